#include "server/run/snapshots.h"

#include "api/results/events.h"
#include "core/base/memory.h"

static bf_status fail_memory(bf_error *err)
{
    return bf_fail(err, BF_ENOMEM, "", "the service has no memory to take a run's snapshot");
}

store_item *snapshots_add_item(snapshots_items *items, api_event_type type)
{
    if (memory_reserve(&items->items, &items->capacity, items->n + 1, sizeof *items->items) != 0)
        return NULL;
    store_item *item = &items->items[items->n++];
    *item = (store_item){ .type = type };
    return item;
}

static void free_item(store_item *item)
{
    buffer_fini(&item->event);
    buffer_fini(&item->t);
    buffer_fini(&item->values);
    buffer_fini(&item->figures);
}

void snapshots_drop_items(snapshots_items *items)
{
    for (size_t i = 0; i < items->n; i++)
        free_item(&items->items[i]);
    items->n = 0;
}

void snapshots_fini_items(snapshots_items *items)
{
    snapshots_drop_items(items);
    memory_free(items->items);
    *items = (snapshots_items){ .n = 0 };
}

void snapshots_forget(snapshots_incoming *c)
{
    free_item(&c->header);
    *c = (snapshots_incoming){ .has_header = false };
}

bool snapshots_may_come(const snapshots_incoming *c, const frame *f)
{
    const frame_type next = c->has_header ? FRAME_PARTS : FRAME_SNAPSHOT;

    if (f->type == FRAME_SLICE)
        return f->slice.of == (uint32_t)next;
    if (c->n_density > 0 || c->has_header || f->type == FRAME_PARTS)
        return f->type == next;
    return true;
}

// The last item, if it is of the snapshot under way.
static store_item *find_open(const snapshots_items *items)
{
    store_item *last = items->n == 0 ? NULL : &items->items[items->n - 1];

    return last != NULL && last->type == API_EVENT_SNAPSHOT && last->is_open ? last : NULL;
}

static store_item *open_item(const snapshots_incoming *c, snapshots_items *items)
{
    store_item *item = snapshots_add_item(items, API_EVENT_SNAPSHOT);

    if (item == NULL)
        return NULL;
    item->first = item->snapshot.index = c->index;
    item->rho_at = c->n_density;
    item->parts_at = c->n_parts;
    item->is_open = true;
    return item;
}

// Bytes that may come of an array at most: with feeds only the frame behind the slices says how many rows there are.
static uint64_t limit_of(const frame_begin *begin, bool is_parts)
{
    const frame parts = { .type = FRAME_PARTS,
                          .parts = { .n_parts = begin->n_parts, .n_values = begin->n_values } };

    if (!is_parts)
        return grid_cells(&begin->grid) * sizeof(float);
    return frame_has_ids(begin->n_values) ? FRAME_PAYLOAD_MAX : frame_array_bytes(&parts);
}

static bool follows(const snapshots_incoming *c, const frame_slice *s, uint64_t limit)
{
    const uint64_t n_before = s->of == FRAME_PARTS ? c->n_parts : c->n_density;

    return s->at == n_before && s->at % FRAME_SLICE_BYTES == 0 && s->n > 0 &&
           s->n <= FRAME_SLICE_BYTES && s->at + s->n <= limit &&
           (c->n_density == 0 || s->index == c->index);
}

// Density and parts may share an item; each further slice of an array is one of its own.
static bf_status take_slice(snapshots_incoming *c, const frame_begin *begin, const frame_slice *s,
                            snapshots_items *items, bf_error *err)
{
    const bool is_parts = s->of == FRAME_PARTS;
    store_item *item = find_open(items);

    if (!follows(c, s, limit_of(begin, is_parts)))
        return bf_fail(err, BF_ECORRUPT, "", "the solver sent a slice that does not follow");
    c->index = s->index;
    if (item == NULL || item->parts.n > 0 || (!is_parts && item->rho.n > 0))
        item = open_item(c, items);
    if (item == NULL)
        return fail_memory(err);
    *(is_parts ? &item->parts : &item->rho) =
        (bf_buffer){ .bytes = (char *)(uintptr_t)s->bytes, .n = s->n };
    *(is_parts ? &c->n_parts : &c->n_density) += s->n;
    return BF_OK;
}

static bf_status complete(snapshots_incoming *c, snapshots_items *items, bf_error *err)
{
    store_item *item = find_open(items);

    if (item == NULL && (item = open_item(c, items)) == NULL)
        return fail_memory(err);
    item->is_open = false;
    item->snapshot = c->header.snapshot;
    item->event = c->header.event;
    *c = (snapshots_incoming){ .has_header = false };
    return BF_OK;
}

static bf_status take_snapshot(snapshots_incoming *c, const char *run_id, const frame_begin *begin,
                               const frame *f, snapshots_items *items, bf_error *err)
{
    const frame_snapshot *s = &f->snapshot;
    const bool has_parts = begin->n_values > 0;

    if (s->n1 != begin->grid.n1 || s->n2 != begin->grid.n2 || s->index != c->index ||
        frame_array_bytes(f) != c->n_density)
        return bf_fail(err, BF_ECORRUPT, "", "the solver sent a snapshot of another size");
    c->has_header = true;
    c->header.snapshot =
        (api_snapshot){ .index = s->index, .t = s->t, .peak = s->peak, .mass = s->mass };
    bf_status status = events_snapshot(run_id, s, has_parts, &c->header.event, err);
    return status == BF_OK && !has_parts ? complete(c, items, err) : status;
}

bf_status snapshots_take(snapshots_incoming *c, const char *run_id, const frame_begin *begin,
                         const frame *f, snapshots_items *items, bf_error *err)
{
    if (f->type == FRAME_SLICE)
        return take_slice(c, begin, &f->slice, items, err);
    if (f->type == FRAME_SNAPSHOT)
        return take_snapshot(c, run_id, begin, f, items, err);
    const frame_parts *p = &f->parts;
    const bool is_other_number = p->n_parts != begin->n_parts && !frame_has_ids(p->n_values);
    if (is_other_number || p->n_values != begin->n_values || p->index != c->index ||
        frame_array_bytes(f) != c->n_parts)
        return bf_fail(err, BF_ECORRUPT, "", "the solver sent parts of another size or snapshot");
    return complete(c, items, err);
}
