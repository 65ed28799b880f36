#include "tests/unit/core/helper_world.h"

#include "core/base/check.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// Kept, so that tools that look for leaks find them.
typedef struct kept {
    bf_world world;
    scene_obstacle *obstacles;
    struct kept *next;
} kept;

bf_world *helper_world(size_t n_belts, const scene_belt *belts, size_t n_obstacles,
                       const scene_obstacle *obstacles)
{
    static kept *all;
    kept *new = calloc(1, sizeof *new);
    scene_obstacle *own = calloc(n_obstacles + 1, sizeof *own);
    scene s = { .n_belts = n_belts,
                .n_sections = n_belts,
                .belts = (scene_belt *)belts,
                .n_obstacles = n_obstacles,
                .obstacles = own };

    BF_CHECK(new != NULL &&own != NULL);
    for (size_t k = 0; k < n_obstacles; k++) {
        own[k] = obstacles[k];
        if (own[k].force_limit == 0.0)
            own[k].force_limit = INFINITY;
    }
    BF_CHECK(world_init(&new->world, &s, NULL) == BF_OK);
    new->obstacles = own;
    new->next = all;
    all = new;
    return &new->world;
}

bf_world *helper_world_of(const micro_def *def)
{
    return def->world != NULL
               ? def->world
               : helper_world(def->n_belts, def->belts, def->n_obstacles, def->obstacles);
}

void helper_world_turn(bf_world *w, double t, double angle, double over)
{
    const scene_action turn = { .type = SCENE_ACTION_TURN, .value = angle, .over = over };

    world_command(w, &turn, t);
}

void helper_world_shift(bf_world *w, double t, vec2 to, double over)
{
    const scene_action shift = { .type = SCENE_ACTION_SHIFT, .shift = to, .over = over };

    world_command(w, &shift, t);
}

void helper_world_presence(bf_world *w, double t, bool is_present)
{
    const scene_action presence = { .type = SCENE_ACTION_PRESENCE, .value = is_present };

    world_command(w, &presence, t);
}

void helper_world_copy(const bf_world *from, bf_world *to)
{
    bf_buffer saved = { 0 };
    checkpoint_writer w;
    checkpoint_reader r;

    checkpoint_begin(&w, &saved, CHECKPOINT_RUN, 0);
    world_save(from, &w);
    BF_CHECK(checkpoint_end(&w, NULL) == BF_OK);
    BF_CHECK(checkpoint_open(&r, saved.bytes, saved.n, CHECKPOINT_RUN, 0, NULL) == BF_OK);
    BF_CHECK(world_load(to, &r) && r.n_left == 0);
    buffer_fini(&saved);
}
