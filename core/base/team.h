/// Loops over several threads (OpenMP; one thread where it is not compiled in).

#pragma once

#include <stddef.h>

/// The work of one item of a parallel loop; items may run at the same time and in any order.
typedef void team_body(void *context, size_t item);

/// Call body(context, item) for item = 0 .. n_items - 1 on up to n_threads threads and return when
/// all are done. The caller gives each item its own outputs, so that results never depend on how
/// many threads there are.
void team_for(int n_threads, size_t n_items, team_body *body, void *context);

/// How many processors this process may use, at least 1.
int team_processors(void);

/// Where the members of a team wait for each other.
typedef struct team_gate team_gate;

/// For a thread that waits: let others run, the longer the more often in a row it has waited.
void team_relax(int n_waits);

/// The work of one member of a team of n_members, 0 <= member < n_members.
typedef void team_member(void *context, int member, int n_members, team_gate *gate);

/// Call body once for each member of a team, all at the same time, and return when all are done. The
/// team has at most n_threads members; it may have fewer.
void team_run(int n_threads, team_member *body, void *context);

/// Wait until all members of the team have come here. What they wrote before is seen by all after it.
/// Takes well below a microsecond where every member has a processor of its own.
void team_wait(team_gate *gate);
