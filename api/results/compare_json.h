/// Comparisons as JSON, for the resource and the command line alike. NAN is written as null.

#pragma once

#include "api/json/json_out.h"
#include "core/compare/compare.h"

/// Write the members of a curve's figures into the object that is open: t_start_s, t_end_s,
/// parts_start, parts_end, drain_time_s, t10_s, t90_s, throughput_per_s.
void compare_json_figures(json_out *w, const compare_figures *f);

/// Write the measures between two curves as an object.
void compare_json_measures(json_out *w, const compare_measures *m);

/// Write the members of the distance of two densities: mean_abs, l1, emd_x_m, emd_y_m.
void compare_json_distance(json_out *w, const compare_distance *d);
