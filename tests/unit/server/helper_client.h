/// A client made of a raw socket, for tests that must send what no HTTP library would.

#pragma once

#include "core/base/buffer.h"

#include <netinet/in.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/// Connect to a port of 127.0.0.1, or of another address. Returns the socket; fails the test if it cannot.
int client_connect(unsigned port);
int client_connect_to(struct in_addr host, unsigned port);

/// Send n bytes, or a text. False: the other side does not take them any more.
bool client_send_bytes(int fd, const void *bytes, size_t n);
bool client_send(int fd, const char *text);

/// Append what comes to *answer until it holds text, the other side closes, or ms have passed. True:
/// text is there.
bool client_read_until(int fd, bf_buffer *answer, const char *text, int64_t ms);

/// Append what comes until the other side closes (true), or ms have passed (false). A reset counts
/// as closed.
bool client_read_all(int fd, bf_buffer *answer, int64_t ms);

/// Read one response: its header and as much body as its Content-Length says, left in *answer,
/// zero-terminated; what follows stays in *rest, which must outlive the connection. False: none came
/// in five seconds. has_body false: it answers a HEAD.
bool client_read_response(int fd, bf_buffer *rest, bool has_body, bf_buffer *answer);

/// The status code of a response, or -1.
int client_status(const bf_buffer *answer);

/// Send a request on a new connection and return its status; the response is in *answer (NULL: not
/// wanted) up to the closing of the connection, so the request should ask for it.
int client_ask(unsigned port, const char *request, bf_buffer *answer);
