#include "tests/unit/core/helper_disk_state.h"

#include "core/base/check.h"
#include "core/micro/backend.h"
#include "tests/unit/core/helper_world.h"

#include <math.h>
#include <stdlib.h>

static void set_belt(scene_belt *belt, vec2 *corners, double x_min, double x_max, double v)
{
    corners[0] = (vec2){ x_min, 0.0 };
    corners[1] = (vec2){ x_max, 0.0 };
    corners[2] = (vec2){ x_max, 2.0 };
    corners[3] = (vec2){ x_min, 2.0 };
    *belt = (scene_belt){ .velocity = { v, 0.0 }, .n_points = 4, .polygon = corners };
}

static void set_kind(micro_kind *kind, double r)
{
    kind->shape = (scene_shape){ .type = SCENE_CYLINDER, .radius = r, .height = 0.008 };
    kind->material = (scene_material){ 210e9, 0.28 };
    kind->mass = 7850.0 * M_PI * r * r * 0.008;
    kind->spin_radius = 2.0 / 3.0 * r;
}

helper_disk_state *helper_disk_state_make(double v_west, double v_east)
{
    helper_disk_state *w = calloc(1, sizeof *w);

    BF_CHECK(w != NULL);
    w->def = micro_def_default();
    w->def.domain = (scene_rect){ 0.0, 2.0, 0.0, 2.0 };
    for (int k = 0; k < SCENE_SIDE_COUNT; k++)
        w->def.edges[k] = SCENE_EDGE_OUTFLOW;
    set_belt(&w->belts[0], w->west, 0.0, 1.0, v_west);
    set_belt(&w->belts[1], w->east, 1.0, 2.0, v_east);
    set_kind(&w->kinds[0], 0.012);
    set_kind(&w->kinds[1], 0.009);
    w->obstacle = (scene_obstacle){ .n_points = 2, .path = w->path, .thickness = 0.005 };
    w->def.n_belts = w->def.n_kinds = 2;
    w->def.belts = w->belts;
    w->def.obstacles = &w->obstacle;
    w->def.kinds = w->kinds;
    w->def.poses = w->poses;
    w->def.damping = 0.0;
    return w;
}

void helper_disk_state_add(helper_disk_state *w, double x, double y)
{
    BF_CHECK(w->def.n_parts < HELPER_DISK_STATE_PARTS);
    w->poses[w->def.n_parts++] = (scene_pose){ x, y, 0.0 };
}

void helper_disk_state_crowd(helper_disk_state *w, bool is_mixed)
{
    w->path[0] = (vec2){ 1.998, 0.1 };
    w->path[1] = (vec2){ 1.98, 0.6 };
    w->def.n_obstacles = 1;
    w->def.dt = is_mixed ? 2.5e-5 : 5e-5;
    for (int k = 0; k < 32 * 44; k++)
        helper_disk_state_add(w, 1.982 - 0.0237 * (k % 44), 0.11 + 0.0236 * (k / 44));
    for (size_t k = 0; is_mixed && k < w->def.n_parts; k++)
        w->part_kinds[k] = k % 7 == 0;
    w->def.part_kinds = is_mixed ? w->part_kinds : NULL;
    if (!is_mixed)
        w->def.n_kinds = 1;
}

void helper_disk_state_jam(helper_outflow *e, double angle_deg)
{
    const double spacing = 0.97 * 2.0 * 0.012;

    helper_outflow_example(e, angle_deg, 1e6);
    for (int k = 0; k < HELPER_OUTFLOW_PARTS; k++) {
        int row = k / 12, column = k % 12;
        double y = 0.11 + spacing * 0.5 * sqrt(3.0) * row;
        double lean = (y - e->path[0].y) / (e->path[1].y - e->path[0].y);
        double plate = e->path[0].x + lean * (e->path[1].x - e->path[0].x);
        e->poses[k] = (scene_pose){ plate - 0.013 - spacing * (column + 0.1 * (row % 2)), y, 0.0 };
    }
    e->def.dt = 5e-5;
}

disk_state *helper_disk_state_start(const micro_def *def)
{
    micro_def own = *def;
    micro_common *state = NULL;

    own.world = helper_world_of(def);
    BF_CHECK(micro__disk.create(&own, &state, NULL) == BF_OK);
    return (disk_state *)state;
}

void helper_disk_state_end(disk_state *s)
{
    micro__disk.destroy(s);
}

disk *helper_disk_state_row(disk_state *s, size_t number)
{
    return &s->now[s->slot_of[number]];
}

void helper_disk_state_push(disk_state *s, size_t k, double vx, double vy, double spin)
{
    disk *row = helper_disk_state_row(s, k);

    row->vx = vx;
    row->vy = vy;
    row->spin = spin;
}

void helper_disk_state_advance(disk_state *s, uint64_t n)
{
    BF_CHECK(micro__disk.advance(s, n, NULL) == BF_OK);
}
