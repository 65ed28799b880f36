/// Private to server/http: the memory of all answers together, http_options.answer_limit.

#pragma once

#include "server/http/http_priv.h"

/// Count n bytes for the answer to a request, which is made now. False: with those of others they are too many.
bool http__answer_reserve(void *request, uint64_t n);

/// Count what the answer, which was made, takes; beyond the limit it becomes a 503.
void http__answer_settle(http_request *r);

/// Count nothing for the request any more.
void http__answer_release(http_request *r);
