#include "core/advice/bridges.h"

#include <math.h>
#include <stddef.h>

/// b, 1/diameter^2: tests/validation/bridges.py says what the rows fall with, the slower kind of outlet.
#define FALL 0.68

/// A place between two rising values: at `index` and `part` of the way to the next one.
typedef struct between {
    size_t index;
    double part;
} between;

static between find(const double *values, size_t n, double value)
{
    size_t k = 0;

    while (k + 2 < n && value >= values[k + 1])
        k++;
    const double part = (value - values[k]) / (values[k + 1] - values[k]);
    return (between){ k, fmin(fmax(part, 0.0), 1.0) };
}

/// Half a stop by the parts that passed at an opening, at one angle and friction or over all of them, whichever is less.
static double most_of(bool has_two, size_t angle, size_t friction, size_t opening)
{
    const double passed = bridges_table[has_two][angle][friction][opening].passed;
    bridges_cell all = { 0.0, 0.5 };

    for (size_t a = 0; a < BRIDGES_ANGLES; a++) {
        for (size_t f = 0; f < BRIDGES_FRICTIONS; f++) {
            all.passed += bridges_table[has_two][a][f][opening].passed;
            all.stops += bridges_table[has_two][a][f][opening].stops;
        }
    }
    return fmin(passed > 0.0 ? 0.5 / passed : 1.0, all.passed > 0.0 ? all.stops / all.passed : 1.0);
}

/// h of a cell of the table.
static double chance_of(bool has_two, size_t angle, size_t friction, size_t opening)
{
    double chance = 1.0, narrower = bridges_openings[0];

    for (size_t o = 0; o <= opening; o++) {
        const bridges_cell *cell = &bridges_table[has_two][angle][friction][o];
        const double w = bridges_openings[o];
        if (cell->stops > 0.0)
            chance = cell->stops / cell->passed;
        else
            chance = fmin(chance * exp(-FALL * (w * w - narrower * narrower)),
                          most_of(has_two, angle, friction, o));
        narrower = w;
    }
    return chance;
}

double bridges_probability(const bridges_outlet *at, double n)
{
    const between a = find(bridges_angles, BRIDGES_ANGLES, at->angle);
    const between f = find(bridges_frictions, BRIDGES_FRICTIONS, at->friction);
    const between o = find(bridges_openings, BRIDGES_OPENINGS, at->opening);
    double logarithm = 0.0;

    if (at->opening > bridges_openings[BRIDGES_OPENINGS - 1])
        return 0.0;
    for (int corner = 0; corner < 8; corner++) {
        const size_t da = corner & 1, df = (corner >> 1) & 1, dw = (corner >> 2) & 1;
        const double weight = (da ? a.part : 1.0 - a.part) * (df ? f.part : 1.0 - f.part) *
                              (dw ? o.part : 1.0 - o.part);
        if (weight > 0.0)
            logarithm += weight * log(chance_of(at->has_two_plates, a.index + da, f.index + df,
                                                o.index + dw));
    }
    return -expm1(n * log1p(-fmin(exp(logarithm), 1.0 - 1e-12)));
}

double bridges_of(const scene *s, const layout *of, double diameter, double n)
{
    const scene_contact *contact = s->micro.contact;
    const bridges_outlet outlet = {
        .has_two_plates = of->n_plates > 1,
        .opening = of->opening.value / diameter,
        .angle = of->greatest.value,
        .friction = contact[SCENE_CARGO_CARGO].friction + contact[SCENE_HANDLING_CARGO].friction,
    };

    for (size_t k = 0; k < s->n_cargo; k++) {
        if (s->cargo[k].shape.type != SCENE_CYLINDER)
            return 0.0;
    }
    return outlet.opening > 0.0 ? bridges_probability(&outlet, n) : 0.0;
}
