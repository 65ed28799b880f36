/// Examples 1 and 2 for the microscopic solver alone, and their outflow curves.

#pragma once

#include "core/micro/micro.h"

enum {
    HELPER_OUTFLOW_PARTS = 192,  ///< parts of an Example
    HELPER_OUTFLOW_SAMPLES = 61, ///< of a curve
};

/// A definition with what it points to. Do not move it once it was made.
typedef struct helper_outflow {
    micro_def def;                          ///< to be changed at will
    scene_belt belt;                        ///< under the whole domain, 0.395 m/s
    scene_obstacle obstacle;                ///< to (0.75, 0.5)
    vec2 path[2];                           ///< of the obstacle
    micro_kind kind;                        ///< the steel cylinder
    scene_pose poses[HELPER_OUTFLOW_PARTS]; ///< 16 rows of 12
} helper_outflow;

/// Example 1 (60 degrees) or 2 (90 degrees) as core/scene/README.md lays them out.
void helper_outflow_example(helper_outflow *e, double angle_deg, double modulus_reduction);

/// U(t): parts with x < 0.75 m, HELPER_OUTFLOW_SAMPLES times from t = 0 to t_end, s. Each step that the
/// samples need is made; t_end must be samples - 1 whole numbers of steps. Asserts that all goes well.
void helper_outflow_curve(const micro_def *def, double t_end, double *ret_u);

/// Mean over time of the difference of two curves, a share of the parts.
double helper_outflow_gap(const double *a, const double *b);
