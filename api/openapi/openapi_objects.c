// The rows of openapi_schemas*.c as JSON Schema.

#include "api/openapi/openapi_priv.h"

#include <stdio.h>
#include <string.h>

static void write_members(json_out *w, const openapi_member *rows)
{
    for (; rows != NULL && rows->name != NULL; rows++) {
        char name[64];
        size_t n = strcspn(rows->name, "?");
        snprintf(name, sizeof name, "%.*s", (int)n, rows->name);
        json_out_key(w, name);
        schema_write(w, rows->type, NULL, rows->help);
    }
}

static void write_required(json_out *w, const openapi_member *rows)
{
    for (; rows != NULL && rows->name != NULL; rows++) {
        if (strchr(rows->name, '?') == NULL)
            json_out_string(w, rows->name);
    }
}

static void write_object(json_out *w, const openapi_schema *schema)
{
    json_out_key_string(w, "type", "object");
    json_out_key(w, "properties");
    json_out_object(w);
    write_members(w, schema->members);
    write_members(w, schema->more);
    json_out_object_end(w);
    json_out_key(w, "required");
    json_out_array(w);
    write_required(w, schema->members);
    write_required(w, schema->more);
    json_out_array_end(w);
    json_out_key(w, "additionalProperties");
    if (schema->others == NULL || *schema->others == '\0')
        json_out_bool(w, schema->others != NULL);
    else
        schema_write(w, schema->others, NULL, NULL);
}

static void write_one_of(json_out *w, const char *names)
{
    json_out_key(w, "oneOf");
    json_out_array(w);
    for (size_t n; (n = schema_next_word(&names)) > 0; names += n) {
        json_out_object(w);
        schema_write_ref(w, "schemas", names, n);
        json_out_object_end(w);
    }
    json_out_array_end(w);
}

static void write_schema(json_out *w, const openapi_schema *schema)
{
    json_out_key(w, schema->name);
    json_out_object(w);
    json_out_key_string(w, "description", schema->help);
    if (schema->members != NULL)
        write_object(w, schema);
    else if (schema->type != NULL)
        schema_write_members(w, schema->type);
    else if (schema->one_of != NULL)
        write_one_of(w, schema->one_of);
    else
        schema->write(w);
    schema_write_limits(w, schema->limits);
    json_out_object_end(w);
}

void openapi__write_schemas(json_out *w)
{
    size_t n_schemas, n_events;
    const openapi_schema *schemas = openapi__schemas(&n_schemas);
    const openapi_schema *events = openapi__event_schemas(&n_events);

    for (size_t k = 0; k < n_schemas; k++)
        write_schema(w, &schemas[k]);
    for (size_t k = 0; k < n_events; k++)
        write_schema(w, &events[k]);
}
