#include "server/http/http_priv.h"

#include <errno.h>
#include <netdb.h>
#include <netinet/in.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

enum { LISTEN_HOST_SIZE = 256, LISTEN_BACKLOG = 1024 };

// An address in its two parts.
typedef struct listen_parts {
    char host[LISTEN_HOST_SIZE];
    char port[8];
} listen_parts;

static bool is_port(const char *text)
{
    size_t n = strlen(text);
    return n > 0 && n <= 5 && strspn(text, "0123456789") == n && atol(text) <= 65535;
}

static bf_status split_address(const char *address, listen_parts *ret_parts, bf_error *err)
{
    const char *colon = strrchr(address, ':');
    const char *host = address;
    size_t n = colon == NULL ? 0 : (size_t)(colon - address);

    if (n >= 2 && host[0] == '[' && host[n - 1] == ']') {
        host++;
        n -= 2;
    } else if (n > 0 && memchr(host, ':', n) != NULL) {
        n = 0;
    }
    if (n == 0 || n >= LISTEN_HOST_SIZE || !is_port(colon + 1))
        return bf_fail(err, BF_EINPUT, "",
                       "'%s' is not an address to listen on, such as 127.0.0.1:8080 or [::1]:8080",
                       address);
    memcpy(ret_parts->host, host, n);
    ret_parts->host[n] = '\0';
    memcpy(ret_parts->port, colon + 1, strlen(colon + 1) + 1);
    return BF_OK;
}

static bf_status explain(const listen_parts *parts, int error, bf_error *err)
{
    if (error == EADDRINUSE)
        return bf_fail(err, BF_ESYSTEM, "", "port %s of %s is taken by another program",
                       parts->port, parts->host);
    if (error == EADDRNOTAVAIL)
        return bf_fail(err, BF_ESYSTEM, "", "%s is not an address of this machine", parts->host);
    if (error == EACCES)
        return bf_fail(err, BF_ESYSTEM, "", "port %s of %s may only be used with more rights",
                       parts->port, parts->host);
    return bf_fail(err, BF_ESYSTEM, "", "cannot listen on port %s of %s: %s", parts->port,
                   parts->host, strerror(error));
}

// A listening socket, or -1 with errno.
static int open_socket(const struct addrinfo *where)
{
    int fd = socket(where->ai_family, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
    int on = 1;

    if (fd < 0)
        return -1;
    if (setsockopt(fd, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on) == 0 &&
        bind(fd, where->ai_addr, where->ai_addrlen) == 0 && listen(fd, LISTEN_BACKLOG) == 0)
        return fd;
    int error = errno;
    (void)close(fd);
    errno = error;
    return -1;
}

// A name can have addresses that this machine cannot use, such as ::1 of localhost without IPv6: then
// the next one counts. -1 with errno.
static int open_first(const struct addrinfo *where)
{
    int fd = open_socket(where);

    while (fd < 0 && where->ai_next != NULL && (errno == EADDRNOTAVAIL || errno == EAFNOSUPPORT)) {
        where = where->ai_next;
        fd = open_socket(where);
    }
    return fd;
}

static unsigned port_of(int fd)
{
    struct sockaddr_storage address = { 0 };
    socklen_t n = sizeof address;

    if (getsockname(fd, (struct sockaddr *)&address, &n) != 0)
        return 0;
    if (address.ss_family == AF_INET6)
        return ntohs(((const struct sockaddr_in6 *)&address)->sin6_port);
    return ntohs(((const struct sockaddr_in *)&address)->sin_port);
}

bf_status http_check_address(const char *text, bf_error *err)
{
    listen_parts parts;

    return split_address(text, &parts, err);
}

bf_status http__listen(const char *address, int *ret_fd, unsigned *ret_port, bf_error *err)
{
    const struct addrinfo hints = { .ai_flags = AI_PASSIVE, .ai_socktype = SOCK_STREAM };
    struct addrinfo *found = NULL;
    listen_parts parts;
    bf_status status = split_address(address, &parts, err);

    if (status != BF_OK)
        return status;
    int failure = getaddrinfo(parts.host, parts.port, &hints, &found);
    if (failure != 0)
        return bf_fail(err, BF_EINPUT, "", "'%s' is not an address to listen on: %s", parts.host,
                       gai_strerror(failure));
    int fd = open_first(found);
    int error = errno;
    freeaddrinfo(found);
    if (fd < 0)
        return explain(&parts, error, err);
    *ret_fd = fd;
    *ret_port = port_of(fd);
    return BF_OK;
}
