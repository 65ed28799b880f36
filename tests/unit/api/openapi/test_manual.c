// The manual is made of all chapters of api/docs/, with the tables that their lines stand for.

#include "api/http/problem.h"
#include "api/openapi/openapi_priv.h"
#include "tests/unit/helper_cmocka.h"

#include <string.h>

static bf_buffer manual;

static int write_manual(void **unused)
{
    assert_int_equal(openapi__write_manual(&manual), BF_OK);
    return 0;
}

static int drop_manual(void **unused)
{
    buffer_fini(&manual);
    return 0;
}

static void every_chapter_is_a_section(void **unused)
{
    for (const openapi_text *text = openapi__texts; text->name != NULL; text++) {
        char title[200] = "\n#"; // one level lower
        if (strcmp(text->name, "samples") == 0)
            continue;
        assert_memory_equal(text->text, "# ", 2);
        strncat(title, text->text, strcspn(text->text, "\n") + 1);
        if (strstr(manual.bytes, title) == NULL)
            fail_msg("the manual lacks the chapter %s.md:%s", text->name, title);
    }
}

static void headings_are_lower_and_comments_in_code_are_not(void **unused)
{
    assert_non_null(strstr(manual.bytes, "\n### What is refused\n"));
    assert_non_null(
        strstr(manual.bytes, "\n# 1. Take a ready scenario and submit it to both models.\n"));
}

// Lines as they stood in the manual when they were written by hand.
static void tables_list_members_with_unit_range_and_default(void **unused)
{
    static const char *const lines[] = {
        "| `/duration_s` | number | s | > 0 | must be given | simulated time |\n",
        "| `/belts/n/polygon_m` | list of [x, y], 3 to 1024 | m |  | the domain | corners of a "
        "simple polygon |\n",
        "| `/cargo/n/share` | number |  | > 0 | 1 | how many parts are of the kind, in proportion "
        "to all shares |\n",
        "| `/actions/n/do/hold` | boolean |  |  | one of several | true: the feed is held, false: "
        "it is released |\n",
        "| `/model` | macro, micro |  |  | macro | which solver |\n",
        "| `/t_s` | list of numbers, 2 to 100000 | s |  | must be given | times of the samples, "
        "rising |\n",
        "| `/method/sweep` | grid, list, lhs, sobol |  |  | sobol | of screen: the points that the "
        "macroscopic model tries |\n",
    };

    for (size_t k = 0; k < sizeof lines / sizeof lines[0]; k++) {
        if (strstr(manual.bytes, lines[k]) == NULL)
            fail_msg("the manual lacks %s", lines[k]);
    }
    assert_non_null(strstr(manual.bytes, "| `can-330` |"));
}

static void every_kind_of_problem_has_a_paragraph(void **unused)
{
    size_t n;
    const problem_kind *kinds = problem_kinds(&n);

    for (size_t k = 0; k < n; k++)
        assert_non_null(strstr(manual.bytes, kinds[k].remedy));
}

static void no_line_that_stands_for_a_table_is_left(void **unused)
{
    assert_null(strstr(manual.bytes, "<!--"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_chapter_is_a_section),
        cmocka_unit_test(headings_are_lower_and_comments_in_code_are_not),
        cmocka_unit_test(tables_list_members_with_unit_range_and_default),
        cmocka_unit_test(every_kind_of_problem_has_a_paragraph),
        cmocka_unit_test(no_line_that_stands_for_a_table_is_left),
    };
    return cmocka_run_group_tests(tests, write_manual, drop_manual);
}
