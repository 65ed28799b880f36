#include "core/advice/review_closure.h"

#include "core/scene/cells.h"

#include <math.h>
#include <stdio.h>

/// A cell may be fitted by so much, relative to it, without a warning.
static const double fitted_most = 0.1;

static void add_unused(const char *pointer, const char *member, const char *closure,
                       review_warnings *ret_warnings)
{
    char title[REVIEW_TEXT_SIZE];

    snprintf(title, sizeof title, "'%s' has no effect on the density model", member);
    review_explain(review_add(ret_warnings, title, "%s", pointer),
                   "Only the closure '%s' uses it: leave it out, or choose that closure.", closure);
}

static void review_macro(const scene *s, review_warnings *ret_warnings)
{
    const scene_macro *m = &s->macro;
    scene d;

    scene_init(&d);
    if (m->closure == SCENE_DISPERSIVE) {
        if (m->jam_density != d.macro.jam_density)
            add_unused("/macro/jam_density", "jam_density", "congested", ret_warnings);
        return;
    }
    if (m->heaviside != d.macro.heaviside)
        add_unused("/macro/heaviside", "heaviside", "dispersive", ret_warnings);
    if (m->heaviside_width != d.macro.heaviside_width)
        add_unused("/macro/heaviside_width", "heaviside_width", "dispersive", ret_warnings);
    if (m->dispersion != 2.0 * scene_belt_speed(s))
        add_unused("/macro/dispersion_m_s", "dispersion_m_s", "dispersive", ret_warnings);
    if (m->mollifier != d.macro.mollifier)
        add_unused("/macro/mollifier_per_m2", "mollifier_per_m2", "dispersive", ret_warnings);
}

/// The first obstacle with a member that another closure uses stands for all.
static void review_obstacles(const scene *s, review_warnings *ret_warnings)
{
    char pointer[BF_POINTER_SIZE];

    for (size_t k = 0; k < s->n_obstacles; k++) {
        const scene_obstacle *o = &s->obstacles[k];
        scene_obstacle d = { .treatment = o->treatment, .band = NAN, .slide_width = NAN };
        scene_resolve_obstacle(&d, s->macro.mollifier);
        const char *member = o->treatment != SCENE_SEALED      ? "treatment"
                             : o->band != d.band               ? "band_m"
                             : o->slide_width != d.slide_width ? "slide_width_m"
                                                               : NULL;
        if (member == NULL)
            continue;
        snprintf(pointer, sizeof pointer, "/obstacles/%zu/%s", k, member);
        add_unused(pointer, member, "dispersive", ret_warnings);
        return;
    }
}

static void review_cell(const scene *s, review_warnings *ret_warnings)
{
    const double wanted = s->macro.cell;
    const cells c = cells_of(s);
    const double off = fmax(fabs(c.d1 - wanted), fabs(c.d2 - wanted));

    if (wanted == 0.0 || off <= fitted_most * wanted)
        return;
    review_explain(
        review_add(ret_warnings, "The domain is not a whole number of cells of this size",
                   "/macro/cell_m"),
        "The density model has cells of %.4g m x %.4g m instead of %.4g m.", c.d1, c.d2, wanted);
}

void review_closure(const scene *s, review_warnings *ret_warnings)
{
    review_macro(s, ret_warnings);
    if (s->macro.closure != SCENE_DISPERSIVE)
        review_obstacles(s, ret_warnings);
    review_cell(s, ret_warnings);
}
