// The densities of two runs against each other, snapshot by snapshot: two grids at a time.

#include "api/http/handlers_compare_priv.h"

#include "api/http/exchange_priv.h"
#include "api/results/compare_json.h"

#include <math.h>

enum { SNAPSHOTS_MAX = 200 }; // compared of one pair

// One of the two runs.
typedef struct side {
    const char *id;
    api_snapshot_list list; // items owned
} side;

// Sums over the snapshots that were compared, of those figures that are known.
typedef struct totals {
    compare_distance sum;
    size_t n_mean_abs, n_l1, n_emd_x, n_emd_y;
} totals;

static const api_snapshot *snapshot_at(const side *s, size_t i)
{
    return (const api_snapshot *)(const void *)s->list.items.bytes + i;
}

static bool have_same_grid(const bf_grid *a, const bf_grid *b)
{
    double near = 1e-9 * (a->d1 + a->d2);

    return a->n1 == b->n1 && a->n2 == b->n2 && fabs(a->lower1 - b->lower1) <= near &&
           fabs(a->lower2 - b->lower2) <= near && fabs(a->d1 - b->d1) * (double)a->n1 <= near &&
           fabs(a->d2 - b->d2) * (double)a->n2 <= near;
}

// Moves to the next snapshots i of a and k of b that have the same time. False: there are none.
static bool find_common(const side *a, const side *b, size_t *i, size_t *k)
{
    while (*i < a->list.n && *k < b->list.n) {
        double t_a = snapshot_at(a, *i)->t, t_b = snapshot_at(b, *k)->t;
        if (fabs(t_a - t_b) <= 1e-9 * (1.0 + fabs(t_a)))
            return true;
        if (t_a < t_b)
            (*i)++;
        else
            (*k)++;
    }
    return false;
}

static size_t count_common(const side *a, const side *b)
{
    size_t n = 0;

    for (size_t i = 0, k = 0; find_common(a, b, &i, &k); i++, k++)
        n++;
    return n;
}

static bf_status read_grid(exchange *x, const side *s, size_t i, bf_buffer *out, bf_error *err)
{
    api_snapshot snapshot;
    bf_grid grid;

    bf_status status = x->services->read_snapshot(
        x->services->context, s->id, snapshot_at(s, i)->index, &snapshot, &grid, out, err);
    if (status == BF_OK && out->n != grid_cells(&s->list.grid) * sizeof(float))
        return bf_fail(err, BF_ECORRUPT, "", "a snapshot does not have the size of its grid");
    return status;
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

static void add_known(double value, double *sum, size_t *n)
{
    if (isfinite(value)) {
        *sum += value;
        (*n)++;
    }
}

static void add_distance(const compare_distance *d, totals *all)
{
    add_known(d->mean_abs, &all->sum.mean_abs, &all->n_mean_abs);
    add_known(d->l1, &all->sum.l1, &all->n_l1);
    add_known(d->emd_x, &all->sum.emd_x, &all->n_emd_x);
    add_known(d->emd_y, &all->sum.emd_y, &all->n_emd_y);
}

// 0 / 0 is not a number, which is what a mean of nothing is.
static compare_distance mean_of(const totals *all)
{
    return (compare_distance){ .mean_abs = all->sum.mean_abs / (double)all->n_mean_abs,
                               .l1 = all->sum.l1 / (double)all->n_l1,
                               .emd_x = all->sum.emd_x / (double)all->n_emd_x,
                               .emd_y = all->sum.emd_y / (double)all->n_emd_y };
}

static void write_distance(json_out *w, const api_snapshot *a, const api_snapshot *b,
                           const compare_distance *d)
{
    const compare_json_snapshots view = { .t = a->t,
                                          .a = a->index,
                                          .b = b->index,
                                          .mass_a = a->mass,
                                          .mass_b = b->mass,
                                          .distance = *d };
    members_write(w, &compare_json_density_distance, &view);
}

static size_t choose_stride(size_t n_common, size_t n_cells, size_t n_cells_max)
{
    size_t most = n_cells_max / n_cells;

    most = most < 1 ? 1 : most > SNAPSHOTS_MAX ? SNAPSHOTS_MAX : most;
    return n_common <= most ? 1 : (n_common + most - 1) / most;
}

static bf_status write_distances(exchange *x, json_out *w, const side *a, const side *b,
                                 size_t n_common, size_t stride, totals *all, bf_error *err)
{
    size_t at = 0;

    for (size_t i = 0, k = 0; find_common(a, b, &i, &k); i++, k++, at++) {
        compare_distance distance;
        if (at % stride != 0 && at + 1 != n_common)
            continue;
        bf_status status = measure_distance(x, a, i, b, k, &distance, err);
        if (status != BF_OK)
            return status;
        add_distance(&distance, all);
        write_distance(w, snapshot_at(a, i), snapshot_at(b, k), &distance);
    }
    return BF_OK;
}

static bf_status write_sides(exchange *x, json_out *w, const side *a, const side *b,
                             size_t n_cells_max, bf_error *err)
{
    bool is_same = a->list.n > 0 && b->list.n > 0 && have_same_grid(&a->list.grid, &b->list.grid);
    size_t n_common = count_common(a, b);
    totals all = { .n_l1 = 0 };
    bf_status status = BF_OK;

    json_out_object(w);
    json_out_key_bool(w, "same_grid", is_same);
    json_out_key_integer(w, "n_common", (int64_t)n_common);
    json_out_key(w, "snapshots");
    json_out_array(w);
    if (is_same) {
        size_t stride = choose_stride(n_common, grid_cells(&a->list.grid), n_cells_max);
        status = write_distances(x, w, a, b, n_common, stride, &all, err);
    }
    json_out_array_end(w);
    compare_distance mean = mean_of(&all);
    json_out_key(w, "mean");
    members_write(w, &compare_json_distance, &mean);
    json_out_object_end(w);
    return status;
}

bf_status handlers_compare__density(exchange *x, json_out *w, const handlers_compare__entry *a,
                                    const handlers_compare__entry *b, size_t n_cells_max,
                                    bf_error *err)
{
    side of_a = { .id = a->id }, of_b = { .id = b->id };

    if (!a->is_run || !b->is_run) {
        json_out_null(w);
        return BF_OK;
    }
    bf_status status = x->services->list_snapshots(x->services->context, of_a.id, &of_a.list, err);
    if (status == BF_OK)
        status = x->services->list_snapshots(x->services->context, of_b.id, &of_b.list, err);
    if (status == BF_OK)
        status = write_sides(x, w, &of_a, &of_b, n_cells_max, err);
    buffer_fini(&of_a.list.items);
    buffer_fini(&of_b.list.items);
    return status;
}
