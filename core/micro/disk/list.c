// What is rebuilt when parts have moved: their order in space, their neighbours, and what each thread advances.

#include "core/micro/disk/disk_priv.h"

#include "core/base/memory.h"
#include "core/base/team.h"

#include <math.h>
#include <string.h>

enum {
    ROWS_AT_FIRST = 7,       // a group, guessed
    GROUPS_A_PARTITION = 64, // least work of a thread
};

// Sets parts that have left to the state they left with. Parts whose exit was not recorded left just now.
static void find_gone(disk_state *s)
{
    for (size_t k = 0; k < s->n_border_parts; k++) {
        const disk_border_part *w = &s->border_parts[k];
        if (w->gone == DISK_HERE)
            continue;
        s->now[w->slot] = w->part;
        s->heading[w->slot] = w->heading;
    }
    s->n_border_parts = 0;
    for (size_t slot = 0; slot < s->n_live; slot++)
        if (s->common.presence[s->id_of[slot]] == MICRO_HERE &&
            surroundings_is_outside(&s->common.around, (vec2){ s->now[slot].x, s->now[slot].y }))
            s->common.presence[s->id_of[slot]] = MICRO_LEFT;
}

// Parts in their new order, and which slots of the old one are not among the live ones; in scratch.
typedef struct new_order {
    disk *parts;
    double *heading;
    uint32_t *id;
    uint8_t *skip;
} new_order;

static bf_status reserve_order(disk_state *s, new_order *ret_sorted)
{
    const size_t n = s->void_slot + 1;
    uint32_t *order, *cell_of;
    const memory_array arrays[] = {
        { &ret_sorted->heading, sizeof *ret_sorted->heading, 0, n },
        { &ret_sorted->id, sizeof *ret_sorted->id, 0, n },
        { &ret_sorted->skip, sizeof *ret_sorted->skip, 0, n },
        { &order, sizeof *order, 0, n },
        { &cell_of, sizeof *cell_of, 0, n },
        { &ret_sorted->parts, sizeof *ret_sorted->parts, 0, s->next == NULL ? n : 0 },
    };

    if (memory_lay_out(&s->scratch, arrays, sizeof arrays / sizeof *arrays) != 0)
        return BF_ENOMEM;
    if (s->next != NULL)
        ret_sorted->parts = s->next;
    neighbours_lend(&s->cells, n, order, cell_of);
    return BF_OK;
}

static void move_part(const disk_state *s, size_t from, const new_order *sorted, size_t to)
{
    sorted->parts[to] = s->now[from];
    sorted->heading[to] = s->heading[from];
    sorted->id[to] = s->id_of[from];
}

static void fill_pad(const disk_state *s, const new_order *sorted, size_t to)
{
    sorted->parts[to] = disk__pad(s, to);
    sorted->heading[to] = 0.0;
    sorted->id[to] = UINT32_MAX;
}

// The rows in `now` for the search, once they are sorted by cell.
static neighbours_parts parts_of(const disk_state *s)
{
    return (neighbours_parts){ .x = &s->now->x,
                               .y = &s->now->y,
                               .stride = DISK_DOUBLES,
                               .radius = &s->now->radius,
                               .radius_stride = DISK_DOUBLES,
                               .id = s->id_of };
}

// Sorts live parts by cell to the front, those that left behind the padding.
static bf_status sort_parts(disk_state *s, bf_error *err)
{
    const neighbours_parts parts = parts_of(s);
    const size_t end = s->n_padded + (s->n - s->n_live);
    new_order sorted;

    if (reserve_order(s, &sorted) != BF_OK)
        return bf_fail(err, BF_ENOMEM, "", "no memory for sorting %zu parts", s->n);
    for (size_t slot = 0; slot < end; slot++)
        sorted.skip[slot] =
            s->id_of[slot] == UINT32_MAX || s->common.presence[s->id_of[slot]] != MICRO_HERE;
    bf_status status =
        neighbours_sort(&s->cells, end, &parts, sorted.skip, 2.0 * s->radius_max + s->skin, err);
    if (status == BF_OK) {
        // Writes the new order: live parts by cell, padding, those that left, padding.
        size_t to = 0;
        for (; to < s->cells.n_live; to++)
            move_part(s, s->cells.order[to], &sorted, to);
        for (; to % DISK_GROUP != 0; to++)
            fill_pad(s, &sorted, to);
        s->n_padded = to;
        for (size_t slot = 0; slot < end; slot++)
            if (s->cells.cell_of[slot] == UINT32_MAX && s->id_of[slot] != UINT32_MAX)
                move_part(s, slot, &sorted, to++);
        for (; to < s->void_slot; to++)
            fill_pad(s, &sorted, to);
        sorted.parts[s->void_slot] = s->now[s->void_slot];
        s->n_live = s->cells.n_live;
        // The parts in their new order become the state. Rows of `next` have what steps do not write.
        memcpy(s->now, sorted.parts, s->void_slot * sizeof *s->now);
        memcpy(s->heading, sorted.heading, s->void_slot * sizeof *s->heading);
        memcpy(s->id_of, sorted.id, s->void_slot * sizeof *s->id_of);
        for (size_t slot = 0; slot < s->void_slot; slot++) {
            const uint32_t id = s->id_of[slot];
            if (id != UINT32_MAX)
                s->slot_of[id] = (uint32_t)slot;
            if (s->spin_deceleration != NULL)
                s->spin_deceleration[slot] =
                    id != UINT32_MAX ? disk__kind_of(s, id)->spin_deceleration : 0.0;
        }
    }
    neighbours_end_loan(&s->cells);
    return status;
}

// Consecutive groups whose list one thread makes, in its own rows.
typedef struct piece {
    size_t group_first, group_last;
    size_t row_first, row_room, n_rows;
    bool is_short; // the memory was not sufficient
} piece;

typedef struct making {
    disk_state *s;
    piece pieces[DISK_PARTITIONS_MAX];
    size_t n_pieces;
} making;

// Lists the neighbours of a group's parts in up to `room` rows. Returns how many; SIZE_MAX: more.
static size_t list_group(const disk_state *s, const neighbours_parts *parts, size_t group,
                         uint32_t *rows, size_t room)
{
    size_t n[DISK_GROUP] = { 0 }, most = 0;

    for (size_t lane = 0; lane < DISK_GROUP; lane++) {
        const size_t slot = group * DISK_GROUP + lane;
        if (slot >= s->n_live)
            continue;
        n[lane] = neighbours_find(&s->cells, parts, s->skin, slot, rows + lane, DISK_GROUP, room);
        if (n[lane] == SIZE_MAX)
            return SIZE_MAX;
        most = n[lane] > most ? n[lane] : most;
    }
    for (size_t row = 0; row < most; row++)
        for (size_t lane = 0; lane < DISK_GROUP; lane++) {
            uint32_t *at = &rows[row * DISK_GROUP + lane];
            *at = (row < n[lane] ? *at : s->void_slot) * DISK_DOUBLES;
        }
    return most;
}

static void list_piece(void *context, size_t item)
{
    making *m = context;
    piece *p = &m->pieces[item];
    disk_state *s = m->s;
    const neighbours_parts parts = parts_of(s);

    p->n_rows = 0;
    for (size_t group = p->group_first; group < p->group_last; group++) {
        size_t at = p->row_first + p->n_rows;
        size_t n = list_group(s, &parts, group, s->list.neighbour + at * DISK_GROUP,
                              p->row_room - p->n_rows);
        if (n == SIZE_MAX) {
            p->is_short = true;
            return;
        }
        s->list.first[group] = (uint32_t)p->n_rows;
        p->n_rows += n;
    }
}

// Room for n rows or more, without those that there are.
static bf_status reserve_rows(disk_state *s, size_t n)
{
    const size_t size = DISK_GROUP * sizeof *s->list.neighbour;
    const size_t n_present = s->scratch.capacity / (2 * size) * 2; // arrays take whole cache lines

    n = n > n_present ? n : n_present;
    s->list.rows_capacity = 0;
    if (n > UINT32_MAX ||
        memory_lay_out(&s->scratch, &(memory_array){ &s->list.neighbour, size, 0, n }, 1) != 0)
        return BF_ENOMEM;
    s->list.rows_capacity = n;
    return BF_OK;
}

static bf_status list_neighbours(disk_state *s)
{
    const size_t n_groups = s->n_padded / DISK_GROUP;
    making m = { .s = s };

    if (reserve_rows(s, (n_groups + 1) * ROWS_AT_FIRST + DISK_GROUP) != BF_OK)
        return BF_ENOMEM;
    for (bool is_short = true; is_short;) {
        const size_t n = m.n_pieces = (size_t)s->n_partitions;
        for (size_t k = 0; k < n; k++) {
            piece *p = &m.pieces[k];
            *p = (piece){ n_groups * k / n, n_groups * (k + 1) / n, 0, 0, 0, false };
            p->row_first = s->list.rows_capacity * k / n;
            p->row_room = s->list.rows_capacity * (k + 1) / n - p->row_first;
        }
        team_for((int)n, n, list_piece, &m);
        is_short = false;
        for (size_t k = 0; k < n; k++)
            is_short = is_short || m.pieces[k].is_short;
        if (is_short && reserve_rows(s, s->list.rows_capacity + s->list.rows_capacity / 4) != BF_OK)
            return BF_ENOMEM;
    }
    // Closes the gaps between the pieces' rows.
    disk_list *list = &s->list;
    size_t n_rows = 0;
    for (size_t k = 0; k < m.n_pieces; k++) {
        piece *p = &m.pieces[k];
        for (size_t group = p->group_first; group < p->group_last; group++)
            list->first[group] += (uint32_t)n_rows;
        memmove(list->neighbour + n_rows * DISK_GROUP, list->neighbour + p->row_first * DISK_GROUP,
                p->n_rows * DISK_GROUP * sizeof *list->neighbour);
        n_rows += p->n_rows;
    }
    list->first[s->n_padded / DISK_GROUP] = (uint32_t)n_rows;
    return BF_OK;
}

disk disk__pad(const disk_state *s, size_t slot)
{
    const scene_rect *d = &s->common.around.domain;
    const scene_edge *edges = s->common.around.edges;
    const double away = DISK_FAR + 4.0 * s->radius_max * (double)slot;
    disk part = s->kinds[0].part;

    // Beyond an open side, where it is inside of every wall.
    part.x = 0.5 * (d->x_min + d->x_max);
    part.y = 0.5 * (d->y_min + d->y_max);
    if (edges[SCENE_EAST] != SCENE_EDGE_WALL)
        part.x = away;
    else if (edges[SCENE_SOUTH] != SCENE_EDGE_WALL)
        part.y = -away;
    else if (edges[SCENE_NORTH] != SCENE_EDGE_WALL)
        part.y = away;
    else
        part.x = -away;
    return part;
}

uint16_t disk__belt_under(const disk_state *s, const disk *part)
{
    return (uint16_t)surroundings_belt_under(&s->common.around, (vec2){ part->x, part->y },
                                             part->radius);
}

static int count_partitions(const disk_state *s)
{
    size_t most = s->n_padded / DISK_GROUP / GROUPS_A_PARTITION;
    int wanted = s->def.n_threads < DISK_PARTITIONS_MAX ? s->def.n_threads : DISK_PARTITIONS_MAX;

    return most < (size_t)wanted ? (most > 1 ? (int)most : 1) : wanted;
}

// Work of the groups before g: their rows and what a group costs by itself, in rows.
static size_t measure_work(const disk_state *s, size_t group)
{
    return s->list.first[group] + 3 * group;
}

// Cuts blocks into partitions of about equal work, and candidates and border parts along with them.
static void cut_partitions(disk_state *s)
{
    const size_t n_groups = s->n_padded / DISK_GROUP, n = (size_t)s->n_partitions;
    disk_partition at = { 0 };

    for (size_t k = 0; k < n; k++) {
        size_t work = measure_work(s, n_groups) * (k + 1) / n;
        at.group_first = at.group_last;
        at.candidate_first = at.candidate_last;
        at.border_first = at.border_last;
        while (at.group_last < n_groups && measure_work(s, at.group_last) < work)
            at.group_last += DISK_BLOCK_GROUPS;
        if (k + 1 == n || at.group_last > n_groups)
            at.group_last = n_groups;
        size_t end = at.group_last * DISK_GROUP;
        while (at.candidate_last < s->n_candidates && s->candidates[at.candidate_last].slot < end)
            at.candidate_last++;
        while (at.border_last < s->n_border_parts && s->border_parts[at.border_last].slot < end)
            at.border_last++;
        s->partitions[k] = at;
    }
}

bf_status disk__rebuild(disk_state *s, bf_error *err)
{
    s->displacement_bound = INFINITY;
    find_gone(s);
    bf_status status = sort_parts(s, err);
    if (status != BF_OK)
        return status;
    s->n_partitions = count_partitions(s);
    if (list_neighbours(s) != BF_OK || disk__find_candidates(s) != BF_OK ||
        disk__find_border_parts(s) != BF_OK ||
        (s->def.integrator == MICRO_VERLET && disk__pair_up(s) != BF_OK))
        return bf_fail(err, BF_ENOMEM, "", "no memory for the neighbours of %zu parts", s->n_live);
    cut_partitions(s);
    disk__plan_tiles(s);
    s->displacement_bound = 0.0;
    s->is_stale = false;
    s->n_builds++;
    return BF_OK;
}
