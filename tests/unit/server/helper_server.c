#include "tests/unit/server/helper_server.h"
#include "tests/unit/server/helper_await.h"

#include <string.h>
#include <unistd.h>

fake server_services;
http *server;

int server_set_up(void **state)
{
    fake_init(&server_services);
    server = NULL;
    return 0;
}

int server_tear_down(void **state)
{
    fake_hold(&server_services, FAKE_HELD_NONE);
    server = http_stop(server);
    fake_fini(&server_services);
    return 0;
}

void server_append(bool is_end)
{
    fake_append(&server_services, is_end);
    http_notify(server, FAKE_RUN);
}

static void *keep_appending(void *context)
{
    const server_writer *w = context;

    while (__atomic_load_n(&w->goes_on, __ATOMIC_ACQUIRE)) {
        server_append(false);
        (void)usleep(200);
    }
    return NULL;
}

void server_writer_start(server_writer *w)
{
    w->goes_on = true;
    assert_int_equal(pthread_create(&w->thread, NULL, keep_appending, w), 0);
}

void server_writer_end(server_writer *w)
{
    __atomic_store_n(&w->goes_on, false, __ATOMIC_RELEASE);
    assert_int_equal(pthread_join(w->thread, NULL), 0);
}

// How soon threads answer is up to the machine, but they need some time between two rounds.
void server_await_sign_of_life(void)
{
    HELPER_AWAIT(http_is_alive(server));
}

void server_assert_holds(const bf_buffer *answer, const char *text)
{
    bool holds = answer->n > 0 && strstr(answer->bytes, text) != NULL;

    if (!holds)
        print_error("no '%s' in: %s\n", text, answer->n == 0 ? "" : answer->bytes);
    assert_true(holds);
}
