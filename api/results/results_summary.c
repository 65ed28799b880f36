#include "api/results/results.h"

#include "api/json/json_out.h"
#include "api/json/members.h"
#include "api/scenario/scenario_members.h"

#include <inttypes.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

// Above this density (1 is close packing) the macroscopic model is further from the microscopic one
// than it need be.
static const double density_trusted = 1.4;

// Parts that overlap by a larger share of their radius are too soft: the outflow depends on it.
static const double overlap_trusted = 0.05;

// The document was checked when it was accepted, so it is only read here.
static bf_status read_resolved(const char *json, size_t n, scene *ret_scene, bf_error *err)
{
    bf_faults faults = { 0 };
    json_in in = json_in_to(&faults);
    struct json_t *root = json_in_parse(&in, json, n);
    scene s;

    scene_init(&s);
    if (root != NULL)
        members_read(&in, root, &scenario_members, &s);
    json_in_free(root);
    bf_status status = json_in_status(&in, err);
    if (status == BF_OK)
        status = scene_resolve(&s, err);
    if (status != BF_OK) {
        scene_fini(&s);
        return status == BF_ENOMEM ? status
                                   : bf_fail(err, BF_ECORRUPT, "", "the scenario is damaged");
    }
    *ret_scene = s;
    return BF_OK;
}

static void warn(json_out *w, const char *format, ...) __attribute__((format(printf, 2, 3)));

static void warn(json_out *w, const char *format, ...)
{
    char text[BF_TEXT_SIZE];
    va_list args;

    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    json_out_string(w, text);
}

static void write_warnings(json_out *w, const scene *s, const frame_begin *begin,
                           const frame_end *end)
{
    bool is_macro = begin->model == RUN_MACRO;
    double positive = scene_step_positive(s);

    json_out_key(w, "warnings");
    json_out_array(w);
    if (end->stopped != 0)
        warn(w, "stopped on request at t = %.6g s of %.6g s", end->t, begin->duration);
    if (is_macro && end->peak > density_trusted)
        warn(w, "the largest density, %.4g, is above %.4g of close packing", end->peak,
             density_trusted);
    if (is_macro && begin->dt >= positive)
        warn(w, "the step, %.6g s, is not below %.6g s: densities may become negative", begin->dt,
             positive);
    if (end->overlap_share > overlap_trusted)
        warn(w,
             "parts overlapped by up to %.4g m, %.3g %% of a radius, more than %.3g %%: a smaller "
             "/micro/modulus_reduction makes them harder",
             end->largest_overlap, 100.0 * end->overlap_share, 100.0 * overlap_trusted);
    json_out_array_end(w);
}

// How much work it was, in the model's own measure.
static void write_work(json_out *w, const frame_begin *begin, const frame_end *end,
                       const results_timing *timing)
{
    bool has_parts = begin->n_values > 0;
    double n = has_parts ? (double)begin->n_parts : (double)end->n_cells;

    json_out_key_integer(w, "steps", (int64_t)end->n_steps);
    if (has_parts)
        json_out_key_string(w, "path",
                            begin->n_values == FRAME_VALUES_PLANAR ? "planar" : "spatial");
    json_out_key_integer(w, has_parts ? "parts" : "cells", (int64_t)n);
    json_out_key_number(w, "step_s", begin->dt);
    json_out_key_number(w, "duration_s", end->t);
    json_out_key_number(w, "wall_time_s", timing->wall_s);
    json_out_key_number(w, has_parts ? "particle_steps_per_s" : "cell_steps_per_s",
                        n * (double)end->n_steps / timing->wall_s);
}

static void write_figures(json_out *w, const frame_begin *begin, const frame_end *end,
                          const results_timing *timing)
{
    char digest[20];

    json_out_key_bool(w, "stopped", end->stopped != 0);
    write_work(w, begin, end, timing);
    json_out_key_integer(w, "threads", timing->n_threads);
    json_out_key_integer(w, "samples", (int64_t)end->n_samples);
    json_out_key_integer(w, "snapshots", (int64_t)end->n_snapshots);
    json_out_key_number(w, "parts_start", end->parts_start);
    json_out_key_number(w, "parts_end", end->parts_end);
    json_out_key_number(w, "parts_left", end->parts_start - end->parts_end);
    json_out_key_number(w, "largest_density", end->peak);
    if (begin->n_values > 0) {
        json_out_key_number(w, "largest_overlap_m", end->largest_overlap);
        json_out_key_number(w, "largest_overlap_share", end->overlap_share);
        json_out_key_integer(w, "contacts", (int64_t)end->n_contacts);
        json_out_key_number(w, "kinetic_energy_j", end->kinetic_energy);
    }
    snprintf(digest, sizeof digest, "%016" PRIx64, end->digest);
    json_out_key_string(w, "digest", digest);
}

bf_status results_summary(run_model model, const char *scenario, size_t n_scenario,
                          const frame_begin *begin, const frame_end *end,
                          const results_timing *timing, bf_buffer *out, bf_error *err)
{
    size_t n_before = out->n;
    json_out w = json_out_to(out);
    scene s;

    bf_status status = read_resolved(scenario, n_scenario, &s, err);
    if (status != BF_OK)
        return status;
    json_out_object(&w);
    json_out_key_string(&w, "model", run_model_words[model]);
    json_out_key_string(&w, "solver_version", BELTFLOW_VERSION);
    write_figures(&w, begin, end, timing);
    json_out_key_number(&w, "packing_density_per_m2", scene_packing_density(&s));
    write_warnings(&w, &s, begin, end);
    json_out_key(&w, "scenario");
    json_out_raw(&w, scenario, n_scenario);
    json_out_object_end(&w);
    scene_fini(&s);
    status = json_out_status(&w, err);
    if (status != BF_OK)
        buffer_truncate(out, n_before);
    return status;
}

bf_status results_summary_cached(const char *summary, size_t n_summary, const char *scenario,
                                 size_t n_scenario, bf_buffer *out, bf_error *err)
{
    // The last two members. Inside a string the quotes would be escaped, and no other member has
    // members.
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
    return bf_fail(err, BF_ENOMEM, "", "out of memory");
}
