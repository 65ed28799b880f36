/// The transport by v_stat: rho* = rho - dt div(rho v_stat) by both schemes.

#pragma once

#include "core/macro/congested/congested_priv.h"

/// Fill rows first <= row < last of `next` with rho*, with its spans; all members of the team call it.
void congested__transport(macro_solver *s, int member, ptrdiff_t first, ptrdiff_t last,
                          team_barrier *barrier);

#ifdef CPU_BUILD
/// What transport_kernels.c gives to the table of each build, see congested_kernels.
#define congested__transport_upwind CPU_NAME(congested__transport_upwind)
#define congested__muscl_states_x2  CPU_NAME(congested__muscl_states_x2)
#define congested__muscl_flux_x2    CPU_NAME(congested__muscl_flux_x2)
#define congested__muscl_update     CPU_NAME(congested__muscl_update)
void congested__transport_upwind(const macro_solver *s, ptrdiff_t row, ptrdiff_t i_min,
                                 ptrdiff_t i_max, double *ret_rho);
void congested__muscl_states_x2(const macro_solver *s, const congested_stage *stage, ptrdiff_t r,
                                block_span span);
void congested__muscl_flux_x2(const macro_solver *s, const congested_stage *stage, ptrdiff_t r,
                              block_span span);
void congested__muscl_update(const macro_solver *s, const congested_stage *stage, ptrdiff_t row,
                             block_span span);
#endif
