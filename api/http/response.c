// Headers of a response, beyond adding one.

#include "api/http/exchange.h"

#include "core/base/check.h"

#include <stdio.h>
#include <string.h>
#include <strings.h>

static api_header *find(api_response *response, const char *name)
{
    for (size_t i = 0; i < response->n_headers; i++) {
        if (strcasecmp(response->headers[i].name, name) == 0)
            return &response->headers[i];
    }
    return NULL;
}

const char *api_response_find(const api_response *response, const char *name)
{
    for (size_t i = 0; i < response->n_headers; i++) {
        if (strcasecmp(response->headers[i].name, name) == 0)
            return response->headers[i].value;
    }
    return NULL;
}

void api_response_set(api_response *response, const char *name, const char *value)
{
    api_header *header = find(response, name);

    if (header == NULL) {
        api_response_header(response, name, "%s", value);
        return;
    }
    BF_CHECK(strlen(value) < sizeof header->value);
    memcpy(header->value, value, strlen(value) + 1);
}

void api_response_drop(api_response *response, const char *name)
{
    api_header *header = find(response, name);

    if (header != NULL)
        *header = response->headers[--response->n_headers];
}

// True if a list of field names has this one.
static bool lists(const char *list, const char *name)
{
    size_t n = strlen(name);

    while (*list != '\0') {
        list += strspn(list, ", ");
        size_t n_item = strcspn(list, ",");
        if (n_item == n && strncasecmp(list, name, n) == 0)
            return true;
        list += n_item;
    }
    return false;
}

void api_response_vary(api_response *response, const char *name)
{
    const char *before = api_response_find(response, "Vary");
    char list[API_HEADER_SIZE];

    if (before != NULL && lists(before, name))
        return;
    int n = snprintf(list, sizeof list, "%s%s%s", before == NULL ? "" : before,
                     before == NULL ? "" : ", ", name);
    BF_CHECK(n >= 0 && (size_t)n < sizeof list);
    api_response_set(response, "Vary", list);
}
