/// Digests of what a scenario defines: equal where every number is, by which a solver recognises its
/// checkpoints. Each function adds to a digest (core/base/digest.h) and returns the sum. Names and ids are
/// not included.

#pragma once

#include "core/scene/types.h"

/// A rectangle.
uint64_t definition_add_rect(uint64_t digest, const scene_rect *rect);

/// n belts: velocities, speed schedules and polygons.
uint64_t definition_add_belts(uint64_t digest, size_t n, const scene_belt *belts);

/// n obstacles with all their members.
uint64_t definition_add_obstacles(uint64_t digest, size_t n, const scene_obstacle *obstacles);

/// The motions of n obstacles; nothing where none moves.
uint64_t definition_add_motions(uint64_t digest, size_t n, const scene_obstacle *obstacles);

/// The shape of a part.
uint64_t definition_add_shape(uint64_t digest, const scene_shape *shape);

/// n materials.
uint64_t definition_add_materials(uint64_t digest, size_t n, const scene_material *materials);

/// The contact laws of all pairs.
uint64_t definition_add_contacts(uint64_t digest, const scene_contact contact[SCENE_PAIR_COUNT]);

/// n poses.
uint64_t definition_add_poses(uint64_t digest, size_t n, const scene_pose *poses);

/// A whole resolved scenario.
uint64_t definition_digest(const scene *s);
