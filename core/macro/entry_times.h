/// When the cargo of each cell entered: a time e that is carried along with the density.
///
///     d(rho e)/dt + div( F e ) = 0,    F the flux of mass
///
/// F is the very flux by which the density moves in a step, that of the pressure with it, and e that of the cell which it leaves.
/// With m what stays in a cell and f_k what comes from the cells k beside it,
///
///     e <- ( m e + sum f_k e_k ) / ( m + sum f_k ),
///
/// with m = rho - sum f_k of the density after the step: so e is never beyond those of the cells that it comes from, and rho e
/// is conserved as the density is, but where a cell passes on what came in the same step (m < 0 counts as 0). The density
/// does not depend on e.
///
/// A cell has one e, the mean of what has mixed in it. So the mean time of all that leaves is exact, and a distribution
/// shows what goes different ways: lanes, corners that stand, queues that come and go. Where ways meet within a cell, or
/// upwind fluxes spread cargo from cell to cell, times come closer to each other than those of parts.
///
/// Threads  rows are divided among threads: each writes its own and reads those beside them of the step before. The bits are
///          the same for any number of threads and with every instruction set.
/// Units    s; densities normalised.

#pragma once

#include "core/base/checkpoint.h"
#include "core/macro/macro_priv.h"

#include <string.h>

/// Carry the times of a row over a step whose fluxes are recorded, from `times` to `next`.
typedef void entry_times_carry_fn(const macro_solver *s, ptrdiff_t row);

/// The state. Fluxes are what a step moves towards rising x, in densities of a cell.
typedef struct entry_times {
    entry_times_carry_fn *carry; ///< as built for this processor
    double *times;               ///< n2 rows: e; 0 in blocks without cargo
    double *next;                ///< n2 rows: what a step makes of it
    double *flux1;               ///< n2 rows: fluxes along x1, rows as macro_faces has them
    double *flux2;               ///< n2 + 1 rows: fluxes along x2
    size_t n_exits; ///< 2 n2 + 2 n1: west and east of each row, then south and north of each column
    macro_exit *exits; ///< what left through them in the last step
} entry_times;

#ifdef CPU_BUILD
/// Each build has a name of its own.
#define entry_times__carry CPU_NAME(entry_times__carry)
extern entry_times_carry_fn entry_times__carry;
#endif

/// Begin with e = 0. The caller owns *ret_times: entry_times_destroy(). BF_ENOMEM.
BF_MUST_CHECK bf_status entry_times_create(const macro_solver *s, entry_times **ret_times);

/// Free it and what it owns. NULL is fine. Always returns NULL.
entry_times *entry_times_destroy(entry_times *e);

/// All cargo entered at t = 0, and nothing has left.
void entry_times_reset(const macro_solver *s);

/// Set a row to 0 outside blocks.
static inline void entry_times_clear(const macro_solver *s, double *row, block_span span)
{
    double *begin = row - s->margin, *end = begin + s->stride;
    double *first = span.first < span.last ? row + span.first * BLOCK_CELLS : end;
    double *last = span.first < span.last ? row + span.last * BLOCK_CELLS : end;

    memset(begin, 0, (size_t)(first - begin) * sizeof *row);
    memset(last, 0, (size_t)(end - last) * sizeof *row);
}

/// Record a stage's fluxes of blocks in flux1 or flux2, in row `row` of it: `part` of the step's, which is dt/dx times the
/// stage's weight. is_first: of the step; the row is 0 outside the blocks then.
void entry_times_record(const macro_solver *s, double *rows, ptrdiff_t row, const double *flux,
                        block_span span, double part, bool is_first);

/// A step was made, whose fluxes are recorded and whose density is `now`: carry the times, and note what left the grid.
void entry_times_follow(const macro_solver *s);

/// Append the times to a checkpoint, n2 rows of n1, and take them from one before the first step. False: it is too short.
void entry_times_save(const macro_solver *s, checkpoint_writer *w);
BF_MUST_CHECK bool entry_times_load(const macro_solver *s, checkpoint_reader *r);
