#include "api/http/trials_csv.h"

#include "core/base/memory.h"

#include <string.h>

enum { PAGE = 256 }; // trials that are read at once

// What is still to be sent.
typedef struct sending {
    char id[API_ID_SIZE];
    study_columns columns;
    uint64_t n_ended;  // those that ended after it are left out
    uint64_t n_trials; // there were
    uint64_t from;     // next number
    bool has_begun;
} sending;

// A page that is written.
typedef struct page {
    const sending *of;
    bf_buffer *out;
} page;

static bf_status append_trial(void *context, const api_trial *trial, bf_error *err)
{
    const page *p = context;

    if (trial->ended == 0 || trial->ended > p->of->n_ended)
        return BF_OK;
    return study_trial_csv_line(trial, p->out, err);
}

static bf_status next_chunk(void *state, const api_services *services, size_t limit_bytes,
                            bf_buffer *out, body_state *ret_state, bf_error *err)
{
    sending *s = state;
    page p = { .of = s, .out = out };
    const size_t start = out->n;
    bf_status status = BF_OK;

    if (!s->has_begun)
        status = study_trial_csv_header(&s->columns, out, err);
    s->has_begun = true;
    while (status == BF_OK && s->from < s->n_trials && out->n - start < limit_bytes) {
        const api_trial_query wanted = { .order = API_TRIALS_BY_NUMBER,
                                         .from = s->from,
                                         .limit = PAGE };
        status = services->read_trials(services->store, s->id, &wanted, append_trial, &p, err);
        s->from += PAGE;
    }
    *ret_state = s->from < s->n_trials ? BODY_MORE : BODY_DONE;
    return status;
}

bf_status trials_csv_open(const api_study *about, const study_columns *columns,
                          body_source *ret_source, bf_error *err)
{
    sending *s = memory_alloc(1, sizeof *s);

    if (s == NULL)
        return bf_fail_memory(err);
    memcpy(s->id, about->id, sizeof s->id);
    s->columns = *columns;
    s->n_ended = api_study_ended(about);
    s->n_trials = about->n_trials;
    *ret_source = (body_source){ .state = s, .next_chunk = next_chunk, .destroy = memory_free };
    return BF_OK;
}
