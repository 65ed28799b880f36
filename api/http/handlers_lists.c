// Lists of studies, measurements and lines; those of runs are in handlers_runs.c.

#include "api/http/access.h"
#include "api/http/http_priv.h"
#include "api/json/text.h"
#include "api/results/line_json.h"
#include "api/results/measurement.h"
#include "api/study/study_json.h"
#include "core/base/memory.h"

#include <stdio.h>
#include <string.h>

// Answer a page of a list. Its items have `size` bytes, and the id that they are sorted by stands at byte `id` of each.
static bf_status answer_page(exchange *x, api_page_fn *read, const member_table *table, size_t size,
                             size_t id, bf_error *err)
{
    const exchange_page page = exchange__page(x);
    const char *state = exchange__text(x, "status"), *line = exchange__text(x, "line");
    api_page_query wanted = { .state = -1, .limit = page.limit };

    BF_TRY(access_list_owner_asked(x, wanted.owner, err));
    memcpy(wanted.label, page.label, sizeof wanted.label);
    snprintf(wanted.before, sizeof wanted.before, "%s", page.cursor);
    snprintf(wanted.line, sizeof wanted.line, "%s", line == NULL ? "" : line);
    if (state != NULL)
        wanted.state = (int)text_find_word(api_study_state_words, API_STUDY_STATES, state);
    api_page *list = memory_alloc(1, sizeof *list);
    if (list == NULL)
        return bf_fail_memory(err);
    bf_status status = read(x->services->store, &wanted, list, err);
    if (status == BF_OK && list->has_more)
        memcpy(list->next_cursor, (const char *)list->studies + (list->n - 1) * size + id,
               sizeof list->next_cursor);
    if (status == BF_OK)
        status = exchange__send_page(x, &page, list->next_cursor, table, list, err);
    memory_free(list);
    return status;
}

bf_status handlers_lists_studies(exchange *x, bf_error *err)
{
    return answer_page(x, x->services->list_studies, &study_json_list, sizeof(api_study),
                       offsetof(api_study, id), err);
}

bf_status handlers_lists_measurements(exchange *x, bf_error *err)
{
    return answer_page(x, x->services->list_measurements, &measurement_list,
                       sizeof(api_measurement), offsetof(api_measurement, id), err);
}

bf_status handlers_lists_lines(exchange *x, bf_error *err)
{
    return answer_page(x, x->services->list_lines, &line_json_list, sizeof(api_line),
                       offsetof(api_line, newest), err);
}
