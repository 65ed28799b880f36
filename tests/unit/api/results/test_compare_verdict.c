// What two runs are to each other, in sentences.

#include "api/results/compare_verdict.h"

#include "core/base/memory.h"
#include "tests/unit/api/helper_document.h"
#include "tests/unit/helper_cmocka.h"

#include <math.h>
#include <string.h>

static verdicts all;

static const verdict *say(const compare_side *a, const compare_side *b)
{
    all = (verdicts){ 0 };
    compare_verdict_find(a, b, &all);
    assert_int_equal(all.n, 1);
    return &all.items[0];
}

static compare_side run_of(run_model model, uint64_t line, double throughput, double error)
{
    return (compare_side){ .is_run = true,
                           .model = model,
                           .is_compared = true,
                           .offered_per_h = 1010.0,
                           .arrived = 1.0,
                           .has_chance = model == RUN_MICRO,
                           .line = line,
                           .throughput_per_h = throughput,
                           .error_per_h = error,
                           .needs_s = (double)NAN };
}

// 6 % of the microscopic model's value are 60; an interval of 100 is more.
static void models_of_one_line_agree_or_not(void **unused)
{
    compare_side macro = run_of(RUN_MACRO, 1, 1059.0, (double)NAN);
    compare_side micro = run_of(RUN_MICRO, 1, 1000.0, 10.0);

    assert_string_equal(say(&macro, &micro)->kind, "models_agree");
    macro.throughput_per_h = 1090.0;
    const verdict *v = say(&micro, &macro);
    assert_string_equal(v->kind, "models_disagree");
    assert_non_null(strstr(v->text, "1,090 against 1,000 ± 10 parts/h"));
    assert_non_null(strstr(v->text, "+9.0 %"));
    assert_null(strstr(v->text, "chance"));
    assert_string_equal(v->advice, "Trust the microscopic model.");
    micro.is_compared = false;
    assert_non_null(strstr(say(&micro, &macro)->advice, "counts"));
    micro.error_per_h = 100.0;
    assert_string_equal(say(&micro, &macro)->kind, "models_agree");
    macro.line = 2;
    assert_string_equal(say(&micro, &macro)->kind, "equal");
    macro.line = 1;
    micro.error_per_h = (double)NAN;
    assert_non_null(strstr(say(&micro, &macro)->text, "How much of that is chance is not known."));
}

// In a run with feeds a counter holds what enters and leaves; counts since the start only rise.
static void what_is_inside_is_no_outflow_where_cargo_enters(void **unused)
{
    const compare_side heap = run_of(RUN_MACRO, 1, 1000.0, (double)NAN), counted = { 0 };
    compare_side fed = heap;

    fed.is_fed = true;
    assert_true(compare_verdict_is_content(&fed, "upstream"));
    assert_true(compare_verdict_is_content(&fed, NULL));
    assert_false(compare_verdict_is_content(&fed, "left_domain"));
    assert_false(compare_verdict_is_content(&heap, "upstream"));
    assert_false(compare_verdict_is_content(&counted, "upstream"));
}

// The density has the mean of what arrives. Of 1,093 parts for 1,000, 6 % and 9.3 % of 1,093 are 167. It does not matter where the
// density lets only half of what is offered through.
static void models_agree_where_more_parts_than_the_mean_arrived(void **unused)
{
    const compare_side macro = run_of(RUN_MACRO, 1, 1000.0, (double)NAN);
    compare_side micro = run_of(RUN_MICRO, 1, 1093.0, (double)NAN), full = macro;

    full.offered_per_h = 2000.0;
    assert_string_equal(say(&macro, &micro)->kind, "models_disagree");
    micro.arrived = 1.093;
    const verdict *v = say(&macro, &micro);
    assert_string_equal(v->kind, "models_agree");
    assert_non_null(strstr(v->text, "By chance 9.3 % more parts arrived"));
    assert_string_equal(say(&full, &micro)->kind, "models_disagree");
    micro.arrived = 0.9;
    micro.throughput_per_h = 1200.0;
    assert_string_equal(say(&macro, &micro)->kind, "models_disagree");
    assert_non_null(strstr(say(&macro, &micro)->text, "10.0 % fewer parts arrived"));
}

// The interval of the difference: sqrt(30^2 + 40^2) = 50.
static void a_difference_is_held_against_chance(void **unused)
{
    compare_side a = run_of(RUN_MICRO, 1, 1000.0, 30.0), b = run_of(RUN_MICRO, 2, 1049.0, 40.0);

    const verdict *v = say(&a, &b);
    assert_string_equal(v->kind, "equal");
    assert_non_null(strstr(v->text, "leaves open, 50 parts/h"));
    assert_non_null(strstr(v->advice, "halve"));
    b.throughput_per_h = 1051.0;
    v = say(&a, &b);
    assert_string_equal(v->kind, "more");
    assert_non_null(strstr(v->text, "5.1 % more throughput than the reference"));
    b.throughput_per_h = 949.0;
    assert_string_equal(say(&a, &b)->kind, "less");
    b.throughput_per_h = 1000.0;
    assert_string_equal(say(&a, &b)->kind, "same");
    b.throughput_per_h = 1049.0;
    b.error_per_h = (double)NAN;
    b.needs_s = 900.0;
    v = say(&a, &b);
    assert_string_equal(v->kind, "uncertain");
    assert_non_null(strstr(v->advice, "900 s"));
    b.has_chance = a.has_chance = false;
    assert_string_equal(say(&a, &b)->kind, "more");
    a.throughput_per_h = (double)NAN;
    assert_string_equal(say(&a, &b)->kind, "no_throughput");
}

#define SUMMARY(model, macro, figures)                                                             \
    "{'model': '" model "', 'verdicts': [{'kind': 'belt_fills'}], 'key_figures': {" figures        \
    "'feeds': [], 'counters': [{'id': 'c', 'flow_per_h': 7}]}, 'scenario': {" DOCUMENT_NEEDED      \
    ", 'macro': {" macro "}}}"

// Models that both let nothing through do not agree on anything.
static void there_is_nothing_to_compare_where_nothing_comes_through(void **unused)
{
    compare_side macro = run_of(RUN_MACRO, 1, 0.0, (double)NAN);
    const compare_side micro = run_of(RUN_MICRO, 1, 0.0, 0.0);

    assert_string_equal(say(&macro, &micro)->kind, "no_throughput");
    macro.throughput_per_h = 10.0;
    assert_string_equal(say(&macro, &micro)->kind, "models_disagree");
}

// Two counters and an outlet; without chance but where the throughput of a run of parts has some.
static compare_flows flows_of(double first, double second, double outlet, double error)
{
    return (compare_flows){ .n = 3,
                            .items = { { "counter", "first", first, error },
                                       { "counter", "second", second, error },
                                       { "outlet", "second", outlet, error } } };
}

// Of 1,000 parts/h by both; 6 % of a flow's larger value are allowed, and what the throughputs differ by.
static void flows_that_differ_more_than_the_throughputs_are_told(void **unused)
{
    static compare_flows of_a, of_b;
    compare_side a = run_of(RUN_MICRO, 1, 1000.0, 30.0), b = run_of(RUN_MICRO, 2, 1000.0, 30.0);

    of_a = flows_of(500.0, 500.0, 400.0, 20.0);
    of_b = flows_of(531.0, 600.0, 800.0, 20.0);
    all = (verdicts){ 0 };
    compare_verdict_flows(&a, &b, &of_a, &of_b, &all);
    assert_int_equal(all.n, 1);
    assert_string_equal(all.items[0].kind, "flows_differ");
    assert_non_null(strstr(all.items[0].text,
                           "800 ± 20 against 400 ± 20 parts/h at outlet 'second', "
                           "600 ± 20 against 500 ± 20 parts/h at counter 'second'."));
    assert_int_equal(all.items[0].n_figures, 2);
    assert_true(all.items[0].figures[0].value == 400.0);

    b.throughput_per_h = 2000.0; // half of it is what the throughputs differ by
    all = (verdicts){ 0 };
    compare_verdict_flows(&a, &b, &of_a, &of_b, &all);
    assert_int_equal(all.n, 0);

    a.throughput_per_h = b.throughput_per_h =
        0.0; // what goes through counters before a queue differs all the same
    compare_verdict_flows(&a, &b, &of_a, &of_b, &all);
    assert_int_equal(all.n, 1);
}

static void flows_within_their_intervals_or_without_any_do_not_differ(void **unused)
{
    static compare_flows of_a, of_b;
    compare_side a = run_of(RUN_MICRO, 1, 1000.0, 30.0), b = run_of(RUN_MICRO, 2, 1000.0, 30.0);

    of_a = flows_of(500.0, 500.0, 400.0, 80.0);
    of_b = flows_of(600.0, 500.0, 400.0, 80.0); // sqrt(80^2 + 80^2) = 113
    all = (verdicts){ 0 };
    compare_verdict_flows(&a, &b, &of_a, &of_b, &all);
    assert_int_equal(all.n, 0);
    of_b.items[0].error_per_h = of_a.items[0].error_per_h = (double)NAN;
    compare_verdict_flows(&a, &b, &of_a, &of_b, &all);
    assert_int_equal(all.n, 0);
    a.has_chance = b.has_chance = false;
    compare_verdict_flows(&a, &b, &of_a, &of_b, &all);
    assert_int_equal(all.n, 1);
    a.arrived = 1.2; // a fifth more than the mean arrived
    all = (verdicts){ 0 };
    compare_verdict_flows(&a, &b, &of_a, &of_b, &all);
    assert_int_equal(all.n, 0);
}

// 0.03 h: of 231 /h 7 parts were counted, and 5 of them are chance; of 1832 /h 55, and 15 are.
static void flows_without_intervals_differ_by_more_than_counts_of_parts_may(void **unused)
{
    static compare_flows of_a, of_b;
    compare_side a = run_of(RUN_MICRO, 1, 3600.0, (double)NAN),
                 b = run_of(RUN_MACRO, 2, 3600.0, (double)NAN);

    a.counted_h = b.counted_h = 0.03;
    b.has_chance = false;
    of_a = flows_of(1832.0, 0.0, 1.0, (double)NAN);
    of_b = flows_of(1577.0, 231.0, 1.0, (double)NAN);
    all = (verdicts){ 0 };
    compare_verdict_flows(&a, &b, &of_a, &of_b, &all);
    assert_int_equal(all.n, 1);
    assert_non_null(strstr(all.items[0].text, ": 231 against 0 parts/h at counter 'second'."));
    of_b.items[1].per_h = 150.0; // 4.5 parts of 4.2
    all = (verdicts){ 0 };
    compare_verdict_flows(&a, &b, &of_a, &of_b, &all);
    assert_int_equal(all.n, 1);
    of_b.items[1].per_h = 120.0; // 3.6 parts of 3.7
    all = (verdicts){ 0 };
    compare_verdict_flows(&a, &b, &of_a, &of_b, &all);
    assert_int_equal(all.n, 0);
}

static void of_many_flows_that_differ_three_are_named(void **unused)
{
    static compare_flows of_a, of_b;
    compare_side a = run_of(RUN_MACRO, 1, 1000.0, (double)NAN), b = a;

    for (int k = 0; k < 5; k++) {
        of_a.items[k] = (compare_flow){ "counter", "", 100.0, (double)NAN };
        of_b.items[k] = (compare_flow){ "counter", "", 200.0 + 100.0 * k, (double)NAN };
        of_a.items[k].id[0] = of_b.items[k].id[0] = (char)('a' + k);
    }
    of_a.n = of_b.n = 5;
    all = (verdicts){ 0 };
    compare_verdict_flows(&a, &b, &of_a, &of_b, &all);
    assert_int_equal(all.items[0].n_figures, COMPARE_FLOWS_TOLD);
    assert_string_equal(all.items[0].figures[0].of, "e");
    assert_string_equal(all.items[0].figures[2].of, "c");
    assert_non_null(strstr(all.items[0].text, "and at 2 others."));
}

static void models_are_not_compared_while_the_belt_fills(void **unused)
{
    compare_side macro = run_of(RUN_MACRO, 1, 2000.0, (double)NAN);
    compare_side micro = run_of(RUN_MICRO, 1, 1000.0, 10.0);

    macro.is_filling = true;
    const verdict *v = say(&macro, &micro);
    assert_string_equal(v->kind, "too_early");
    assert_non_null(strstr(v->text, "2,000 against 1,000 ± 10 parts/h"));
    assert_null(strstr(v->text, "not compared"));
    assert_non_null(strstr(v->advice, "warmup_s"));
    macro.is_compared = false;
    assert_non_null(strstr(say(&macro, &micro)->text, "The macroscopic one was not compared"));
    macro.throughput_per_h = 1010.0;
    assert_string_equal(say(&macro, &micro)->kind, "models_agree");
}

// What a summary has; how a line is solved does not make it another one.
static void a_side_is_read_from_a_summary(void **unused)
{
    bf_buffer text =
        document_quote(SUMMARY("micro", "'cell_m': 0.01", "'sustained_throughput_per_h': 5, "));
    bf_buffer other = document_quote(SUMMARY("macro", "'cell_m': 0.005", ""));
    static compare_flows flows;
    compare_side micro, macro;
    bf_error err;

    assert_int_equal(compare_verdict_side_of_summary(text.bytes, text.n, &micro, &flows, NULL),
                     BF_OK);
    assert_int_equal(compare_verdict_side_of_summary(other.bytes, other.n, &macro, &flows, NULL),
                     BF_OK);
    assert_true(micro.is_run && micro.model == RUN_MICRO && macro.model == RUN_MACRO);
    assert_true(micro.throughput_per_h == 5.0 && isnan(micro.error_per_h));
    assert_true(isnan(macro.throughput_per_h));
    assert_false(micro.has_chance);
    assert_true(micro.is_filling);
    assert_int_equal(flows.n, 1);
    assert_string_equal(flows.items[0].id, "c");
    assert_true(flows.items[0].per_h == 7.0);
    assert_true(micro.line == macro.line);
    assert_int_equal(compare_verdict_side_of_summary("t,upstream\n", 11, &micro, &flows, &err),
                     BF_EINPUT);
    assert_int_equal(compare_verdict_side_of_summary("{}", 2, &micro, &flows, &err), BF_EINPUT);
    buffer_fini(&text);
    buffer_fini(&other);
}

// A summary that there is no memory to read is no damaged one.
static void out_of_memory_is_said_of_a_summary_wherever_it_runs_out(void **unused)
{
    bf_buffer text = document_quote(SUMMARY("micro", "'cell_m': 0.01", ""));
    static compare_flows flows;
    size_t n_faults = 1;
    compare_side side;

    for (size_t n = 1; n_faults > 0; n++) {
        memory_plan_fault(n, 0);
        const bf_status status =
            compare_verdict_side_of_summary(text.bytes, text.n, &side, &flows, NULL);
        n_faults = memory_faults();
        memory_plan_fault(0, 0);
        assert_int_equal(status, n_faults > 0 ? BF_ENOMEM : BF_OK);
    }
    buffer_fini(&text);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(models_of_one_line_agree_or_not),
        cmocka_unit_test(what_is_inside_is_no_outflow_where_cargo_enters),
        cmocka_unit_test(models_agree_where_more_parts_than_the_mean_arrived),
        cmocka_unit_test(a_difference_is_held_against_chance),
        cmocka_unit_test(there_is_nothing_to_compare_where_nothing_comes_through),
        cmocka_unit_test(flows_that_differ_more_than_the_throughputs_are_told),
        cmocka_unit_test(flows_within_their_intervals_or_without_any_do_not_differ),
        cmocka_unit_test(flows_without_intervals_differ_by_more_than_counts_of_parts_may),
        cmocka_unit_test(of_many_flows_that_differ_three_are_named),
        cmocka_unit_test(models_are_not_compared_while_the_belt_fills),
        cmocka_unit_test(a_side_is_read_from_a_summary),
        cmocka_unit_test(out_of_memory_is_said_of_a_summary_wherever_it_runs_out),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
