// Responses: headers and clean-up.

#include "api/http/exchange.h"

#include "core/base/check.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

void api_response_header(api_response *response, const char *name, const char *format, ...)
{
    va_list args;

    BF_CHECK(response->n_headers < API_HEADERS_MAX);
    api_header *header = &response->headers[response->n_headers++];
    header->name = name;
    va_start(args, format);
    int n = vsnprintf(header->value, sizeof header->value, format, args);
    va_end(args);
    BF_CHECK(n >= 0 && (size_t)n < sizeof header->value);
}

void api_response_fini(api_response *response)
{
    if (response == NULL)
        return;
    buffer_fini(&response->body);
    if (response->source.next_chunk != NULL)
        response->source.destroy(response->source.state);
    *response = (api_response){ 0 };
}

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
