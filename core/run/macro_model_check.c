#include "core/run/run_priv.h"

#include <math.h>

static void check_step(const scene *s, bf_faults *faults)
{
    double step = s->macro.step, stable = scene_step_stable(s);
    double n = ceil(s->duration / scene_macro_step(s));

    if (step > stable * (1.0 + RUN__STABLE_SLACK))
        faults_add(faults, "/macro/step_s",
                   "a step of %.10g s is unstable (CFL): the largest stable one is %.10g s", step,
                   stable);
    else if (s->duration < step)
        faults_add(faults, "/duration_s", "%.10g s are less than one step of %.10g s", s->duration,
                   step);
    else if (!(n <= SCENE_STEPS_MAX))
        faults_add_limit(faults, step > 0.0 ? "/macro/step_s" : "/duration_s",
                         "%.10g steps of the macroscopic model, the limit is %.10g", n,
                         SCENE_STEPS_MAX);
}

void run__check_macro(const scene *s, bf_faults *faults)
{
    double reach = ceil(4.0 / (sqrt(s->macro.mollifier) * s->macro.cell) * (1.0 - 1e-12));

    check_step(s, faults);
    if (!(reach <= SCENE_REACH_MAX))
        faults_add_limit(faults, "/macro/mollifier_per_m2",
                         "%.10g cells to reach over, the limit is %d", reach, SCENE_REACH_MAX);
}
