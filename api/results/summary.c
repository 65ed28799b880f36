#include "api/results/results.h"

#include "api/json/json_out.h"
#include "api/json/members.h"
#include "api/results/run_verdict.h"
#include "api/scenario/review_members.h"
#include "api/scenario/scenario.h"
#include "api/scenario/scenario_members.h"
#include "core/base/memory.h"

#include <inttypes.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

// Fewer divisible parts than this have not fallen: a density spreads without end.
#define FALLEN_TOLD 0.1

// What a summary is written from.
typedef struct summary_view {
    run_model model;
    const char *solver_version;
    frame_begin begin;
    frame_end end;
    results_timing timing;
    uint64_t n_threads;
    bool is_stopped;
    bool is_fed;
    bool may_end_early; // by `until`
    uint64_t n_parts;   // of the microscopic model, in the run
    bool may_drop;      // some of the domain is under no belt
    double n_left;
    double work_per_s; // cell or particle steps
    double packing_density;
    bf_grid grid;
    scene_closure closure;
    advice advice;
    review_warnings warnings; // with those of the advice
    const key_figures *figures;
    verdicts verdicts; // about it
    const char *scenario;
    size_t n_scenario;
} summary_view;

static void collect_warnings(summary_view *of)
{
    const unsigned doubts = advice_doubts(of->model, &of->end);
    review_warning *item;

    if (of->is_stopped)
        review_explain(review_add(&of->warnings, "The run was stopped before its end", "%s", ""),
                       "The results are those of %.6g s of %.6g s.", of->end.t, of->begin.duration);
    if (of->end.parts_fallen >= FALLEN_TOLD)
        review_explain(review_add(&of->warnings, "Parts fell off the belts", "/belts"),
                       of->model == RUN_MACRO
                           ? "%.4g parts came to where no belt is. They are gone, and count as "
                             "fallen, not as throughput."
                           : "%.0f parts came to where no belt is. They are gone, and count as "
                             "fallen, not as throughput.",
                       of->end.parts_fallen);
    if ((doubts & ADVICE_DOUBT_DENSITY) != 0) {
        item = review_add(&of->warnings, "The jam is denser than real parts can be", "/macro");
        review_explain(item, "It looks shorter than it will be.%s",
                       of->advice.validity.is_compared
                           ? " The outflow is as for moving parts all the same: for scenarios like "
                             "this one they differed by at most 5 % of the parts."
                           : "");
        snprintf(item->detail, sizeof item->detail,
                 "The largest density, %.4g, is above %.4g of close packing.", of->end.peak,
                 advice_density_trusted);
    }
    review_append(&of->warnings, &of->advice.warnings);
    if ((doubts & ADVICE_DOUBT_OVERLAP) != 0) {
        item = review_add(&of->warnings, "The parts were computed softer than they are",
                          "/micro/modulus_reduction");
        review_explain(item, "They were pressed into each other in the jam, so that the outflow "
                             "may differ somewhat from that of hard parts.");
        snprintf(item->detail, sizeof item->detail,
                 "Parts overlapped by up to %.4g m, %.3g %% of a radius, more than %.3g %%: a "
                 "smaller modulus_reduction makes them harder.",
                 of->end.largest_overlap, 100.0 * of->end.overlap_share,
                 100.0 * advice_overlap_trusted);
    }
}

static void write_warnings(json_out *w, const member *m, const void *item)
{
    const summary_view *of = item;

    (void)m;
    review_write_texts(w, &of->warnings);
}

static void write_path(json_out *w, const member *m, const void *item)
{
    const summary_view *of = item;

    (void)m;
    json_out_string(w, frame_is_planar(of->begin.n_values) ? "planar" : "spatial");
}

static void write_digest(json_out *w, const member *m, const void *item)
{
    const summary_view *of = item;
    char digest[20];

    (void)m;
    snprintf(digest, sizeof digest, "%016" PRIx64, of->end.digest);
    json_out_string(w, digest);
}

static void write_figures(json_out *w, const member *m, const void *item)
{
    const summary_view *of = item;

    (void)m;
    key_figures_write(w, of->figures);
}

static bool has_figures(const void *item)
{
    const summary_view *of = item;

    return of->figures->n > 0;
}

static const member_kind member_figures = { .type = "#KeyFigures", .write = write_figures };
static const member_kind member_warnings = { .type = "[string]", .write = write_warnings };
static const member_kind member_path = { .type = "string", .write = write_path };
static const member_kind member_digest = { .type = "string", .write = write_digest };

static const char *const end_words[FRAME_END_REASON_COUNT + 1] = { "duration", "drained",
                                                                   "steady" };

static bool is_hardness_chosen(const void *item)
{
    const summary_view *of = item;

    return of->end.reduction > 0.0;
}

#define AT(place) offsetof(summary_view, place)
#define MACRO     (1U << RUN_MACRO)
#define MICRO     (1U << RUN_MICRO)
static const member summary_members[] = {
    MEMBER("model", enum, AT(model), "Which solver", .words = run_model_words),
    MEMBER("solver_version", string, AT(solver_version), "Version of the solver"),
    MEMBER("stopped", bool, AT(is_stopped), "It was stopped before its end"),
    MEMBER("end_reason", enum, AT(end.reason),
           "Why it ended: its duration, or what `until` in the scenario waited for",
           .words = end_words, .offset_if = AT(may_end_early)),
    MEMBER("steps", size, AT(end.n_steps), "Time steps"),
    MEMBER("path", path, 0, "Equations of motion: planar or spatial", .tags = MICRO),
    MEMBER("parts", size, AT(n_parts), "Parts at the start and those of feeds that entered",
           .tags = MICRO),
    MEMBER("closure", enum, AT(closure), "How packed cargo moved", .words = scenario_closure_words,
           .tags = MACRO),
    MEMBER("cells", size, AT(end.n_cells), "Cells of the grid", .tags = MACRO),
    MEMBER("cell_m", point, AT(grid.d1), "Edges of a cell along x and y, as fitted to the domain",
           .unit = "m, m"),
    MEMBER("step_s", number, AT(begin.dt), "Length of a time step", .unit = "s"),
    MEMBER("duration_s", number, AT(end.t), "Simulated time that was reached", .unit = "s"),
    MEMBER("wall_time_s", measure, AT(timing.wall_s), "Wall time spent solving", .unit = "s"),
    MEMBER("particle_steps_per_s", measure, AT(work_per_s),
           "Time steps times parts (those in the domain; without feeds, at the start) per second "
           "of wall time",
           .unit = "1/s", .tags = MICRO, .null = "not known"),
    MEMBER("cell_steps_per_s", measure, AT(work_per_s),
           "Cells times time steps per second of wall time", .unit = "1/s", .tags = MACRO,
           .null = "not known"),
    MEMBER("threads", size, AT(n_threads), "Threads used"),
    MEMBER("samples", size, AT(end.n_samples), "Samples of the curve"),
    MEMBER("snapshots", size, AT(end.n_snapshots), "Number of snapshots"),
    MEMBER("parts_start", number, AT(end.parts_start), "Parts in the domain at the start"),
    MEMBER("parts_entered", number, AT(end.parts_entered), "Parts of feeds that entered the domain",
           .offset_if = AT(is_fed)),
    MEMBER("parts_end", number, AT(end.parts_end), "Parts in the domain at the end"),
    MEMBER("parts_left", number, AT(n_left), "Parts that left the domain"),
    MEMBER("parts_fallen", number, AT(end.parts_fallen),
           "Parts that fell off the belts, which are not among those that left the domain; where "
           "some of the domain is under no belt",
           .offset_if = AT(may_drop)),
    MEMBER("largest_density", number, AT(end.peak), "At any time; 1 is close packing"),
    MEMBER("largest_overlap_m", number, AT(end.largest_overlap),
           "Largest overlap of two parts at any time", .unit = "m", .tags = MICRO),
    MEMBER("largest_overlap_share", number, AT(end.overlap_share),
           "Largest overlap divided by the smaller part's radius", .tags = MICRO),
    MEMBER("modulus_reduction", number, AT(end.reduction),
           "By which moduli were divided at the end, where the scenario says auto", .tags = MICRO,
           .applies = is_hardness_chosen),
    MEMBER("modulus_reduction_start", number, AT(end.reduction_start),
           "The same at the start; larger: parts were pressed harder than foreseen, and contacts "
           "made harder while the run went on",
           .tags = MICRO, .applies = is_hardness_chosen),
    MEMBER("contacts", size, AT(end.n_contacts), "Contacts at the end", .tags = MICRO),
    MEMBER("kinetic_energy_j", number, AT(end.kinetic_energy), "Of all parts at the end",
           .unit = "J", .tags = MICRO),
    MEMBER("digest", digest, 0, "Digest of the final state: the same for the same results"),
    MEMBER("packing_density_per_m2", number, AT(packing_density), "Parts in close packing",
           .unit = "1/m2"),
    MEMBER("key_figures", figures, 0,
           "Throughput, residence, queues, jams, gaps; missing in summaries of versions that did "
           "not say so",
           .applies = has_figures),
    MEMBER("verdicts", array, AT(verdicts.items),
           "What the run says, in sentences: everything_through, queue_at_inlet, inlet_limit, "
           "queue_grows, belt_fills or throughput of a belt that is fed, drained or not_drained of "
           "another, bridges or pauses, stalled, too_short, not_compared; missing in summaries of "
           "versions that did not say so",
           .table = &verdict_members, .offset_n = AT(verdicts.n), .limit = VERDICTS_MAX,
           .flags = MEMBER_OPTIONAL),
    MEMBER("warnings", warnings, 0, "Reasons to doubt the results"),
    MEMBER("warning_details", array, AT(warnings.items),
           "The same warnings, each with its parts; missing in summaries of versions that did not "
           "say so",
           .table = &review_warning_members, .offset_n = AT(warnings.n),
           .limit = REVIEW_WARNINGS_MAX, .flags = MEMBER_OPTIONAL),
    MEMBER("validity", object, AT(advice.validity),
           "Whether the model was compared for scenarios like this one; missing in summaries of "
           "versions that did not say so",
           .table = &review_validity_members, .flags = MEMBER_OPTIONAL),
    MEMBER("cached", described, 0, "The results were known from an earlier run", .type = "boolean",
           .flags = MEMBER_OPTIONAL),
    MEMBER("scenario", raw, AT(scenario), "What was solved, with every default filled in",
           .offset_n = AT(n_scenario), .type = "#ResolvedScenario"),
};
const member_table results_summary_members = { MEMBER_TABLE("Summary", summary_members),
                                               .choice = MEMBER_TAGGED };
#undef AT

static double work_per_s(run_model model, const frame_end *end, const results_timing *timing)
{
    const double cell_steps = (double)end->n_cells * (double)end->n_steps;

    return (model == RUN_MICRO ? end->part_steps : cell_steps) / timing->wall_s;
}

bf_status results_summary(run_model model, const char *scenario, size_t n_scenario,
                          const frame_begin *begin, const frame_end *end,
                          const key_figures *figures, const results_timing *timing, bf_buffer *out,
                          bf_error *err)
{
    size_t n_before = out->n;
    json_out w = json_out_to(out);
    scene s;

    BF_TRY(figures->n > 0 ? key_figures_check(figures, err) : BF_OK);
    BF_TRY(scenario_read_resolved(scenario, n_scenario, &s, err));
    summary_view *of = memory_alloc(1, sizeof *of);
    if (of == NULL) {
        scene_fini(&s);
        return bf_fail_memory(err);
    }
    of->model = model;
    of->solver_version = BELTFLOW_VERSION;
    of->begin = *begin;
    of->end = *end;
    of->timing = *timing;
    of->n_threads = timing->n_threads;
    of->is_stopped = end->stopped != 0;
    of->is_fed = s.n_feeds > 0;
    of->may_end_early = s.until != SCENE_UNTIL_DURATION;
    of->n_parts = begin->n_parts + (uint64_t)end->parts_entered;
    of->may_drop = s.may_drop;
    of->n_left = run_left(end->parts_start + end->parts_entered, end->parts_end, end->parts_fallen);
    of->work_per_s = work_per_s(model, end, timing);
    of->packing_density = scene_packing_density(&s);
    of->grid = scene_grid(&s);
    of->closure = s.macro.closure;
    of->figures = figures;
    of->scenario = scenario;
    of->n_scenario = n_scenario;
    bf_status status = advice_of(&s, model, &of->advice, err);
    const run_verdict_subject subject = { .scene = &s,
                                          .advice = &of->advice,
                                          .end = end,
                                          .values = figures->n > 0 ? figures->values : NULL };
    if (status == BF_OK)
        status = run_verdict_find(&subject, &of->verdicts, err);
    scene_fini(&s);
    if (status == BF_OK) {
        collect_warnings(of);
        members_write(&w, &results_summary_members, of);
        status = json_out_status(&w, err);
    }
    memory_free(of);
    if (status != BF_OK)
        buffer_truncate(out, n_before);
    return status;
}

bf_status results_summary_cached(const char *summary, size_t n_summary, const char *scenario,
                                 size_t n_scenario, bf_buffer *out, bf_error *err)
{
    // The last two members. Inside a string the quotes would be escaped, and no member of another
    // member has this name.
    static const char mark[] = ",\"cached\":true", last[] = ",\"scenario\":";
    const char *end = memmem(summary, n_summary, last, sizeof last - 1);
    size_t n_before = out->n;

    if (end == NULL)
        return bf_fail(err, BF_ECORRUPT, "", "a stored summary is damaged");
    size_t n = (size_t)(end - summary), n_mark = sizeof mark - 1;
    if (n >= n_mark && memcmp(end - n_mark, mark, n_mark) == 0)
        n -= n_mark;
    if (buffer_append(out, summary, n) == BF_OK && buffer_append(out, mark, n_mark) == BF_OK &&
        buffer_append(out, last, sizeof last - 1) == BF_OK &&
        buffer_append(out, scenario, n_scenario) == BF_OK && buffer_append(out, "}", 1) == BF_OK)
        return BF_OK;
    buffer_truncate(out, n_before);
    return bf_fail_memory(err);
}
