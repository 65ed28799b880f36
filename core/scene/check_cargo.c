#include "core/scene/check_priv.h"

#include "core/scene/shape.h"

#include <math.h>
#include <stdio.h>

/// Largest ratio of the disk about the part that reaches farthest to the smallest footprint: with
/// more, far too many small parts fit into one cell of the search for overlaps.
#define UNLIKE_MAX 1000.0

static const scene_check__rule kind_rules[] = {
    SCENE_CHECK__ABOVE_0("/mass_kg", scene_cargo, mass, 1e9),
    SCENE_CHECK__ABOVE_0("/material/young_modulus_pa", scene_cargo, material.young_modulus, 1e15),
    SCENE_CHECK__BELOW_HALF("/material/poisson_ratio", scene_cargo, material.poisson_ratio),
};

/// What only a kind of a mix says itself.
static const scene_check__rule mix_rules[] = {
    SCENE_CHECK__FROM("/spin_friction_radius_m", scene_cargo, spin_friction_radius, 0.0,
                      SCENE_LENGTH_MAX),
};

/// What says how many parts are of a kind.
static const scene_check__rule share_rule = SCENE_CHECK__ABOVE_0("/share", scene_cargo, share, 1e9);

/// The pointer of kind k: "/cargo", or "/cargo/<k>" in a mix.
static const char *point_at(const scene *s, size_t k, char *room, size_t size)
{
    if (!s->is_mix)
        return "/cargo";
    snprintf(room, size, "/cargo/%zu", k);
    return room;
}

void scene_check__cargo(const scene *s, bf_faults *faults)
{
    char room[BF_POINTER_SIZE];

    for (size_t k = 0; k < s->n_cargo; k++) {
        const scene_cargo *kind = &s->cargo[k];
        const char *pointer = point_at(s, k, room, sizeof room);
        scene_check__numbers(kind, pointer, kind_rules, sizeof kind_rules / sizeof *kind_rules,
                             faults);
        if (s->is_mix)
            scene_check__numbers(kind, pointer, mix_rules, sizeof mix_rules / sizeof *mix_rules,
                                 faults);
        if (s->micro.path == SCENE_PATH_PLANAR && kind->shape.type != SCENE_CYLINDER)
            faults_add(faults, "/micro/path", "planar is for cylinders; %s has another shape",
                       pointer);
    }
    if (s->cargo_seed >= UINT64_C(1) << 53)
        faults_add(faults, "/cargo_seed", "must be below 2^53");
}

void scene_check__shapes(const scene *s, bf_faults *faults)
{
    double reach = 0.0, area = INFINITY;
    size_t n_before = faults->n;
    char room[BF_POINTER_SIZE], at[2 * BF_POINTER_SIZE];

    for (size_t k = 0; k < s->n_cargo; k++) {
        const char *pointer = point_at(s, k, room, sizeof room);
        if (s->is_mix)
            scene_check__numbers(&s->cargo[k], pointer, &share_rule, 1, faults);
        snprintf(at, sizeof at, "%s/shape", pointer);
        shape_check(&s->cargo[k].shape, at, faults);
    }
    for (size_t k = 0; k < s->n_cargo && faults->n == n_before; k++) {
        shape_footprint f = shape_footprint_of(&s->cargo[k].shape);
        reach = fmax(reach, f.reach);
        area = fmin(area, f.area);
    }
    if (faults->n == n_before && s->n_cargo > 1 && M_PI * reach * reach > UNLIKE_MAX * area)
        faults_add_limit(faults, "/cargo",
                         "kinds are too unlike in size: the disk about the largest has %g times "
                         "the area of the smallest, the limit is %g",
                         M_PI * reach * reach / area, UNLIKE_MAX);
}
