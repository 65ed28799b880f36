#include "core/micro/drives.h"

#include "core/base/memory.h"
#include "core/micro/implicit_step.h"

#include <math.h>
#include <string.h>

static const double finely = 0.01; // of the smallest radius, between two measurements
static const double window = 0.1;  // same, in all that count

bf_status drives_init(drives *d, const micro_def *def, bf_error *err)
{
    size_t fastest;
    const double radius = implicit_step_radius(def);
    const double speed = micro__plate_speed(def, &fastest);

    *d = (drives){ .world = micro__world(def), .dt = def->dt };
    if (!d->world->plates.is_any)
        return BF_OK;
    d->n = def->n_obstacles;
    const double steps = finely * radius / (speed * def->dt);
    d->n_steps = (uint64_t)fmax(fmin(floor(steps), DRIVES_STEPS_MAX), 1.0);
    const double measured = window * radius / (speed * def->dt * (double)d->n_steps);
    d->window = (size_t)fmax(fmin(floor(measured), DRIVES_WINDOW), 1.0);
    d->recent = memory_alloc(d->n, sizeof *d->recent);
    if (d->recent != NULL)
        return BF_OK;
    d->n = 0;
    return bf_fail(err, BF_ENOMEM, "/obstacles", "no memory for drives of obstacles");
}

void drives_fini(drives *d)
{
    memory_free(d->recent);
    *d = (drives){ .n = 0 };
}

uint64_t drives_steps_until(const drives *d, uint64_t steps, uint64_t n)
{
    const uint64_t left = d->n > 0 ? d->n_steps - steps % d->n_steps : n;

    return left < n ? left : n;
}

// The one nearer to zero; 0 if they differ in sign.
static double least_of(double a, double b)
{
    return a * b <= 0.0 ? 0.0 : copysign(fmin(fabs(a), fabs(b)), a);
}

// Takes a measurement; returns the load that lasted.
static plate_load add_measurement(drives *d, size_t obstacle, plate_load measured)
{
    plate_load *recent = d->recent[obstacle], least = measured;

    memmove(recent + 1, recent, (DRIVES_WINDOW - 1) * sizeof *recent);
    recent[0] = measured;
    for (size_t k = 1; k < d->window; k++)
        least = (plate_load){ .torque = least_of(least.torque, recent[k].torque),
                              .force = least_of(least.force, recent[k].force),
                              .resultant = { least_of(least.resultant.x, recent[k].resultant.x),
                                             least_of(least.resultant.y, recent[k].resultant.y) } };
    return least;
}

void drives_follow(drives *d, const micro_backend *backend, micro_common *state)
{
    const double t = (double)state->steps * d->dt;
    const double until = (double)(state->steps + d->n_steps) * d->dt;

    if (d->n == 0 || state->steps % d->n_steps != 0)
        return;
    for (size_t k = 0; k < d->n; k++) {
        if (!plate_drive_is_needed(&d->world->plates, k, t, until)) {
            memset(d->recent[k], 0, sizeof d->recent[k]);
            continue;
        }
        const plate_load load = add_measurement(d, k, backend->load_on(state, k));
        plate_drive_follow(&d->world->plates, k, &d->world->drives[k], &load, t, until);
    }
}

void drives_save(const drives *d, checkpoint_writer *w)
{
    checkpoint_write(w, d->recent, d->n * sizeof *d->recent);
}

bool drives_load(drives *d, checkpoint_reader *r)
{
    bool is_sound = checkpoint_read(r, d->recent, d->n * sizeof *d->recent);

    for (size_t k = 0; k < d->n && is_sound; k++)
        for (size_t m = 0; m < DRIVES_WINDOW; m++)
            is_sound = is_sound && isfinite(d->recent[k][m].torque) &&
                       isfinite(d->recent[k][m].force) && isfinite(d->recent[k][m].resultant.x) &&
                       isfinite(d->recent[k][m].resultant.y);
    return is_sound;
}
