// Distance and depth of hulls against libccd, an independent implementation of the same algorithms.

#include "core/convex/gjk.h"

#include "tests/unit/core/helper_hull.h"
#include "tests/unit/core/helper_scene.h"
#include "tests/unit/helper_cmocka.h"

#include <ccd/ccd.h>

/// A hull in its place, for libccd.
typedef struct placed {
    const hull *shape;
    mat3 r;
    vec3 x;
} placed;

static void find_support(const void *object, const ccd_vec3_t *direction, ccd_vec3_t *ret_point)
{
    const placed *p = object;
    vec3 d = { ccdVec3X(direction), ccdVec3Y(direction), ccdVec3Z(direction) };
    size_t k = hull_support(p->shape, mat3_apply_back(&p->r, d));
    vec3 at = vec3_add(mat3_apply(&p->r, hull_vertex(p->shape, k)), p->x);

    ccdVec3Set(ret_point, at.x, at.y, at.z);
}

static ccd_t settings(void)
{
    ccd_t ccd;

    CCD_INIT(&ccd);
    ccd.support1 = ccd.support2 = find_support;
    ccd.max_iterations = 1000;
    ccd.epa_tolerance = 1e-10;
    return ccd;
}

/// Pairs like those of a jam: parts of a few sizes, by their centres apart.
static gjk_pair make_pair(bf_random *random, int k, hull *a, hull *b, placed *at_a, placed *at_b)
{
    double span = k % 2 == 0 ? 0.7 : 2.0;

    if (k % 2 == 0)
        helper_hull_box(1.0, 0.8, 0.5, a);
    else
        helper_hull_random(random, 8 + (size_t)k % 30, 1.0, a);
    helper_hull_random(random, 4 + (size_t)k % 20, 1.0, b);
    *at_a = (placed){ a, helper_hull_rotation(random), { 0.0, 0.0, 0.0 } };
    *at_b = (placed){ b,
                      helper_hull_rotation(random),
                      { helper_hull_number(random, -span, span),
                        helper_hull_number(random, -span, span),
                        helper_hull_number(random, -span, span) } };
    return gjk_pair_of(a, at_a->x, &at_a->r, b, at_b->x, &at_b->r);
}

// It says whether hulls touch, and mostly the same depth. It sometimes ends its search
// early: where the two differ, ours agrees with an exhaustive search.
static void libccd_finds_the_same_contacts_and_depths(void **state)
{
    bf_random random;
    int n_deep = 0, n_equal = 0;
    random_init(&random, 9);
    for (int k = 0; k < 600; k++) {
        hull a, b;
        placed at_a, at_b;
        ccd_t ccd = settings();
        ccd_real_t depth;
        ccd_vec3_t direction, position;
        gjk_pair pair = make_pair(&random, k, &a, &b, &at_a, &at_b);
        gjk_result touch = gjk_measure(&pair, (vec3){ 1.0, 0.0, 0.0 });
        int is_apart = ccdGJKPenetration(&at_a, &at_b, &ccd, &depth, &direction, &position);
        if (fabs(touch.distance) < 1e-6)
            continue;
        assert_true((is_apart != 0) == (touch.distance > 0.0));
        if (is_apart)
            continue;
        n_deep++;
        if (fabs(depth + touch.distance) < 1e-8)
            n_equal++;
        else
            assert_near(touch.distance, helper_hull_distance(&pair), 1e-11);
    }
    assert_true(n_deep > 100);
    assert_true(n_equal >= n_deep * 9 / 10);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(libccd_finds_the_same_contacts_and_depths),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
