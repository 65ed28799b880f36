// Access to the state: read, measure, save and load.

#include "core/micro/disk/implicit.h"
#include "core/micro/disk/parts.h"

#include <math.h>
#include <string.h>

// A part as it is saved. After the parts the data of the integrator follow.
typedef struct saved_part {
    double x, y, vx, vy, spin, heading;
    uint32_t presence, kind;
} saved_part;

disk_border_part *disk__find_left(const disk_state *s, uint32_t slot)
{
    size_t first = 0, last = s->n_border_parts;

    while (first < last) {
        size_t middle = first + (last - first) / 2;
        if (s->border_parts[middle].slot < slot)
            first = middle + 1;
        else
            last = middle;
    }
    bool is_there = first < s->n_border_parts && s->border_parts[first].slot == slot;
    return is_there && s->border_parts[first].gone != DISK_HERE ? &s->border_parts[first] : NULL;
}

static saved_part read_part(const disk_state *s, size_t k)
{
    const uint32_t slot = s->slot_of[k];
    const disk_border_part *left =
        s->common.presence[k] != MICRO_HERE ? disk__find_left(s, slot) : NULL;
    const disk *part = left != NULL ? &left->part : &s->now[slot];

    return (saved_part){ .x = part->x,
                         .y = part->y,
                         .vx = part->vx,
                         .vy = part->vy,
                         .spin = part->spin,
                         .heading = left != NULL ? left->heading : s->heading[slot],
                         .presence = s->common.presence[k],
                         .kind = s->kind_of != NULL ? s->kind_of[k] : 0 };
}

micro_extent disk__extent(const void *state, size_t k)
{
    const disk_state *s = state;
    const saved_part p = read_part(s, k);

    return (micro_extent){ .kind = p.kind,
                           .is_flat = true,
                           .pose = { p.x, p.y, p.heading },
                           .radius = s->kinds[p.kind].part.radius };
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
                         .is_gone = p.presence != MICRO_HERE,
                         .has_fallen = p.presence == MICRO_FELL };
}

void disk__count_contact(const disk_state *s, size_t slot, uint64_t other, double overlap,
                         double radius, disk_contacts *all)
{
    const double relative = overlap / radius;

    if (overlap <= 0.0)
        return;
    all->totals.n_contacts++;
    all->totals.largest_overlap = fmax(all->totals.largest_overlap, overlap);
    all->totals.overlap_share = fmax(all->totals.overlap_share, relative);
    if (relative > all->press.overlap)
        all->press = (micro_press){ .overlap = relative,
                                    .part = s->id_of[slot],
                                    .other = other,
                                    .at = { s->now[slot].x, s->now[slot].y } };
}

// Counts the contacts there are now.
static void count_contacts(const disk_state *s, disk_contacts *all)
{
    const implicit_state *pairs = s->implicit;

    if (pairs != NULL && pairs->is_current)
        disk_implicit__count_contacts(s, pairs, all);
    else
        for (size_t slot = 0; slot < s->n_live; slot++) {
            const disk *part = &s->now[slot];
            for (size_t row = 0; row < disk__n_rows(s, slot); row++) {
                const uint32_t other = disk__neighbour(s, slot, row);
                const disk *with = &s->now[other];
                const double dx = with->x - part->x, dy = with->y - part->y;
                if (other > slot && other < s->n_live)
                    disk__count_contact(s, slot, s->id_of[other],
                                        part->radius + with->radius - sqrt(dx * dx + dy * dy),
                                        fmin(part->radius, with->radius), all);
            }
        }
    for (size_t k = 0; k < s->n_candidates; k++) {
        const size_t slot = s->candidates[k].slot;
        const disk *part = &s->now[slot];
        bool counts;
        const double overlap = disk__overlap(s, part, s->candidates[k].feature, &counts);
        if (counts)
            disk__count_contact(s, slot, UINT64_MAX, overlap, part->radius, all);
    }
}

micro_totals disk__measure(const void *state)
{
    const disk_state *s = state;
    disk_contacts all = { .totals = { .largest_overlap = s->common.largest_overlap,
                                      .overlap_share = s->common.overlap_share } };

    // Without a list, as after an allocation that failed, the contacts are not known.
    if (s->displacement_bound != INFINITY)
        count_contacts(s, &all);
    for (size_t k = 0; k < s->n; k++) {
        const disk *part = &s->now[s->slot_of[k]];
        if (s->common.presence[k] != MICRO_HERE)
            continue;
        double mass = 1.0 / part->inv_mass, inertia = 0.5 * mass * part->radius * part->radius;
        all.totals.n_parts++;
        all.totals.kinetic_energy += 0.5 * mass * (part->vx * part->vx + part->vy * part->vy) +
                                     0.5 * inertia * part->spin * part->spin;
    }
    return all.totals;
}

void disk__press(const void *state, micro_press *ret_press)
{
    disk_contacts all = { .press = { .other = UINT64_MAX } };

    count_contacts(state, &all);
    *ret_press = all.press;
}

// The header of the pairs.
typedef struct state_header {
    uint64_t is_chosen;
    uint64_t n_pairs;
    double displacement_bound;
    double last_bound;
    uint64_t group[IMPLICIT_GROUPS + 1];
} state_header;

void disk_implicit__save(const disk_state *s, checkpoint_writer *w)
{
    const implicit_state *z = s->implicit;

    if (!z)
        return;
    state_header header = { .is_chosen = z->is_chosen,
                            .n_pairs = z->group[IMPLICIT_GROUPS],
                            .displacement_bound = z->displacement_bound,
                            .last_bound = z->last_bound };
    for (size_t g = 0; g <= IMPLICIT_GROUPS; g++)
        header.group[g] = z->group[g];
    checkpoint_write(w, &header, sizeof header);
    for (size_t piece = 0; piece < z->group_piece[IMPLICIT_GROUPS]; piece++)
        for (size_t k = 0; k < z->pieces[piece].n; k++) {
            const implicit_pair pair = disk_implicit__pair(s, z, &z->pieces[piece], k);
            checkpoint_write(w, &pair, sizeof pair);
        }
}

static bool is_header_sound(const state_header *h)
{
    bool is_sound = h->is_chosen <= 1 && h->displacement_bound >= 0.0 && h->last_bound >= 0.0 &&
                    isfinite(h->displacement_bound) && isfinite(h->last_bound) &&
                    h->group[0] == 0 && h->group[IMPLICIT_GROUPS] == h->n_pairs;

    for (size_t g = 0; g < IMPLICIT_GROUPS; g++)
        is_sound = is_sound && h->group[g] <= h->group[g + 1];
    return is_sound;
}

// Contacts with the boundary and pairs of parts must be in their groups, and no part twice in any but the last:
// registers and threads rely on it. last_group has, by id, the last group that a part was found in.
static bool is_pair_sound(const disk_state *s, const implicit_pair *p, uint32_t group,
                          uint32_t *last_group)
{
    const size_t n = s->n, n_features = s->n_faces + s->n_arcs;
    bool is_boundary = implicit_is_at_boundary(p);

    if (p->id[0] >= n || !isfinite(p->normal) || !isfinite(p->sliding))
        return false;
    if (is_boundary ? p->id[1] - IMPLICIT_FEATURE >= n_features
                    : p->id[1] <= p->id[0] || p->id[1] >= n)
        return false;
    if (group != IMPLICIT_REST && is_boundary != (group < IMPLICIT_BOUNDARY))
        return false;
    for (int end = 0; group != IMPLICIT_REST && end < (is_boundary ? 1 : 2); end++) {
        if (last_group[p->id[end]] == group)
            return false;
        last_group[p->id[end]] = group;
    }
    return true;
}

// The pairs, group by group; last_group as above.
static bool load_pairs(const disk_state *s, implicit_state *z, checkpoint_reader *r,
                       uint32_t *last_group)
{
    memset(last_group, 0xff, s->n * sizeof *last_group);
    for (uint32_t group = 0; group < IMPLICIT_GROUPS; group++)
        for (size_t piece = z->group_piece[group]; piece < z->group_piece[group + 1]; piece++)
            for (size_t k = 0; k < z->pieces[piece].n; k++) {
                implicit_pair pair;
                if (!checkpoint_read(r, &pair, sizeof pair) ||
                    !is_pair_sound(s, &pair, group, last_group))
                    return false;
                disk_implicit__set_pair(z, &z->pieces[piece], k, &pair);
            }
    return r->n_left == 0;
}

bf_status disk_implicit__load(disk_state *s, checkpoint_reader *r, bf_error *err)
{
    state_header header;
    size_t group[IMPLICIT_GROUPS + 1];

    if (r->n_left == 0)
        return BF_OK;
    if (s->def.integrator != MICRO_IMPLICIT || !checkpoint_read(r, &header, sizeof header) ||
        !is_header_sound(&header) || header.n_pairs > r->n_left / sizeof(implicit_pair))
        return bf_fail(err, BF_ECORRUPT, "", "the saved pairs of parts are damaged");
    implicit_state *z = s->implicit = disk_implicit__create(s);
    uint32_t *last_group = memory_alloc(s->n + 1, sizeof *last_group);
    bf_status status = z != NULL && last_group != NULL
                           ? BF_OK
                           : bf_fail(err, BF_ENOMEM, "", "no memory for pairs of parts");
    for (size_t g = 0; g <= IMPLICIT_GROUPS; g++)
        group[g] = header.group[g];
    if (status == BF_OK)
        status = disk_implicit__cut(s, z, group, err);
    if (status == BF_OK && !load_pairs(s, z, r, last_group))
        status = bf_fail(err, BF_ECORRUPT, "", "the saved pairs of parts are not of these parts");
    memory_free(last_group);
    if (status != BF_OK)
        return status;
    z->is_chosen = header.is_chosen != 0;
    z->displacement_bound = header.displacement_bound;
    z->last_bound = header.last_bound;
    return BF_OK;
}

void disk__save(const void *state, checkpoint_writer *w)
{
    const disk_state *s = state;

    for (size_t k = 0; k < s->n; k++) {
        const saved_part part = read_part(s, k);
        checkpoint_write(w, &part, sizeof part);
    }
    disk_implicit__save(s, w);
}

bf_status disk__load(void *state, size_t n, checkpoint_reader *r, bf_error *err)
{
    disk_state *s = state;
    const char *parts = checkpoint_read_items(r, n, sizeof(saved_part));
    saved_part part;

    if (parts == NULL)
        return bf_fail(err, BF_ECORRUPT, "", "the saved parts are damaged");
    if (n > s->capacity && disk__resize(s, n) != BF_OK)
        return bf_fail(err, BF_ENOMEM, "", "no memory for %zu parts", n);
    s->n = n;
    for (size_t k = 0; k < n; k++) {
        memcpy(&part, parts + k * sizeof part, sizeof part);
        if (part.presence >= MICRO_PRESENCE_COUNT || part.kind >= s->n_kinds)
            return bf_fail(err, BF_ECORRUPT, "", "the saved parts are damaged");
        s->common.presence[k] = (uint8_t)part.presence;
        if (s->kind_of != NULL)
            s->kind_of[k] = part.kind;
    }
    disk__fill_slots(s);
    for (size_t k = 0; k < n; k++) {
        memcpy(&part, parts + k * sizeof part, sizeof part);
        s->now[k].x = part.x;
        s->now[k].y = part.y;
        s->now[k].vx = part.vx;
        s->now[k].vy = part.vy;
        s->now[k].spin = part.spin;
        s->heading[k] = part.heading;
    }
    disk__pose_plates(s, s->common.steps);
    const bf_status status = disk_implicit__load(s, r, err);
    return status == BF_OK ? disk__rebuild(s, err) : status;
}
