#include "server/daemon/owner_figures.h"

#include "core/base/memory.h"
#include "server/base/clock.h"

#include <inttypes.h>
#include <stdbool.h>
#include <string.h>

static bf_status write_head(bf_buffer *out, const char *name, const char *help)
{
    return buffer_printf(out, "# HELP %s %s\n# TYPE %s gauge\n", name, help, name);
}

// Grants are made to expire, and nobody need know when.
static bool is_told(const tokens_record *token, int64_t now_ms)
{
    return token->expires_ms != 0 && token->resource[0] == '\0' && tokens_counts(token, now_ms);
}

static bf_status write_tokens(const tokens_record *all, size_t n, int64_t now_ms, bf_buffer *out)
{
    BF_TRY(write_head(out, "beltflow_token_expires_in_seconds",
                      "Until a token that counts and does not last for ever expires"));
    for (size_t i = 0; i < n; i++)
        if (is_told(&all[i], now_ms))
            BF_TRY(buffer_printf(out,
                                 "beltflow_token_expires_in_seconds{token=\"%" PRIu64
                                 "\",name=\"%s\",owner=\"%s\"} %" PRId64 "\n",
                                 all[i].id, all[i].name, all[i].owner,
                                 (all[i].expires_ms - now_ms) / 1000));
    return BF_OK;
}

// Whether a token of the same owner comes before.
static bool is_known(const tokens_record *all, size_t i)
{
    for (size_t k = 0; k < i; k++)
        if (strcmp(all[k].owner, all[i].owner) == 0)
            return true;
    return false;
}

static bf_status write_use(bf_buffer *out, const char *name, const char *help,
                           const api_quotas *quotas, size_t n, size_t offset)
{
    BF_TRY(write_head(out, name, help));
    for (size_t i = 0; i < n; i++) {
        const api_quota *quota =
            (const api_quota *)(const void *)((const char *)&quotas[i] + offset);
        BF_TRY(buffer_printf(out, "%s{owner=\"%s\"} %" PRIu64 "\n", name, quotas[i].owner,
                             quota->used));
    }
    return BF_OK;
}

static bf_status write_owners(const tokens_record *all, size_t n, store *s, api_quotas *quotas,
                              bf_buffer *out, bf_error *err)
{
    size_t n_owners = 0;

    for (size_t i = 0; i < n; i++)
        if (!is_known(all, i))
            BF_TRY(store_read_quotas(s, all[i].owner, &quotas[n_owners++], err));
    BF_TRY(write_use(out, "beltflow_owner_queue_length", "Runs of an owner that wait", quotas,
                     n_owners, offsetof(api_quotas, waiting)));
    BF_TRY(write_use(out, "beltflow_owner_cpu_seconds",
                     "CPU time of an owner in the present hour and the 23 before", quotas, n_owners,
                     offsetof(api_quotas, cpu_s)));
    return write_use(out, "beltflow_owner_bytes", "Results and measurements of an owner", quotas,
                     n_owners, offsetof(api_quotas, bytes));
}

bf_status owner_figures_write(tokens *t, store *s, bf_buffer *out, bf_error *err)
{
    tokens_record *all = memory_alloc(TOKENS_MAX, sizeof *all);
    api_quotas *quotas = memory_alloc(TOKENS_MAX, sizeof *quotas);
    bf_status status = all == NULL || quotas == NULL ? BF_ENOMEM : BF_OK;

    const size_t n = status == BF_OK ? tokens_copy(t, all) : 0;
    if (n > 0)
        status = write_tokens(all, n, clock_unix_ms(), out);
    if (status == BF_OK && n > 0)
        status = write_owners(all, n, s, quotas, out, err);
    if (status == BF_ENOMEM)
        (void)bf_fail_memory(err);
    memory_free(all);
    memory_free(quotas);
    return status;
}
