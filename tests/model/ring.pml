/* rt/ring.hpp: one producer pushes and refuses, one consumer pops, a third thread asks for size and refusals.
 *
 * Steps carry the header's own lines. Indices count modulo WRAP (there 2^64) and begin shortly before it, as after
 * many laps. Items are numbered; an item is one cell, as a race on it is told whatever its length. The search covers
 * every execution of ATTEMPTS pushes with any number of pops between.
 *
 * Each of the words in `twins` of CMakeLists.txt, given as -DWORD, plants one mistake that the search must find. */
#ifndef CAPACITY
#define CAPACITY 2
#endif
#define WRAP 8
#define FIRST 6
#ifndef ATTEMPTS
#define ATTEMPTS 6
#endif
#define MASK (CAPACITY - 1)

#ifdef WATCHED
#define THREADS 3
#else
#define THREADS 2
#endif
#define producer 0
#define consumer 1
#define watcher 2

#define ATOMICS 3
#define TAIL 0
#define HEAD 1
#define REFUSED 2

#define CELLS CAPACITY
#define MESSAGES (ATTEMPTS + 1)
#include "memory.pml"

#ifdef PUBLISHES_RELAXED
#define publish_order relaxed
#else
#define publish_order release
#endif
#ifdef LOOKS_FOR_ITEMS_RELAXED
#define look_for_items_order relaxed
#else
#define look_for_items_order acquire
#endif
#ifdef RETURNS_RELAXED
#define return_order relaxed
#else
#define return_order release
#endif
#ifdef LOOKS_FOR_ROOM_RELAXED
#define look_for_room_order relaxed
#else
#define look_for_room_order acquire
#endif
#ifdef SIZE_RELAXED
#define size_order relaxed
#else
#define size_order acquire
#endif

#ifdef TAKES_ONE_TOO_MANY
#define no_room(tail, head) (ahead(tail, head) > MASK + 1)
#elif defined(TAKES_ONE_TOO_FEW)
#define no_room(tail, head) (ahead(tail, head) > MASK - 1)
#else
#define no_room(tail, head) (ahead(tail, head) > MASK)
#endif
#define ahead(tail, head) ((tail + WRAP - head) % WRAP)
#define next(index) ((index + 1) % WRAP)

/* What the threads did, for the assertions only. */
byte taken, received, refused;
bool producer_ended;

inline refuse() {
  load(producer, REFUSED, count, relaxed);
  store(producer, REFUSED, count + 1, relaxed)  /* producer_.refused.store(refused.load(relaxed) + 1, relaxed) */
}

active proctype Producer() {
  byte tail, head_seen = FIRST, count, attempts;
  threads_started;
  do
  :: attempts < ATTEMPTS ->
     attempts++;
     load(producer, TAIL, tail, relaxed);                    /* tail = producer_.tail.load(relaxed) */
     if
     :: no_room(tail, head_seen) ->                          /* if (tail - producer_.head_seen > mask_) */
#ifdef COUNTS_TOO_SOON
        refuse();
#endif
#ifdef WAITS_FOR_ROOM
        do
        :: no_room(tail, head_seen) -> load(producer, HEAD, head_seen, look_for_room_order)
        :: else -> break
        od
#else
        load(producer, HEAD, head_seen, look_for_room_order) /* producer_.head_seen = consumer_.head.load(acquire) */
#endif
     :: else
     fi;
     if
     :: no_room(tail, head_seen) ->                          /* if (tail - producer_.head_seen > mask_) */
#ifndef COUNTS_TOO_SOON
        refuse();
#endif
        refused++;
        assert(ahead(tail, head_seen) == CAPACITY)           /* only a ring that holds its capacity refuses */
     :: else ->
#ifdef PUBLISHES_BEFORE_WRITING
        store(producer, TAIL, next(tail), publish_order);
#endif
        write_cell(producer, (tail & MASK), taken + 1);      /* items_[tail & mask_] = item */
        taken++;
#ifndef PUBLISHES_BEFORE_WRITING
        store(producer, TAIL, next(tail), publish_order)     /* producer_.tail.store(tail + 1, release) */
#endif
     fi;
progress_pushed:
     tail = 0; count = 0
  :: else -> break
  od;
  producer_ended = true
}

active proctype Consumer() {
  byte head, tail_seen = FIRST, item;
  bool last_round, popped;
  threads_started;
  do
  :: last_round = producer_ended;
     if
     :: last_round -> join_thread(consumer, producer)
     :: else
     fi;
     load(consumer, HEAD, head, relaxed);                    /* head = consumer_.head.load(relaxed) */
     if
     :: head == tail_seen ->                                 /* if (head == consumer_.tail_seen) */
        load(consumer, TAIL, tail_seen, look_for_items_order) /* consumer_.tail_seen = producer_.tail.load(acquire) */
     :: else
     fi;
     popped = (head != tail_seen);                           /* if (head == consumer_.tail_seen) return false */
     if
     :: popped ->
#ifdef RETURNS_BEFORE_READING
        store(consumer, HEAD, next(head), return_order);
#endif
        read_cell(consumer, (head & MASK), item);            /* item = items_[head & mask_] */
        assert(item == received + 1);                        /* in order, none lost, none twice */
        received++;
#ifndef RETURNS_BEFORE_READING
        store(consumer, HEAD, next(head), return_order)      /* consumer_.head.store(head + 1, release) */
#endif
     :: else
     fi;
progress_popped:
     head = 0; item = 0;
     if
     :: last_round && !popped -> break
     :: else
     fi
  od;
  load(consumer, REFUSED, item, relaxed);                    /* refused(), after the producer has ended */
  assert(received == taken);
  assert(item == refused && taken + refused == ATTEMPTS)     /* what was dropped is counted, exactly */
}

#ifdef WATCHED
active proctype Watcher() {
  byte head, tail, count, count_before;
  byte head_at, tail_at;                                     /* the same, not modulo WRAP */
  threads_started;
  load(watcher, HEAD, head, size_order);                     /* head = consumer_.head.load(acquire) */
  head_at = thread[watcher].seen[HEAD];
  load(watcher, TAIL, tail, relaxed);                        /* producer_.tail.load(relaxed) - head */
  tail_at = thread[watcher].seen[TAIL];
  assert(tail_at >= head_at);                                /* an empty ring is never called full */
  load(watcher, REFUSED, count_before, relaxed);
  load(watcher, REFUSED, count, relaxed);                    /* refused(), twice */
  assert(count_before <= count && count <= refused + 1)      /* + 1: between the store and the ghost's count */
}
#endif

init {
  d_step {
    memory[TAIL].message[0].value = FIRST;
    memory[HEAD].message[0].value = FIRST
  }
  start_threads();
}
