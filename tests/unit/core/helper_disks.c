#include "tests/unit/core/helper_disks.h"

#include "core/base/check.h"
#include "tests/unit/core/helper_world.h"

#include <math.h>
#include <stdlib.h>

static micro_kind make_kind(double radius)
{
    return (micro_kind){ .shape = { .type = SCENE_CYLINDER, .radius = radius, .height = 0.008 },
                         .material = { 210e9, 0.28 },
                         .mass = 7850.0 * M_PI * radius * radius * 0.008,
                         .spin_radius = 2.0 / 3.0 * radius };
}

helper_disks *helper_disks_make(double length, double width, double speed)
{
    helper_disks *d = calloc(1, sizeof *d);

    BF_CHECK(d != NULL);
    d->def = micro_def_default();
    d->def.domain = (scene_rect){ 0.0, length, 0.0, width };
    d->belts[0].velocity = (vec2){ speed, 0.0 };
    d->def.n_belts = 1;
    d->def.belts = d->belts;
    d->kinds[0] = make_kind(0.012);
    d->kinds[1] = make_kind(0.009);
    d->kinds[2] = make_kind(0.015);
    d->def.n_kinds = 1;
    d->def.kinds = d->kinds;
    d->def.poses = d->poses;
    return d;
}

helper_disks *helper_disks_make_bare(void)
{
    helper_disks *d = helper_disks_make(1.0, 1.0, 0.0);

    d->def.n_belts = 0;
    d->def.damping = 0.0;
    return d;
}

void helper_disks_free(helper_disks *d)
{
    free(d);
}

void helper_disks_add(helper_disks *d, double x, double y)
{
    BF_CHECK(d->def.n_parts < HELPER_DISKS_MAX);
    d->poses[d->def.n_parts++] = (scene_pose){ x, y, 0.0 };
}

static double spread_by(double spread)
{
    return spread * (2.0 * rand() / RAND_MAX - 1.0);
}

void helper_disks_fill(helper_disks *d, int columns, int rows, double x, double y, double spacing,
                       double spread)
{
    srand(7);
    for (int row = 0; row < rows; row++)
        for (int column = 0; column < columns; column++)
            helper_disks_add(d, x + column * spacing + spread_by(spread),
                             y + row * spacing + spread_by(spread));
}

void helper_disks_block(helper_disks *d, size_t n, double thickness)
{
    d->obstacle = (scene_obstacle){ .n_points = n, .path = d->path, .thickness = thickness };
    d->def.n_obstacles = 1;
    d->def.obstacles = &d->obstacle;
}

micro_solver *helper_disks_start(const helper_disks *d)
{
    micro_def own = d->def;
    micro_solver *s = NULL;

    own.world = helper_world_of(&own);
    BF_CHECK(micro_create(&own, &s, NULL) == BF_OK);
    return s;
}

void helper_disks_advance(micro_solver *s, uint64_t n)
{
    BF_CHECK(micro_advance(s, n, NULL) == BF_OK);
}
