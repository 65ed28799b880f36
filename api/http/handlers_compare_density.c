// The densities of two runs, snapshot by snapshot, by core/compare.

#include "api/http/http_priv.h"
#include "api/json/json_out.h"
#include "api/results/compare_json.h"
#include "core/compare/compare.h"

// Work of one request: beyond it every second, third, ... common snapshot is compared, and the last.
enum {
    CELLS_MAX = 20000000, // of all pairs
    SNAPSHOTS_MAX = 200   // of one pair
};

// One of the two runs.
typedef struct side {
    const char *id;
    api_snapshot_list list; // items owned
} side;

static const api_snapshot *snapshot_at(const side *s, size_t i)
{
    return (const api_snapshot *)(const void *)s->list.items.bytes + i;
}

static compare_times times_of(const side *s)
{
    const api_snapshot *first = snapshot_at(s, 0);

    return (compare_times){ s->list.n, first == NULL ? NULL : &first->t, sizeof *first };
}

static bf_status read_grid(exchange *x, const side *s, size_t i, bf_buffer *out, bf_error *err)
{
    api_array of;

    BF_TRY(x->services->read_array(x->services->store, s->id, snapshot_at(s, i)->index,
                                   API_ARRAY_DENSITY, &of, out, err));
    if (out->n != grid_cells(&s->list.grid) * sizeof(float))
        return bf_fail(err, BF_ECORRUPT, "", "a snapshot does not have the size of its grid");
    return BF_OK;
}

static bf_status measure_distance(exchange *x, const side *a, size_t i, const side *b, size_t k,
                                  compare_distance *ret_distance, bf_error *err)
{
    bf_buffer of_a = { 0 }, of_b = { 0 };

    bf_status status = read_grid(x, a, i, &of_a, err);
    if (status == BF_OK)
        status = read_grid(x, b, k, &of_b, err);
    if (status == BF_OK)
        status = compare_densities(&a->list.grid, (const float *)(const void *)of_a.bytes,
                                   (const float *)(const void *)of_b.bytes, ret_distance, err);
    buffer_fini(&of_a);
    buffer_fini(&of_b);
    return status;
}

static bf_status write_distances(exchange *x, json_out *w, const side *a, const side *b,
                                 size_t n_common, size_t stride, compare_mean *mean, bf_error *err)
{
    const compare_times of_a = times_of(a), of_b = times_of(b);
    size_t at = 0;

    for (size_t i = 0, k = 0; compare_next_common(&of_a, &of_b, &i, &k); i++, k++, at++) {
        if (at % stride != 0 && at + 1 != n_common)
            continue;
        const api_snapshot *at_a = snapshot_at(a, i), *at_b = snapshot_at(b, k);
        compare_json_snapshots view = { .t = at_a->t,
                                        .a = at_a->index,
                                        .b = at_b->index,
                                        .mass_a = at_a->mass,
                                        .mass_b = at_b->mass };
        BF_TRY(measure_distance(x, a, i, b, k, &view.distance, err));
        compare_mean_add(mean, &view.distance);
        members_write(w, &compare_json_density_distance, &view);
    }
    return BF_OK;
}

static bf_status write_sides(exchange *x, json_out *w, const side *a, const side *b,
                             size_t n_cells_max, bf_error *err)
{
    bool is_same =
        a->list.n > 0 && b->list.n > 0 && compare_is_same_grid(&a->list.grid, &b->list.grid);
    const compare_times of_a = times_of(a), of_b = times_of(b);
    size_t n_common = compare_count_common(&of_a, &of_b);
    compare_mean sum = { .n_l1 = 0 };
    bf_status status = BF_OK;

    json_out_object(w);
    json_out_key_bool(w, "same_grid", is_same);
    json_out_key_integer(w, "n_common", (int64_t)n_common);
    json_out_key(w, "snapshots");
    json_out_array(w);
    if (is_same) {
        size_t most = n_cells_max / grid_cells(&a->list.grid);
        most = most < 1 ? 1 : most > SNAPSHOTS_MAX ? SNAPSHOTS_MAX : most;
        const size_t stride = n_common <= most ? 1 : (n_common + most - 1) / most;
        status = write_distances(x, w, a, b, n_common, stride, &sum, err);
    }
    json_out_array_end(w);
    compare_distance mean = compare_mean_of(&sum);
    json_out_key(w, "mean");
    members_write(w, &compare_json_distance, &mean);
    json_out_object_end(w);
    return status;
}

bf_status handlers__write_density(exchange *x, json_out *w, const char *a, const char *b,
                                  size_t n_pairs, bf_error *err)
{
    side of_a = { .id = a }, of_b = { .id = b };

    if (a == NULL || b == NULL) {
        json_out_null(w);
        return BF_OK;
    }
    bf_status status = x->services->list_snapshots(x->services->store, of_a.id, &of_a.list, err);
    if (status == BF_OK)
        status = x->services->list_snapshots(x->services->store, of_b.id, &of_b.list, err);
    if (status == BF_OK)
        status = write_sides(x, w, &of_a, &of_b, CELLS_MAX / n_pairs, err);
    buffer_fini(&of_a.list.items);
    buffer_fini(&of_b.list.items);
    return status;
}
