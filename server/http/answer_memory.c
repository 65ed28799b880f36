// The memory of all answers together. What an answer takes is counted from before it is made to its end, so that
// neither many that are made at once nor many that nobody reads can take all memory. Small ones are not counted: they
// are limited with the connections, and shall be sent when large ones take all.

#include "server/http/answer_memory.h"

enum { SMALL = 65536 }; // bytes of an answer up to which it is not counted

// Count n bytes for a request instead of what was counted. A lone one is admitted whatever it takes.
static bool change(http_request *r, uint64_t n)
{
    http *h = r->server;

    lock_acquire(&h->lock);
    const uint64_t others = h->n_answer_bytes - r->n_answer_bytes;
    const uint64_t limit = h->options.answer_limit;
    const bool has_room =
        n <= r->n_answer_bytes || others == 0 || (n <= limit && others <= limit - n);
    if (has_room) {
        h->n_answer_bytes = others + n;
        r->n_answer_bytes = n;
    }
    lock_release(&h->lock);
    return has_room;
}

bool http__answer_reserve(void *request, uint64_t n)
{
    http_request *r = request;

    return n <= SMALL || change(r, n);
}

void http__answer_settle(http_request *r)
{
    const body_source *source = &r->response.source;
    const size_t n =
        source->next_chunk == NULL ? r->response.body.n : source->n_held + http__pull_chunk(source);

    if (!change(r, n > SMALL ? n : 0))
        http__respond_refuse(r, 503, BF_EBUSY,
                             "answers to others take the memory that this one needs");
}

void http__answer_release(http_request *r)
{
    (void)change(r, 0);
}
