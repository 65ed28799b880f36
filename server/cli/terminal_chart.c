#include "server/cli/terminal_chart.h"

#include "core/base/memory.h"
#include "server/cli/chart_axis.h"

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

enum {
    WIDTH_MIN = 40,
    WIDTH_MAX = 400,
    HEIGHT_MIN = 4,
    HEIGHT_MAX = 100,
    LINES_PER_TICK = 4,
    COLUMNS_PER_TICK = 12,
};

// What is being drawn: n1 x n2 dots, each the number of its curve from 1, or 0; row 0 is the top.
typedef struct plot {
    const terminal_chart_options *options;
    chart_axis x;
    chart_axis y;
    int label_width; // of the y axis
    int columns;     // cells
    int rows;
    int dots_x; // a cell
    int dots_y;
    int n1;
    int n2;
    uint8_t *dots;
    unsigned color; // of what is written next: a curve's number, 0: none
    bf_buffer text;
    bool has_failed; // out of memory while writing text
} plot;

// Dots on and off in turn, for telling curves apart without colours; n = 0: all on.
typedef struct dash {
    int n;
    int lengths[4];
} dash;

static const dash dashes[TERMINAL_CHART_CURVES_MAX] = {
    { 0 },           { 2, { 6, 4 } }, { 2, { 1, 2 } }, { 4, { 6, 2, 1, 2 } },
    { 2, { 3, 7 } }, { 2, { 1, 5 } },
};
static const char marks[TERMINAL_CHART_CURVES_MAX] = { '*', '+', 'o', 'x', '#', '@' };

static void put(plot *p, const char *text)
{
    if (buffer_append(&p->text, text, strlen(text)) != BF_OK)
        p->has_failed = true;
}

static void put_repeated(plot *p, const char *text, int n)
{
    for (int i = 0; i < n; i++)
        put(p, text);
}

static int clamp_size(size_t value, int least, int most)
{
    return value < (size_t)least ? least : value > (size_t)most ? most : (int)value;
}

static bool is_point(const terminal_chart_curve *c, size_t i)
{
    return isfinite(c->x[i]) && isfinite(c->y[i]);
}

static bf_status find_axes(plot *p, const terminal_chart_curve *curves, size_t n, int width,
                           bf_error *err)
{
    double x_low = INFINITY, x_high = -INFINITY, y_low = 0.0, y_high = 0.0;
    char label[CHART_AXIS_LABEL_SIZE];

    for (size_t c = 0; c < n; c++) {
        for (size_t i = 0; i < curves[c].n; i++) {
            if (!is_point(&curves[c], i))
                continue;
            x_low = fmin(x_low, curves[c].x[i]);
            x_high = fmax(x_high, curves[c].x[i]);
            y_low = fmin(y_low, curves[c].y[i]);
            y_high = fmax(y_high, curves[c].y[i]);
        }
    }
    if (x_low > x_high)
        return bf_fail(err, BF_EINPUT, "", "there is no point to draw");
    if (fmax(fmax(-x_low, x_high), fmax(-y_low, y_high)) > 1e300)
        return bf_fail(err, BF_EINPUT, "", "a value is too large to draw");
    p->y = chart_axis_make(y_low, y_high, p->rows / LINES_PER_TICK + 1, CHART_AXIS_ON_TICKS);
    for (int i = 0; i < p->y.n; i++) {
        int length = chart_axis_label(&p->y, i, label);
        p->label_width = length > p->label_width ? length : p->label_width;
    }
    p->columns = width - p->label_width - 2;
    p->x = chart_axis_make(x_low, x_high, p->columns / COLUMNS_PER_TICK + 1, CHART_AXIS_AS_GIVEN);
    return BF_OK;
}

// True if the dot at this distance along the curve is drawn.
static bool is_on(const dash *d, int along)
{
    int period = 0;

    for (int i = 0; i < d->n; i++)
        period += d->lengths[i];
    if (period == 0)
        return true;
    along %= period;
    int i = 0;
    while (along >= d->lengths[i])
        along -= d->lengths[i++];
    return i % 2 == 0;
}

// Bresenham's line without its first dot; *along counts dots since the curve's start.
static void draw_line(plot *p, uint8_t number, const dash *d, const int from[2], const int to[2],
                      int *along)
{
    int x = from[0], y = from[1];
    int dx = to[0] > x ? to[0] - x : x - to[0], step_x = to[0] > x ? 1 : -1;
    int dy = to[1] > y ? y - to[1] : to[1] - y, step_y = to[1] > y ? 1 : -1;
    int error = dx + dy;

    while (x != to[0] || y != to[1]) {
        int twice = 2 * error;
        if (twice >= dy) {
            error += dy;
            x += step_x;
        }
        if (twice <= dx) {
            error += dx;
            y += step_y;
        }
        if (is_on(d, ++*along))
            p->dots[y * p->n1 + x] = number;
    }
}

static void draw_curve(plot *p, const terminal_chart_curve *c, size_t number)
{
    static const dash solid = { 0 };
    const dash *d = p->options->has_colors || !p->options->is_unicode ? &solid : &dashes[number];
    int before[2] = { -1, -1 };
    int along = 0;

    for (size_t i = 0; i < c->n; i++) {
        if (!is_point(c, i)) {
            before[0] = -1;
            continue;
        }
        int at[2] = { chart_axis_place(&p->x, c->x[i], p->n1),
                      p->n2 - 1 - chart_axis_place(&p->y, c->y[i], p->n2) };
        if (before[0] < 0)
            p->dots[at[1] * p->n1 + at[0]] = (uint8_t)(number + 1);
        else
            draw_line(p, (uint8_t)(number + 1), d, before, at, &along);
        memcpy(before, at, sizeof before);
    }
}

// Go over to the colour of a curve, 0: the terminal's own.
static void set_color(plot *p, unsigned curve)
{
    static const char *const codes[TERMINAL_CHART_CURVES_MAX + 1] = {
        "\x1b[0m", "\x1b[36m", "\x1b[33m", "\x1b[35m", "\x1b[32m", "\x1b[31m", "\x1b[34m",
    };

    if (p->options->has_colors && p->color != curve)
        put(p, codes[curve]);
    p->color = curve;
}

// One character cell: the dots in it as a braille character, or the mark of its dot.
static void put_cell(plot *p, int column, int row)
{
    static const unsigned bits[4][2] = { { 1, 8 }, { 2, 16 }, { 4, 32 }, { 64, 128 } };
    unsigned mask = 0, curve = 0;

    for (int j = 0; j < p->dots_y; j++) {
        for (int i = 0; i < p->dots_x; i++) {
            unsigned dot = p->dots[(row * p->dots_y + j) * p->n1 + column * p->dots_x + i];
            mask |= dot == 0 ? 0U : bits[j][i];
            curve = dot > curve ? dot : curve;
        }
    }
    set_color(p, curve);
    if (mask == 0)
        put(p, " ");
    else if (!p->options->is_unicode)
        put(p, (char[]){ marks[curve - 1], '\0' });
    else
        put(p, (char[]){ '\xe2', (char)(0xa0 + (mask >> 6)), (char)(0x80 + (mask & 63)), '\0' });
}

static void put_row(plot *p, int row)
{
    char label[CHART_AXIS_LABEL_SIZE] = "", line[CHART_AXIS_LABEL_SIZE + 8];
    bool is_tick = false;

    for (int i = 0; i < p->y.n && !is_tick; i++) {
        int at = p->rows - 1 - chart_axis_place(&p->y, chart_axis_tick(&p->y, i), p->rows);
        is_tick = at == row;
        if (is_tick)
            chart_axis_label(&p->y, i, label);
    }
    snprintf(line, sizeof line, "%*s ", p->label_width, label);
    put(p, line);
    if (p->options->is_unicode)
        put(p, is_tick ? "┤" : "│");
    else
        put(p, is_tick ? "+" : "|");
    for (int column = 0; column < p->columns; column++)
        put_cell(p, column, row);
    set_color(p, 0);
    // No blanks at a line's end.
    while (p->text.n > 0 && p->text.bytes[p->text.n - 1] == ' ')
        p->text.n--;
    put(p, "\n");
}

static int find_tick_column(const plot *p, int i)
{
    return chart_axis_place(&p->x, chart_axis_tick(&p->x, i), p->columns);
}

// Write text into the line at a column, if that and a blank on either side is free.
static bool place_text(char *line, int width, int at, const char *text)
{
    int n = (int)strlen(text);

    at = at + n > width ? width - n : at;
    for (int i = at - 1; i <= at + n; i++) {
        if (i >= 0 && i < width && line[i] != ' ')
            return false;
    }
    if (at >= 0)
        memcpy(line + at, text, (size_t)n);
    return true;
}

// How many bytes the character at text has; 0 if a terminal could take it for a command.
static size_t measure_character(const plot *p, const unsigned char *text)
{
    bool is_control = *text < 0x20 || *text == 0x7f || (*text == 0xc2 && text[1] < 0xa0);
    size_t n = 1;

    if (is_control || (*text >= 0x80 && !p->options->is_unicode))
        return 0;
    while (*text >= 0xc0 && (text[n] & 0xc0) == 0x80)
        n++;
    return *text >= 0x80 && n == 1 ? 0 : n;
}

static void put_legend(plot *p, const terminal_chart_curve *curves, size_t n)
{
    enum { SAMPLE = 6 };

    for (size_t c = 0; c < n; c++) {
        memset(p->dots, 0, (size_t)p->n1 * (size_t)p->n2);
        const dash *d = &dashes[p->options->has_colors ? 0 : c];
        for (int i = 0; i < SAMPLE * p->dots_x; i++) {
            if (!p->options->is_unicode || is_on(d, i))
                p->dots[p->dots_y / 2 * p->n1 + i] = (uint8_t)(c + 1);
        }
        put_repeated(p, " ", p->label_width + 2);
        for (int column = 0; column < SAMPLE; column++)
            put_cell(p, column, 0);
        set_color(p, 0);
        put(p, " ");
        // The label with unfit bytes shown as '?', cut to width characters.
        const char *label = curves[c].label;
        for (int i = 0; i < p->columns - SAMPLE - 1 && *label != '\0'; i++) {
            size_t n_bytes = measure_character(p, (const unsigned char *)label);
            if (buffer_append(&p->text, n_bytes == 0 ? "?" : label, n_bytes == 0 ? 1 : n_bytes) !=
                BF_OK)
                p->has_failed = true;
            label += n_bytes == 0 ? 1 : n_bytes;
        }
        put(p, "\n");
    }
}

bf_status terminal_chart_draw(const terminal_chart_options *options,
                              const terminal_chart_curve *curves, size_t n_curves, bf_buffer *out,
                              bf_error *err)
{
    plot p = {
        .options = options,
        .rows = clamp_size(options->height, HEIGHT_MIN, HEIGHT_MAX),
        .dots_x = options->is_unicode ? 2 : 1,
        .dots_y = options->is_unicode ? 4 : 1,
    };

    if (n_curves > TERMINAL_CHART_CURVES_MAX)
        return bf_fail(err, BF_ELIMIT, "", "%zu curves, more than the %d that can be told apart",
                       n_curves, TERMINAL_CHART_CURVES_MAX);
    bf_status status =
        find_axes(&p, curves, n_curves, clamp_size(options->width, WIDTH_MIN, WIDTH_MAX), err);
    if (status != BF_OK)
        return status;
    p.n1 = p.columns * p.dots_x;
    p.n2 = p.rows * p.dots_y;
    p.dots = memory_alloc((size_t)p.n1 * (size_t)p.n2, 1);
    p.has_failed = p.dots == NULL;
    if (!p.has_failed) {
        for (size_t c = 0; c < n_curves; c++)
            draw_curve(&p, &curves[c], c);
        put(&p, options->y_title);
        put(&p, "\n");
        for (int row = 0; row < p.rows; row++)
            put_row(&p, row);
        put_repeated(&p, " ", p.label_width + 1);
        put(&p, p.options->is_unicode ? "└" : "+");
        for (int column = 0; column < p.columns; column++) {
            bool is_tick = false;
            for (int i = 0; i < p.x.n; i++)
                is_tick = is_tick || find_tick_column(&p, i) == column;
            if (p.options->is_unicode)
                put(&p, is_tick ? "┬" : "─");
            else
                put(&p, is_tick ? "+" : "-");
        }
        put(&p, "\n");
        char line[WIDTH_MAX + 1], label[CHART_AXIS_LABEL_SIZE];
        int width = p.label_width + 2 + p.columns;
        memset(line, ' ', (size_t)width);
        for (int i = 0; i < p.x.n; i++) {
            int n = chart_axis_label(&p.x, i, label);
            place_text(line, width, p.label_width + 2 + find_tick_column(&p, i) - n / 2, label);
        }
        for (int at = width; at >= 0 && !place_text(line, width, at, p.options->x_title);)
            at--;
        while (width > 0 && line[width - 1] == ' ')
            width--;
        line[width] = '\0';
        put(&p, line);
        put(&p, "\n");
        put_legend(&p, curves, n_curves);
    }
    if (p.has_failed || buffer_append(out, p.text.bytes, p.text.n) != BF_OK)
        status = bf_fail(err, BF_ENOMEM, "", "no memory for the chart");
    memory_free(p.dots);
    buffer_fini(&p.text);
    return status;
}
