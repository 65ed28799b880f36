// All results in one file, over the API.

#include "tests/unit/api/helper_ask.h"
#include "tests/unit/api/helper_unzip.h"
#include "tests/unit/helper_cmocka.h"

#define TAG "\"" ID_1 "-1769860810000-zip\""

static helper_run *add_ended_run(void)
{
    helper_run *of = ask_add_run(RUN_SUCCEEDED);

    of->record.finished_ms = 1769860810000;
    return of;
}

// The files of the answer, made by now.
static size_t unzip_answer(unzip_file *ret_files)
{
    api_services services = helper_services(&ask_daemon);
    body_source *body = &ask_response.source;
    body_state where = BODY_MORE;

    assert_non_null(body->next_chunk);
    while (where == BODY_MORE)
        assert_int_equal(
            body->next_chunk(body->state, &services, 65536, &ask_response.body, &where, NULL),
            BF_OK);
    return unzip_all(&ask_response.body, ret_files);
}

static void the_results_of_a_run_are_one_file_that_never_changes(void **state)
{
    unzip_file files[UNZIP_FILES_MAX];

    add_ended_run();
    ask_get(RUN_1 "/results.zip", NULL, NULL, 200);
    ask_assert_header("Content-Type", "application/zip");
    ask_assert_header("Content-Disposition", "attachment; filename=\"" ID_1 ".zip\"");
    ask_assert_header("Cache-Control", "private, max-age=31536000, immutable");
    ask_assert_header("ETag", TAG);
    size_t n = unzip_answer(files);
    assert_int_equal(n, 5);
    unzip_fini(files, n);
    ask_get(RUN_1 "/results.zip", NULL, "If-None-Match: " TAG "\n", 304);
    assert_null(ask_response.source.next_chunk);
}

static void files_for_vtk_come_when_asked(void **state)
{
    unzip_file files[UNZIP_FILES_MAX];

    add_ended_run();
    ask_get(RUN_1 "/results.zip", "vtk=1", "If-None-Match: " TAG "\n", 200);
    size_t n = unzip_answer(files);
    assert_int_equal(n, 8); // an image of each of two snapshots, and their collection
    unzip_fini(files, n);
    ask_get(RUN_1 "/results.zip", "vtk=0", "If-None-Match: " TAG "\n", 304);
    ask_get(RUN_1 "/results.zip", "vtk=yes", NULL, 400);
    assert_true(ask_body_has("'vtk' must be a whole number from 0 to 1"));
}

// The tests free an answer that was not created.
static void a_run_that_goes_on_has_no_archive_yet(void **state)
{
    static const run_state early[] = { RUN_QUEUED, RUN_RUNNING };
    static const run_state late[] = { RUN_SUCCEEDED, RUN_FAILED, RUN_CANCELLED };
    helper_run *of = add_ended_run();

    for (size_t i = 0; i < sizeof early / sizeof *early; i++) {
        of->record.state = early[i];
        ask_get(RUN_1 "/results.zip", NULL, NULL, 409);
        assert_true(ask_body_has("results.zip comes at its end"));
    }
    for (size_t i = 0; i < sizeof late / sizeof *late; i++) {
        of->record.state = late[i];
        ask_get(RUN_1 "/results.zip", NULL, NULL, 200);
    }
    ask_get(NO_RUN "/results.zip", NULL, NULL, 404);
}

int main(void)
{
    static const struct CMUnitTest tests[] = {
        ASK_TEST(the_results_of_a_run_are_one_file_that_never_changes),
        ASK_TEST(files_for_vtk_come_when_asked),
        ASK_TEST(a_run_that_goes_on_has_no_archive_yet),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
