/// The parameters of routes, for their table and for what is made of it.

#pragma once

#include "api/http/param.h"

/// In the path,
extern const param routes__run_id;
extern const param routes__measurement_id;
extern const param routes__study_id;
extern const param routes__lease_id;
extern const param routes__grant_number;
extern const param routes__trial_number;
extern const param routes__snapshot_n;
extern const param routes__example_name;
extern const param routes__problem_word;

/// in the query,
extern const param routes__compared_a;
extern const param routes__compared_b;
extern const param routes__compared_runs;
extern const param routes__reference;
extern const param routes__column;
extern const param routes__csv_label;
extern const param routes__csv_counter;
extern const param routes__csv_kind;
extern const param routes__run_status;
extern const param routes__run_model_word;
extern const param routes__run_label;
extern const param routes__of_line;
extern const param routes__of_owner;
extern const param routes__run_search;
extern const param routes__run_sort;
extern const param routes__run_created_from;
extern const param routes__run_created_before;
extern const param routes__run_starred;
extern const param routes__run_where;
extern const param routes__run_count;
extern const param routes__run_cursor;
extern const param routes__run_study;
extern const param routes__study_status;
extern const param routes__trials_from;
extern const param routes__trials_limit;
extern const param routes__measurement_label;
extern const param routes__page_limit;
extern const param routes__page_cursor;
extern const param routes__wait_s;
extern const param routes__format;
extern const param routes__snapshot_count;
extern const param routes__picture_width;
extern const param routes__picture_colormap;
extern const param routes__picture_max;
extern const param routes__with_vtk;
extern const param routes__with_densities;
extern const param routes__start_parts;
extern const param routes__followed_runs;
extern const param routes__inline_grids;
extern const param routes__last_event_id;

/// in the header.
extern const param routes__idempotency_key;
extern const param routes__if_match;
extern const param routes__if_none_match;
extern const param routes__if_range;
extern const param routes__last_event_id_header;
extern const param routes__prefer;
extern const param routes__range;
