#include "core/macro/entry_times.h"

#include "core/base/memory.h"
#include "core/base/team.h"

#include <string.h>

#define X(suffix) extern entry_times_carry_fn entry_times__carry_##suffix;
CPU_EACH_BUILD(X)
#undef X

static entry_times_carry_fn *carry_of(cpu_level level)
{
    static entry_times_carry_fn *const builds[CPU_AVX512 + 1] = {
#define X(suffix) entry_times__carry_##suffix,
        CPU_EACH_BUILD(X)
#undef X
    };

    return builds[level];
}

static double *make_rows(const macro_solver *s, ptrdiff_t n)
{
    return memory_alloc((size_t)(n * s->stride), sizeof(double));
}

bf_status entry_times_create(const macro_solver *s, entry_times **ret_times)
{
    entry_times *e = memory_alloc(1, sizeof *e);

    if (e == NULL)
        return BF_ENOMEM;
    e->carry = carry_of(cpu_best());
    e->n_exits = 2 * (size_t)(s->n1 + s->n2);
    e->exits = memory_alloc(e->n_exits, sizeof *e->exits);
    e->times = make_rows(s, s->n2);
    e->next = make_rows(s, s->n2);
    e->flux1 = make_rows(s, s->n2);
    e->flux2 = make_rows(s, s->n2 + 1);
    if (e->exits == NULL || e->times == NULL || e->next == NULL || e->flux1 == NULL ||
        e->flux2 == NULL) {
        entry_times_destroy(e);
        return BF_ENOMEM;
    }
    *ret_times = e;
    return BF_OK;
}

entry_times *entry_times_destroy(entry_times *e)
{
    if (e == NULL)
        return NULL;
    memory_free(e->exits);
    memory_free(e->times);
    memory_free(e->next);
    memory_free(e->flux1);
    memory_free(e->flux2);
    memory_free(e);
    return NULL;
}

void entry_times_reset(const macro_solver *s)
{
    entry_times *e = s->entries;

    memset(e->times, 0, (size_t)(s->n2 * s->stride) * sizeof *e->times);
    memset(e->exits, 0, e->n_exits * sizeof *e->exits);
}

void entry_times_record(const macro_solver *s, double *rows, ptrdiff_t row, const double *flux,
                        block_span span, double part, bool is_first)
{
    double *recorded = macro__row(s, rows, row);

    if (is_first)
        entry_times_clear(s, recorded, span);
    for (ptrdiff_t i = span.first * BLOCK_CELLS; i < span.last * BLOCK_CELLS; i++)
        recorded[i] = is_first ? part * flux[i] : recorded[i] + part * flux[i];
}

static macro_exit exit_of(double flux, double entered)
{
    return flux > 0.0 ? (macro_exit){ flux, entered } : (macro_exit){ 0.0, 0.0 };
}

// What left through the sides of row r, and for the first and last one through those of its columns.
static void note_exits(const macro_solver *s, ptrdiff_t r)
{
    const entry_times *e = s->entries;
    const double *times = macro__row(s, e->times, r), *flux1 = macro__row(s, e->flux1, r);
    const double *first = macro__row(s, e->flux2, 0), *last = macro__row(s, e->flux2, s->n2);
    macro_exit *south = e->exits + 2 * s->n2, *north = south + s->n1;

    e->exits[2 * r] = exit_of(-flux1[-1], times[0]);
    e->exits[2 * r + 1] = exit_of(flux1[s->n1 - 1], times[s->n1 - 1]);
    for (ptrdiff_t i = 0; r == 0 && i < s->n1; i++)
        south[i] = exit_of(-first[i], times[i]);
    for (ptrdiff_t i = 0; r + 1 == s->n2 && i < s->n1; i++)
        north[i] = exit_of(last[i], times[i]);
}

static void follow_row(void *context, size_t row)
{
    const macro_solver *s = context;

    s->entries->carry(s, (ptrdiff_t)row);
    note_exits(s, (ptrdiff_t)row);
}

void entry_times_follow(const macro_solver *s)
{
    entry_times *e = s->entries;
    double *before = e->times;

    team_for(s->def.n_threads, (size_t)s->n2, follow_row, (void *)s);
    e->times = e->next;
    e->next = before;
}

void entry_times_save(const macro_solver *s, checkpoint_writer *w)
{
    for (ptrdiff_t j = 0; j < s->n2; j++)
        checkpoint_write(w, macro__row(s, s->entries->times, j), (size_t)s->n1 * sizeof(double));
}

bool entry_times_load(const macro_solver *s, checkpoint_reader *r)
{
    bool is_read = true;

    for (ptrdiff_t j = 0; j < s->n2 && is_read; j++)
        is_read =
            checkpoint_read(r, macro__row(s, s->entries->times, j), (size_t)s->n1 * sizeof(double));
    return is_read;
}
