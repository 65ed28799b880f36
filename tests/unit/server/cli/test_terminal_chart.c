// Unit tests of charts as text. Expected lines follow from the geometry given in each comment.

#include "server/cli/terminal_chart.h"

#include "core/base/memory.h"
#include "tests/unit/helper_cmocka.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { LINES_MAX = 128 };

static const double two_times[] = { 0.0, 10.0 };
static const double rising[] = { 0.0, 10.0 };
static const double zeros[] = { 0.0, 0.0 };
static const terminal_chart_curve line_curve = { "line", 2, two_times, rising };

static terminal_chart_options plain_options(void)
{
    return (terminal_chart_options){
        .width = 60, .height = 11, .x_title = "t [s]", .y_title = "parts"
    };
}

// Draw into *out and cut it into lines. Returns how many.
static size_t draw_lines(const terminal_chart_options *options, const terminal_chart_curve *curves,
                         size_t n, bf_buffer *out, char **ret_lines)
{
    size_t n_lines = 0;

    assert_int_equal(terminal_chart_draw(options, curves, n, out, NULL), BF_OK);
    for (char *line = strtok(out->bytes, "\n"); line != NULL; line = strtok(NULL, "\n"))
        ret_lines[n_lines++] = line;
    return n_lines;
}

// Title, 11 rows, axis, labels, legend. Both axes run from 0 to 10: the curve starts in the first
// column of the lowest row and ends in the last column of the highest.
static void a_line_goes_from_corner_to_corner(void **state)
{
    terminal_chart_options options = plain_options();
    bf_buffer out = { 0 };
    char *lines[LINES_MAX];

    assert_int_equal(draw_lines(&options, &line_curve, 1, &out, lines), 15);
    assert_string_equal(lines[0], "parts");
    assert_int_equal(strncmp(lines[1], "10 +", 4), 0);
    assert_int_equal(strlen(lines[1]), 60);
    assert_int_equal(lines[1][59], '*');
    assert_int_equal(strncmp(lines[11], " 0 +*", 5), 0);
    assert_int_equal(strncmp(lines[12], "   +", 4), 0);
    assert_non_null(strstr(lines[13], "t [s]"));
    assert_string_equal(lines[14], "    ****** line");
    buffer_fini(&out);
}

static void without_unicode_every_byte_is_ascii_and_no_line_is_too_wide(void **state)
{
    terminal_chart_options options = plain_options();
    const terminal_chart_curve curve = { "r\xc3\xa4nder", 2, two_times, rising };
    bf_buffer out = { 0 };
    char *lines[LINES_MAX];

    size_t n = draw_lines(&options, &curve, 1, &out, lines);
    for (size_t i = 0; i < n; i++) {
        assert_true(strlen(lines[i]) <= options.width);
        for (const char *byte = lines[i]; *byte != '\0'; byte++)
            assert_true(*byte >= 0x20 && *byte < 0x7f);
    }
    assert_non_null(strstr(lines[n - 1], "r??nder"));
    buffer_fini(&out);
}

// A curve along y = 0 lights the lowest dots of each braille cell, dots 7 and 8: U+28C0.
static void with_unicode_a_cell_holds_two_by_four_dots(void **state)
{
    terminal_chart_options options = plain_options();
    const terminal_chart_curve curves[] = { { "zero", 2, two_times, zeros } };
    const double high[] = { 5.0 };
    const terminal_chart_curve both[] = { curves[0], { "dot", 1, two_times, high } };
    bf_buffer out = { 0 };
    char *lines[LINES_MAX];

    options.is_unicode = true;
    draw_lines(&options, both, 2, &out, lines);
    const char *lowest = strstr(lines[11], "┤");
    assert_non_null(lowest);
    lowest += strlen("┤");
    // 60 columns without the label "0", a blank and the axis.
    for (int i = 0; i < 57; i++)
        assert_memory_equal(lowest + (size_t)i * 3, "\xe2\xa3\x80", 3);
    assert_int_equal(strlen(lowest), 57 * 3);
    buffer_fini(&out);
}

static void colors_begin_and_end_within_a_line(void **state)
{
    terminal_chart_options options = plain_options();
    bf_buffer out = { 0 };
    char *lines[LINES_MAX];

    options.is_unicode = options.has_colors = true;
    size_t n = draw_lines(&options, &line_curve, 1, &out, lines);
    for (size_t i = 0; i < n; i++) {
        const char *on = strstr(lines[i], "\x1b[36m");
        const char *last = strrchr(lines[i], '\x1b');
        assert_true(last == NULL || strncmp(last, "\x1b[0m", 4) == 0);
        assert_int_equal(on != NULL, (i >= 1 && i <= 11) || i == n - 1);
    }
    buffer_fini(&out);
}

// Without colours two curves must not look the same: the second is dashed, so shows fewer cells.
static void curves_differ_without_colors(void **state)
{
    terminal_chart_options options = plain_options();
    const terminal_chart_curve curves[] = { line_curve, { "zero", 2, two_times, zeros } };
    bf_buffer out = { 0 };
    char *lines[LINES_MAX];

    size_t n = draw_lines(&options, curves, 2, &out, lines);
    assert_string_equal(lines[n - 2], "    ****** line");
    assert_string_equal(lines[n - 1], "    ++++++ zero");
    buffer_fini(&out);
    options.is_unicode = true;
    n = draw_lines(&options, curves, 2, &out, lines);
    assert_int_not_equal(strncmp(lines[n - 2], lines[n - 1], 4 + 6 * 3), 0);
    buffer_fini(&out);
}

// The curve is at 0 up to t = 4 and from t = 6 on; the hole between is empty on the lowest row.
static void a_point_that_is_no_number_leaves_a_gap(void **state)
{
    terminal_chart_options options = plain_options();
    const double t[] = { 0.0, 4.0, 5.0, 6.0, 10.0 };
    const double y[] = { 0.0, 0.0, NAN, 0.0, 0.0 };
    const terminal_chart_curve curve = { "gap", 5, t, y };
    bf_buffer out = { 0 };
    char *lines[LINES_MAX];

    draw_lines(&options, &curve, 1, &out, lines);
    const char *row = NULL;
    for (size_t i = 1; i <= 11; i++)
        row = strchr(lines[i], '*') == NULL ? row : lines[i];
    assert_non_null(row);
    size_t n = strlen(row);
    size_t at = n - (n - 4) / 2; // the middle of the plot
    assert_int_equal(row[at], ' ');
    assert_int_equal(row[n - 1], '*');
    buffer_fini(&out);
}

static void a_label_cannot_command_the_terminal(void **state)
{
    terminal_chart_options options = plain_options();
    // ESC, DEL, the C1 control CSI as UTF-8, a lone continuation byte, and one valid character.
    const terminal_chart_curve curve = { "a\x1b[2Jb\x7f\xc2\x9b"
                                         "c\x80\xc3\xa4",
                                         2, two_times, rising };
    bf_buffer out = { 0 };
    char *lines[LINES_MAX];

    options.is_unicode = true;
    size_t n = draw_lines(&options, &curve, 1, &out, lines);
    assert_non_null(strstr(lines[n - 1], "a?[2Jb???c?\xc3\xa4"));
    assert_null(strchr(lines[n - 1], '\x1b'));
    buffer_fini(&out);
}

static void a_long_label_is_cut(void **state)
{
    terminal_chart_options options = plain_options();
    char label[200];
    const terminal_chart_curve curve = { label, 2, two_times, rising };
    bf_buffer out = { 0 };
    char *lines[LINES_MAX];

    memset(label, 'x', sizeof label - 1);
    label[sizeof label - 1] = '\0';
    size_t n = draw_lines(&options, &curve, 1, &out, lines);
    assert_int_equal(strlen(lines[n - 1]), 60);
    buffer_fini(&out);
}

static void any_size_is_taken_into_its_bounds(void **state)
{
    static const size_t sizes[] = { 0, 1, 39, 401, SIZE_MAX };
    bf_buffer out = { 0 };

    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
        terminal_chart_options options = plain_options();
        options.width = options.height = sizes[i];
        assert_int_equal(terminal_chart_draw(&options, &line_curve, 1, &out, NULL), BF_OK);
    }
    buffer_fini(&out);
}

static void what_cannot_be_drawn_is_refused_and_nothing_written(void **state)
{
    terminal_chart_options options = plain_options();
    const double none[] = { NAN, INFINITY }, huge[] = { 0.0, 1e301 };
    const terminal_chart_curve empty = { "empty", 0, NULL, NULL };
    const terminal_chart_curve gaps = { "gaps", 2, two_times, none };
    const terminal_chart_curve large = { "large", 2, two_times, huge };
    terminal_chart_curve many[TERMINAL_CHART_CURVES_MAX + 1];
    bf_buffer out = { 0 };
    bf_error err = { 0 };

    assert_int_equal(terminal_chart_draw(&options, &empty, 1, &out, &err), BF_EINPUT);
    assert_int_equal(terminal_chart_draw(&options, &gaps, 1, &out, &err), BF_EINPUT);
    assert_int_equal(terminal_chart_draw(&options, &large, 1, &out, &err), BF_EINPUT);
    for (size_t i = 0; i < sizeof many / sizeof *many; i++)
        many[i] = line_curve;
    assert_int_equal(terminal_chart_draw(&options, many, sizeof many / sizeof *many, &out, &err),
                     BF_ELIMIT);
    assert_int_equal(err.code, BF_ELIMIT);
    assert_int_equal(out.n, 0);
    assert_null(out.bytes);
}

static void without_memory_nothing_is_written(void **state)
{
    terminal_chart_options options = plain_options();
    bf_buffer out = { 0 };
    bf_status status = BF_ENOMEM;

    for (size_t n = 1; status != BF_OK; n++) {
        memory_plan_fault(n, 0);
        status = terminal_chart_draw(&options, &line_curve, 1, &out, NULL);
        assert_true(status == BF_OK || (status == BF_ENOMEM && out.n == 0));
    }
    memory_plan_fault(0, 0);
    buffer_fini(&out);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_line_goes_from_corner_to_corner),
        cmocka_unit_test(without_unicode_every_byte_is_ascii_and_no_line_is_too_wide),
        cmocka_unit_test(with_unicode_a_cell_holds_two_by_four_dots),
        cmocka_unit_test(colors_begin_and_end_within_a_line),
        cmocka_unit_test(curves_differ_without_colors),
        cmocka_unit_test(a_point_that_is_no_number_leaves_a_gap),
        cmocka_unit_test(a_label_cannot_command_the_terminal),
        cmocka_unit_test(a_long_label_is_cut),
        cmocka_unit_test(any_size_is_taken_into_its_bounds),
        cmocka_unit_test(what_cannot_be_drawn_is_refused_and_nothing_written),
        cmocka_unit_test(without_memory_nothing_is_written),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
