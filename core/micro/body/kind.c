// A kind of part: its hull in the frame of its principal axes, and the laws of its contacts.

#include "core/micro/body/body_priv.h"

#include "core/base/memory.h"
#include "core/base/polygon.h"
#include "core/micro/hardness.h"
#include "core/micro/implicit_step.h"
#include "core/scene/shape.h"

#include <math.h>

/// Cosine of the largest angle between a face that lies flat and the plane below.
#define FLAT (1.0 - 1e-9)

_Static_assert((int)HULL_POINTS_MAX >= (int)SCENE_VERTICES_MAX,
               "a hull has room for the points of a shape");

/// The hull of a checked shape in its own frame: prisms from z = 0 up, boxes and cylinders around the
/// origin.
static bf_status find_hull(const scene_shape *shape, hull *ret_hull, bf_error *err)
{
    shape_footprint footprint;
    vec2 outline[SCENE_VERTICES_MAX + 1];
    bf_error fault = { .code = BF_OK };

    if (shape->type == SCENE_HULL) {
        if (hull_from_points((const double(*)[3])shape->vertices, shape->n_vertices, ret_hull,
                             &fault) == BF_OK)
            return BF_OK;
        return bf_fail(err, BF_EINPUT, "/cargo/shape/vertices_m", "%s", fault.text);
    }
    if (shape->type == SCENE_CYLINDER) {
        hull_from_cylinder(shape->radius, shape->height, ret_hull);
        return BF_OK;
    }
    footprint = shape_footprint_of(shape);
    size_t n = polygon_convex_hull(footprint.corners, footprint.n_corners, outline);
    double bottom = shape->type == SCENE_PRISM ? 0.0 : -0.5 * shape->height;
    hull_from_outline(outline, n, bottom, bottom + shape->height, ret_hull);
    return BF_OK;
}

static hull_mass mass_of(const scene_shape *shape, const hull *h)
{
    double r = shape->radius, height = shape->height;
    double across = (3.0 * r * r + height * height) / 12.0;

    if (shape->type != SCENE_CYLINDER)
        return hull_measure(h);
    return (
        hull_mass){ M_PI * r * r * height,
                    { 0.0, 0.0, 0.0 },
                    { { { across, 0.0, 0.0 }, { 0.0, across, 0.0 }, { 0.0, 0.0, 0.5 * r * r } } } };
}

/// Moments of a face with weights as in manifold.h: half the two sides that meet in a corner, divided by the
/// outline.
static body_face weigh_face(const hull *h, size_t face_id)
{
    const uint8_t *corner = &h->corner[h->first[face_id]];
    size_t n = (size_t)(h->first[face_id + 1] - h->first[face_id]);
    body_face face = { .radius = 0.0 };
    double weight[SCENE_VERTICES_MAX], outline = 0.0;

    for (size_t k = 0; k < n; k++) {
        vec3 at = hull_vertex(h, corner[k]), last = hull_vertex(h, corner[(k + n - 1) % n]);
        vec3 next = hull_vertex(h, corner[(k + 1) % n]);
        weight[k] = vec3_length(vec3_sub(at, last)) + vec3_length(vec3_sub(next, at));
        outline += weight[k];
    }
    for (size_t k = 0; k < n; k++)
        face.centre = vec3_along(face.centre, weight[k] / outline, hull_vertex(h, corner[k]));
    for (size_t k = 0; k < n; k++) {
        vec3 off = vec3_sub(hull_vertex(h, corner[k]), face.centre);
        const double factor = weight[k] / outline;
        face.spread.row[0] = vec3_along(face.spread.row[0], factor * off.x, off);
        face.spread.row[1] = vec3_along(face.spread.row[1], factor * off.y, off);
        face.spread.row[2] = vec3_along(face.spread.row[2], factor * off.z, off);
        face.skew = vec3_along(face.skew, weight[k] / outline * vec3_dot(off, off), off);
        face.radius = fmax(face.radius, vec3_length(off));
    }
    return face;
}

micro_law body__law(const body_state *s, const body_kind *a, const body_kind *b)
{
    micro_law law = s->cargo;

    law.stiffness /= a->compliance + b->compliance;
    law.damping =
        hardness_dashpot(&s->def, law.damping, law.stiffness, 1.0 / a->mass + 1.0 / b->mass);
    return law;
}

/// Radius of gyration of the pressure under a body that lies flat on its lowest face. If it starts on an
/// edge or a corner, that of a disk of the same area.
static double find_flat_gyration(const body_kind *kind, vec3 down)
{
    const hull *h = &kind->shape;
    size_t face = hull_facing(h, hull_support(h, down), down);
    const mat3 *spread = &kind->faces[face].spread;

    return vec3_dot(h->normal[face], down) > FLAT
               ? sqrt(spread->row[0].x + spread->row[1].y + spread->row[2].z)
               : M_SQRT1_2 * kind->radius;
}

bf_status body__kind_init(const micro_def *def, const micro_kind *from, body_kind *ret_kind,
                          bf_error *err)
{
    const scene_shape *shape = &from->shape;
    const vec3 down = { 0.0, 0.0, -1.0 };
    body_kind *kind = ret_kind;
    vec3 moments;

    bf_status status = find_hull(shape, &kind->shape, err);
    if (status != BF_OK)
        return status;
    kind->mass = from->mass;
    kind->spin_radius = from->spin_radius;
    kind->is_cylinder = shape->type == SCENE_CYLINDER;
    kind->footprint_radius = shape_footprint_of(shape).bounding_radius;
    kind->radius = kind->is_cylinder ? shape->radius : sqrt(shape_footprint_of(shape).area / M_PI);
    kind->half_width = implicit_step_radius_of(shape);
    kind->inner_radius = shape_inner_radius(shape);
    kind->half_height = kind->is_cylinder ? 0.5 * shape->height : 0.0;
    kind->bottom = hull_vertex(&kind->shape, hull_support(&kind->shape, down)).z;
    hull_mass mass = mass_of(shape, &kind->shape);
    mat3 axes = hull_principal_axes(&mass.inertia, &moments);
    kind->centre = mass.centre;
    kind->inertia = vec3_scale(moments, kind->mass);
    kind->turn = quat_of_mat3(&axes);
    hull_move(&kind->shape, kind->centre, &axes);
    for (size_t face = 0; face < kind->shape.n_faces; face++)
        kind->faces[face] = weigh_face(&kind->shape, face);
    kind->flat_gyration = find_flat_gyration(kind, mat3_apply_back(&axes, down));
    const scene_material *material = &from->material;
    const double reduction = def->modulus_reduction;
    micro_law *const laws[] = { &kind->belt_law, &kind->boundary_law };
    kind->compliance = contact_law_compliance(material, reduction);
    kind->belt_law = contact_law_of_disk(&def->contact[SCENE_CONVEYOR_CARGO], material,
                                         &def->conveyor, reduction, kind->radius);
    kind->boundary_law = contact_law_of_line(&def->contact[SCENE_HANDLING_CARGO], material,
                                             &def->handling, reduction);
    for (size_t k = 0; k < sizeof laws / sizeof *laws; k++)
        laws[k]->damping =
            hardness_dashpot(def, laws[k]->damping, laws[k]->stiffness, 1.0 / kind->mass);
    return BF_OK;
}

/// Largest rotational part of the inverse effective mass in a vertex, 1/kg: lever squared by moment of inertia.
static double find_rotational_response(const body_kind *kind)
{
    const hull *h = &kind->shape;
    double most = 0.0;

    for (size_t k = 0; k < h->n_vertices; k++) {
        vec3 at = hull_vertex(h, k);
        most = fmax(most, (at.y * at.y + at.z * at.z) / kind->inertia.x);
        most = fmax(most, (at.x * at.x + at.z * at.z) / kind->inertia.y);
        most = fmax(most, (at.x * at.x + at.y * at.y) / kind->inertia.z);
    }
    return most;
}

// The step is stable while 2 d dt + k dt^2 < 4, where d and k are dashpot and stiffness per mass of
// the fastest motion. In a dense packing that is a part against six neighbours which move the opposite way,
// in contact at both its ends; on the belt a part that stands on one end.
double body__dt_stable(const micro_def *def)
{
    const scene_contact *contact = def->contact;
    double damping =
        fmax(contact[SCENE_CARGO_CARGO].damping, contact[SCENE_HANDLING_CARGO].damping);
    double dashpot = 0.0, spring = 0.0;
    body_kind *kind = memory_alloc(1, sizeof *kind);

    for (size_t k = 0; kind != NULL && k < def->n_kinds; k++) {
        const scene_material *material = &def->kinds[k].material;
        if (body__kind_init(def, &def->kinds[k], kind, NULL) != BF_OK)
            continue;
        double crowded = 6.0 / kind->mass + 2.0 * find_rotational_response(kind);
        double lying = 1.0 / kind->mass + find_rotational_response(kind);
        double stiffness = kind->boundary_law.stiffness;
        for (size_t m = 0; m < def->n_kinds; m++)
            stiffness =
                fmax(stiffness, contact_law_of_line(&contact[SCENE_CARGO_CARGO], material,
                                                    &def->kinds[m].material, def->modulus_reduction)
                                    .stiffness);
        dashpot = fmax(dashpot, fmax(damping * crowded, kind->belt_law.damping * lying));
        spring = fmax(spring, fmax(stiffness * crowded, kind->belt_law.stiffness * lying));
    }
    memory_free(kind);
    return 4.0 / (dashpot + sqrt(dashpot * dashpot + 4.0 * spring));
}
