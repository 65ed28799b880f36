#include "api/scenario/feed_csv.h"

#include "api/json/number.h"
#include "api/json/text.h"
#include "api/scenario/scenario_priv.h"
#include "core/base/memory.h"
#include "core/scene/ranges.h"

#include <math.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

enum { COLUMNS_MAX = 8, LINE_TEXT_SIZE = 32 };

// The reading of a text.
typedef struct csv {
    json_in *in;
    text_piece rest;                // what was not read yet
    size_t line;                    // number of the line that was read
    const char *const *names;       // of columns; NULL-terminated
    size_t n;                       // columns in the text
    size_t which[COLUMNS_MAX];      // the name of each
    text_piece fields[COLUMNS_MAX]; // of a row, by names; without a column: at is NULL
    bool has[COLUMNS_MAX];          // by names: the column is there
} csv;

// Notes a fault of the present line, or of the text as a whole, which has no line in its text.
static void note_at(const csv *c, bool is_of_line, const char *text)
{
    json_in *in = c->in;

    if (in->pointer.text[0] != '\0') {
        if (is_of_line)
            json_in_fault(in, "line %zu: %s", c->line, text);
        else
            json_in_fault(in, "%s", text);
        return;
    }
    const size_t mark = json_pointer_enter(&in->pointer, "line", strlen("line"));
    (void)json_pointer_enter_index(&in->pointer, c->line);
    json_in_fault(in, "%s", text);
    json_pointer_leave(&in->pointer, mark);
}

static void note(const csv *c, const char *format, ...) __attribute__((format(printf, 2, 3)));

static void note(const csv *c, const char *format, ...)
{
    char text[BF_TEXT_SIZE];
    va_list args;

    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    note_at(c, true, text);
}

static text_piece next_line(csv *c)
{
    text_piece line = text_take_until(&c->rest, '\n');

    line.n -= line.n > 0 && line.at[line.n - 1] == '\r';
    c->line++;
    return line;
}

// Splits a line at its commas; returns how many fields there are, of which ret_fields has the first ones.
static size_t split(text_piece line, text_piece ret_fields[COLUMNS_MAX])
{
    const size_t n = text_count_pieces(line, ',');

    for (size_t k = 0; k < n && k < COLUMNS_MAX; k++)
        ret_fields[k] = text_take_until(&line, ',');
    return n;
}

static bool read_column(csv *c, size_t k, text_piece field)
{
    size_t which = 0;

    while (c->names[which] != NULL && !text_is(field, c->names[which]))
        which++;
    if (c->names[which] == NULL) {
        note(c, "\"%.*s\" is not a column", (int)fmin((double)field.n, 40.0), field.at);
        return false;
    }
    if (c->has[which]) {
        note(c, "%s stands there twice", c->names[which]);
        return false;
    }
    c->has[which] = true;
    c->which[k] = which;
    return true;
}

// Reads the header, of which the first name must be there, and counts the rows. 0: a fault was noted.
static size_t begin(csv *c, json_in *in, const char *text, const char *const *names)
{
    text_piece fields[COLUMNS_MAX];
    size_t n_rows = 0;

    *c = (csv){ .in = in, .rest = { text, strlen(text) }, .names = names };
    c->n = split(next_line(c), fields);
    for (size_t k = 0; k < c->n; k++) {
        if (k == COLUMNS_MAX)
            note(c, "has %zu columns, the limit is %d", c->n, COLUMNS_MAX);
        if (k == COLUMNS_MAX || !read_column(c, k, fields[k]))
            return 0;
    }
    if (!c->has[0]) {
        note(c, "the column %s is missing", names[0]);
        return 0;
    }
    for (text_piece rest = c->rest; rest.n > 0; n_rows++)
        (void)text_take_until(&rest, '\n');
    if (n_rows == 0)
        note_at(c, false, "has no rows after its header");
    if (n_rows > SCENE_SERIES_MAX) {
        json_in_fault_limit(in, "has %zu rows, the limit is %d", n_rows, SCENE_SERIES_MAX);
        return 0;
    }
    return n_rows;
}

// Reads a row into c->fields. False: a fault was noted.
static bool next_row(csv *c)
{
    text_piece fields[COLUMNS_MAX];
    const size_t n = split(next_line(c), fields);

    if (n != c->n) {
        note(c, "has %zu fields, the header has %zu", n, c->n);
        return false;
    }
    for (size_t k = 0; k < n; k++)
        c->fields[c->which[k]] = fields[k];
    return true;
}

// The number of a column within a range. False: a fault was noted.
static bool get_number(const csv *c, size_t which, const bf_range *range, double *ret_number)
{
    const text_piece field = c->fields[which];
    bf_faults faults = { 0 };

    if (number_read(field.at, field.n, ret_number) != 0) {
        note(c, "%s must be a number, not \"%.*s\"", c->names[which],
             (int)fmin((double)field.n, 40.0), field.at);
        return false;
    }
    if (range == NULL)
        return true;
    range_check(range, *ret_number, "", &faults);
    if (faults.n > 0)
        note(c, "%s %s", c->names[which], faults.items[0].text);
    return faults.n == 0;
}

static bool note_order(const csv *c, double t, double before)
{
    note(c, "%.15g s do not come after the %.15g s before them", t, before);
    return false;
}

// ---- profiles

enum { PROFILE_T, PER_S, PER_H, PER_ROW };
static const char *const profile_names[] = { "t_s", "rate_per_s", "rate_per_h", "count", NULL };

static bool read_profile_rows(csv *c, size_t n, double *times, double *values)
{
    const size_t which = c->has[PER_S] ? PER_S : c->has[PER_H] ? PER_H : PER_ROW;

    for (size_t k = 0; k < n; k++) {
        if (!next_row(c) || !get_number(c, PROFILE_T, &scene_range_instant, &times[k]) ||
            !get_number(c, which, &scene_range_profile, &values[k]))
            return false;
        if (k > 0 && !(times[k] > times[k - 1]))
            return note_order(c, times[k], times[k - 1]);
        if (which == PER_H)
            values[k] /= 3600.0;
    }
    return true;
}

static void add(scene_series *p, double t, double rate)
{
    p->times[p->n_times] = t;
    p->values[p->n_times++] = rate;
    p->n_values = p->n_times;
}

static bool check_profile_columns(const csv *c, size_t n_rows)
{
    if (c->has[PER_S] + c->has[PER_H] + c->has[PER_ROW] != 1)
        note(c, "must have exactly one of rate_per_s, rate_per_h and count");
    else if (c->has[PER_ROW] && n_rows < 2)
        note_at(c, false, "counts need at least 2 rows");
    else
        return true;
    return false;
}

static void read_profile(json_in *in, const char *text, scene_series *profile,
                         feed_csv_about *ret_about)
{
    csv c;
    const size_t n = begin(&c, in, text, profile_names);

    if (n == 0 || !check_profile_columns(&c, n))
        return;
    const size_t n_max = c.has[PER_ROW] ? 2 * n + 2 : n;
    double *rows = memory_alloc(2 * n, sizeof *rows);
    profile->times = memory_alloc(n_max, sizeof *profile->times);
    profile->values = memory_alloc(n_max, sizeof *profile->values);
    if (rows == NULL || profile->times == NULL || profile->values == NULL) {
        in->has_failed = true;
    } else if (read_profile_rows(&c, n, rows, rows + n)) {
        if (c.has[PER_ROW]) {
            const double *counts = rows + n;
            if (rows[0] > 0.0)
                add(profile, nextafter(rows[0], 0.0), 0.0);
            for (size_t k = 0; k < n; k++) {
                const double length = k + 1 < n ? rows[k + 1] - rows[k] : rows[k] - rows[k - 1];
                const double end = k + 1 < n ? rows[k + 1] : rows[k] + length;
                add(profile, rows[k], counts[k] / length);
                add(profile, nextafter(end, 0.0), counts[k] / length);
                if (k + 1 == n)
                    add(profile, end, 0.0);
            }
        }
        for (size_t k = 0; k < n && !c.has[PER_ROW]; k++)
            add(profile, rows[k], rows[n + k]);
        *ret_about = (feed_csv_about){ n, rows[0], rows[n - 1] };
    }
    memory_free(rows);
}

void feed_csv__read_profile(json_in *in, const char *text, scene_series *profile)
{
    feed_csv_about about;

    read_profile(in, text, profile, &about);
}

// ---- lists of arrivals

enum { LIST_T, COUNT, KIND, X, Y, HEADING };
static const char *const list_names[] = {
    "t_s", "count", "kind", "x_m", "y_m", "heading_deg", NULL
};

static bool get_count(const csv *c, uint32_t *ret_count)
{
    static const bf_range range = { 1.0, UINT32_MAX, false, false, 0.0 };
    double count;

    if (!get_number(c, COUNT, &range, &count))
        return false;
    if (count != floor(count))
        note(c, "count must be a whole number, not %.15g", count);
    *ret_count = (uint32_t)count;
    return count == floor(count);
}

static bool get_kind(const csv *c, const scene *s, uint32_t *ret_kind)
{
    char line[LINE_TEXT_SIZE], id[SCENE_ID_SIZE];
    const text_piece field = c->fields[KIND];

    snprintf(line, sizeof line, "line %zu: ", c->line);
    snprintf(id, sizeof id, "%.*s", (int)fmin((double)field.n, SCENE_ID_SIZE), field.at);
    if (s == NULL && !scene_is_id(id))
        note(c, "kind must be an id, not \"%.40s\"", id);
    if (s == NULL) {
        *ret_kind = 0;
        return scene_is_id(id);
    }
    return scenario__find_kind(c->in, s, line, id, ret_kind);
}

// The place on the line of the feed, from 0 to 1, of a coordinate.
static bool place_on(const csv *c, size_t which, const scene_feed *feed, double at,
                     double *ret_place)
{
    const double from = which == X ? feed->line[0].x : feed->line[0].y;
    const double to = which == X ? feed->line[1].x : feed->line[1].y;

    // A line across has no other places; rounding must not move an end off it.
    if (at >= fmin(from, to) - SCENE_TOLERANCE && at <= fmax(from, to) + SCENE_TOLERANCE &&
        from != to) {
        *ret_place = fmin(fmax((at - from) / (to - from), 0.0), 1.0);
        return true;
    }
    note(c, "%s %.15g lies off the feed, from %.15g to %.15g m", c->names[which], at, from, to);
    return false;
}

// A coordinate as a place on the line of the feed, from 0 to 1; an empty one is none. feed NULL: it is not known yet.
static bool get_place(const csv *c, size_t which, const scene_feed *feed, double *ret_place)
{
    double at;

    *ret_place = NAN;
    if (c->fields[which].n == 0)
        return true;
    if (!get_number(c, which, NULL, &at))
        return false;
    return feed == NULL || place_on(c, which, feed, at, ret_place);
}
static bool get_heading(const csv *c, double *ret_heading)
{
    double degrees;

    *ret_heading = NAN;
    if (c->fields[HEADING].n == 0)
        return true;
    if (!get_number(c, HEADING, NULL, &degrees))
        return false;
    *ret_heading = number_from_degrees(degrees);
    return true;
}

static bool read_arrival(csv *c, const scene *s, const scene_feed *feed, size_t k)
{
    const scene_arrival_list *l = &feed->schedule;

    if (!next_row(c) || !get_number(c, LIST_T, &scene_range_instant, &l->times[k]))
        return false;
    if (k > 0 && !(l->times[k] >= l->times[k - 1]))
        return note_order(c, l->times[k], l->times[k - 1]);
    return (l->counts == NULL || get_count(c, &l->counts[k])) &&
           (l->kinds == NULL || get_kind(c, s, &l->kinds[k])) &&
           (l->places == NULL ||
            get_place(c, c->has[X] ? X : Y, s == NULL ? NULL : feed, &l->places[k])) &&
           (l->headings == NULL || get_heading(c, &l->headings[k]));
}

// Room for n items of a column, if it is there.
static void *make_room(csv *c, bool is_there, size_t n, size_t size)
{
    void *items = is_there ? memory_alloc(n, size) : NULL;

    c->in->has_failed = c->in->has_failed || (is_there && items == NULL);
    return items;
}

void feed_csv__read_schedule(json_in *in, const char *text, const scene *s, scene_feed *feed)
{
    scene_arrival_list *l = &feed->schedule;
    csv c;
    const size_t n = begin(&c, in, text, list_names);

    if (n == 0)
        return;
    if (c.has[X] && c.has[Y]) {
        note(&c, "must have one of x_m and y_m");
        return;
    }
    l->n = n;
    l->times = make_room(&c, true, n, sizeof *l->times);
    l->counts = make_room(&c, c.has[COUNT], n, sizeof *l->counts);
    l->kinds = make_room(&c, c.has[KIND], n, sizeof *l->kinds);
    l->places = make_room(&c, c.has[X] || c.has[Y], n, sizeof *l->places);
    l->headings = make_room(&c, c.has[HEADING], n, sizeof *l->headings);
    for (size_t k = 0; k < n && !in->has_failed; k++) {
        if (!read_arrival(&c, s, feed, k))
            return;
    }
}

// ---- texts by themselves

// True if nothing was noted and there was memory.
static bool is_sound(const json_in *in)
{
    return !in->has_failed && in->faults->n == 0;
}

bool feed_csv_check_profile(json_in *in, const char *text, feed_csv_about *ret_about)
{
    scene_series profile = { .n_times = 0 };

    read_profile(in, text, &profile, ret_about);
    memory_free(profile.times);
    memory_free(profile.values);
    return is_sound(in);
}

bool feed_csv_check_schedule(json_in *in, const char *text, feed_csv_about *ret_about)
{
    scene_feed feed;
    scene_arrival_list *l = &feed.schedule;

    scene_feed_init(&feed);
    feed_csv__read_schedule(in, text, NULL, &feed);
    if (is_sound(in))
        *ret_about = (feed_csv_about){ l->n, l->times[0], l->times[l->n - 1] };
    memory_free(l->times);
    memory_free(l->counts);
    memory_free(l->kinds);
    memory_free(l->places);
    memory_free(l->headings);
    return is_sound(in);
}
