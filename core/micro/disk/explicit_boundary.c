// The forces of plates and walls in explicit steps. This file is compiled once per instruction set.

#include "core/micro/disk/explicit_lanes.h"

// A square whose root is never zero.
static const double tiny2 = 1e-200;

// SIMD_LANES candidates: the geometry of the boundary relative to the parts.
typedef struct surface {
    simd nx, ny;   // unit normal out of the boundary
    simd height;   // of the part's centre over it, m
    simd friction; // mu
    simd inside;   // 1 where the centre is in the range of the feature, else 0
} surface;

INLINED surface find_faces(const disk_state *s, const parts *own, const uint32_t *feature)
{
    simd_quad low = simd_quad_load(&s->faces->px, feature);
    simd_quad high = simd_quad_load(&s->faces->from, feature);
    simd rx = own->x - low.column[0], ry = own->y - low.column[1];
    surface f = { .nx = low.column[2], .ny = low.column[3], .friction = high.column[3] };
    simd along = rx * f.ny - ry * f.nx;

    f.height = rx * f.nx + ry * f.ny;
    f.inside = simd_where_less(along, high.column[1], simd_all(1.0));
    f.inside = simd_where_less(-high.column[2], f.height, f.inside);
    f.inside -= simd_where_less(along, high.column[0], f.inside);
    return f;
}

INLINED surface find_arcs(const disk_state *s, const parts *own, const uint32_t *feature)
{
    simd_quad low = simd_quad_load(&s->arcs->px, feature);
    simd_quad high = simd_quad_load(&s->arcs->ey, feature);
    simd rx = own->x - low.column[0], ry = own->y - low.column[1];
    simd distance = simd_sqrt(simd_max(rx * rx + ry * ry, simd_all(tiny2)));
    surface a = { .nx = rx / distance, .ny = ry / distance, .friction = high.column[3] };
    simd zero = simd_all(0.0);

    a.height = distance - low.column[2];
    a.inside = simd_where_less(zero, a.height, simd_all(1.0));
    a.inside = simd_where_less(zero, rx * high.column[1] + ry * high.column[2], a.inside);
    a.inside -= simd_where_less(rx * low.column[3] + ry * high.column[0], zero, a.inside);
    return a;
}

// Takes the lanes of b where pick is 1, keeps those of a where it is 0.
INLINED surface choose(surface a, surface b, simd pick)
{
    simd half = simd_all(0.5);
    surface s;

    s.nx = simd_where_less(pick, half, a.nx) + simd_where_less(half, pick, b.nx);
    s.ny = simd_where_less(pick, half, a.ny) + simd_where_less(half, pick, b.ny);
    s.height = simd_where_less(pick, half, a.height) + simd_where_less(half, pick, b.height);
    s.friction = simd_where_less(pick, half, a.friction) + simd_where_less(half, pick, b.friction);
    s.inside = simd_where_less(pick, half, a.inside) + simd_where_less(half, pick, b.inside);
    return s;
}

// Candidates first .. first + SIMD_LANES - 1, of which those from last on are ignored.
typedef struct candidate_lanes {
    uint32_t slot[SIMD_LANES];
    uint32_t row[SIMD_LANES], face[SIMD_LANES], arc[SIMD_LANES]; // where they begin
    simd is_arc;                                                 // 1 or 0
    simd counts;                                                 // 1, or 0 behind the last
    bool has_arcs;
} candidate_lanes;

INLINED candidate_lanes load_candidates(const disk_state *s, size_t first, size_t last)
{
    candidate_lanes t = { .has_arcs = false };

    for (size_t k = 0; k < SIMD_LANES; k++) {
        disk_candidate candidate = { s->void_slot, 0 };
        if (first + k < last)
            candidate = s->candidates[first + k];
        bool is_arc = candidate.feature >= s->n_faces;
        t.slot[k] = candidate.slot;
        t.row[k] = candidate.slot * DISK_DOUBLES;
        t.face[k] = is_arc ? 0 : candidate.feature * DISK_DOUBLES;
        t.arc[k] = is_arc ? (candidate.feature - (uint32_t)s->n_faces) * DISK_DOUBLES : 0;
        t.is_arc[k] = is_arc ? 1.0 : 0.0;
        t.counts[k] = first + k < last ? 1.0 : 0.0;
        t.has_arcs = t.has_arcs || is_arc;
    }
    return t;
}

// How the surfaces move that SIMD_LANES candidates are about.
typedef struct surface_motion {
    simd px, py; // pivot
    simd spin, recess, growth;
    simd vx, vy; // of the pivot
} surface_motion;

INLINED surface_motion load_surfaces(const disk_state *s, const candidate_lanes *t)
{
    const uint32_t first_arc = (uint32_t)s->n_faces * DISK_DOUBLES;
    uint32_t row[SIMD_LANES];

    for (size_t k = 0; k < SIMD_LANES; k++)
        row[k] = t->is_arc[k] > 0.0 ? first_arc + t->arc[k] : t->face[k];
    simd_quad low = simd_quad_load(&s->plates.surfaces->px, row);
    simd_quad high = simd_quad_load(&s->plates.surfaces->growth, row);
    return (surface_motion){ low.column[0],  low.column[1],  low.column[2], low.column[3],
                             high.column[0], high.column[1], high.column[2] };
}

// The velocity of the parts becomes that against the surface in the contact point.
INLINED void subtract_surface_velocity(const surface_motion *m, const surface *at, simd lever,
                                       parts *own)
{
    simd rx = own->x - lever * at->nx - m->px, ry = own->y - lever * at->ny - m->py;

    own->vx -= m->growth * at->nx - m->spin * ry + m->vx;
    own->vy -= m->growth * at->ny + m->spin * rx + m->vy;
}

INLINED void boundary_forces_lanes(const explicit_step *step, const pair_law *law,
                                   const candidate_lanes *t, bool uniform, overlaps *all,
                                   simd_quad *ret_forces)
{
    const disk_state *s = step->state;
    const disk *kind = &s->kinds[0].part;
    const simd zero = simd_all(0.0);
    parts own = load_parts(step->now, t->row, uniform);
    simd radius = uniform ? simd_all(kind->radius) : own.radius, stiffness = law->stiffness;
    surface at = find_faces(s, &own, t->face);

    if (t->has_arcs)
        at = choose(at, find_arcs(s, &own, t->arc), t->is_arc);
    if (!uniform)
        stiffness = law->line / (own.compliance + s->handling_compliance);
    surface_motion surfaces = { zero, zero, zero, zero, zero, zero, zero };
    if (s->plates.n > 0)
        surfaces = load_surfaces(s, t);
    simd range = radius - surfaces.recess, overlap = range - at.height;
    simd presses = simd_where_less(at.height, range, at.inside * t->counts);
    contact c = { .nx = -at.nx, .ny = -at.ny, .lever = radius - 0.5 * overlap };
    if (s->plates.n > 0)
        subtract_surface_velocity(&surfaces, &at, c.lever, &own);
    c.force = normal_force(law, stiffness, overlap, own.vx * at.nx + own.vy * at.ny, zero, presses);
    c.sliding = law->rate * (own.vx * at.ny - own.vy * at.nx + own.spin * c.lever);
    friction_quotient tanh = friction_tanh(c.sliding);
    contact_force f = add_friction(&c, at.friction, &tanh, uniform);
    *ret_forces = (simd_quad){ { f.x, f.y, -(f.friction * c.lever), zero } };
    overlap = simd_where_less(zero, presses, overlap);
    all->overlap = simd_max(overlap, all->overlap);
    if (!uniform)
        all->ratio = simd_max(overlap / radius, all->ratio);
}

// Adds the forces of SIMD_LANES candidates, of which n are valid. *group is that of the candidate before.
INLINED void store_forces(const explicit_step *step, const candidate_lanes *t, size_t n,
                          const simd_quad *forces, uint32_t *group)
{
    for (size_t k = 0; k < SIMD_LANES && k < n; k++) {
        disk *to = &step->next[t->slot[k]];
        if (t->slot[k] / DISK_GROUP != *group) {
            *group = t->slot[k] / DISK_GROUP;
            disk *rows = &step->next[*group * DISK_GROUP];
            for (size_t row = 0; row < DISK_GROUP; row++)
                rows[row].x = rows[row].y = rows[row].vx = rows[row].vy = 0.0;
        }
        to->x += forces->column[0][k];
        to->y += forces->column[1][k];
        to->vx += forces->column[2][k];
    }
}

INLINED void add_boundary_forces(const explicit_step *step, size_t first, size_t last, bool uniform,
                                 driver_extremes *extremes)
{
    const disk_state *s = step->state;
    const pair_law law = make_law(s, &s->handling, s->handling_compliance);
    const simd zero = simd_all(0.0);
    overlaps all = { zero, zero };
    simd_quad forces;
    uint32_t group = UINT32_MAX;

    for (size_t from = first; from < last; from += SIMD_LANES) {
        candidate_lanes t = load_candidates(s, from, last);
        boundary_forces_lanes(step, &law, &t, uniform, &all, &forces);
        store_forces(step, &t, last - from, &forces, &group);
    }
    raise_overlaps(s, &all, uniform, extremes);
}

void CPU_NAME(explicit_boundary_forces)(const explicit_step *step, size_t first, size_t last,
                                        driver_extremes *extremes)
{
    if (step->state->is_uniform)
        add_boundary_forces(step, first, last, true, extremes);
    else
        add_boundary_forces(step, first, last, false, extremes);
}
