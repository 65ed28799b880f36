/// A server of made-up services, one a test, with the fixtures that start from nothing and stop it.

#pragma once

#include "tests/unit/helper_cmocka.h"
#include "tests/unit/server/helper_client.h"
#include "tests/unit/server/helper_fake.h"

#include <pthread.h>
#include <stdbool.h>

extern fake server_services; ///< of the present test
extern http *server;         ///< what the present test started; NULL: nothing

/// Fixtures of cmocka: services without events and no server yet; whatever runs is stopped.
int server_set_up(void **state);
int server_tear_down(void **state);

/// Append an event to the run's log and notify the server, as a commit does.
void server_append(bool is_end);

/// A thread that appends events all the time.
typedef struct server_writer {
    pthread_t thread; ///< it
    bool goes_on;     ///< it shall
} server_writer;

/// Start it; end it.
void server_writer_start(server_writer *w);
void server_writer_end(server_writer *w);

/// Wait until every thread of the server has answered what http_is_alive() asked it.
void server_await_sign_of_life(void);

/// Fail the test unless the answer has the text.
void server_assert_holds(const bf_buffer *answer, const char *text);
