#include "core/micro/disk/parts.h"

#include "core/base/digest.h"
#include "core/base/memory.h"
#include "core/micro/backend.h"
#include "core/scene/belt_slope.h"

#include <math.h>
#include <string.h>

static const double skin_fraction = 0.25; // of the radius
enum { TILED_PARTS = 150000 };            // from this number on parts do not fit into the caches

static void destroy(void *state)
{
    disk_state *s = state;

    if (s == NULL)
        return;
    disk__implicit_fini(s);
    disk__boundary_fini(s);
    disk__plates_fini(s);
    disk__tiling_fini(s);
    surroundings_fini(&s->common.around);
    memory_free(s->now);
    memory_free(s->next);
    memory_free(s->heading);
    memory_free(s->spin_deceleration);
    memory_free(s->belt_under);
    memory_free(s->scratch.bytes);
    memory_free(s->has_candidates);
    memory_free(s->id_of);
    memory_free(s->slot_of);
    memory_free(s->common.presence);
    memory_free(s->kinds);
    memory_free(s->kind_of);
    memory_free(s->list.first);
    memory_free(s->list.pair_first);
    memory_free(s->list.pairs.bytes);
    memory_free(s->border_parts);
    memory_free(s->extremes);
    neighbours_cells_fini(&s->cells);
    memory_free(s);
}

static disk_law make_law(const scene_contact *contact)
{
    return (disk_law){ .line = 0.25 * M_PI * contact->length,
                       .damping = contact->damping,
                       .friction = contact->friction,
                       .tanh_linear = contact->tanh_linear };
}

static bf_status copy_kinds(disk_state *s, const micro_def *def)
{
    s->n_kinds = def->n_kinds;
    s->kinds = memory_alloc(def->n_kinds, sizeof *s->kinds);
    if (s->kinds == NULL)
        return BF_ENOMEM;
    s->radius_min = INFINITY;
    for (size_t k = 0; k < def->n_kinds; k++) {
        const micro_kind *kind = &def->kinds[k];
        const double r = kind->shape.radius;
        // Theta = m r^2 / 2.
        s->kinds[k] = (disk_kind){ .part = { .radius = r,
                                             .compliance = contact_law_compliance(
                                                 &kind->material, s->def.modulus_reduction),
                                             .inv_mass = 1.0 / kind->mass },
                                   .spin_deceleration = 2.0 * s->belt.friction * s->def.gravity *
                                                        kind->spin_radius / (r * r),
                                   .height = kind->shape.height };
        s->radius_min = fmin(s->radius_min, s->kinds[k].part.radius);
        s->radius_max = fmax(s->radius_max, s->kinds[k].part.radius);
    }
    s->uniform_deceleration = s->kinds[0].spin_deceleration;
    s->skin = skin_fraction * sqrt(s->radius_min * s->radius_max);
    return BF_OK;
}

static bf_status make_arrays(disk_state *s, const micro_def *def)
{
    s->extremes = memory_alloc((size_t)2 * DISK_PARTITIONS_MAX, sizeof *s->extremes);
    s->kernels = disk__explicit_kernels(cpu_best());
    // One more, so that no array is empty.
    if (s->extremes == NULL || disk__resize(s, s->n > 0 ? s->n : 1) != BF_OK)
        return BF_ENOMEM;
    if (s->kind_of != NULL && def->part_kinds != NULL)
        memcpy(s->kind_of, def->part_kinds, s->n * sizeof *s->kind_of);
    return BF_OK;
}

void disk__fill_slots(disk_state *s)
{
    s->n_live = s->n;
    s->n_padded = (s->n + DISK_GROUP - 1) / DISK_GROUP * DISK_GROUP;
    s->n_border_parts = 0;
    s->displacement_bound = s->last_bound = INFINITY;
    for (uint32_t k = 0; k <= s->void_slot; k++) {
        const disk_kind *kind = &s->kinds[k < s->n && s->kind_of != NULL ? s->kind_of[k] : 0];
        s->now[k] = k < s->n ? kind->part : disk__pad(s, k);
        s->id_of[k] = k < s->n ? k : UINT32_MAX;
        if (k < s->n)
            s->slot_of[k] = k;
        if (s->spin_deceleration != NULL)
            s->spin_deceleration[k] = kind->spin_deceleration;
    }
}

const disk_belt *disk__belts_in_step(const disk_state *s, uint64_t n_before, disk_belts *room)
{
    double factors[SCENE_BELTS_MAX + 1];

    if (s->common.world->belts.are_constant && !s->has_slopes)
        return s->belts.of;
    belt_speeds_in_step(&s->common.world->belts, n_before, s->def.dt, factors);
    for (size_t k = 0; k <= s->common.around.n_belts; k++) {
        disk_belt *belt = &room->of[k];
        *belt = s->belts.of[k];
        belt->vx *= factors[k];
        belt->vy *= factors[k];
        belt->turn *= factors[k];
        if (!s->has_slopes)
            continue;
        belt->vx += belt->hold.x;
        belt->vy += belt->hold.y;
    }
    return room->of;
}

static bf_status fill(disk_state *s, const micro_def *def, bf_error *err)
{
    bool is_tiled = def->integrator == MICRO_VERLET && def->n_parts >= TILED_PARTS;

    // All steps of a tile have one boundary, so plates must stand.
    for (size_t k = 0; k < def->n_obstacles; k++)
        is_tiled = is_tiled && !scene_obstacle_moves(&def->obstacles[k]);
    s->common.world = micro__world(def);
    const scene_belt *top = def->n_belts > 0 ? &def->belts[def->n_belts - 1] : NULL;
    s->def = micro__without_arrays(def);
    s->cargo = make_law(&def->contact[SCENE_CARGO_CARGO]);
    s->handling = make_law(&def->contact[SCENE_HANDLING_CARGO]);
    s->handling_compliance = contact_law_compliance(&def->handling, def->modulus_reduction);
    s->belt =
        contact_law_of_disk(&def->contact[SCENE_CONVEYOR_CARGO], &def->kinds[0].material,
                            &def->conveyor, def->modulus_reduction, def->kinds[0].shape.radius);
    s->spin_damping = pow(fmax(1.0 - def->damping, 0.0), def->dt);
    s->is_uniform =
        def->n_kinds == 1 && !def->tension &&
        (top == NULL || (top->n_points == 0 && top->turn == 0.0 && top->incline == 0.0));
    s->uniform_belt = (uint16_t)(def->n_belts - (top != NULL ? 1 : 0));
    s->n = def->n_parts;
    s->n_partitions = 1;
    s->displacement_bound = s->last_bound = INFINITY;
    if (copy_kinds(s, def) != BF_OK || make_arrays(s, def) != BF_OK ||
        (is_tiled && disk__tiling_init(s) != BF_OK))
        return bf_fail(err, BF_ENOMEM, "/initial", "no memory for %zu parts", def->n_parts);
    for (size_t k = 0; k < def->n_belts; k++) {
        const scene_belt *belt = &def->belts[k];
        const scene_contact *conveyor = &def->contact[SCENE_CONVEYOR_CARGO];
        const vec2 v = belt_velocity(belt, (vec2){ 0.0, 0.0 });
        s->belts.of[k] = (disk_belt){ v.x,
                                      v.y,
                                      belt->turn,
                                      belt_friction_ratio(belt, conveyor) * cos(belt->incline),
                                      belt_slope_pull(belt, def->gravity),
                                      belt_slope_hold(belt, conveyor) };
        s->has_turning = s->has_turning || belt->turn != 0.0;
        s->has_slopes = s->has_slopes || belt->incline != 0.0;
    }
    bf_status status = micro__copy_surroundings(def, &s->common.around, err);
    if (status == BF_OK)
        status = disk__boundary_init(s, def, err);
    if (status != BF_OK)
        return status;
    disk__fill_slots(s);
    for (size_t k = 0; k < s->n; k++) {
        const scene_pose *pose = &def->poses[k];
        const vec2 v = micro__start_velocity(def, &s->common, (vec2){ pose->x, pose->y },
                                             s->now[k].radius, &s->now[k].spin);
        s->now[k].x = pose->x;
        s->now[k].y = pose->y;
        s->now[k].vx = v.x;
        s->now[k].vy = v.y;
        s->heading[k] = pose->heading;
    }
    return disk__rebuild(s, err);
}

static bf_status create(const micro_def *def, micro_common **ret_state, bf_error *err)
{
    disk_state *s = memory_alloc(1, sizeof *s);

    if (s == NULL)
        return bf_fail(err, BF_ENOMEM, "", "no memory for a solver");
    bf_status status = fill(s, def, err);
    if (status != BF_OK) {
        destroy(s);
        return status;
    }
    *ret_state = &s->common;
    return BF_OK;
}

static bf_status advance(void *state, uint64_t n, bf_error *err)
{
    disk_state *s = state;

    return s->def.integrator == MICRO_IMPLICIT ? disk__advance_implicit(s, n, err)
                                               : disk__advance_explicit(s, n, err);
}

static void harden(void *state, double reduction)
{
    disk_state *s = state;
    const double factor = reduction / s->def.modulus_reduction;

    s->def.modulus_reduction = reduction;
    s->handling_compliance *= factor;
    for (size_t k = 0; k < s->n_kinds; k++)
        s->kinds[k].part.compliance *= factor;
    for (size_t slot = 0; slot < s->void_slot; slot++)
        s->now[slot].compliance *= factor;
    disk__set_iterations(s);
}

const micro_backend micro__disk = {
    .dt_stable = disk__dt_stable_explicit,
    .create = create,
    .destroy = destroy,
    .advance = advance,
    .part = disk__part,
    .extent = disk__extent,
    .admit = disk__admit,
    .take_out = disk__take_out,
    .forget_gone = disk__forget_gone,
    .measure = disk__measure,
    .press = disk__press,
    .harden = harden,
    .load_on = disk__load_on,
    .save = disk__save,
    .load = disk__load,
    .kind = CHECKPOINT_DISK,
};
