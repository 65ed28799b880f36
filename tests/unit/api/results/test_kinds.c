// Which part is of which kind, by the scenario's document.

#include "api/results/kinds.h"

#include "api/results/results.h"
#include "api/scenario/scenario.h"
#include "tests/unit/api/helper_document.h"
#include "tests/unit/helper_cmocka.h"

#include <string.h>

enum { N_PARTS = 6 };

#define PLACES                                                                                     \
    "'initial': {'positions_m': [[0.1, 0.3], [0.2, 0.3], [0.3, 0.3], [0.4, 0.3], [0.5, 0.3], "     \
    "[0.6, 0.3]]}"
#define BELT  "'duration_s': 1, 'domain': {'x_m': [0, 1], 'y_m': [0, 0.6]}, "
#define PLAIN "{" BELT PLACES ", 'cargo': {}}"
#define MIX   "{" BELT PLACES ", 'cargo': [{'share': 2}, {'shape': {'radius_m': 0.02}, 'share': 1}]}"

static const api_parts planar = { .n_parts = N_PARTS, .n_values = FRAME_VALUES_PLANAR };

static part_kinds find(const char *text, const api_parts *parts)
{
    bf_buffer resolved = document_resolve(text);
    part_kinds kinds;

    assert_int_equal(kinds_find(resolved.bytes, resolved.n, parts, &kinds, NULL), BF_OK);
    buffer_fini(&resolved);
    return kinds;
}

// Shares of 2 and 1 of 6 parts: 4 and 2. In which order they come is another test's (tests/unit/core/scene/test_mix.c).
static void the_kinds_of_a_mix_are_as_many_as_their_shares_say(void **unused)
{
    size_t counts[2] = { 0, 0 };
    part_kinds kinds = find(MIX, &planar);

    assert_int_equal(kinds.n, N_PARTS);
    for (size_t k = 0; k < kinds.n; k++) {
        assert_in_range(kinds.of[k], 0, 1);
        counts[kinds.of[k]]++;
    }
    assert_int_equal(counts[0], 4);
    assert_int_equal(counts[1], 2);
    kinds_fini(&kinds);
    assert_int_equal(kinds.n, 0);
}

static void one_kind_needs_no_list(void **unused)
{
    assert_int_equal(find(PLAIN, &planar).n, 0);
}

static void rows_without_parts_or_with_kinds_of_their_own_need_no_list(void **unused)
{
    const api_parts none = { .n_values = 0 };
    const api_parts with_ids = { .n_values = FRAME_VALUES_PLANAR + FRAME_VALUES_FED };

    assert_int_equal(find(MIX, &none).n, 0);
    assert_int_equal(find(MIX, &with_ids).n, 0);
}

static void a_list_of_snapshots_has_them(void **unused)
{
    const part_kinds kinds = { .n = 3, .of = (uint32_t[]){ 1, 0, 1 } };
    const api_snapshot_list list = { .parts = planar };
    bf_buffer out = { 0 };

    assert_int_equal(results_snapshots_json(&list, "x", &kinds, &out, NULL), BF_OK);
    assert_non_null(strstr(out.bytes, "]},\"kinds\":[1,0,1],\"snapshots\":[]}"));
    buffer_fini(&out);
}

static void a_damaged_mix_is_reported(void **unused)
{
    static const char damaged[] = "{\"cargo\":[";
    part_kinds kinds;

    assert_int_equal(kinds_find(damaged, sizeof damaged - 1, &planar, &kinds, NULL), BF_ECORRUPT);
    assert_int_equal(kinds.n, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_kinds_of_a_mix_are_as_many_as_their_shares_say),
        cmocka_unit_test(one_kind_needs_no_list),
        cmocka_unit_test(rows_without_parts_or_with_kinds_of_their_own_need_no_list),
        cmocka_unit_test(a_list_of_snapshots_has_them),
        cmocka_unit_test(a_damaged_mix_is_reported),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
