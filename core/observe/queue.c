#include "core/observe/queue.h"

#include "core/scene/shape.h"
#include "core/scene/surroundings.h"

#include <math.h>
#include <string.h>

// Bounds of the states of cargo, relative to the speed of its belt.
static const double free_speed = 0.8, blocked_speed = 0.05;

// A piece of a plate that is less inclined to its belt than this, rad, guides cargo and does not hold it back.
static const double guide_angle = 0.01;

// Of the ends of a queue: what does not count, in parts and of what is held back.
static const double thin_parts = 0.5, thin_portion = 0.05;

queue_state queue_state_of(double speed, double belt_speed)
{
    if (!(speed >= blocked_speed * belt_speed) || belt_speed == 0.0)
        return QUEUE_BLOCKED;
    return speed > free_speed * belt_speed ? QUEUE_FREE : QUEUE_MOVES;
}

static void find_piece(queue *q, size_t obstacle, const surroundings_piece *piece, vec2 belt,
                       bool *has_plate)
{
    const double speed = vec2_length(belt);

    if (!(fabs(vec2_cross(belt, piece->along)) > guide_angle * speed))
        return;
    if (!*has_plate) {
        *has_plate = true;
        q->upstream = vec2_scale(belt, -1.0 / speed);
    }
    q->plate_ends[obstacle] =
        fmin(q->plate_ends[obstacle],
             fmin(vec2_dot(q->upstream, piece->start), vec2_dot(q->upstream, piece->end)));
}

queue queue_of(const scene *s)
{
    const scene_rect *d = &s->domain;
    const bool is_straight = s->n_belts > 0 && !s->belts[0].arc.is_given;
    const vec2 velocity = is_straight ? s->belts[0].velocity : (vec2){ 0.0, 0.0 };
    const double speed = vec2_length(velocity);
    queue q = { .upstream = speed > 0.0 ? vec2_scale(velocity, -1.0 / speed) : (vec2){ -1.0, 0.0 },
                .width = 2.0 * shape_inner_radius(&s->cargo[0].shape),
                .n_plates = s->n_obstacles };

    // The most downstream point of each plate, along the belt under the first one.
    const surroundings around = surroundings_of(s);
    bool has_plate = false;
    for (size_t k = 0; k < s->n_obstacles; k++) {
        q.plate_ends[k] = (double)INFINITY;
        for (size_t p = 0; p + 1 < s->obstacles[k].n_points; p++) {
            const surroundings_piece piece = surroundings_piece_of(&around, &s->obstacles[k], p);
            const vec2 middle = vec2_scale(vec2_add(piece.start, piece.end), 0.5);
            find_piece(&q, k, &piece, surroundings_velocity_under(&around, middle), &has_plate);
        }
    }
    q.start = fmin(q.upstream.x * d->x_min, q.upstream.x * d->x_max) +
              fmin(q.upstream.y * d->y_min, q.upstream.y * d->y_max);
    q.span =
        fabs(q.upstream.x) * (d->x_max - d->x_min) + fabs(q.upstream.y) * (d->y_max - d->y_min);
    return q;
}

static void add_to_bin(queue_bins *bins, double distance, double span, double parts)
{
    const double place = fmin(fmax(distance / span, 0.0) * QUEUE_BINS, QUEUE_BINS - 1);
    const size_t k = (size_t)place;

    if (bins->parts[k] == 0.0)
        bins->nearest[k] = bins->farthest[k] = distance;
    bins->parts[k] += parts;
    bins->nearest[k] = fmin(bins->nearest[k], distance);
    bins->farthest[k] = fmax(bins->farthest[k], distance);
}

void queue_add(queue *q, vec2 at, double parts)
{
    const double upstream = vec2_dot(q->upstream, at);
    double next = (double)INFINITY;

    if (!(parts > 0.0))
        return;
    q->parts += parts;
    for (size_t k = 0; k < q->n_plates; k++)
        if (upstream >= q->plate_ends[k])
            next = fmin(next, upstream - q->plate_ends[k]);
    if (isinf(next))
        add_to_bin(&q->elsewhere, upstream - q->start, q->span, parts);
    else
        add_to_bin(&q->before_plates, next, q->span, parts);
}

// The distance beyond which only thin ends are; -1: there is nothing.
static double far_end(const queue_bins *bins, double thin)
{
    double parts = 0.0;

    for (size_t k = QUEUE_BINS; k-- > 0;)
        if ((parts += bins->parts[k]) > thin)
            return bins->farthest[k];
    return -1.0;
}

// The distance before which only thin ends are, where there is something.
static double near_end(const queue_bins *bins, double thin)
{
    double parts = 0.0;
    size_t k = 0;

    while (k + 1 < QUEUE_BINS && (parts += bins->parts[k]) <= thin)
        k++;
    return bins->nearest[k];
}

double queue_length(const queue *q)
{
    const double thin = fmin(thin_parts, thin_portion * q->parts);
    const double before_plates = fmax(far_end(&q->before_plates, thin), 0.0);
    const double last = far_end(&q->elsewhere, thin);

    if (last < 0.0)
        return before_plates;
    return fmax(before_plates, last - near_end(&q->elsewhere, thin) + q->width);
}

void queue_clear(queue *q)
{
    if (q->parts == 0.0)
        return;
    q->parts = 0.0;
    memset(q->before_plates.parts, 0, sizeof q->before_plates.parts);
    memset(q->elsewhere.parts, 0, sizeof q->elsewhere.parts);
}
