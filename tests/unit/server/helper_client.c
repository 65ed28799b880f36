#include "tests/unit/server/helper_client.h"
#include "tests/unit/server/helper_await.h"

#include "server/base/clock.h"
#include "tests/unit/helper_cmocka.h"

#include <arpa/inet.h>
#include <errno.h>
#include <poll.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

int client_connect_to(struct in_addr host, unsigned port)
{
    const struct sockaddr_in address = { .sin_family = AF_INET,
                                         .sin_port = htons((uint16_t)port),
                                         .sin_addr = host };
    int fd = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);

    assert_true(fd >= 0);
    assert_int_equal(connect(fd, (const struct sockaddr *)&address, sizeof address), 0);
    return fd;
}

int client_connect(unsigned port)
{
    return client_connect_to((struct in_addr){ htonl(INADDR_LOOPBACK) }, port);
}

bool client_send_bytes(int fd, const void *bytes, size_t n)
{
    const char *from = bytes;

    while (n > 0) {
        ssize_t n_sent = send(fd, from, n, MSG_NOSIGNAL);
        if (n_sent <= 0)
            return false;
        from += n_sent;
        n -= (size_t)n_sent;
    }
    return true;
}

bool client_send(int fd, const char *text)
{
    return client_send_bytes(fd, text, strlen(text));
}

// The outcome of one read.
typedef enum got { GOT_BYTES, GOT_END, GOT_NOTHING } got;

static got read_some(int fd, bf_buffer *answer, int64_t deadline_ms)
{
    struct pollfd p = { .fd = fd, .events = POLLIN };
    char bytes[65536];
    int64_t left = deadline_ms - clock_monotonic_ms();

    if (poll(&p, 1, left < 0 ? 0 : (int)left) <= 0)
        return GOT_NOTHING;
    ssize_t n = recv(fd, bytes, sizeof bytes, 0);
    if (n <= 0)
        return GOT_END;
    assert_int_equal(buffer_append(answer, bytes, (size_t)n), BF_OK);
    return GOT_BYTES;
}

bool client_read_until(int fd, bf_buffer *answer, const char *text, int64_t ms)
{
    int64_t deadline_ms = clock_monotonic_ms() + ms;
    size_t n_text = strlen(text), n_seen = 0;

    while (answer->n == 0 ||
           memmem(answer->bytes + n_seen, answer->n - n_seen, text, n_text) == NULL) {
        n_seen = answer->n < n_text ? 0 : answer->n - n_text;
        if (read_some(fd, answer, deadline_ms) != GOT_BYTES)
            return false;
    }
    return true;
}

bool client_read_all(int fd, bf_buffer *answer, int64_t ms)
{
    int64_t deadline_ms = clock_monotonic_ms() + ms;

    for (;;) {
        got what = read_some(fd, answer, deadline_ms);
        if (what != GOT_BYTES)
            return what == GOT_END;
    }
}

static size_t content_length(const bf_buffer *bytes)
{
    const char *found = strcasestr(bytes->bytes, "\r\nContent-Length:");
    return found == NULL ? 0 : strtoul(found + strlen("\r\nContent-Length:"), NULL, 10);
}

bool client_read_response(int fd, bf_buffer *rest, bool has_body, bf_buffer *answer)
{
    int64_t deadline_ms = clock_monotonic_ms() + HELPER_PATIENCE_MS;

    answer->n = 0;
    if (!client_read_until(fd, rest, "\r\n\r\n", HELPER_PATIENCE_MS))
        return false;
    size_t n = (size_t)(strstr(rest->bytes, "\r\n\r\n") + 4 - rest->bytes);
    if (has_body && client_status(rest) != 304)
        n += content_length(rest);
    while (rest->n < n) {
        if (read_some(fd, rest, deadline_ms) != GOT_BYTES)
            return false;
    }
    assert_int_equal(buffer_append(answer, rest->bytes, n), BF_OK);
    buffer_drop(rest, n);
    return true;
}

int client_status(const bf_buffer *answer)
{
    if (answer->n < 12 || memcmp(answer->bytes, "HTTP/1.", 7) != 0)
        return -1;
    return atoi(answer->bytes + 9);
}

int client_ask(unsigned port, const char *request, bf_buffer *answer)
{
    bf_buffer own = { 0 };
    bf_buffer *to = answer == NULL ? &own : answer;
    int fd = client_connect(port);

    to->n = 0;
    (void)client_send(fd, request);
    assert_true(client_read_all(fd, to, HELPER_PATIENCE_MS));
    int status = client_status(to);
    assert_int_equal(close(fd), 0);
    buffer_fini(&own);
    return status;
}
