// The loops of the transport by v_stat, compiled once per instruction set. The states are those of muscl.h, and the
// terms of an update have the order of sweep_muscl.c: where no cargo is packed the density has the same bits.

#include "core/macro/congested/transport.h"
#include "core/macro/flux.h"
#include "core/macro/muscl.h"

void congested__transport_upwind(const macro_solver *s, ptrdiff_t row, ptrdiff_t i_min,
                                 ptrdiff_t i_max, double *ret_rho)
{
    const double *rho = macro__row(s, s->now.rho, row);
    const double *south = row > 0 ? macro__row(s, s->now.rho, row - 1) : s->zero_row + s->margin;
    const double *north =
        row + 1 < s->n2 ? macro__row(s, s->now.rho, row + 1) : s->zero_row + s->margin;
    const double *v1 = macro__row(s, s->faces1.v, row), *v2 = macro__row(s, s->faces2.v, row);
    const double *v2_north = macro__row(s, s->faces2.v, row + 1);

    for (ptrdiff_t i = i_min; i < i_max; i += SIMD_LANES) {
        const simd here = simd_load(rho + i);
        const simd east = flux_upwind_one(simd_load(v1 + i), here, simd_load_any(rho + i + 1));
        const simd west =
            flux_upwind_one(simd_load_any(v1 + i - 1), simd_load_any(rho + i - 1), here);
        const simd up = flux_upwind_one(simd_load(v2_north + i), here, simd_load(north + i));
        const simd down = flux_upwind_one(simd_load(v2 + i), simd_load(south + i), here);
        simd_store(ret_rho + i, here - s->lambda1 * (east - west) - s->lambda2 * (up - down));
    }
}

void congested__muscl_states_x2(const macro_solver *s, const congested_stage *stage, ptrdiff_t r,
                                block_span span)
{
    const double *nothing = s->zero_row + s->margin;
    const macro_face_states *states = &stage->rows->states2[r & 1];

    if (r < 0 || r >= s->n2)
        return;
    const double *rho = macro__row(s, stage->from->rho, r);
    muscl_states_x2(r > 0 ? rho - s->stride : nothing, rho,
                    r + 1 < s->n2 ? rho + s->stride : nothing, macro__row(s, s->open2, r),
                    span.first, span.last, states->right, states->left);
}

void congested__muscl_flux_x2(const macro_solver *s, const congested_stage *stage, ptrdiff_t r,
                              block_span span)
{
    const double *nothing = s->zero_row + s->margin;
    const congested_rows *rows = stage->rows;

    flux_upwind(macro__row(s, s->faces2.v, r), r > 0 ? rows->states2[(r - 1) & 1].left : nothing,
                r < s->n2 ? rows->states2[r & 1].right : nothing, span.first, span.last,
                rows->flux2[r & 1]);
}

// The row of `to` from the fluxes along both axes, whose faces before the first cell are in `before`.
static void update(const macro_solver *s, const congested_stage *stage, ptrdiff_t row,
                   block_span span)
{
    const congested_rows *rows = stage->rows;
    const double *rho = macro__row(s, stage->from->rho, row);
    const double *begin = stage->begin != NULL ? macro__row(s, stage->begin->rho, row) : NULL;
    const double *south = rows->flux2[row & 1], *north = rows->flux2[(row + 1) & 1];
    const double lambda2 = begin != NULL ? 0.5 * s->lambda2 : s->lambda2;
    double *to = macro__row(s, stage->to->rho, row);
    simd before = simd_load(rows->flux1 + span.first * BLOCK_CELLS - SIMD_LANES);

    for (ptrdiff_t i = span.first * BLOCK_CELLS; i < span.last * BLOCK_CELLS; i += SIMD_LANES) {
        const simd after = simd_load(rows->flux1 + i);
        simd updated = simd_load(rho + i) - s->lambda1 * (after - simd_shift_up(before, after));
        if (begin != NULL)
            updated = 0.5 * (simd_load(begin + i) + updated);
        simd_store(to + i, updated - lambda2 * (simd_load(north + i) - simd_load(south + i)));
        before = after;
    }
}

void congested__muscl_update(const macro_solver *s, const congested_stage *stage, ptrdiff_t row,
                             block_span span)
{
    const congested_rows *rows = stage->rows;
    const block_span faces = { span.first - 1, span.last };

    muscl_states_x1(macro__row(s, stage->from->rho, row), macro__row(s, s->open1, row), faces.first,
                    faces.last, rows->states1.left, rows->states1.right);
    flux_upwind(macro__row(s, s->faces1.v, row), rows->states1.left, rows->states1.right,
                faces.first, faces.last, rows->flux1);
    update(s, stage, row, span);
}
