// What squeue printed: a line for each task, fields between bars.

#include "core/base/memory.h"
#include "server/slurm/slurm_priv.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

enum { FIELDS = 6, FIELD_SIZE = 600 };

enum { JOB, TASK, STATE, TIME, REASON, COMMENT };

typedef struct line {
    char fields[FIELDS][FIELD_SIZE];
} line;

int64_t slurm__read_time(const char *text)
{
    long long days = 0, parts[3] = { 0, 0, 0 };
    const char *at = strchr(text, '-');
    size_t n = 0;

    if (at != NULL)
        days = strtoll(text, NULL, 10);
    at = at == NULL ? text : at + 1;
    for (; n < 3 && *at >= '0' && *at <= '9'; n++) {
        char *end;
        parts[n] = strtoll(at, &end, 10);
        at = *end == ':' ? end + 1 : end;
    }
    const long long hours = n == 3 ? parts[0] : 0;
    const long long minutes = n == 3 ? parts[1] : n == 2 ? parts[0] : 0;
    const long long seconds = n == 0 ? 0 : parts[n - 1];
    return ((days * 24 + hours) * 60 + minutes) * 60 + seconds;
}

// The last field has the rest of the line. False: there are too few, or one is too long.
static bool read_line(const char *text, size_t n, line *ret_line)
{
    for (size_t f = 0; f < FIELDS; f++) {
        const char *bar = f + 1 < FIELDS ? memchr(text, '|', n) : text + n;
        if (bar == NULL || bar - text >= FIELD_SIZE)
            return false;
        const size_t n_field = (size_t)(bar - text);
        memcpy(ret_line->fields[f], text, n_field);
        ret_line->fields[f][n_field] = '\0';
        text = bar + (n_field < n);
        n -= n_field + (n_field < n);
    }
    return true;
}

static slurm__state state_of(const line *l)
{
    const char *word = l->fields[STATE], *reason = l->fields[REASON];

    // Reasons of a hold: "JobHeldUser", "JobHeldAdmin", "launch failed requeued held" (some releases: with underscores).
    if (strcmp(word, "PENDING") == 0)
        return strcasestr(reason, "held") == NULL     ? SLURM_PENDING
               : strcasestr(reason, "launch") != NULL ? SLURM_FAILED
                                                      : SLURM_HELD;
    if (strcmp(word, "REQUEUED") == 0 || strcmp(word, "REQUEUE_HOLD") == 0 ||
        strcmp(word, "SPECIAL_EXIT") == 0)
        return SLURM_FAILED;
    if (strcmp(word, "RUNNING") == 0 || strcmp(word, "CONFIGURING") == 0 ||
        strcmp(word, "SUSPENDED") == 0)
        return SLURM_STARTED;
    return SLURM_OVER;
}

static bool is_number(const char *text)
{
    return text[0] != '\0' && text[strspn(text, "0123456789")] == '\0' && strlen(text) <= 20;
}

bf_status slurm__read_queue(const char *text, const char *comment, slurm__queue *ret_queue,
                            bf_error *err)
{
    slurm__queue queue = { .n = 0 };
    size_t room = 0;
    line l;

    for (const char *next; *text != '\0'; text = next) {
        const size_t n = strcspn(text, "\n");
        next = text + n + (text[n] == '\n');
        if (!read_line(text, n, &l) || strcmp(l.fields[COMMENT], comment) != 0 ||
            !is_number(l.fields[JOB]) || !is_number(l.fields[TASK]))
            continue;
        if (memory_reserve(&queue.tasks, &room, queue.n + 1, sizeof *queue.tasks) != 0) {
            memory_free(queue.tasks);
            return bf_fail(err, BF_ENOMEM, "", "no memory for Slurm's queue");
        }
        slurm__task *task = &queue.tasks[queue.n++];
        task->state = state_of(&l);
        task->runs_s = slurm__read_time(l.fields[TIME]);
        (void)snprintf(task->name, sizeof task->name, "%.20s_%.20s", l.fields[JOB], l.fields[TASK]);
    }
    *ret_queue = queue;
    return BF_OK;
}
