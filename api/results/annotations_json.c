#include "api/results/annotations_json.h"

#include <jansson.h>

static void read_text_or_null(json_in *in, const json_t *value, const member *m, void *item)
{
    if (json_is_null(value))
        ((char *)item)[m->offset] = '\0';
    else
        member_text.read(in, value, m, item);
}

static const member_kind member_patched_text = { .text = "string or null",
                                                 .type = "string?",
                                                 .read = read_text_or_null };

static void read_flag_or_null(json_in *in, const json_t *value, const member *m, void *item)
{
    if (json_is_null(value))
        *(bool *)((char *)item + m->offset) = false;
    else
        member_bool.read(in, value, m, item);
}

static const member_kind member_patched_flag = { .text = "boolean or null",
                                                 .type = "boolean?",
                                                 .read = read_flag_or_null };

#define TEXT(name_, place, size, help_)                                                            \
    MEMBER(name_, patched_text, offsetof(api_annotations, place), help_, .limit = (size),          \
           .default_text = "as it is")
static const member run_members[] = {
    TEXT("name", name, SCENE_NAME_SIZE, "what it is called; the scenario keeps its own name"),
    TEXT("label", label, API_LABEL_SIZE, "what it is found by"),
    TEXT("line", line, API_LABEL_SIZE, "the line that it belongs to"),
    TEXT("notes", notes, API_NOTES_SIZE, "what is worth knowing of it"),
    MEMBER("starred", patched_flag, offsetof(api_annotations, is_starred),
           "whether it is to be found again by `?starred=1`", .default_text = "as it is"),
};
static const member study_members[] = {
    TEXT("name", name, API_STUDY_NAME_SIZE, "what it is called; the document keeps its own name"),
    TEXT("line", line, API_LABEL_SIZE, "the line that it belongs to"),
};
#undef TEXT

const member_table annotations_json_run = { MEMBER_TABLE("runAnnotations", run_members),
                                            .size = sizeof(api_annotations) };
const member_table annotations_json_study = { MEMBER_TABLE("studyAnnotations", study_members),
                                              .size = sizeof(api_annotations) };

bf_status annotations_json_read(const char *json, size_t n, const member_table *table,
                                api_annotations *annotations, bf_faults *faults, bf_error *err)
{
    json_in in = json_in_to(faults);
    api_annotations changed = *annotations;
    json_t *root = json_in_parse(&in, json, n);

    if (root != NULL)
        members_read(&in, root, table, &changed);
    json_in_free(root);
    BF_TRY(json_in_status(&in, err));
    *annotations = changed;
    return BF_OK;
}
