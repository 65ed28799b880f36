// Tests that answers take no more memory than they may together.

#include "server/http/http.h"

#include "server/base/metrics.h"
#include "tests/unit/server/helper_await.h"
#include "tests/unit/server/helper_server.h"

#include <string.h>
#include <unistd.h>

#define SNAPSHOT                                                                                   \
    "GET /v1/runs/" FAKE_RUN "/snapshots/0?format=json HTTP/1.1\r\nHost: a\r\nConnection: "        \
    "close\r\n\r\n"

// A snapshot of FAKE_CELLS numbers of 4 bytes takes six times that while it is made as a text.
static void room_for_one_and_a_half(http_options *options)
{
    options->answer_limit = FAKE_CELLS * 36;
}

static void answers_beyond_the_memory_for_all_of_them_are_refused(void **state)
{
    bf_buffer first = { 0 }, second = { 0 };

    server_services.n_snapshots = 1;
    server = fake_serve(&server_services, room_for_one_and_a_half);
    fake_hold(&server_services, FAKE_HELD_SNAPSHOT);
    int fd = client_connect(http_port(server));
    assert_true(client_send(fd, SNAPSHOT));
    assert_true(fake_wait_for_held(&server_services, 1));
    assert_int_equal(client_ask(http_port(server), SNAPSHOT, &second), 503);
    server_assert_holds(&second, "\r\nRetry-After: ");
    fake_hold(&server_services, FAKE_HELD_NONE);
    assert_true(client_read_all(fd, &first, HELPER_PATIENCE_MS));
    assert_int_equal(client_status(&first), 200);
    assert_int_equal(close(fd), 0);
    buffer_fini(&first);
    buffer_fini(&second);
}

static void what_an_answer_took_is_free_when_it_is_sent(void **state)
{
    server_services.n_snapshots = 1;
    server = fake_serve(&server_services, room_for_one_and_a_half);
    for (int i = 0; i < 5; i++) {
        assert_int_equal(client_ask(http_port(server), SNAPSHOT, NULL), 200);
        // The client can have its answer before the server has ended the request.
        for (int k = 0; k < 500 && metrics_value(METRICS_REQUESTS_NOW, 0) > 0; k++)
            assert_int_equal(usleep(10000), 0);
    }
}

static void room_for_nothing(http_options *options)
{
    options->answer_limit = 1;
}

static void a_single_answer_is_sent_whatever_it_takes(void **state)
{
    server_services.n_snapshots = 1;
    server = fake_serve(&server_services, room_for_nothing);
    assert_int_equal(client_ask(http_port(server), SNAPSHOT, NULL), 200);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(answers_beyond_the_memory_for_all_of_them_are_refused,
                                        server_set_up, server_tear_down),
        cmocka_unit_test_setup_teardown(what_an_answer_took_is_free_when_it_is_sent, server_set_up,
                                        server_tear_down),
        cmocka_unit_test_setup_teardown(a_single_answer_is_sent_whatever_it_takes, server_set_up,
                                        server_tear_down),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
