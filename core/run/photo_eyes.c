#include "core/run/photo_eyes.h"

#include "core/base/memory.h"
#include "core/run/schedule.h"

photo_eyes photo_eyes_of(const scene *s, double dt)
{
    photo_eyes eyes = { .n = s->n_eyes };

    for (size_t k = 0; k < s->n_eyes; k++) {
        eyes.n_block[k] = schedule_steps_until(s->eyes[k].block_time, dt);
        eyes.n_clear[k] = schedule_steps_until(s->eyes[k].clear_time, dt);
    }
    for (size_t k = 0; k < s->n_actions; k++)
        if (s->actions[k].kind != SCENE_KIND_ANY)
            eyes.tells_kinds[s->actions[k].eye] = true;
    return eyes;
}

void photo_eyes_fini(photo_eyes *eyes)
{
    for (size_t k = 0; k < eyes->n; k++)
        memory_free(eyes->parts[k].items);
}

// Tells a state whether the beam is broken. True: it changed.
static bool see(const photo_eyes *eyes, size_t eye, photo_eye_state *state, uint64_t step,
                bool is_broken)
{
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

bool photo_eyes_see(photo_eyes *eyes, size_t eye, uint64_t step, bool is_broken)
{
    return see(eyes, eye, &eyes->states[eye], step, is_broken);
}

static bf_status reserve(photo_eye_parts *known, size_t n, bf_error *err)
{
    if (memory_reserve(&known->items, &known->n_max, n, sizeof *known->items) == 0)
        return BF_OK;
    return bf_fail(err, BF_ENOMEM, "", "no memory for %zu parts at a photo eye", n);
}

bf_status photo_eyes_see_parts(photo_eyes *eyes, size_t eye, uint64_t step, size_t n,
                               const photo_eye_part *parts, bf_error *err)
{
    photo_eye_parts *known = &eyes->parts[eye];
    size_t n_kept = 0;

    // What is clear and does not break the beam is forgotten; so is what came and went within its block_time.
    for (size_t k = 0; k < known->n; k++)
        if (known->items[k].state.is_broken != 0 || known->items[k].state.is_blocked != 0)
            known->items[n_kept++] = known->items[k];
    known->n = n_kept;
    for (size_t i = 0; i < n; i++) {
        bool is_known = false;
        for (size_t k = 0; k < n_kept && !is_known; k++)
            is_known = known->items[k].part.id == parts[i].id;
        if (is_known)
            continue;
        const bf_status status = reserve(known, known->n + 1, err);
        if (status != BF_OK)
            return status;
        known->items[known->n++] = (photo_eye_known){ .part = parts[i] };
    }
    for (size_t k = 0; k < known->n; k++) {
        photo_eye_known *item = &known->items[k];
        bool is_broken = false;
        for (size_t i = 0; i < n && !is_broken; i++)
            is_broken = parts[i].id == item->part.id;
        item->is_new_state = see(eyes, eye, &item->state, step, is_broken);
    }
    return BF_OK;
}

void photo_eyes_save(const photo_eyes *eyes, checkpoint_writer *w)
{
    checkpoint_write(w, eyes->states, eyes->n * sizeof *eyes->states);
    for (size_t k = 0; k < eyes->n; k++) {
        const uint64_t n = eyes->parts[k].n;
        if (!eyes->tells_kinds[k])
            continue;
        checkpoint_write(w, &n, sizeof n);
        checkpoint_write(w, eyes->parts[k].items, (size_t)n * sizeof *eyes->parts[k].items);
    }
}

bf_status photo_eyes_load(photo_eyes *eyes, checkpoint_reader *r, bf_error *err)
{
    bool is_read = checkpoint_read(r, eyes->states, eyes->n * sizeof *eyes->states);

    for (size_t k = 0; k < eyes->n && is_read; k++) {
        photo_eye_parts *known = &eyes->parts[k];
        uint64_t n = 0;
        if (!eyes->tells_kinds[k])
            continue;
        is_read = checkpoint_read(r, &n, sizeof n) && n <= r->n_left / sizeof *known->items;
        const bf_status status = is_read ? reserve(known, (size_t)n, err) : BF_OK;
        if (status != BF_OK)
            return status;
        is_read = is_read && checkpoint_read(r, known->items, (size_t)n * sizeof *known->items);
        known->n = is_read ? (size_t)n : 0;
    }
    return is_read ? BF_OK : bf_fail(err, BF_ECORRUPT, "", "the checkpoint is damaged");
}
