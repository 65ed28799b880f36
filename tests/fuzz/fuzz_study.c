// The document of a study. What is accepted can begin, and its first trials have scenarios or faults.

#include "tests/fuzz/fuzz.h"

#include "api/study/study_best.h"

#include <math.h>
#include <stdlib.h>

enum { TRIALS = 4, TRIALS_MAX = 1000 };

static void make_trial(study_document *d, const study *s, size_t trial)
{
    const study_trial t = study_trial_at(s, trial);
    const study_point p = study_point_at(s, t.point);
    double values[STUDY_VALUES], read[STUDY_VALUES];
    bf_faults faults = { 0 };
    bf_buffer line = { 0 };
    size_t number = 0;
    bf_error err = { 0 };
    scene made;

    for (size_t k = 0; k < STUDY_VALUES; k++)
        values[k] = (double)NAN;
    for (size_t k = 0; k < d->n_parameters; k++)
        fuzz_require(isfinite(study_document_value(&d->parameters[k], p.at[k])),
                     "parameters are numbers");
    if (study_document_scene(d, p.at, t.substream, study_document_model(d, p.model), &made, &faults,
                             &err) == BF_OK)
        scene_fini(&made);
    fuzz_require(study_best_csv_line(d, s, trial, STUDY_TRIAL_FAILED, values, err.text, &line,
                                     &err) == BF_OK &&
                     study_best_csv_read(d, line.bytes, line.n, &number, read) && number == trial,
                 "the line of a trial can be read");
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
