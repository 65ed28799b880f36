#include "api/results/key_figures.h"

#include "api/json/json_in.h"
#include "api/json/number.h"
#include "api/services.h"

#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

enum { ITEMS_MAX = SCENE_BELTS_MAX };
_Static_assert((int)ITEMS_MAX >= (int)SCENE_FEEDS_MAX && (int)ITEMS_MAX >= (int)SCENE_EYES_MAX &&
                   (int)ITEMS_MAX >= (int)SCENE_COUNTERS_MAX &&
                   (int)ITEMS_MAX >= (int)SCENE_SINKS_MAX &&
                   (int)ITEMS_MAX >= (int)SCENE_ALL_FAILURES_MAX,
               "there is room for the items of every scope");

static const struct {
    const char *list; // the member with the items
    const char *word; // in CSV
} scopes[FIGURE_SCOPES] = {
    [FIGURE_OF_RUN] = { NULL, "run" },
    [FIGURE_OF_FEED] = { "feeds", "feed" },
    [FIGURE_OF_COUNTER] = { "counters", "counter" },
    [FIGURE_OF_EYE] = { "photo_eyes", "photo_eye" },
    [FIGURE_OF_BELT] = { "belts", "belt" },
    [FIGURE_OF_FAILURE] = { "failures", "failure" },
    [FIGURE_OF_OUTLET] = { "outlets", "outlet" },
    [FIGURE_OF_SINK] = { "sinks", "sink" },
};

const char *key_figures_list(figure_scope scope)
{
    return scopes[scope].list;
}

// An id within the names of columns.
typedef struct item {
    const char *id;
    size_t n; // bytes
} item;

// What the figures are of.
typedef struct items {
    size_t n[FIGURE_SCOPES];
    item of[FIGURE_SCOPES][ITEMS_MAX];
} items;

static void add_item(items *all, figure_scope scope, const char *id, size_t n)
{
    const size_t k = all->n[scope]++;

    if (k < ITEMS_MAX)
        all->of[scope][k] = (item){ id, n };
}

// The columns before left_domain are counters; of those behind it one of each other item tells the id.
static void find_items(const char *columns, items *ret_items)
{
    static const struct {
        const char *word;
        figure_scope scope;
    } told_by[] = { { ".offered", FIGURE_OF_FEED },   { ".blocked", FIGURE_OF_EYE },
                    { ".speed_m_s", FIGURE_OF_BELT }, { ".failed", FIGURE_OF_FAILURE },
                    { ".left", FIGURE_OF_OUTLET },    { ".taken", FIGURE_OF_SINK } };
    bool is_counter = true;
    size_t n = 0;

    *ret_items = (items){ .n = { [FIGURE_OF_RUN] = 1 } };
    for (const char *name = columns; *name != '\0'; name += n + (name[n] == ',' ? 1 : 0)) {
        n = strcspn(name, ",");
        const char *dot = memrchr(name, '.', n);
        const size_t n_id = dot == NULL ? n : (size_t)(dot - name), n_word = n - n_id;
        if (n == strlen("left_domain") && strncmp(name, "left_domain", n) == 0)
            is_counter = false;
        else if (is_counter)
            add_item(ret_items, FIGURE_OF_COUNTER, name, n);
        for (size_t k = 0; !is_counter && dot != NULL && k < sizeof told_by / sizeof *told_by; k++)
            if (n_word == strlen(told_by[k].word) && memcmp(dot, told_by[k].word, n_word) == 0)
                add_item(ret_items, told_by[k].scope, name, n_id);
    }
}

static size_t figures_of(figure_scope scope)
{
    return (size_t)(figure_first(scope + 1) - figure_first(scope));
}

// BF_OK if the items have n values.
static bf_status check_items(const items *all, size_t n, bf_error *err)
{
    size_t n_there = 0;

    for (figure_scope scope = 0; scope < FIGURE_SCOPES; scope++) {
        if (all->n[scope] > ITEMS_MAX)
            return bf_fail(err, BF_ECORRUPT, "", "the curve has too many columns");
        n_there += all->n[scope] * figures_of(scope);
    }
    if (n != n_there)
        return bf_fail(err, BF_ECORRUPT, "", "%zu key figures, not %zu", n, n_there);
    return BF_OK;
}

bf_status key_figures_check(const key_figures *figures, bf_error *err)
{
    items all;

    find_items(figures->columns, &all);
    return check_items(&all, figures->n, err);
}

// Writes the figures of an item into an object that is open. Those that share a word are neighbours.
static void write_item(json_out *w, figure_scope scope, const double *values)
{
    const figure *open = NULL; // the last one in an inner object that is open

    for (figure_id id = figure_first(scope); id < figure_first(scope + 1); id++) {
        const figure *f = &figure_table[id];
        const double value = values[id - figure_first(scope)];
        if (!isfinite(value))
            continue;
        if (open != NULL && strcmp(open->word, f->word) != 0) {
            json_out_object_end(w);
            open = NULL;
        }
        if (open == NULL && f->part != NULL) {
            json_out_key(w, f->word);
            json_out_object(w);
            open = f;
        }
        json_out_key_number(w, f->part != NULL ? f->part : f->word, value);
    }
    if (open != NULL)
        json_out_object_end(w);
}

void key_figures_write_run(json_out *w, const double *values)
{
    json_out_object(w);
    write_item(w, FIGURE_OF_RUN, values);
    json_out_object_end(w);
}

void key_figures_write(json_out *w, const key_figures *figures)
{
    const double *values = figures->values;
    char id[SCENE_ID_SIZE];
    items all;

    find_items(figures->columns, &all);
    json_out_object(w);
    write_item(w, FIGURE_OF_RUN, values);
    values += figures_of(FIGURE_OF_RUN);
    for (figure_scope scope = FIGURE_OF_RUN + 1; scope < FIGURE_SCOPES; scope++) {
        if (scope >= FIGURE_OF_BELT && all.n[scope] == 0)
            continue;
        json_out_key(w, scopes[scope].list);
        json_out_array(w);
        for (size_t k = 0; k < all.n[scope]; k++, values += figures_of(scope)) {
            const item *of = &all.of[scope][k];
            (void)snprintf(id, sizeof id, "%.*s", (int)of->n, of->id);
            json_out_object(w);
            json_out_key_string(w, "id", id);
            write_item(w, scope, values);
            json_out_object_end(w);
        }
        json_out_array_end(w);
    }
    json_out_object_end(w);
}

// The number of a figure in the object of an item; NULL or none: it is missing.
static const json_t *find_figure(const json_t *object, const figure *f)
{
    const json_t *value = json_object_get(object, f->word);

    return f->part == NULL ? value : json_object_get(value, f->part);
}

static bf_status append_rows(figure_scope scope, const json_t *object, bf_buffer *out)
{
    const char *of = json_string_value(json_object_get(object, "id"));

    for (figure_id id = figure_first(scope); id < figure_first(scope + 1); id++) {
        const figure *f = &figure_table[id];
        const json_t *value = find_figure(object, f);
        char number[NUMBER_SIZE];
        if (!json_is_number(value))
            continue;
        (void)number_format(json_number_value(value), number);
        BF_TRY(buffer_printf(out, "%s%s%s,%s,%s,%s,%s\n", f->word, f->part != NULL ? "." : "",
                             f->part != NULL ? f->part : "", scopes[scope].word,
                             of != NULL ? of : "", number, f->unit != NULL ? f->unit : ""));
    }
    return BF_OK;
}

bf_status key_figures_parse(const char *json, size_t n, json_t **ret_root, bf_error *err)
{
    bf_faults faults = { 0 };
    json_in in = json_in_to(&faults);

    *ret_root = json_in_parse(&in, json, n);
    if (*ret_root != NULL)
        return BF_OK;
    return in.has_failed ? bf_fail_memory(err)
                         : bf_fail(err, BF_ECORRUPT, "", "stored key figures are damaged");
}

bf_status key_figures_csv(const char *json, size_t n, bf_buffer *out, bf_error *err)
{
    const size_t start = out->n;
    json_t *root = NULL;

    BF_TRY(key_figures_parse(json, n, &root, err));
    bf_status status = buffer_printf(out, "figure,of,id,value,unit\n");
    if (status == BF_OK)
        status = append_rows(FIGURE_OF_RUN, root, out);
    for (figure_scope scope = FIGURE_OF_RUN + 1; scope < FIGURE_SCOPES; scope++) {
        const json_t *list = json_object_get(root, scopes[scope].list);
        for (size_t k = 0; k < json_array_size(list) && status == BF_OK; k++)
            status = append_rows(scope, json_array_get(list, k), out);
    }
    json_in_free(root);
    if (status == BF_OK)
        return BF_OK;
    buffer_truncate(out, start);
    return bf_fail_memory(err);
}

static double *read_item(figure_scope scope, const json_t *object, double *values)
{
    for (figure_id id = figure_first(scope); id < figure_first(scope + 1); id++) {
        const json_t *value = find_figure(object, &figure_table[id]);
        *values++ = json_is_number(value) ? json_number_value(value) : (double)NAN;
    }
    return values;
}

bf_status key_figures_read(const char *json, size_t n_json, const char *columns, size_t n,
                           double *ret_values, bf_error *err)
{
    json_t *root = NULL;
    items all;

    find_items(columns, &all);
    bf_status status = check_items(&all, n, err);
    if (status == BF_OK)
        status = key_figures_parse(json, n_json, &root, err);
    if (status != BF_OK)
        return status;
    ret_values = read_item(FIGURE_OF_RUN, root, ret_values);
    for (figure_scope scope = FIGURE_OF_RUN + 1; scope < FIGURE_SCOPES; scope++) {
        const json_t *list = json_object_get(root, scopes[scope].list);
        if (json_array_size(list) != all.n[scope])
            status = bf_fail(err, BF_ECORRUPT, "", "stored key figures are damaged");
        for (size_t k = 0; k < all.n[scope]; k++)
            ret_values = read_item(scope, json_array_get(list, k), ret_values);
    }
    json_in_free(root);
    return status;
}

void key_figures_read_run(const json_t *object, double *ret_values)
{
    (void)read_item(FIGURE_OF_RUN, object, ret_values);
}
