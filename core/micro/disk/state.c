// The planar path from outside: reading, measuring, saving.

#include "core/micro/disk/disk_priv.h"

#include <math.h>
#include <string.h>

// A part as it is saved.
typedef struct saved_part {
    double x, y, vx, vy, spin, heading, is_gone;
} saved_part;

// What stands before the parts of a saved state; what the integrator adds stands behind them.
typedef struct saved_header {
    uint64_t steps;
    double largest_overlap;
    double overlap_share;
} saved_header;

// The watch of a part that left after the last list was made, or NULL.
static const disk_watch *find_left(const disk_state *s, uint32_t place)
{
    size_t first = 0, last = s->n_watches;

    while (first < last) {
        size_t middle = first + (last - first) / 2;
        if (s->watches[middle].place < place)
            first = middle + 1;
        else
            last = middle;
    }
    bool is_there = first < s->n_watches && s->watches[first].place == place;
    return is_there && s->watches[first].gone != DISK_HERE ? &s->watches[first] : NULL;
}

static saved_part read_part(const disk_state *s, size_t k)
{
    const uint32_t place = s->place[k];
    const disk_watch *left = s->is_gone[k] != 0 ? find_left(s, place) : NULL;
    const disk_row *row = left != NULL ? &left->row : &s->now[place];

    return (saved_part){ .x = row->x,
                         .y = row->y,
                         .vx = row->vx,
                         .vy = row->vy,
                         .spin = row->spin,
                         .heading = left != NULL ? left->heading : s->heading[place],
                         .is_gone = s->is_gone[k] };
}

micro_part disk__part(const void *state, size_t k)
{
    const disk_state *s = state;
    const saved_part p = read_part(s, k);
    const double height = disk__kind_of(s, k)->height;

    return (micro_part){ .x = { p.x, p.y, 0.5 * height },
                         .q = { cos(0.5 * p.heading), 0.0, 0.0, sin(0.5 * p.heading) },
                         .v = { p.vx, p.vy, 0.0 },
                         .w = { 0.0, 0.0, p.spin },
                         .heading = p.heading,
                         .is_gone = p.is_gone != 0.0 };
}

static void count_contact(micro_totals *totals, double overlap, double radius)
{
    if (overlap <= 0.0)
        return;
    totals->n_contacts++;
    totals->largest_overlap = fmax(totals->largest_overlap, overlap);
    totals->overlap_share = fmax(totals->overlap_share, overlap / radius);
}

static void count_contacts_of(const disk_state *s, size_t place, micro_totals *totals)
{
    const disk_row *part = &s->now[place];

    for (size_t slot = 0; slot < disk__slots(s, place); slot++) {
        uint32_t other = disk__neighbour(s, place, slot);
        const disk_row *with = &s->now[other];
        double dx = with->x - part->x, dy = with->y - part->y;
        if (other > place && other != s->void_place)
            count_contact(totals, part->radius + with->radius - sqrt(dx * dx + dy * dy),
                          fmin(part->radius, with->radius));
    }
}

micro_totals disk__measure(const void *state)
{
    const disk_state *s = state;
    micro_totals totals = { .largest_overlap = s->largest_overlap,
                            .overlap_share = s->overlap_share };

    for (size_t k = 0; k < s->n; k++) {
        const disk_row *row = &s->now[s->place[k]];
        if (s->is_gone[k] != 0)
            continue;
        double mass = 1.0 / row->inverse_mass, inertia = 0.5 * mass * row->radius * row->radius;
        totals.n_parts++;
        totals.kinetic_energy += 0.5 * mass * (row->vx * row->vx + row->vy * row->vy) +
                                 0.5 * inertia * row->spin * row->spin;
    }
    if (s->travel == INFINITY)
        return totals;
    for (size_t place = 0; place < s->n_live; place++)
        count_contacts_of(s, place, &totals);
    for (size_t k = 0; k < s->n_touches; k++) {
        const disk_row *part = &s->now[s->touches[k].place];
        bool counts;
        double overlap = disk__overlap(s, part, s->touches[k].feature, &counts);
        if (counts)
            count_contact(&totals, overlap, part->radius);
    }
    return totals;
}

void disk__save(const void *state, checkpoint_writer *w)
{
    const disk_state *s = state;
    const saved_header header = { s->steps, s->largest_overlap, s->overlap_share };

    checkpoint_write(w, &header, sizeof header);
    for (size_t k = 0; k < s->n; k++) {
        const saved_part part = read_part(s, k);
        checkpoint_write(w, &part, sizeof part);
    }
    disk__implicit_save(s, w);
}

static void take_parts(disk_state *s, const char *parts)
{
    disk__place_parts(s);
    for (size_t k = 0; k < s->n; k++) {
        saved_part part;
        memcpy(&part, parts + k * sizeof part, sizeof part);
        s->now[k].x = part.x;
        s->now[k].y = part.y;
        s->now[k].vx = part.vx;
        s->now[k].vy = part.vy;
        s->now[k].spin = part.spin;
        s->heading[k] = part.heading;
        s->is_gone[k] = part.is_gone != 0.0;
    }
}

bf_status disk__load(void *state, checkpoint_reader *r, bf_error *err)
{
    disk_state *s = state;
    saved_header header;
    const char *parts = NULL;

    if (checkpoint_read(r, &header, sizeof header))
        parts = checkpoint_read_items(r, s->n, sizeof(saved_part));
    if (parts == NULL)
        return bf_fail(err, BF_ECORRUPT, "", "the saved state is too short");
    bf_status status = disk__implicit_load(s, r, err);
    if (status != BF_OK)
        return status;
    take_parts(s, parts);
    s->steps = header.steps;
    s->largest_overlap = header.largest_overlap;
    s->overlap_share = header.overlap_share;
    return disk__rebuild(s, err);
}
