#include "api/study/study_trial.h"

#include "api/results/run_json.h"

#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

void study_columns_of(const study_document *d, study_columns *ret_columns)
{
    ret_columns->n_parameters = d->n_parameters;
    ret_columns->n_values = study_document_definition(d).n_values;
    for (size_t k = 0; k < ret_columns->n_parameters; k++)
        snprintf(ret_columns->parameters[k], sizeof *ret_columns->parameters, "%s",
                 d->parameters[k].pointer);
    for (size_t k = 0; k < ret_columns->n_values; k++)
        study_document_column(d, k, ret_columns->values[k]);
}

void study_trial_of(const study_document *d, const study *s, size_t number, api_trial *ret_trial)
{
    const study_trial trial = study_trial_at(s, number);
    const study_point point = study_point_at(s, trial.point);

    *ret_trial = (api_trial){ .number = number,
                              .point = trial.point,
                              .model = study_document_model(d, point.model),
                              .substream = d->substream + trial.substream,
                              .state = API_TRIAL_QUEUED,
                              .n_parameters = d->n_parameters,
                              .n_values = study_document_definition(d).n_values };
    for (size_t k = 0; k < d->n_parameters; k++)
        ret_trial->parameters[k] = study_document_value(&d->parameters[k], point.at[k]);
    for (size_t k = 0; k < STUDY_VALUES; k++)
        ret_trial->values[k] = (double)NAN;
}

// ---- the columns

static void write_names(json_out *w, const char *key, const char *names, size_t size, size_t n)
{
    json_out_key(w, key);
    json_out_array(w);
    for (size_t k = 0; k < n; k++)
        json_out_string(w, names + k * size);
    json_out_array_end(w);
}

bf_status study_columns_write(const study_columns *columns, bf_buffer *out, bf_error *err)
{
    json_out w = json_out_to(out);

    json_out_object(&w);
    write_names(&w, "parameters", columns->parameters[0], sizeof *columns->parameters,
                columns->n_parameters);
    write_names(&w, "values", columns->values[0], sizeof *columns->values, columns->n_values);
    json_out_object_end(&w);
    return json_out_status(&w, err);
}

// False: it is not a list of at most `most` names of fewer bytes than size.
static bool read_names(const json_t *list, char *names, size_t size, size_t most, size_t *ret_n)
{
    const size_t n = json_array_size(list);

    for (size_t k = 0; k < n && k < most; k++) {
        const char *name = json_string_value(json_array_get(list, k));
        if (name == NULL || strlen(name) >= size)
            return false;
        memcpy(names + k * size, name, strlen(name) + 1);
    }
    *ret_n = n;
    return json_is_array(list) && n <= most;
}

bf_status study_columns_read(const char *json, size_t n, study_columns *ret_columns, bf_error *err)
{
    bf_faults faults = { 0 };
    json_in in = json_in_to(&faults);
    json_t *root = json_in_parse(&in, json, n);
    study_columns columns;

    if (in.has_failed)
        return json_in_status(&in, err);
    const bool is_read =
        read_names(json_object_get(root, "parameters"), columns.parameters[0],
                   sizeof *columns.parameters, STUDY_PARAMETERS, &columns.n_parameters) &&
        read_names(json_object_get(root, "values"), columns.values[0], sizeof *columns.values,
                   STUDY_VALUES, &columns.n_values) &&
        columns.n_values >= 1;
    json_in_free(root);
    if (!is_read)
        return bf_fail(err, BF_ECORRUPT, "", "stored columns of trials are damaged");
    *ret_columns = columns;
    return BF_OK;
}

// ---- JSON

static void write_map(json_out *w, const char *names, size_t size, const double *values, size_t n)
{
    json_out_object(w);
    for (size_t k = 0; k < n; k++)
        if (isfinite(values[k]))
            json_out_key_number(w, names + k * size, values[k]);
    json_out_object_end(w);
}

static void write_parameters(json_out *w, const member *m, const void *item)
{
    const study_trial_item *of = item;

    (void)m;
    write_map(w, of->columns->parameters[0], sizeof *of->columns->parameters, of->trial.parameters,
              of->columns->n_parameters);
}

static void write_values(json_out *w, const member *m, const void *item)
{
    const study_trial_item *of = item;

    (void)m;
    write_map(w, of->columns->values[0], sizeof *of->columns->values, of->trial.values,
              of->columns->n_values);
}

static const member_kind member_parameters = { .type = "#NumbersByName",
                                               .write = write_parameters };
static const member_kind member_values = { .type = "#NumbersByName", .write = write_values };

static bool has_fault(const void *item)
{
    const study_trial_item *of = item;

    return of->trial.fault.code != BF_OK;
}

#define AT(place) offsetof(study_trial_item, trial.place)
static const member members[] = {
    MEMBER("trial", size, AT(number), "Its number, from 0", .type = "#Count"),
    MEMBER("point", size, AT(point), "Number of its point; its replications have the same",
           .type = "#Count"),
    MEMBER("model", enum, AT(model), "Which solver", .words = run_model_words, .type = "#Model"),
    MEMBER("substream", size, AT(substream), "Of its scenario", .type = "#Count"),
    MEMBER("status", enum, AT(state), "State of the trial", .words = api_trial_state_words,
           .type = "#TrialStatus"),
    MEMBER("parameters", parameters, 0, "The numbers of its point, by their pointers"),
    MEMBER("values", values, 0,
           "Its objectives, or of calibrate its mean squares; what its run cannot say is missing"),
    MEMBER("run", text, AT(run), "Its run, which may have been removed since", .type = "#Id",
           .flags = MEMBER_OMIT_EMPTY),
    MEMBER("error", object, AT(fault), "Why it failed or is infeasible", .table = &run_json_error,
           .applies = has_fault),
};
#undef AT
const member_table study_trial_members = { MEMBER_TABLE("Trial", members),
                                           .size = sizeof(study_trial_item) };
