// A feed's profile and list of arrivals as CSV, in a scenario: the input's first byte says which of them it is.

#include "tests/fuzz/fuzz.h"

#include "api/scenario/scenario.h"

#include <jansson.h>
#include <stdlib.h>
#include <string.h>

static const char *const member[] = { "profile", "schedule" };

static json_t *scenario_with(const char *word, const char *csv, size_t n)
{
    return json_pack("{s:f, s:{s:[ff], s:[ff]}, s:{s:s}, s:[{s:s, s:{s:{s:s, s:f, s:f}, s:f}}],"
                     " s:[{s:s, s:s, s:s%}]}",
                     "duration_s", 60.0, "domain", "x_m", 0.0, 1.0, "y_m", 0.0, 0.6, "edges",
                     "west", "inflow", "cargo", "id", "box", "shape", "type", "cylinder",
                     "radius_m", 0.012, "height_m", 0.008, "mass_kg", 0.03, "feeds", "id", "in",
                     "edge", "west", word, csv, n);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t n)
{
    scene s;
    bf_faults faults = { 0 };
    bf_error err;

    if (n == 0)
        return 0;
    // NULL where the CSV is no UTF-8: then there is no such document.
    json_t *scenario = scenario_with(member[bytes[0] % 2], (const char *)bytes + 1, n - 1);
    char *text = scenario == NULL ? NULL : json_dumps(scenario, 0);
    json_decref(scenario);
    if (text != NULL && scenario_read(text, strlen(text), &s, &faults, &err) == BF_OK)
        scene_fini(&s);
    free(text);
    return 0;
}
