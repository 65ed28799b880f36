#include "api/scenario/examples.h"

#include "api/scenario/scenario_priv.h"

#include <jansson.h>
#include <stdio.h>
#include <string.h>

const example *examples_list(size_t *ret_n)
{
    size_t n = 0;

    while (examples__list[n].name != NULL)
        n++;
    *ret_n = n;
    return examples__list;
}

const example *examples_find(const char *name)
{
    for (const example *at = examples__list; at->name != NULL; at++) {
        if (strcmp(at->name, name) == 0)
            return at;
    }
    return NULL;
}

typedef struct item {
    char name[64];
    const char *title;
} item;

#define AT(place) offsetof(item, place)
static const member item_members[] = {
    MEMBER("name", text, AT(name), "Name of the example in paths"),
    MEMBER("title", string, AT(title), "Name of the scenario"),
    MEMBER("url", link, AT(name), "Its document", .path = "/v1/examples/{id}"),
};
const member_table examples_item_members = { MEMBER_TABLE("ExampleItem", item_members) };
#undef AT

static const member list_members[] = {
    MEMBER("examples", described, 0, "All of them, by name", .type = "[#ExampleItem]"),
};
const member_table examples_members = { MEMBER_TABLE("ExampleList", list_members) };

static bf_status write_item(json_out *w, const example *of, bf_error *err)
{
    bf_faults faults = { .n = 0 };
    json_in in = json_in_to(&faults);
    item view;

    json_t *document = json_in_parse(&in, of->document, of->n);
    if (document == NULL)
        return json_in_status(&in, err);
    snprintf(view.name, sizeof view.name, "%s", of->name);
    view.title = json_string_value(json_object_get(document, "name"));
    members_write(w, &examples_item_members, &view);
    json_in_free(document);
    return BF_OK;
}

bf_status examples_write(bf_buffer *out, bf_error *err)
{
    json_out w = json_out_to(out);
    bf_status status = BF_OK;

    json_out_object(&w);
    json_out_key(&w, "examples");
    json_out_array(&w);
    for (const example *at = examples__list; at->name != NULL && status == BF_OK; at++)
        status = write_item(&w, at, err);
    json_out_array_end(&w);
    json_out_object_end(&w);
    return status == BF_OK ? json_out_status(&w, err) : status;
}
