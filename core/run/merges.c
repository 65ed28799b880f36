#include "core/run/merges.h"

#include "core/run/schedule.h"

#include <math.h>

merges merges_of(const scene *s, double dt)
{
    merges m = { .scene = s, .dt = dt };

    for (size_t k = 0; k < s->n_merges; k++)
        m.states[k].lane = s->merges[k].n_lanes - 1;
    return m;
}

// True if something stands, or would stand, in the beam.
static bool waits(const merges_eye *eye)
{
    return eye->is_broken && eye->is_blocked;
}

uint64_t merges_go_on(merges *m, size_t merge, const merges_eye *eyes, uint64_t step)
{
    const scene_merge *of = &m->scene->merges[merge];
    merges_state now = m->states[merge];
    const merges_eye *eye = &eyes[of->lanes[now.lane].eye];
    const uint64_t was_held = now.held;

    if (now.is_open != 0) {
        const bool is_full = (double)(eye->n_left - now.n_left) >= of->parts;
        const bool is_late =
            isfinite(of->time) && step - now.since >= schedule_steps_until(of->time, m->dt);
        if (is_full || is_late || !eye->is_blocked)
            now = (merges_state){ .lane = now.lane, .since = step };
    }
    // No release ended at t = 0.
    const bool may_open =
        now.is_open == 0 &&
        (now.since == 0 || step - now.since >= schedule_steps_until(of->gap, m->dt));
    for (size_t k = 1; k <= of->n_lanes && may_open && now.is_open == 0; k++) {
        const size_t lane =
            of->order == SCENE_MERGE_PRIORITY ? k - 1 : ((size_t)now.lane + k) % of->n_lanes;
        const merges_eye *at = &eyes[of->lanes[lane].eye];
        if (waits(at))
            now = (merges_state){ 1, lane, step, at->n_left, 0 };
    }
    now.held = 0;
    for (size_t k = 0; k < of->n_lanes; k++)
        if (waits(&eyes[of->lanes[k].eye]) && !(now.is_open != 0 && now.lane == k))
            now.held |= (uint64_t)1 << k;
    m->states[merge] = now;
    return now.held ^ was_held;
}

void merges_find_held(const merges *m, bool *ret_held)
{
    for (size_t k = 0; k < m->scene->n_belts; k++)
        ret_held[k] = false;
    for (size_t k = 0; k < m->scene->n_merges; k++)
        for (size_t i = 0; i < m->scene->merges[k].n_lanes; i++)
            ret_held[m->scene->merges[k].lanes[i].belt] = (m->states[k].held >> i & 1) != 0;
}

void merges_save(const merges *m, checkpoint_writer *w)
{
    checkpoint_write(w, m->states, m->scene->n_merges * sizeof *m->states);
}

bool merges_load(merges *m, checkpoint_reader *r)
{
    bool is_sound = checkpoint_read(r, m->states, m->scene->n_merges * sizeof *m->states);

    for (size_t k = 0; k < m->scene->n_merges; k++)
        is_sound = is_sound && m->states[k].lane < m->scene->merges[k].n_lanes;
    return is_sound;
}
