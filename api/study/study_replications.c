#include "api/study/study_replications.h"

#include "api/json/json_out.h"
#include "api/study/study_priv.h"
#include "api/study/study_submission.h"
#include "core/base/memory.h"
#include "core/observe/figure.h"

#include <stdio.h>

// The first one is the objective.
static const figure_id values[] = { FIGURE_SUSTAINED, FIGURE_RESIDENCE_MEAN, FIGURE_RESIDENCE_P95,
                                    FIGURE_JAM_COUNT, FIGURE_QUEUE_END };

static bf_status write_document(const api_submission *base, bf_buffer *out, bf_error *err)
{
    json_out w = json_out_to(out);

    json_out_object(&w);
    // Names are cut to whole characters.
    char name[STUDY_DOCUMENT_NAME];
    const char *whole = base->label[0] != '\0' ? base->label : base->name;
    int n = snprintf(name, sizeof name, "%s", whole);
    if (n >= (int)sizeof name) {
        size_t end = sizeof name - 1;
        while (end > 0 && ((unsigned char)whole[end] & 0xC0) == 0x80)
            end--;
        name[end] = '\0';
    }
    json_out_key_string(&w, "name", name);
    if (base->line[0] != '\0')
        json_out_key_string(&w, "line", base->line);
    json_out_key(&w, "base");
    json_out_object(&w);
    json_out_key(&w, "scenario");
    json_out_raw(&w, base->scenario.bytes, base->scenario.n);
    json_out_key_string(&w, "model", run_model_words[base->model]);
    json_out_object_end(&w);
    json_out_key(&w, "parameters");
    json_out_array(&w);
    json_out_array_end(&w);
    json_out_key(&w, "objectives");
    char word[MEMBER_TEXT_SIZE];
    json_out_array(&w);
    for (size_t k = 0; k < sizeof values / sizeof *values; k++) {
        if (base->model == RUN_MACRO && (figure_table[values[k]].models & FIGURE_BY_DENSITY) == 0)
            continue;
        study__figure_word(values[k], word);
        json_out_object(&w);
        json_out_key_string(&w, "figure", word);
        json_out_key_string(&w, "goal", k == 0 ? "maximize" : "minimize");
        json_out_object_end(&w);
    }
    json_out_array_end(&w);
    json_out_key(&w, "method");
    json_out_object(&w);
    json_out_key_string(&w, "type", study_document_methods[STUDY_LIST]);
    json_out_object_end(&w);
    json_out_key_integer(&w, "replications", (int64_t)base->replications);
    json_out_key_integer(&w, "priority", base->priority);
    json_out_object_end(&w);
    return json_out_status(&w, err);
}

bf_status study_replications_make(const api_submission *base, api_study_submission *ret_submission,
                                  bf_error *err)
{
    bf_buffer document = { 0 };
    bf_faults *faults = memory_alloc(1, sizeof *faults);

    bf_status status = faults == NULL ? bf_fail_memory(err) : write_document(base, &document, err);
    if (status == BF_OK)
        status =
            study_submission_read(document.bytes, document.n, NULL, ret_submission, faults, err);
    memory_free(faults);
    buffer_fini(&document);
    return status;
}
