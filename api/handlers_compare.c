// Two runs against each other: their curves by core/compare, their densities cell by cell.

#include "api/exchange_priv.h"
#include "api/handlers.h"
#include "api/json_out.h"
#include "api/results.h"
#include "core/base/check.h"
#include "core/base/memory.h"

#include <math.h>
#include <string.h>

// Work of one request: beyond it every second, third, ... common snapshot is compared, and the last.
enum { SNAPSHOTS_MAX = 200, CELLS_MAX = 20000000 };

// One of the two runs.
typedef struct side {
    const char *name;           // of its query parameter
    api_run run;                // found
    api_curve curve;            // owned
    char column[SCENE_ID_SIZE]; // name of the column that is compared
    double *parts;              // that column, owned
    api_snapshot_list list;     // items owned
} side;

static void fini_side(side *s)
{
    api_curve_fini(&s->curve);
    memory_free(s->parts);
    buffer_fini(&s->list.items);
}

static const api_snapshot *snapshot_at(const side *s, size_t i)
{
    return (const api_snapshot *)(const void *)s->list.items.bytes + i;
}

static bf_status find_side(exchange *x, side *s, bf_error *err)
{
    const char *id = query_value(&x->query, s->name);

    if (id == NULL)
        return exchange__refuse(x, 400, err, "query parameter '%s' is missing: the id of a run",
                                s->name);
    if (!exchange__is_id(id))
        return bf_fail(err, BF_ENOTFOUND, "", "there is no run '%.64s'", id);
    return x->services->find(x->services->context, id, &s->run, err);
}

// Finds the column that is asked for (NULL: the first one) and copies its name. False: none.
static bool find_column(side *s, const char *wanted, size_t *ret_index)
{
    const char *names = s->curve.columns.bytes == NULL ? "" : s->curve.columns.bytes;

    for (size_t index = 0; index < s->curve.n_columns; index++) {
        size_t n = strcspn(names, ",");
        BF_CHECK(n < sizeof s->column);
        if (wanted == NULL || (strlen(wanted) == n && memcmp(names, wanted, n) == 0)) {
            memcpy(s->column, names, n);
            s->column[n] = '\0';
            *ret_index = index;
            return true;
        }
        names += n + (names[n] == ',');
    }
    return false;
}

static bf_status read_side(exchange *x, side *s, bf_error *err)
{
    const char *wanted = query_value(&x->query, "column");
    size_t index = 0;

    bf_status status = x->services->read_curve(x->services->context, s->run.id, 0, &s->curve, err);
    if (status != BF_OK)
        return status;
    if (s->curve.n == 0)
        return bf_fail(err, BF_ECONFLICT, "", "run '%s' has no samples of its curve yet",
                       s->run.id);
    if (!find_column(s, wanted, &index))
        return exchange__refuse(x, 400, err,
                                "query parameter 'column': run '%s' has no column '%.64s'",
                                s->run.id, wanted == NULL ? "" : wanted);
    s->parts = memory_alloc(s->curve.n, sizeof *s->parts);
    if (s->parts == NULL)
        return bf_fail(err, BF_ENOMEM, "", "out of memory");
    const double *values = (const double *)(const void *)s->curve.values.bytes;
    for (size_t i = 0; i < s->curve.n; i++)
        s->parts[i] = values[i * s->curve.n_columns + index];
    return x->services->list_snapshots(x->services->context, s->run.id, &s->list, err);
}

static bf_status measure_curves(exchange *x, const side *a, const side *b,
                                compare_measures *ret_measures, bf_error *err)
{
    compare_curve of_a = { a->curve.n, (const double *)(const void *)a->curve.t.bytes, a->parts };
    compare_curve of_b = { b->curve.n, (const double *)(const void *)b->curve.t.bytes, b->parts };

    bf_status status = compare_curves(&of_a, &of_b, ret_measures, err);
    if (status == BF_EINPUT)
        x->refusal = 409; // the request is right, but these runs cannot be compared
    return status;
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

    return x->services->read_snapshot(x->services->context, s->run.id, snapshot_at(s, i)->index,
                                      &snapshot, &grid, out, err);
}

// Mean |a - b| over the cells of snapshot i of a and k of b.
static bf_status measure_distance(exchange *x, const side *a, size_t i, const side *b, size_t k,
                                  double *ret_distance, bf_error *err)
{
    size_t n = grid_cells(&a->list.grid);
    bf_buffer of_a = { 0 }, of_b = { 0 };
    double sum = 0.0;

    bf_status status = read_grid(x, a, i, &of_a, err);
    if (status == BF_OK)
        status = read_grid(x, b, k, &of_b, err);
    if (status == BF_OK && (of_a.n != n * sizeof(float) || of_b.n != of_a.n))
        status = bf_fail(err, BF_ECORRUPT, "", "a snapshot does not have the size of its grid");
    if (status == BF_OK) {
        const float *rho_a = (const float *)(const void *)of_a.bytes;
        const float *rho_b = (const float *)(const void *)of_b.bytes;
        for (size_t cell = 0; cell < n; cell++)
            sum += fabs((double)rho_a[cell] - (double)rho_b[cell]);
        *ret_distance = sum / (double)n;
    }
    buffer_fini(&of_a);
    buffer_fini(&of_b);
    return status;
}

static void write_distance(json_out *w, const api_snapshot *a, const api_snapshot *b, double value)
{
    json_out_object(w);
    json_out_key_number(w, "t_s", a->t);
    json_out_key_integer(w, "a", (int64_t)a->index);
    json_out_key_integer(w, "b", (int64_t)b->index);
    json_out_key_number(w, "mean_abs", value);
    json_out_object_end(w);
}

static size_t choose_stride(size_t n_common, size_t n_cells)
{
    size_t most = CELLS_MAX / n_cells;

    most = most < 1 ? 1 : most > SNAPSHOTS_MAX ? SNAPSHOTS_MAX : most;
    return n_common <= most ? 1 : (n_common + most - 1) / most;
}

static bf_status write_distances(exchange *x, json_out *w, const side *a, const side *b,
                                 size_t n_common, bf_error *err)
{
    size_t stride = choose_stride(n_common, grid_cells(&a->list.grid));
    size_t at = 0;

    for (size_t i = 0, k = 0; find_common(a, b, &i, &k); i++, k++, at++) {
        double distance = 0.0;
        if (at % stride != 0 && at + 1 != n_common)
            continue;
        bf_status status = measure_distance(x, a, i, b, k, &distance, err);
        if (status != BF_OK)
            return status;
        write_distance(w, snapshot_at(a, i), snapshot_at(b, k), distance);
    }
    return BF_OK;
}

// {"same_grid", "n_common", "snapshots": [...]}; the list is empty where the grids differ.
static bf_status write_density(exchange *x, json_out *w, const side *a, const side *b,
                               bf_error *err)
{
    bool is_same = a->list.n > 0 && b->list.n > 0 && have_same_grid(&a->list.grid, &b->list.grid);
    size_t n_common = count_common(a, b);
    bf_status status = BF_OK;

    json_out_key(w, "density");
    json_out_object(w);
    json_out_key_bool(w, "same_grid", is_same);
    json_out_key_integer(w, "n_common", (int64_t)n_common);
    json_out_key(w, "snapshots");
    json_out_array(w);
    if (is_same)
        status = write_distances(x, w, a, b, n_common, err);
    json_out_array_end(w);
    json_out_object_end(w);
    return status;
}

static void write_side(json_out *w, const side *s)
{
    json_out_key(w, s->name);
    json_out_object(w);
    json_out_key_string(w, "id", s->run.id);
    json_out_key_string(w, "status", run_state_word(s->run.state));
    json_out_key_string(w, "column", s->column);
    json_out_object_end(w);
}

static bf_status write_comparison(exchange *x, const side *a, const side *b,
                                  const compare_measures *measures, bf_error *err)
{
    json_out w = json_out_to(&x->response->body);

    json_out_object(&w);
    write_side(&w, a);
    write_side(&w, b);
    json_out_key(&w, "curve");
    bf_status status = json_out_status(&w, err);
    if (status == BF_OK)
        status = results_compare_json(measures, &x->response->body, err);
    w.needs_comma = true; // the value was written past w
    if (status == BF_OK)
        status = write_density(x, &w, a, b, err);
    json_out_object_end(&w);
    return status == BF_OK ? json_out_status(&w, err) : status;
}

bf_status handlers_compare_runs(exchange *x, bf_error *err)
{
    side a = { .name = "a" }, b = { .name = "b" };
    compare_measures measures;

    bf_status status = find_side(x, &a, err);
    if (status == BF_OK)
        status = find_side(x, &b, err);
    if (status == BF_OK)
        status = read_side(x, &a, err);
    if (status == BF_OK)
        status = read_side(x, &b, err);
    if (status == BF_OK)
        status = measure_curves(x, &a, &b, &measures, err);
    if (status == BF_OK)
        status = write_comparison(x, &a, &b, &measures, err);
    fini_side(&a);
    fini_side(&b);
    return status;
}
