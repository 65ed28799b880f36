// Pages of lists: which one is asked for, and the link to the next one.

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

void exchange__encode(const char *value, char *text)
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
                         const char *cursor)
{
    char label[API_LABEL_SIZE * 3];

    exchange__encode(page->label, label);
    api_response_header(x->response, "Link", "<%s?limit=%zu%s%s%s&cursor=%s>; rel=\"next\"",
                        x->route->path, page->limit, filters,
                        label[0] == '\0' ? "" : "&label=", label, cursor);
}
