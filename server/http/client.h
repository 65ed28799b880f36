/// Who sent a request: the address that limits hold for.
///
/// Behind a proxy every connection comes from the proxy; X-Forwarded-For names the original client.
/// The header is trusted from configured proxies only, and read from the right up to the first address
/// that is no configured proxy: anything left of it may be forged.
///
/// Clients on this machine are exempt from limits, unless a forwarding header shows that the request was
/// forwarded: a local proxy that is not configured must not exempt all the clients behind it.

#pragma once

#include "api/services.h"
#include "core/base/status.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/socket.h>

enum {
    HTTP_CLIENT_KEY_SIZE = 16, ///< bytes of an address, IPv6 or IPv4 mapped into it
    HTTP_PROXIES_MAX = 32,     ///< configured proxies
};

/// Networks whose X-Forwarded-For is trusted. Zero-initialise: none.
typedef struct http_proxies {
    size_t n;                                             ///< networks
    uint8_t keys[HTTP_PROXIES_MAX][HTTP_CLIENT_KEY_SIZE]; ///< their addresses
    unsigned bits[HTTP_PROXIES_MAX];                      ///< of which so many count
} http_proxies;

/// A client. Of IPv6 only the network's 64 bits count, since one host has all the rest of them.
typedef struct http_client {
    uint8_t key[HTTP_CLIENT_KEY_SIZE]; ///< for comparison
    char text[API_CLIENT_SIZE];        ///< for people
    bool is_local;                     ///< of this machine, for itself: the loopback network
    bool is_unknown_proxy;             ///< of this machine, for an unknown client
} http_client;

/// Read a list of addresses and networks ("10.0.0.0/8 ::1"), separated by spaces or commas.
/// BF_EINPUT: an item is no network, and the text names it; BF_ELIMIT: too many.
BF_MUST_CHECK bf_status http_client_read_proxies(const char *list, http_proxies *ret_proxies,
                                                 bf_error *err);

/// Whose connection it is, for a limit of each client's connections. False: no such limit holds, as for clients on this
/// machine, and for trusted proxies, whose connections are those of many.
bool http_client_of_connection(const struct sockaddr *peer, const http_proxies *proxies,
                               uint8_t *ret_key);

/// The client behind a connection from peer whose request has this X-Forwarded-For (NULL: none), and
/// perhaps another forwarding header. A peer of another family than IPv4 and IPv6 is local.
http_client http_client_find(const struct sockaddr *peer, const char *forwarded,
                             bool is_forwarded_otherwise, const http_proxies *proxies);
