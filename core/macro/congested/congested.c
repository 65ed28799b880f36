// The congested closure's memory and state; step.c makes the steps.

#include "core/base/memory.h"
#include "core/macro/congested/congested_priv.h"
#include "core/macro/congested/half_rows.h"
#include "core/scene/belt.h"
#include "core/scene/belt_range.h"
#include "core/scene/belt_slope.h"

#include <math.h>
#include <string.h>

static const double too_dense = 2.0; // times the largest density that there can be

#define X(suffix) extern const congested_kernels congested__kernels_##suffix;
CPU_EACH_BUILD(X)
#undef X

static congested_kernels kernels_of(cpu_level level)
{
    static const congested_kernels *const builds[CPU_AVX512 + 1] = {
#define X(suffix) &congested__kernels_##suffix,
        CPU_EACH_BUILD(X)
#undef X
    };

    return *builds[level];
}

// The velocities across the faces of an axis, and where those of packed and of loose cargo differ.
static void copy_velocities(const macro_solver *s, int axis, const double *v, const double *loose)
{
    const congested *c = s->congested;
    const ptrdiff_t n_columns = s->n1 + (axis == 0), n_rows = s->n2 + axis;

    for (ptrdiff_t j = 0; j < n_rows; j++) {
        congested_range differ = { n_columns, 0 };
        for (ptrdiff_t i = 0; i < n_columns; i++) {
            const size_t at = (size_t)(j * n_columns + i);
            const double open = c->aperture[axis][at], slide = open * v[at];
            c->is_stale[axis][j] |= slide != c->slide[axis][at];
            c->slide[axis][at] = slide;
            c->loose[axis][at] = open * (loose != NULL ? loose : v)[at];
            if (c->loose[axis][at] == c->slide[axis][at])
                continue;
            differ.first = i < differ.first ? i : differ.first;
            differ.last = i + 1;
        }
        c->sliding[axis][j] = differ;
    }
}

// Copies a row; true if it was another one.
static bool copy_row(void *to, const void *from, size_t n_bytes)
{
    const bool is_new = memcmp(to, from, n_bytes) != 0;

    memcpy(to, from, n_bytes);
    return is_new;
}

static void copy_faces(const macro_solver *s, const macro_def *def)
{
    const congested *c = s->congested;

    for (int axis = 0; axis < 2; axis++) {
        const velocity_field_faces *from = &def->faces[axis];
        const size_t n = (size_t)(s->n1 + (axis == 0));
        for (size_t j = 0; j < (size_t)(s->n2 + axis); j++) {
            const size_t at = j * n;
            bool *is_stale = &c->is_stale[axis][j];
            *is_stale |= copy_row(c->aperture[axis] + at, from->aperture + at, n * sizeof(double));
            *is_stale |=
                copy_row(c->transverse[axis] + at, from->transverse + at, n * sizeof(double));
            *is_stale |= copy_row(c->belt[axis] + at, from->belt + at, n * sizeof(uint16_t));
        }
        copy_velocities(s, axis, from->v, from->loose);
    }
}

// How fast each belt moves across one that it runs onto: it has the cell before a face, and the other one the face opposite. Not
// beside it, where faces bridge gaps. Belts that turn run along those that they lead to.
static void find_onto(const macro_def *def, congested *c)
{
    const bf_grid *g = &def->grid;

    for (size_t j = 0; j < g->n2; j++)
        for (size_t i = 0; i < g->n1; i++) {
            const size_t west = j * (g->n1 + 1) + i, south = j * g->n1 + i;
            const size_t around[4] = { def->faces[0].belt[west], def->faces[0].belt[west + 1],
                                       def->faces[1].belt[south],
                                       def->faces[1].belt[south + g->n1] };
            const double in[4] = { def->faces[0].v[west], -def->faces[0].v[west + 1],
                                   def->faces[1].v[south], -def->faces[1].v[south + g->n1] };
            const vec2 before[4] = {
                { -g->d1, 0.0 }, { g->d1, 0.0 }, { 0.0, -g->d2 }, { 0.0, g->d2 }
            };
            for (int from = 0; from < 4; from++) {
                const size_t belt = around[from];
                const scene_belt *a = &c->belts[belt], *b = &c->belts[around[from ^ 1]];
                const double speed = vec2_length(b->velocity);
                const vec2 centre = { grid_x1(g, i), grid_x2(g, j) };
                if (in[from] <= 0.0 || belt == def->n_belts || belt == around[from ^ 1] ||
                    speed == 0.0 || a->turn != 0.0 || b->turn != 0.0 ||
                    !belt_holds(&def->belts[belt], vec2_add(centre, before[from])))
                    continue;
                c->onto[belt] =
                    fmax(c->onto[belt], fabs(vec2_cross(a->velocity, b->velocity)) / speed);
                c->has_drives = c->has_drives || c->onto[belt] > 0.0;
            }
        }
}

// The belts in the directions that the definition's field has.
static void copy_belts(const macro_def *def, congested *c)
{
    for (size_t k = 0; k < def->n_belts; k++) {
        c->belts[k] = (scene_belt){ .velocity = def->belts[k].velocity,
                                    .turn = def->belts[k].turn,
                                    .centre = def->belts[k].centre,
                                    .incline = def->belts[k].incline };
        c->slope_ratio[k] =
            belt_slope_ratio(&def->belts[k], &(scene_contact){ .friction = def->friction });
        c->fastest[k] = belt_largest_speed(&def->belts[k]);
        c->onto[k] = 0.0;
    }
    find_onto(def, c);
}

static bool init_faces(const macro_solver *s, congested *c, const macro_def *def)
{
    const bf_grid *g = &s->def.grid;
    const size_t n[2] = { (g->n1 + 1) * g->n2, g->n1 * (g->n2 + 1) };

    for (int axis = 0; axis < 2; axis++) {
        c->aperture[axis] = memory_alloc(n[axis], sizeof *c->aperture[axis]);
        c->transverse[axis] = memory_alloc(n[axis], sizeof *c->transverse[axis]);
        c->belt[axis] = memory_alloc(n[axis], sizeof *c->belt[axis]);
        c->slide[axis] = memory_alloc(n[axis], sizeof *c->slide[axis]);
        c->loose[axis] = memory_alloc(n[axis], sizeof *c->loose[axis]);
        c->sliding[axis] = memory_alloc(g->n2 + 1, sizeof *c->sliding[axis]);
        c->is_stale[axis] = memory_alloc(g->n2 + 1, sizeof *c->is_stale[axis]);
        if (c->aperture[axis] == NULL || c->transverse[axis] == NULL || c->belt[axis] == NULL ||
            c->slide[axis] == NULL || c->loose[axis] == NULL || c->sliding[axis] == NULL ||
            c->is_stale[axis] == NULL)
            return false;
    }
    c->belts = memory_alloc(def->n_belts + 1, sizeof *c->belts);
    c->fastest = memory_alloc(def->n_belts + 1, sizeof *c->fastest);
    c->slope_ratio = memory_alloc(def->n_belts + 1, sizeof *c->slope_ratio);
    c->onto = memory_alloc(def->n_belts + 1, sizeof *c->onto);
    c->present = memory_alloc(def->n_belts + 1, sizeof *c->present);
    c->is_changed = memory_alloc(def->n_belts + 1, sizeof *c->is_changed);
    if (c->belts == NULL || c->is_changed == NULL || c->fastest == NULL || c->slope_ratio == NULL ||
        c->onto == NULL || c->present == NULL)
        return false;
    for (size_t k = 0; k <= def->n_belts; k++)
        c->present[k] = (congested_belt){ 1.0, 1.0, 1.0, 1.0, 0.0, 0.0, 0.0 };
    copy_belts(def, c);
    memcpy(c->closed_edge, def->one_way, sizeof c->closed_edge);
    return true;
}

// Members of a law that every solver has, and those that only solvers have that are not forward.
enum { LAW_ARRAYS = 11, LAW_COUPLED_ARRAYS = 3, LAW_SLOPE_ARRAYS = 2 };

static int count_law_arrays(const congested *c)
{
    return LAW_ARRAYS + (c->is_forward ? 0 : LAW_COUPLED_ARRAYS) +
           (c->has_drives ? LAW_SLOPE_ARRAYS : 0);
}

static void lay_out_law(congested_law *l, float **at, ptrdiff_t pitch, int n_arrays)
{
    float **const members[LAW_ARRAYS + LAW_COUPLED_ARRAYS + LAW_SLOPE_ARRAYS] = {
        &l->slope,  &l->offset,    &l->most,  &l->least,   &l->threshold, &l->lower,
        &l->upper,  &l->full_slip, &l->gain,  &l->at_rest, &l->flux,      &l->along,
        &l->across, &l->crosswise, &l->inner, &l->sideways
    };

    for (int k = 0; k < n_arrays; k++) {
        *members[k] = *at;
        *at += pitch;
    }
}

static bool lay_out(macro_solver *s, congested *c)
{
    const ptrdiff_t unit = CONGESTED_UNIT;
    const int arrays = count_law_arrays(c);

    c->half_width = (s->n1 / 2 + unit) / unit * unit + 2 * unit;
    // An odd number of cache lines, so that the arrays of a row do not share the few sets of a power of two.
    const ptrdiff_t pitch = c->half_width + (c->half_width / unit % 2 == 0 ? unit : 0);
    c->half_stride = ((c->has_drives ? 6 : 4) + CONGESTED_SIDES * arrays) * pitch;
    const size_t n = (size_t)((s->n2 + 2) * c->half_width);
    const size_t n_floats = (size_t)((s->n2 + 2) * c->half_stride);
    c->storage = memory_alloc(n_floats, sizeof *c->storage);
    c->is_uniform = memory_alloc(2 * n, sizeof *c->is_uniform);
    c->is_unforced = memory_alloc(2 * n, sizeof *c->is_unforced);
    c->range = memory_alloc((size_t)s->n2, sizeof *c->range);
    c->found = memory_alloc((size_t)s->n2, sizeof *c->found);
    bool has_pressed = true;
    for (int k = 0; k < CONGESTED_PRESSED_STEPS; k++) {
        c->pressed[k] = memory_alloc((size_t)s->n2, sizeof *c->pressed[k]);
        has_pressed = has_pressed && c->pressed[k] != NULL;
    }
    c->disturbed = memory_alloc((size_t)s->n2, sizeof *c->disturbed);
    c->is_unsettled = memory_alloc(2 * n, sizeof *c->is_unsettled);
    c->slots = memory_alloc(2 * (size_t)s->def.n_threads, sizeof *c->slots);
    if (c->storage == NULL || c->is_uniform == NULL || c->is_unforced == NULL || c->range == NULL ||
        c->found == NULL || !has_pressed || c->disturbed == NULL || c->is_unsettled == NULL ||
        c->slots == NULL)
        return false;
    float *at = c->storage;
    for (int colour = 0; colour < 2; colour++) {
        c->pressure[colour] = at;
        c->excess[colour] = at + pitch;
        at += 2 * pitch;
        if (!c->has_drives)
            continue;
        c->relaxations[colour] = at;
        at += pitch;
        for (ptrdiff_t row = 0; row < s->n2 + 2; row++) // those beyond the grid, too
            for (ptrdiff_t k = 0; k < c->half_width; k++)
                c->relaxations[colour][row * c->half_stride + k] = c->relaxation;
    }
    for (int side = 0; side < CONGESTED_SIDES; side++)
        lay_out_law(&c->law[side], &at, pitch, arrays);
    return true;
}

// The density between the stages of the scheme muscl, and the rows that the threads need for them.
static bool lay_out_stage(const macro_solver *s, congested *c)
{
    enum { ROWS = 9 }; // of a thread
    const size_t n_members = (size_t)s->def.n_threads;

    c->stage.rho = memory_alloc((size_t)(s->n2 * s->stride), sizeof *c->stage.rho);
    c->stage.span = memory_alloc((size_t)s->n2, sizeof *c->stage.span);
    c->rows = memory_alloc(n_members, sizeof *c->rows);
    c->stage_storage = memory_alloc(n_members * ROWS * (size_t)s->stride, sizeof *c->stage_storage);
    if (c->stage.rho == NULL || c->stage.span == NULL || c->rows == NULL ||
        c->stage_storage == NULL)
        return false;
    double *at = c->stage_storage + s->margin;
    for (congested_rows *r = c->rows; r < c->rows + n_members; r++) {
        double **const members[ROWS] = { &r->states1.left,    &r->states1.right,
                                         &r->states2[0].left, &r->states2[0].right,
                                         &r->states2[1].left, &r->states2[1].right,
                                         &r->flux1,           &r->flux2[0],
                                         &r->flux2[1] };
        for (int k = 0; k < ROWS; k++, at += s->stride)
            *members[k] = at;
    }
    return true;
}

// The laws of all faces are to be made.
static void set_stale(const macro_solver *s)
{
    for (int axis = 0; axis < 2; axis++)
        memset(s->congested->is_stale[axis], true, (size_t)(s->n2 + axis) * sizeof(bool));
}

bf_status congested_create(macro_solver *s, const macro_def *def, congested **ret_congested)
{
    congested *c = memory_alloc(1, sizeof *c);

    if (c == NULL)
        return BF_ENOMEM;
    c->kernels = kernels_of(cpu_best());
    c->is_forward = belt_are_forward(def->n_belts, def->belts);
    // Of belts that run backwards each may run onto another one.
    c->has_drives = belt_range_may_reverse_any(def->n_belts, def->belts);
    for (size_t k = 0; k < def->n_belts; k++)
        c->has_drives = c->has_drives || def->belts[k].incline != 0.0;
    c->jam_density = def->jam_density;
    c->slip_rate = def->slip_rate;
    c->n_belts = def->n_belts;
    const double ratio = def->grid.d1 / def->grid.d2;
    c->ratio = (float)ratio;
    c->steepness = (float)(ratio * ratio);
    c->relaxation =
        (float)(CONGESTED_OMEGA * def->grid.d1 / (2.0 * (1.0 + ratio * ratio) * def->dt));
    c->lambda = (float)(def->dt / def->grid.d1);
    if (!init_faces(s, c, def) || !lay_out(s, c) ||
        (def->scheme == SCENE_SCHEME_MUSCL && !lay_out_stage(s, c))) {
        congested_destroy(c);
        return BF_ENOMEM;
    }
    *ret_congested = s->congested = c;
    copy_faces(s, def);
    set_stale(s);
    congested_update(s);
    congested_reset(s);
    return BF_OK;
}

// In cargo that a plate has enclosed no pressure brings the density down to rho_j, and the iteration raises it step by step.
// Where the plate goes on and opens a way, that drives more into the free cells than the iteration can hold back. So no
// pressure is above that of a queue as long as both sides of the domain: rho_j v_T a cell.
static void limit_pressures(const macro_solver *s, congested *c)
{
    double fastest = 0.0, steepest = 1.0;

    for (size_t k = 0; k < c->n_belts; k++) {
        fastest = fmax(fastest, fmax(s->factors[k], 1.0) * c->fastest[k]);
        steepest = fmax(steepest, c->present[k].slower);
    }
    const float most = (float)(c->jam_density * fastest * steepest * (double)(s->n1 + s->n2));
    for (int colour = 0; colour < 2; colour++)
        for (ptrdiff_t row = 0; row < s->n2; row++)
            for (ptrdiff_t k = c->range[row].first; k < c->range[row].last; k++) {
                float *pressure = congested__row(c, c->pressure[colour], row) + k;
                *pressure = fminf(*pressure, most);
            }
}

void congested_set_faces(macro_solver *s, const macro_def *def)
{
    limit_pressures(s, s->congested);
    if (def->belts != NULL) {
        copy_belts(def, s->congested);
        set_stale(s);
    }
    copy_faces(s, def);
    congested_update(s);
}

congested *congested_destroy(congested *c)
{
    if (c == NULL)
        return NULL;
    for (int axis = 0; axis < 2; axis++) {
        memory_free(c->aperture[axis]);
        memory_free(c->transverse[axis]);
        memory_free(c->belt[axis]);
        memory_free(c->slide[axis]);
        memory_free(c->loose[axis]);
        memory_free(c->sliding[axis]);
        memory_free(c->is_stale[axis]);
    }
    memory_free(c->belts);
    memory_free(c->is_changed);
    memory_free(c->fastest);
    memory_free(c->slope_ratio);
    memory_free(c->onto);
    memory_free(c->present);
    memory_free(c->storage);
    memory_free(c->is_uniform);
    memory_free(c->is_unforced);
    memory_free(c->range);
    memory_free(c->found);
    for (int k = 0; k < CONGESTED_PRESSED_STEPS; k++)
        memory_free(c->pressed[k]);
    memory_free(c->disturbed);
    memory_free(c->is_unsettled);
    memory_free(c->slots);
    memory_free(c->stage.rho);
    memory_free(c->stage.span);
    memory_free(c->stage_storage);
    memory_free(c->rows);
    memory_free(c);
    return NULL;
}

// The arrays that a step reads of the step before.
enum { STATE_ARRAYS = 2 + 2 * CONGESTED_SIDES };

static int state_of(const congested *c, float *ret_arrays[STATE_ARRAYS])
{
    int n = 0;

    ret_arrays[n++] = c->pressure[0];
    ret_arrays[n++] = c->pressure[1];
    for (int side = 0; side < CONGESTED_SIDES; side++) {
        ret_arrays[n++] = c->law[side].threshold;
        if (!c->is_forward)
            ret_arrays[n++] = c->law[side].crosswise;
    }
    return n;
}

static size_t row_bytes(const congested *c)
{
    return (size_t)c->half_width * sizeof(float);
}

static void clear_array(const macro_solver *s, const congested *c, float *array)
{
    for (ptrdiff_t row = 0; row < s->n2 + 2; row++)
        memset(array + row * c->half_stride, 0, row_bytes(c));
}

// The next steps take all active cells: nothing is known of fluxes and thresholds of the steps before.
static void skip_nothing(const macro_solver *s, congested *c)
{
    c->n_unskipped = CONGESTED_PRESSED_STEPS;
    memset(c->is_unsettled, true, 2 * (size_t)((s->n2 + 2) * c->half_width));
}

void congested_reset(macro_solver *s)
{
    congested *c = s->congested;
    float *arrays[STATE_ARRAYS];
    const int n = state_of(c, arrays);

    for (int k = 0; k < n; k++)
        clear_array(s, c, arrays[k]);
    for (int side = 0; side < CONGESTED_SIDES; side++)
        clear_array(s, c, c->law[side].flux);
    memset(c->range, 0, (size_t)s->n2 * sizeof *c->range);
    skip_nothing(s, c);
    c->density_limit = too_dense * fmax(1.0, macro_measure(s).peak);
}

bf_status congested_check(const macro_solver *s, bf_error *err)
{
    const bf_grid *g = &s->def.grid;

    if (macro_measure(s).peak <= s->congested->density_limit)
        return BF_OK;
    for (size_t j = 0; j < g->n2; j++)
        for (size_t i = 0; i < g->n1; i++)
            if (macro_row(s, j)[i] > s->congested->density_limit)
                return bf_fail(
                    err, BF_ENUMERIC, "",
                    "cargo is packed to density %.3g at x = %.6g m, y = %.6g m after step "
                    "%llu (t = %.6g s): it has no way out, or the pressure does not converge",
                    macro_row(s, j)[i], grid_x1(g, i), grid_x2(g, j),
                    (unsigned long long)macro_steps(s), macro_time(s));
    return BF_OK;
}

double congested_relaxed(const macro_solver *s)
{
    return s->congested->relaxed;
}

void congested_save(const macro_solver *s, checkpoint_writer *w)
{
    const congested *c = s->congested;
    float *arrays[STATE_ARRAYS];
    const int n = state_of(c, arrays);

    checkpoint_write(w, &c->density_limit, sizeof c->density_limit);
    checkpoint_write(w, c->range, (size_t)s->n2 * sizeof *c->range);
    for (int k = 0; k < n; k++)
        for (ptrdiff_t row = 0; row < s->n2 + 2; row++)
            checkpoint_write(w, arrays[k] + row * c->half_stride, row_bytes(c));
}

size_t congested_state_size(const macro_solver *s)
{
    const congested *c = s->congested;
    float *arrays[STATE_ARRAYS];
    const int n = state_of(c, arrays);

    return sizeof c->density_limit + (size_t)s->n2 * sizeof *c->range +
           (size_t)n * (size_t)(s->n2 + 2) * row_bytes(c);
}

bool congested_load(macro_solver *s, checkpoint_reader *r)
{
    congested *c = s->congested;
    float *arrays[STATE_ARRAYS];
    const int n = state_of(c, arrays);
    bool is_read = checkpoint_read(r, &c->density_limit, sizeof c->density_limit) &&
                   checkpoint_read(r, c->range, (size_t)s->n2 * sizeof *c->range);

    for (int k = 0; k < n; k++)
        for (ptrdiff_t row = 0; row < s->n2 + 2; row++)
            is_read = is_read && checkpoint_read(r, arrays[k] + row * c->half_stride, row_bytes(c));
    skip_nothing(s, c);
    return is_read;
}
