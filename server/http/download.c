// Bodies that are made while they are sent (body_source). Each piece is made on a request thread, as its
// making reads the store and compresses, while the connection is suspended:
//
//     reader (MHD's thread)                       request thread
//     D1  bytes of the piece left: hand them out
//     D2  none: suspend, queue the request   -->  D3  make the next piece
//     D5  go to D1                           <--  D4  resume
//
// The piece and what it is made from are touched by the one that has the request: the pool's lock
// hands it to the request thread (D2), MHD's own back (D4). In between MHD calls nothing for the
// connection. The queue always takes such a request, as its number is limited by download_limit, until
// the pool ends; then the response is torn off. So suspend and resume strictly alternate here, too.
//
// A slow client holds one piece and the maker's state, no thread and nothing of the store.

#include "server/http/download_priv.h"

#include "server/base/log.h"
#include "server/http/http_priv.h"

#include <microhttpd.h>
#include <string.h>

bool http__download_begin(http_request *r)
{
    http *h = r->server;

    lock_take(&h->lock);
    bool has_room = !h->is_stopping && h->n_downloads < h->options.download_limit;
    if (has_room) {
        h->n_downloads++;
        r->is_download = true;
    }
    lock_give(&h->lock);
    return has_room;
}

void http__download_end(http_request *r)
{
    http *h = r->server;

    if (!r->is_download)
        return;
    lock_take(&h->lock);
    h->n_downloads--;
    r->is_download = false;
    lock_give(&h->lock);
    buffer_fini(&r->download.piece);
}

void http__download_make(http_request *r)
{
    http_download *d = &r->download;
    const body_source *source = &r->response.source;
    body_state where = BODY_MORE;
    bf_error err = { 0 };

    d->n_taken = d->piece.n = 0;
    bf_status status = source->next_chunk(source->state, &r->server->services, HTTP_DOWNLOAD_PIECE,
                                          &d->piece, &where, &err);
    d->is_over = where == BODY_DONE;
    if (status == BF_OK)
        return;
    char path[LOG_QUOTED_SIZE], text[LOG_QUOTED_SIZE];
    log_event(LOG_LEVEL_WARN, "download_failed", "path=%s error=%s", log_quote(r->path, path),
              log_quote(err.text, text));
    d->piece.n = 0;
    d->has_failed = true;
}

ssize_t http__download_read(void *context, uint64_t position, char *bytes, size_t n)
{
    http_request *r = context;
    http_download *d = &r->download;
    size_t n_left = d->piece.n - d->n_taken;

    (void)position;
    if (n_left > 0) {
        n = n < n_left ? n : n_left;
        memcpy(bytes, d->piece.bytes + d->n_taken, n);
        d->n_taken += n;
        return (ssize_t)n;
    }
    if (d->has_failed)
        return MHD_CONTENT_READER_END_WITH_ERROR;
    if (d->is_over)
        return MHD_CONTENT_READER_END_OF_STREAM;
    return http__pool_continue(r->server->pool, r) ? 0 : MHD_CONTENT_READER_END_WITH_ERROR;
}
