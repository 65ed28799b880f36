#include "core/advice/prediction.h"

#include "core/advice/prediction_load.h"
#include "core/macro/mollifier.h"
#include "core/run/micro_setup.h"
#include "core/scene/belt.h"
#include "core/scene/density.h"
#include "core/scene/mix.h"

#include <math.h>

const char *const prediction_kind_words[] = { "roe",
                                              "muscl",
                                              "congested",
                                              "planar_verlet",
                                              "planar_implicit",
                                              "spatial_verlet",
                                              "spatial_implicit",
                                              NULL };

/// Seconds for each amount. tests/bench/prediction.py fits them, and says how far off predictions are.
static const double costs[PREDICTION_KIND_COUNT][PREDICTION_TERM_COUNT] = {
    [PREDICTION_ROE] = { [PREDICTION_ROW_STEPS] = 2.80e-08,
                         [PREDICTION_SWEPT] = 3.21e-10,
                         [PREDICTION_VARIED] = 4.21e-09,
                         [PREDICTION_DISPERSED] = 3.43e-10,
                         [PREDICTION_RECORDED] = 9.85e-10,
                         [PREDICTION_SAMPLE_CELLS] = 1.73e-08,
                         [PREDICTION_TRACER_STEPS] = 5.64e-08 },
    [PREDICTION_MUSCL] = { [PREDICTION_ROW_STEPS] = 6.29e-08,
                           [PREDICTION_SWEPT] = 5.81e-10,
                           [PREDICTION_VARIED] = 4.27e-09,
                           [PREDICTION_DISPERSED] = 2.59e-10,
                           [PREDICTION_RECORDED] = 1.10e-09,
                           [PREDICTION_SAMPLE_CELLS] = 2.13e-08,
                           [PREDICTION_TRACER_STEPS] = 4.76e-08 },
    [PREDICTION_CONGESTED] = { [PREDICTION_RUN] = 2.66e-03,
                               [PREDICTION_STEPS] = 2.16e-06,
                               [PREDICTION_ROW_STEPS] = 8.94e-08,
                               [PREDICTION_CELL_STEPS] = 1.58e-09,
                               [PREDICTION_COVERED_STEPS] = 1.05e-09,
                               [PREDICTION_RELAXED] = 1.13e-09,
                               [PREDICTION_COUPLED] = 2.00e-09,
                               [PREDICTION_FIELD_CELLS] = 3.70e-08,
                               [PREDICTION_SAMPLE_CELLS] = 1.04e-08,
                               [PREDICTION_TRACER_STEPS] = 7.43e-08,
                               [PREDICTION_KIND_STEPS] = 1.22e-08 },
    [PREDICTION_PLANAR_VERLET] = { [PREDICTION_STEPS] = 1.25e-07,
                                   [PREDICTION_SAMPLE_PARTS] = 5.05e-07,
                                   [PREDICTION_PART_STEPS] = 2.61e-09,
                                   [PREDICTION_LISTED_PAIRS] = 6.42e-06,
                                   [PREDICTION_PAIR_STEPS] = 9.95e-09 },
    [PREDICTION_PLANAR_IMPLICIT] = { [PREDICTION_SNAPSHOT_CELLS] = 2.82e-09,
                                     [PREDICTION_STEPS] = 1.23e-06,
                                     [PREDICTION_SPREAD_CELLS] = 1.28e-09,
                                     [PREDICTION_SAMPLE_PARTS] = 1.36e-07,
                                     [PREDICTION_PART_STEPS] = 3.41e-08,
                                     [PREDICTION_LISTED_PAIRS] = 9.94e-07,
                                     [PREDICTION_PAIR_STEPS] = 2.08e-08 },
    [PREDICTION_SPATIAL_VERLET] = { [PREDICTION_SNAPSHOT_CELLS] = 3.66e-07,
                                    [PREDICTION_STEPS] = 6.02e-07,
                                    [PREDICTION_PART_STEPS] = 1.43e-07,
                                    [PREDICTION_ROUND_STEPS] = 3.85e-08,
                                    [PREDICTION_LISTED_PAIRS] = 4.04e-04,
                                    [PREDICTION_PAIR_STEPS] = 2.21e-07 },
    [PREDICTION_SPATIAL_IMPLICIT] = { [PREDICTION_STEPS] = 4.44e-06,
                                      [PREDICTION_SPREAD_CELLS] = 1.58e-09,
                                      [PREDICTION_PART_STEPS] = 2.10e-07,
                                      [PREDICTION_ROUND_STEPS] = 5.89e-07,
                                      [PREDICTION_LISTED_PAIRS] = 1.01e-05,
                                      [PREDICTION_PAIR_STEPS] = 6.17e-07 },
};

// What recording the velocity of a cell whose I is made costs, by that of others.
static const double dispersed_cost = 8.0;

static prediction_kind kind_of_micro(const micro_def *def)
{
    const bool is_implicit = def->integrator == MICRO_IMPLICIT;

    if (micro_def_is_planar(def))
        return is_implicit ? PREDICTION_PLANAR_IMPLICIT : PREDICTION_PLANAR_VERLET;
    return is_implicit ? PREDICTION_SPATIAL_IMPLICIT : PREDICTION_SPATIAL_VERLET;
}

// The fraction of the parts that are cylinders.
static double round_fraction(const scene *s)
{
    const size_t of = 1000;
    size_t counts[SCENE_KINDS_MAX], n_round = 0;

    mix_count(s, of, counts);
    for (size_t k = 0; k < s->n_cargo; k++)
        n_round += s->cargo[k].shape.type == SCENE_CYLINDER ? counts[k] : 0;
    return (double)n_round / (double)of;
}

static double largest_belt_speed(const scene *s)
{
    double largest = 0.0;

    for (size_t k = 0; k < s->n_sections; k++)
        largest = fmax(largest, belt_largest_speed(&s->belts[k]));
    return largest;
}

static void set_macro(const scene *s, const prediction_load *load, prediction_work *work)
{
    const bf_grid grid = scene_grid(s);
    const double steps = load->time / scene_macro_step(s);
    const double cells = steps / (grid.d1 * grid.d2) / load->time;
    double *amounts = work->amounts;

    work->kind = s->macro.closure == SCENE_CONGESTED     ? PREDICTION_CONGESTED
                 : s->macro.scheme == SCENE_SCHEME_MUSCL ? PREDICTION_MUSCL
                                                         : PREDICTION_ROE;
    amounts[PREDICTION_STEPS] = steps;
    amounts[PREDICTION_ROW_STEPS] = (double)grid.n2 * steps;
    amounts[PREDICTION_CELL_STEPS] = (double)grid_cells(&grid) * steps;
    amounts[belt_are_forward(s->n_sections, s->belts) ? PREDICTION_RELAXED : PREDICTION_COUPLED] =
        work->kind == PREDICTION_CONGESTED ? load->relaxed : 0.0;
    amounts[PREDICTION_FIELD_CELLS] = load->fields * (double)grid_cells(&grid);
    if (s->n_feeds > 0)
        amounts[PREDICTION_SAMPLE_CELLS] =
            load->area / (grid.d1 * grid.d2) * scene_samples(s) / s->duration;
    amounts[PREDICTION_TRACER_STEPS] = load->tracers / load->time * steps;
    if (scene_tells_kinds(s))
        amounts[PREDICTION_KIND_STEPS] =
            (double)s->n_cargo * (load->area + load->saturated_area) * cells;
    if (work->kind == PREDICTION_CONGESTED)
        amounts[PREDICTION_COVERED_STEPS] = load->area * cells;
    amounts[PREDICTION_SWEPT] = load->swept;
    amounts[PREDICTION_VARIED] = load->varied;
    amounts[PREDICTION_DISPERSED] =
        load->dispersed * mollifier_reach(s->macro.mollifier, scene_cell_edge(s));
    if (work->kind != PREDICTION_CONGESTED && s->n_feeds > 0)
        amounts[PREDICTION_RECORDED] =
            amounts[PREDICTION_CELL_STEPS] + dispersed_cost * load->dispersed;
}

static bf_status set_micro(const scene *s, const prediction_load *load, prediction_work *work,
                           bf_error *err)
{
    const bf_grid grid = scene_grid(s);
    micro_setup setup;
    double *amounts = work->amounts;

    const bf_status status = micro_setup_init(s, NULL, 1, &setup, err);
    if (status != BF_OK)
        return status;
    const double per_s = 1.0 / setup.def.dt;
    const int iterations = micro_iterations(&setup.def);
    const double times = iterations > 0 ? iterations : 1.0;
    work->kind = kind_of_micro(&setup.def);
    micro_setup_fini(&setup);
    amounts[PREDICTION_STEPS] = load->time * per_s;
    amounts[PREDICTION_SPREAD_CELLS] =
        load->parts * scene_snapshots(s) / s->duration *
        density_cells(s->macro.initial_mollifier, grid.d1 * grid.d2, (double)grid_cells(&grid));
    amounts[PREDICTION_SAMPLE_PARTS] = load->parts * scene_samples(s) / s->duration;
    amounts[PREDICTION_PART_STEPS] = load->parts * per_s;
    amounts[PREDICTION_ROUND_STEPS] =
        work->kind >= PREDICTION_SPATIAL_VERLET ? round_fraction(s) * load->parts * per_s : 0.0;
    amounts[PREDICTION_PAIR_STEPS] = load->pairs * per_s * times;
    amounts[PREDICTION_LISTED_PAIRS] =
        load->pairs * largest_belt_speed(s) / sqrt(scene_mean_footprint(s) / M_PI);
    return BF_OK;
}

bf_status prediction_work_of(const scene *s, run_model model, prediction_work *ret_work,
                             bf_error *err)
{
    prediction_load load;

    bf_status status = prediction_load_of(s, model, &load, err);
    if (status != BF_OK)
        return status;
    *ret_work = (prediction_work){ .kind = PREDICTION_KIND_COUNT };
    // What depends on the grid; a snapshot of either model has one.
    const bf_grid grid = scene_grid(s);
    const double n_cells = (double)grid_cells(&grid);
    const double n_snapshots = scene_snapshots(s) * load.time / s->duration;
    ret_work->amounts[PREDICTION_RUN] = 1.0;
    ret_work->amounts[PREDICTION_CELLS] = n_cells;
    ret_work->amounts[PREDICTION_SNAPSHOT_CELLS] = n_cells * n_snapshots;
    if (model == RUN_MICRO)
        return set_micro(s, &load, ret_work, err);
    set_macro(s, &load, ret_work);
    return BF_OK;
}

void prediction_seconds_of_terms(const prediction_work *work, const prediction_speed *speed,
                                 double *ret_seconds)
{
    for (size_t i = 0; i < PREDICTION_TERM_COUNT; i++)
        ret_seconds[i] = speed->factors[work->kind] * costs[work->kind][i] *
                         exp(speed->corrections[work->kind][i]) * work->amounts[i];
}

double prediction_seconds(const prediction_work *work, const prediction_speed *speed)
{
    double terms[PREDICTION_TERM_COUNT], seconds = 0.0;

    prediction_seconds_of_terms(work, speed, terms);
    for (size_t i = 0; i < PREDICTION_TERM_COUNT; i++)
        seconds += terms[i];
    return seconds;
}
