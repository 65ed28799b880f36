/// The loop over steps of all four solvers: disks and bodies, explicit and implicit.
///
/// As long as steps are left, the driver calls the solver's refresh(), which rebuilds its lists, and then a team of
/// threads makes steps until all are made, the lists are no longer valid or a step has to be checked. Every
/// member of the team runs the same loop: it does its part of each phase of a step, waits for the others
/// between phases, and computes the same outcome from the same values.
///
/// The solvers make results independent of the number of threads: in a phase no item writes what another one
/// reads.

#pragma once

#include "core/base/status.h"
#include "core/base/team.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/// The outcome of a step.
typedef enum driver_outcome {
    DRIVER_MADE,     ///< the next one may follow
    DRIVER_STALE,    ///< made, but the lists are not valid for the next one
    DRIVER_SUSPECT,  ///< made, but driver_solver.check has to be called
    DRIVER_NOT_MADE, ///< not made, as the lists are not valid for it
} driver_outcome;

/// Extremes of all parts in a step, or since a list was made.
typedef struct driver_extremes {
    double speed2;        ///< largest v^2, m2/s2
    double sum;           ///< of all that must be finite: not finite if any term is not
    double overlap;       ///< largest, m; 0 or more
    double overlap_share; ///< largest overlap divided by the smaller part's radius
} driver_extremes;

/// Progress of a team. Each member has a copy, all with the same values.
typedef struct driver_progress {
    double displacement_bound; ///< m, no part has moved farther since the list was made
    double pair_bound;       ///< m, nor since pairs were chosen from it, where that is another time
    double last_bound;       ///< m, nor in the last step
    driver_extremes largest; ///< of the steps of this team
} driver_progress;

/// A member of the team.
typedef struct driver_member {
    void *state;              ///< the solver's
    const void *step;         ///< for data that the solver passes to its phases
    int index;                ///< 0 <= index < n_members
    int n_members;            ///< see there
    team_barrier *barrier;    ///< driver_wait()
    uint64_t n_made;          ///< steps of this team so far
    driver_progress progress; ///< see there
} driver_member;

/// The functions of a solver; state is its own.
typedef struct driver_solver {
    /// Rebuild the lists that are not valid for the next step.
    bf_status (*refresh)(void *state, bf_error *err);

    /// Make several steps at once, at most n, in another way than by single ones. Returns how many; 0: none,
    /// and nothing has changed, and *ret_most is how many single steps to make before the next try. NULL: the
    /// solver has no such way.
    uint64_t (*advance_tile)(void *state, uint64_t n, uint64_t *ret_most, bool *ret_suspect);

    /// Set the progress with which a team begins. Returns how many threads are of use.
    int (*begin)(const void *state, driver_progress *ret_progress);

    /// One member's part of a step, which waits for the others at least once. All members return the same.
    driver_outcome (*step)(driver_member *m);

    /// Take over what a team has done: n steps, of which the last one had this outcome.
    void (*end)(void *state, uint64_t n, driver_outcome outcome, const driver_progress *progress);

    /// BF_ENUMERIC, with step, time and part, if a part is not finite or has moved impossibly far.
    bf_status (*check)(const void *state, bf_error *err);
} driver_solver;

/// Make n steps. Errors are those of refresh and check.
BF_MUST_CHECK bf_status driver_advance(const driver_solver *solver, void *state, uint64_t n,
                                       bf_error *err);

/// The work of one item of a phase.
typedef void driver_work(const driver_member *m, size_t item);

/// Do the member's part of the items first .. last - 1: every n_members-th of them.
void driver_split(const driver_member *m, size_t first, size_t last, driver_work *work);

/// Do the member's part of the items of one group after those of the other, each `slice` items at a time: group g has the
/// items first[g] .. first[g + 1] - 1. Groups of one slice, and the last one, are done by the first member alone, without
/// waiting between them. All have done everything afterwards.
void driver_split_groups(const driver_member *m, const size_t *first, size_t n_groups, size_t slice,
                         driver_work *work);

/// Barrier: wait until all members have called it.
static inline void driver_wait(const driver_member *m)
{
    team_barrier_wait(m->barrier);
}

/// Raise the extremes in *all, and add up the sums.
static inline void driver_join(driver_extremes *all, const driver_extremes *more)
{
    all->speed2 = more->speed2 > all->speed2 ? more->speed2 : all->speed2;
    all->overlap = more->overlap > all->overlap ? more->overlap : all->overlap;
    all->overlap_share =
        more->overlap_share > all->overlap_share ? more->overlap_share : all->overlap_share;
    all->sum += more->sum;
}
