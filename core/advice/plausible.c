#include "core/advice/plausible.h"

#include "core/observe/columns.h"
#include "core/run/schedule.h"

#include <math.h>
#include <string.h>

static bool is_same_grid(const bf_grid *a, const bf_grid *b)
{
    return a->n1 == b->n1 && a->n2 == b->n2 && a->lower1 == b->lower1 && a->lower2 == b->lower2 &&
           a->d1 == b->d1 && a->d2 == b->d2;
}

// A step that the microscopic model chooses itself is any.
static bool is_step(const scene *s, run_model model, double dt)
{
    if (!isfinite(dt) || dt <= 0.0)
        return false;
    if (model == RUN_MACRO)
        return dt == scene_macro_step(s);
    return !(s->micro.step > 0.0) || dt == s->micro.step;
}

static bool is_begin(const scene *s, run_model model, const frame_begin *b)
{
    const bf_grid grid = scene_grid(s);

    return b->model == (uint32_t)model && b->n_columns == columns_count(s) &&
           is_step(s, model, b->dt) && b->n_steps == schedule_steps_until(s->duration, b->dt) &&
           b->duration == (double)b->n_steps * b->dt && is_same_grid(&b->grid, &grid) &&
           (b->n_values == 0) == (model == RUN_MACRO) && b->definition == run_definition(s, model);
}

bf_status plausible_begin(const scene *s, run_model model, const frame_begin *begin, bf_error *err)
{
    return is_begin(s, model, begin)
               ? BF_OK
               : bf_fail(err, BF_ECORRUPT, "", "what was begun is not the run of this scenario");
}

static frame_end_reason reason_of(const scene *s)
{
    return s->until == SCENE_UNTIL_DRAINED  ? FRAME_END_DRAINED
           : s->until == SCENE_UNTIL_STEADY ? FRAME_END_STEADY
                                            : FRAME_END_DURATION;
}

// Before the last step a run is over only for the reason that its scenario has.
static bool is_last_step(const scene *s, const frame_begin *b, const frame_end *end)
{
    const bool is_early = end->n_steps < b->n_steps;

    if (end->stopped != 0 || end->n_steps > b->n_steps || end->t != (double)end->n_steps * b->dt)
        return false;
    return end->reason == (uint32_t)reason_of(s) ? !is_early || end->reason != FRAME_END_DURATION
                                                 : !is_early && end->reason == FRAME_END_DURATION;
}

// Results of a kind of a run with this last step, at which one is taken, too.
static uint64_t count(const scene *s, schedule_of of, uint64_t last, double dt)
{
    uint64_t n = 1, step = 0;

    for (uint64_t next = schedule_next(&s->output, of, 0, dt); next <= last; n++) {
        step = next;
        next = schedule_next(&s->output, of, step, dt);
    }
    return n + (step < last);
}

bf_status plausible_end(const scene *s, run_model model, const frame_begin *begin,
                        const frame_end *end, bf_error *err)
{
    bf_status status = plausible_begin(s, model, begin, err);

    if (status != BF_OK)
        return status;
    if (!is_last_step(s, begin, end))
        return bf_fail(err, BF_ECORRUPT, "", "the run cannot be over after %llu of %llu steps",
                       (unsigned long long)end->n_steps, (unsigned long long)begin->n_steps);
    const uint64_t n_samples = count(s, SCHEDULE_CURVE, end->n_steps, begin->dt);
    const uint64_t n_snapshots = count(s, SCHEDULE_SNAPSHOT, end->n_steps, begin->dt);
    if (end->n_samples != n_samples || end->n_snapshots != n_snapshots ||
        end->n_cells != grid_cells(&begin->grid))
        return bf_fail(err, BF_ECORRUPT, "",
                       "the run has %llu samples and %llu snapshots, not %llu and %llu",
                       (unsigned long long)n_samples, (unsigned long long)n_snapshots,
                       (unsigned long long)end->n_samples, (unsigned long long)end->n_snapshots);
    return BF_OK;
}
