// Examples of requests and answers, which the tests recorded (samples.txt): a line for each, with the operation, "request" or
// the status, the media type, the path, and the value as JSON.

#include "api/openapi/openapi_priv.h"

#include <stdio.h>
#include <string.h>

/// A line of the file.
typedef struct sample {
    const char *target; ///< n_target bytes: path and query
    size_t n_target;
    const char *value; ///< n_value bytes of JSON
    size_t n_value;
} sample;

static bool find_sample(const char *id, const char *where, const char *type, sample *ret_sample)
{
    char head[160];

    const size_t n = (size_t)snprintf(head, sizeof head, "%s %s %s ", id, where, type);
    for (const char *line = openapi__text("samples"); *line != '\0';) {
        const char *end = strchr(line, '\n'), *target = line + n;
        if (strncmp(line, head, n) == 0) {
            const char *value = strchr(target, ' ') + 1;
            *ret_sample = (sample){ .target = target,
                                    .n_target = (size_t)(value - 1 - target),
                                    .value = value,
                                    .n_value = (size_t)(end - value) };
            return true;
        }
        line = end + 1;
    }
    return false;
}

void openapi__write_sample(json_out *w, const char *method, const char *id, const char *where,
                           const char *type)
{
    char summary[API_PATH_MAX];
    sample found;

    if (!find_sample(id, where, type, &found))
        return;
    snprintf(summary, sizeof summary, "%s %.*s", method, (int)found.n_target, found.target);
    json_out_key(w, "examples");
    json_out_object(w);
    json_out_key(w, "recorded");
    json_out_object(w);
    json_out_key_string(w, "summary", summary);
    json_out_key(w, "value");
    json_out_raw(w, found.value, found.n_value);
    json_out_object_end(w);
    json_out_object_end(w);
}
