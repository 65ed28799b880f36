// Unit tests of the text of the progress bar.

#include "server/cli/progress_bar.h"
#include "tests/unit/helper_cmocka.h"

#include <string.h>

static const char *write_bar(uint64_t step, uint64_t first_step, double elapsed_s)
{
    static char text[PROGRESS_BAR_SIZE];
    frame_progress p = { .step = step, .n_steps = 400, .t = (double)step / 100.0 };

    progress_bar_text(&p, first_step, elapsed_s, text);
    return text;
}

// 100 of 400 steps in 2 s: a quarter of 30 cells is 7, 50 steps/s, 300 steps are left for 6 s.
static void a_quarter_of_the_way_shows_a_quarter_of_the_bar(void **state)
{
    assert_string_equal(write_bar(100, 0, 2.0),
                        "[#######.......................]  25 %  t = 1 s  50 steps/s  6 s left");
}

// 100 steps of this attempt in 2 s, whatever was made before it.
static void a_resumed_run_counts_its_own_steps_only(void **state)
{
    assert_non_null(strstr(write_bar(300, 200, 2.0), "50 steps/s  2 s left"));
}

static void the_ends_divide_by_nothing(void **state)
{
    frame_progress none = { .n_steps = 0 };
    char text[PROGRESS_BAR_SIZE];

    assert_string_equal(write_bar(0, 0, 0.0), "[..............................]   0 %  t = 0 s");
    assert_non_null(strstr(write_bar(400, 0, 1.0), "[##############################] 100 %"));
    progress_bar_text(&none, 0, 0.0, text);
    assert_non_null(strstr(text, "100 %"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_quarter_of_the_way_shows_a_quarter_of_the_bar),
        cmocka_unit_test(a_resumed_run_counts_its_own_steps_only),
        cmocka_unit_test(the_ends_divide_by_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
