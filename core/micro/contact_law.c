#include "core/micro/contact_law.h"

#include <math.h>

double contact_law_modulus(const scene_material *a, const scene_material *b, double reduction)
{
    double soft_a = (1.0 - a->poisson_ratio * a->poisson_ratio) * reduction / a->young_modulus;
    double soft_b = (1.0 - b->poisson_ratio * b->poisson_ratio) * reduction / b->young_modulus;

    return 1.0 / (soft_a + soft_b);
}

static micro_law contact_law_with(const scene_contact *contact, double stiffness)
{
    return (micro_law){ .stiffness = stiffness,
                        .damping = contact->damping,
                        .friction = contact->friction,
                        .tanh_linear = contact->tanh_linear,
                        .tanh_spin = contact->tanh_spin };
}

micro_law contact_law_of_line(const scene_contact *contact, const scene_material *a,
                              const scene_material *b, double reduction)
{
    return contact_law_with(contact,
                            0.25 * M_PI * contact_law_modulus(a, b, reduction) * contact->length);
}

micro_law contact_law_of_disk(const scene_contact *contact, const scene_material *cargo,
                              const scene_material *conveyor, double reduction, double r)
{
    return contact_law_with(contact, 2.0 * contact_law_modulus(cargo, conveyor, reduction) * r);
}
