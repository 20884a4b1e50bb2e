/* What the C++ memory model lets threads see of each other, for the models of ring and snapshot: a thread may read old
 * values of an atomic until it has been told of newer ones, and what it did to ordinary memory is ordered with what
 * another did only where a release was read by an acquire.
 *
 *   atomic     every value it ever had is kept, oldest first, each with what its writer vouched for (nothing, if relaxed)
 *   load       picks any value from the newest that this thread has seen on; an acquire then knows what its writer did
 *   exchange   reads the newest value, always, and passes on what the value it replaced vouched for (a release sequence)
 *   cell       ordinary memory. An access that is not ordered after every access of the other threads that it collides
 *              with is a data race, whatever the order in which the search happens to run them: with a race the slot may
 *              be torn, without one it cannot be
 *
 * Knowledge is a vector clock: clock[u] is how far the work of thread u is known; a thread's own count moves on at each
 * of its releases. Each statement is one step of the search. What is left out (a load that is served after a later store
 * of the same thread) cannot happen around these protocols: every store that another thread acts on is a release.
 *
 * To be defined before: THREADS, ATOMICS, CELLS, MESSAGES (values an atomic has in one run, at most). */

typedef View { byte clock[THREADS]; byte seen[ATOMICS] };
typedef Message { byte value; View known };
typedef Atomic { byte newest; Message message[MESSAGES] };
typedef Cell { byte value; byte written[THREADS]; byte read[THREADS] };

View thread[THREADS];
Atomic memory[ATOMICS];
Cell cell[CELLS];
byte pick;
hidden byte at;
hidden byte data_race;
bool threads_started;

#define relaxed 0
#define acquire 1
#define release 2
#define acq_rel 3

#define raise(into, value) if :: into < value -> into = value :: else fi

inline join(into, from) {
  at = 0;
  do
  :: at < THREADS -> raise(into.clock[at], from.clock[at]); at++
  :: else -> break
  od;
  at = 0;
  do
  :: at < ATOMICS -> raise(into.seen[at], from.seen[at]); at++
  :: else -> break
  od;
  at = 0
}

inline append(t, a, new_value, order) {
  memory[a].newest++;
  thread[t].seen[a] = memory[a].newest;
  memory[a].message[memory[a].newest].value = new_value;
  if
  :: order & release ->
     join(memory[a].message[memory[a].newest].known, thread[t]);
     thread[t].clock[t]++
  :: else
  fi
}

inline store(t, a, new_value, order) {
  d_step { append(t, a, new_value, order) }
}

inline load(t, a, into, order) {
  atomic {
    pick = thread[t].seen[a];
    do
    :: pick < memory[a].newest -> pick++
    :: break
    od;
    into = memory[a].message[pick].value;
    thread[t].seen[a] = pick;
    if
    :: order & acquire -> d_step { join(thread[t], memory[a].message[pick].known) }
    :: else
    fi;
    pick = 0
  }
}

inline exchange(t, a, new_value, into, order) {
  atomic {
    memory[a].newest < MESSAGES - 1;  /* where a wrong twin would go on for ever, the search stops */
    d_step {
      pick = memory[a].newest;
      into = memory[a].message[pick].value;
      if
      :: order & acquire -> join(thread[t], memory[a].message[pick].known)
      :: else
      fi;
      append(t, a, new_value, order);
      join(memory[a].message[memory[a].newest].known, memory[a].message[pick].known);
      pick = 0
    }
  }
}

inline write_cell(t, c, new_value) {
  d_step {
    data_race = false;
    at = 0;
    do
    :: at < THREADS ->
       data_race = data_race || (at != t && (cell[c].written[at] > thread[t].clock[at] ||
                                             cell[c].read[at] > thread[t].clock[at]));
       at++
    :: else -> break
    od;
    assert(!data_race);
    cell[c].written[t] = thread[t].clock[t];
    cell[c].value = new_value
  }
}

inline read_cell(t, c, into) {
  d_step {
    data_race = false;
    at = 0;
    do
    :: at < THREADS -> data_race = data_race || (at != t && cell[c].written[at] > thread[t].clock[at]); at++
    :: else -> break
    od;
    assert(!data_race);
    cell[c].read[t] = thread[t].clock[t];
    into = cell[c].value
  }
}

/* As std::thread::join does: all that thread u has done lies before what thread t does next. */
inline join_thread(t, u) {
  d_step { join(thread[t], thread[u]) }
}

/* Everything up to here lies before the threads' start. */
inline start_threads() {
  d_step {
    pick = 0;
    do
    :: pick < THREADS -> thread[pick].clock[pick] = 1; pick++
    :: else -> break
    od;
    pick = 0;
    threads_started = true
  }
}
