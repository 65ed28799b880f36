/// Parallel loops and teams of threads.
///
/// One set of worker threads serves the whole process: a call takes idle workers, starts those that are
/// missing, and returns them when it ends. So solvers that follow one another or work at the same time do
/// not start threads again and again, and a process never has more threads than are at work at once. Calls
/// may come from any thread, also from inside another call. Idle workers spin for about
/// a millisecond, then sleep; they block all signals and end with the process.

#pragma once

#include <stddef.h>

/// Most members that a team may have, the caller among them.
enum { TEAM_MEMBERS_MAX = 256 };

/// The work of one item of a parallel loop; items may run at the same time and in any order.
typedef void team_body(void *context, size_t item);

/// Call body(context, item) for item = 0 .. n_items - 1 on up to n_threads threads and return when
/// all are done. The caller gives each item its own outputs, so that results never depend on how
/// many threads there are.
void team_for(int n_threads, size_t n_items, team_body *body, void *context);

/// How many processors this process may use, at least 1.
int team_processors(void);

/// Where the members of a team wait for each other.
typedef struct team_barrier team_barrier;

/// The work of one member of a team of n_members, 0 <= member < n_members.
typedef void team_member(void *context, int member, int n_members, team_barrier *barrier);

/// Call body once for each member of a team, all at the same time, and return when all are done. The
/// caller's thread is member 0. The team has n_threads members; fewer beyond TEAM_MEMBERS_MAX or where the
/// system refuses threads.
void team_run(int n_threads, team_member *body, void *context);

/// Barrier: wait until all members of the team have called it. Their earlier writes are visible to all afterwards.
/// Takes well below a microsecond where every member has a processor of its own; who waits for a millisecond sleeps, and at
/// once where there are more members than processors.
void team_barrier_wait(team_barrier *barrier);

/// One turn of a loop that waits for another thread, n_turns >= 1 counted from the loop's beginning: pause
/// the processor for some cycles, and after many turns let other threads run.
void team_spin_wait(int n_turns);
