/// The listening socket, and which Host a request may name (RFC 9110, 7.2 and 15.5.20).
///
/// A page on the internet can resolve its own name to 127.0.0.1 and so make a browser send requests
/// to a service that listens only there (DNS rebinding); the Host header then has that name. So a request
/// is answered only under the addresses that are listened on and under configured names.
///
/// Ports are not compared: a tunnel, a container or a proxy may give the service another one, and
/// they add nothing to the protection that the name gives.

#pragma once

#include "core/base/status.h"

#include <stdbool.h>
#include <stdint.h>
#include <sys/socket.h>

/// Listen on "host:port". BF_EINPUT: not an address; BF_ESYSTEM: it cannot be used.
BF_MUST_CHECK bf_status http_listen(const char *address, int *ret_fd, unsigned *ret_port,
                                    bf_error *err);

/// BF_EINPUT: text is not a word of the setting plaintext: "loopback", "proxy" or "open".
BF_MUST_CHECK bf_status http_check_plaintext(const char *text, bf_error *err);

/// Decide whether an address beyond loopback may be listened on without TLS. With "proxy" the operator says that a
/// proxy or a private network stands before it, and requests must need a token; with "open" that everybody may
/// come. BF_EINPUT: not so.
BF_MUST_CHECK bf_status http_allow_plaintext(const char *plaintext, bool has_tokens,
                                             const char *address, bf_error *err);

/// The same of settings, before anything is started: tokens are not asked for, and an address that is a name is left to
/// the start.
BF_MUST_CHECK bf_status http_check_listen(const char *address, const char *plaintext,
                                          bf_error *err);

enum { HTTP_HOST_ADDRESS_SIZE = 16 }; ///< bytes of an address, IPv6 or IPv4 mapped into it

/// The hosts that are accepted.
typedef struct http_hosts {
    const char *names;                       ///< configured ones, as http_host_check(); borrowed
    const char *listened;                    ///< host part of the address to listen on; borrowed
    uint8_t address[HTTP_HOST_ADDRESS_SIZE]; ///< listened on
    bool is_wildcard;                        ///< all addresses are listened on
    bool is_loopback;                        ///< only this machine is
} http_hosts;

/// Classification of a Host.
typedef enum http_host_verdict {
    HTTP_HOST_OURS,      ///< answer
    HTTP_HOST_MALFORMED, ///< 400
    HTTP_HOST_FOREIGN,   ///< 421
} http_host_verdict;

/// BF_EINPUT unless names are host names or addresses, separated by commas or spaces, without ports.
BF_MUST_CHECK bf_status http_host_check(const char *names, bf_error *err);

/// The hosts accepted by a server that listens on this socket address.
http_hosts http_host_list(const char *names, const char *listened, const struct sockaddr *address);

/// Classify the value of a Host header.
http_host_verdict http_host_classify(const http_hosts *hosts, const char *host);
