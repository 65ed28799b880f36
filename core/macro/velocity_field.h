/// The static velocity field v_stat of the macroscopic model (section 3.1) and the closed faces.
///
/// By region, B before C before A; the obstacle listed first takes precedence. With t the unit tangent of the
/// obstacle's segment, n its unit normal on the upstream side (n . v_T < 0), a = (x - start).t,
/// d = (x - start).n and 0 <= a <= length:
///
///     field   B: v = |v_T| n      -thickness <= d < 0
///             C: v = (v_T . t) t  0 <= d <= slide_width
///     wall    C as above; no flux through faces whose cell-centre link crosses the line (11b)
///     sealed  line closed as above; B: 0 <= d < band; C: band <= d <= band + slide_width
///     A       everywhere else: v_T of the belt that carries what is at x, zero off every belt
///
/// For the congested closure, whatever the treatment, as `wall` with a slide zone of its own width, slide r with
/// r = aperture_radius(), in which loose cargo goes on at v_T (congested.h); what partly closes faces beside the ends of plates is in aperture.h.
///
/// v_T and the segments are those of surroundings.h. Borders are taken with SCENE_TOLERANCE in favour of
/// the band, and of C on the line itself. Velocities are evaluated at face centres. On a border of two belts
/// the later one counts, as everywhere; but a face along which that one moves has the velocity of the other one if
/// this comes towards the face: what is brought to the border crosses it.
///
/// A cell whose centre is off every belt (surroundings.h) carries nothing: what comes into it falls. So that cargo comes
/// there where a belt ends within a cell, a face off every belt has the velocity of the belt under the centre of a cell
/// beside it, if that moves over the face into one off every belt. Where the cells are too large for a gap, which lies
/// between two centres, what crosses it falls in the cell behind it. With the dispersive closure the faces beside cells off
/// every belt are closed where no belt moves over them: else saturated cargo would disperse off the sides of belts.
///
/// Faces of arcs without an obstacle's region have the velocities of arc_faces.h, which differ from v_T beside borders and guides.
///
/// Walls of the domain are closed lines, and so are sides with a feed, whose density enters in the cells beside them
/// (core/feed/density_entry.h).
///
/// All velocities are linear in v_T, so that a belt whose speed changes (core/world/belt_speeds.h) scales them by
/// its factor: where there is such a belt, the field says which belt each face has its velocity from.

#pragma once

#include "core/base/grid.h"
#include "core/scene/scene.h"

/// What the faces across one axis have; layout as in grid.h.
typedef struct velocity_field_faces {
    double *v;       ///< velocity across them, m/s; 0 on closed ones
    uint8_t *closed; ///< nonzero: nothing crosses this face
    uint16_t *belt;  ///< index of the belt of this face, n_belts of the scene off every belt;
                     ///< NULL if the speeds of all belts are constant
    double *
        aperture; ///< 0 closed to 1 open; this, the next two and the belt for the congested closure
    double *transverse; ///< velocity along them, m/s
    double *loose;      ///< of loose cargo across them, m/s: v_T in slide zones, else v
} velocity_field_faces;

/// Carrying velocity and closed faces on a grid. Owned.
typedef struct velocity_field {
    bf_grid grid;                  ///< the cells between the faces
    velocity_field_faces faces[2]; ///< the x1-faces and the x2-faces
    uint8_t *off;                  ///< nonzero: what is in this cell falls; NULL: nothing can
    struct velocity_field_sampler *sampler; ///< scratch of velocity_field_update()
} velocity_field;

/// Build the field of a checked scenario on its grid, for belts that move at v_T. The caller owns *ret_field:
/// velocity_field_destroy(). BF_ENOMEM.
BF_MUST_CHECK bf_status velocity_field_create(const scene *s, velocity_field **ret_field,
                                              bf_error *err);

/// Make the field again where obstacles have moved: *s differs from the scene that it was created for, which has moving obstacles or
/// belts that may run backwards, in the paths of obstacles and the directions of belts alone, or lacks some obstacles.
/// What differs from the last time are the obstacles in these n rectangles, m, which hold each before and now; n is at most the
/// number of obstacles of the scene. Only faces that they can touch are made. NULL: all are. The field is the same, bit by bit. Never allocates.
void velocity_field_update(velocity_field *f, const scene *s, size_t n, const scene_rect *changed);

/// Free a field; NULL is fine. Always returns NULL.
velocity_field *velocity_field_destroy(velocity_field *f);
