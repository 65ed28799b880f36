// The body of POST /v1/runs. What is accepted has a resolved document that reads back to the same document.

#include "tests/fuzz/fuzz.h"

#include "api/scenario/scenario.h"
#include "api/scenario/submission.h"

#include <stdlib.h>
#include <string.h>

static void read_back(const bf_buffer *document)
{
    bf_error err;
    bf_buffer again = { 0 };
    scene s;

    const bool is_read = scenario_read_resolved(document->bytes, document->n, &s, &err) == BF_OK;
    fuzz_require(is_read, "a resolved document can be read");
    fuzz_require(scenario_write(&s, &again, &err) == BF_OK, "and written");
    fuzz_require(again.n == document->n && memcmp(again.bytes, document->bytes, again.n) == 0,
                 "and is the same");
    scene_fini(&s);
    buffer_fini(&again);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t n)
{
    api_submission submission;
    bf_faults faults = { 0 };
    bf_error err;
    char *text = fuzz_text(bytes, n);

    if (submission_read(text, n, NULL, &submission, &faults, &err) == BF_OK) {
        read_back(&submission.scenario);
        submission_fini(&submission);
    }
    free(text);
    return 0;
}
