#include "tests/reference/schedule.h"

#include <math.h>

double schedule_integral(const scene_belt *belt, double t)
{
    const scene_speed_schedule *s = &belt->speed_schedule;
    double factor = 1.0, reached = 0.0, sum = 0.0;

    for (size_t k = 0; k <= s->n_times; k++) {
        // At the constant rate of the last target from `reached` on, until the next time.
        double until = k < s->n_times ? fmin(s->times[k], t) : t;
        double target = k > 0 ? s->factors[k - 1] : 1.0;
        double a = target > factor ? belt->acceleration : belt->deceleration;
        double rate =
            k == 1 && s->times[0] == 0.0 ? INFINITY : a / hypot(belt->velocity.x, belt->velocity.y);
        double time = until - reached, ramp = fmin(fabs(target - factor) / rate, time);
        double after = ramp < time ? target : factor + copysign(rate * ramp, target - factor);
        if (time <= 0.0)
            continue;
        sum += 0.5 * (factor + after) * ramp + after * (time - ramp);
        factor = after;
        reached = until;
    }
    return sum;
}

double schedule_mean(const scene_belt *belt, unsigned long n, double dt)
{
    const double from = (double)n * dt, to = (double)(n + 1) * dt;

    return (schedule_integral(belt, to) - schedule_integral(belt, from)) / (to - from);
}
