// Sorting parts in space and listing their neighbours.

#include "core/micro/disk/disk_priv.h"

#include "core/base/memory.h"
#include "core/base/team.h"

#include <math.h>
#include <string.h>

enum {
    SLOTS_AT_FIRST = 7,  // a group, guessed for the first list
    GROUPS_A_SHARE = 64, // least work of a thread
};

// Gives parts that are gone the state they left with. Parts that left unseen left just now.
static void find_gone(disk_state *s)
{
    for (size_t k = 0; k < s->n_watches; k++) {
        const disk_watch *w = &s->watches[k];
        if (w->gone == DISK_HERE)
            continue;
        s->now[w->place] = w->row;
        s->heading[w->place] = w->heading;
    }
    s->n_watches = 0;
    for (size_t place = 0; place < s->n_live; place++)
        if (surroundings_is_outside(&s->around, (vec2){ s->now[place].x, s->now[place].y }))
            s->is_gone[s->number[place]] = 1;
}

// Copies what stands in a place into a new one: rows to next, the rest to scratch.
static void move_part(disk_state *s, size_t from, size_t to)
{
    s->next[to] = s->now[from];
    s->scratch[to] = s->heading[from];
    s->list.scratch[to] = s->number[from];
}

static void fill_pad(disk_state *s, size_t to)
{
    s->next[to] = disk__pad(s, to);
    s->scratch[to] = 0.0;
    s->list.scratch[to] = UINT32_MAX;
}

// What move_part() put aside becomes the state.
static void take_moved(disk_state *s)
{
    uint32_t *numbers = s->number;
    double *headings = s->heading;

    disk__swap(s);
    s->number = s->list.scratch;
    s->list.scratch = numbers;
    s->heading = s->scratch;
    s->scratch = headings;
    memcpy(s->next, s->now, (s->void_place + 1) * sizeof *s->now);
    for (size_t place = 0; place < s->void_place; place++) {
        const uint32_t number = s->number[place];
        if (number != UINT32_MAX)
            s->place[number] = (uint32_t)place;
        if (s->brake != NULL)
            s->brake[place] = number != UINT32_MAX ? disk__kind_of(s, number)->brake : 0.0;
    }
}

// The rows in `now` for the search, once they are sorted by cell.
static neighbours_parts parts_of(const disk_state *s)
{
    return (neighbours_parts){ .x = &s->now->x,
                               .y = &s->now->y,
                               .stride = DISK_ROW,
                               .radius = &s->now->radius,
                               .radius_stride = DISK_ROW,
                               .id = s->number };
}

// Sorts live parts by cell to the front, gone ones behind the pads.
static bf_status sort_parts(disk_state *s, bf_error *err)
{
    const neighbours_parts parts = parts_of(s);
    const size_t n_filed = s->n - s->n_live, filed_at = s->n_padded;
    uint8_t *skip = (uint8_t *)s->list.scratch;
    size_t to = 0;

    for (size_t place = 0; place < s->n_live; place++)
        skip[place] = s->is_gone[s->number[place]];
    bf_status status =
        neighbours_sort(&s->cells, s->n_live, &parts, skip, 2.0 * s->radius_max + s->skin, err);
    if (status != BF_OK)
        return status;
    for (; to < s->cells.n_live; to++)
        move_part(s, s->cells.order[to], to);
    for (; to % DISK_GROUP != 0; to++)
        fill_pad(s, to);
    s->n_padded = to;
    for (size_t place = 0; place < s->n_live; place++)
        if (s->cells.cell_of[place] == UINT32_MAX)
            move_part(s, place, to++);
    for (size_t k = 0; k < n_filed; k++)
        move_part(s, filed_at + k, to++);
    for (; to < s->void_place; to++)
        fill_pad(s, to);
    s->next[s->void_place] = s->now[s->void_place];
    s->n_live = s->cells.n_live;
    take_moved(s);
    return BF_OK;
}

// A run of groups whose list one thread makes, in slots of its own.
typedef struct piece {
    size_t group_first, group_last;
    size_t slot_first, slot_room, n_slots;
    bool is_short; // the room was not enough
} piece;

typedef struct making {
    disk_state *s;
    piece pieces[DISK_SHARES_MAX];
    size_t n_pieces;
} making;

// Lists the neighbours of a group's parts in up to `room` slots. Returns how many; SIZE_MAX: more.
static size_t list_group(const disk_state *s, const neighbours_parts *parts, size_t group,
                         uint32_t *slots, size_t room)
{
    size_t n[DISK_GROUP] = { 0 }, most = 0;

    for (size_t lane = 0; lane < DISK_GROUP; lane++) {
        const size_t place = group * DISK_GROUP + lane;
        if (place >= s->n_live)
            continue;
        n[lane] = neighbours_find(&s->cells, parts, s->skin, place, slots + lane, DISK_GROUP, room);
        if (n[lane] == SIZE_MAX)
            return SIZE_MAX;
        most = n[lane] > most ? n[lane] : most;
    }
    for (size_t slot = 0; slot < most; slot++)
        for (size_t lane = 0; lane < DISK_GROUP; lane++) {
            uint32_t *at = &slots[slot * DISK_GROUP + lane];
            *at = (slot < n[lane] ? *at : s->void_place) * DISK_ROW;
        }
    return most;
}

static void list_piece(void *context, size_t item)
{
    making *m = context;
    piece *p = &m->pieces[item];
    disk_state *s = m->s;
    const neighbours_parts parts = parts_of(s);

    p->n_slots = 0;
    for (size_t group = p->group_first; group < p->group_last; group++) {
        size_t at = p->slot_first + p->n_slots;
        size_t n = list_group(s, &parts, group, s->list.neighbour + at * DISK_GROUP,
                              p->slot_room - p->n_slots);
        if (n == SIZE_MAX) {
            p->is_short = true;
            return;
        }
        s->list.first[group] = (uint32_t)p->n_slots;
        p->n_slots += n;
    }
}

static void cut_pieces(making *m)
{
    const disk_state *s = m->s;
    const size_t n_groups = s->n_padded / DISK_GROUP, n = (size_t)s->n_shares;

    m->n_pieces = n;
    for (size_t k = 0; k < n; k++) {
        piece *p = &m->pieces[k];
        *p = (piece){ n_groups * k / n, n_groups * (k + 1) / n, 0, 0, 0, false };
        p->slot_first = s->list.slots_capacity * k / n;
        p->slot_room = s->list.slots_capacity * (k + 1) / n - p->slot_first;
    }
}

static bf_status grow(disk_list *list, size_t n_slots)
{
    if (n_slots > UINT32_MAX)
        return BF_ENOMEM;
    memory_free(list->neighbour);
    list->slots_capacity = 0;
    list->neighbour = memory_alloc(n_slots, DISK_GROUP * sizeof *list->neighbour);
    if (list->neighbour == NULL)
        return BF_ENOMEM;
    list->slots_capacity = n_slots;
    return BF_OK;
}

// Closes the gaps between the pieces' slots.
static void join_pieces(making *m)
{
    disk_list *list = &m->s->list;
    size_t n_slots = 0;

    for (size_t k = 0; k < m->n_pieces; k++) {
        piece *p = &m->pieces[k];
        for (size_t group = p->group_first; group < p->group_last; group++)
            list->first[group] += (uint32_t)n_slots;
        memmove(list->neighbour + n_slots * DISK_GROUP,
                list->neighbour + p->slot_first * DISK_GROUP,
                p->n_slots * DISK_GROUP * sizeof *list->neighbour);
        n_slots += p->n_slots;
    }
    list->first[m->s->n_padded / DISK_GROUP] = (uint32_t)n_slots;
}

static bool is_short(const making *m)
{
    for (size_t k = 0; k < m->n_pieces; k++)
        if (m->pieces[k].is_short)
            return true;
    return false;
}

static bf_status list_neighbours(disk_state *s)
{
    const size_t n_groups = s->n_padded / DISK_GROUP;
    making m = { .s = s };

    if (s->list.slots_capacity == 0 &&
        grow(&s->list, (n_groups + 1) * SLOTS_AT_FIRST + DISK_GROUP) != BF_OK)
        return BF_ENOMEM;
    for (;;) {
        cut_pieces(&m);
        team_for((int)m.n_pieces, m.n_pieces, list_piece, &m);
        if (!is_short(&m))
            break;
        if (grow(&s->list, s->list.slots_capacity + s->list.slots_capacity / 4) != BF_OK)
            return BF_ENOMEM;
    }
    join_pieces(&m);
    return BF_OK;
}

static int count_shares(const disk_state *s)
{
    size_t most = s->n_padded / DISK_GROUP / GROUPS_A_SHARE;
    int wanted = s->def.n_threads < DISK_SHARES_MAX ? s->def.n_threads : DISK_SHARES_MAX;

    return most < (size_t)wanted ? (most > 1 ? (int)most : 1) : wanted;
}

// Work of the groups before g: their slots and what a group costs by itself, in slots.
static size_t measure_work(const disk_state *s, size_t group)
{
    return s->list.first[group] + 3 * group;
}

// Cuts groups into shares of about equal work, and touches and watches along with them.
static void cut_shares(disk_state *s)
{
    const size_t n_groups = s->n_padded / DISK_GROUP, n = (size_t)s->n_shares;
    disk_share at = { 0 };

    for (size_t k = 0; k < n; k++) {
        size_t work = measure_work(s, n_groups) * (k + 1) / n;
        at.group_first = at.group_last;
        at.touch_first = at.touch_last;
        at.watch_first = at.watch_last;
        while (at.group_last < n_groups && measure_work(s, at.group_last) < work)
            at.group_last++;
        if (k + 1 == n)
            at.group_last = n_groups;
        size_t end = at.group_last * DISK_GROUP;
        while (at.touch_last < s->n_touches && s->touches[at.touch_last].place < end)
            at.touch_last++;
        while (at.watch_last < s->n_watches && s->watches[at.watch_last].place < end)
            at.watch_last++;
        s->shares[k] = at;
    }
}

bf_status disk__rebuild(disk_state *s, bf_error *err)
{
    s->travel = INFINITY;
    find_gone(s);
    bf_status status = sort_parts(s, err);
    if (status != BF_OK)
        return status;
    s->n_shares = count_shares(s);
    if (list_neighbours(s) != BF_OK || disk__find_touches(s) != BF_OK ||
        disk__find_watches(s) != BF_OK)
        return bf_fail(err, BF_ENOMEM, "", "no memory for the neighbours of %zu parts", s->n_live);
    cut_shares(s);
    disk__cut_tiles(s);
    s->travel = 0.0;
    s->n_builds++;
    return BF_OK;
}
