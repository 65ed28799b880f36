// What the transport adds to every answer, over a real server: encodings, ranges, limits, origins and
// the identity of a request.

#include "server/base/clock.h"
#include "server/http/http.h"

#include "tests/unit/server/helper_server.h"

#include <fcntl.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>
#include <zlib.h>

#define EXAMPLE "/v1/examples/example-1"
#define N_PAGE  5000

static char folder[] = "/tmp/test_http_finish_XXXXXX";
static char page[N_PAGE + 1];
static bf_buffer answer;

static void write_file(const char *name, const char *text)
{
    char path[128];

    (void)snprintf(path, sizeof path, "%s/%s", folder, name);
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    assert_true(fputs(text, file) >= 0);
    assert_int_equal(fclose(file), 0);
}

// Sets a file's time to so many seconds after that of others.
static void age(const char *name, time_t seconds)
{
    const struct timespec times[2] = { { .tv_sec = 1700000000 + seconds },
                                       { .tv_sec = 1700000000 + seconds } };
    char path[128];

    (void)snprintf(path, sizeof path, "%s/%s", folder, name);
    assert_int_equal(utimensat(AT_FDCWD, path, times, 0), 0);
}

static int make_web(void **state)
{
    for (size_t i = 0; i < N_PAGE; i++)
        page[i] = "abcdefghij klm\n"[i * 7 % 15];
    assert_non_null(mkdtemp(folder));
    write_file("app.js", page);
    write_file("built.js", page);
    write_file("built.js.gz", "made by the build");
    write_file("stale.js", page);
    write_file("stale.js.gz", "of an earlier build");
    write_file("small.js", "export {};");
    write_file("font.woff2", page);
    age("built.js", 0);
    age("built.js.gz", 0);
    age("stale.js", 1);
    age("stale.js.gz", 0);
    return 0;
}

static int remove_web(void **state)
{
    char command[64];

    buffer_fini(&answer);
    (void)snprintf(command, sizeof command, "rm -rf %s", folder);
    return system(command);
}

static void with_all(http_options *options)
{
    options->web_directory = folder;
    options->cors_origins = "https://plan.example";
    options->trusted_proxies = "127.0.0.1";
    options->requests_per_minute = 600;
    options->work_per_minute = 3;
}

// One request; *headers are lines with their ends. The body of the answer.
static const char *ask(const char *method, const char *path, const char *headers, int status)
{
    char request[1024];

    (void)snprintf(request, sizeof request,
                   "%s %s HTTP/1.1\r\nHost: a\r\nConnection: close\r\n%s\r\n", method, path,
                   headers);
    assert_int_equal(client_ask(http_port(server), request, &answer), status);
    return strstr(answer.bytes, "\r\n\r\n") + 4;
}

// The value of a header of the answer, or NULL.
static const char *header(const char *name)
{
    static char value[256];
    char line[64];

    (void)snprintf(line, sizeof line, "\r\n%s: ", name);
    const char *found = strcasestr(answer.bytes, line);
    if (found == NULL || found > strstr(answer.bytes, "\r\n\r\n"))
        return NULL;
    found += strlen(line);
    (void)snprintf(value, sizeof value, "%.*s", (int)strcspn(found, "\r"), found);
    return value;
}

static void assert_unpacks_to(const char *body, const char *text)
{
    char back[N_PAGE + 1] = "";
    z_stream z = { .next_in = (Bytef *)(uintptr_t)body,
                   .avail_in = (uInt)(answer.bytes + answer.n - body),
                   .next_out = (Bytef *)back,
                   .avail_out = N_PAGE };

    assert_int_equal(inflateInit2(&z, 15 + 16), Z_OK);
    assert_int_equal(inflate(&z, Z_FINISH), Z_STREAM_END);
    assert_int_equal(inflateEnd(&z), Z_OK);
    assert_string_equal(back, text);
}

static void an_encoded_answer_says_so_and_has_its_own_tag(void **state)
{
    char tag[256], headers[512], plain[N_PAGE + 1];

    server = fake_serve(&server_services, with_all);
    (void)snprintf(plain, sizeof plain, "%s", ask("GET", EXAMPLE, "", 200));
    assert_null(header("Content-Encoding"));
    assert_string_equal(header("Vary"), "Accept-Encoding, Origin");
    (void)snprintf(tag, sizeof tag, "%s", header("ETag"));
    assert_unpacks_to(ask("GET", EXAMPLE, "Accept-Encoding: gzip\r\n", 200), plain);
    assert_string_equal(header("Content-Encoding"), "gzip");
    assert_memory_equal(header("ETag"), tag, strlen(tag) - 1);
    assert_string_equal(header("ETag") + strlen(tag) - 1, "-gzip\"");
    (void)snprintf(headers, sizeof headers, "Accept-Encoding: gzip\r\nIf-None-Match: %s\r\n",
                   header("ETag"));
    char length[256];
    (void)snprintf(length, sizeof length, "%s", header("Content-Length"));
    const char *body = ask("GET", EXAMPLE, headers, 304);
    assert_string_equal(body, "");
    assert_string_equal(header("Content-Length"), length); // that of the 200 (RFC 9110, 8.6)
    assert_null(header("Content-Encoding"));
    assert_null(header("Content-Type"));
    (void)ask("HEAD", EXAMPLE, "Accept-Encoding: gzip\r\n", 200);
    assert_string_equal(header("Content-Length"), length);
}

static void small_ones_and_streams_are_sent_as_they_are(void **state)
{
    server = fake_serve(&server_services, with_all);
    (void)ask("GET", "/livez", "Accept-Encoding: gzip\r\n", 200);
    assert_null(header("Content-Encoding"));
    fake_append(&server_services, true);
    const char *body =
        ask("GET", "/v1/runs/" FAKE_RUN "/events", "Accept-Encoding: gzip, zstd\r\n", 200);
    assert_non_null(strstr(body, "event: end"));
    assert_null(header("Content-Encoding"));
}

static void a_client_that_refuses_the_plain_form_gets_another_or_none(void **state)
{
    server = fake_serve(&server_services, with_all);
    (void)ask("GET", "/livez", "Accept-Encoding: gzip, identity;q=0\r\n", 200);
    assert_string_equal(header("Content-Encoding"), "gzip");
    const char *body = ask("GET", "/livez", "Accept-Encoding: *;q=0\r\n", 406);
    assert_non_null(strstr(body, "\"status\":406"));
    (void)ask("GET", "/font.woff2", "Accept-Encoding: *;q=0\r\n", 406);
    (void)ask("GET", "/font.woff2", "Accept-Encoding: gzip, identity;q=0\r\n", 406);
    (void)ask("GET", "/built.js", "Accept-Encoding: gzip, identity;q=0\r\n", 200);
    assert_string_equal(header("Content-Encoding"), "gzip");
}

// The page's build compresses its files; the server compresses none of them again.
static void files_are_sent_as_the_build_left_them(void **state)
{
    server = fake_serve(&server_services, with_all);
    const char *body = ask("GET", "/built.js", "Accept-Encoding: zstd, gzip\r\n", 200);
    assert_string_equal(header("Content-Encoding"), "gzip");
    assert_string_equal(header("Content-Length"), "17");
    assert_string_equal(header("Vary"), "Accept-Encoding, Origin");
    assert_string_equal(body, "made by the build");
    (void)ask("GET", "/built.js.gz", "", 404);
    assert_string_equal(ask("GET", "/built.js", "", 200), page);
    assert_string_equal(ask("GET", "/app.js", "Accept-Encoding: gzip\r\n", 200), page);
    assert_null(header("Content-Encoding"));
    assert_string_equal(header("Vary"), "Accept-Encoding, Origin");
    assert_string_equal(ask("GET", "/stale.js", "Accept-Encoding: gzip\r\n", 200), page);
    assert_null(header("Content-Encoding"));
    (void)ask("GET", "/small.js", "Accept-Encoding: gzip\r\n", 200);
    assert_null(header("Content-Encoding"));
    (void)ask("GET", "/font.woff2", "Accept-Encoding: gzip\r\n", 200);
    assert_null(header("Content-Encoding"));
}

static void a_file_that_was_changed_has_another_tag(void **state)
{
    char tag[256];

    server = fake_serve(&server_services, with_all);
    write_file("changing.js", "before");
    age("changing.js", 0);
    (void)ask("GET", "/changing.js", "", 200);
    (void)snprintf(tag, sizeof tag, "%s", header("ETag"));
    write_file("changing.js", "beyond");
    assert_string_equal(ask("GET", "/changing.js", "", 200), "beyond");
    assert_string_not_equal(header("ETag"), tag);
}

static void a_range_of_a_file_is_its_bytes(void **state)
{
    char headers[512], tag[256];

    server = fake_serve(&server_services, with_all);
    const char *body =
        ask("GET", "/app.js", "Range: bytes=10-19\r\nAccept-Encoding: gzip\r\n", 206);
    assert_string_equal(header("Content-Range"), "bytes 10-19/5000");
    assert_string_equal(header("Content-Length"), "10");
    assert_memory_equal(body, page + 10, 10);
    assert_null(header("Content-Encoding"));
    (void)snprintf(tag, sizeof tag, "%s", header("ETag"));
    body = ask("GET", "/app.js", "Range: bytes=-3\r\n", 206);
    assert_string_equal(body, page + N_PAGE - 3);
    (void)ask("GET", "/app.js", "Range: bytes=0-1,5-6\r\n", 200);
    assert_string_equal(header("Accept-Ranges"), "bytes");
    body = ask("GET", "/app.js", "Range: bytes=5000-\r\n", 416);
    assert_string_equal(header("Content-Range"), "bytes */5000");
    assert_non_null(strstr(body, "5000 bytes"));
    (void)snprintf(headers, sizeof headers, "Range: bytes=0-1\r\nIf-Range: %s\r\n", tag);
    (void)ask("GET", "/app.js", headers, 206);
    (void)ask("GET", "/app.js", "Range: bytes=0-1\r\nIf-Range: \"other\"\r\n", 200);
    (void)snprintf(headers, sizeof headers, "Range: bytes=0-1\r\nIf-None-Match: %s\r\n", tag);
    (void)ask("GET", "/app.js", headers, 304);
    (void)ask("HEAD", "/app.js", "Range: bytes=0-1\r\n", 200);
    assert_string_equal(header("Content-Length"), "5000");
    (void)ask("GET", EXAMPLE, "Range: bytes=0-1\r\n", 200);
    assert_null(header("Accept-Ranges"));
}

// Its length would be that of a curve that has not been computed.
static void a_304_of_what_was_not_made_has_no_length(void **state)
{
    server = fake_serve(&server_services, with_all);
    (void)ask("GET", "/v1/runs/" FAKE_RUN "/curve", "If-None-Match: \"r0-json\"\r\n", 304);
    assert_null(header("Content-Length"));
    assert_null(header("Transfer-Encoding"));
    assert_memory_equal(answer.bytes + answer.n - 4, "\r\n\r\n", 4);
}

static void pages_elsewhere_are_answered_as_configured(void **state)
{
    server = fake_serve(&server_services, with_all);
    (void)ask("OPTIONS", "/v1/runs",
              "Origin: https://plan.example\r\nAccess-Control-Request-Method: POST\r\n", 204);
    assert_string_equal(header("Access-Control-Allow-Methods"), "POST, GET, HEAD, OPTIONS");
    assert_string_equal(header("Access-Control-Allow-Origin"), "https://plan.example");
    (void)ask("GET", "/nowhere", "Origin: https://plan.example\r\n", 404);
    assert_string_equal(header("Access-Control-Allow-Origin"), "https://plan.example");
    (void)ask("GET", "/livez", "Origin: https://other.example\r\n", 200);
    assert_null(header("Access-Control-Allow-Origin"));
    assert_string_equal(header("Vary"), "Accept-Encoding, Origin");
    (void)ask("OPTIONS", "/app.js", "", 204);
    assert_string_equal(header("Allow"), "GET, HEAD, OPTIONS");
}

// The third request that makes work is the last one for twenty seconds; others are served on.
static void a_client_that_asks_too_often_is_told_when_to_come_back(void **state)
{
    static const char remote[] = "X-Forwarded-For: 198.51.100.1\r\nContent-Length: 0\r\n";

    server = fake_serve(&server_services, with_all);
    for (int i = 0; i < 3; i++)
        (void)ask("POST", "/v1/validate", remote, 415);
    assert_string_equal(header("RateLimit-Policy"), "\"requests\";q=600;w=60, \"work\";q=3;w=60");
    const char *body = ask("POST", "/v1/validate", remote, 429);
    assert_non_null(strstr(body, "198.51.100.1"));
    assert_in_range(atoi(header("Retry-After")), 1, 20);
    (void)ask("GET", "/version", remote, 200);
    assert_string_equal(header("RateLimit-Policy"), "\"requests\";q=600;w=60");
    (void)ask("POST", "/v1/validate", "X-Forwarded-For: 198.51.100.2\r\nContent-Length: 0\r\n",
              415);
    // Lines of their own count as one list: the last address is the one that the proxy wrote.
    (void)ask("POST", "/v1/validate",
              "X-Forwarded-For: 203.0.113.1\r\nX-Forwarded-For: 198.51.100.1\r\n"
              "Content-Length: 0\r\n",
              429);
    for (int i = 0; i < 10; i++)
        (void)ask("POST", "/v1/validate", "Content-Length: 0\r\n", 415); // of this machine
    assert_null(header("RateLimit"));
    (void)ask("GET", "/livez", remote, 200);
    assert_null(header("RateLimit"));
}

static void every_answer_carries_the_identity_of_its_request(void **state)
{
    server = fake_serve(&server_services, with_all);
    (void)ask("GET", "/livez", "X-Request-Id: mine-1\r\n", 200);
    assert_string_equal(header("X-Request-Id"), "mine-1");
    assert_null(header("traceparent"));
    const char *body = ask("GET", "/nowhere",
                           "X-Request-Id: mine-2\r\ntraceparent: "
                           "00-0af7651916cd43dd8448eb211c80319c-b7ad6b7169203331-01\r\n",
                           404);
    assert_non_null(strstr(body, ",\"request_id\":\"mine-2\"}"));
    assert_memory_equal(header("traceparent"), "00-0af7651916cd43dd8448eb211c80319c-", 36);
    (void)ask("GET", "/a%00b", "X-Request-Id: mine-3\r\n", 400); // refused by the guard
    assert_string_equal(header("X-Request-Id"), "mine-3");
    (void)ask("GET", "/livez", "", 200);
    assert_int_equal(strlen(header("X-Request-Id")), 36);
}

static void settings_that_make_no_sense_are_refused(void **state)
{
    const api_services table = fake_services(&server_services);
    http_options options = { .listen = "127.0.0.1:0",
                             .services = &table,
                             .n_threads = 1,
                             .n_request_threads = 1,
                             .connection_limit = 10,
                             .cors_origins = "plan.example" };
    http *h = NULL;
    bf_error err = { 0 };

    assert_int_equal(http_start(&options, &h, &err), BF_EINPUT);
    assert_non_null(strstr(err.text, "plan.example"));
    options.cors_origins = "*";
    options.trusted_proxies = "localhost";
    assert_int_equal(http_start(&options, &h, &err), BF_EINPUT);
    assert_non_null(strstr(err.text, "localhost"));
    assert_null(h);
}

static void two_requests_a_minute(http_options *options)
{
    options->requests_per_minute = 2;
}

// The clocks of the test: time stands still, and CPU time is what the list says that it takes.
static _Atomic int64_t test_cpu_ns;

static int64_t stand_still(void)
{
    return 1000000;
}

static int64_t read_cpu_ns(void)
{
    return atomic_load(&test_cpu_ns);
}

static bf_status list_for_70_ms(api_service *service, const api_list_query *query,
                                api_run_list *ret_list, bf_error *err)
{
    atomic_fetch_add(&test_cpu_ns, 70000000);
    return fake_services((void *)service).list(service, query, ret_list, err);
}

static void six_requests_a_minute_and_slow_lists(http_options *options)
{
    static api_services slow;

    slow = *options->services;
    slow.list = list_for_70_ms;
    options->services = &slow;
    options->requests_per_minute = 6;
    options->clocks = (http_clocks){ .monotonic_ms = stand_still, .thread_cpu_ns = read_cpu_ns };
}

// Its token is good for 10 ms: it takes 6 others, of which 5 are left. The next is there when two have come, one in 10 s.
static void a_request_that_takes_long_counts_for_many(void **state)
{
    static const char remote[] = "X-Forwarded-For: 198.51.100.1\r\n";

    server = fake_serve(&server_services, six_requests_a_minute_and_slow_lists);
    (void)ask("GET", "/v1/runs", remote, 200);
    (void)ask("GET", "/version", remote, 429);
    assert_int_equal(atoi(header("Retry-After")), 20);
}

// Behind a proxy of this machine that is not configured, all clients would count as this machine.
static void what_an_unknown_proxy_forwards_is_limited_as_one_client(void **state)
{
    server = fake_serve(&server_services, two_requests_a_minute);
    (void)ask("GET", "/version", "X-Forwarded-For: 198.51.100.1\r\n", 200);
    (void)ask("GET", "/version", "Forwarded: for=198.51.100.2\r\n", 200);
    (void)ask("GET", "/version", "X-Forwarded-For: 198.51.100.3\r\n", 429);
    assert_non_null(header("Retry-After"));
    for (int i = 0; i < 5; i++)
        (void)ask("GET", "/version", "", 200);
    assert_null(header("RateLimit"));
}

int main(void)
{
#define CASE(name) cmocka_unit_test_setup_teardown(name, server_set_up, server_tear_down)
    const struct CMUnitTest tests[] = {
        CASE(an_encoded_answer_says_so_and_has_its_own_tag),
        CASE(small_ones_and_streams_are_sent_as_they_are),
        CASE(a_client_that_refuses_the_plain_form_gets_another_or_none),
        CASE(files_are_sent_as_the_build_left_them),
        CASE(a_file_that_was_changed_has_another_tag),
        CASE(a_range_of_a_file_is_its_bytes),
        CASE(a_304_of_what_was_not_made_has_no_length),
        CASE(pages_elsewhere_are_answered_as_configured),
        CASE(a_client_that_asks_too_often_is_told_when_to_come_back),
        CASE(a_request_that_takes_long_counts_for_many),
        CASE(what_an_unknown_proxy_forwards_is_limited_as_one_client),
        CASE(every_answer_carries_the_identity_of_its_request),
        CASE(settings_that_make_no_sense_are_refused),
    };
    return cmocka_run_group_tests(tests, make_web, remove_web);
}
