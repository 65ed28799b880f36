// Tests of bodies whose senders may not send them: the header alone is decided.

#include "server/http/http.h"

#include "tests/unit/server/helper_await.h"
#include "tests/unit/server/helper_server.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define HOST   "Host: a\r\n"
#define LENGTH "Content-Length: 90000\r\n"
#define TO     "POST /v1/validate HTTP/1.1\r\n" HOST "Content-Type: application/json\r\n"

// Tokens "reads" and "submits".
static api_credential identify(api_service *service, const char *token, api_identity *ret_who)
{
    if (token == NULL)
        return API_CREDENTIAL_MISSING;
    const bool reads = strcmp(token, "reads") == 0;
    if (!reads && strcmp(token, "submits") != 0)
        return API_CREDENTIAL_UNKNOWN;
    *ret_who = (api_identity){ .token = 1, .scopes = reads ? API_SCOPE_READ : API_SCOPE_SUBMIT };
    return API_CREDENTIAL_VALID;
}

static void need_tokens(http_options *options)
{
    static api_services services;

    services = *options->services;
    services.identify = identify;
    options->services = &services;
}

// The body never comes, so only an answer to the header is one.
static void who_may_not_send_a_body_is_refused_before_it_comes(void **state)
{
    static const struct {
        const char *header;
        int status;
    } cases[] = {
        { TO LENGTH "\r\n", 401 },
        { TO LENGTH "Expect: 100-continue\r\n\r\n", 401 },
        { TO "Transfer-Encoding: chunked\r\n\r\n", 401 },
        { TO LENGTH "Authorization: Bearer nonsense\r\n\r\n", 401 },
        { TO LENGTH "Authorization: Bearer submits\r\n\r\n", 403 },
        { TO LENGTH "Authorization: Bearer submits\r\nExpect: 100-continue\r\n\r\n", 403 },
    };

    server = fake_serve(&server_services, need_tokens);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        bf_buffer answer = { 0 };
        int fd = client_connect(http_port(server));
        assert_true(client_send(fd, cases[i].header));
        assert_true(client_read_all(fd, &answer, HELPER_PATIENCE_MS));
        assert_int_equal(client_status(&answer), cases[i].status);
        server_assert_holds(&answer, "application/problem+json");
        server_assert_holds(&answer, "\r\nWWW-Authenticate: Bearer realm=");
        server_assert_holds(&answer, "\r\nConnection: close\r\n");
        assert_null(strstr(answer.bytes + 1, "HTTP/1.1 "));
        assert_int_equal(close(fd), 0);
        buffer_fini(&answer);
    }
}

static void a_client_that_sends_its_body_anyway_reads_the_refusal(void **state)
{
    enum { N = 90000 };
    char *body = calloc(1, N);
    bf_buffer answer = { 0 };

    assert_non_null(body);
    server = fake_serve(&server_services, need_tokens);
    int fd = client_connect(http_port(server));
    assert_true(client_send(fd, TO LENGTH "\r\n"));
    assert_true(client_send_bytes(fd, body, N));
    assert_true(client_read_all(fd, &answer, HELPER_PATIENCE_MS));
    assert_int_equal(client_status(&answer), 401);
    assert_int_equal(close(fd), 0);
    buffer_fini(&answer);
    free(body);
}

static void who_may_send_it_is_asked_for_it(void **state)
{
    bf_buffer answer = { 0 };

    server = fake_serve(&server_services, need_tokens);
    int fd = client_connect(http_port(server));
    assert_true(client_send(fd, TO "Connection: close\r\nAuthorization: Bearer reads\r\n"
                                   "Content-Length: 3\r\nExpect: 100-continue\r\n\r\n"));
    assert_true(client_read_until(fd, &answer, "\r\n\r\n", HELPER_PATIENCE_MS));
    assert_int_equal(client_status(&answer), 100);
    assert_true(client_send(fd, "{,}"));
    answer.n = 0;
    assert_true(client_read_all(fd, &answer, HELPER_PATIENCE_MS));
    assert_int_equal(client_status(&answer), 400);
    assert_int_equal(close(fd), 0);
    buffer_fini(&answer);
}

// A body that no route looks at is taken off the connection, and the next request is answered.
static void a_body_of_no_use_is_passed_over(void **state)
{
    bf_buffer answer = { 0 };

    server = fake_serve(&server_services, need_tokens);
    assert_int_equal(client_ask(http_port(server),
                                "POST /livez HTTP/1.1\r\n" HOST "Content-Length: 5\r\n\r\nGET /"
                                "GET /livez HTTP/1.1\r\n" HOST "Connection: close\r\n\r\n",
                                &answer),
                     405);
    server_assert_holds(&answer, "HTTP/1.1 200 OK");
    buffer_fini(&answer);
}

static void need_tokens_two_times_a_minute(http_options *options)
{
    need_tokens(options);
    options->trusted_proxies = "127.0.0.1";
    options->requests_per_minute = 2;
}

static void refusals_count_as_requests(void **state)
{
    static const int statuses[] = { 401, 401, 429 };

    server = fake_serve(&server_services, need_tokens_two_times_a_minute);
    for (size_t i = 0; i < sizeof statuses / sizeof *statuses; i++)
        assert_int_equal(
            client_ask(http_port(server), TO LENGTH "X-Forwarded-For: 192.0.2.1\r\n\r\n", NULL),
            statuses[i]);
}

int main(void)
{
#define CASE(name) cmocka_unit_test_setup_teardown(name, server_set_up, server_tear_down)
    const struct CMUnitTest tests[] = {
        CASE(who_may_not_send_a_body_is_refused_before_it_comes),
        CASE(a_client_that_sends_its_body_anyway_reads_the_refusal),
        CASE(who_may_send_it_is_asked_for_it),
        CASE(a_body_of_no_use_is_passed_over),
        CASE(refusals_count_as_requests),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
