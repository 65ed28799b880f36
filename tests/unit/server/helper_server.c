#include "tests/unit/server/helper_server.h"

#include <string.h>

fake server_services;
http *server;

int server_set_up(void **state)
{
    (void)state;
    fake_init(&server_services);
    server = NULL;
    return 0;
}

int server_tear_down(void **state)
{
    (void)state;
    fake_hold(&server_services, false);
    server = http_stop(server);
    fake_fini(&server_services);
    return 0;
}

void server_assert_holds(const bf_buffer *answer, const char *text)
{
    bool holds = answer->n > 0 && strstr(answer->bytes, text) != NULL;

    if (!holds)
        print_error("no '%s' in: %s\n", text, answer->n == 0 ? "" : answer->bytes);
    assert_true(holds);
}
