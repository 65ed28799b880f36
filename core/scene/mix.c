#include "core/scene/mix.h"

#include "core/base/memory.h"
#include "core/base/random.h"

#include <math.h>

void mix_count(const scene *s, size_t n, size_t ret_counts[SCENE_KINDS_MAX])
{
    double sum = 0.0, remainders[SCENE_KINDS_MAX];
    size_t left = n;

    for (size_t k = 0; k < s->n_cargo; k++)
        sum += s->cargo[k].share;
    for (size_t k = 0; k < s->n_cargo; k++) {
        double quota = fmin((double)n * (s->cargo[k].share / sum), (double)left);
        ret_counts[k] = (size_t)quota;
        remainders[k] = quota - floor(quota);
        left -= ret_counts[k];
    }
    for (; left > 0; left--) {
        size_t most = 0;
        for (size_t k = 1; k < s->n_cargo; k++)
            most = remainders[k] > remainders[most] ? k : most;
        ret_counts[most]++;
        remainders[most] -= 1.0;
    }
}

bf_status mix_draw(const scene *s, size_t n, uint32_t **ret_kinds, bf_error *err)
{
    size_t counts[SCENE_KINDS_MAX], at = 0;

    if (s->n_cargo == 1) {
        *ret_kinds = NULL;
        return BF_OK;
    }
    uint32_t *kinds = memory_alloc(n, sizeof *kinds);
    if (kinds == NULL)
        return bf_fail(err, BF_ENOMEM, "/initial", "no memory for %zu parts", n);
    mix_count(s, n, counts);
    for (uint32_t kind = 0; kind < s->n_cargo; kind++) {
        for (size_t k = 0; k < counts[kind]; k++)
            kinds[at++] = kind;
    }
    // Fisher and Yates: all orders have the same probability.
    bf_random random;
    random_init(&random, s->cargo_seed);
    for (size_t left = n; left > 1; left--) {
        size_t k = (size_t)(random_unit(&random) * (double)left);
        uint32_t last = kinds[left - 1];
        kinds[left - 1] = kinds[k];
        kinds[k] = last;
    }
    *ret_kinds = kinds;
    return BF_OK;
}

void mix_footprints(const scene *s, shape_footprint ret_footprints[SCENE_KINDS_MAX])
{
    for (size_t k = 0; k < s->n_cargo; k++)
        ret_footprints[k] = shape_footprint_of(&s->cargo[k].shape);
}

static mix_radii radii_by(const scene *s, double radius_of(const scene_shape *shape))
{
    mix_radii radii = { INFINITY, 0.0 };

    for (size_t k = 0; k < s->n_cargo; k++) {
        const double radius = radius_of(&s->cargo[k].shape);
        radii.smallest = fmin(radii.smallest, radius);
        radii.largest = fmax(radii.largest, radius);
    }
    return radii;
}

static double bounding_radius_of(const scene_shape *shape)
{
    return shape_footprint_of(shape).bounding_radius;
}

mix_radii mix_radii_of(const scene *s)
{
    return radii_by(s, bounding_radius_of);
}

mix_radii mix_inner_radii_of(const scene *s)
{
    return radii_by(s, shape_inner_radius);
}

double mix_angularity(const scene *s)
{
    double sum = 0.0, of_kinds = 0.0;

    for (size_t k = 0; k < s->n_cargo; k++) {
        const shape_footprint footprint = shape_footprint_of(&s->cargo[k].shape);
        const double radius = sqrt(footprint.area / M_PI);
        sum += s->cargo[k].share;
        if (footprint.n_corners > 0)
            of_kinds += sqrt(footprint.bounding_radius / radius - 1.0) * s->cargo[k].share;
    }
    return of_kinds / sum;
}

double mix_mass_ratio(const scene *s)
{
    double least = INFINITY, largest = 0.0;

    for (size_t k = 0; k < s->n_cargo; k++) {
        least = fmin(least, s->cargo[k].mass);
        largest = fmax(largest, s->cargo[k].mass);
    }
    return largest / least;
}

double mix_mass_per_area(const scene *s)
{
    double mass = 0.0, of = 0.0;

    for (size_t k = 0; k < s->n_cargo; k++) {
        mass += s->cargo[k].share * s->cargo[k].mass;
        of += s->cargo[k].share;
    }
    return mass / of * scene_packing_density(s);
}
