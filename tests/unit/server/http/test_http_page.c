// Tests of the page's files over HTTP, and of what never is a file of the page.

#include "server/http/http_priv.h"

#include "tests/unit/server/helper_server.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define REST " HTTP/1.1\r\nHost: a\r\nConnection: close\r\n"
#define PAGE "<!doctype html><title>page</title>"

static char folder[] = "/tmp/test_http_page_XXXXXX";
static char web[64];

static void write_file(const char *name, const char *text)
{
    char path[256];

    (void)snprintf(path, sizeof path, "%s/%s", folder, name);
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    assert_true(fputs(text, file) >= 0);
    assert_int_equal(fclose(file), 0);
}

static void make_folder(const char *name)
{
    char path[256];

    (void)snprintf(path, sizeof path, "%s/%s", folder, name);
    assert_int_equal(mkdir(path, 0700), 0);
}

static void make_link(const char *to, const char *name)
{
    char path[256];

    (void)snprintf(path, sizeof path, "%s/%s", folder, name);
    assert_int_equal(symlink(to, path), 0);
}

static int make_web(void **state)
{
    assert_non_null(mkdtemp(folder));
    (void)snprintf(web, sizeof web, "%s/web", folder);
    make_folder("web");
    make_folder("web/assets");
    make_folder("web/.git");
    write_file("secret", "secret");
    write_file("web/index.html", PAGE);
    write_file("web/assets/app.js", "export {};");
    write_file("web/strange.xyz", "?");
    write_file("web/a b.txt", "blank");
    write_file("web/.git/config", "secret");
    make_link("../secret", "web/link.txt");
    make_link("..", "web/up");
    return 0;
}

static int remove_web(void **state)
{
    char command[64];

    (void)snprintf(command, sizeof command, "rm -rf %s", folder);
    return system(command);
}

static void with_web(http_options *options)
{
    options->web_directory = web;
}

static void a_file_is_served_with_its_type_and_a_strict_policy(void **state)
{
    static const struct {
        const char *request, *type, *text;
    } cases[] = {
        { "GET /" REST "\r\n", "text/html; charset=utf-8", "\r\n\r\n" PAGE },
        { "GET /index.html" REST "\r\n", "text/html; charset=utf-8", "\r\n\r\n" PAGE },
        { "GET /assets/app.js?v=1" REST "\r\n", "text/javascript; charset=utf-8", "export {};" },
        { "GET /a%20b.txt" REST "\r\n", "text/plain; charset=utf-8", "blank" },
    };

    server = fake_serve(&server_services, with_web);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        bf_buffer answer = { 0 };
        char type[80];
        assert_int_equal(client_ask(http_port(server), cases[i].request, &answer), 200);
        (void)snprintf(type, sizeof type, "\r\nContent-Type: %s\r\n", cases[i].type);
        assert_non_null(strstr(answer.bytes, type));
        assert_non_null(strstr(answer.bytes, cases[i].text));
        assert_non_null(strstr(answer.bytes, "\r\nContent-Security-Policy: default-src 'self';"));
        assert_non_null(strstr(answer.bytes, "\r\nX-Content-Type-Options: nosniff\r\n"));
        buffer_fini(&answer);
    }
}

static void nothing_else_is_served(void **state)
{
    static const char *const paths[] = {
        "/secret",
        "/../secret",
        "/%2e%2e/secret",
        "/assets/../../secret",
        "/link.txt",
        "/up/secret",
        "/.git/config",
        "/assets",
        "/assets/",
        "//index.html",
        "/./index.html",
        "/index.html/",
        "/index.html/x",
        "/assets//app.js",
        "/none",
        "/..%2fsecret",
        "/v1/index.html",
        "/strange.xyz",
        "/*",
    };

    server = fake_serve(&server_services, with_web);
    for (size_t i = 0; i < sizeof paths / sizeof *paths; i++) {
        char request[256];
        bf_buffer answer = { 0 };
        (void)snprintf(request, sizeof request, "GET %s" REST "\r\n", paths[i]);
        int status = client_ask(http_port(server), request, &answer);
        if (status != 404)
            print_error("%s: %d\n", paths[i], status);
        assert_int_equal(status, 404);
        assert_non_null(strstr(answer.bytes, "application/problem+json"));
        buffer_fini(&answer);
    }
}

static void a_file_that_the_client_has_is_not_sent_again(void **state)
{
    bf_buffer answer = { 0 };
    char length[64];
    char request[256];

    server = fake_serve(&server_services, with_web);
    assert_int_equal(client_ask(http_port(server), "GET /" REST "\r\n", &answer), 200);
    const char *tag = strstr(answer.bytes, "\r\nETag: ");
    assert_non_null(tag);
    tag += strlen("\r\nETag: ");
    (void)snprintf(request, sizeof request, "GET /" REST "If-None-Match: \"x\", %.*s\r\n\r\n",
                   (int)strcspn(tag, "\r"), tag);
    assert_int_equal(client_ask(http_port(server), request, &answer), 304);
    assert_memory_equal(answer.bytes + answer.n - 4, "\r\n\r\n", 4);
    // A length in a 304 is that of what a 200 would send (RFC 9110, 8.6).
    (void)snprintf(length, sizeof length, "\r\nContent-Length: %zu\r\n", strlen(PAGE));
    server_assert_holds(&answer, length);
    assert_int_equal(
        client_ask(http_port(server), "GET /" REST "If-None-Match: \"x\"\r\n\r\n", &answer), 200);
    buffer_fini(&answer);
}

static void head_of_a_file_has_its_length_only(void **state)
{
    bf_buffer answer = { 0 };
    char length[64];

    server = fake_serve(&server_services, with_web);
    assert_int_equal(client_ask(http_port(server), "HEAD /" REST "\r\n", &answer), 200);
    (void)snprintf(length, sizeof length, "\r\nContent-Length: %zu\r\n", strlen(PAGE));
    assert_non_null(strstr(answer.bytes, length));
    assert_null(strstr(answer.bytes, PAGE));
    buffer_fini(&answer);
}

static void a_file_is_only_read(void **state)
{
    bf_buffer answer = { 0 };

    server = fake_serve(&server_services, with_web);
    assert_int_equal(client_ask(http_port(server), "POST /index.html" REST "\r\n", &answer), 405);
    server_assert_holds(&answer, "\r\nAllow: GET, HEAD, OPTIONS\r\n");
    assert_int_equal(client_ask(http_port(server), "POST /nothing.html" REST "\r\n", &answer), 404);
    buffer_fini(&answer);
}

static void without_a_page_the_root_says_so(void **state)
{
    bf_buffer answer = { 0 };

    server = fake_serve(&server_services, NULL);
    assert_int_equal(client_ask(http_port(server), "GET /" REST "\r\n", &answer), 200);
    assert_non_null(strstr(answer.bytes, "\r\nContent-Type: text/plain; charset=utf-8\r\n"));
    assert_non_null(strstr(answer.bytes, "Its page is not here"));
    assert_int_equal(client_ask(http_port(server), "GET /index.html" REST "\r\n", &answer), 404);
    buffer_fini(&answer);
}

static void without_a_reference_its_address_leads_to_the_document(void **state)
{
    static void (*const starts[])(http_options *) = { NULL, with_web };
    bf_buffer answer = { 0 };

    for (size_t i = 0; i < sizeof starts / sizeof *starts; i++) {
        server = fake_serve(&server_services, starts[i]);
        assert_int_equal(client_ask(http_port(server), "GET /docs" REST "\r\n", &answer), 200);
        server_assert_holds(&answer, "\r\nContent-Type: text/html; charset=utf-8\r\n");
        server_assert_holds(&answer, "<a href=\"/openapi.json\">");
        assert_int_equal(client_ask(http_port(server), "POST /docs" REST "\r\n", &answer), 405);
        server = http_stop(server);
    }
    buffer_fini(&answer);
}

static void the_reference_is_a_file_like_others(void **state)
{
    bf_buffer answer = { 0 };

    make_folder("web/docs");
    write_file("web/docs/index.html", "reference");
    server = fake_serve(&server_services, with_web);
    assert_int_equal(client_ask(http_port(server), "GET /docs" REST "\r\n", &answer), 200);
    assert_non_null(strstr(answer.bytes, "reference"));
    server_assert_holds(&answer, "default-src 'self'; ");
    assert_null(strstr(answer.bytes, "-src 'self' "));
    buffer_fini(&answer);
}

static void a_page_that_is_not_there_is_an_error(void **state)
{
    const api_services table = fake_services(&server_services);
    const http_options options = { .listen = "127.0.0.1:0",
                                   .services = &table,
                                   .web_directory = "/nowhere/web",
                                   .n_threads = 1,
                                   .n_request_threads = 1,
                                   .connection_limit = 10 };
    http *h = NULL;
    bf_error err = { 0 };

    assert_int_equal(http_start(&options, &h, &err), BF_ESYSTEM);
    assert_non_null(strstr(err.text, "/nowhere/web"));
    assert_null(h);
}

static void what_is_no_regular_file_is_not_opened(void **state)
{
    char path[128];
    http_file file = { .fd = -1 };

    (void)snprintf(path, sizeof path, "%s/fifo.txt", web);
    assert_int_equal(mkfifo(path, 0600), 0);
    server = fake_serve(&server_services, with_web);
    assert_false(http__page_open(server->web_fd, "/fifo.txt", CODING_IDENTITY, &file));
    assert_int_equal(file.fd, -1);
    assert_int_equal(unlink(path), 0);
}

int main(void)
{
#define CASE(name) cmocka_unit_test_setup_teardown(name, server_set_up, server_tear_down)
    const struct CMUnitTest tests[] = {
        CASE(a_file_is_served_with_its_type_and_a_strict_policy),
        CASE(nothing_else_is_served),
        CASE(a_file_that_the_client_has_is_not_sent_again),
        CASE(head_of_a_file_has_its_length_only),
        CASE(a_file_is_only_read),
        CASE(without_a_page_the_root_says_so),
        CASE(without_a_reference_its_address_leads_to_the_document),
        CASE(the_reference_is_a_file_like_others),
        CASE(a_page_that_is_not_there_is_an_error),
        CASE(what_is_no_regular_file_is_not_opened),
    };
    return cmocka_run_group_tests(tests, make_web, remove_web);
}
