// Laws of contacts in an implicit step, from the kinds of the parts and the boundary.

#include "core/micro/disk/implicit.h"
#include "core/micro/hardness.h"

#include <math.h>

// The numbers of a law.
typedef struct pair_law {
    double stiffness;   // N/m
    double damping;     // N s/m
    double friction;    // mu
    double rate;        // lambda, s/m
    double lower_bound; // of J
    double radius[2];   // m
    double inv_mass[2]; // 1/kg
} pair_law;

static pair_law law_of_parts(const disk_state *s, const disk *a, const disk *b)
{
    const double stiffness = s->cargo.line / (a->compliance + b->compliance);

    return (pair_law){ .stiffness = stiffness,
                       .damping = hardness_dashpot(&s->def, s->cargo.damping, stiffness,
                                                   a->inv_mass + b->inv_mass),
                       .friction = s->cargo.friction,
                       .rate = s->cargo.tanh_linear,
                       .radius = { a->radius, b->radius },
                       .inv_mass = { a->inv_mass, b->inv_mass } };
}

static pair_law law_with_boundary(const disk_state *s, const disk *part, size_t feature)
{
    const double stiffness = s->handling.line / (part->compliance + s->handling_compliance);

    return (pair_law){ .stiffness = stiffness,
                       .damping = hardness_dashpot(&s->def, s->handling.damping, stiffness,
                                                   part->inv_mass),
                       .friction = feature < s->n_faces ? s->faces[feature].friction
                                                        : s->arcs[feature - s->n_faces].friction,
                       .rate = s->handling.tanh_linear,
                       .radius = { part->radius, 0.0 },
                       .inv_mass = { part->inv_mass, 0.0 } };
}

static void set_law(implicit_law *law, size_t lane, const pair_law *of, double h)
{
    const double joint = h * of->stiffness + of->damping;
    const double scale = 1.0 / (1.0 + h * joint * (of->inv_mass[0] + of->inv_mass[1]));

    law->joint[lane] = joint;
    law->damping[lane] = of->damping;
    law->scale[lane] = scale;
    law->gain[lane] = h * joint * scale;
    law->lower_bound[lane] = of->lower_bound;
    law->friction[lane] = of->friction;
    law->rate[lane] = of->rate;
    for (int end = 0; end < 2; end++) {
        law->radius[end][lane] = of->radius[end];
        law->inv_mass[end][lane] = of->inv_mass[end];
    }
}

void disk_implicit__set_common_law(const disk_state *s, implicit_state *z)
{
    const disk *part = &s->kinds[0].part;
    const pair_law law = law_of_parts(s, part, part);

    for (size_t lane = 0; lane < IMPLICIT_WIDTH; lane++)
        set_law(&z->laws[0], lane, &law, s->def.dt);
}

void disk_implicit__set_law(const disk_state *s, const implicit_state *z,
                            const implicit_block *block, size_t lane, double gap, implicit_law *law)
{
    const disk *part = &s->now[implicit_body(block, 0, lane)];
    const size_t b = implicit_body(block, 1, lane);
    pair_law own = b < z->first_feature
                       ? law_of_parts(s, part, &s->now[b])
                       : law_with_boundary(s, part, z->features[b - z->first_feature]);

    own.lower_bound = s->def.tension && gap < 0.0 ? -HUGE_VAL : 0.0;
    set_law(law, lane, &own, s->def.dt);
}
