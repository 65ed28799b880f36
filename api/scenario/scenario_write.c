#include "api/json/json_out.h"
#include "api/json/members.h"
#include "api/scenario/scenario.h"
#include "api/scenario/scenario_members.h"

#include <string.h>

bf_status scenario_write(const scene *s, bf_buffer *out, bf_error *err)
{
    size_t n = out->n;
    json_out w = json_out_to(out);

    members_write(&w, &scenario_members, s);
    bf_status status = json_out_status(&w, err);
    if (status != BF_OK)
        buffer_truncate(out, n);
    return status;
}

bf_status scenario_columns(const scene *s, bf_buffer *out, bf_error *err)
{
    size_t n = out->n;
    bf_status status = BF_OK;

    for (size_t k = 0; k < s->n_counters && status == BF_OK; k++)
        status = buffer_printf(out, "%s,", s->counters[k].id);
    if (status == BF_OK)
        status = buffer_append(out, "left_domain", strlen("left_domain"));
    if (status != BF_OK) {
        buffer_truncate(out, n);
        return bf_fail(err, status, "", "out of memory");
    }
    return BF_OK;
}
