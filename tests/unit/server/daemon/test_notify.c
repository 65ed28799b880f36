// Unit tests of the messages to the service manager, with a socket of the test in its place.

#include "server/daemon/notify.h"

#include "server/base/clock.h"
#include "tests/unit/helper_cmocka.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

static int manager = -1;
static char folder[] = "/tmp/test_notify_XXXXXX";
static char path[64];

static int listen_as_manager(void **state)
{
    struct sockaddr_un address = { .sun_family = AF_UNIX };

    if (mkdtemp(folder) == NULL)
        return -1;
    (void)snprintf(path, sizeof path, "%s/notify", folder);
    (void)snprintf(address.sun_path, sizeof address.sun_path, "%s", path);
    manager = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
    if (manager < 0 || bind(manager, (struct sockaddr *)&address, sizeof address) != 0)
        return -1;
    return setenv("NOTIFY_SOCKET", path, 1);
}

static int leave(void **state)
{
    (void)unsetenv("NOTIFY_SOCKET");
    (void)close(manager);
    return unlink(path) != 0 || rmdir(folder) != 0;
}

static const char *receive(void)
{
    static char text[1024];
    ssize_t n = recv(manager, text, sizeof text - 1, 0);

    assert_true(n > 0);
    text[n] = '\0';
    return text;
}

static void readiness_comes_with_words(void **state)
{
    notify_ready("port %d", 80);
    assert_string_equal(receive(), "READY=1\nSTATUS=port 80");
    notify_stopping("bye");
    assert_string_equal(receive(), "STOPPING=1\nSTATUS=bye");
    notify_alive("%s", "well");
    assert_string_equal(receive(), "WATCHDOG=1\nSTATUS=well");
}

// A manager distinguishes this reload from the one before by the time.
static void a_reload_comes_with_its_time(void **state)
{
    int64_t from_us = clock_monotonic_ns() / 1000, at_us = 0;

    notify_reloading();
    const char *text = receive();
    assert_int_equal(sscanf(text, "RELOADING=1\nMONOTONIC_USEC=%" SCNd64 "\nSTATUS=", &at_us), 1);
    assert_true(at_us >= from_us && at_us <= clock_monotonic_ns() / 1000);
}

static void a_long_status_is_cut(void **state)
{
    char text[3 * NOTIFY_TEXT_SIZE];

    memset(text, 'x', sizeof text);
    text[sizeof text - 1] = '\0';
    notify_ready("%s", text);
    assert_int_equal(strlen(receive()), strlen("READY=1\nSTATUS=") + NOTIFY_TEXT_SIZE - 1);
}

static void the_watchdog_is_ours_only_if_it_names_this_process(void **state)
{
    char pid[32];

    assert_int_equal(notify_watchdog_ms(), 0);
    assert_int_equal(setenv("WATCHDOG_USEC", "30000000", 1), 0);
    assert_int_equal(notify_watchdog_ms(), 30000);
    (void)snprintf(pid, sizeof pid, "%ld", (long)getpid());
    assert_int_equal(setenv("WATCHDOG_PID", pid, 1), 0);
    assert_int_equal(notify_watchdog_ms(), 30000);
    (void)snprintf(pid, sizeof pid, "%ld", (long)getpid() + 1);
    assert_int_equal(setenv("WATCHDOG_PID", pid, 1), 0);
    assert_int_equal(notify_watchdog_ms(), 0);
    assert_int_equal(unsetenv("WATCHDOG_PID"), 0);
    assert_int_equal(setenv("WATCHDOG_USEC", "nonsense", 1), 0);
    assert_int_equal(notify_watchdog_ms(), 0);
    assert_int_equal(unsetenv("WATCHDOG_USEC"), 0);
}

static void without_a_manager_nothing_happens(void **state)
{
    char none;

    assert_int_equal(unsetenv("NOTIFY_SOCKET"), 0);
    notify_ready("port %d", 80);
    notify_reloading();
    assert_int_equal(recv(manager, &none, 1, 0), -1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(readiness_comes_with_words),
        cmocka_unit_test(a_reload_comes_with_its_time),
        cmocka_unit_test(a_long_status_is_cut),
        cmocka_unit_test(the_watchdog_is_ours_only_if_it_names_this_process),
        cmocka_unit_test(without_a_manager_nothing_happens),
    };
    return cmocka_run_group_tests(tests, listen_as_manager, leave);
}
