#include "core/micro/contact_law.h"

#include <math.h>

double contact_law_compliance(const scene_material *m, double reduction)
{
    return (1.0 - m->poisson_ratio * m->poisson_ratio) * reduction / m->young_modulus;
}

double contact_law_modulus(const scene_material *a, const scene_material *b, double reduction)
{
    return 1.0 / (contact_law_compliance(a, reduction) + contact_law_compliance(b, reduction));
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
