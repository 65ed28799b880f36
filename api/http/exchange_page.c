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

// Into three bytes per byte of it at most; the end of what was written.
static char *encode(const char *value, char *text)
{
    static const char plain[] =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-._~";

    for (; *value != '\0'; value++) {
        if (strchr(plain, *value) != NULL)
            *text++ = *value;
        else
            text += sprintf(text, "%%%02X", (unsigned char)*value);
    }
    return text;
}

bf_status exchange__send_page(exchange *x, const exchange_page *page, const char *cursor,
                              const member_table *table, const void *list, bf_error *err)
{
    char filters[3 * QUERY_SIZE], *end = filters;

    for (size_t k = 0; k < x->query.n; k++) {
        const char *name = x->query.text + x->query.params[k].name;
        if (strcmp(name, "limit") == 0 || strcmp(name, "cursor") == 0)
            continue;
        end += sprintf(end, "&%s=", name);
        end = encode(x->query.text + x->query.params[k].value, end);
    }
    *end = '\0';
    if (cursor[0] != '\0')
        api_response_header(x->response, "Link", "<%s?limit=%zu%s&cursor=%s>; rel=\"next\"",
                            x->route->path, page->limit, filters, cursor);
    exchange__cache_revalidate(x);
    return exchange__write(x, table, list, err);
}
