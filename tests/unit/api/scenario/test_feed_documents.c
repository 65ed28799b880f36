// Feeds, photo eyes and actions in documents: CSV, names of other parts, and what is refused where.

#include "api/scenario/scenario.h"
#include "core/base/memory.h"
#include "tests/unit/api/helper_document.h"
#include "tests/unit/helper_cmocka.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define SCENE                                                                                      \
    "'duration_s': 100, 'domain': {'x_m': [0, 1], 'y_m': [0, 0.6]},"                               \
    "'cargo': [{'id': 'box'}, {'id': 'tin'}]"
#define FEED(members)    "{" SCENE ", 'feeds': [{" members "}]}"
#define WEST(members)    FEED("'edge': 'west', 'y_m': [0.1, 0.5], " members)
#define PROFILE(members) WEST("'profile': {" members "}")
#define LIST(members)    WEST("'schedule': {" members "}")
#define ACTION(when, do)                                                                           \
    "{" SCENE ", 'feeds': [{'id': 'in', 'edge': 'west', 'rate_per_s': 1, 'y_m': [0.1, 0.5]}],"     \
    "'obstacles': [{'id': 'arm', 'from_m': [0.5, 0.1], 'to_m': [0.6, 0.2]}],"                      \
    "'photo_eyes': [{'id': 'pe', 'line_m': [[0.7, 0], [0.7, 0.6]]}],"                              \
    "'actions': [{'when': {" when "}, 'do': {" do "}}]}"
#define MERGE(members)                                                                             \
    "{" SCENE ", 'initial': {'positions_m': [[0.5, 0.3]]}, 'belts': [{'id': 'a'}, {'id': 'b'}],"   \
    "'photo_eyes': [{'id': 'pa', 'line_m': [[0.7, 0], [0.7, 0.6]]},"                               \
    "{'id': 'pb', 'line_m': [[0.8, 0], [0.8, 0.6]]}], 'merges': [{" members "}]}"
#define LANE(belt, eye) "{'belt': '" belt "', 'photo_eye': '" eye "'}"
#define LANES           "'lanes': [" LANE("a", "pa") ", " LANE("b", "pb") "]"
#define CLEAR           "'photo_eye': 'pe', 'state': 'clear'"

static bf_faults faults;

static scene read_text(const char *text)
{
    bf_buffer document = document_quote(text);
    bf_error err = { 0 };
    scene s;

    faults.n = 0;
    bf_status status = scenario_read(document.bytes, document.n, &s, &faults, &err);
    buffer_fini(&document);
    if (status != BF_OK)
        fail_msg("%s: %s", err.pointer, err.text);
    return s;
}

static void a_profile_may_be_csv(void **unused)
{
    static const double times[] = { 0, 30, 60.5 }, rates[] = { 2, 0, 4 };
    static const char *const documents[] = {
        PROFILE("'csv': 't_s,rate_per_s\\n0,2\\n30,0\\n60.5,4\\n', 'repeat_s': 90"),
        PROFILE("'csv': 'rate_per_h,t_s\\r\\n7200,0\\r\\n0,30\\r\\n14400,60.5', 'repeat_s': 90"),
    };

    for (size_t k = 0; k < sizeof documents / sizeof *documents; k++) {
        scene s = read_text(documents[k]);
        const scene_series *p = &s.feeds[0].profile;
        assert_int_equal(p->n_times, 3);
        assert_int_equal(p->n_values, 3);
        assert_memory_equal(p->times, times, sizeof times);
        assert_memory_equal(p->values, rates, sizeof rates);
        assert_true(p->repeat == 90);
        scene_fini(&s);
    }
}

// 6 parts from 10 to 12 s, 4 from 12 to 16 s and, as long as those, 8 from 16 to 20 s: rates 3, 1 and 2; none before
// and after.
static void counts_are_rates_that_step(void **unused)
{
    static const double times[] = { 10, 10, 12, 12, 16, 16, 20, 20 },
                        rates[] = { 0, 3, 3, 1, 1, 2, 2, 0 };
    scene s = read_text(PROFILE("'csv': 't_s,count\\n10,6\\n12,4\\n16,8\\n'"));
    const scene_series *p = &s.feeds[0].profile;
    double sum = 0.0;

    assert_int_equal(p->n_times, 8);
    for (size_t k = 0; k < 8; k++) {
        assert_true(p->times[k] == (k % 2 == 0 ? nextafter(times[k], 0.0) : times[k]));
        assert_true(p->values[k] == rates[k]);
        if (k > 0)
            sum += 0.5 * (p->times[k] - p->times[k - 1]) * (p->values[k] + p->values[k - 1]);
    }
    assert_true(fabs(sum - 18.0) < 1e-12);
    scene_fini(&s);
}

static void a_list_of_arrivals_may_be_csv(void **unused)
{
    scene s =
        read_text(LIST("'csv': 't_s,kind,y_m,heading_deg,count\\n0,tin,0.1,,2\\n1.5,box,,90,1\\n"
                       "1.5,tin,0.4,-30,7\\n'"));
    const scene_arrival_list *l = &s.feeds[0].schedule;

    assert_int_equal(l->n, 3);
    assert_true(l->times[0] == 0.0 && l->times[2] == 1.5);
    assert_true(l->kinds[0] == 1 && l->kinds[1] == 0 && l->kinds[2] == 1);
    assert_true(l->counts[0] == 2 && l->counts[1] == 1 && l->counts[2] == 7);
    assert_true(l->places[0] == 0.0 && isnan(l->places[1]));
    assert_true(fabs(l->places[2] - 0.75) < 1e-15);
    assert_true(isnan(l->headings[0]) && l->headings[1] == M_PI / 2.0);
    scene_fini(&s);
    s = read_text(
        FEED("'line_m': [[0.5, 0.3], [0.25, 0.3]], 'schedule': {'csv': 't_s,x_m\\n0,0.5\\n1,"
             "0.375\\n'}"));
    l = &s.feeds[0].schedule;
    assert_true(l->counts == NULL && l->kinds == NULL && l->headings == NULL);
    assert_true(l->places[0] == 0.0 && l->places[1] == 0.5);
    scene_fini(&s);
}

// The resolved document has numbers: it is read without the text.
static void csv_is_resolved_to_numbers(void **unused)
{
    scene s = read_text(LIST("'csv': 't_s,kind,y_m\\n0,tin,0.1\\n2,box,0.3'"));
    bf_buffer written = { 0 };

    assert_int_equal(scenario_write(&s, &written, NULL), BF_OK);
    assert_non_null(strstr(written.bytes, "\"schedule\":{\"t_s\":[0,2],\"kind\":[\"tin\",\"box\"],"
                                          "\"place\":[0,0.49999999999999994]}"));
    assert_null(strstr(written.bytes, "csv"));
    buffer_fini(&written);
    scene_fini(&s);
}

// text, if any, must stand in the fault's text.
static const struct {
    const char *pointer, *document, *text;
} bad[] = {
    { "/initial", "{" SCENE "}", "where the cargo is" },
    { "/feeds/0", WEST("'count': 3"), "rate_per_s, profile, schedule; not 0" },
    { "/feeds/0", WEST("'rate_per_s': 1, 'schedule': {'t_s': [1]}"), "not 2" },
    { "/feeds/0", FEED("'rate_per_s': 1"), "edge or line_m" },
    { "/feeds/0/line_m", WEST("'rate_per_s': 1, 'line_m': [[0.1, 0.1], [0.1, 0.2]]"), "belong" },
    { "/feeds/0/x_m", WEST("'rate_per_s': 1, 'x_m': [0, 1]"), "does not belong to this feed" },
    { "/feeds/0/edge", FEED("'edge': 'up', 'rate_per_s': 1"), "\"west\"" },
    { "/feeds/0/line_m", FEED("'rate_per_s': 1, 'line_m': [[0.1, 0.1]]"), "2 points, not 1" },
    { "/feeds/0/line_m/1/0", FEED("'rate_per_s': 1, 'line_m': [[0.1, 0.1], ['a', 1]]"), NULL },
    { "/feeds/0/heading_deg", WEST("'rate_per_s': 1, 'heading_deg': 'any'"), "\"random\"" },
    { "/feeds/0/count", WEST("'rate_per_s': 1, 'count': 1.5"), "whole" },
    { "/feeds/0/count", WEST("'rate_per_s': 1, 'count': 0"), "at least 1" },
    { "/feeds/0/end_s", WEST("'rate_per_s': 1, 'start_s': 5, 'end_s': 5"), "after start_s" },
    { "/feeds/0/rate_per_s", WEST("'rate_per_s': -1"), "above 0" },
    { "/feeds/0/cargo/0/kind", WEST("'rate_per_s': 1, 'cargo': [{}]"), "missing" },
    { "/feeds/0/cargo/0/kind", WEST("'rate_per_s': 1, 'cargo': [{'kind': 3}]"), NULL },
    { "/feeds/0/cargo/1/kind", WEST("'rate_per_s': 1, 'cargo': [{'kind': 'tin'}, {'kind': 'can'}]"),
      "\"can\" is not the id of a kind of cargo; there are: box, tin" },
    { "/feeds/0/cargo", WEST("'rate_per_s': 1, 'cargo': []"), "at least 1" },
    { "/feeds/0/profile", PROFILE(""), "t_s, csv or measurement" },
    { "/feeds/0/profile/t_s/1", PROFILE("'t_s': [1, 0], 'rate_per_s': [1, 1]"), "do not come" },
    { "/feeds/0/profile/rate_per_s", PROFILE("'t_s': [0, 1]"), "0 items, but t_s has 2" },
    { "/feeds/0/profile/t_s", PROFILE("'t_s': [0], 'csv': 't_s,count'"), "beside csv" },
    { "/feeds/0/profile/csv", PROFILE("'csv': 5"), "string" },
    { "/feeds/0/profile/csv", PROFILE("'csv': ''"), "line 1: \"\" is not a column" },
    { "/feeds/0/profile/csv", PROFILE("'csv': 'rate_per_s\\n1'"), "t_s is missing" },
    { "/feeds/0/profile/csv", PROFILE("'csv': 't_s,t_s\\n1,1'"), "twice" },
    { "/feeds/0/profile/csv", PROFILE("'csv': 't_s\\n1'"), "exactly one of rate_per_s" },
    { "/feeds/0/profile/csv", PROFILE("'csv': 't_s,count,rate_per_s\\n1,1,1'"), "exactly one" },
    { "/feeds/0/profile/csv", PROFILE("'csv': 't_s,count\\n1,1'"), "at least 2 rows" },
    { "/feeds/0/profile/csv", PROFILE("'csv': 't_s,rate_per_s\\n'"), "no rows" },
    { "/feeds/0/profile/csv", PROFILE("'csv': 't_s,rate_per_s\\n1,2\\n1,2'"),
      "line 3: 1 s do not come after the 1 s" },
    { "/feeds/0/profile/csv", PROFILE("'csv': 't_s,rate_per_s\\n1,-2'"),
      "line 2: rate_per_s must" },
    { "/feeds/0/profile/csv", PROFILE("'csv': 't_s,rate_per_s\\n1,many'"), "number, not \"many\"" },
    { "/feeds/0/profile/csv", PROFILE("'csv': 't_s,rate_per_s\\n1'"),
      "1 fields, the header has 2" },
    { "/feeds/0/profile/csv", PROFILE("'csv': 't_s,rate_per_s\\n0,1\\n\\n1,1'"), "line 3" },
    { "/feeds/0/profile/repeat_s", PROFILE("'csv': 't_s,rate_per_s\\n9,1', 'repeat_s': 5"), "9 s" },
    { "/feeds/0/schedule", LIST("'count': [1]"), "t_s, csv or measurement" },
    { "/feeds/0/schedule/kind", LIST("'t_s': [1], 'kind': ['box', 'tin']"), "2 items" },
    { "/feeds/0/schedule/kind/0", LIST("'t_s': [1], 'kind': ['can']"), "box, tin" },
    { "/feeds/0/schedule/kind/0", LIST("'t_s': [1], 'kind': [null]"), NULL },
    { "/feeds/0/schedule/count/0", LIST("'t_s': [1], 'count': [0.5]"), "whole" },
    { "/feeds/0/schedule/place/0", LIST("'t_s': [1], 'place': [1.5]"), "from 0 to 1" },
    { "/feeds/0/schedule/t_s/1", LIST("'t_s': [1, 0.5]"), NULL },
    { "/feeds/0/schedule/kind", LIST("'kind': ['box'], 'csv': 't_s\\n1'"), "beside csv" },
    { "/feeds/0/profile/measurement", PROFILE("'measurement': 'x'"), "needs a daemon" },
    { "/feeds/0/profile/measurement", PROFILE("'measurement': 5"), "must be an id" },
    { "/feeds/0/profile/t_s", PROFILE("'t_s': [0], 'measurement': 'x'"), "beside measurement" },
    { "/feeds/0/profile/csv", PROFILE("'csv': 't_s', 'measurement': 'x'"), "beside measurement" },
    { "/feeds/0/schedule/measurement", LIST("'measurement': 'x'"), "needs a daemon" },
    { "/feeds/0/schedule/count", LIST("'count': [1], 'measurement': 'x'"), "beside measurement" },
    { "/feeds/0/schedule/csv", LIST("'csv': 't_s,colour\\n1,red'"), "\"colour\" is not a column" },
    { "/feeds/0/schedule/csv", LIST("'csv': 't_s,kind\\n1,box\\n2,can'"),
      "line 3: \"can\" is not the id" },
    { "/feeds/0/schedule/csv", LIST("'csv': 't_s,y_m\\n1,0.6'"), "line 2: y_m 0.6 lies off" },
    { "/feeds/0/schedule/csv", LIST("'csv': 't_s,x_m\\n1,0.6'"), "lies off" },
    { "/feeds/0/schedule/csv", LIST("'csv': 't_s,x_m,y_m\\n1,0,0.3'"), "one of x_m and y_m" },
    { "/feeds/0/schedule/csv", LIST("'csv': 't_s,count\\n1,2.5'"),
      "line 2: count must be a whole" },
    { "/feeds/0/schedule/csv", LIST("'csv': 't_s,count\\n1,0'"), "at least 1" },
    { "/feeds/0/schedule/csv", LIST("'csv': 't_s,heading_deg\\n1,up'"), "line 2: heading_deg" },
    { "/feeds/0/schedule/csv", LIST("'csv': 't_s\\n2\\n1'"), "line 3" },
    { "/photo_eyes/0/line_m",
      "{" SCENE ", 'initial': {'positions_m': [[0.5, 0.3]]},"
      "'photo_eyes': [{}]}",
      "is missing" },
    { "/actions/0/when/photo_eye", ACTION("'state': 'clear'", "'feed': 'in', 'hold': true"), NULL },
    { "/actions/0/when/photo_eye",
      ACTION("'photo_eye': 'px', 'state': 'clear'", "'feed': 'in', 'hold': true"),
      "\"px\" is not the id of a photo eye; there are: pe" },
    { "/actions/0/when/kind", ACTION(CLEAR ", 'kind': 'jar'", "'feed': 'in', 'hold': true"),
      "\"jar\" is not the id of a kind of cargo" },
    { "/actions/0/when/state",
      ACTION("'photo_eye': 'pe', 'state': 'open'", "'feed': 'in', 'hold': true"), "\"clear\"" },
    { "/actions/0/do", ACTION(CLEAR, ""), "factor, turn_deg, present, hold, shift_m; not 0" },
    { "/actions/0/do", ACTION(CLEAR, "'factor': 1, 'hold': true"), "not 2" },
    { "/actions/0/do/belt", ACTION(CLEAR, "'factor': 1"), "is missing" },
    { "/actions/0/do/belt", ACTION(CLEAR, "'factor': 1, 'belt': 'in'"), "there are: main" },
    { "/actions/0/do/feed", ACTION(CLEAR, "'factor': 1, 'belt': 'main', 'feed': 'in'"), "belong" },
    { "/actions/0/do/over_s", ACTION(CLEAR, "'obstacle': 'arm', 'present': true, 'over_s': 1"),
      "does not belong" },
    { "/actions/0/do/obstacle", ACTION(CLEAR, "'obstacle': 'leg', 'present': true"), "arm" },
    { "/actions/0/do/feed", ACTION(CLEAR, "'feed': 'out', 'hold': true"), "there are: in" },
    { "/merges/0/lanes", MERGE(""), "is missing" },
    { "/merges/0/lanes", MERGE("'lanes': [" LANE("a", "pa") "]"), "at least 2 items" },
    { "/merges/0/lanes/1/belt", MERGE("'lanes': [" LANE("a", "pa") ", " LANE("c", "pb") "]"),
      "\"c\" is not the id of a belt; there are: a, b" },
    { "/merges/0/lanes/0/photo_eye", MERGE("'lanes': [" LANE("a", "pc") ", " LANE("b", "pb") "]"),
      "is not the id of a photo eye" },
    { "/merges/0/order", MERGE(LANES ", 'order': 'by_turn'"), "\"in_turn\"" },
    { "/merges/0/parts", MERGE(LANES ", 'parts': 0"), "at least 1" },
    { "/merges/0/parts", MERGE(LANES ", 'parts': 1.5"), "whole number" },
    { "/merges/0/time_s", MERGE(LANES ", 'time_s': 0"), "above 0" },
    { "/merges/0/gap_s", MERGE(LANES ", 'gap_s': -1"), "at least 0" },
    { "/actions/0/do/hold", ACTION(CLEAR, "'feed': 'in', 'hold': 1"), "true or false" },
};

static void a_merge_names_its_lanes_and_keeps_its_rule(void **unused)
{
    scene s = read_text(MERGE(LANES));

    (void)unused;
    assert_int_equal(s.merges[0].n_lanes, 2);
    assert_true(s.merges[0].lanes[1].belt == 1 && s.merges[0].lanes[1].eye == 1);
    assert_true(s.merges[0].order == SCENE_MERGE_IN_TURN && s.merges[0].parts == 1);
    assert_true(s.merges[0].time == INFINITY && s.merges[0].gap == 0.0);
    scene_fini(&s);
    s = read_text(MERGE(LANES ", 'order': 'priority', 'time_s': 8, 'gap_s': 0.5"));
    assert_true(s.merges[0].order == SCENE_MERGE_PRIORITY && s.merges[0].parts == INFINITY);
    assert_true(s.merges[0].time == 8.0 && s.merges[0].gap == 0.5);
    scene_fini(&s);
    s = read_text(MERGE(LANES ", 'time_s': 8, 'parts': 5"));
    assert_true(s.merges[0].time == 8.0 && s.merges[0].parts == 5);
    scene_fini(&s);
    s = read_text(MERGE(LANES ", 'parts': 4294967295"));
    assert_true(s.merges[0].parts == 4294967295.0);
    scene_fini(&s);
}

static void what_is_wrong_is_pointed_at(void **unused)
{
    for (size_t k = 0; k < sizeof bad / sizeof *bad; k++) {
        bf_buffer document = document_quote(bad[k].document);
        bf_error err = { 0 };
        document_refuse(document.bytes, document.n, &faults, &err);
        if (strcmp(err.pointer, bad[k].pointer) != 0 ||
            (bad[k].text != NULL && strstr(err.text, bad[k].text) == NULL))
            fail_msg("%s: at \"%s\" (%s), not at \"%s\" (%s)", bad[k].document, err.pointer,
                     err.text, bad[k].pointer, bad[k].text != NULL ? bad[k].text : "");
        buffer_fini(&document);
    }
}

static void a_million_rows_are_beyond_the_limit(void **unused)
{
    bf_buffer document = document_quote("{" SCENE ", 'feeds': [{'edge': 'west', 'profile': {'csv': "
                                        "'t_s,rate_per_s");
    bf_error err;

    for (int k = 0; k < 1000000; k++)
        assert_int_equal(buffer_printf(&document, "\\n%d,1", k), BF_OK);
    assert_int_equal(buffer_printf(&document, "\"}}]}"), BF_OK);
    assert_int_equal(document_refuse(document.bytes, document.n, &faults, &err), BF_ELIMIT);
    assert_string_equal(err.pointer, "/feeds/0/profile/csv");
    assert_string_equal(err.text, "has 1000000 rows, the limit is 100000");
    buffer_fini(&document);
}

static void no_memory_for_csv_is_reported(void **unused)
{
    static const char *const documents[] = {
        PROFILE("'csv': 't_s,count\\n10,6\\n12,4'"),
        LIST("'csv': 't_s,kind,y_m,heading_deg,count\\n0,tin,0.1,,2'"),
    };

    for (size_t k = 0; k < sizeof documents / sizeof *documents; k++) {
        bf_buffer document = document_quote(documents[k]);
        bf_status status = BF_ENOMEM;
        for (size_t n = 1; status != BF_OK; n++) {
            scene s;
            faults.n = 0;
            memory_plan_fault(n, 0);
            status = scenario_read(document.bytes, document.n, &s, &faults, NULL);
            memory_plan_fault(0, 0);
            assert_true(status == BF_OK || status == BF_ENOMEM);
            if (status == BF_OK)
                scene_fini(&s);
            assert_true(n < 5000);
        }
        buffer_fini(&document);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_profile_may_be_csv),
        cmocka_unit_test(counts_are_rates_that_step),
        cmocka_unit_test(a_list_of_arrivals_may_be_csv),
        cmocka_unit_test(csv_is_resolved_to_numbers),
        cmocka_unit_test(a_merge_names_its_lanes_and_keeps_its_rule),
        cmocka_unit_test(what_is_wrong_is_pointed_at),
        cmocka_unit_test(a_million_rows_are_beyond_the_limit),
        cmocka_unit_test(no_memory_for_csv_is_reported),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
