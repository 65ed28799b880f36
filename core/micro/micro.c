#include "core/micro/micro.h"

#include "core/base/digest.h"
#include "core/base/memory.h"
#include "core/micro/backend.h"
#include "core/micro/contact_law.h"
#include "core/micro/implicit_step.h"
#include "core/micro/micro_priv.h"
#include "core/scene/definition.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const double step_slack = 1e-9; // tolerance for steps that are equal to the bound in decimal

// Of the stable step of MICRO_VERLET, where none is given: keeps U(t) within about 1 % of N.
static const double chosen_fraction = 0.25;

// Of the smallest radius, how far a plate may move in a step, so that no part gets behind it.
static const double plate_move = 0.25;

struct micro_solver {
    const micro_backend *backend;
    void *state;
    size_t n_parts;
    double dt;
    uint64_t definition; // digest, to which checkpoints belong
};

micro_def micro_def_default(void)
{
    micro_def def = { .modulus_reduction = 1e6,
                      .damping = 0.1,
                      .gravity = 9.81,
                      .dt = 1e-5,
                      .n_threads = 1,
                      .cookie = MICRO__COOKIE };
    scene s;

    scene_init(&s);
    memcpy(def.edges, s.edges, sizeof def.edges);
    memcpy(def.contact, s.micro.contact, sizeof def.contact);
    def.conveyor = s.micro.conveyor;
    def.handling = s.micro.handling;
    scene_fini(&s);
    return def;
}

static const micro_backend *choose_backend(const micro_def *def)
{
    bool are_cylinders = true;

    for (size_t k = 0; k < def->n_kinds; k++)
        are_cylinders = are_cylinders && def->kinds[k].shape.type == SCENE_CYLINDER;
    return are_cylinders && def->path != MICRO_PATH_SPATIAL ? &micro__disk : &micro__body;
}

double micro_dt_stable(const micro_def *def)
{
    return def->integrator == MICRO_IMPLICIT ? implicit_step_stable(def)
                                             : choose_backend(def)->dt_stable(def);
}

double micro_dt_chosen(const micro_def *def)
{
    const micro_backend *backend = choose_backend(def);

    return def->integrator == MICRO_IMPLICIT
               ? implicit_step_chosen(def, backend == &micro__disk)
               : fmin(chosen_fraction * backend->dt_stable(def), micro_dt_plates(def));
}

double micro_dt_plates(const micro_def *def)
{
    size_t fastest;
    const double speed = micro__plate_speed(def, &fastest);

    return speed > 0.0 ? plate_move * implicit_step_radius(def) / speed : INFINITY;
}

static bf_status check_step(const micro_def *def, bf_error *err)
{
    const double stable = micro_dt_stable(def);

    if (isfinite(def->dt) && def->dt > 0.0 && def->dt <= stable * (1.0 + step_slack))
        return BF_OK;
    return bf_fail(err, BF_EINPUT, "/micro/step_s",
                   "a step of %.9g s is not possible; the largest stable one is %.9g s", def->dt,
                   stable);
}

// The fastest plate whose contacts stop it within plate_move of a radius: a mass m at a speed v is stopped
// by a spring within v sqrt(m/k), by a dashpot within v m/d.
static double largest_plate_speed(const micro_def *def)
{
    const scene_contact *contact = &def->contact[SCENE_HANDLING_CARGO];
    double longest = 0.0; // s

    for (size_t k = 0; k < def->n_kinds; k++) {
        const micro_kind *kind = &def->kinds[k];
        const micro_law law =
            contact_law_of_line(contact, &kind->material, &def->handling, def->modulus_reduction);
        longest = fmax(longest, fmin(sqrt(kind->mass / law.stiffness), kind->mass / law.damping));
    }
    return plate_move * implicit_step_radius(def) / longest;
}

// A plate must not get behind what is in front of it.
static bf_status check_plates(const micro_def *def, bf_error *err)
{
    const double stable = micro_dt_plates(def), most = largest_plate_speed(def);
    char pointer[BF_POINTER_SIZE];
    size_t fastest;
    const double speed = micro__plate_speed(def, &fastest);

    snprintf(pointer, sizeof pointer, "/obstacles/%zu/motion", fastest);
    if (speed > most)
        return bf_fail(err, BF_EINPUT, pointer,
                       "moves at up to %.6g m/s; faster than %.6g m/s parts would pass through it",
                       speed, most);
    if (def->dt > 0.0 && def->dt <= stable * (1.0 + step_slack))
        return BF_OK;
    return bf_fail(
        err, BF_EINPUT, pointer,
        "moves at up to %.6g m/s: too fast for steps of %.9g s; the largest stable one is "
        "%.9g s",
        speed, def->dt, stable);
}

bf_status micro__copy_surroundings(const micro_def *def, surroundings *ret_copy, bf_error *err)
{
    surroundings around = { .domain = def->domain, .n_belts = def->n_belts, .belts = def->belts };

    memcpy(around.edges, def->edges, sizeof around.edges);
    return surroundings_copy(&around, ret_copy, err);
}

// All that determines the solution, so not the number of threads; the path is the checkpoint's
// kind.
static uint64_t digest_definition(const micro_def *def)
{
    const double numbers[] = { def->start_velocity.x, def->start_velocity.y, def->modulus_reduction,
                               def->damping,          def->gravity,          def->dt,
                               def->tension,          def->integrator,       (double)def->n_parts };
    uint64_t digest = digest_add(DIGEST_START, numbers, sizeof numbers);

    digest = definition_add_rect(digest, &def->domain);
    digest = digest_add(digest, def->edges, sizeof def->edges);
    digest = definition_add_belts(digest, def->n_belts, def->belts);
    digest = definition_add_obstacles(digest, def->n_obstacles, def->obstacles);
    digest = definition_add_motions(digest, def->n_obstacles, def->obstacles);
    for (size_t k = 0; k < def->n_kinds; k++) {
        const micro_kind *kind = &def->kinds[k];
        digest = definition_add_shape(digest, &kind->shape);
        digest = definition_add_materials(digest, 1, &kind->material);
        digest = digest_add(digest, &kind->mass, sizeof kind->mass);
        digest = digest_add(digest, &kind->spin_radius, sizeof kind->spin_radius);
    }
    digest = definition_add_poses(digest, def->n_parts, def->poses);
    digest = digest_add(digest, def->part_kinds,
                        def->part_kinds == NULL ? 0 : def->n_parts * sizeof *def->part_kinds);
    digest = definition_add_contacts(digest, def->contact);
    digest = definition_add_materials(digest, 1, &def->conveyor);
    return definition_add_materials(digest, 1, &def->handling);
}

bf_status micro_create(const micro_def *def, micro_solver **ret_solver, bf_error *err)
{
    bf_status status = micro__check(def, err);
    if (status != BF_OK)
        return status;
    micro_def own = *def;
    const micro_backend *backend = choose_backend(def);
    if (own.dt == 0.0)
        own.dt = micro_dt_chosen(def);
    if (micro_dt_plates(&own) < INFINITY && (status = check_plates(&own, err)) != BF_OK)
        return status;
    if ((status = check_step(&own, err)) != BF_OK)
        return status;
    micro_solver *s = memory_alloc(1, sizeof *s);
    if (s == NULL)
        return bf_fail(err, BF_ENOMEM, "", "no memory for a solver");
    *s = (micro_solver){ .backend = backend,
                         .n_parts = def->n_parts,
                         .dt = own.dt,
                         .definition = digest_definition(&own) };
    if ((status = backend->create(&own, &s->state, err)) != BF_OK) {
        memory_free(s);
        return status;
    }
    *ret_solver = s;
    return BF_OK;
}

micro_solver *micro_destroy(micro_solver *s)
{
    if (s != NULL)
        s->backend->destroy(s->state);
    memory_free(s);
    return NULL;
}

bf_status micro_advance(micro_solver *s, uint64_t n, bf_error *err)
{
    return s->backend->advance(s->state, n, err);
}

void micro_command_turn(micro_solver *s, size_t obstacle, double t, double angle, double over)
{
    plate_motion_command_turn(s->backend->motion(s->state), obstacle, t, angle, over);
    s->backend->pose_plates(s->state);
}

void micro_command_presence(micro_solver *s, size_t obstacle, double t, bool is_present)
{
    plate_motion_command_presence(s->backend->motion(s->state), obstacle, t, is_present);
    s->backend->pose_plates(s->state);
}

micro_part micro_part_of(const micro_solver *s, size_t k)
{
    return s->backend->part(s->state, k);
}

bool micro_is_gone(const micro_solver *s, size_t k)
{
    return s->backend->part(s->state, k).is_gone;
}

bool micro_is_planar(const micro_solver *s)
{
    return s->backend == &micro__disk;
}

size_t micro_parts(const micro_solver *s)
{
    return s->n_parts;
}

micro_totals micro_measure(const micro_solver *s)
{
    return s->backend->measure(s->state);
}

double micro_dt(const micro_solver *s)
{
    return s->dt;
}

uint64_t micro_steps(const micro_solver *s)
{
    return s->backend->steps(s->state);
}

uint64_t micro_digest(const micro_solver *s)
{
    const uint64_t steps = micro_steps(s);
    const bool is_planar = micro_is_planar(s);
    uint64_t digest = digest_add(DIGEST_START, &steps, sizeof steps);

    for (size_t k = 0; k < s->n_parts; k++) {
        const micro_part part = micro_part_of(s, k);
        const double is_gone = part.is_gone ? 1.0 : 0.0;
        digest = digest_add(digest, part.x, sizeof part.x);
        digest = digest_add(digest, part.v, sizeof part.v);
        digest = digest_add(digest, part.w, sizeof part.w);
        // q is computed from the heading by sines, which differ between versions of libm.
        if (is_planar)
            digest = digest_add(digest, &part.heading, sizeof part.heading);
        else
            digest = digest_add(digest, part.q, sizeof part.q);
        digest = digest_add(digest, &is_gone, sizeof is_gone);
    }
    return digest;
}

bf_status micro_save(const micro_solver *s, bf_buffer *out, bf_error *err)
{
    checkpoint_writer w;

    checkpoint_begin(&w, out, s->backend->kind, s->definition);
    s->backend->save(s->state, &w);
    return checkpoint_end(&w, err);
}

bf_status micro_load(micro_solver *s, const void *bytes, size_t n, bf_error *err)
{
    checkpoint_reader r;

    bf_status status = checkpoint_open(&r, bytes, n, s->backend->kind, s->definition, err);
    return status == BF_OK ? s->backend->load(s->state, &r, err) : status;
}
