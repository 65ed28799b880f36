// The document of a study. What is accepted can begin, and its first trials have scenarios or faults.

#include "tests/fuzz/fuzz.h"

#include "api/study/study_trial.h"

#include <math.h>
#include <stdlib.h>

enum { TRIALS = 4, TRIALS_MAX = 1000 };

static void make_trial(study_document *d, const study *s, size_t number)
{
    const study_trial t = study_trial_at(s, number);
    const study_point p = study_point_at(s, t.point);
    double values[STUDY_VALUES];
    bf_faults faults = { 0 };
    bf_buffer line = { 0 };
    study_columns columns;
    bf_error err = { 0 };
    api_trial trial;
    size_t read = 0;
    scene made;

    study_columns_of(d, &columns);
    study_trial_of(d, s, number, &trial);
    for (size_t k = 0; k < d->n_parameters; k++)
        fuzz_require(isfinite(trial.parameters[k]), "parameters are numbers");
    if (study_document_scene(d, p.at, t.substream, trial.model, &made, &faults, &trial.fault) ==
        BF_OK)
        scene_fini(&made);
    fuzz_require(study_trial_csv_line(&trial, &line, &err) == BF_OK &&
                     study_trial_csv_read(&columns, line.bytes, line.n, &read, values) &&
                     read == number,
                 "the line of a trial can be read");
    line.n = 0;
    fuzz_require(study_columns_write(&columns, &line, &err) == BF_OK &&
                     study_columns_read(line.bytes, line.n, &columns, &err) == BF_OK,
                 "its columns can be read");
    buffer_fini(&line);
}

static void begin(study_document *d)
{
    const study_definition definition = study_document_definition(d);
    study *s = NULL;
    bf_error err;

    fuzz_require(study_create(&definition, &s, &err) == BF_OK, "a study within its limits");
    // Points of large sweeps need time, and are those of small ones.
    if (definition.n_trials_max <= TRIALS_MAX) {
        fuzz_require(study_advance(s, &err) == BF_OK && study_trials(s) > 0, "it begins");
        for (size_t trial = 0; trial < study_trials(s) && trial < TRIALS; trial++)
            make_trial(d, s, trial);
    }
    study_destroy(s);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t n)
{
    study_document document;
    bf_faults faults = { 0 };
    bf_error err = { 0 };
    char *text = fuzz_text(bytes, n);

    if (study_document_read(text, n, &document, &faults, &err) == BF_OK) {
        begin(&document);
        study_document_fini(&document);
    }
    free(text);
    return 0;
}
