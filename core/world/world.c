#include "core/world/world.h"

#include "core/base/memory.h"

bf_status world_init(bf_world *ret_world, const scene *s, bf_error *err)
{
    bf_world w = { .drives = memory_alloc(s->n_obstacles, sizeof *w.drives) };
    bf_status status = w.drives != NULL
                           ? belt_speeds_init(&w.belts, s->n_sections, s->belts, err)
                           : bf_fail(err, BF_ENOMEM, "/obstacles", "no memory for drives");

    if (status == BF_OK)
        status = plate_motion_init(&w.plates, s->n_obstacles, s->obstacles, err);
    for (size_t k = 0; status == BF_OK && k < s->n_obstacles; k++)
        w.drives[k] = plate_drive_of(s, k);
    if (status != BF_OK)
        world_fini(&w);
    *ret_world = w;
    return status;
}

void world_fini(bf_world *w)
{
    belt_speeds_fini(&w->belts);
    plate_motion_fini(&w->plates);
    memory_free(w->drives);
    *w = (bf_world){ .drives = NULL };
}

void world_command(bf_world *w, const scene_action *action, double t)
{
    if (action->type == SCENE_ACTION_BELT)
        belt_speeds_command(&w->belts, action->target, t, action->value);
    if (action->type == SCENE_ACTION_TURN)
        plate_motion_command_turn(&w->plates, action->target, t, action->value, action->over);
    if (action->type == SCENE_ACTION_SHIFT)
        plate_motion_command_shift(&w->plates, action->target, t, action->shift, action->over);
    if (action->type == SCENE_ACTION_PRESENCE)
        plate_motion_command_presence(&w->plates, action->target, t, action->value != 0.0);
}

void world_save(const bf_world *w, checkpoint_writer *writer)
{
    belt_speeds_save(&w->belts, writer);
    plate_motion_save(&w->plates, writer);
}

bool world_load(bf_world *w, checkpoint_reader *r)
{
    return belt_speeds_load(&w->belts, r) && plate_motion_load(&w->plates, r);
}
