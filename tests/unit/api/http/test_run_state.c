// The life of a run, against the diagram at the head of the header.

#include "api/json/text.h"
#include "api/run_state.h"
#include "tests/unit/helper_cmocka.h"

static void words_and_states_name_each_other(void **state)
{
    for (unsigned s = 0; s < RUN_STATE_COUNT; s++)
        assert_int_equal(
            text_find_word(run_state_words, RUN_STATE_COUNT, run_state_word((run_state)s)), s);
    assert_string_equal(run_state_word(RUN_QUEUED), "queued");
    assert_string_equal(run_state_word(RUN_CANCELLED), "cancelled");
}

static void what_is_no_word_is_no_state(void **state)
{
    static const char *const words[] = { "", "Queued", "queue", "queued ", "done" };

    for (size_t i = 0; i < sizeof words / sizeof *words; i++)
        assert_int_equal(text_find_word(run_state_words, RUN_STATE_COUNT, words[i]),
                         RUN_STATE_COUNT);
}

// One row for each state, one column for each that may follow, in the order of the enum.
static void only_the_arrows_of_the_diagram_exist(void **state)
{
    static const bool arrows[RUN_STATE_COUNT][RUN_STATE_COUNT] = {
        [RUN_QUEUED] = { [RUN_RUNNING] = true, [RUN_CANCELLED] = true, [RUN_FAILED] = true },
        [RUN_RUNNING] = { [RUN_QUEUED] = true,
                          [RUN_SUCCEEDED] = true,
                          [RUN_FAILED] = true,
                          [RUN_CANCELLED] = true },
    };

    for (unsigned from = 0; from < RUN_STATE_COUNT; from++) {
        for (unsigned to = 0; to < RUN_STATE_COUNT; to++)
            assert_int_equal(run_state_may_follow((run_state)from, (run_state)to),
                             arrows[from][to]);
    }
}

static void a_run_ends_once(void **state)
{
    assert_false(run_state_is_end(RUN_QUEUED));
    assert_false(run_state_is_end(RUN_RUNNING));
    assert_true(run_state_is_end(RUN_SUCCEEDED));
    assert_true(run_state_is_end(RUN_FAILED));
    assert_true(run_state_is_end(RUN_CANCELLED));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(words_and_states_name_each_other),
        cmocka_unit_test(what_is_no_word_is_no_state),
        cmocka_unit_test(only_the_arrows_of_the_diagram_exist),
        cmocka_unit_test(a_run_ends_once),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
