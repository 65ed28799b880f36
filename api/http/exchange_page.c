// Pages of lists: which one is asked for, and the answer with the link to the next one.

#include "api/http/http_priv.h"

#include <stdio.h>
#include <string.h>

exchange_page exchange__page(const exchange *x)
{
    const char *label = exchange__text(x, "label");
    const char *cursor = exchange__text(x, "cursor");
    exchange_page page = { .limit = (size_t)exchange__whole(x, "limit"),
                           .cursor = cursor == NULL ? "" : cursor };

    snprintf(page.label, sizeof page.label, "%s", label == NULL ? "" : label);
    return page;
}

bf_status exchange__send_page(exchange *x, const exchange_page *page, const char *cursor,
                              const member_table *table, const void *list, bf_error *err)
{
    char filters[3 * QUERY_SIZE] = "";
    size_t n = 0;

    for (size_t k = 0; k < x->query.n; k++) {
        const char *name = x->query.text + x->query.params[k].name;
        if (strcmp(name, "limit") == 0 || strcmp(name, "cursor") == 0)
            continue;
        n += (size_t)snprintf(filters + n, sizeof filters - n, "&%s=", name);
        n += query_write_escaped(x->query.text + x->query.params[k].value, "", filters + n,
                                 sizeof filters - n);
    }
    if (cursor[0] != '\0')
        api_response_header(x->response, "Link", "<%s?limit=%zu%s&cursor=%s>; rel=\"next\"",
                            x->route->path, page->limit, filters, cursor);
    exchange__cache_revalidate(x);
    return exchange__write(x, table, list, err);
}
