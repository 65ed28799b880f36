#include "core/micro/micro.h"

#include "core/base/check.h"
#include "core/base/digest.h"
#include "core/base/memory.h"
#include "core/micro/backend.h"
#include "core/micro/contact_law.h"
#include "core/micro/drives.h"
#include "core/micro/hardness.h"
#include "core/micro/implicit_step.h"
#include "core/micro/part_index.h"
#include "core/micro/press.h"
#include "core/scene/goods.h"
#include "core/scene/plate_range.h"
#include "core/scene/shape.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double step_slack = 1e-9; // tolerance for steps that are equal to the bound in decimal

// Of the stable step of MICRO_VERLET, where none is given: keeps U(t) within about 1 % of N.
static const double chosen_fraction = 0.25;

// Of the smallest radius, how far a plate may move in a step, so that no part gets behind it.
static const double plate_move = 0.25;

struct micro_solver {
    const micro_backend *backend;
    micro_common *state;
    double dt;
    double overlap_limit; // see micro_def
    double reduction;     // of the moduli, now
    bool hardens;         // see micro_def
    size_t n_kinds;
    size_t n_defined; // parts of the definition
    bool admits;      // parts may be admitted
    size_t n;         // handles
    size_t capacity;  // room in ids
    uint64_t *ids;    // by handle
    uint64_t next_id;
    size_t first_free; // no lower handle is free
    uint64_t n_reported_fallen;
    part_index part_index;
    drives drives;
};

// The start of a saved state, followed by the ids and what the backend saves.
typedef struct saved_header {
    uint64_t n;
    uint64_t next_id;
    uint64_t n_reported_fallen;
    double reduction;
    uint64_t steps; // these of micro_common
    double largest_overlap;
    double overlap_share;
    double recent_overlap;
} saved_header;

micro_def micro_def_default(void)
{
    micro_def def = { .modulus_reduction = 1e6,
                      .overlap_limit = INFINITY,
                      .damping = 0.1,
                      .gravity = 9.81,
                      .dt = 1e-5,
                      .n_threads = 1 };
    scene s;

    scene_init(&s);
    goods_resolve(&s);
    memcpy(def.edges, s.edges, sizeof def.edges);
    memcpy(def.contact, s.micro.contact, sizeof def.contact);
    def.wall_friction = s.micro.contact[SCENE_HANDLING_CARGO].friction;
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

bool micro_def_is_planar(const micro_def *def)
{
    return choose_backend(def) == &micro__disk;
}

int micro_iterations(const micro_def *def)
{
    return def->integrator == MICRO_IMPLICIT ? implicit_step_effort(def, micro_def_is_planar(def))
                                             : 0;
}

double micro__plate_speed(const micro_def *def, size_t *ret_obstacle)
{
    double largest = 0.0;

    *ret_obstacle = 0;
    for (size_t k = 0; k < def->n_obstacles; k++) {
        const double speed =
            plate_range_largest_speed(def->obstacles, k, def->n_actions, def->actions);
        if (speed > largest)
            *ret_obstacle = k;
        largest = fmax(largest, speed);
    }
    return largest;
}

double micro_dt_plates(const micro_def *def)
{
    size_t fastest;
    const double speed = micro__plate_speed(def, &fastest);

    return speed > 0.0 ? plate_move * implicit_step_radius(def) / speed : INFINITY;
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

vec2 micro__start_velocity(const micro_def *def, const micro_common *of, vec2 at, double radius,
                           double *ret_spin)
{
    const size_t belt = surroundings_belt_under(&of->around, at, radius);

    *ret_spin = 0.0;
    if (belt == def->n_belts)
        return def->start_velocity;
    const double factor = belt_speeds_at(&of->world->belts, belt, 0.0);
    *ret_spin = factor * def->belts[belt].turn;
    return vec2_scale(belt_velocity(&def->belts[belt], at), factor);
}

bf_world *micro__world(const micro_def *def)
{
    static bf_world at_rest = { .belts = { .are_constant = true } };

    return def->world != NULL ? def->world : &at_rest;
}

micro_def micro__without_arrays(const micro_def *def)
{
    micro_def copy = *def;

    copy.belts = NULL;
    copy.obstacles = NULL;
    copy.actions = NULL;
    copy.kinds = NULL;
    copy.poses = NULL;
    copy.part_kinds = NULL;
    return copy;
}

bf_status micro__copy_surroundings(const micro_def *def, surroundings *ret_copy, bf_error *err)
{
    surroundings around = {
        .domain = def->domain, .n_belts = def->n_belts, .belts = def->belts, .bridge = INFINITY
    };

    for (size_t k = 0; k < def->n_kinds; k++)
        around.bridge = fmin(around.bridge, shape_inner_radius(&def->kinds[k].shape));
    memcpy(around.edges, def->edges, sizeof around.edges);
    return surroundings_copy(&around, ret_copy, err);
}

bf_status micro_create(const micro_def *def, micro_solver **ret_solver, bf_error *err)
{
    micro_def own = *def;
    const micro_backend *backend = choose_backend(def);
    bf_status status = BF_OK;

    if (own.dt == 0.0)
        own.dt = micro_dt_chosen(def);
    if (micro_dt_plates(&own) < INFINITY && (status = check_plates(&own, err)) != BF_OK)
        return status;
    const double stable = micro_dt_stable(&own);
    if (!isfinite(own.dt) || !(own.dt > 0.0) || !(own.dt <= stable * (1.0 + step_slack)))
        return bf_fail(err, BF_EINPUT, "/micro/step_s",
                       "a step of %.9g s is not possible; the largest stable one is %.9g s", own.dt,
                       stable);
    micro_solver *s = memory_alloc(1, sizeof *s);
    if (s == NULL)
        return bf_fail(err, BF_ENOMEM, "", "no memory for a solver");
    *s = (micro_solver){ .backend = backend,
                         .dt = own.dt,
                         .overlap_limit = own.overlap_limit,
                         .reduction = own.modulus_reduction,
                         .hardens = own.hardens && own.integrator == MICRO_IMPLICIT &&
                                    backend == &micro__disk,
                         .n_kinds = def->n_kinds,
                         .n_defined = def->n_parts,
                         .admits = def->n_parts_expected > 0 };
    if (memory_reserve(&s->ids, &s->capacity, def->n_parts, sizeof *s->ids) != 0)
        status = bf_fail(err, BF_ENOMEM, "/initial", "no memory for %zu parts", def->n_parts);
    while (status == BF_OK && s->n < def->n_parts)
        s->ids[s->n++] = s->next_id++;
    s->first_free = s->n;
    if (status == BF_OK)
        status = part_index_init(&own, &s->part_index, err);
    if (status == BF_OK)
        status = backend->create(&own, &s->state, err);
    if (status == BF_OK)
        status = drives_init(&s->drives, &own, err);
    if (status != BF_OK) {
        micro_destroy(s);
        return status;
    }
    *ret_solver = s;
    return BF_OK;
}

micro_solver *micro_destroy(micro_solver *s)
{
    if (s == NULL)
        return NULL;
    if (s->state != NULL)
        s->backend->destroy(s->state);
    part_index_fini(&s->part_index);
    drives_fini(&s->drives);
    memory_free(s->ids);
    memory_free(s);
    return NULL;
}

static void set_reduction(micro_solver *s, double reduction)
{
    if (reduction != s->reduction)
        s->backend->harden(s->state, reduction);
    s->reduction = reduction;
}

static double time_now(const micro_solver *s)
{
    return (double)micro_steps(s) * s->dt;
}

bf_status micro_advance(micro_solver *s, uint64_t n, bf_error *err)
{
    bf_status status = BF_OK;
    micro_press press;

    s->part_index.is_sorted = false;
    while (n > 0 && status == BF_OK) {
        // Where the run may become harder depends on the number of the step alone.
        const uint64_t left = HARDNESS_STEPS - micro_steps(s) % HARDNESS_STEPS;
        const uint64_t n_now =
            drives_steps_until(&s->drives, micro_steps(s), s->hardens && left < n ? left : n);
        status = s->backend->advance(s->state, n_now, err);
        n -= n_now;
        if (s->hardens && micro_steps(s) % HARDNESS_STEPS == 0) {
            if (s->state->recent_overlap > hardness_goal)
                set_reduction(s, hardness_harder(s->reduction));
            s->state->recent_overlap = 0.0;
        }
        drives_follow(&s->drives, s->backend, s->state);
    }
    if (status != BF_ENUMERIC || !micro_press_now(s, &press))
        return status;
    return bf_fail(err, BF_ENUMERIC, "/micro/modulus_reduction",
                   "part %llu overlaps by %.3g %% of a radius at (%.4g, %.4g) m after %.6g s, more "
                   "than overlap_limit, %.3g %%",
                   (unsigned long long)press.part, 100.0 * press.overlap, press.at.x, press.at.y,
                   time_now(s), 100.0 * s->overlap_limit);
}

bool micro_press_now(const micro_solver *s, micro_press *ret_press)
{
    const double overlap = s->backend->measure(s->state).overlap_share;

    if (overlap <= s->overlap_limit)
        return false;
    s->backend->press(s->state, ret_press);
    ret_press->overlap = overlap;
    ret_press->part = s->ids[ret_press->part];
    if (ret_press->other != UINT64_MAX)
        ret_press->other = s->ids[ret_press->other];
    return true;
}

double micro_reduction(const micro_solver *s)
{
    return s->reduction;
}

micro_part micro_part_of(const micro_solver *s, size_t k)
{
    return s->backend->part(s->state, k);
}

bool micro_is_gone(const micro_solver *s, size_t k)
{
    return s->state->presence[k] != MICRO_HERE;
}

uint64_t micro_id_of(const micro_solver *s, size_t k)
{
    return s->ids[k];
}

void micro_take_out(micro_solver *s, size_t k)
{
    s->backend->take_out(s->state, k);
    s->part_index.is_sorted = false;
}

// The lowest handle from `first` on that stands for this; n if there is none.
static size_t find_handle(const micro_solver *s, size_t first, int what)
{
    const uint8_t *presence = s->state->presence;
    const uint8_t *found = first < s->n ? memchr(presence + first, what, s->n - first) : NULL;

    return found != NULL ? (size_t)(found - presence) : s->n;
}

// The lowest one from `first` on that stands for a part that is gone and was not reported.
static size_t find_gone(const micro_solver *s, size_t first)
{
    const size_t left = find_handle(s, first, MICRO_LEFT);
    const size_t fell = find_handle(s, first, MICRO_FELL);

    return left < fell ? left : fell;
}

bf_status micro_admit(micro_solver *s, const micro_arrival *arrival, size_t *ret_part,
                      bf_error *err)
{
    BF_CHECK(s->admits && arrival->kind < s->n_kinds);
    const size_t k = s->first_free = find_handle(s, s->first_free, MICRO_FREE);
    if (k == SCENE_PARTS_MAX)
        return bf_fail(err, BF_ELIMIT, "", "the limit is %d parts at a time", SCENE_PARTS_MAX);
    if (memory_reserve(&s->ids, &s->capacity, k + 1, sizeof *s->ids) != 0)
        return bf_fail(err, BF_ENOMEM, "", "no memory for %zu parts", k + 1);
    const bf_status status = s->backend->admit(s->state, k, arrival, err);
    if (status != BF_OK)
        return status;
    s->ids[k] = s->next_id++;
    s->n += k == s->n;
    s->first_free = k + 1;
    part_index_add(&s->part_index, k, arrival->kind);
    *ret_part = k;
    return BF_OK;
}

uint64_t micro_fallen(const micro_solver *s)
{
    uint64_t n = s->n_reported_fallen;

    for (size_t k = find_handle(s, 0, MICRO_FELL); k < s->n; k = find_handle(s, k + 1, MICRO_FELL))
        n++;
    return n;
}

size_t micro_take_departures(micro_solver *s, micro_departure *ret_departures, size_t room)
{
    uint8_t *presence = s->state->presence;
    size_t n = 0;

    for (size_t k = find_gone(s, 0); n < room && k < s->n; k = find_gone(s, k)) {
        const micro_part part = micro_part_of(s, k);
        ret_departures[n++] = (micro_departure){ .part = k,
                                                 .id = s->ids[k],
                                                 .kind = s->backend->extent(s->state, k).kind,
                                                 .at = { part.x[0], part.x[1] },
                                                 .has_fallen = part.has_fallen };
        s->n_reported_fallen += part.has_fallen ? 1 : 0;
        presence[k] = MICRO_FREE;
        s->first_free = k < s->first_free ? k : s->first_free;
    }
    if (n > 0)
        s->backend->forget_gone(s->state);
    return n;
}

vec2 micro_belt_velocity(const micro_solver *s, vec2 at)
{
    const surroundings *around = &s->state->around;
    const size_t belt = surroundings_belt_at(around, at);

    return vec2_scale(surroundings_velocity_at(around, belt, at),
                      belt_speeds_at(&s->state->world->belts, belt, time_now(s)));
}

static part_index_parts parts_of(const micro_solver *s)
{
    return (part_index_parts){ s->backend, s->state, s->n, time_now(s) };
}

bf_status micro_is_free(micro_solver *s, uint32_t kind, scene_pose pose, bool *ret_is_free,
                        bf_error *err)
{
    const part_index_parts parts = parts_of(s);

    return part_index_find_free(&s->part_index, &parts, kind, pose, ret_is_free, err);
}

bf_status micro_visit_near(micro_solver *s, vec2 a, vec2 b, double distance, micro_visit *visit,
                           void *context, bf_error *err)
{
    const part_index_parts parts = parts_of(s);

    return part_index_visit_near(&s->part_index, &parts, a, b, distance, visit, context, err);
}

bool micro_is_planar(const micro_solver *s)
{
    return s->backend == &micro__disk;
}

size_t micro_parts(const micro_solver *s)
{
    return s->n;
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
    return s->state->steps;
}

uint64_t micro_digest(const micro_solver *s)
{
    const uint64_t steps = micro_steps(s);
    const bool is_planar = micro_is_planar(s);
    uint64_t digest = digest_add(DIGEST_START, &steps, sizeof steps);

    for (size_t k = 0; k < s->n; k++) {
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
    if (!s->admits)
        return digest;
    digest = digest_add(digest, s->ids, s->n * sizeof *s->ids);
    return digest_add(digest, s->state->presence, s->n);
}

bf_status micro_save(const micro_solver *s, bf_buffer *out, bf_error *err)
{
    checkpoint_writer w;
    const saved_header header = {
        s->n,
        s->next_id,
        s->n_reported_fallen,
        s->reduction,
        s->state->steps,
        s->state->largest_overlap,
        s->state->overlap_share,
        s->state->recent_overlap,
    };

    checkpoint_begin(&w, out, s->backend->kind, 0);
    checkpoint_write(&w, &header, sizeof header);
    checkpoint_write(&w, s->ids, s->n * sizeof *s->ids);
    drives_save(&s->drives, &w);
    s->backend->save(s->state, &w);
    return checkpoint_end(&w, err);
}

static int compare_ids(const void *left, const void *right)
{
    uint64_t a, b;

    memcpy(&a, left, sizeof a);
    memcpy(&b, right, sizeof b);
    return (a > b) - (a < b);
}

static bool is_header_sound(const micro_solver *s, const saved_header *h)
{
    if (!(h->reduction >= 1.0) || !isfinite(h->reduction) || !(h->recent_overlap >= 0.0) ||
        (!s->hardens && h->reduction != s->reduction))
        return false;
    if (!s->admits)
        return h->n == s->n_defined && h->next_id == h->n && h->n_reported_fallen <= h->n;
    return h->n_reported_fallen <= h->next_id && h->n >= s->n_defined && h->n <= SCENE_PARTS_MAX &&
           h->next_id >= h->n;
}

// Each id once, and less than the next one.
static bf_status check_ids(const micro_solver *s, bf_error *err)
{
    uint64_t *ids = memory_alloc(s->n + 1, sizeof *ids);
    bool are_sound = true;

    if (ids == NULL)
        return bf_fail(err, BF_ENOMEM, "", "no memory for %zu parts", s->n);
    memcpy(ids, s->ids, s->n * sizeof *ids);
    qsort(ids, s->n, sizeof *ids, compare_ids);
    for (size_t k = 0; k < s->n; k++)
        are_sound = are_sound && ids[k] < s->next_id && (k == 0 || ids[k - 1] < ids[k]);
    memory_free(ids);
    return are_sound ? BF_OK : bf_fail(err, BF_ECORRUPT, "", "the saved ids are damaged");
}

bf_status micro_load(micro_solver *s, const void *bytes, size_t n, bf_error *err)
{
    checkpoint_reader r;
    saved_header header;

    BF_CHECK(micro_steps(s) == 0);
    bf_status status = checkpoint_open(&r, bytes, n, s->backend->kind, 0, err);
    if (status != BF_OK)
        return status;
    if (!checkpoint_read(&r, &header, sizeof header) || !is_header_sound(s, &header))
        return bf_fail(err, BF_ECORRUPT, "", "the saved state is damaged");
    if (memory_reserve(&s->ids, &s->capacity, header.n, sizeof *s->ids) != 0)
        return bf_fail(err, BF_ENOMEM, "", "no memory for %zu parts", (size_t)header.n);
    if (!checkpoint_read(&r, s->ids, header.n * sizeof *s->ids) || !drives_load(&s->drives, &r))
        return bf_fail(err, BF_ECORRUPT, "", "the saved state is damaged, or too short");
    s->n = header.n;
    s->next_id = header.next_id;
    s->first_free = 0;
    s->n_reported_fallen = header.n_reported_fallen;
    s->state->steps = header.steps;
    s->state->largest_overlap = header.largest_overlap;
    s->state->overlap_share = header.overlap_share;
    s->state->recent_overlap = header.recent_overlap;
    if ((status = check_ids(s, err)) == BF_OK)
        status = s->backend->load(s->state, s->n, &r, err);
    if (status != BF_OK)
        return status;
    set_reduction(s, header.reduction);
    return BF_OK;
}
