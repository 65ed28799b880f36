// Conditions on numbers of documents: how they are read, and where they hold.

#include "api/scenario/condition.h"
#include "tests/unit/helper_cmocka.h"

#include <stdbool.h>
#include <stdio.h>
#include <string.h>

static const char scenario[] =
    "{\"duration_s\":60,\"cargo\":{\"mass_kg\":0.35,\"shape\":{\"type\":\"can\"}},"
    "\"belts\":[{\"velocity_m_s\":[0.3,0.4]},{\"velocity_m_s\":[-1,0],\"incline_deg\":5}],"
    "\"obstacles\":[{\"path_m\":[[1,0],[2,1]]},{\"path_m\":[[0,1],[1,0],[2,0]]},"
    "{\"path_m\":[[0,0],[0,1]],\"motion\":{}},{\"end_m\":[1,1],\"angle_deg\":75}],"
    "\"micro\":{\"step_s\":\"auto\"}}";
static const char figures[] = "{\"throughput_per_h\":1200,\"residence_s\":{\"p95\":4.5}}";

static bool hold(const char *text)
{
    const char *const documents[] = { scenario, figures };
    const size_t lengths[] = { strlen(scenario), strlen(figures) };
    api_conditions conditions;
    bf_error err;
    bool ret = false;

    if (condition_list_read(text, &conditions, &err) != BF_OK)
        fail_msg("%s: %s", text, err.text);
    assert_int_equal(condition_list_hold(&conditions, documents, lengths, 2, &ret, NULL), BF_OK);
    return ret;
}

static void each_relation_has_its_border(void **state)
{
    assert_true(hold("duration_s=60"));
    assert_true(hold("duration_s<=60"));
    assert_true(hold("duration_s>=60"));
    assert_false(hold("duration_s<60"));
    assert_false(hold("duration_s>60"));
    assert_true(hold("duration_s<60.001"));
    assert_true(hold("duration_s>59.999"));
    assert_false(hold("duration_s>=60.001"));
    assert_false(hold("duration_s<=59.999"));
}

// Equal means six digits, whichever is the larger one.
static void what_was_computed_equals_what_is_typed(void **state)
{
    static const char *const equal[] = { "0.3500003", "0.3499997" };

    for (size_t i = 0; i < 2; i++) {
        const char *const text[] = { "=", "<=", ">=", "<", ">" };
        for (size_t k = 0; k < 5; k++) {
            char condition[32];
            snprintf(condition, sizeof condition, "mass_kg%s%s", text[k], equal[i]);
            assert_int_equal(hold(condition), k < 3);
        }
    }
    assert_false(hold("mass_kg=0.350001"));
    assert_false(hold("mass_kg>=0.350001"));
    assert_true(hold("mass_kg<0.350001"));
}

static void a_name_is_the_end_of_a_pointer_in_whole_names(void **state)
{
    assert_true(hold("cargo/mass_kg<1"));
    assert_true(hold("/cargo/mass_kg<1"));
    assert_false(hold("/mass_kg<1"));
    assert_false(hold("kg<1"));
    assert_true(hold("velocity_m_s/0<0"));
    assert_false(hold("belts/0/velocity_m_s/0<0"));
    assert_true(hold("residence_s/p95>4"));
    assert_false(hold("step_s>0")); // a word is no number
}

// The plate of two points has 45 degrees, that of three has none, nor has one that moves (90); the fourth says 75.
static void angles_of_plates_are_found_however_they_are_written(void **state)
{
    assert_true(hold("angle_deg=45"));
    assert_true(hold("obstacles/0/angle_deg=45"));
    assert_true(hold("angle_deg=75"));
    assert_false(hold("angle_deg<45"));
    assert_false(hold("angle_deg>75"));
}

static void the_speed_of_a_belt_is_the_size_of_its_velocity(void **state)
{
    assert_true(hold("belts/0/speed_m_s=0.5"));
    assert_true(hold("speed_m_s=1"));
    assert_false(hold("speed_m_s>1"));
}

static void all_conditions_must_hold_in_any_of_the_documents(void **state)
{
    assert_true(hold("angle_deg>50, throughput_per_h >= 1000 ,incline_deg=5,speed_m_s<0.6"));
    assert_false(hold("angle_deg>50,throughput_per_h>1200"));
    assert_false(hold("angle_deg>80,throughput_per_h>1000"));
}

static void what_is_no_document_has_no_numbers(void **state)
{
    static const char *const texts[] = { "", "{\"duration_s\":" };
    const size_t lengths[] = { 0, strlen(texts[1]) };
    api_conditions conditions;
    bool holds = true;

    assert_int_equal(condition_list_read("duration_s>=0", &conditions, NULL), BF_OK);
    assert_int_equal(condition_list_hold(&conditions, texts, lengths, 2, &holds, NULL), BF_OK);
    assert_false(holds);
}

static void a_fault_says_which_condition(void **state)
{
    static const struct {
        const char *text, *fault;
    } cases[] = {
        { "", "condition 1 must be a name, <, <=, =, >= or >, and a number, not ''" },
        { "a>1,=3", "condition 2 must be a name, <, <=, =, >= or >, and a number, not '=3'" },
        { "a", "condition 1 must be a name, <, <=, =, >= or >, and a number, not 'a'" },
        { "a,b>1", "condition 1 must be a name, <, <=, =, >= or >, and a number, not 'a'" },
        { "a>", "condition 1 ends in '', which is no number" },
        { "a>,b>1", "condition 1 ends in '', which is no number" },
        { "a==1", "condition 1 ends in '=1', which is no number" },
        { "a<nan", "condition 1 ends in 'nan', which is no number" },
        { "a>1,b>2,c>3,d>4,e>5", "there are more than 4 conditions" },
        { "a234567890123456789012345678901234567890123456789012345678901234>1",
          "the name in condition 1 has more than 63 bytes" },
    };
    api_conditions conditions = { .n = 3 };
    bf_error err;

    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        assert_int_equal(condition_list_read(cases[i].text, &conditions, &err), BF_EINPUT);
        assert_string_equal(err.text, cases[i].fault);
        assert_int_equal(conditions.n, 3);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_relation_has_its_border),
        cmocka_unit_test(what_was_computed_equals_what_is_typed),
        cmocka_unit_test(a_name_is_the_end_of_a_pointer_in_whole_names),
        cmocka_unit_test(angles_of_plates_are_found_however_they_are_written),
        cmocka_unit_test(the_speed_of_a_belt_is_the_size_of_its_velocity),
        cmocka_unit_test(all_conditions_must_hold_in_any_of_the_documents),
        cmocka_unit_test(what_is_no_document_has_no_numbers),
        cmocka_unit_test(a_fault_says_which_condition),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
