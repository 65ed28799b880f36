#include "core/run/commands.h"

#include "core/base/memory.h"
#include "core/run/schedule.h"

#include <string.h>

commands commands_of(const scene *s, double dt)
{
    return (commands){ .scene = s, .dt = dt };
}

void commands_fini(commands *c)
{
    memory_free(c->items);
    *c = (commands){ .n = 0 };
}

static bool is_before(const command *a, const command *b)
{
    return a->step < b->step || (a->step == b->step && a->action < b->action);
}

static bf_status reserve(commands *c, uint64_t n, bf_error *err)
{
    if (n > COMMANDS_MAX)
        return bf_fail(err, BF_ELIMIT, "/actions",
                       "more than %d commands of photo eyes wait for their delay", COMMANDS_MAX);
    if (memory_reserve(&c->items, &c->capacity, (size_t)n, sizeof *c->items) != 0)
        return bf_fail(err, BF_ENOMEM, "", "no memory for %llu commands", (unsigned long long)n);
    return BF_OK;
}

bf_status commands_note(commands *c, size_t eye, uint32_t kind, bool is_blocked, uint64_t step,
                        bf_error *err)
{
    bf_status status;

    for (size_t k = 0; k < c->scene->n_actions; k++) {
        const scene_action *a = &c->scene->actions[k];
        if (a->eye != eye || a->kind != kind || a->when_blocked != is_blocked)
            continue;
        const command new = { step + schedule_steps_until(a->delay, c->dt), k };
        size_t at = c->n;
        if ((status = reserve(c, c->n + 1, err)) != BF_OK)
            return status;
        while (at > 0 && is_before(&new, &c->items[at - 1]))
            at--;
        memmove(&c->items[at + 1], &c->items[at], (c->n - at) * sizeof *c->items);
        c->items[at] = new;
        c->n++;
    }
    return BF_OK;
}

bool commands_take(commands *c, uint64_t step, size_t *ret_action)
{
    if (c->n == 0 || c->items[0].step > step)
        return false;
    *ret_action = (size_t)c->items[0].action;
    memmove(&c->items[0], &c->items[1], --c->n * sizeof *c->items);
    return true;
}

void commands_save(const commands *c, checkpoint_writer *w)
{
    const uint64_t n = c->n;

    checkpoint_write(w, &n, sizeof n);
    checkpoint_write(w, c->items, c->n * sizeof *c->items);
}

bf_status commands_load(commands *c, checkpoint_reader *r, bf_error *err)
{
    uint64_t n = 0;
    const bool has_count = checkpoint_read(r, &n, sizeof n) && n <= COMMANDS_MAX;
    bf_status status = has_count ? reserve(c, n, err) : BF_ECORRUPT;

    if (status == BF_OK && !checkpoint_read(r, c->items, (size_t)n * sizeof *c->items))
        status = BF_ECORRUPT;
    for (uint64_t k = 0; k < n && status == BF_OK; k++)
        status = c->items[k].action < c->scene->n_actions ? BF_OK : BF_ECORRUPT;
    if (status == BF_ECORRUPT)
        return bf_fail(err, BF_ECORRUPT, "", "the checkpoint is damaged");
    if (status == BF_OK)
        c->n = (size_t)n;
    return status;
}
