// The body of a request: what it says it is.

#include "api/http/exchange_priv.h"

#include <stdio.h>
#include <string.h>
#include <strings.h>

static void list_types(exchange *x, const char *const *types)
{
    size_t n = 0;

    for (size_t i = 0; types[i] != NULL && n < sizeof x->accepts; i++)
        n += (size_t)snprintf(x->accepts + n, sizeof x->accepts - n, "%s%s", i == 0 ? "" : ", ",
                              types[i]);
}

bf_status exchange__check_body(exchange *x, const char *const *types, size_t *ret_type,
                               bf_error *err)
{
    const char *type = exchange__header(x, "Content-Type");
    const char *coding = exchange__header(x, "Content-Encoding");
    size_t found = 0;

    list_types(x, types);
    if (type == NULL)
        return exchange__refuse(x, 415, err, "the body needs Content-Type: %s", x->accepts);
    size_t n = strcspn(type, "; \t");
    while (types[found] != NULL &&
           (strlen(types[found]) != n || strncasecmp(type, types[found], n) != 0))
        found++;
    if (types[found] == NULL)
        return exchange__refuse(x, 415, err, "the body must be %s, not '%.64s'", x->accepts, type);
    if (coding != NULL && strcasecmp(coding, "identity") != 0)
        return exchange__refuse(x, 415, err, "the body must not be encoded ('%.32s')", coding);
    *ret_type = found;
    return BF_OK;
}
