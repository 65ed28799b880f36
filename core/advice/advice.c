#include "core/advice/advice.h"

#include "core/advice/review_belts.h"
#include "core/advice/review_closure.h"
#include "core/advice/review_operation.h"
#include "core/advice/review_plates.h"
#include "core/advice/review_sinks.h"
#include "core/base/number_text.h"
#include "core/micro/hardness.h"
#include "core/run/micro_setup.h"
#include "core/scene/mix.h"

#include <math.h>
#include <stdio.h>

enum { DIGITS = 4 }; ///< of numbers in sentences

const double advice_density_trusted = 1.4;
const double advice_overlap_trusted = 0.05;

unsigned advice_doubts(run_model model, const frame_end *end)
{
    unsigned doubts = 0;

    if (model == RUN_MACRO && end->peak > advice_density_trusted)
        doubts |= ADVICE_DOUBT_DENSITY;
    if (end->overlap_share > advice_overlap_trusted)
        doubts |= ADVICE_DOUBT_OVERLAP;
    return doubts;
}

/// Warn of an opening that a kind of part does not fit through.
static void review_opening(const scene *s, const layout *of, review_warnings *ret_warnings)
{
    const double radius = mix_inner_radii_of(s).largest, opening = of->opening.value;
    char width[NUMBER_TEXT_SIZE], least[NUMBER_TEXT_SIZE];

    // One of 0 is closed, not narrow: validity says so.
    if (opening == 0.0 || opening >= layout_least_width(radius))
        return;
    review_explain(
        review_add(ret_warnings, "Parts do not fit through the narrowest opening", "/obstacles/%zu",
                   of->opening.index),
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
        review_add(ret_warnings, "The time step of the density model is long", "/macro/step_s");
    review_explain(
        item, "Densities may become negative, and the figures wrong: choose a shorter step, or "
              "leave the choice to the program.");
    snprintf(item->detail, sizeof item->detail, "The step is %.6g s, and not below %.6g s.", step,
             positive);
}

static void warn_of_items(const validity_item *items, size_t n, review_warnings *ret_warnings)
{
    for (size_t k = 0; k < n; k++) {
        if (items[k].figure == VALIDITY_OVERLAP || items[k].figure == VALIDITY_FALLS)
            continue; // review_hardness() and the falls say so
        review_warning *item = review_add(ret_warnings, items[k].title, "%s", items[k].pointer);
        review_explain(item, "%s", items[k].meaning);
        snprintf(item->detail, sizeof item->detail, "%s", items[k].comparison);
    }
}

/// Warn where parts may be pressed far into each other, before they are: by the overlap that is to be expected of these moduli.
static void review_hardness(const scene *s, double overlap, double reduction,
                            review_warnings *ret_warnings)
{
    char divisor[NUMBER_TEXT_SIZE];

    if (overlap <= advice_overlap_trusted)
        return;
    review_warning *item =
        review_add(ret_warnings, "Parts are softer than the load of a queue needs",
                   "/micro/modulus_reduction");
    review_explain(
        item,
        "A queue may press them into each other and into plates: more come through than in "
        "reality, and beyond %.3g %% of a radius the run fails.",
        100.0 * s->micro.overlap_limit);
    snprintf(item->detail, sizeof item->detail,
             "With moduli divided by %s an overlap of %.3g %% of the smallest radius is to be "
             "expected, more than %.3g %%.%s",
             number_text(reduction, DIGITS, divisor), 100.0 * overlap,
             100.0 * advice_overlap_trusted,
             s->micro.modulus_reduction > 0.0
                 ? " Without modulus_reduction the program chooses what is hard enough."
                 : " Their materials bear no more: kinds of very different mass or size press on "
                   "the smallest.");
}

/// Warn of light parts among heavy ones, which a run may not get through.
static void review_masses(const scene *s, review_warnings *ret_warnings)
{
    const double ratio = mix_mass_ratio(s);
    char times[NUMBER_TEXT_SIZE];
    size_t lightest = 0;

    if (ratio <= hardness_masses_most)
        return;
    for (size_t k = 1; k < s->n_cargo; k++)
        lightest = s->cargo[k].mass < s->cargo[lightest].mass ? k : lightest;
    review_warning *item =
        review_add(ret_warnings, "The masses of the kinds of parts differ too much",
                   "/cargo/%zu/mass_kg", lightest);
    review_explain(item,
                   "Where parts queue, light ones are squeezed by heavy ones faster than their "
                   "contacts follow: the run may fail, or take so long that it does not end. "
                   "Give them masses that are more alike, or use the density model.");
    snprintf(item->detail, sizeof item->detail,
             "The heaviest kind has %s times the mass of the lightest. Queues of cylinders were "
             "solved up to %g times, and failed at 1,000 times.",
             number_text(ratio, DIGITS, times), hardness_masses_most);
}

/// What both the warnings and the validity follow from, measured once.
static bf_status measure(const scene *s, run_model model, double *ret_overlap,
                         double *ret_reduction, validity *ret_validity, bf_error *err)
{
    micro_setup setup;

    if (model == RUN_MACRO)
        return validity_of(s, ret_validity, err);
    const bf_status status = micro_setup_init(s, NULL, 1, &setup, err);
    if (status != BF_OK)
        return status;
    *ret_overlap = hardness_expected_overlap(&setup.def);
    *ret_reduction = setup.def.modulus_reduction;
    micro_setup_fini(&setup);
    return validity_of_parts(s, *ret_overlap, ret_validity, err);
}

bf_status advice_of(const scene *s, run_model model, advice *ret_advice, bf_error *err)
{
    review_warnings *warnings = &ret_advice->warnings;
    const validity *v = &ret_advice->validity;
    double overlap = NAN, reduction = NAN;

    *ret_advice = (advice){ .model = model };
    bf_status status = measure(s, model, &overlap, &reduction, &ret_advice->validity, err);
    if (status == BF_OK)
        status = review_plates(s, warnings, err);
    if (status != BF_OK)
        return status;
    review_belts_outside(s, warnings);
    review_append(warnings, &v->falls);
    if ((status = review_sinks(s, warnings, err)) != BF_OK)
        return status;
    review_opening(s, &v->layout, warnings);
    status = review_operation(s, warnings, err);
    if (model == RUN_MACRO) {
        review_step(s, warnings);
        review_closure(s, warnings);
    } else {
        review_hardness(s, overlap, reduction, warnings);
        review_masses(s, warnings);
    }
    warn_of_items(v->items, v->n, warnings);
    warn_of_items(v->never, v->n_never, warnings);
    return status;
}
