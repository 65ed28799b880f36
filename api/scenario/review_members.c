#include "api/scenario/review_members.h"

#include "api/scenario/scenario_members.h"

#include <stdio.h>

#define AT(place) offsetof(validity_item, place)
static const member outside_members[] = {
    MEMBER("what", enum, AT(figure), "Figure of the scenario", .words = validity_words),
    MEMBER("value", measure, AT(value), "Its value, the one that is farthest out",
           .null = "not known"),
    MEMBER("unit", string, AT(unit), "Unit of the value and of the range", .null = "none"),
    MEMBER("min", measure, AT(minimum), "Smallest value of the comparison",
           .null = "no limit, or never compared"),
    MEMBER("max", measure, AT(maximum), "Largest value of the comparison",
           .null = "no limit, or never compared"),
    MEMBER("pointer", text, AT(pointer), "What has that value, in the document of the scenario",
           .type = "#JsonPointer"),
    MEMBER("detail", text, AT(detail), "Value, range and what to expect, for people"),
};
const member_table review_outside_members = { MEMBER_TABLE("OutsideValidity", outside_members),
                                              .size = sizeof(validity_item) };
#undef AT

static bool is_of_a_density(const void *item)
{
    const validity *of = item;

    return of->subject != VALIDITY_PARTS_MODEL;
}

static bool has_like(const void *item)
{
    const validity *of = item;

    return of->like.n > 0;
}

#define AT(place) offsetof(validity_like, place)
static const member like_members[] = {
    MEMBER("scenes", size, AT(n), "How many there are"),
    MEMBER("largest_percent", measure, AT(largest),
           "By which the rate of the model was off in one of them at most, %"),
    MEMBER("mean_percent", measure, AT(mean), "The same in the mean of their sizes, %"),
    MEMBER("detail", text, AT(text), "The same for people"),
};
const member_table review_like_members = { MEMBER_TABLE("LikeScenes", like_members) };
#undef AT

// In the order of validity_subject, which has the closures first.
#define AT(place) offsetof(validity, place)
static const member validity_members[] = {
    MEMBER("closure", enum, AT(subject), "Closure of the macroscopic model",
           .words = scenario_closure_words, .applies = is_of_a_density),
    MEMBER("compared", bool, AT(is_compared),
           "Every figure of the scenario was compared and is within its range"),
    MEMBER("like", object, AT(like),
           "Scenes that were solved for the comparison and are like this one: each figure that "
           "both have is about the same, and neither has others. Absent: there are none",
           .table = &review_like_members, .applies = has_like),
    MEMBER("outside", array, AT(items), "Figures that are out of their range",
           .table = &review_outside_members, .offset_n = AT(n), .limit = VALIDITY_OUTSIDE_MAX),
    MEMBER("never_compared", array, AT(never),
           "Figures that no comparison had, or whose value is not known",
           .table = &review_outside_members, .offset_n = AT(n_never), .limit = VALIDITY_NEVER_MAX),
};
const member_table review_validity_members = { MEMBER_TABLE("Validity", validity_members) };
#undef AT

#define AT(place) offsetof(review_warning, place)
static const member warning_members[] = {
    MEMBER("title", text, AT(title), "What is the case"),
    MEMBER("meaning", text, AT(meaning), "What it means for the results, in sentences"),
    MEMBER("detail", text, AT(detail), "Figures and limits of the solver; empty if there are none"),
    MEMBER("pointer", text, AT(pointer),
           "What has to do with it, in the document of the scenario; empty: all of it",
           .type = "#JsonPointer"),
};
const member_table review_warning_members = { MEMBER_TABLE("Warning", warning_members),
                                              .size = sizeof(review_warning) };
#undef AT

void review_write_texts(json_out *w, const review_warnings *of)
{
    char text[2 * REVIEW_TEXT_SIZE];

    json_out_array(w);
    for (size_t k = 0; k < of->n; k++) {
        snprintf(text, sizeof text, "%s. %s", of->items[k].title, of->items[k].meaning);
        json_out_string(w, text);
    }
    json_out_array_end(w);
}
