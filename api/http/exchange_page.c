// Lists in pages: what the query asks for, and the link to what follows.

#include "api/http/exchange_priv.h"

#include <stdio.h>
#include <string.h>

enum { LIST_LIMIT = 50 }; // items a page, unless asked for

bf_status exchange__read_page(const exchange *x, exchange_page *ret_page, bf_error *err)
{
    const char *label = query_value(&x->query, "label");
    const char *cursor = query_value(&x->query, "cursor");
    exchange_page page = { .label = "" };
    uint64_t limit = LIST_LIMIT;

    if (label != NULL && strlen(label) >= sizeof page.label)
        return bf_fail(err, BF_EINPUT, "", "query parameter 'label' has more than %d bytes",
                       API_LABEL_SIZE - 1);
    if (cursor != NULL && !exchange__is_id(cursor))
        return bf_fail(err, BF_EINPUT, "", "query parameter 'cursor' is not from a `next` link");
    snprintf(page.label, sizeof page.label, "%s", label == NULL ? "" : label);
    snprintf(page.before, sizeof page.before, "%s", cursor == NULL ? "" : cursor);
    bf_status status = query_number(&x->query, "limit", 1, API_LIST_MAX, &limit, err);
    page.limit = (size_t)limit;
    if (status == BF_OK)
        *ret_page = page;
    return status;
}

// Writes a value for a query; text has room for three bytes per byte of value.
static void encode_value(const char *value, char *text)
{
    static const char plain[] =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-._~";

    for (; *value != '\0'; value++) {
        if (strchr(plain, *value) != NULL)
            *text++ = *value;
        else
            text += sprintf(text, "%%%02X", (unsigned char)*value);
    }
    *text = '\0';
}

void exchange__link_next(exchange *x, const exchange_page *page, const char *filters,
                         const char *last_id)
{
    char label[API_LABEL_SIZE * 3];

    encode_value(page->label, label);
    api_response_header(x->response, "Link", "<%s?limit=%zu%s%s%s&cursor=%s>; rel=\"next\"",
                        x->route->path, page->limit, filters,
                        label[0] == '\0' ? "" : "&label=", label, last_id);
}
