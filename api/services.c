#include "api/services.h"

#include "core/base/check.h"

#include <string.h>

const char *const api_measured_words[] = { "curve", "profile", "schedule", NULL };

size_t api_count_columns(const bf_buffer *columns)
{
    size_t n = 1;

    for (size_t i = 0; i < columns->n; i++)
        n += columns->bytes[i] == ',';
    return n;
}

bool api_next_column(const char **columns, char *ret_name)
{
    size_t n = strcspn(*columns, ",");

    if (n == 0)
        return false;
    BF_CHECK(n < COLUMN_NAME_SIZE);
    memcpy(ret_name, *columns, n);
    ret_name[n] = '\0';
    *columns += n + ((*columns)[n] == ',');
    return true;
}

void api_curve_fini(api_curve *curve)
{
    if (curve == NULL)
        return;
    buffer_fini(&curve->columns);
    buffer_fini(&curve->t);
    buffer_fini(&curve->values);
    *curve = (api_curve){ 0 };
}
