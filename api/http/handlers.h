/// The handlers of the routes, by the file that holds them. What each does is said in the table of
/// routes.c.

#pragma once

#include "api/http/routes.h"

/// Runs: accept, list, show, stop, remove; and what accepting would say.
route_handler handlers_runs_submit;
route_handler handlers_runs_validate;
route_handler handlers_runs_list;
route_handler handlers_runs_show;
route_handler handlers_runs_cancel;
route_handler handlers_runs_remove;

/// What a run has given so far.
route_handler handlers_results_scenario;
route_handler handlers_results_summary;
route_handler handlers_results_curve;

/// Its density snapshots.
route_handler handlers_snapshots_list;
route_handler handlers_snapshots_show;

/// The parts of a microscopic run.
route_handler handlers_parts_show;
route_handler handlers_parts_series;

/// All results at once.
route_handler handlers_archive_show;

/// Event streams of one run and of several.
route_handler handlers_events_of_run;
route_handler handlers_events_of_runs;

/// Measured curves.
route_handler handlers_measurements_add;
route_handler handlers_measurements_list;
route_handler handlers_measurements_show;
route_handler handlers_measurements_remove;

/// Runs and measurements against each other.
route_handler handlers_compare_runs;

/// The service itself.
route_handler handlers_meta_examples;
route_handler handlers_meta_example;
route_handler handlers_meta_livez;
route_handler handlers_meta_readyz;
route_handler handlers_meta_metrics;
route_handler handlers_meta_version;
route_handler handlers_meta_openapi;
