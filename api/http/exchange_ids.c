// Ids in requests: of runs, and of measurements, which have the same form.

#include "api/http/exchange_priv.h"

#include <stdio.h>
#include <string.h>

bool exchange__is_id(const char *text)
{
    static const char form[] = "xxxxxxxx-xxxx-xxxx-xxxx-xxxxxxxxxxxx";

    for (size_t i = 0; i < sizeof form - 1; i++) {
        bool fits = form[i] == '-' ? text[i] == '-'
                                   : text[i] != '\0' && strchr("0123456789abcdef", text[i]) != NULL;
        if (!fits)
            return false;
    }
    return text[sizeof form - 1] == '\0';
}

// Takes one id off the list; what cannot be one is not found.
static bf_status take_id(exchange *x, const char **list, const char *pointer, char *ret_id,
                         bf_error *err)
{
    size_t n = strcspn(*list, ",");
    char id[API_ID_SIZE] = "";

    if (n < sizeof id)
        memcpy(id, *list, n);
    if (!exchange__is_id(id))
        return exchange__refuse_at(x, 404, pointer, err, "there is nothing with the id '%.*s'",
                                   n < 64 ? (int)n : 64, *list);
    memcpy(ret_id, id, sizeof id);
    *list += n;
    return BF_OK;
}

bf_status exchange__read_ids(exchange *x, const char *name, size_t most,
                             char (*ret_ids)[API_ID_SIZE], size_t *ret_n, bf_error *err)
{
    const char *list = query_value(&x->query, name);
    char pointer[BF_POINTER_SIZE];
    size_t n = 0;

    if (list == NULL || *list == '\0')
        return exchange__refuse(x, 400, err, "query parameter '%s' is missing: ids with commas",
                                name);
    do {
        list += n > 0; // the comma
        if (n == most)
            return exchange__refuse(x, 400, err, "query parameter '%s' has more than %zu ids", name,
                                    most);
        snprintf(pointer, sizeof pointer, "/%s/%zu", name, n);
        bf_status status = take_id(x, &list, pointer, ret_ids[n], err);
        if (status != BF_OK)
            return status;
        for (size_t i = 0; i < n; i++) {
            if (strcmp(ret_ids[i], ret_ids[n]) == 0)
                return exchange__refuse(x, 400, err, "query parameter '%s' has '%s' twice", name,
                                        ret_ids[n]);
        }
        n++;
    } while (*list != '\0');
    *ret_n = n;
    return BF_OK;
}
