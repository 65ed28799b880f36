#include "server/http/listen.h"

#include "server/http/http.h"

#include <arpa/inet.h>
#include <ctype.h>
#include <errno.h>
#include <netdb.h>
#include <netinet/in.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
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

bf_status http_check_plaintext(const char *text, bf_error *err)
{
    if (strcmp(text, "loopback") == 0 || strcmp(text, "proxy") == 0 || strcmp(text, "open") == 0)
        return BF_OK;
    return bf_fail(err, BF_EINPUT, "", "plaintext must be loopback, proxy or open, not '%.40s'",
                   text);
}

bf_status http_allow_plaintext(const char *plaintext, bool has_tokens, const char *address,
                               bf_error *err)
{
    if (strcmp(plaintext, "open") == 0 || (strcmp(plaintext, "proxy") == 0 && has_tokens))
        return BF_OK;
    if (strcmp(plaintext, "proxy") == 0)
        return bf_fail(err, BF_EINPUT, "",
                       "%s can be reached from other machines, and there is no access token: add "
                       "one (beltflowd token add NAME), or set plaintext = open to let everybody "
                       "submit, read and remove",
                       address);
    return bf_fail(err, BF_EINPUT, "",
                   "%s can be reached from other machines without TLS: set plaintext = proxy if a "
                   "proxy or a private network stands before it (and add a token: beltflowd token "
                   "add NAME), or plaintext = open to let everybody submit, read and remove",
                   address);
}

bf_status http_listen(const char *address, int *ret_fd, unsigned *ret_port, bf_error *err)
{
    const struct addrinfo hints = { .ai_flags = AI_PASSIVE, .ai_socktype = SOCK_STREAM };
    struct addrinfo *found = NULL;
    listen_parts parts;
    BF_TRY(split_address(address, &parts, err));
    int failure = getaddrinfo(parts.host, parts.port, &hints, &found);
    if (failure != 0)
        return bf_fail(err, BF_EINPUT, "", "'%s' is not an address to listen on: %s", parts.host,
                       gai_strerror(failure));
    // A name can have addresses that this machine cannot use, such as ::1 of localhost without IPv6: then
    // the next one counts.
    const struct addrinfo *where = found;
    int fd = open_socket(where);
    while (fd < 0 && where->ai_next != NULL && (errno == EADDRNOTAVAIL || errno == EAFNOSUPPORT)) {
        where = where->ai_next;
        fd = open_socket(where);
    }
    int error = errno;
    freeaddrinfo(found);
    if (fd < 0)
        return explain(&parts, error, err);
    *ret_fd = fd;
    *ret_port = port_of(fd);
    return BF_OK;
}

enum { LITERAL_SIZE = INET6_ADDRSTRLEN };

static const char separators[] = ", \t";
static const uint8_t mapped[12] = { 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0xff, 0xff };

// The host of "host", "host:port", without brackets and the dot that ends a full name.
typedef struct host_text {
    const char *at;
    size_t n;
    bool is_bracketed;
} host_text;

// The bytes of reg-name (RFC 3986, 3.2.2), but for a comma, which would look like a list.
static bool is_name(const char *text, size_t n)
{
    for (size_t i = 0; i < n; i++) {
        bool is_escape = text[i] == '%' && i + 2 < n && isxdigit((unsigned char)text[i + 1]) &&
                         isxdigit((unsigned char)text[i + 2]);
        if (is_escape)
            i += 2;
        else if (!(isalnum((unsigned char)text[i]) ||
                   (text[i] != '\0' && strchr("-._~!$&'()*+;=", text[i]) != NULL)))
            return false;
    }
    return n > 0;
}

static bool read_literal(const char *text, size_t n, int family, void *ret_address)
{
    char copy[LITERAL_SIZE];

    if (n >= sizeof copy)
        return false;
    memcpy(copy, text, n);
    copy[n] = '\0';
    return inet_pton(family, copy, ret_address) == 1;
}

// False: it is no address.
static bool read_address(const host_text *host, uint8_t ret_address[HTTP_HOST_ADDRESS_SIZE])
{
    uint8_t v4[4];

    if (host->is_bracketed)
        return read_literal(host->at, host->n, AF_INET6, ret_address);
    if (!read_literal(host->at, host->n, AF_INET, v4))
        return false;
    memcpy(ret_address, mapped, sizeof mapped);
    memcpy(ret_address + sizeof mapped, v4, sizeof v4);
    return true;
}

// What follows the host: nothing, or a port, which may be empty.
static bool ends_in_port(const char *text)
{
    return *text == '\0' || (*text == ':' && text[1 + strspn(text + 1, "0123456789")] == '\0');
}

// False: it is not of the form uri-host [ ":" port ].
static bool split(const char *host, host_text *ret_text)
{
    host_text text = { .at = host, .n = strcspn(host, ":") };
    uint8_t address[HTTP_HOST_ADDRESS_SIZE];

    if (*host == '[') {
        text = (host_text){ .at = host + 1, .n = strcspn(host + 1, "]"), .is_bracketed = true };
        if (text.at[text.n] != ']' || !ends_in_port(text.at + text.n + 1) ||
            !read_address(&text, address))
            return false;
    } else if (!ends_in_port(host + text.n) || !is_name(host, text.n)) {
        return false;
    }
    if (!text.is_bracketed && text.n > 1 && host[text.n - 1] == '.')
        text.n--;
    *ret_text = text;
    return true;
}

// The next name of a list from *text on, of *n bytes; moves *text behind it. False: no more.
static bool next_name(const char **text, const char **ret_name, size_t *ret_n)
{
    const char *p = *text + strspn(*text, separators);

    *ret_name = p;
    *ret_n = strcspn(p, separators);
    *text = p + *ret_n;
    return *ret_n > 0;
}

static bool is_listed_form(const char *name, size_t n)
{
    uint8_t address[HTTP_HOST_ADDRESS_SIZE];

    if (n > 2 && name[0] == '[' && name[n - 1] == ']')
        return read_literal(name + 1, n - 2, AF_INET6, address);
    for (size_t i = 0; i < n; i++) {
        if (!isalnum((unsigned char)name[i]) && (name[i] == '\0' || strchr("-._", name[i]) == NULL))
            return false;
    }
    return true;
}

bf_status http_host_check(const char *names, bf_error *err)
{
    const char *name;
    size_t n = 0;

    while (next_name(&names, &name, &n)) {
        if (!is_listed_form(name, n))
            return bf_fail(err, BF_EINPUT, "",
                           "'%.*s' is no name of a host; one is beltflow.example, without a port",
                           (int)(n < 100 ? n : 100), name);
    }
    return BF_OK;
}

http_hosts http_host_list(const char *names, const char *listened, const struct sockaddr *address)
{
    static const uint8_t any6[HTTP_HOST_ADDRESS_SIZE] = { 0 }, loopback6[] = { [15] = 1 };
    http_hosts hosts = { .names = names, .listened = listened };
    bool is_v4 = address->sa_family == AF_INET;
    const void *from =
        is_v4 ? (const void *)&((const struct sockaddr_in *)(const void *)address)->sin_addr
              : &((const struct sockaddr_in6 *)(const void *)address)->sin6_addr;

    if (is_v4) {
        memcpy(hosts.address, mapped, sizeof mapped);
        memcpy(hosts.address + sizeof mapped, from, 4);
    } else {
        memcpy(hosts.address, from, sizeof hosts.address);
    }
    is_v4 = memcmp(hosts.address, mapped, sizeof mapped) == 0;
    hosts.is_wildcard = is_v4 ? memcmp(hosts.address + sizeof mapped, any6, 4) == 0
                              : memcmp(hosts.address, any6, sizeof any6) == 0;
    hosts.is_loopback = is_v4 ? hosts.address[sizeof mapped] == 127
                              : memcmp(hosts.address, loopback6, sizeof loopback6) == 0;
    return hosts;
}

bf_status http_check_listen(const char *address, const char *plaintext, bf_error *err)
{
    const struct addrinfo hints = { .ai_flags = AI_PASSIVE | AI_NUMERICHOST,
                                    .ai_socktype = SOCK_STREAM };
    struct addrinfo *found = NULL;
    listen_parts parts;

    bf_status status = split_address(address, &parts, err);
    if (status != BF_OK || getaddrinfo(parts.host, parts.port, &hints, &found) != 0)
        return status;
    bool is_loopback = http_host_list("", parts.host, found->ai_addr).is_loopback;
    freeaddrinfo(found);
    return is_loopback ? BF_OK : http_allow_plaintext(plaintext, true, address, err);
}

static bool is_same(const host_text *host, const char *name, size_t n)
{
    if (host->is_bracketed && n > 2 && name[0] == '[') {
        name++;
        n -= 2;
    }
    return host->n == n && strncasecmp(host->at, name, n) == 0;
}

static bool is_listed(const http_hosts *hosts, const host_text *host)
{
    const char *rest = hosts->names, *name;
    size_t n = 0;

    while (next_name(&rest, &name, &n)) {
        if (is_same(host, name, n))
            return true;
    }
    return is_same(host, hosts->listened, strlen(hosts->listened));
}

// A literal address cannot be rebound by DNS, so any address that is listened on is accepted.
static bool is_our_address(const http_hosts *hosts, const uint8_t *address)
{
    static const uint8_t loopback4[] = { 127, 0, 0, 1 };
    static const uint8_t loopback6[HTTP_HOST_ADDRESS_SIZE] = { [15] = 1 };
    bool is_loopback = memcmp(address, loopback6, sizeof loopback6) == 0 ||
                       (memcmp(address, mapped, sizeof mapped) == 0 &&
                        memcmp(address + sizeof mapped, loopback4, sizeof loopback4) == 0);

    return hosts->is_wildcard || (hosts->is_loopback && is_loopback) ||
           memcmp(address, hosts->address, sizeof hosts->address) == 0;
}

http_host_verdict http_host_classify(const http_hosts *hosts, const char *host)
{
    uint8_t address[HTTP_HOST_ADDRESS_SIZE];
    host_text text;

    if (!split(host, &text))
        return HTTP_HOST_MALFORMED;
    bool is_ours = read_address(&text, address)
                       ? is_our_address(hosts, address)
                       : hosts->is_loopback && is_same(&text, "localhost", strlen("localhost"));
    return is_ours || is_listed(hosts, &text) ? HTTP_HOST_OURS : HTTP_HOST_FOREIGN;
}
