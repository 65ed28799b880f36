#include "api/results/kinds.h"

#include "api/scenario/scenario.h"
#include "core/base/memory.h"
#include "core/observe/frame.h"
#include "core/scene/mix.h"

#include <stdbool.h>
#include <string.h>

// True if a resolved document, which has no blanks, lists kinds of cargo: most do not, and large ones need not be read
// then. Inside a string the quotes would be escaped.
static bool is_mix(const char *scenario, size_t n_scenario)
{
    static const char mark[] = "\"cargo\":[";

    return n_scenario > 0 && memmem(scenario, n_scenario, mark, sizeof mark - 1) != NULL;
}

bf_status kinds_find(const char *scenario, size_t n_scenario, const api_parts *parts,
                     part_kinds *ret_kinds, bf_error *err)
{
    part_kinds kinds = { 0 };
    scene s;

    *ret_kinds = kinds;
    if (parts->n_values == 0 || frame_has_ids(parts->n_values) || !is_mix(scenario, n_scenario))
        return BF_OK;
    BF_TRY(scenario_read_resolved(scenario, n_scenario, &s, err));
    bf_status status = mix_draw(&s, parts->n_parts, &kinds.of, err);
    kinds.n = kinds.of == NULL ? 0 : parts->n_parts;
    scene_fini(&s);
    if (status == BF_OK)
        *ret_kinds = kinds;
    return status;
}

void kinds_fini(part_kinds *kinds)
{
    memory_free(kinds->of);
    *kinds = (part_kinds){ 0 };
}
