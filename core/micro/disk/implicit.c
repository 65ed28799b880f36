// Implicit steps of disks: implicit Euler for contacts and frictions, solved by impulses.
//
//     overlap    delta+ = delta - h v+, v = speed at which the surfaces part
//     normal     impulse J = max(0, E (delta - h v+) - d max(delta, 0)), E = h k + d: for delta > 0
//                h times (4a) at the end of the step; for a gap (delta < 0), zero until it closes,
//                and then the dashpot acts on the overlap
//                v is against the surface of a plate that moves: a body of given velocity that impulses do
//                not change
//     sliding    impulse -mu |J| lambda theta(lambda |u|) u+, at most mu |J|; u the slip known so far: (7),
//                implicit by its secant (core/micro/friction.h)
//     belt       impulse -h mu m g lambda theta(lambda |u|) u+, u the velocity relative to the belt
//     spin       the same with (8), secant of the spin before the step; on the diagonal, so it only
//                changes the inertia
//
// The coupled equations are solved contact by contact (Gauss-Seidel) from the impulses of the step
// before, with over-relaxation; each iteration updates the secants and so converges to implicit Euler. Every impulse acts
// on both parts, so momentum is conserved however few iterations are made.
//
// The members of a team wait for each other between the phases of a step. In a phase every member works on some of
// the chunks of slots or of the pieces of a group, none of which writes what another one reads.

#include "core/micro/disk/implicit.h"
#include "core/base/memory.h"
#include "core/micro/disk/parts.h"
#include "core/micro/hardness.h"
#include "core/micro/implicit_step.h"

#include <math.h>
#include <string.h>

#define X(suffix) extern const implicit_kernels implicit_kernels_##suffix;
CPU_EACH_BUILD(X)
#undef X

const implicit_kernels *disk__implicit_kernels(cpu_level level)
{
    static const implicit_kernels *const builds[] = {
#define X(suffix) &implicit_kernels_##suffix,
        CPU_EACH_BUILD(X)
#undef X
    };

    return builds[level];
}

// The largest number of iterations that a kind of part requires.
static int find_iterations(const disk_state *s)
{
    const double damping = fmax(s->cargo.damping, s->handling.damping);
    int iterations = 1;

    for (size_t k = 0; k < s->n_kinds; k++) {
        const disk *part = &s->kinds[k].part;
        double cargo = s->cargo.line / (2.0 * part->compliance);
        double handling = s->handling.line / (part->compliance + s->handling_compliance);
        double stiffness = fmax(cargo, handling);
        int own = implicit_step_iterations(
            true, micro__n_expected(&s->def), s->def.dt, stiffness,
            hardness_dashpot(&s->def, damping, stiffness, part->inv_mass), 1.0 / part->inv_mass);
        iterations = own > iterations ? own : iterations;
    }
    return iterations;
}

implicit_state *disk_implicit__create(const disk_state *s)
{
    implicit_state *z = memory_alloc(1, sizeof *z);

    if (!z)
        return NULL;
    z->iterations = find_iterations(s);
    z->skin = s->radius_min;
    z->kernels = disk__implicit_kernels(cpu_best());
    z->step = (implicit_step){ .damping_factor = exp(-s->def.damping * s->def.dt),
                               .belt_secant = s->def.dt * s->belt.friction * s->def.gravity *
                                              s->belt.tanh_linear };
    return z;
}

void disk__set_iterations(disk_state *s)
{
    implicit_state *z = s->implicit;

    if (z != NULL)
        z->iterations = find_iterations(s);
    if (z != NULL && z->is_current && s->n_kinds == 1)
        disk_implicit__set_common_law(s, z);
}

void disk_implicit__forget_choice(implicit_state *z)
{
    z->is_chosen = false;
}

void disk__implicit_fini(disk_state *s)
{
    implicit_state *z = s->implicit;

    if (z == NULL)
        return;
    memory_free(z->pieces);
    memory_free(z->blocks);
    memory_free(z);
    s->implicit = NULL;
}

// False if a next step like the last one, which moved parts by up to `last_bound`, could make parts touch that
// are in no list with this skin, after parts have moved by displacement_bound since it was made, m.
static bool holds(double skin, double displacement_bound, double move)
{
    return neighbours_holds(skin, displacement_bound + 1.25 * move);
}

// The list and the pairs as the next step needs them. The list alone is rebuilt if it was made at another
// time than the pairs, as after a load.
static bf_status refresh(void *state, bf_error *err)
{
    disk_state *s = state;
    implicit_state *z = s->implicit;
    const double move = z->last_bound + disk__plates_travel(s, s->common.steps);
    bool must_choose = !z->is_chosen || !holds(z->skin, z->displacement_bound, move);

    bf_status status = BF_OK;

    if (must_choose || !holds(s->skin, s->displacement_bound, move)) {
        s->skin = z->skin;
        disk_implicit__unlocate(s, z);
        status = disk__rebuild(s, err);
    }
    if (status == BF_OK && must_choose)
        status = disk_implicit__choose(s, z, err);
    if (status == BF_OK && !z->is_current)
        status = disk_implicit__locate(s, z, err);
    if (status == BF_OK && must_choose) {
        z->is_chosen = true;
        z->displacement_bound = 0.0;
    }
    return status;
}

static implicit_state *state_of(const driver_member *m)
{
    return ((disk_state *)m->state)->implicit;
}

static void split_groups(const driver_member *m, driver_work *work)
{
    driver_split_groups(m, state_of(m)->group_piece, IMPLICIT_GROUPS, 1, work);
}

static size_t count_chunks(const disk_state *s)
{
    return (s->n_padded + IMPLICIT_CHUNK - 1) / IMPLICIT_CHUNK;
}

// Up to the next group of parts; slots between the last part and that are pads.
static size_t end_of_chunk(const disk_state *s, size_t chunk)
{
    size_t end = (chunk + 1) * IMPLICIT_CHUNK;

    return end < s->n_padded ? end : s->n_padded;
}

static driver_extremes join_chunks(const disk_state *s)
{
    const implicit_state *z = s->implicit;
    driver_extremes all = { 0 };

    for (size_t c = 0; c < count_chunks(s); c++)
        driver_join(&all, &z->extremes[c]);
    return all;
}

// The numbers of a step, which every member of a team makes for itself.
typedef struct step_numbers {
    implicit_step step;
    double margin; // gaps that may close, m
    double excess; // of the present iteration
} step_numbers;

static void predict_chunk(const driver_member *m, size_t chunk)
{
    const disk_state *s = m->state;
    const step_numbers *numbers = m->step;
    implicit_state *z = s->implicit;

    z->extremes[chunk] = z->kernels->predict(s, &numbers->step, &z->bodies, chunk * IMPLICIT_CHUNK,
                                             end_of_chunk(s, chunk));
}

static void apply_belt_friction_of_chunk(const driver_member *m, size_t chunk)
{
    const disk_state *s = m->state;
    const step_numbers *numbers = m->step;
    implicit_state *z = s->implicit;

    z->kernels->apply_belt_friction(s, &numbers->step, &z->bodies, chunk * IMPLICIT_CHUNK,
                                    end_of_chunk(s, chunk));
}

static void move_chunk(const driver_member *m, size_t chunk)
{
    disk_state *s = m->state;
    implicit_state *z = s->implicit;

    z->extremes[chunk] =
        z->kernels->move(s, z->bodies.rows, chunk * IMPLICIT_CHUNK, end_of_chunk(s, chunk));
}

static void find_contacts_of_piece(const driver_member *m, size_t piece)
{
    const step_numbers *numbers = m->step;

    disk_implicit__find_contacts(m->state, state_of(m), piece, numbers->margin);
}

static void solve_piece(const driver_member *m, size_t piece)
{
    const step_numbers *numbers = m->step;

    disk_implicit__solve(state_of(m), piece, numbers->excess);
}

static void update_partition(const driver_member *m, size_t k)
{
    disk_state *s = m->state;
    const disk_partition *of = &s->partitions[k];

    disk__update_border_parts(s, s->now, of->border_first, of->border_last, DISK_GONE);
}

// The phases of a step: prediction, contacts, iterations, motion.
static void make_phases(driver_member *m, double travel)
{
    const disk_state *s = m->state;
    const implicit_state *z = s->implicit;
    const size_t n_chunks = count_chunks(s);
    step_numbers numbers = { .step = z->step };
    disk_belts room;

    numbers.step.belts = disk__belts_in_step(s, s->common.steps + m->n_made, &room);
    m->step = &numbers;
    disk__pose_plates_by_team(m);
    driver_split(m, 0, n_chunks, predict_chunk);
    driver_wait(m);
    numbers.margin = 2.0 * (s->def.dt * sqrt(join_chunks(s).speed2) + travel);
    split_groups(m, find_contacts_of_piece);
    for (int iteration = 0; iteration < z->iterations; iteration++) {
        if (iteration > 0) {
            driver_split(m, 0, n_chunks, apply_belt_friction_of_chunk);
            driver_wait(m);
        }
        numbers.excess = implicit_step_excess(iteration, z->iterations);
        split_groups(m, solve_piece);
    }
    driver_split(m, 0, n_chunks, move_chunk);
    driver_wait(m);
    driver_split(m, 0, (size_t)s->n_partitions, update_partition);
}

static driver_outcome step(driver_member *m)
{
    const disk_state *s = m->state;
    const implicit_state *z = s->implicit;
    const uint64_t n_before = s->common.steps + m->n_made;
    const double travel = disk__plates_travel(s, n_before);
    driver_progress *p = &m->progress;

    make_phases(m, travel);
    const driver_extremes e = join_chunks(s);
    p->last_bound = s->def.dt * sqrt(e.speed2);
    p->pair_bound += p->last_bound + travel;
    p->displacement_bound += p->last_bound + travel;
    for (size_t k = 0; k < z->group_piece[IMPLICIT_GROUPS]; k++) {
        const implicit_piece *piece = &z->pieces[k];
        p->largest.overlap =
            piece->overlap > p->largest.overlap ? piece->overlap : p->largest.overlap;
        p->largest.overlap_share = piece->overlap_share > p->largest.overlap_share
                                       ? piece->overlap_share
                                       : p->largest.overlap_share;
    }
    driver_wait(m);
    if (!isfinite(e.sum) || p->last_bound > 0.5 * s->radius_min ||
        micro__is_pressed(p->largest.overlap_share, &s->def))
        return DRIVER_SUSPECT;
    const double move = p->last_bound + disk__plates_travel(s, n_before + 1);
    return holds(z->skin, p->pair_bound, move) && holds(s->skin, p->displacement_bound, move)
               ? DRIVER_MADE
               : DRIVER_STALE;
}

static int begin(const void *state, driver_progress *ret_progress)
{
    const disk_state *s = state;
    const implicit_state *z = s->implicit;

    *ret_progress = (driver_progress){ .displacement_bound = s->displacement_bound,
                                       .pair_bound = z->displacement_bound };
    return s->n_partitions;
}

static void end(void *state, uint64_t n, driver_outcome outcome, const driver_progress *progress)
{
    disk_state *s = state;
    implicit_state *z = s->implicit;

    (void)outcome;
    s->common.steps += n;
    disk__pose_plates(s, s->common.steps);
    s->displacement_bound = progress->displacement_bound;
    z->displacement_bound = progress->pair_bound;
    z->last_bound = progress->last_bound;
    micro__take_overlaps(&s->common, progress->largest.overlap, progress->largest.overlap_share);
}

bf_status disk__advance_implicit(disk_state *s, uint64_t n, bf_error *err)
{
    static const driver_solver solver = {
        .refresh = refresh, .begin = begin, .step = step, .end = end, .check = disk__check
    };

    if (!s->implicit)
        s->implicit = disk_implicit__create(s);
    if (!s->implicit)
        return bf_fail(err, BF_ENOMEM, "", "no memory for the solver");
    return driver_advance(&solver, s, n, err);
}
