// Request ids and traceparent (W3C Trace Context).

#include "server/http/trace.h"
#include "tests/unit/helper_cmocka.h"

#include <string.h>

#define TRACE  "0af7651916cd43dd8448eb211c80319c"
#define SPAN   "b7ad6b7169203331"
#define PARENT "00-" TRACE "-" SPAN "-01"

static void a_sane_id_is_kept(void **state)
{
    char longest[HTTP_TRACE_ID_SIZE];

    memset(longest, 'x', sizeof longest - 1);
    longest[sizeof longest - 1] = '\0';
    assert_string_equal(http_trace_read("a-1._B:/+=@~", NULL).id, "a-1._B:/+=@~");
    assert_string_equal(http_trace_read(longest, NULL).id, longest);
}

static void any_other_id_is_replaced_by_one_of_its_own(void **state)
{
    char too_long[HTTP_TRACE_ID_SIZE + 1];
    const char *const ids[] = { NULL, "", "a b", "a\"b", "a,b", "\xc3\xa4", "<a>", too_long };
    char before[HTTP_TRACE_ID_SIZE] = "";

    memset(too_long, 'x', sizeof too_long - 1);
    too_long[sizeof too_long - 1] = '\0';
    for (size_t i = 0; i < sizeof ids / sizeof *ids; i++) {
        http_trace trace = http_trace_read(ids[i], NULL);
        assert_int_equal(strlen(trace.id), 36);
        assert_string_not_equal(trace.id, before);
        memcpy(before, trace.id, sizeof before);
    }
}

static void a_trace_goes_on_with_a_span_of_its_own(void **state)
{
    http_trace trace = http_trace_read(NULL, PARENT);

    assert_int_equal(strlen(trace.parent), HTTP_TRACE_PARENT_SIZE - 1);
    assert_memory_equal(trace.parent, "00-" TRACE "-", 36);
    assert_memory_not_equal(trace.parent + 36, SPAN, 16);
    assert_string_equal(trace.parent + 52, "-01");
    // What later versions add is not known here.
    trace = http_trace_read(NULL, "cc-" TRACE "-" SPAN "-00-more");
    assert_memory_equal(trace.parent, "00-" TRACE "-", 36);
    assert_string_equal(trace.parent + 52, "-00");
}

static void what_is_no_trace_is_none(void **state)
{
    static const char *const parents[] = {
        "",
        "00",
        "00-" TRACE "-" SPAN,
        "00-" TRACE "-" SPAN "-1",
        PARENT "-more",
        PARENT "1",
        "ff-" TRACE "-" SPAN "-01",
        "0x-" TRACE "-" SPAN "-01",
        "00-00000000000000000000000000000000-" SPAN "-01",
        "00-" TRACE "-0000000000000000-01",
        "00-0AF7651916CD43DD8448EB211C80319C-" SPAN "-01",
        "00_" TRACE "-" SPAN "-01",
        "00-" TRACE "_" SPAN "-01",
        "00-" TRACE "-" SPAN "_01",
        "00-" TRACE "-" SPAN "-0g",
        "cc-" TRACE "-" SPAN "-01more",
    };

    assert_string_equal(http_trace_read(NULL, NULL).parent, "");
    for (size_t i = 0; i < sizeof parents / sizeof *parents; i++)
        assert_string_equal(http_trace_read(NULL, parents[i]).parent, "");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_sane_id_is_kept),
        cmocka_unit_test(any_other_id_is_replaced_by_one_of_its_own),
        cmocka_unit_test(a_trace_goes_on_with_a_span_of_its_own),
        cmocka_unit_test(what_is_no_trace_is_none),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
