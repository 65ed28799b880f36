// A feed's profile and list of arrivals as CSV, in a scenario: the input's first byte says which of them it is.

#include "tests/fuzz/fuzz.h"

#include "api/scenario/scenario.h"

#include <jansson.h>
#include <stdlib.h>
#include <string.h>

#define BEFORE                                                                                     \
    "{\"duration_s\":60,\"domain\":{\"x_m\":[0,1],\"y_m\":[0,0.6]},"                               \
    "\"cargo\":[{\"id\":\"box\",\"shape\":{\"type\":\"cylinder\",\"radius_m\":0.012,"              \
    "\"height_m\":0.008},\"mass_kg\":0.03}],\"feeds\":[{\"id\":\"in\",\"edge\":\"west\","

static const char *const members[] = { "profile", "schedule" };

static void read_scenario(const char *member, const char *csv)
{
    scene s;
    bf_faults faults = { 0 };
    bf_error err;
    bf_buffer text = { 0 };

    const bf_status written = buffer_printf(&text, BEFORE "\"%s\":{\"csv\":%s}}]}", member, csv);
    fuzz_require(written == BF_OK, "memory for a scenario");
    if (scenario_read(text.bytes, text.n, &s, &faults, &err) == BF_OK)
        scene_fini(&s);
    else
        fuzz_require(faults_kept(&faults) > 0 && strncmp(faults.items[0].pointer, "/feeds", 6) == 0,
                     "what is at fault is the feed");
    buffer_fini(&text);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t n)
{
    // No document has a zero byte in a text.
    if (n == 0 || memchr(bytes + 1, '\0', n - 1) != NULL)
        return 0;
    // NULL where the CSV is no UTF-8: then there is no such document either.
    json_t *csv = json_stringn((const char *)bytes + 1, n - 1);
    char *quoted = csv == NULL ? NULL : json_dumps(csv, JSON_ENCODE_ANY);
    json_decref(csv);
    if (quoted != NULL)
        read_scenario(members[bytes[0] % 2], quoted);
    free(quoted);
    return 0;
}
