#include "api/results/verdict.h"

#include "core/base/number_text.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

enum { DIGITS = 3 };

#define AT(place) offsetof(verdict_figure, place)
static const member figure_members[] = {
    MEMBER("figure", text, AT(name), "Word of a key figure, or a name with its unit"),
    MEMBER("of", text, AT(of), "Feed that it is of; empty: none"),
    MEMBER("value", measure, AT(value), "Its value"),
};
const member_table verdict_figure_members = { MEMBER_TABLE("VerdictFigure", figure_members),
                                              .size = sizeof(verdict_figure) };
#undef AT

#define AT(place) offsetof(verdict, place)
static const member members[] = {
    MEMBER("kind", string, AT(kind), "What it is about, one word of the list of the answer"),
    MEMBER("text", text, AT(text), "A sentence or some, in English, with what can be done"),
    MEMBER("advice", text, AT(advice), "The part of it that says what can be done; empty: nothing"),
    MEMBER("figures", array, AT(figures), "What it rests on", .table = &verdict_figure_members,
           .offset_n = AT(n_figures), .limit = VERDICT_FIGURES_MAX),
};
const member_table verdict_members = { MEMBER_TABLE("Verdict", members), .size = sizeof(verdict) };
#undef AT

void verdict_write_all(json_out *w, const verdicts *all)
{
    json_out_array(w);
    for (size_t k = 0; k < all->n; k++)
        members_write(w, &verdict_members, &all->items[k]);
    json_out_array_end(w);
}

verdict *verdict_add(verdicts *all, const char *kind)
{
    verdict *v = &all->items[all->n];

    all->n += all->n < VERDICTS_MAX;
    *v = (verdict){ .kind = kind };
    return v;
}

static void append(char *text, size_t size, const char *format, va_list arguments)
{
    const size_t n = strlen(text);

    vsnprintf(text + n, size - n, format, arguments);
}

void verdict_say(verdict *v, const char *format, ...)
{
    va_list arguments;

    va_start(arguments, format);
    append(v->text, sizeof v->text, format, arguments);
    va_end(arguments);
}

void verdict_advise(verdict *v, const char *format, ...)
{
    va_list arguments, again;

    va_start(arguments, format);
    va_copy(again, arguments);
    if (v->text[0] != '\0' && v->advice[0] == '\0')
        verdict_say(v, " ");
    append(v->text, sizeof v->text, format, arguments);
    append(v->advice, sizeof v->advice, format, again);
    va_end(again);
    va_end(arguments);
}

void verdict_rests_on(verdict *v, const char *name, const char *of, double value)
{
    if (!isfinite(value) || v->n_figures == VERDICT_FIGURES_MAX)
        return;
    verdict_figure *figure = &v->figures[v->n_figures++];
    snprintf(figure->name, sizeof figure->name, "%s", name);
    snprintf(figure->of, sizeof figure->of, "%s", of);
    figure->value = value;
}

const char *verdict_number(double value, double half_width, char text[VERDICT_NUMBER_SIZE])
{
    char number[NUMBER_TEXT_SIZE], half[NUMBER_TEXT_SIZE];

    (void)number_text(value, DIGITS, number);
    if (isfinite(half_width) && half_width > 0.0)
        snprintf(text, VERDICT_NUMBER_SIZE, "%s ± %s", number,
                 number_text(half_width, DIGITS, half));
    else
        snprintf(text, VERDICT_NUMBER_SIZE, "%s", number);
    return text;
}
