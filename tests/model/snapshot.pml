/* rt/snapshot.hpp: one writer publishes PUBLISHED values, one reader looks for newer ones as often as it likes.
 *
 * Steps carry the header's own lines. A value is its number; it is one cell, as a race on it is told whatever its
 * length. `middle` holds the index of a slot and the mark kNewer, as there.
 *
 * Each of the words in `twins` of CMakeLists.txt, given as -DWORD, plants one mistake that the search must find. */
#ifndef PUBLISHED
#define PUBLISHED 5
#endif
#define kIndex 3
#define kNewer 4

#define THREADS 2
#define writer 0
#define reader 1

#define ATOMICS 1
#define MIDDLE 0

#define CELLS 3
#define MESSAGES (2 * PUBLISHED + 2)
#include "memory.pml"

#ifdef PUBLISHES_WITHOUT_RELEASE
#define publish_order acquire
#elif defined(PUBLISHES_WITHOUT_ACQUIRE)
#define publish_order release
#else
#define publish_order acq_rel
#endif
#ifdef UPDATES_WITHOUT_ACQUIRE
#define update_order release
#elif defined(UPDATES_WITHOUT_RELEASE)
#define update_order acquire
#else
#define update_order acq_rel
#endif

#ifdef TWO_SLOTS
#define FRONT 1 /* the reader's slot is the one between */
#else
#define FRONT 2
#endif
#ifdef UNMARKED
#define mark 0
#else
#define mark kNewer
#endif

/* What the threads did, for the assertions only. */
byte published;
bool writer_ended;

active proctype Writer() {
  byte back, seen;
  threads_started;
  do
  :: published < PUBLISHED ->
#ifdef PUBLISHES_BEFORE_WRITING
     seen = back;
     exchange(writer, MIDDLE, (back | mark), back, publish_order);
     write_cell(writer, seen, published + 1);
#else
     write_cell(writer, back, published + 1);                        /* slots_[back_].value = value */
     exchange(writer, MIDDLE, (back | mark), seen, publish_order);   /* middle_.exchange(back_ | kNewer, acq_rel) */
     back = seen & kIndex;                                           /* back_ = ... & kIndex */
#endif
     seen = 0;
     published++;
progress_published:
     skip
  :: else -> break
  od;
  writer_ended = true
}

active proctype Reader() {
  byte front = FRONT, seen, value, shown;
  bool last_round, newer;
  threads_started;
  do
  :: last_round = writer_ended;
     if
     :: last_round -> join_thread(reader, writer)
     :: else
     fi;
     load(reader, MIDDLE, seen, relaxed);                            /* middle_.load(relaxed) */
#ifdef WAITS_FOR_A_VALUE
     do
     :: (seen & kNewer) == 0 && !last_round -> load(reader, MIDDLE, seen, relaxed)
     :: else -> break
     od;
#endif
#ifdef TAKES_UNMARKED
     newer = true;
#else
     newer = ((seen & kNewer) != 0);                                 /* if ((... & kNewer) == 0) return false */
#endif
     seen = 0;
     if
     :: newer ->
#ifdef LOADS_AND_STORES
        load(reader, MIDDLE, seen, acquire);
        store(reader, MIDDLE, front, release);
        front = seen & kIndex;
#elif defined(KEEPS_THE_MARK)
        exchange(reader, MIDDLE, (front | kNewer), seen, update_order);
        front = seen & kIndex;
#else
        exchange(reader, MIDDLE, front, seen, update_order);         /* middle_.exchange(front_, acq_rel) */
        front = seen & kIndex;                                       /* front_ = ... & kIndex */
#endif
        seen = 0
     :: else
     fi;
     read_cell(reader, front, value);                                /* value() */
     if
     :: newer -> assert(value > shown)                               /* never the same as new, never older after newer */
     :: else -> assert(value == shown)                               /* without a newer one it stays, in content too */
     fi;
     shown = value;
     value = 0;
     newer = false;
progress_looked:
     if
     :: last_round -> break
     :: else
     fi
  od;
  assert(shown == PUBLISHED)                                         /* the last one arrives */
}

init {
  d_step {
    memory[MIDDLE].message[0].value = 1
  }
  start_threads();
}
