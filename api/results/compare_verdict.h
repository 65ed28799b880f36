/// What a comparison of two runs, or of a run and counts, says of their throughputs, in sentences (api/results/verdict.h).
///
///     models_agree     both models of one line, within COMPARE_MODELS_AGREE of each other, to which comes, where nothing holds parts up,
///                      by how much more or fewer than the mean, which the density has, arrived by chance; or within the interval
///     models_disagree  same, not so
///     more, less       the other lets more, or less, through than the reference, by more than chance leaves open
///     equal            the difference is within what chance leaves open, and what would halve that
///     same             no difference at all
///     uncertain        parts arrive by chance, and how much of the difference is chance is not known
///     too_early        both models of one line, not within that, and the belt of one was still filling while its throughput was
///                      counted
///     no_throughput    nothing came through in either, or nothing has left of one of them, or its curve is of what is inside while cargo enters and leaves
///     flows_differ     flows of counters, outlets or sinks differ by more than chance leaves open, and by more than the throughputs do. Of a flow
///                      without an interval n parts were counted, and 1.96 sqrt(n) of them are left to chance (Poisson)

#pragma once

#include "api/results/compare_flows.h"
#include "api/results/verdict.h"
#include "core/compare/compare.h"
#include "core/run/run.h"

#include <stdbool.h>
#include <stdint.h>

/// Of the microscopic model's throughput: in the lines for which both were compared they were mostly this near.
#define COMPARE_MODELS_AGREE 0.06

/// What is compared.
typedef struct compare_side {
    bool is_run;             ///< else it was measured, and only the throughput counts
    run_model model;         ///< of the run
    bool has_chance;         ///< runs at other substreams may differ
    bool is_compared;        ///< the model was compared for such lines
    bool is_filling;         ///< its summary says belt_fills
    bool is_fed;             ///< its scenario has feeds: cargo enters while it leaves
    uint64_t line;           ///< digest of the scenario without how it is solved
    double offered_per_h;    ///< mean of what arrives after the warm-up; NAN: nothing, or not known
    double arrived;          ///< of that mean, what was drawn; 1 without chance
    double throughput_per_h; ///< NAN: nothing left
    double error_per_h;      ///< half width of its interval of 95 %; NAN: there is none
    double needs_s;          ///< how long a run has to be for one; NAN: not known
    double counted_h;        ///< for how long its flows were counted, h; 0: not known
} compare_side;

/// The side of a run, from its resolved scenario and its key figures (n_figures = 0: none), and its flows; also of a run that
/// goes on. BF_ECORRUPT; BF_ENOMEM.
BF_MUST_CHECK bf_status compare_verdict_side(run_model model, const char *scenario,
                                             size_t n_scenario, const char *figures,
                                             size_t n_figures, compare_side *ret_side,
                                             compare_flows *ret_flows, bf_error *err);

/// The same from a summary. BF_EINPUT: it is none; BF_ECORRUPT: its scenario cannot be read; BF_ENOMEM.
BF_MUST_CHECK bf_status compare_verdict_side_of_summary(const char *summary, size_t n,
                                                        compare_side *ret_side,
                                                        compare_flows *ret_flows, bf_error *err);

/// True if a column of the curve of a side is what is inside while cargo enters and leaves (compare_figures_of_content()).
/// NULL: the first column, a counter.
bool compare_verdict_is_content(const compare_side *side, const char *column);

/// Leave out what such a column of the reference or of a side does not tell: figures of the side, measures of both.
void compare_verdict_leave_out(const compare_side *reference, const compare_side *side,
                               const char *column, compare_figures *figures,
                               compare_measures *measures);

/// Add what b's throughput is to that of the reference a.
void compare_verdict_find(const compare_side *a, const compare_side *b, verdicts *ret_verdicts);

/// Add flows_differ, where it is so: it names the COMPARE_FLOWS_TOLD that differ most.
void compare_verdict_flows(const compare_side *a, const compare_side *b,
                           const compare_flows *flows_a, const compare_flows *flows_b,
                           verdicts *ret_verdicts);
