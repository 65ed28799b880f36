// The summary of a run: its figures and warnings, and that of a run whose results were known.

#include "api/results/results.h"

#include "api/scenario/scenario.h"
#include "core/base/memory.h"
#include "tests/unit/api/helper_document.h"
#include "tests/unit/helper_cmocka.h"

#include <jansson.h>
#include <math.h>
#include <string.h>

static json_t *parse(const bf_buffer *b)
{
    json_t *root = json_loadb(b->bytes, b->n, JSON_REJECT_DUPLICATES, NULL);

    assert_non_null(root);
    return root;
}

static double number_at(const json_t *object, const char *key)
{
    const json_t *value = json_object_get(object, key);

    assert_true(json_is_number(value));
    return json_number_value(value);
}

// A text of an object in a list.
static const char *text_at(const json_t *list, size_t k, const char *key)
{
    return json_string_value(json_object_get(json_array_get(list, k), key));
}

static const frame_begin begin = { .model = RUN_MACRO, .dt = 0.00125, .duration = 1.0 };
static const frame_end end = { .n_steps = 800,
                               .t = 1.0,
                               .n_cells = 24000,
                               .parts_start = 192.0,
                               .parts_end = 100.5,
                               .peak = 1.25,
                               .digest = 0xabc };
static const results_timing timing = { .wall_s = 0.5, .n_threads = 2 };

// Of a run with one counter.
static const double known_figures[FIGURE_COUNT] = { 3600.0 };
static const key_figures figures = { .columns = "upstream,left_domain",
                                     .t = 1.0,
                                     .n = FIGURE_OFFERED + FIGURE_GAP_MIN - FIGURE_CONTENT_MEAN,
                                     .values = known_figures };

static json_t *summarise_scenario(const char *text, const frame_begin *b, const frame_end *e)
{
    bf_buffer scenario = document_resolve(text);
    bf_buffer out = { 0 };

    assert_int_equal(results_summary((run_model)b->model, scenario.bytes, scenario.n, b, e,
                                     &figures, &timing, &out, NULL),
                     BF_OK);
    json_t *root = parse(&out);
    json_t *document = json_loadb(scenario.bytes, scenario.n, 0, NULL);
    assert_true(json_equal(json_object_get(root, "scenario"), document));
    json_decref(document);
    buffer_fini(&out);
    buffer_fini(&scenario);
    return root;
}

static json_t *summarise(const frame_begin *b, const frame_end *e)
{
    return summarise_scenario("{" DOCUMENT_NEEDED "}", b, e);
}

static void a_summary_has_the_figures_of_the_run(void **unused)
{
    json_t *root = summarise(&begin, &end);

    assert_string_equal(json_string_value(json_object_get(root, "model")), "macro");
    assert_true(json_is_string(json_object_get(root, "solver_version")));
    assert_true(number_at(root, "steps") == 800);
    assert_true(number_at(root, "cells") == 24000);
    assert_true(number_at(root, "step_s") == 0.00125);
    assert_true(number_at(root, "duration_s") == 1.0);
    assert_true(number_at(root, "wall_time_s") == 0.5);
    assert_true(number_at(root, "cell_steps_per_s") == 800.0 * 24000.0 / 0.5);
    assert_true(number_at(root, "threads") == 2);
    assert_true(number_at(root, "parts_start") == 192.0);
    assert_true(number_at(root, "parts_end") == 100.5);
    assert_true(number_at(root, "parts_left") == 91.5);
    assert_true(number_at(root, "largest_density") == 1.25);
    // 1/(2 sqrt(3) r^2) of the default cylinder, r = 0.012 m: the paper's 2004 parts/m2.
    assert_true(number_at(root, "packing_density_per_m2") == 2004.0);
    assert_string_equal(json_string_value(json_object_get(root, "digest")), "0000000000000abc");
    assert_int_equal(json_array_size(json_object_get(root, "warnings")), 0);
    json_decref(root);
}

// dx/(2 (eps + |v|)) = 0.005/(2 (0.79 + 0.395)) = 2.11 ms bounds the positive step.
static void a_summary_warns(void **unused)
{
    frame_end dense = end;

    dense.peak = 1.41;
    dense.stopped = 1;
    json_t *root = summarise_scenario(
        DOCUMENT_WITH("'macro': {'closure': 'dispersive', 'cell_m': 0.005, 'step_s': 0.00212}"),
        &begin, &dense);
    const json_t *texts = json_object_get(root, "warnings");
    assert_int_equal(json_array_size(texts), 3);
    assert_true(json_is_true(json_object_get(root, "stopped")));
    assert_non_null(strstr(json_string_value(json_array_get(texts, 0)), "stopped before its end"));
    assert_non_null(strstr(json_string_value(json_array_get(texts, 1)), "denser than real parts"));
    assert_non_null(strstr(json_string_value(json_array_get(texts, 2)), "time step"));
    const json_t *details = json_object_get(root, "warning_details");
    assert_int_equal(json_array_size(details), 3);
    assert_string_equal(text_at(details, 0, "detail"), "");
    assert_non_null(strstr(text_at(details, 1, "detail"), "1.41"));
    assert_non_null(strstr(text_at(details, 2, "detail"), "0.00212"));
    assert_string_equal(text_at(details, 2, "pointer"), "/macro/step_s");
    json_decref(root);
}

// One part before a deflector: what holds of heaps does not hold of it. The warning leads to the same place.
static void a_summary_says_whether_the_model_was_compared_for_such_a_scenario(void **unused)
{
    static const char deflected[] =
        DOCUMENT_WITH("'obstacles': [{'from_m': [0.461325, 0], 'to_m': [0.75, 0.5]}]");
    json_t *root = summarise(&begin, &end);
    const json_t *compared = json_object_get(root, "validity");

    assert_true(json_is_true(json_object_get(compared, "compared")));
    assert_int_equal(json_array_size(json_object_get(compared, "outside")), 0);
    json_decref(root);
    root = summarise_scenario(deflected, &begin, &end);
    compared = json_object_get(root, "validity");
    assert_true(json_is_false(json_object_get(compared, "compared")));
    assert_int_equal(json_array_size(json_object_get(compared, "outside")), 1);
    const json_t *item = json_array_get(json_object_get(compared, "outside"), 0);
    assert_string_equal(json_string_value(json_object_get(item, "what")), "parts");
    assert_true(number_at(item, "value") == 1.0);
    assert_true(number_at(item, "min") > 1.0);
    assert_string_equal(json_string_value(json_object_get(item, "pointer")), "/initial");
    const json_t *details = json_object_get(root, "warning_details");
    assert_int_equal(json_array_size(details), 1);
    assert_string_equal(text_at(details, 0, "pointer"), "/initial");
    json_decref(root);
}

static const frame_begin micro_begin = {
    .model = RUN_MICRO, .dt = 1e-5, .duration = 1.0, .n_parts = 192, .n_values = FRAME_VALUES_PLANAR
};
static const frame_end micro_end = { .n_steps = 100000,
                                     .t = 1.0,
                                     .n_cells = 24000,
                                     .parts_start = 192.0,
                                     .parts_end = 190.0,
                                     .n_parts_left = 2,
                                     .part_steps = 192.0 * 100000.0,
                                     .peak = 1.5,
                                     .n_contacts = 17,
                                     .kinetic_energy = 0.25,
                                     .largest_overlap = 0.0005,
                                     .overlap_share = 0.0625 };

static void parts_of_feeds_count_in_a_summary(void **unused)
{
    frame_begin fed = micro_begin;
    frame_end over = micro_end;

    fed.n_parts = 2;
    over.parts_start = 2.0;
    over.parts_entered = 40.0;
    over.parts_end = 3.0;
    over.part_steps = 5e6;
    json_t *root = summarise(&fed, &over);
    assert_true(number_at(root, "parts") == 42);
    assert_true(number_at(root, "particle_steps_per_s") == 1e7);
    json_decref(root);
}

static void a_microscopic_summary_counts_parts(void **unused)
{
    json_t *root = summarise(&micro_begin, &micro_end);

    assert_string_equal(json_string_value(json_object_get(root, "path")), "planar");
    assert_true(number_at(root, "parts") == 192);
    assert_true(number_at(root, "particle_steps_per_s") == 192.0 * 100000.0 / 0.5);
    assert_null(json_object_get(root, "cells"));
    assert_null(json_object_get(root, "cell_steps_per_s"));
    assert_true(number_at(root, "parts_left") == 2.0);
    assert_true(number_at(root, "largest_overlap_m") == 0.0005);
    assert_true(number_at(root, "largest_overlap_share") == 0.0625);
    assert_true(number_at(root, "contacts") == 17);
    assert_true(number_at(root, "kinetic_energy_j") == 0.25);
    const json_t *of = json_object_get(root, "validity");
    assert_null(json_object_get(of, "closure"));
    assert_non_null(json_object_get(of, "compared"));
    assert_int_equal(json_array_size(json_object_get(of, "outside")), 0);
    json_decref(root);
}

// 6.25 % of a radius are more than 5 %; a density of 1.5 means nothing where parts are counted.
static void a_microscopic_summary_warns_of_soft_parts_only(void **unused)
{
    frame_end hard = micro_end;
    json_t *soft_root = summarise(&micro_begin, &micro_end);
    json_t *texts = json_object_get(soft_root, "warnings");

    assert_int_equal(json_array_size(texts), 1);
    const json_t *details = json_object_get(soft_root, "warning_details");
    assert_non_null(strstr(text_at(details, 0, "detail"), "6.25 % of a radius"));
    json_decref(soft_root);
    hard.overlap_share = 0.05;
    json_t *hard_root = summarise(&micro_begin, &hard);
    assert_int_equal(json_array_size(json_object_get(hard_root, "warnings")), 0);
    json_decref(hard_root);
}

static void a_damaged_scenario_gives_no_summary(void **unused)
{
    bf_buffer out = { 0 };
    bf_error err = { 0 };

    assert_int_equal(
        results_summary(RUN_MACRO, "{", 1, &begin, &end, &figures, &timing, &out, &err),
        BF_ECORRUPT);
    assert_int_equal(err.code, BF_ECORRUPT);
    assert_int_equal(out.n, 0);
    buffer_fini(&out);
}

// The second one has a name that looks like the member that is replaced.
static void a_cached_summary_differs_in_its_scenario_alone(void **unused)
{
    static const char *const documents[] = { "{'name': 'first', " DOCUMENT_NEEDED "}",
                                             "{'name': 'a\\',\\'scenario\\':{b', " DOCUMENT_NEEDED
                                             "}",
                                             "{" DOCUMENT_NEEDED "}" };
    bf_buffer summary = { 0 };

    for (size_t i = 0; i < sizeof documents / sizeof *documents; i++) {
        bf_buffer scenario = document_resolve(documents[i]), wanted = { 0 }, out = { 0 };
        assert_int_equal(results_summary(RUN_MACRO, scenario.bytes, scenario.n, &begin, &end,
                                         &figures, &timing, &wanted, NULL),
                         BF_OK);
        if (i > 0) {
            assert_int_equal(results_summary_cached(summary.bytes, summary.n, scenario.bytes,
                                                    scenario.n, &out, NULL),
                             BF_OK);
            json_t *root = parse(&out), *fresh = parse(&wanted);
            assert_true(json_is_true(json_object_get(root, "cached")));
            assert_int_equal(json_object_del(root, "cached"), 0);
            assert_true(json_equal(root, fresh));
            json_decref(root);
            json_decref(fresh);
        }
        buffer_fini(&summary);
        summary = i > 0 ? out : wanted;
        if (i > 0)
            buffer_fini(&wanted);
        buffer_fini(&scenario);
    }
    buffer_fini(&summary);
}

static void what_is_no_summary_is_not_made_a_cached_one(void **unused)
{
    bf_buffer out = { 0 };

    assert_int_equal(buffer_printf(&out, "before"), BF_OK);
    assert_int_equal(results_summary_cached("{\"steps\":1}", 11, "{}", 2, &out, NULL), BF_ECORRUPT);
    assert_int_equal(results_summary_cached("", 0, "{}", 2, &out, NULL), BF_ECORRUPT);
    memory_plan_fault(1, 1);
    bf_status status =
        results_summary_cached("{\"a\":1,\"scenario\":{}}", 21,
                               "{\"a longer one, for which there is no room\":1}", 46, &out, NULL);
    memory_plan_fault(0, 0);
    assert_int_equal(status, BF_ENOMEM);
    assert_string_equal(out.bytes, "before");
    buffer_fini(&out);
}

static void no_memory_leaves_what_was_there(void **unused)
{
    bf_buffer scenario = document_resolve("{" DOCUMENT_NEEDED "}");
    bf_status status = BF_ENOMEM;

    for (size_t n = 1; status != BF_OK; n++) {
        bf_buffer out = { 0 };
        assert_int_equal(buffer_printf(&out, "before"), BF_OK);
        memory_plan_fault(n, 0);
        status = results_summary(RUN_MACRO, scenario.bytes, scenario.n, &begin, &end, &figures,
                                 &timing, &out, NULL);
        memory_plan_fault(0, 0);
        assert_true(status == BF_OK || status == BF_ENOMEM);
        assert_true(status == BF_OK ? out.n > 6 : out.n == 6);
        assert_memory_equal(out.bytes, "before", 6);
        assert_true(n < 2000);
        buffer_fini(&out);
    }
    buffer_fini(&scenario);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_summary_has_the_figures_of_the_run),
        cmocka_unit_test(a_summary_warns),
        cmocka_unit_test(a_summary_says_whether_the_model_was_compared_for_such_a_scenario),
        cmocka_unit_test(parts_of_feeds_count_in_a_summary),
        cmocka_unit_test(a_microscopic_summary_counts_parts),
        cmocka_unit_test(a_microscopic_summary_warns_of_soft_parts_only),
        cmocka_unit_test(a_damaged_scenario_gives_no_summary),
        cmocka_unit_test(a_cached_summary_differs_in_its_scenario_alone),
        cmocka_unit_test(what_is_no_summary_is_not_made_a_cached_one),
        cmocka_unit_test(no_memory_leaves_what_was_there),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
