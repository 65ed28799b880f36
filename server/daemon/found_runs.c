#include "server/daemon/found_runs.h"

#include "core/base/digest.h"

#include <string.h>

void found_runs_init(found_runs *f)
{
    lock_init(&f->lock);
}

void found_runs_fini(found_runs *f)
{
    lock_fini(&f->lock);
}

static found_run *place_of(found_runs *f, const char *id)
{
    return &f->runs[digest_add(DIGEST_START, id, strlen(id)) % FOUND_RUNS_MAX];
}

bool found_runs_look(found_runs *f, const char *id, uint64_t n_commits, api_run *ret_run)
{
    lock_acquire(&f->lock);
    const found_run *found = place_of(f, id);
    const bool is_found = found->n_commits == n_commits && strcmp(found->record.id, id) == 0;
    if (is_found && ret_run != NULL)
        *ret_run = found->record;
    lock_release(&f->lock);
    return is_found;
}

void found_runs_remember(found_runs *f, uint64_t n_commits, const api_run *record)
{
    lock_acquire(&f->lock);
    *place_of(f, record->id) = (found_run){ n_commits, *record };
    lock_release(&f->lock);
}
