#include "core/scene/overlap_grid.h"

#include "core/base/memory.h"
#include "core/scene/mix.h"

#include <math.h>
#include <string.h>

#define NO_PART UINT32_MAX

bf_status overlap_grid_init(overlap_grid *ret_grid, const shape_footprint *footprints,
                            size_t n_kinds, const uint32_t *kinds, const scene_pose *poses,
                            size_t n, bf_error *err)
{
    overlap_grid c = { .footprints = footprints, .kinds = kinds, .poses = poses };

    for (size_t k = 0; k < n_kinds; k++)
        c.cell = fmax(c.cell, 2.0 * footprints[k].bounding_radius);
    c.n_buckets = 16;
    while (c.n_buckets < 2 * n)
        c.n_buckets *= 2;
    c.heads = memory_alloc(c.n_buckets, sizeof *c.heads);
    c.next = memory_alloc(n, sizeof *c.next);
    if (c.heads == NULL || c.next == NULL) {
        overlap_grid_fini(&c);
        return bf_fail(err, BF_ENOMEM, "/initial", "no memory for %zu parts", n);
    }
    memset(c.heads, 0xff, c.n_buckets * sizeof *c.heads);
    *ret_grid = c;
    return BF_OK;
}

void overlap_grid_fini(overlap_grid *c)
{
    if (c == NULL)
        return;
    memory_free(c->heads);
    memory_free(c->next);
    *c = (overlap_grid){ 0 };
}

static size_t find_bucket(const overlap_grid *c, int64_t column, int64_t row)
{
    uint64_t mixed = (uint64_t)column * UINT64_C(0x9e3779b97f4a7c15) ^
                     (uint64_t)row * UINT64_C(0xc2b2ae3d27d4eb4f);
    return (size_t)(mixed ^ mixed >> 32) & (c->n_buckets - 1);
}

static const shape_footprint *footprint_of(const overlap_grid *c, size_t k)
{
    return &c->footprints[mix_kind(c->kinds, k)];
}

bool overlap_grid_overlaps(const overlap_grid *c, size_t part, scene_pose pose, size_t *ret_other)
{
    const shape_footprint *own = footprint_of(c, part);
    int64_t column = (int64_t)floor(pose.x / c->cell), row = (int64_t)floor(pose.y / c->cell);

    for (int64_t i = column - 1; i <= column + 1; i++) {
        for (int64_t j = row - 1; j <= row + 1; j++) {
            uint32_t k = c->heads[find_bucket(c, i, j)];
            for (; k != NO_PART; k = c->next[k]) {
                if (shape_overlaps(own, pose, footprint_of(c, k), c->poses[k])) {
                    *ret_other = k;
                    return true;
                }
            }
        }
    }
    return false;
}

void overlap_grid_add(overlap_grid *c, size_t k)
{
    int64_t column = (int64_t)floor(c->poses[k].x / c->cell);
    int64_t row = (int64_t)floor(c->poses[k].y / c->cell);
    uint32_t *head = &c->heads[find_bucket(c, column, row)];

    c->next[k] = *head;
    *head = (uint32_t)k;
}
