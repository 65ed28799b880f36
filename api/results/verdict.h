/// Verdicts: what results say, in sentences for people, each with members for programs: a kind, the figures that it rests
/// on, and what can be done.

#pragma once

#include "api/json/members.h"
#include "core/scene/scene.h"

#include <stddef.h>

enum {
    VERDICT_TEXT_SIZE = 1200,  ///< bytes of a text with its terminator
    VERDICT_ADVICE_SIZE = 400, ///< bytes of what can be done
    VERDICT_FIGURE_SIZE = 80,  ///< bytes of the name of a figure
    VERDICT_FIGURES_MAX = 8,   ///< of one verdict; further ones are dropped
    VERDICTS_MAX = 16,         ///< of one answer; further ones are dropped
    VERDICT_NUMBER_SIZE = 80,  ///< bytes of a number for people
};

/// A figure that a verdict rests on.
typedef struct verdict_figure {
    char name[VERDICT_FIGURE_SIZE]; ///< word of a key figure where it is one, else of its own
    char of[SCENE_ID_SIZE];         ///< id of the feed that it is of; "": of no part
    double value;                   ///< in the unit of its name
} verdict_figure;

/// A verdict.
typedef struct verdict {
    const char *kind;                            ///< a constant word
    char text[VERDICT_TEXT_SIZE];                ///< all of it, with what can be done
    char advice[VERDICT_ADVICE_SIZE];            ///< what can be done; "": nothing
    size_t n_figures;                            ///< of figures
    verdict_figure figures[VERDICT_FIGURES_MAX]; ///< that it rests on
} verdict;

/// Verdicts in the order in which they matter. Zero-initialise; owns nothing.
typedef struct verdicts {
    size_t n;                        ///< how many
    verdict items[VERDICTS_MAX + 1]; ///< the last one takes what is dropped
} verdicts;

/// The object of a verdict, and of a figure.
extern const member_table verdict_members;
extern const member_table verdict_figure_members;

/// Write all of them as a list.
void verdict_write_all(json_out *w, const verdicts *all);

/// Begin a verdict of a kind: no text yet.
verdict *verdict_add(verdicts *all, const char *kind);

/// Append to its text, or to its text and its advice.
__attribute__((format(printf, 2, 3))) void verdict_say(verdict *v, const char *format, ...);
__attribute__((format(printf, 2, 3))) void verdict_advise(verdict *v, const char *format, ...);

/// Add a figure; one that is not finite is left out.
void verdict_rests_on(verdict *v, const char *name, const char *of, double value);

/// A number with the digits that matter to people, "8,730" or "12.3"; with a half width that is finite and positive,
/// "8,730 ± 120". Returns `text`.
const char *verdict_number(double value, double half_width, char text[VERDICT_NUMBER_SIZE]);
