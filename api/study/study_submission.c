#include "api/study/study_submission.h"

#include "api/json/json_out.h"
#include "api/study/study_document.h"
#include "api/study/study_priv.h"
#include "api/study/study_trial.h"

#include <jansson.h>
#include <stdio.h>
#include <string.h>

const char study_submission_curve[] = "curve";

// Puts what a stored curve consists of in the place of its id; else a fault is noted.
static void fill_curve(json_in *in, json_t *curve)
{
    json_t *id = json_object_get(curve, "measurement"), *lists = NULL;
    bf_buffer text = { 0 };

    // What stands beside the id is refused when the members are read.
    if (id == NULL || json_object_get(curve, "t_s") != NULL)
        return;
    const size_t mark = json_pointer_enter(&in->pointer, "measurement", strlen("measurement"));
    if (json_in_stored_text(in, id, study_submission_curve, &text))
        lists = json_in_parse(in, text.bytes, text.n);
    json_pointer_leave(&in->pointer, mark);
    if (lists != NULL) {
        in->has_failed |= json_object_update(curve, lists) != 0;
        (void)json_object_del(curve, "measurement");
    }
    json_in_free(lists);
    buffer_fini(&text);
}

static void fill_curves(json_in *in, json_t *root)
{
    json_t *curve;
    size_t k;

    const size_t mark = json_pointer_enter(&in->pointer, "curves", strlen("curves"));
    json_array_foreach(json_object_get(root, "curves"), k, curve)
    {
        const size_t inner = json_pointer_enter_index(&in->pointer, k);
        if (k < STUDY_DOCUMENT_CURVES)
            fill_curve(in, curve);
        json_pointer_leave(&in->pointer, inner);
    }
    json_pointer_leave(&in->pointer, mark);
}

// Puts the text of a stored profile or schedule in the place of its id, in a document that was read with it.
static void fill_feed(json_in *in, json_t *feed, const char *kind)
{
    json_t *object = json_object_get(feed, kind);
    json_t *id = json_object_get(object, "measurement");
    bf_buffer text = { 0 };

    if (id == NULL || !json_in_stored_text(in, id, kind, &text))
        return;
    in->has_failed |= json_object_set_new(object, "csv", json_stringn(text.bytes, text.n)) != 0;
    (void)json_object_del(object, "measurement");
    buffer_fini(&text);
}

static void write_tree(json_out *w, json_t *value)
{
    json_t *item;
    const char *key;
    size_t k;

    switch (json_typeof(value)) {
    case JSON_OBJECT:
        json_out_object(w);
        json_object_foreach(value, key, item)
        {
            json_out_key(w, key);
            write_tree(w, item);
        }
        json_out_object_end(w);
        return;
    case JSON_ARRAY:
        json_out_array(w);
        json_array_foreach(value, k, item) write_tree(w, item);
        json_out_array_end(w);
        return;
    case JSON_STRING:
        json_out_string(w, json_string_value(value));
        return;
    case JSON_NULL:
        json_out_null(w);
        return;
    case JSON_TRUE:
    case JSON_FALSE:
        json_out_bool(w, json_is_true(value));
        return;
    case JSON_INTEGER:
    case JSON_REAL:
        json_out_number(w, json_number_value(value));
    }
}

static bf_status make_submission(const study_document *d, json_t *root,
                                 api_study_submission *ret_submission, bf_error *err)
{
    api_study_submission made = { .method = d->method.type,
                                  .model = d->model,
                                  .priority = d->priority,
                                  .trials_max = d->trials_max };
    json_out w = json_out_to(&made.document);
    study_columns columns;

    snprintf(made.name, sizeof made.name, "%s", d->name);
    snprintf(made.line, sizeof made.line, "%s", d->line);
    study_columns_of(d, &columns);
    write_tree(&w, root);
    bf_status status = json_out_status(&w, err);
    if (status == BF_OK)
        status = study_columns_write(&columns, &made.columns, err);
    if (status == BF_OK)
        *ret_submission = made;
    else
        study_submission_fini(&made);
    return status;
}

bf_status study_submission_read(const char *json, size_t n, json_in_texts *texts,
                                api_study_submission *ret_submission, bf_faults *faults,
                                bf_error *err)
{
    json_in in = json_in_to(faults);
    json_t *root = json_in_parse(&in, json, n);
    study_document d;

    in.texts = texts;
    if (root == NULL)
        return json_in_status(&in, err);
    fill_curves(&in, root);
    bf_status status = study__read_tree(&in, root, &d, err);
    if (status == BF_OK) {
        const json_t *feeds = json_object_get(d.scenario, "feeds");
        for (size_t k = 0; k < json_array_size(feeds); k++) {
            fill_feed(&in, json_array_get(feeds, k), "profile");
            fill_feed(&in, json_array_get(feeds, k), "schedule");
        }
        status = json_in_status(&in, err);
        if (status == BF_OK)
            status = make_submission(&d, root, ret_submission, err);
        study_document_fini(&d);
    }
    json_in_free(root);
    return status;
}

void study_submission_fini(api_study_submission *submission)
{
    if (submission == NULL)
        return;
    buffer_fini(&submission->document);
    buffer_fini(&submission->columns);
    *submission = (api_study_submission){ .name = "" };
}
