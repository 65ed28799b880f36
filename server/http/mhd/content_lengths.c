#include "server/http/mhd/content_lengths.h"

#include "core/base/digest.h"

#include <string.h>

void http_content_lengths_init(http_content_lengths *lengths)
{
    memset(lengths->places, 0, sizeof lengths->places);
    lock_init(&lengths->lock);
}

void http_content_lengths_fini(http_content_lengths *lengths)
{
    lock_fini(&lengths->lock);
}

// The terminators keep "a", "b" apart from "ab", "".
static uint64_t digest_of(const char *path, const char *query, const char *tag)
{
    uint64_t digest = digest_add(DIGEST_START, path, strlen(path) + 1);

    digest = digest_add(digest, query, strlen(query) + 1);
    return digest_add(digest, tag, strlen(tag) + 1);
}

void http_content_lengths_remember(http_content_lengths *lengths, const char *path,
                                   const char *query, const char *tag, uint64_t n)
{
    uint64_t digest = digest_of(path, query, tag);

    lock_acquire(&lengths->lock);
    lengths->places[digest % HTTP_CONTENT_LENGTHS_MAX] =
        (http_content_length){ .digest = digest, .n = n };
    lock_release(&lengths->lock);
}

bool http_content_lengths_find(http_content_lengths *lengths, const char *path, const char *query,
                               const char *tag, uint64_t *ret_n)
{
    uint64_t digest = digest_of(path, query, tag);

    lock_acquire(&lengths->lock);
    const http_content_length found = lengths->places[digest % HTTP_CONTENT_LENGTHS_MAX];
    lock_release(&lengths->lock);
    *ret_n = found.n;
    return found.digest == digest && digest != 0;
}
