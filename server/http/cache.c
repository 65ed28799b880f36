// Encoded files of the page, so that each is encoded once: a few entries, the one that was not asked
// for longest goes first. A file that was changed has another entity tag, and its old forms go like
// all others.

#include "server/http/http_priv.h"

#include "core/base/memory.h"

#include <string.h>

enum { CACHE_ENTRIES = 64, CACHE_BYTES = 8 * 1024 * 1024 };

typedef struct cache_entry {
    char path[API_PATH_MAX];
    char etag[sizeof((http_file){ 0 }.etag)];
    coding coding;
    bf_buffer bytes;  // empty: the entry is free
    uint64_t used_at; // by the cache's own clock
} cache_entry;

struct http_cache {
    lock lock;      // guards all of it
    uint64_t now;   // questions and answers so far
    size_t n_bytes; // in all entries
    cache_entry entries[CACHE_ENTRIES];
};

http_cache *http__cache_create(void)
{
    http_cache *cache = memory_alloc(1, sizeof *cache);

    if (cache != NULL)
        lock_init(&cache->lock);
    return cache;
}

http_cache *http__cache_destroy(http_cache *cache)
{
    if (cache == NULL)
        return NULL;
    for (size_t i = 0; i < CACHE_ENTRIES; i++)
        buffer_fini(&cache->entries[i].bytes);
    lock_fini(&cache->lock);
    memory_free(cache);
    return NULL;
}

static cache_entry *find(http_cache *cache, const char *path, const char *etag, coding c)
{
    for (size_t i = 0; i < CACHE_ENTRIES; i++) {
        cache_entry *entry = &cache->entries[i];
        if (entry->bytes.n > 0 && entry->coding == c && strcmp(entry->path, path) == 0 &&
            strcmp(entry->etag, etag) == 0)
            return entry;
    }
    return NULL;
}

bool http__cache_find(http_cache *cache, const char *path, const char *etag, coding c,
                      bf_buffer *out)
{
    lock_take(&cache->lock);
    cache_entry *entry = find(cache, path, etag, c);
    bool is_there =
        entry != NULL && buffer_append(out, entry->bytes.bytes, entry->bytes.n) == BF_OK;
    if (is_there)
        entry->used_at = ++cache->now;
    lock_give(&cache->lock);
    return is_there;
}

static void empty(http_cache *cache, cache_entry *entry)
{
    cache->n_bytes -= entry->bytes.n;
    buffer_fini(&entry->bytes);
    entry->used_at = 0; // before all that are used
}

// The entry that was not used for longest: a free one, unless only those with bytes count.
static cache_entry *find_oldest(http_cache *cache, bool has_bytes)
{
    cache_entry *oldest = NULL;

    for (size_t i = 0; i < CACHE_ENTRIES; i++) {
        cache_entry *entry = &cache->entries[i];
        if (has_bytes && entry->bytes.n == 0)
            continue;
        if (oldest == NULL || entry->used_at < oldest->used_at)
            oldest = entry;
    }
    return oldest;
}

// A free entry, with room for n bytes.
static cache_entry *make_room(http_cache *cache, size_t n)
{
    while (cache->n_bytes + n > CACHE_BYTES)
        empty(cache, find_oldest(cache, true));
    cache_entry *entry = find_oldest(cache, false);
    empty(cache, entry);
    return entry;
}

void http__cache_put(http_cache *cache, const char *path, const char *etag, coding c,
                     const bf_buffer *bytes)
{
    bf_buffer copy = { 0 };

    if (bytes->n > CACHE_BYTES / 4 || buffer_append(&copy, bytes->bytes, bytes->n) != BF_OK)
        return;
    lock_take(&cache->lock);
    if (find(cache, path, etag, c) == NULL) {
        cache_entry *entry = make_room(cache, copy.n);
        memcpy(entry->path, path, strlen(path) + 1);
        memcpy(entry->etag, etag, strlen(etag) + 1);
        entry->coding = c;
        entry->bytes = copy;
        entry->used_at = ++cache->now;
        cache->n_bytes += copy.n;
        copy = (bf_buffer){ 0 };
    }
    lock_give(&cache->lock);
    buffer_fini(&copy);
}
