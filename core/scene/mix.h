/// Mixes: which part is of which kind of cargo.

#pragma once

#include "core/scene/scene.h"
#include "core/scene/shape.h"

/// How many of n parts are of each kind: n in proportion to the shares, rounded down, and the rest
/// one by one to the kinds with the largest remainders, the first listed of equal ones.
void mix_count(const scene *s, size_t n, size_t ret_counts[SCENE_KINDS_MAX]);

/// The kinds of n parts: as many of each as mix_count() says, in an order drawn from cargo_seed, the
/// same on every machine. *ret_kinds is the caller's, memory_free(); NULL if there is one kind.
/// BF_ENOMEM.
BF_MUST_CHECK bf_status mix_draw(const scene *s, size_t n, uint32_t **ret_kinds, bf_error *err);

/// The footprint of each kind.
void mix_footprints(const scene *s, shape_footprint ret_footprints[SCENE_KINDS_MAX]);

/// The smallest and the largest of a radius of the kinds, m.
typedef struct mix_radii {
    double smallest; ///< of all kinds
    double largest;  ///< same
} mix_radii;

/// Of the disks about their footprints.
mix_radii mix_radii_of(const scene *s);

/// Of the disks that fit into them, shape_inner_radius(): what a gap must be wider than to let a part through.
mix_radii mix_inner_radii_of(const scene *s);

/// sqrt(R/r - 1), R the radius about a part and r that of a disk with its footprint, the mean by the shares of the kinds: 0 of
/// cylinders, 0.5 of square boxes.
double mix_angularity(const scene *s);

/// The largest mass of a kind divided by the smallest.
double mix_mass_ratio(const scene *s);

/// Mass of close packed cargo of a resolved scene, kg/m2.
double mix_mass_per_area(const scene *s);

/// The kind of part k by what mix_draw() gave.
static inline uint32_t mix_kind(const uint32_t *kinds, size_t k)
{
    return kinds == NULL ? 0 : kinds[k];
}
