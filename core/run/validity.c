#include "core/run/validity.h"

#include "core/base/vec2.h"
#include "core/scene/layout.h"
#include "core/scene/mix.h"
#include "core/scene/shape.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

/// Values are told with four digits. What is outside by less than they show, relative to the bound, is inside.
#define SLACK 2e-4

/// Where the models were compared and differed by at most 5 % of the parts, and what happens outside.
typedef struct range_row {
    double minimum;    ///< see validity_item
    double maximum;    ///< see validity_item
    const char *below; ///< what to expect of smaller values; NULL: it was not measured
    const char *above; ///< what to expect of larger values; NULL: it was not measured
} range_row;

/// What to expect where it was not measured.
static const char unknown[] = "How well the density model predicts this was not measured: solve it "
                              "with the microscopic model, too.";

#define NOTHING -INFINITY

static const range_row dispersive_ranges[VALIDITY_FIGURE_COUNT] = {
    [VALIDITY_ANGLE] = { 30.0, 90.0,
                         "The density model lets cargo slide too slowly along a flat deflector.",
                         "Cargo collects in the corner that the deflector closes, and stays "
                         "there." },
    [VALIDITY_OPENING] = { 2.9, 12.5, "Parts may bridge the opening, which a density cannot show.",
                           NULL },
    [VALIDITY_FUNNEL] = { 2.9, 12.5, "Parts may bridge the opening, which a density cannot show.",
                          NULL },
    [VALIDITY_HEAP] = { NOTHING, 62.0, NULL,
                        "So much cargo fills the opening, and the density model lets it pass too "
                        "fast." },
    [VALIDITY_PARTS] = { 24.0, 640.0, "A density says little about a few parts.", NULL },
    [VALIDITY_SPEED] = { 0.2, 0.8, "The density model lets cargo pass too slowly at such a speed.",
                         NULL },
    [VALIDITY_SCHEDULES] = { NOTHING, 0.0, NULL, NULL },
    [VALIDITY_BELTS] = { NOTHING, 1.0, NULL, NULL },
    [VALIDITY_PLATES] = { NOTHING, 1.0, NULL,
                          "The density model holds cargo back between two deflectors." },
    [VALIDITY_BENDS] = { NOTHING, 1.0, NULL, NULL },
    [VALIDITY_PIECES] = { NOTHING, LAYOUT_PIECES_MAX, NULL,
                          "Angles and openings of so many were not measured." },
    [VALIDITY_WALL] = { NOTHING, 0.0, NULL, "Cargo collects at such a wall." },
    [VALIDITY_DIAMETER] = { 0.022, 0.036, "The density model is not laid out for such small parts.",
                            "The density model is not laid out for such large parts." },
    [VALIDITY_SHAPE] = { NOTHING, 0.0, NULL, NULL },
    [VALIDITY_KINDS] = { NOTHING, 1.0, NULL, NULL },
    [VALIDITY_PLATE_FRICTION] = { 0.1, 0.5, NULL, NULL },
    [VALIDITY_PART_FRICTION] = { 0.05, 0.5, NULL, NULL },
    [VALIDITY_BELT_FRICTION] = { 0.3, 1.0, NULL, NULL },
    [VALIDITY_TREATMENT] = { NOTHING, 0.0, NULL,
                             "In the density model cargo leaks through field, and piles up in the "
                             "corners of wall." },
    [VALIDITY_CELL] = { 0.1, 0.25, NULL,
                        "The density model lets cargo pass too slowly on a coarse grid." },
    [VALIDITY_MOTIONS] = { NOTHING, 0.0, NULL, NULL },
};

static const range_row congested_ranges[VALIDITY_FIGURE_COUNT] = {
    [VALIDITY_ANGLE] = { 10.0, 90.0, NULL,
                         "Cargo collects in the corner that the deflector closes, and stays "
                         "there." },
    [VALIDITY_OPENING] = { 2.9, 9.0, "Parts may bridge the opening, which a density cannot show.",
                           NULL },
    [VALIDITY_FUNNEL] = { 6.0, 10.0, "Parts may bridge the opening, which a density cannot show.",
                          NULL },
    [VALIDITY_HEAP] = { NOTHING, INFINITY, NULL, NULL },
    [VALIDITY_PARTS] = { 96.0, 840.0, "A density says little about a few parts.", NULL },
    [VALIDITY_SPEED] = { 0.1, 0.6, NULL, NULL },
    [VALIDITY_SCHEDULES] = { NOTHING, 0.0, NULL, NULL },
    [VALIDITY_BELTS] = { NOTHING, 2.0, NULL, NULL },
    [VALIDITY_PLATES] = { NOTHING, 2.0, NULL, NULL },
    [VALIDITY_BENDS] = { NOTHING, 1.0, NULL, NULL },
    [VALIDITY_PIECES] = { NOTHING, LAYOUT_PIECES_MAX, NULL,
                          "Angles and openings of so many were not measured." },
    [VALIDITY_WALL] = { NOTHING, 0.0, NULL, "Cargo collects at such a wall." },
    [VALIDITY_DIAMETER] = { 0.024, 0.024, NULL, NULL },
    [VALIDITY_SHAPE] = { NOTHING, 0.0, NULL, NULL },
    [VALIDITY_KINDS] = { NOTHING, 1.0, NULL, NULL },
    [VALIDITY_PLATE_FRICTION] = { 0.19, 0.19, NULL, NULL },
    [VALIDITY_PART_FRICTION] = { 0.15, 0.15, NULL, NULL },
    [VALIDITY_BELT_FRICTION] = { 1.0, 1.0, NULL, NULL },
    [VALIDITY_TREATMENT] = { NOTHING, INFINITY, NULL, NULL },
    [VALIDITY_CELL] = { 0.2, 0.42, NULL, NULL },
    [VALIDITY_MOTIONS] = { NOTHING, 0.0, NULL, NULL },
};

static const range_row *const ranges[SCENE_CLOSURE_COUNT] = {
    [SCENE_DISPERSIVE] = dispersive_ranges,
    [SCENE_CONGESTED] = congested_ranges,
};

const char *const validity_words[] = {
    [VALIDITY_ANGLE] = "angle",
    [VALIDITY_OPENING] = "opening",
    [VALIDITY_FUNNEL] = "funnel",
    [VALIDITY_HEAP] = "heap",
    [VALIDITY_PARTS] = "parts",
    [VALIDITY_SPEED] = "speed",
    [VALIDITY_SCHEDULES] = "schedules",
    [VALIDITY_BELTS] = "belts",
    [VALIDITY_PLATES] = "plates",
    [VALIDITY_BENDS] = "bends",
    [VALIDITY_PIECES] = "pieces",
    [VALIDITY_WALL] = "wall",
    [VALIDITY_DIAMETER] = "diameter",
    [VALIDITY_SHAPE] = "shape",
    [VALIDITY_KINDS] = "kinds",
    [VALIDITY_PLATE_FRICTION] = "plate_friction",
    [VALIDITY_PART_FRICTION] = "part_friction",
    [VALIDITY_BELT_FRICTION] = "belt_friction",
    [VALIDITY_TREATMENT] = "treatment",
    [VALIDITY_CELL] = "cell",
    [VALIDITY_MOTIONS] = "motions",
    [VALIDITY_FIGURE_COUNT] = NULL,
};

/// The text about a figure: "<before> <value><after>; the model was compared with moving parts for <range>".
typedef struct figure_text {
    const char *unit;   ///< in documents; NULL: none
    const char *before; ///< words before the value
    const char *after;  ///< words after the value
    const char *of;     ///< words after the numbers of the range
    const char *only;   ///< instead of these numbers; NULL: the numbers
} figure_text;

static const figure_text texts[VALIDITY_FIGURE_COUNT] = {
    [VALIDITY_ANGLE] = { "deg", "A deflector stands at", " degrees to the belt", " degrees", NULL },
    [VALIDITY_OPENING] = { "diameters", "The narrowest opening is", " part diameters wide",
                           " diameters", NULL },
    [VALIDITY_FUNNEL] = { "diameters", "The narrowest opening of several deflectors is",
                          " part diameters wide", " diameters", NULL },
    [VALIDITY_HEAP] = { "parts/diameter", "The heap has",
                        " parts for each part diameter of the narrowest opening", "", NULL },
    [VALIDITY_PARTS] = { "parts", "The number of parts is", "", "", NULL },
    [VALIDITY_SPEED] = { "m/s", "A belt runs at", " m/s", " m/s", NULL },
    [VALIDITY_SCHEDULES] = { NULL, "The number of belts whose speed changes is", "", "",
                             "constant speeds alone" },
    [VALIDITY_BELTS] = { NULL, "The number of different belt velocities is", "", "", "one alone" },
    [VALIDITY_PLATES] = { NULL, "The number of deflectors is", "", "", NULL },
    [VALIDITY_BENDS] = { NULL, "The number of bends of a deflector is", "", "", NULL },
    [VALIDITY_PIECES] = { NULL, "The number of straight pieces of the deflectors is", "", "",
                          "a few" },
    [VALIDITY_WALL] = { "deg", "A belt runs against a wall at", " degrees", "",
                        "walls along the belt" },
    [VALIDITY_DIAMETER] = { "m", "A part is", " m across", " m", NULL },
    [VALIDITY_SHAPE] = { "%", "The share of parts that are no cylinders is", " %", "",
                         "cylinders alone" },
    [VALIDITY_KINDS] = { NULL, "The number of kinds of cargo is", "", "", "one alone" },
    [VALIDITY_PLATE_FRICTION] = { NULL, "The friction of parts on deflectors is", "", "", NULL },
    [VALIDITY_PART_FRICTION] = { NULL, "The friction of parts on parts is", "", "", NULL },
    [VALIDITY_BELT_FRICTION] = { NULL, "The friction of parts on belts is", "", "", NULL },
    [VALIDITY_TREATMENT] = { NULL, "The number of deflectors that are not sealed is", "", "",
                             "sealed ones alone" },
    [VALIDITY_CELL] = { "diameters", "The edge of a cell is", " part diameters", " diameters",
                        NULL },
    [VALIDITY_MOTIONS] = { NULL, "The number of obstacles that move is", "", "",
                           "obstacles that stand" },
};

enum { TOO_SMALL, TOO_LARGE, WAY_COUNT };

/// What was found so far.
typedef struct findings {
    const scene *s;
    const range_row *ranges; ///< of its closure
    double diameter;         ///< of the largest part, m
    validity_item items[VALIDITY_FIGURE_COUNT][WAY_COUNT];
    bool has[VALIDITY_FIGURE_COUNT][WAY_COUNT]; ///< the item is filled in
} findings;

static void note(findings *f, validity_figure figure, double value, const char *format, ...)
    __attribute__((format(printf, 4, 5)));

/// Compare a value with its range; the text is the pointer of what has it.
static void note(findings *f, validity_figure figure, double value, const char *format, ...)
{
    const range_row *range = &f->ranges[figure];
    int way = WAY_COUNT;
    va_list args;

    if (value < range->minimum * (1.0 - SLACK))
        way = TOO_SMALL;
    else if (value > range->maximum * (1.0 + SLACK))
        way = TOO_LARGE;
    if (way == WAY_COUNT)
        return;
    validity_item *item = &f->items[figure][way];
    if (f->has[figure][way] && (way == TOO_SMALL ? value >= item->value : value <= item->value))
        return;
    f->has[figure][way] = true;
    item->figure = figure;
    item->value = value;
    va_start(args, format);
    vsnprintf(item->pointer, sizeof item->pointer, format, args);
    va_end(args);
}

// ---- the figures

static void note_angles(findings *f, const layout *of)
{
    note(f, VALIDITY_ANGLE, of->least.value, "/obstacles/%zu", of->least.index);
    note(f, VALIDITY_ANGLE, of->greatest.value, "/obstacles/%zu", of->greatest.index);
    note(f, VALIDITY_PLATES, (double)of->n_plates, "/obstacles");
    note(f, VALIDITY_BENDS, of->bends.value, "/obstacles/%zu", of->bends.index);
}

static void note_heap(findings *f, const layout *of)
{
    const double n_parts = (double)scene_parts(f->s), width = of->opening.value / f->diameter;

    // How many parts there are at a time is not known before where feeds go on to deliver them.
    if (f->s->n_feeds == 0)
        note(f, VALIDITY_PARTS, n_parts, "/initial");
    if (!isfinite(width))
        return;
    note(f, of->n_plates > 1 ? VALIDITY_FUNNEL : VALIDITY_OPENING, width, "/obstacles/%zu",
         of->opening.index);
    if (width > 0.0 && f->s->n_feeds == 0)
        note(f, VALIDITY_HEAP, n_parts / width, "/initial");
}

static void note_walls(findings *f, const layout *of)
{
    static const char *const sides[SCENE_SIDE_COUNT] = { [SCENE_WEST] = "west",
                                                         [SCENE_EAST] = "east",
                                                         [SCENE_SOUTH] = "south",
                                                         [SCENE_NORTH] = "north" };

    note(f, VALIDITY_WALL, of->wall_angle.value, "/edges/%s", sides[of->wall_angle.index]);
}

static size_t count_velocities(const scene *s)
{
    size_t n = 0;

    for (size_t k = 0; k < s->n_belts; k++) {
        bool is_new = true;
        for (size_t i = 0; i < k && is_new; i++)
            is_new = vec2_length(vec2_sub(s->belts[k].velocity, s->belts[i].velocity)) > 0.0;
        n += is_new;
    }
    return n;
}

static void note_speeds(findings *f)
{
    double n_schedules = 0.0;

    for (size_t k = 0; k < f->s->n_belts; k++) {
        const scene_belt *belt = &f->s->belts[k];
        const scene_speed_schedule *schedule = &belt->speed_schedule;
        const double speed = vec2_length(belt->velocity);
        if (schedule->n_times == 0 || schedule->times[0] > 0.0)
            note(f, VALIDITY_SPEED, speed, "/belts/%zu/velocity_m_s", k);
        for (size_t i = 0; i < schedule->n_times; i++)
            note(f, VALIDITY_SPEED, speed * schedule->factors[i],
                 "/belts/%zu/speed_schedule/factor/%zu", k, i);
        n_schedules += schedule->n_times > 0;
    }
    note(f, VALIDITY_SCHEDULES, n_schedules, "/belts");
}

static void note_motions(findings *f)
{
    double n_moving = 0.0;
    size_t moving = 0;

    for (size_t k = 0; k < f->s->n_obstacles; k++) {
        if (scene_obstacle_moves(&f->s->obstacles[k])) {
            n_moving += 1.0;
            moving = k;
        }
    }
    note(f, VALIDITY_MOTIONS, n_moving, "/obstacles/%zu", moving);
}

static void note_cargo(findings *f)
{
    const scene *s = f->s;
    const size_t n_parts = scene_parts(s);
    size_t counts[SCENE_KINDS_MAX], n_others = 0, other = 0;

    mix_count(s, n_parts, counts);
    for (size_t k = 0; k < s->n_cargo; k++) {
        const scene_cargo *kind = &s->cargo[k];
        const double diameter = 2.0 * shape_footprint_of(&kind->shape).bounding_radius;
        const bool is_other = kind->shape.type != SCENE_CYLINDER;
        if (s->is_mix)
            note(f, VALIDITY_DIAMETER, diameter, "/cargo/%zu/shape", k);
        else
            note(f, VALIDITY_DIAMETER, diameter, "/cargo/shape");
        n_others += is_other ? counts[k] : 0;
        other = is_other ? k : other;
    }
    const double percent = 100.0 * (double)n_others / (double)n_parts;
    if (s->is_mix)
        note(f, VALIDITY_SHAPE, percent, "/cargo/%zu/shape", other);
    else
        note(f, VALIDITY_SHAPE, percent, "/cargo/shape");
    note(f, VALIDITY_KINDS, (double)s->n_cargo, "/cargo");
}

static void note_parameters(findings *f)
{
    const scene_contact *contact = f->s->micro.contact;
    double n_others = 0.0;
    size_t other = 0;

    note(f, VALIDITY_PLATE_FRICTION, contact[SCENE_HANDLING_CARGO].friction,
         "/contacts/handling_cargo/friction");
    note(f, VALIDITY_PART_FRICTION, contact[SCENE_CARGO_CARGO].friction,
         "/contacts/cargo_cargo/friction");
    note(f, VALIDITY_BELT_FRICTION, contact[SCENE_CONVEYOR_CARGO].friction,
         "/contacts/conveyor_cargo/friction");
    for (size_t k = 0; k < f->s->n_obstacles; k++) {
        if (f->s->obstacles[k].treatment != SCENE_SEALED) {
            n_others += 1.0;
            other = k;
        }
    }
    note(f, VALIDITY_TREATMENT, n_others, "/obstacles/%zu/treatment", other);
    note(f, VALIDITY_CELL, scene_cell_edge(f->s) / f->diameter, "/macro/cell_m");
}

static double diameter_of(const scene *s)
{
    double radius = 0.0;

    for (size_t k = 0; k < s->n_cargo; k++)
        radius = fmax(radius, shape_footprint_of(&s->cargo[k].shape).bounding_radius);
    return 2.0 * radius;
}

static void note_figures(findings *f, const layout *of)
{
    const size_t n_velocities = count_velocities(f->s);

    note_motions(f);
    const bool is_free =
        of->is_measured && of->n_plates == 0 && of->wall_angle.value == 0.0 && n_velocities == 1;

    if (is_free)
        return;
    note(f, VALIDITY_PIECES, (double)of->n_pieces, "/obstacles");
    note(f, VALIDITY_BELTS, (double)n_velocities, "/belts");
    note_walls(f, of);
    if (of->is_measured && of->n_plates > 0)
        note_angles(f, of);
    note_heap(f, of);
    note_speeds(f);
    note_cargo(f);
    note_parameters(f);
}

// ---- the texts

/// A number with four digits, or all of its whole part.
static void print_value(double value, char *ret_text, size_t size)
{
    snprintf(ret_text, size, fabs(value) < 10000.0 ? "%.4g" : "%.0f", value);
}

static void print_range(const validity_item *item, char *ret_text, size_t size)
{
    const figure_text *text = &texts[item->figure];
    char minimum[32], maximum[32];

    print_value(item->minimum, minimum, sizeof minimum);
    print_value(item->maximum, maximum, sizeof maximum);
    if (text->only != NULL)
        snprintf(ret_text, size, "%s", text->only);
    else if (!isfinite(item->minimum))
        snprintf(ret_text, size, "up to %s%s", maximum, text->of);
    else if (item->minimum == item->maximum)
        snprintf(ret_text, size, "%s%s", minimum, text->of);
    else if (!isfinite(item->maximum))
        snprintf(ret_text, size, "%s%s and more", minimum, text->of);
    else
        snprintf(ret_text, size, "%s to %s%s", minimum, maximum, text->of);
}

/// Fill in what follows from figure and value.
static void complete_item(validity_item *item, const range_row *range, int way)
{
    const figure_text *text = &texts[item->figure];
    const char *then = way == TOO_SMALL ? range->below : range->above;
    const bool is_closed =
        item->value == 0.0 && (item->figure == VALIDITY_OPENING || item->figure == VALIDITY_FUNNEL);
    char value[32], between[96];

    if (is_closed)
        then = "The deflectors close the belt: cargo collects at them, and stays there.";
    item->unit = text->unit;
    item->minimum = range->minimum;
    item->maximum = range->maximum;
    item->meaning = then == NULL ? unknown : then;
    print_value(item->value, value, sizeof value);
    print_range(item, between, sizeof between);
    snprintf(item->title, sizeof item->title, "%s %s%s", text->before, value, text->after);
    snprintf(item->comparison, sizeof item->comparison,
             "The density model was compared with moving parts for %s.", between);
    snprintf(item->detail, sizeof item->detail,
             "%s %s%s; the model was compared with moving parts for %s.%s%s", text->before, value,
             text->after, between, then == NULL ? "" : " ", then == NULL ? "" : then);
}

bf_status validity_of(const scene *s, validity *ret_validity, bf_error *err)
{
    findings f = { .s = s, .ranges = ranges[s->macro.closure], .diameter = diameter_of(s) };
    layout of;

    bf_status status = layout_measure(s, &of, err);
    if (status != BF_OK)
        return status;
    note_figures(&f, &of);
    ret_validity->n = 0;
    for (int figure = 0; figure < VALIDITY_FIGURE_COUNT; figure++) {
        for (int way = 0; way < WAY_COUNT; way++) {
            if (!f.has[figure][way])
                continue;
            validity_item *item = &ret_validity->items[ret_validity->n++];
            *item = f.items[figure][way];
            complete_item(item, &f.ranges[figure], way);
        }
    }
    ret_validity->closure = s->macro.closure;
    ret_validity->is_compared = ret_validity->n == 0;
    return BF_OK;
}
