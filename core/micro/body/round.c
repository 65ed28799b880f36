// Cylinders that stand side by side, or near a plate, or lie against a plane: the contact is a
// line, and its two ends are the contact points, with half of stiffness and dashpot each.
//
// Axes that are tilted against each other by an angle t less than about 0.1 count as parallel: the
// distance is then measured at each end of the height that they share, and is right to r t^2/2.

#include "core/micro/body/body_priv.h"

#include <math.h>

/// Cosine of the largest tilt.
#define UPRIGHT 0.995

/// A cylinder lies against a plane if the cosine between its axis and the normal is below this.
#define ON_ITS_SIDE M_SQRT1_2

/// The contact point of two circles around p and q, or none.
static size_t touch_circles(vec3 p, double radius_p, vec3 q, double radius_q, vec3 along,
                            double near, body_spot *ret_spot)
{
    vec3 to = vec3_sub(q, p);
    double distance = vec3_length(to), depth = radius_p + radius_q - distance;
    vec3 normal = distance > 0.0 ? vec3_scale(to, 1.0 / distance) : vec3_aside(along);

    if (depth <= -near)
        return 0;
    *ret_spot = (body_spot){ vec3_along(p, radius_p - 0.5 * depth, normal), normal, depth, 0.5 };
    return 1;
}

bool body__round_pair(const body_state *s, const body_body *a, const body_body *b, double near,
                      body_spot *ret_spots, size_t *ret_n)
{
    const body_kind *kind_a = &s->kinds[a->kind], *kind_b = &s->kinds[b->kind];
    vec3 axis_a = mat3_column(&a->r, 2), axis_b = mat3_column(&b->r, 2), to = vec3_sub(b->x, a->x);
    double h_a = kind_a->half_height, h_b = kind_b->half_height;

    if (!kind_a->is_round || !kind_b->is_round || fabs(vec3_dot(axis_a, axis_b)) < UPRIGHT)
        return false;
    if (vec3_dot(axis_a, axis_b) < 0.0)
        axis_b = vec3_scale(axis_b, -1.0);
    vec3 along = vec3_unit(vec3_add(axis_a, axis_b));
    double lift = vec3_dot(to, along);
    double low = fmax(-h_a, lift - h_b), high = fmin(h_a, lift + h_b), shared = high - low;
    double radial = vec3_length(vec3_along(to, -lift, along));
    double depth = kind_a->radius + kind_b->radius - radial;
    // One on top of the other is for the hulls.
    if (shared <= 0.0 || (shared < fmin(h_a, h_b) && depth > shared))
        return false;
    *ret_n = 0;
    for (int end = 0; end < 2; end++) {
        double at = end == 0 ? low : high;
        vec3 p = vec3_along(a->x, at / vec3_dot(axis_a, along), axis_a);
        vec3 q = vec3_along(b->x, (at - lift) / vec3_dot(axis_b, along), axis_b);
        *ret_n +=
            touch_circles(p, kind_a->radius, q, kind_b->radius, along, near, &ret_spots[*ret_n]);
    }
    return true;
}

bool body__round_plane(const body_state *s, const body_body *body, const manifold_plane *plane,
                       double near, body_spot *ret_spots, size_t *ret_n)
{
    const body_kind *kind = &s->kinds[body->kind];
    vec3 axis = mat3_column(&body->r, 2);
    double leaning = vec3_dot(axis, plane->normal);

    if (!kind->is_round || fabs(leaning) > ON_ITS_SIDE)
        return false;
    // From the axis to the point of either rim that is deepest.
    vec3 down = vec3_unit(vec3_along(vec3_scale(axis, leaning), -1.0, plane->normal));
    *ret_n = 0;
    for (int end = -1; end <= 1; end += 2) {
        vec3 rim =
            vec3_along(vec3_along(body->x, end * kind->half_height, axis), kind->radius, down);
        double depth = plane->offset - vec3_dot(plane->normal, rim);
        if (depth > -near)
            ret_spots[(*ret_n)++] = (body_spot){ vec3_along(rim, 0.5 * depth, plane->normal),
                                                 plane->normal, depth, 0.5 };
    }
    return true;
}

bool body__round_plate(const body_state *s, const body_body *body, const body_plate *plate,
                       double near, body_spot *ret_spots, size_t *ret_n)
{
    const body_kind *kind = &s->kinds[body->kind];
    vec3 axis = mat3_column(&body->r, 2);

    if (!kind->is_round || fabs(axis.z) < UPRIGHT)
        return false;
    *ret_n = 0;
    for (int end = -1; end <= 1; end += 2) {
        vec3 p = vec3_along(body->x, end * kind->half_height, axis);
        vec3 to = vec3_sub(p, plate->middle);
        double a = vec3_dot(to, plate->along), c = vec3_dot(to, plate->across);
        double beyond = fmax(0.0, fabs(a) - plate->half_length);
        double above = fmax(0.0, fabs(c) - plate->half_thickness);
        double distance = sqrt(beyond * beyond + above * above);
        vec3 normal = vec3_scale(plate->across, c < 0.0 ? -1.0 : 1.0);
        if (distance > 0.0)
            normal = vec3_along(vec3_scale(plate->along, copysign(beyond, a) / distance),
                                copysign(above, c) / distance, plate->across);
        else
            distance = fabs(c) - plate->half_thickness;
        double depth = kind->radius - distance;
        if (depth > -near)
            ret_spots[(*ret_n)++] =
                (body_spot){ vec3_along(p, -distance - 0.5 * depth, normal), normal, depth, 0.5 };
    }
    return true;
}
