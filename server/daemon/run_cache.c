#include "server/daemon/run_cache.h"

#include "core/base/digest.h"

#include <string.h>

void run_cache_init(run_cache *f)
{
    lock_init(&f->lock);
}

void run_cache_fini(run_cache *f)
{
    lock_fini(&f->lock);
}

static found_run *place_of(run_cache *f, const char *id)
{
    return &f->runs[digest_add(DIGEST_START, id, strlen(id)) % RUN_CACHE_MAX];
}

bool run_cache_look(run_cache *f, const char *id, uint64_t n_commits, api_run *ret_run)
{
    lock_acquire(&f->lock);
    const found_run *found = place_of(f, id);
    const bool is_found = found->n_commits == n_commits && strcmp(found->record.id, id) == 0;
    if (is_found && ret_run != NULL)
        *ret_run = found->record;
    lock_release(&f->lock);
    return is_found;
}

void run_cache_remember(run_cache *f, uint64_t n_commits, const api_run *record)
{
    lock_acquire(&f->lock);
    *place_of(f, record->id) = (found_run){ n_commits, *record };
    lock_release(&f->lock);
}
