// Plates that move: before each step their faces and arcs are made from those as in the document, turned about the
// pivot and shifted, so that rounding does not add up and upstream sides stay what they are there.

#include "core/micro/disk/disk_priv.h"

#include "core/base/memory.h"
#include "core/scene/plate_range.h"

#include <math.h>
#include <string.h>

void disk__plates_fini(disk_state *s)
{
    memory_free(s->plates.of);
    memory_free(s->plates.faces);
    memory_free(s->plates.arcs);
    memory_free(s->plates.surfaces);
}

void disk__add_moving_plate(disk_state *s, const scene_obstacle *obstacle, size_t index,
                            size_t face_first, size_t arc_first)
{
    s->plates.of[s->plates.n++] = (disk_plate){ .obstacle = index,
                                                .face_first = face_first,
                                                .face_last = s->n_faces,
                                                .arc_first = arc_first,
                                                .arc_last = s->n_arcs,
                                                .radius = plate_range_radius(obstacle),
                                                .depth = s->radius_max + obstacle->thickness };
}

bf_status disk__copy_boundary(disk_state *s, bf_error *err)
{
    disk_plates *plates = &s->plates;

    if (plates->n == 0)
        return BF_OK;
    plates->faces = memory_alloc(s->n_faces, sizeof *plates->faces);
    plates->arcs = memory_alloc(s->n_arcs, sizeof *plates->arcs);
    plates->surfaces = memory_alloc(s->n_faces + s->n_arcs, sizeof *plates->surfaces);
    if (plates->faces == NULL || plates->arcs == NULL || plates->surfaces == NULL)
        return bf_fail(err, BF_ENOMEM, "/obstacles", "no memory for the obstacles");
    memcpy(plates->faces, s->faces, s->n_faces * sizeof *plates->faces);
    memcpy(plates->arcs, s->arcs, s->n_arcs * sizeof *plates->arcs);
    disk__pose_plates(s, 0);
    return BF_OK;
}

static disk_face turn_face(const disk_face *from, const plate_pose *pose)
{
    const vec2 p = plate_pose_move(pose, (vec2){ from->px, from->py });
    const vec2 n = plate_pose_turn(pose, (vec2){ from->nx, from->ny });
    disk_face face = *from;

    face.px = p.x;
    face.py = p.y;
    face.nx = n.x;
    face.ny = n.y;
    return face;
}

static disk_arc turn_arc(const disk_arc *from, const plate_pose *pose)
{
    const vec2 p = plate_pose_move(pose, (vec2){ from->px, from->py });
    const vec2 e = plate_pose_turn(pose, (vec2){ from->ex, from->ey });
    const vec2 f = plate_pose_turn(pose, (vec2){ from->fx, from->fy });

    return (disk_arc){ p.x, p.y, from->radius, e.x, e.y, f.x, f.y, from->friction };
}

void disk__pose_plates(disk_state *s, uint64_t n_before)
{
    const disk_plates *plates = &s->plates;

    for (size_t k = 0; k < plates->n; k++) {
        const disk_plate *plate = &plates->of[k];
        const plate_motion_step step = plate_motion_in_step(
            &s->common.world->plates, plate->obstacle, n_before, s->def.dt, plate->depth);
        const vec2 pivot = plate_pose_pivot(&step.pose);
        const disk_surface surface = { .px = pivot.x,
                                       .py = pivot.y,
                                       .spin = step.spin,
                                       .recess = fmin(step.recess, DISK_FAR),
                                       .growth = step.growth,
                                       .vx = step.velocity.x,
                                       .vy = step.velocity.y };
        for (size_t i = plate->face_first; i < plate->face_last; i++) {
            s->faces[i] = turn_face(&plates->faces[i], &step.pose);
            plates->surfaces[i] = surface;
        }
        for (size_t i = plate->arc_first; i < plate->arc_last; i++) {
            s->arcs[i] = turn_arc(&plates->arcs[i], &step.pose);
            plates->surfaces[s->n_faces + i] = surface;
        }
    }
}

void disk__pose_plates_by_team(const driver_member *m)
{
    disk_state *s = m->state;

    if (s->plates.n == 0)
        return;
    if (m->index == 0)
        disk__pose_plates(s, s->common.steps + m->n_made);
    driver_wait(m);
}

double disk__plates_travel(const disk_state *s, uint64_t n_before)
{
    const double dt = s->def.dt;
    double speed = 0.0;

    for (size_t k = 0; k < s->plates.n; k++) {
        const disk_plate *plate = &s->plates.of[k];
        const plate_motion_step step = plate_motion_in_step(
            &s->common.world->plates, plate->obstacle, n_before, dt, plate->depth);
        speed =
            fmax(speed, fabs(step.spin) * plate->radius + vec2_length(step.velocity) + step.growth);
    }
    return speed * dt;
}

vec2 disk__surface_velocity(const disk_surface *surface, vec2 n, vec2 at)
{
    const vec2 rigid = plate_pose_velocity((vec2){ surface->px, surface->py }, surface->spin,
                                           (vec2){ surface->vx, surface->vy }, at);

    return vec2_add(rigid, vec2_scale(n, surface->growth));
}

// The normal of a feature towards a part.
static vec2 find_normal(const disk_state *s, const disk *part, uint32_t feature)
{
    if (feature < s->n_faces)
        return (vec2){ s->faces[feature].nx, s->faces[feature].ny };
    const disk_arc *arc = &s->arcs[feature - s->n_faces];
    const vec2 to = { part->x - arc->px, part->y - arc->py };
    return vec2_scale(to, 1.0 / vec2_length(to));
}

static void add_load(const disk_state *s, const disk_plate *plate, const disk_candidate *candidate,
                     plate_load *load)
{
    const size_t arc = candidate->feature - s->n_faces;
    const disk *part = &s->now[candidate->slot];
    const bool is_of =
        candidate->feature < s->n_faces
            ? plate->face_first <= candidate->feature && candidate->feature < plate->face_last
            : plate->arc_first <= arc && arc < plate->arc_last;
    bool counts;

    if (!is_of)
        return;
    const double overlap = disk__overlap(s, part, candidate->feature, &counts);
    if (!counts || overlap <= 0.0)
        return;
    const double force = s->handling.line / (part->compliance + s->handling_compliance) * overlap;
    const vec2 normal = find_normal(s, part, candidate->feature);
    const vec2 at = vec2_sub((vec2){ part->x, part->y }, vec2_scale(normal, part->radius));
    const disk_surface *surface = &s->plates.surfaces[candidate->feature];
    load->force += force;
    load->resultant = vec2_sub(load->resultant, vec2_scale(normal, force));
    load->torque -= force * vec2_cross(vec2_sub(at, (vec2){ surface->px, surface->py }), normal);
}

plate_load disk__load_on(void *state, size_t obstacle)
{
    const disk_state *s = state;
    plate_load load = { .torque = 0.0 };

    for (size_t k = 0; k < s->plates.n; k++)
        for (size_t m = 0; m < s->n_candidates && s->plates.of[k].obstacle == obstacle; m++)
            add_load(s, &s->plates.of[k], &s->candidates[m], &load);
    return load;
}
