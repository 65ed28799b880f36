#include "core/run/photo_eyes.h"

#include "core/run/run_priv.h"

photo_eyes photo_eyes_of(const scene *s, double dt)
{
    photo_eyes eyes = { .n = s->n_eyes };

    for (size_t k = 0; k < s->n_eyes; k++) {
        eyes.n_block[k] = run__steps_until(s->eyes[k].block_time, dt);
        eyes.n_clear[k] = run__steps_until(s->eyes[k].clear_time, dt);
    }
    return eyes;
}

bool photo_eyes_see(photo_eyes *eyes, size_t eye, uint64_t step, bool is_broken)
{
    photo_eye_state *state = &eyes->states[eye];
    const uint64_t n_needed = is_broken ? eyes->n_block[eye] : eyes->n_clear[eye];

    if (state->is_broken != is_broken) {
        state->is_broken = is_broken;
        state->since = step;
    }
    if (state->is_blocked == is_broken || step - state->since < n_needed)
        return false;
    state->is_blocked = is_broken;
    return true;
}

void photo_eyes_save(const photo_eyes *eyes, checkpoint_writer *w)
{
    checkpoint_write(w, eyes->states, eyes->n * sizeof *eyes->states);
}

bool photo_eyes_load(photo_eyes *eyes, checkpoint_reader *r)
{
    return checkpoint_read(r, eyes->states, eyes->n * sizeof *eyes->states);
}
