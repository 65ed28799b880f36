// What is said about the results of a scenario before it is solved.

#include "core/run/review.h"

#include "core/base/number_text.h"
#include "core/feed/arrivals.h"
#include "core/feed/capacity.h"
#include "core/figures/figure.h"
#include "core/micro/hardness.h"
#include "core/run/review_closure.h"
#include "core/run/review_plates.h"
#include "core/run/review_sinks.h"
#include "core/run/run.h"
#include "core/run/run_priv.h"
#include "core/scene/belt_path.h"
#include "core/scene/mix.h"
#include "core/scene/surroundings.h"

#include <math.h>
#include <stdio.h>

enum { DIGITS = 4 };          ///< of numbers in sentences
enum { LEAST_FAILURES = 10 }; ///< of a kind in a run: their number is then known to a third
enum { BEAM_POINTS = 101 };   ///< of a beam that belts are looked for under

review_warning *review_add(review_warnings *w, const char *pointer, const char *title)
{
    review_warning *item = &w->items[w->n];

    *item = (review_warning){ 0 };
    snprintf(item->title, sizeof item->title, "%s", title);
    snprintf(item->pointer, sizeof item->pointer, "%s", pointer);
    w->n += w->n < REVIEW_WARNINGS_MAX;
    return item;
}

void review_append(review_warnings *w, const review_warnings *others)
{
    for (size_t k = 0; k < others->n; k++)
        *review_add(w, "", "") = others->items[k];
}

/// Warn of a rate that belts cannot carry away from the line of a feed.
static bf_status review_rate(const scene *s, size_t k, review_warnings *ret_warnings, bf_error *err)
{
    static const char *const members[SCENE_DEMAND_COUNT] = { "rate_per_s", "profile", "schedule" };
    const scene_feed *feed = &s->feeds[k];
    const double capacity = feed_capacity(s, feed);
    char pointer[BF_POINTER_SIZE];
    feed_arrivals *arrivals;

    bf_status status = feed_arrivals_create(feed, s->substream, &arrivals, err);
    if (status != BF_OK)
        return status;
    const double rate = feed_arrivals_largest_rate(arrivals);
    feed_arrivals_destroy(arrivals);
    snprintf(pointer, sizeof pointer, "/feeds/%zu/%s", k, members[feed->demand]);
    if (rate <= capacity)
        return BF_OK;
    char due[NUMBER_TEXT_SIZE], carried[NUMBER_TEXT_SIZE];
    review_warning *item =
        review_add(ret_warnings, pointer, "More parts arrive than the belt carries away");
    snprintf(item->meaning, sizeof item->meaning,
             "The feed '%s' delivers up to %s parts/s, but belts carry at most %s parts/s "
             "away from its line: the others wait.",
             feed->id, number_text(rate, DIGITS, due), number_text(capacity, DIGITS, carried));
    return BF_OK;
}

/// Which belts stand when their cargo breaks a beam, and which belts each beam crosses.
typedef struct standing {
    const scene *s;
    bool stands[SCENE_BELTS_MAX];
    bool stands_under[SCENE_EYES_MAX]; ///< nothing under the beam moves
    bool crosses[SCENE_EYES_MAX][SCENE_BELTS_MAX];
} standing;

/// True if what stops a belt starts it again, too, after a time.
static bool starts_again(const standing *c, const scene_action *stop)
{
    bool is_so = false;

    for (size_t k = 0; k < c->s->n_actions && !is_so; k++) {
        const scene_action *a = &c->s->actions[k];
        is_so = a->type == SCENE_ACTION_BELT && a->target == stop->target && a->value > 0.0 &&
                a->eye == stop->eye && a->when_blocked && a->delay > stop->delay;
    }
    return is_so;
}

/// True if the action stops a belt by cargo that then stands in the beam.
static bool stops_itself(const standing *c, const scene_action *a)
{
    return a->type == SCENE_ACTION_BELT && a->when_blocked && a->value == 0.0 &&
           c->crosses[a->eye][a->target] && c->stands_under[a->eye] && !starts_again(c, a);
}

/// True if a belt that stands stays so: an action stops it by its own cargo, and those that start it wait for
/// photo eyes above belts that stand.
static bool stays(const standing *c, size_t belt)
{
    bool is_stopped = false;

    for (size_t k = 0; k < c->s->n_actions; k++) {
        const scene_action *a = &c->s->actions[k];
        if (a->type != SCENE_ACTION_BELT || a->target != belt)
            continue;
        if (a->value > 0.0 && !c->stands_under[a->eye])
            return false;
        is_stopped = is_stopped || stops_itself(c, a);
    }
    return is_stopped;
}

/// Warn of photo eyes that command something and lie beside all belts.
static void review_beams(const standing *c, review_warnings *ret_warnings)
{
    char pointer[BF_POINTER_SIZE];

    for (size_t e = 0; e < c->s->n_eyes; e++) {
        bool commands = false, crosses = false;
        for (size_t k = 0; k < c->s->n_actions; k++)
            commands = commands || c->s->actions[k].eye == e;
        for (size_t k = 0; k < c->s->n_merges; k++)
            for (size_t i = 0; i < c->s->merges[k].n_lanes; i++)
                commands = commands || c->s->merges[k].lanes[i].eye == e;
        for (size_t k = 0; k < c->s->n_belts; k++)
            crosses = crosses || c->crosses[e][k];
        if (!commands || crosses)
            continue;
        snprintf(pointer, sizeof pointer, "/photo_eyes/%zu/line_m", e);
        review_warning *item =
            review_add(ret_warnings, pointer, "A photo eye lies beside the belts");
        snprintf(item->meaning, sizeof item->meaning,
                 "No cargo is carried through the beam of '%s', so that nothing it commands will "
                 "happen.",
                 c->s->eyes[e].id);
    }
}

/// Warn of lanes whose parts their photo eyes do not see.
static void review_lanes(const standing *c, review_warnings *ret_warnings)
{
    char pointer[BF_POINTER_SIZE];

    for (size_t k = 0; k < c->s->n_merges; k++) {
        for (size_t i = 0; i < c->s->merges[k].n_lanes; i++) {
            const scene_lane *lane = &c->s->merges[k].lanes[i];
            if (c->crosses[lane->eye][lane->belt])
                continue;
            snprintf(pointer, sizeof pointer, "/merges/%zu/lanes/%zu/photo_eye", k, i);
            review_warning *item =
                review_add(ret_warnings, pointer, "A lane does not come to its photo eye");
            snprintf(item->meaning, sizeof item->meaning,
                     "The beam of '%s' does not cross the belt '%s', which stops and goes by what "
                     "is in it.",
                     c->s->eyes[lane->eye].id, c->s->belts[lane->belt].id);
        }
    }
}

/// Warn of actions in a circle. The belts that stay are the largest set of which each one stays as long as the others
/// do.
static void review_actions(const scene *s, review_warnings *ret_warnings)
{
    standing c = { .s = s };
    char pointer[BF_POINTER_SIZE];
    bool changes = true;

    if (s->n_actions == 0 && s->n_merges == 0)
        return;
    const surroundings around = surroundings_of(s);
    for (size_t e = 0; e < s->n_eyes; e++) {
        const vec2 *line = s->eyes[e].line;
        for (int k = 0; k < BEAM_POINTS; k++) {
            const double place = (double)k / (BEAM_POINTS - 1);
            const vec2 at = vec2_add(line[0], vec2_scale(vec2_sub(line[1], line[0]), place));
            const size_t belt = surroundings_belt_at(&around, at);
            if (belt < around.n_belts)
                c.crosses[e][scene_belt_of(s, belt)] = true;
        }
    }
    review_beams(&c, ret_warnings);
    review_lanes(&c, ret_warnings);
    for (size_t k = 0; k < s->n_belts; k++)
        c.stands[k] = true;
    while (changes) {
        changes = false;
        for (size_t e = 0; e < s->n_eyes; e++) {
            bool is_any = false, all_stand = true;
            for (size_t k = 0; k < s->n_belts; k++) {
                is_any = is_any || c.crosses[e][k];
                all_stand = all_stand && (!c.crosses[e][k] || c.stands[k]);
            }
            c.stands_under[e] = is_any && all_stand;
        }
        for (size_t k = 0; k < s->n_belts; k++) {
            if (!c.stands[k] || stays(&c, k))
                continue;
            c.stands[k] = false;
            changes = true;
        }
    }
    for (size_t k = 0; k < s->n_actions; k++) {
        const scene_action *a = &s->actions[k];
        if (!stops_itself(&c, a))
            continue;
        snprintf(pointer, sizeof pointer, "/actions/%zu", k);
        review_warning *item = review_add(ret_warnings, pointer, "Actions in a circle stop a belt");
        snprintf(item->meaning, sizeof item->meaning,
                 "Cargo in the beam of '%s' stops the belt '%s' under it, which nothing but photo "
                 "eyes above standing belts starts again.",
                 s->eyes[a->eye].id, s->belts[a->target].id);
    }
}

/// Warn of failures that are too rare for the run.
static void review_failures(const scene *s, review_warnings *ret_warnings)
{
    const double lasts = fmax(s->duration - s->warmup, 0.0);
    char pointer[BF_POINTER_SIZE], every[NUMBER_TEXT_SIZE], expected[NUMBER_TEXT_SIZE],
        needed[NUMBER_TEXT_SIZE];

    for (size_t k = 0; k < figure_items(s, FIGURE_OF_FAILURE); k++) {
        size_t i;
        const size_t belt = figure_failure(s, k, &i);
        const scene_failure *f = &s->belts[belt].stops.failures[i];
        const double cycle = f->between.mean + f->repair.mean;
        if (f->type != SCENE_FAILURE_DRAWN || lasts >= LEAST_FAILURES * cycle)
            continue;
        snprintf(pointer, sizeof pointer, "/belts/%zu/failures/%zu/mtbf_s", belt, i);
        review_warning *item =
            review_add(ret_warnings, pointer, "The run is too short to see what failures do");
        snprintf(
            item->meaning, sizeof item->meaning,
            "'%s' stops the belt '%s' every %s s, so that the run has about %s of them after "
            "its warm-up, and its figures are those of chance: about %s s are needed for %d, or "
            "as many in replications.",
            f->id, s->belts[belt].id, number_text(cycle, DIGITS, every),
            number_text(lasts / cycle, 2, expected),
            number_text(LEAST_FAILURES * cycle, DIGITS, needed), (int)LEAST_FAILURES);
    }
}

/// Warn of an opening that a kind of part does not fit through.
static void review_opening(const scene *s, const layout *of, review_warnings *ret_warnings)
{
    const double radius = mix_inner_radii_of(s).largest, opening = of->opening.value;
    char pointer[BF_POINTER_SIZE], width[NUMBER_TEXT_SIZE], least[NUMBER_TEXT_SIZE];

    // One of 0 is closed, not narrow: validity says so.
    if (opening == 0.0 || opening >= layout_least_width(radius))
        return;
    snprintf(pointer, sizeof pointer, "/obstacles/%zu", of->opening.index);
    review_warning *item =
        review_add(ret_warnings, pointer, "Parts do not fit through the narrowest opening");
    snprintf(item->meaning, sizeof item->meaning,
             "It is %s m wide, and parts are up to %s m wide where they are narrowest: those that "
             "have no other way stay before it.",
             number_text(opening, DIGITS, width), number_text(2.0 * radius, DIGITS, least));
}

static void review_step(const scene *s, review_warnings *ret_warnings)
{
    const double step = scene_macro_step(s), positive = scene_step_positive(s);

    if (step < positive)
        return;
    review_warning *item =
        review_add(ret_warnings, "/macro/step_s", "The time step of the density model is long");
    snprintf(item->meaning, sizeof item->meaning,
             "Densities may become negative, and the figures wrong: choose a shorter step, or "
             "leave the choice to the program.");
    snprintf(item->detail, sizeof item->detail, "The step is %.6g s, and not below %.6g s.", step,
             positive);
}

static void warn_of_items(const validity_item *items, size_t n, review_warnings *ret_warnings)
{
    for (size_t k = 0; k < n; k++) {
        if (items[k].figure == VALIDITY_OVERLAP || items[k].figure == VALIDITY_FALLS)
            continue; // review_hardness() and the falls say so
        review_warning *item = review_add(ret_warnings, items[k].pointer, items[k].title);
        snprintf(item->meaning, sizeof item->meaning, "%s", items[k].meaning);
        snprintf(item->detail, sizeof item->detail, "%s", items[k].comparison);
    }
}

/// Warn where parts may be pressed far into each other, before they are: by the overlap that is to be expected of these moduli.
static void review_hardness(const scene *s, double overlap, double reduction,
                            review_warnings *ret_warnings)
{
    char divisor[NUMBER_TEXT_SIZE];

    if (overlap <= run_overlap_trusted)
        return;
    review_warning *item = review_add(ret_warnings, "/micro/modulus_reduction",
                                      "Parts are softer than the load of a queue needs");
    snprintf(item->meaning, sizeof item->meaning,
             "A queue may press them into each other and into plates: more come through than in "
             "reality, and beyond %.3g %% of a radius the run fails.",
             100.0 * s->micro.overlap_limit);
    snprintf(item->detail, sizeof item->detail,
             "With moduli divided by %s an overlap of %.3g %% of the smallest radius is to be "
             "expected, more than %.3g %%.%s",
             number_text(reduction, DIGITS, divisor), 100.0 * overlap, 100.0 * run_overlap_trusted,
             s->micro.modulus_reduction > 0.0
                 ? " Without modulus_reduction the program chooses what is hard enough."
                 : " Their materials bear no more: kinds of very different mass or size press on "
                   "the smallest.");
}

/// What both the warnings and the validity follow from, measured once.
static bf_status measure(const scene *s, run_model model, double *ret_overlap,
                         double *ret_reduction, validity *ret_validity, bf_error *err)
{
    run__micro_setup setup;

    if (model == RUN_MACRO)
        return validity_of(s, ret_validity, err);
    const bf_status status = run__micro_init_setup(s, NULL, 1, &setup, err);
    if (status != BF_OK)
        return status;
    *ret_overlap = hardness_expected_overlap(&setup.def);
    *ret_reduction = setup.def.modulus_reduction;
    run__micro_fini_setup(&setup);
    return validity_of_parts(s, *ret_overlap, ret_validity, err);
}

bf_status run_review_of(const scene *s, run_model model, run_review *ret_review, bf_error *err)
{
    review_warnings *warnings = &ret_review->warnings;
    const validity *v = &ret_review->validity;
    double overlap = NAN, reduction = NAN;

    *ret_review = (run_review){ .model = model };
    bf_status status = measure(s, model, &overlap, &reduction, &ret_review->validity, err);
    if (status == BF_OK)
        status = review_plates(s, warnings, err);
    if (status != BF_OK)
        return status;
    review_append(warnings, &v->falls);
    if ((status = review_sinks(s, warnings, err)) != BF_OK)
        return status;
    review_opening(s, &v->layout, warnings);
    for (size_t k = 0; k < s->n_feeds && status == BF_OK; k++)
        status = review_rate(s, k, warnings, err);
    review_actions(s, warnings);
    review_failures(s, warnings);
    if (model == RUN_MACRO) {
        review_step(s, warnings);
        review_closure(s, warnings);
    } else {
        review_hardness(s, overlap, reduction, warnings);
    }
    warn_of_items(v->items, v->n, warnings);
    warn_of_items(v->never, v->n_never, warnings);
    return status;
}
