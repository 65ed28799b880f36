// Documents of studies: what is read, what is refused and where, and the scenarios of trials.

#include "api/study/study_document.h"

#include "api/study/study_best.h"
#include "core/base/memory.h"
#include "tests/unit/api/helper_document.h"
#include "tests/unit/helper_cmocka.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define SCENARIO_WITH(more)                                                                        \
    "{" DOCUMENT_NEEDED more                                                                       \
    ", 'substream': 3, 'obstacles': [{'end_m': [0.75, 0.5], 'angle_deg': 60, "                     \
    "'length_m': 0.5}], 'counters': [{'id': 'a', 'x_m': [0, 0.7]}, {'id': 'b', 'x_m': [0, "        \
    "0.5]}], "                                                                                     \
    "'macro': {'cell_m': 0.02, 'mollifier_per_m2': 10000}}"
#define SCENARIO   SCENARIO_WITH("")
#define ANGLE      "{'pointer': '/obstacles/0/angle_deg', 'range': [30, 90]}"
#define THROUGHPUT "{'figure': 'throughput_per_h', 'goal': 'maximize'}"
#define WITH(base, parameters, objectives, method, rest)                                           \
    "{'base': {'scenario': " SCENARIO base "}, 'parameters': [" parameters                         \
    "], 'objectives': [" objectives "], 'method': {" method "}" rest "}"
// The same with a feed by chance.
#define FED(base, parameters, objectives, method, rest)                                            \
    "{'base': {'scenario': " SCENARIO_WITH(                                                        \
        ", 'feeds': [{'edge': 'west', 'arrivals': 'poisson', 'rate_per_s': 2}]") base              \
        "}, 'parameters': [" parameters "], 'objectives': [" objectives "], 'method': {" method    \
        "}" rest "}"

static bf_faults faults;

static bf_status read_text(const char *text, study_document *ret_document)
{
    bf_buffer document = document_quote(text);

    faults.n = 0;
    bf_status status = study_document_read(document.bytes, document.n, ret_document, &faults, NULL);
    buffer_fini(&document);
    return status;
}

static study_document read_good(const char *text)
{
    study_document d;

    const bf_status status = read_text(text, &d);
    if (status != BF_OK)
        fail_msg("%s: %s", faults.items[0].pointer, faults.items[0].text);
    return d;
}

static void a_document_is_read_with_its_defaults(void **state)
{
    study_document d = read_good(WITH("", ANGLE, THROUGHPUT, "'type': 'sobol'", ""));
    const study_definition def = study_document_definition(&d);
    assert_int_equal(def.method, STUDY_SOBOL);
    assert_int_equal(def.d, 1);
    assert_int_equal(def.n_values, 2); // and residence_s.mean, which decides between equal points
    assert_int_equal(d.objectives[1].figure, FIGURE_RESIDENCE_MEAN);
    assert_true(def.is_maximized && !def.is_second_maximized && !def.has_chance);
    assert_true(def.confidence == 0.95 && isnan(def.indifference));
    assert_int_equal(def.n_points, 32);
    assert_int_equal(def.n_replications, 1);
    assert_int_equal(def.n_trials_max, 32);
    assert_int_equal(d.model, RUN_MACRO);
    study_document_fini(&d);
    study_document_fini(NULL);
}

static void members_are_taken_over(void **state)
{
    study_document d = read_good(FED(
        ", 'model': 'micro'",
        ANGLE ", {'pointer': '/macro/mollifier_per_m2', 'range': [1000, 10000], 'scale': 'log'}",
        "{'figure': 'content.mean', 'of': 'b'}, {'figure': 'jam.count'}",
        "'type': 'screen', 'sweep': 'lhs', 'points': 50, 'confirm': 4, 'indifference': 2, "
        "'confidence': 0.9",
        ", 'name': 'N', 'seed': 9, 'limits': {'trials': 300, 'workers': 2}"));
    const study_definition def = study_document_definition(&d);
    char name[STUDY_DOCUMENT_COLUMN];
    assert_int_equal(def.method, STUDY_SCREEN);
    assert_int_equal(def.sweep, STUDY_LHS);
    assert_int_equal(def.n_points, 50);
    assert_int_equal(def.n_confirmed, 4);
    assert_int_equal(def.n_replications, 10);
    assert_int_equal(def.n_trials_max, 300);
    assert_true(def.confidence == 0.9 && def.indifference == 2.0 && def.seed == 9);
    assert_true(!def.is_maximized && def.has_chance);
    assert_int_equal(d.n_objectives, 2);
    assert_int_equal(d.objectives[0].item, 1);
    assert_int_equal(d.workers, 2);
    study_document_column(&d, 0, name);
    assert_string_equal(name, "content.mean:b");
    study_document_column(&d, 1, name);
    assert_string_equal(name, "jam.count");
    study_document_fini(&d);
}

// In the middle of a logarithmic range lies the geometric mean.
static void coordinates_are_values_of_ranges_and_lists(void **state)
{
    study_document d =
        read_good(WITH("", "{'pointer': '/obstacles/0/angle_deg', 'values': [30, 45, 80]}",
                       THROUGHPUT, "'type': 'list'", ""));
    assert_int_equal(study_document_definition(&d).n_points, 3);
    assert_true(study_document_value(&d.parameters[0], 0.0) == 30.0);
    assert_true(study_document_value(&d.parameters[0], 0.5) == 45.0);
    assert_true(study_document_value(&d.parameters[0], 1.0) == 80.0);
    study_document_fini(&d);
    const study_document_parameter by_ratio = { .range = { 1000, 4000 }, .is_log = true };
    const study_document_parameter linear = { .range = { 1000, 4000 } };
    assert_true(fabs(study_document_value(&by_ratio, 0.5) - 2000.0) < 1e-9);
    assert_true(study_document_value(&by_ratio, 1.0) == 4000.0);
    assert_true(study_document_value(&linear, 0.5) == 2500.0);
}

static void a_trial_has_the_numbers_of_its_point_and_the_substream(void **state)
{
    study_document d =
        read_good(WITH("", ANGLE ", {'pointer': '/macro/mollifier_per_m2', 'range': [1000, 9000]}",
                       THROUGHPUT, "'type': 'cmaes'", ""));
    scene s;
    for (uint32_t k = 0; k < 2; k++) {
        // 30 + k 60 degrees: the path begins 0.5 m away from (0.75, 0.5).
        const double point[2] = { k, 0.25 };
        faults.n = 0;
        assert_int_equal(study_document_scene(&d, point, 5 + k, RUN_MACRO, &s, &faults, NULL),
                         BF_OK);
        const vec2 start = s.obstacles[0].path[0];
        assert_true(fabs(start.x - (0.75 - 0.5 * (k == 0 ? sqrt(0.75) : 0.0))) < 1e-12);
        assert_true(s.macro.mollifier == 3000.0);
        assert_int_equal(s.substream, 3 + 5 + k);
        scene_fini(&s);
    }
    study_document_fini(&d);
}

static void numbers_that_a_scenario_cannot_have_are_faults_of_the_trial(void **state)
{
    study_document d = read_good(WITH("", "{'pointer': '/macro/cell_m', 'range': [-1, 0.02]}",
                                      THROUGHPUT, "'type': 'grid'", ""));
    const double point = 0.0;
    scene s;
    bf_error err;
    faults.n = 0;
    assert_int_equal(study_document_scene(&d, &point, 0, RUN_MACRO, &s, &faults, &err), BF_EINPUT);
    assert_string_equal(err.pointer, "/macro/cell_m");
    study_document_fini(&d);
}

// Documents, each with the place that must be reported.
static const struct {
    const char *text, *pointer;
} cases[] = {
    { WITH("", "{'pointer': '/obstacles/1/angle_deg', 'range': [1, 2]}", THROUGHPUT,
           "'type': 'lhs'", ""),
      "/parameters/0/pointer" },
    { WITH("", "{'pointer': '/obstacles/0x/angle_deg', 'range': [1, 2]}", THROUGHPUT,
           "'type': 'lhs'", ""),
      "/parameters/0/pointer" },
    { WITH("", "{'pointer': 'duration_s', 'range': [1, 2]}", THROUGHPUT, "'type': 'lhs'", ""),
      "/parameters/0/pointer" },
    { WITH("", "{'pointer': '/counters/0/id', 'range': [1, 2]}", THROUGHPUT, "'type': 'lhs'", ""),
      "/parameters/0/pointer" },
    { WITH("", "{'pointer': '/macro', 'range': [1, 2]}", THROUGHPUT, "'type': 'lhs'", ""),
      "/parameters/0/pointer" },
    { WITH("", "{'pointer': '/substream', 'range': [1, 2]}", THROUGHPUT, "'type': 'lhs'", ""),
      "/parameters/0/pointer" },
    { WITH("", ANGLE ", " ANGLE, THROUGHPUT, "'type': 'lhs'", ""), "/parameters/1/pointer" },
    { WITH("", "{'pointer': '/duration_s', 'range': [2, 1]}", THROUGHPUT, "'type': 'lhs'", ""),
      "/parameters/0" },
    { WITH("", "{'pointer': '/duration_s', 'range': [1, 1]}", THROUGHPUT, "'type': 'lhs'", ""),
      "/parameters/0" },
    { WITH("", "{'pointer': '/duration_s', 'range': [0, 1], 'scale': 'log'}", THROUGHPUT,
           "'type': 'lhs'", ""),
      "/parameters/0" },
    { WITH("", "{'pointer': '/duration_s', 'values': [1]}", THROUGHPUT, "'type': 'direct'", ""),
      "/parameters/0" },
    { WITH("", ANGLE, THROUGHPUT, "'type': 'list'", ""), "/parameters/0" },
    { WITH("",
           "{'pointer': '/duration_s', 'values': [1, 2]}, {'pointer': '/macro/cell_m', "
           "'values': [0.1]}",
           THROUGHPUT, "'type': 'list'", ""),
      "/parameters/1" },
    { WITH("", ANGLE, "{'figure': 'queue_end_m'}", "'type': 'lhs'", ""), "/objectives/0/figure" },
    { WITH(", 'model': 'micro'", ANGLE, "{'figure': 'queue_end_m'}",
           "'type': 'screen', 'indifference': 1", ""),
      "/objectives/0/figure" },
    { WITH("", ANGLE, THROUGHPUT, "'type': 'cmaes'", ", 'limits': {'trials': 3}"),
      "/limits/trials" },
    { WITH("", ANGLE, THROUGHPUT, "'type': 'grid', 'confidence': 1", ""), "/method/confidence" },
    { WITH("", ANGLE, THROUGHPUT, "'type': 'grid', 'indifference': 0", ""),
      "/method/indifference" },
    { WITH("", ANGLE, "{'figure': 'speed'}", "'type': 'lhs'", ""), "/objectives/0/figure" },
    { WITH("", ANGLE, "{'figure': 'offered'}", "'type': 'lhs'", ""), "/objectives/0/figure" },
    { WITH("", ANGLE, "{'figure': 'content.mean'}", "'type': 'lhs'", ""), "/objectives/0/of" },
    { WITH("", ANGLE, "{'figure': 'content.mean', 'of': 'c'}", "'type': 'lhs'", ""),
      "/objectives/0/of" },
    { WITH("", ANGLE, "{'figure': 'throughput_per_h', 'of': 'a'}", "'type': 'lhs'", ""),
      "/objectives/0/of" },
    { WITH("", ANGLE, "", "'type': 'lhs'", ""), "/objectives" },
    { WITH("", ANGLE, THROUGHPUT, "'type': 'calibrate'", ""), "/objectives" },
    { WITH("", ANGLE, "", "'type': 'calibrate'", ""), "/curves" },
    { WITH("", ANGLE, "", "'type': 'calibrate'",
           ", 'curves': [{'counter': 'c', 't_s': [0, 1], 'count': [1, 0]}]"),
      "/curves/0" },
    { FED("", ANGLE, "", "'type': 'calibrate'",
          ", 'curves': [{'counter': 'feed-1.waiting', 't_s': [0, 1], 'count': [1, 0]}]"),
      "/curves/0" },
    { WITH("", ANGLE, "", "'type': 'calibrate'",
           ", 'curves': [{'counter': 'a', 't_s': [0, 0], 'count': [1, 0]}]"),
      "/curves/0" },
    { WITH("", ANGLE, "", "'type': 'calibrate'",
           ", 'curves': [{'counter': 'a', 't_s': [0, 1], 'count': [1, 0, 0]}]"),
      "/curves/0" },
    { WITH("", ANGLE, THROUGHPUT, "'type': 'lhs', 'points': 1000000000", ""), "/method/points" },
    { WITH("", ANGLE, THROUGHPUT, "'type': 'cmaes'", ", 'limits': {'trials': 1000000000}"),
      "/limits/trials" },
    { WITH("", "{'pointer': '/duration_s', 'range': [1, 2], 'steps': 1000000000}", THROUGHPUT,
           "'type': 'grid'", ""),
      "/parameters/0/steps" },
    { WITH("", ANGLE, THROUGHPUT, "'type': 'grid'", ", 'limits': {'trials': 4}"),
      "/limits/trials" },
    { WITH("", ANGLE, "", "'type': 'calibrate', 'points': 9",
           ", 'curves': [{'counter': 'a', 't_s': [0, 1], 'count': [1, 0]}], 'limits': {'trials': "
           "8}"),
      "/limits/trials" },
    { WITH("", ANGLE, THROUGHPUT, "'type': 'screen', 'indifference': 1", ", 'replications': 1"),
      "/replications" },
    { WITH("", ANGLE, THROUGHPUT, "'type': 'grid', 'points': 3", ""), "/method/points" },
    { WITH("", ANGLE, THROUGHPUT, "'type': 'anneal'", ""), "/method/type" },
    { WITH("", ANGLE, THROUGHPUT, "'type': 'screen'", ""), "/method/indifference" },
    { WITH("", ANGLE, THROUGHPUT, "'type': 'screen', 'indifference': 0", ""),
      "/method/indifference" },
    { WITH("", ANGLE, THROUGHPUT, "'type': 'cmaes', 'tolerance': 0", ""), "/method/tolerance" },
    { WITH("", ANGLE, THROUGHPUT, "'type': 'screen', 'indifference': 1, 'confidence': 1", ""),
      "/method/confidence" },
    { WITH("", ANGLE, THROUGHPUT, "'type': 'lhs'", ", 'limits': {'workers': 1000}"),
      "/limits/workers" },
    { WITH("", "", THROUGHPUT, "'type': 'lhs'", ""), "/parameters" },
    { "{'base': {'base': {'scenario': " SCENARIO "}}, 'parameters': [" ANGLE
      "], 'objectives': [" THROUGHPUT "], 'method': {'type': 'lhs'}}",
      "/base/base" },
    { "{'base': {'scenario': {'duration_s': 1}}, 'parameters': [{'pointer': '/duration_s', "
      "'range': [1, 2]}], "
      "'objectives': [" THROUGHPUT "], 'method': {'type': 'lhs'}}",
      "/base/scenario/domain" },
    { WITH("",
           "{'pointer': '/duration_s', 'range': [1, 2], 'steps': 100000}, {'pointer': "
           "'/macro/cell_m', 'range': [1, 2]}",
           THROUGHPUT, "'type': 'grid'", ""),
      "/parameters" },
    { WITH("", ANGLE, THROUGHPUT, "'type': 'lhs'", ", 'replications': 0"), "/replications" },
    { WITH("", ANGLE, THROUGHPUT, "'type': 'cmaes'", ", 'limits': {'trials': 0}"),
      "/limits/trials" },
    { WITH("", "{'pointer': '/duration_s', 'range': [-1e308, 1e308]}", THROUGHPUT, "'type': 'lhs'",
           ""),
      "/parameters/0" },
    { WITH("", "{'pointer': '/duration_s', 'range': [1e-308, 1e308], 'scale': 'log'}", THROUGHPUT,
           "'type': 'lhs'", ""),
      "/parameters/0" },
    { WITH("", ANGLE, THROUGHPUT, "'type': 'lhs', 'prune': true", ", 'replications': 2"),
      "/method/prune" },
    { WITH("", ANGLE, "{'figure': 'throughput_per_h', 'demand': 'all'}", "'type': 'lhs'", ""),
      "/objectives/0/demand" },
    { WITH("", ANGLE, "{'figure': 'throughput_per_h', 'demand': 'offered'}", "'type': 'lhs'", ""),
      "/objectives/0/demand" }, // without feeds
    { FED("", ANGLE, "{'figure': 'residence_s.mean', 'demand': 'offered'}", "'type': 'lhs'", ""),
      "/objectives/0/demand" },
    { FED("", "{'pointer': '/feeds/0/rate_per_s', 'range': [1, 3]}",
          "{'figure': 'throughput_per_h', 'demand': 'offered'}", "'type': 'lhs'", ""),
      "/objectives/0/demand" },
    { WITH("", ANGLE, "{'figure': 'throughput_per_h', 'demand': 9}", "'type': 'direct'", ""),
      "/objectives/0/demand" },
    { WITH("", ANGLE, THROUGHPUT ", {'figure': 'throughput_per_h', 'demand': 9}", "'type': 'lhs'",
           ""),
      "/objectives/1/demand" },
    { WITH("", "{'pointer': '/obstacles/0/angle_deg', 'values': [45, 40]}",
           "{'figure': 'throughput_per_h', 'demand': 9}", "'type': 'list'", ""),
      "/parameters/0/values" },
    { WITH("", ANGLE, THROUGHPUT, "'type': 'lhs', 'confidence': 0", ""), "/method/confidence" },
    { WITH("", ANGLE, "{'figure': 'throughput'}", "'type': 'lhs'", ""), "/objectives/0/figure" },
    { "{}", "/base" },
    { "[]", "" },
    { "{", "" },
};

static void what_cannot_be_studied_is_refused_at_its_place(void **state)
{
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        study_document d;
        const bf_status status = read_text(cases[k].text, &d);
        if (status != BF_EINPUT && status != BF_ELIMIT)
            fail_msg("case %zu is not refused", k);
        if (!document_has_fault(&faults, cases[k].pointer))
            fail_msg("case %zu: no fault at %s, but at %s: %s", k, cases[k].pointer,
                     faults.items[0].pointer, faults.items[0].text);
    }
}

// A document with n items of a list.
static bf_status read_items(const char *before, const char *item, size_t n, const char *after)
{
    bf_buffer text = { 0 };
    study_document d;

    assert_int_equal(buffer_printf(&text, "%s", before), BF_OK);
    for (size_t k = 0; k < n; k++)
        assert_int_equal(buffer_printf(&text, "%s%s", k == 0 ? "" : ",", item), BF_OK);
    assert_int_equal(buffer_printf(&text, "%s", after), BF_OK);
    const bf_status status = read_text(text.bytes, &d);
    if (status == BF_OK)
        study_document_fini(&d);
    buffer_fini(&text);
    return status;
}

static void lists_beyond_their_limits_are_refused(void **state)
{
#define BASE "{'base': {'scenario': " SCENARIO "}, "
    static const struct {
        const char *before, *item, *after, *pointer;
        size_t most;
    } lists[] = {
        { BASE "'parameters': [" ANGLE "], 'method': {'type': 'lhs'}, 'objectives': [", THROUGHPUT,
          "]}", "/objectives", STUDY_VALUES },
        { BASE "'parameters': [" ANGLE "], 'method': {'type': 'calibrate'}, 'curves': [",
          "{'counter': 'a', 't_s': [0, 1], 'count': [1, 1]}", "]}", "/curves",
          STUDY_DOCUMENT_CURVES },
        { BASE "'method': {'type': 'grid'}, 'objectives': [" THROUGHPUT
               "], 'parameters': [{'pointer': '/duration_s', 'values': [",
          "1", "]}]}", "/parameters/0/values", STUDY_DOCUMENT_VALUES },
    };
#undef BASE
    for (size_t k = 0; k < sizeof lists / sizeof *lists; k++) {
        assert_int_equal(read_items(lists[k].before, lists[k].item, lists[k].most, lists[k].after),
                         BF_OK);
        assert_int_not_equal(
            read_items(lists[k].before, lists[k].item, lists[k].most + 1, lists[k].after), BF_OK);
        assert_true(document_has_fault(&faults, lists[k].pointer));
    }
    assert_int_not_equal(read_items("{'parameters': [", ANGLE, STUDY_PARAMETERS + 1, "]}"), BF_OK);
    assert_true(document_has_fault(&faults, "/parameters"));
}

// One curve of 1 part more than computed until 1 s, where it ends: its mean square is 1. What left is as computed. Objectives are
// key figures.
static void values_are_key_figures_or_distances_of_curves(void **state)
{
    static const double t[] = { 0, 1, 2 }, columns[] = { 9, 4, 0, 9, 3, 1, 9, 0, 4 };
    const double point = 0.5;
    study_document d =
        read_good(WITH("", ANGLE, "", "'type': 'calibrate'",
                       ", 'curves': [{'counter': 'b', 't_s': [0, 0.5, 1], 'count': [5, 4.5, 4]}, "
                       "{'counter': 'left_domain', 't_s': [0, 1, 2], 'count': [0, 1, 4]}]"));
    study_document_outcome outcome = { .n = 3, .t = t, .n_columns = 3, .columns = columns };
    double values[STUDY_VALUES];
    assert_int_equal(study_document_values(&d, &outcome, values, NULL), BF_OK);
    assert_true(fabs(values[0] - 1.0) < 1e-14);
    assert_true(values[1] == 0.0);
    assert_true(study_document_definition(&d).n_independent == 40.0); // 20 of each curve
    study_document_fini(&d);

    d = read_good(
        WITH("", ANGLE, THROUGHPUT ", {'figure': 'content.max', 'of': 'b'}", "'type': 'lhs'", ""));
    scene s;
    faults.n = 0;
    assert_int_equal(study_document_scene(&d, &point, 0, RUN_MACRO, &s, &faults, NULL), BF_OK);
    double *figures = memory_alloc(figure_values(&s), sizeof *figures);
    for (size_t k = 0; k < figure_values(&s); k++)
        figures[k] = (double)k;
    outcome = (study_document_outcome){ .scene = &s, .figures = figures };
    assert_int_equal(study_document_values(&d, &outcome, values, NULL), BF_OK);
    assert_true(values[0] == (double)FIGURE_THROUGHPUT);
    assert_true(values[1] == (double)figure_at(&s, FIGURE_CONTENT_MAX, 1));
    memory_free(figures);
    scene_fini(&s);
    study_document_fini(&d);
}

// Two replications of 1 and 3 with a jam in one of them: mean 2, deviation sqrt(2), t(0.975; 1) = 12.7062, hence 2 -+
// 12.7062; Wilson's interval of 1 of 2 is 1/2 -+ 0.4055 by hand: z^2 = 3.8415, z/(2 + z^2) sqrt(1/2 + z^2/4).
static void the_best_point_is_told_with_its_intervals(void **state)
{
    study_document d =
        read_good(FED(", 'model': 'micro'", ANGLE, THROUGHPUT ", {'figure': 'jam.count'}",
                      "'type': 'sobol', 'points': 1", ", 'replications': 2, 'name': 'N'"));
    const study_definition def = study_document_definition(&d);
    study *s = NULL;
    bf_buffer out = { 0 };
    assert_int_equal(study_create(&def, &s, NULL), BF_OK);
    assert_int_equal(study_best_write(&d, s, &out, NULL), BF_OK);
    assert_non_null(strstr(out.bytes, "\"best\":null"));
    out.n = 0;
    assert_int_equal(study_advance(s, NULL), BF_OK);
    study_tell(s, 1, (const double[]){ 3, 2 });
    study_tell(s, 0, (const double[]){ 1, 0 });
    assert_int_equal(study_advance(s, NULL), BF_OK);
    assert_int_equal(study_best_write(&d, s, &out, NULL), BF_OK);
    assert_non_null(strstr(out.bytes, "\"is_ended\":true,\"trials\":2,\"points\":1"));
    assert_non_null(
        strstr(out.bytes, "\"throughput_per_h\":{\"n\":2,\"mean\":2,\"deviation\":1.41421356237"));
    assert_non_null(strstr(out.bytes, "\"interval_95\":[-10.7062"));
    assert_non_null(strstr(out.bytes, "\"jam_probability\":{\"mean\":0.5,\"interval_95\":[0.0945"));
    buffer_fini(&out);
    study_destroy(s);
    study_document_fini(&d);
}

static study *begin_study(study_document *d)
{
    const study_definition def = study_document_definition(d);
    study *s = NULL;

    assert_int_equal(study_create(&def, &s, NULL), BF_OK);
    assert_int_equal(study_advance(s, NULL), BF_OK);
    return s;
}

static void assert_says(study_document *d, const study *s, const char *const *texts)
{
    bf_buffer out = { 0 };

    assert_int_equal(study_best_write(d, s, &out, NULL), BF_OK);
    for (; *texts != NULL; texts++)
        if (strstr(out.bytes, *texts) == NULL)
            fail_msg("%s is not in %s", *texts, out.bytes);
    buffer_fini(&out);
}

// The macroscopic model has no chance in it: 3 replications are one run. 2 parts/s are 7200 parts/h; at 45, 54 and 63 degrees all of them
// get through; 63 is slowest, of 45 and 54 the first is taken by residence.
static void a_deterministic_study_is_solved_once_and_names_what_is_equal(void **state)
{
    static const double throughputs[] = { 6000.0, 7199.9, 7200.0, 7200.0, 6500.0 },
                        residences[] = { 9.0, 3.5, 3.8, 6.1, 8.0 };
    study_document d = read_good(FED("",
                                     "{'pointer': '/obstacles/0/angle_deg', 'range': [36, 72], "
                                     "'steps': 5}",
                                     THROUGHPUT, "'type': 'grid'", ", 'replications': 3"));
    study *s = begin_study(&d);
    assert_int_equal(study_trials(s), 5);
    for (size_t k = 0; k < 5; k++)
        study_tell(s, k, (const double[]){ throughputs[k], residences[k] });
    assert_int_equal(study_advance(s, NULL), BF_OK);
    static const char *const texts[] = { "\"best\":{\"point\":1,",
                                         "\"throughput_per_h\":{\"n\":1,\"mean\":7199.9},",
                                         "\"has_chance\":false,\"set\":[{\"point\":1,",
                                         "{\"kind\":\"equal\",\"text\":\"Equally good in "
                                         "throughput_per_h: angle_deg 45 to 63. Less than 36 "
                                         "parts/h counts as equal. Of them this one was chosen by "
                                         "residence_s.mean, then as the middle.\"",
                                         "{\"kind\":\"everything_through\",\"text\":\"Everything "
                                         "that is offered, 7,200 parts/h, gets "
                                         "through at angle_deg 45 to 63.\"",
                                         "{\"kind\":\"no_chance\",",
                                         NULL };
    assert_says(&d, s, texts);
    study_destroy(s);
    study_document_fini(&d);
}

// 99 % of 7200 parts/h are 7128.
static void a_demand_says_where_it_is_met_or_what_is_nearest(void **state)
{
    static const double throughputs[] = { 6000.0, 7100.0, 7200.0, 7150.0, 6500.0 };
    static const char *const met[] = {
        "\"best\":{\"point\":2,", "\"demand\":7128,\"is_met\":true,",
        "{\"kind\":\"demand_met\",\"text\":\"The least is angle_deg 54, with 7,200 parts/h. "
        "Demanded is "
        "throughput_per_h of at least 7,128 parts/h, 99 % of what is offered. It is met at "
        "angle_deg "
        "54, 63.\"",
        NULL
    };
    static const char *const not_met[] = {
        "\"set\":[],\"demand\":9000,\"is_met\":false,",
        "{\"kind\":\"demand_not_met\",\"text\":\"None of angle_deg 36 to 72 meets the demand; the "
        "nearest is "
        "angle_deg 54, with 7,200 parts/h. Demanded is throughput_per_h of at least 9,000 parts/h. "
        "Vary ",
        NULL
    };
    const char *const demands[] = { "'offered'", "9000" };
    for (size_t k = 0; k < 2; k++) {
        char text[2000];
        snprintf(text, sizeof text,
                 FED("", "{'pointer': '/obstacles/0/angle_deg', 'range': [36, 72], 'steps': 5}",
                     "{'figure': 'throughput_per_h', 'demand': %s}", "'type': 'grid'", ""),
                 demands[k]);
        study_document d = read_good(text);
        study *s = begin_study(&d);
        for (size_t point = 0; point < 5; point++)
            study_tell(s, point, (const double[]){ throughputs[point], 3.0 });
        assert_int_equal(study_advance(s, NULL), BF_OK);
        assert_says(&d, s, k == 0 ? met : not_met);
        study_destroy(s);
        study_document_fini(&d);
    }
}

// 99 % of 7,200 parts/h are 7,128. Two runs each of 7,100 and 7,200 have a mean that is enough, but t(0.975; 1) = 12.706 times 50 leaves
// it open: nothing says that it gets through.
static void a_demand_that_chance_leaves_open_is_not_told_as_met(void **state)
{
    study_document d = read_good(FED(", 'model': 'micro'",
                                     "{'pointer': '/obstacles/0/angle_deg', 'values': [36, 54]}",
                                     "{'figure': 'throughput_per_h', 'demand': 'offered'}",
                                     "'type': 'grid'", ", 'replications': 2"));
    study *s = begin_study(&d);
    static const double throughputs[] = { 5000.0, 5100.0, 7100.0, 7200.0 };
    static const char *const texts[] = {
        "\"is_met\":false,",
        "{\"kind\":\"demand_not_met\",\"text\":\"None of "
        "angle_deg 36, 54 is sure to meet the demand; the nearest is "
        "angle_deg 54, with 7,150 ± 635 parts/h. ",
        "\"advice\":\"6 more runs of each may decide it.\"", NULL
    };
    bf_buffer out = { 0 };
    assert_int_equal(study_trials(s), 4);
    for (size_t k = 0; k < 4; k++)
        study_tell(s, k, (const double[]){ throughputs[k], 3.0 });
    assert_int_equal(study_advance(s, NULL), BF_OK);
    assert_says(&d, s, texts);
    assert_int_equal(study_best_write(&d, s, &out, NULL), BF_OK);
    assert_null(strstr(out.bytes, "everything_through"));
    buffer_fini(&out);
    study_destroy(s);
    study_document_fini(&d);
}

// Three angles, of which two are confirmed.
static study_document read_screening(void)
{
    return read_good(
        FED("", "{'pointer': '/obstacles/0/angle_deg', 'range': [60, 80], 'steps': 3}", THROUGHPUT,
            "'type': 'screen', 'sweep': 'grid', 'confirm': 2, 'indifference': 50", ""));
}

// Two points that differ by 1 with a spread of 1 that both have: a screening of 50 is decided after its first round, and more
// runs are no advice.
static void a_screening_that_is_decided_asks_for_no_more_runs(void **state)
{
    study_document d = read_screening();
    study *s = begin_study(&d);
    bf_buffer out = { 0 };
    for (size_t k = 0; k < 3; k++)
        study_tell(s, k, (const double[]){ 1100.0 - (double)k, 3.0 });
    assert_int_equal(study_advance(s, NULL), BF_OK);
    for (size_t k = 3; k < study_trials(s); k++) {
        const double value = study_trial_at(s, k).point == 3 ? 1000.0 : 1001.0;
        study_tell(s, k, (const double[]){ value + (double)(k % 2), 3.0 });
    }
    assert_int_equal(study_advance(s, NULL), BF_OK);
    assert_true(study_is_decided(s));
    assert_int_equal(study_best_write(&d, s, &out, NULL), BF_OK);
    assert_non_null(
        strstr(out.bytes, "\"text\":\"Equally good in throughput_per_h: angle_deg 60, 70."));
    assert_null(strstr(out.bytes, "would halve"));
    buffer_fini(&out);
    study_destroy(s);
    study_document_fini(&d);
}

// More parts take longer at 54 degrees; 72 is worse in both.
static void two_objectives_leave_a_front(void **state)
{
    static const double throughputs[] = { 6000.0, 7000.0, 5000.0 },
                        residences[] = { 3.0, 4.0, 5.0 };
    study_document d =
        read_good(FED("", "{'pointer': '/obstacles/0/angle_deg', 'range': [36, 72], 'steps': 3}",
                      THROUGHPUT ", {'figure': 'residence_s.mean'}", "'type': 'grid'", ""));
    study *s = begin_study(&d);
    for (size_t k = 0; k < 3; k++)
        study_tell(s, k, (const double[]){ throughputs[k], residences[k] });
    assert_int_equal(study_advance(s, NULL), BF_OK);
    static const char *const texts[] = {
        "{\"kind\":\"front\",\"text\":\"What is gained in throughput_per_h is lost in "
        "residence_s.mean between angle_deg 36, 54; ",
        "\"front\":[{\"point\":0,", "}},{\"point\":1,", NULL
    };
    assert_says(&d, s, texts);
    study_destroy(s);
    study_document_fini(&d);
}

static void a_best_point_at_the_edge_is_told(void **state)
{
    study_document d =
        read_good(WITH("", "{'pointer': '/obstacles/0/angle_deg', 'range': [40, 80]}", THROUGHPUT,
                       "'type': 'grid'", ""));
    study *s = begin_study(&d);
    for (size_t k = 0; k < 5; k++)
        study_tell(s, k, (const double[]){ 1000.0 - 100.0 * (double)k, 3.0 });
    assert_int_equal(study_advance(s, NULL), BF_OK);
    static const char *const texts[] = { "{\"kind\":\"alone\",\"text\":\"No other of the 5 points "
                                         "is as good. Less than 5 parts/h counts as "
                                         "equal.\"",
                                         "{\"kind\":\"edge\",\"text\":\"The best point is at the "
                                         "edge of the range, angle_deg 40. Try 20 to "
                                         "50.\"",
                                         NULL };
    assert_says(&d, s, texts);
    study_destroy(s);
    study_document_fini(&d);
}

// 2 parts/s are 7,200 parts/h, and all get through at 40 degrees: no angle is better, but in the time that parts take.
static void beyond_a_range_nothing_is_better_where_everything_gets_through(void **state)
{
    static const char *const objectives[] = { THROUGHPUT,
                                              THROUGHPUT ", {'figure': 'residence_s.mean'}" };
    for (size_t k = 0; k < 2; k++) {
        char text[2000];
        snprintf(text, sizeof text,
                 FED("", "{'pointer': '/obstacles/0/angle_deg', 'range': [40, 80], 'steps': 5}",
                     "%s", "'type': 'grid'", ""),
                 objectives[k]);
        study_document d = read_good(text);
        study *s = begin_study(&d);
        bf_buffer out = { 0 };
        for (size_t point = 0; point < 5; point++)
            study_tell(s, point, (const double[]){ 7200.0, 3.0 + (double)point });
        assert_int_equal(study_advance(s, NULL), BF_OK);
        assert_int_equal(study_best_write(&d, s, &out, NULL), BF_OK);
        assert_non_null(strstr(out.bytes, "\"best\":{\"point\":0,"));
        assert_non_null(strstr(out.bytes, "\"kind\":\"everything_through\""));
        assert_int_equal(strstr(out.bytes, "\"kind\":\"edge\"") != NULL, k == 1);
        buffer_fini(&out);
        study_destroy(s);
        study_document_fini(&d);
    }
}

// 0.2 less two steps of 0.1 is 0 but for rounding, which is no number to try where all are positive.
static void a_range_to_try_stays_positive(void **state)
{
    static const char *const texts[] = { "\"advice\":\"Try 0.1 to 0.3.\"", NULL };
    study_document d = read_good(FED("", "{'pointer': '/feeds/0/rate_per_s', 'range': [0.2, 0.6]}",
                                     THROUGHPUT, "'type': 'grid'", ""));
    study *s = begin_study(&d);
    for (size_t k = 0; k < 5; k++)
        study_tell(s, k, (const double[]){ 1000.0 - 100.0 * (double)k, 3.0 });
    assert_int_equal(study_advance(s, NULL), BF_OK);
    assert_says(&d, s, texts);
    study_destroy(s);
    study_document_fini(&d);
}

static void one_run_each_says_nothing_of_chance(void **state)
{
    study_document d =
        read_good(FED(", 'model': 'micro'", ANGLE, THROUGHPUT, "'type': 'grid'", ""));
    study *s = begin_study(&d);
    for (size_t k = 0; k < 5; k++)
        study_tell(s, k, (const double[]){ 1000.0 - 100.0 * (double)k, 3.0 });
    assert_int_equal(study_advance(s, NULL), BF_OK);
    static const char *const texts[] = { "\"has_chance\":true,\"set\":null",
                                         "{\"kind\":\"one_run_each\",", NULL };
    assert_says(&d, s, texts);
    study_destroy(s);
    study_document_fini(&d);
}

// Nothing is less than no jam at all; and a figure that no trial says has no best point.
static void objectives_without_anything_to_tell_apart_say_so(void **state)
{
    static const char *const texts[][3] = {
        { "\"text\":\"Equally good in jam.count: angle_deg ",
          "Nothing but the same value counts as equal.", NULL },
        { "\"best\":null,", "\"text\":\"No trial has a value of jam.count, so no point is best.\"",
          NULL },
    };
    const double values[] = { 0.0, (double)NAN };
    for (size_t k = 0; k < 2; k++) {
        study_document d =
            read_good(FED("", ANGLE, "{'figure': 'jam.count'}", "'type': 'grid'", ""));
        study *s = begin_study(&d);
        bf_buffer out = { 0 };
        for (size_t trial = 0; trial < study_trials(s); trial++)
            study_tell(s, trial, (const double[]){ values[k], 3.0 + (double)trial });
        assert_int_equal(study_advance(s, NULL), BF_OK);
        assert_says(&d, s, texts[k]);
        assert_int_equal(study_best_write(&d, s, &out, NULL), BF_OK);
        assert_null(strstr(out.bytes, "\"kind\":\"edge\""));
        buffer_fini(&out);
        study_destroy(s);
        study_document_fini(&d);
    }
}

// 10 runs of 2 points; the models differ by 10 % and 0 %.
static void a_screening_says_what_was_compared(void **state)
{
    study_document d = read_screening();
    study *s = begin_study(&d);
    for (size_t k = 0; k < 3; k++)
        study_tell(s, k, (const double[]){ 1100.0 - 50.0 * (double)k, 3.0 });
    assert_int_equal(study_advance(s, NULL), BF_OK);
    static const char *const first[] = { "\"best\":{\"point\":0,", "\"kind\":\"unconfirmed\"",
                                         NULL };
    assert_says(&d, s, first);
    for (size_t k = 3; k < study_trials(s); k++)
        study_tell(s, k,
                   (const double[]){ study_trial_at(s, k).point == 3 ? 1000.0 + (double)(k % 2)
                                                                     : 1050.0 + (double)(k % 2),
                                     3.0 });
    assert_int_equal(study_advance(s, NULL), BF_OK);
    static const char *const second[] = {
        "{\"kind\":\"confirmed\",\"text\":\"The microscopic model compared angle_deg 60, 70 with "
        "each "
        "other, by 10 runs each. The macroscopic model says -0.0 % to +9.9 % of their values.\"",
        "\"is_dropped\":true,\"is_in_set\":", NULL
    };
    assert_says(&d, s, second);
    study_destroy(s);
    study_document_fini(&d);
}

static void without_memory_no_document_is_read(void **state)
{
    bf_buffer document = document_quote(
        WITH("", "{'pointer': '/duration_s', 'values': [1, 2]}", THROUGHPUT, "'type': 'grid'", ""));
    bf_status status = BF_ENOMEM;
    for (size_t n = 1; status != BF_OK; n++) {
        study_document d;
        faults.n = 0;
        memory_plan_fault(n, 0);
        status = study_document_read(document.bytes, document.n, &d, &faults, NULL);
        const size_t n_failed = memory_faults();
        memory_plan_fault(0, 0);
        if (status == BF_OK)
            study_document_fini(&d);
        else
            assert_int_equal(status, BF_ENOMEM);
        assert_true(status != BF_OK || n_failed <= 1);
    }
    buffer_fini(&document);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_document_is_read_with_its_defaults),
        cmocka_unit_test(members_are_taken_over),
        cmocka_unit_test(coordinates_are_values_of_ranges_and_lists),
        cmocka_unit_test(a_trial_has_the_numbers_of_its_point_and_the_substream),
        cmocka_unit_test(numbers_that_a_scenario_cannot_have_are_faults_of_the_trial),
        cmocka_unit_test(what_cannot_be_studied_is_refused_at_its_place),
        cmocka_unit_test(lists_beyond_their_limits_are_refused),
        cmocka_unit_test(values_are_key_figures_or_distances_of_curves),
        cmocka_unit_test(the_best_point_is_told_with_its_intervals),
        cmocka_unit_test(a_deterministic_study_is_solved_once_and_names_what_is_equal),
        cmocka_unit_test(a_demand_says_where_it_is_met_or_what_is_nearest),
        cmocka_unit_test(a_demand_that_chance_leaves_open_is_not_told_as_met),
        cmocka_unit_test(a_screening_that_is_decided_asks_for_no_more_runs),
        cmocka_unit_test(two_objectives_leave_a_front),
        cmocka_unit_test(a_best_point_at_the_edge_is_told),
        cmocka_unit_test(beyond_a_range_nothing_is_better_where_everything_gets_through),
        cmocka_unit_test(a_range_to_try_stays_positive),
        cmocka_unit_test(one_run_each_says_nothing_of_chance),
        cmocka_unit_test(objectives_without_anything_to_tell_apart_say_so),
        cmocka_unit_test(a_screening_says_what_was_compared),
        cmocka_unit_test(without_memory_no_document_is_read),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
