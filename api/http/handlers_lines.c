// Lines: list them.

#include "api/http/access.h"
#include "api/http/http_priv.h"
#include "api/results/line_json.h"
#include "core/base/memory.h"

#include <stdio.h>
#include <string.h>

bf_status handlers_lines_list(exchange *x, bf_error *err)
{
    const exchange_page page = exchange__page(x);
    api_line_query wanted = { .limit = page.limit };

    bf_status status = access_list_owner_asked(x, wanted.owner, err);
    if (status != BF_OK)
        return status;
    snprintf(wanted.before, sizeof wanted.before, "%s", page.cursor);
    api_line_list *list = memory_alloc(1, sizeof *list);
    if (list == NULL)
        return bf_fail_memory(err);
    status = x->services->list_lines(x->services->store, &wanted, list, err);
    if (status == BF_OK && list->has_more && list->n > 0)
        memcpy(list->next_cursor, list->items[list->n - 1].newest, sizeof list->next_cursor);
    if (status == BF_OK)
        status = exchange__send_page(x, &page, list->next_cursor, &line_json_list, list, err);
    memory_free(list);
    return status;
}
