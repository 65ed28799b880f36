// Which Host is answered: the addresses that are listened on, the names that were configured, and no
// other.

#include "server/http/listen.h"

#include "tests/unit/server/helper_server.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <stdio.h>
#include <string.h>

static http_host_verdict judge(const char *listened, const char *names, const char *host)
{
    struct sockaddr_in v4 = { .sin_family = AF_INET };
    struct sockaddr_in6 v6 = { .sin6_family = AF_INET6 };
    const char *address = strcmp(listened, "localhost") == 0 ? "127.0.0.1" : listened;

    assert_int_equal(http_host_check(names, NULL), BF_OK);
    bool is_v4 = inet_pton(AF_INET, address, &v4.sin_addr) == 1;
    assert_true(is_v4 || inet_pton(AF_INET6, address, &v6.sin6_addr) == 1);
    const void *socket_address = is_v4 ? (const void *)&v4 : &v6;
    http_hosts hosts = http_host_list(names, listened, socket_address);
    return http_host_classify(&hosts, host);
}

typedef struct host_case {
    const char *listened, *names, *host;
} host_case;

static void assert_all(const host_case *cases, size_t n, http_host_verdict verdict)
{
    for (size_t i = 0; i < n; i++) {
        http_host_verdict found = judge(cases[i].listened, cases[i].names, cases[i].host);
        if (found != verdict)
            print_error("%s, %s: '%s'\n", cases[i].listened, cases[i].names, cases[i].host);
        assert_int_equal(found, verdict);
    }
}

#define ASSERT_ALL(cases, verdict) assert_all(cases, sizeof(cases) / sizeof *(cases), verdict)

static void what_is_listened_on_and_what_is_configured_is_ours(void **state)
{
    static const host_case cases[] = {
        { "127.0.0.1", "", "127.0.0.1:8080" },
        { "127.0.0.1", "", "127.0.0.1" },
        { "127.0.0.1", "", "localhost:8080" },
        { "127.0.0.1", "", "LocalHost." },
        { "127.0.0.1", "", "[::1]:8080" },
        { "127.0.0.1", "", "localhost:9090" }, // a tunnel has another port
        { "127.0.0.1", "", "[0:0::1]" },
        { "127.0.0.2", "", "127.0.0.2:80" },
        { "127.0.0.2", "", "127.0.0.1:80" },
        { "::1", "", "localhost" },
        { "::1", "", "[::1]" },
        { "localhost", "", "localhost:8080" },
        { "192.0.2.7", "", "192.0.2.7:8080" },
        { "2001:db8::7", "", "[2001:DB8::7]:8080" },
        { "::ffff:192.0.2.7", "", "192.0.2.7" },
        // Behind a wildcard every address may be one of this machine; no page can choose it as a name.
        { "0.0.0.0", "", "192.0.2.7:8080" },
        { "0.0.0.0", "", "127.0.0.1:8080" },
        { "::", "", "[2001:db8::7]:8080" },
        { "::", "", "192.0.2.7" },
        { "0.0.0.0", "plan.example, other.example", "other.example" },
        { "127.0.0.1", "plan.example", "Plan.Example:443" },
        { "127.0.0.1", "plan.example", "plan.example.:443" },
        { "127.0.0.1", "a,b", "b" },
        { "127.0.0.1", "[2001:db8::7]", "[2001:db8::7]:80" },
        { "127.0.0.1", "192.0.2.7", "192.0.2.7:80" },
        { "127.0.0.1", "plan.example", "plan.example:" },
    };

    ASSERT_ALL(cases, HTTP_HOST_OURS);
}

static void every_other_host_is_foreign(void **state)
{
    static const host_case cases[] = {
        { "127.0.0.1", "", "evil.example:8080" },
        { "127.0.0.1", "", "localhost.evil.example" },
        { "127.0.0.1", "", "127.0.0.1.evil.example" },
        { "127.0.0.1", "", "192.0.2.7:8080" },
        { "127.0.0.1", "", "2130706433" },
        { "127.0.0.1", "", "0x7f.1" },
        { "127.0.0.1", "", "local%68ost" },
        { "127.0.0.1", "", "[::2]" },
        { "192.0.2.7", "", "localhost" },
        { "192.0.2.7", "", "127.0.0.1" },
        { "0.0.0.0", "", "evil.example" },
        { "0.0.0.0", "", "localhost:8080" },
        { "::", "plan.example", "xplan.example" },
        { "127.0.0.1", "plan.example", "plan.exampl" },
    };

    ASSERT_ALL(cases, HTTP_HOST_FOREIGN);
}

// uri-host [ ":" port ] of RFC 9110, 7.2
static void what_is_no_host_is_malformed(void **state)
{
    static const host_case cases[] = {
        { "127.0.0.1", "", "" },          { "127.0.0.1", "", ":8080" },
        { "127.0.0.1", "", "a b" },       { "127.0.0.1", "", "a:b" },
        { "127.0.0.1", "", "::1" },       { "127.0.0.1", "", "[::1" },
        { "127.0.0.1", "", "[::1]8080" }, { "127.0.0.1", "", "[localhost]" },
        { "127.0.0.1", "", "user@a" },    { "127.0.0.1", "", "a/b" },
        { "127.0.0.1", "", "a,b" },       { "127.0.0.1", "", "a%2" },
        { "127.0.0.1", "", "\xc3\xa4" },  { "127.0.0.1", "", "a:80:80" },
        { "127.0.0.1", "", "[]" },        { "0.0.0.0", "", "a?b" },
    };

    ASSERT_ALL(cases, HTTP_HOST_MALFORMED);
}

static void settings_are_names_without_ports(void **state)
{
    static const char *const bad[] = { "plan.example:443", "https://plan.example", "a/b", "[::1",
                                       "a *" };
    bf_error err = { 0 };

    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        assert_int_equal(http_host_check(bad[i], &err), BF_EINPUT);
    assert_int_equal(http_host_check("", NULL), BF_OK);
    assert_int_equal(http_host_check(" a , [::1],192.0.2.7 b.example. ", NULL), BF_OK);
}

static void no_names(http_options *options)
{
    options->hosts = NULL;
}

static void two_names(http_options *options)
{
    options->hosts = "plan.example, other.example";
}

static int ask(const char *line, const char *host, bf_buffer *answer)
{
    char request[512];

    (void)snprintf(request, sizeof request, "%s HTTP/1.1\r\nHost: %s\r\nConnection: close\r\n\r\n",
                   line, host);
    return client_ask(http_port(server), request, answer);
}

// A page of the internet whose name leads to 127.0.0.1 sends its own name.
static void a_request_for_another_host_is_misdirected(void **state)
{
    static const char *const paths[] = { "/livez",   "/readyz", "/metrics",
                                         "/v1/runs", "/",       "/v1/none" };
    bf_buffer answer = { 0 };

    server = fake_serve(&server_services, no_names);
    for (size_t i = 0; i < sizeof paths / sizeof *paths; i++) {
        char line[64];
        (void)snprintf(line, sizeof line, "GET %s", paths[i]);
        assert_int_equal(ask(line, "evil.example", &answer), 421);
        server_assert_holds(&answer, "\r\nContent-Type: application/problem+json");
        server_assert_holds(&answer, "\"status\":421");
        assert_int_not_equal(ask(line, "127.0.0.1", NULL), 421);
        assert_int_not_equal(ask(line, "localhost:8080", NULL), 421);
    }
    assert_int_equal(ask("OPTIONS /v1/runs", "evil.example", NULL), 421);
    assert_int_equal(ask("GET /livez", "a b", &answer), 400);
    server_assert_holds(&answer, "the Host header");
    // HTTP/1.0 needs no Host, and no browser leaves it out.
    assert_int_equal(client_ask(http_port(server), "GET /livez HTTP/1.0\r\n\r\n", NULL), 200);
    assert_true(http_is_alive(server)); // was never asked before
    server_await_sign_of_life();
    buffer_fini(&answer);
}

static void a_configured_host_is_answered_whatever_a_proxy_says_of_it(void **state)
{
    server = fake_serve(&server_services, two_names);
    assert_int_equal(ask("GET /livez", "other.example:443", NULL), 200);
    assert_int_equal(ask("GET /livez", "evil.example\r\nX-Forwarded-Host: plan.example", NULL),
                     421);
    assert_int_equal(ask("GET /livez", "plan.example\r\nX-Forwarded-Host: evil.example", NULL),
                     200);
}

// RFC 9112, 3.2.2: the host of a target in absolute form counts, and Host does not.
static void the_host_of_the_target_counts_before_that_of_the_header(void **state)
{
    server = fake_serve(&server_services, two_names);
    assert_int_equal(ask("GET http://plan.example/livez", "evil.example", NULL), 200);
    assert_int_equal(ask("GET http://evil.example/livez", "plan.example", NULL), 421);
    assert_int_equal(ask("GET http://user@plan.example/livez", "plan.example", NULL), 400);
    assert_int_equal(ask("GET http://plan.example/livez", "a b", NULL), 400);
}

#define CASE(name) cmocka_unit_test_setup_teardown(name, server_set_up, server_tear_down)

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_is_listened_on_and_what_is_configured_is_ours),
        cmocka_unit_test(every_other_host_is_foreign),
        cmocka_unit_test(what_is_no_host_is_malformed),
        cmocka_unit_test(settings_are_names_without_ports),
        CASE(a_request_for_another_host_is_misdirected),
        CASE(a_configured_host_is_answered_whatever_a_proxy_says_of_it),
        CASE(the_host_of_the_target_counts_before_that_of_the_header),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
