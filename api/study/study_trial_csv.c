// Trials as lines of CSV.

#include "api/study/study_trial.h"

#include "api/json/number.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

static bf_status append_text(bf_buffer *out, const char *text)
{
    if (strpbrk(text, ",\"\r\n") == NULL)
        return buffer_printf(out, "%s", text);
    BF_TRY(buffer_printf(out, "\""));
    for (const char *at = text; *at != '\0'; at++)
        BF_TRY(buffer_printf(out, *at == '"' ? "\"\"" : "%c", *at == '\n' ? ' ' : *at));
    return buffer_printf(out, "\"");
}

static bf_status append_numbers(bf_buffer *out, const double *values, size_t n)
{
    for (size_t k = 0; k < n; k++) {
        char text[NUMBER_SIZE] = "";
        if (isfinite(values[k]))
            (void)number_format(values[k], text);
        BF_TRY(buffer_printf(out, ",%s", text));
    }
    return BF_OK;
}

static bf_status append_header(bf_buffer *out, const study_columns *columns)
{
    BF_TRY(buffer_printf(out, "trial,point,model,substream"));
    for (size_t k = 0; k < columns->n_parameters; k++) {
        BF_TRY(buffer_printf(out, ","));
        BF_TRY(append_text(out, columns->parameters[k]));
    }
    BF_TRY(buffer_printf(out, ",state"));
    for (size_t k = 0; k < columns->n_values; k++)
        BF_TRY(buffer_printf(out, ",%s", columns->values[k]));
    return buffer_printf(out, ",fault\n");
}

bf_status study_trial_csv_header(const study_columns *columns, bf_buffer *out, bf_error *err)
{
    return append_header(out, columns) == BF_OK ? BF_OK : bf_fail_memory(err);
}

static bf_status append_line(bf_buffer *out, const api_trial *trial)
{
    const bf_error *f = &trial->fault;
    char fault[BF_POINTER_SIZE + BF_TEXT_SIZE + 2] = "";

    if (f->code != BF_OK)
        snprintf(fault, sizeof fault, "%s%s%s", f->pointer, f->pointer[0] != '\0' ? ": " : "",
                 f->text);
    BF_TRY(buffer_printf(out, "%" PRIu64 ",%" PRIu64 ",%s,%" PRIu64, trial->number, trial->point,
                         run_model_words[trial->model], trial->substream));
    BF_TRY(append_numbers(out, trial->parameters, trial->n_parameters));
    BF_TRY(buffer_printf(out, ",%s", api_trial_state_word(trial->state)));
    BF_TRY(append_numbers(out, trial->values, trial->n_values));
    BF_TRY(buffer_printf(out, ","));
    BF_TRY(append_text(out, fault));
    return buffer_printf(out, "\n");
}

bf_status study_trial_csv_line(const api_trial *trial, bf_buffer *out, bf_error *err)
{
    return append_line(out, trial) == BF_OK ? BF_OK : bf_fail_memory(err);
}

bool study_trial_csv_read(const study_columns *columns, const char *line, size_t n,
                          size_t *ret_number, double *ret_values)
{
    const size_t n_before = 4 + columns->n_parameters + 1; // fields before the values
    const char *at = line, *end = line + n;
    double number;

    for (size_t field = 0; field < n_before + columns->n_values; field++) {
        const char *comma = memchr(at, ',', (size_t)(end - at));
        if (comma == NULL)
            return false;
        const size_t n_field = (size_t)(comma - at);
        const bool is_number = number_read(at, n_field, &number) == 0;
        if (field == 0 && (!is_number || number < 0.0 || number >= STUDY_TRIALS_MAX))
            return false;
        if (field == 0)
            *ret_number = (size_t)number;
        if (field >= n_before) {
            if (!is_number && n_field > 0)
                return false;
            ret_values[field - n_before] = n_field > 0 ? number : (double)NAN;
        }
        at = comma + 1;
    }
    return true;
}
