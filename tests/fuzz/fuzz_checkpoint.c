// Checkpoints that were changed, with digests that fit, for a run of each solver. The input's first byte says which; each
// further five are an edit of the solver's own checkpoint: an operation, an offset and a value. Reading one may fail.

#include "tests/fuzz/fuzz.h"

#include "api/scenario/scenario.h"
#include "core/run/run.h"

#include <stdlib.h>
#include <string.h>

#define CARGO                                                                                      \
    "\"cargo\":{\"shape\":{\"type\":\"cylinder\",\"radius_m\":0.012,\"height_m\":0.008},"          \
    "\"mass_kg\":0.02841}"
#define DOMAIN "\"duration_s\":0.1,\"domain\":{\"x_m\":[0,0.4],\"y_m\":[0,0.2]}"
#define HEAP   "\"initial\":{\"positions_m\":[[0.1,0.1],[0.15,0.1]]}"
#define FEED   "\"feeds\":[{\"id\":\"in\",\"edge\":\"west\",\"rate_per_s\":20}]"
#define CELLS  "\"macro\":{\"cell_m\":0.02,\"step_s\":\"auto\"}"
#define MICRO(integrator, path)                                                                    \
    "\"micro\":{\"integrator\":\"" integrator "\",\"path\":\"" path "\"}"

typedef struct fuzz_solver {
    run_model model;
    const char *scenario;
    bf_buffer checkpoint; // of a run in the middle; made when it is first needed
} fuzz_solver;

static fuzz_solver solvers[] = {
    { RUN_MACRO, "{" DOMAIN "," CARGO "," HEAP "," CELLS "}", { 0 } },
    { RUN_MACRO, "{" DOMAIN "," CARGO "," FEED "," CELLS "}", { 0 } },
    { RUN_MICRO, "{" DOMAIN "," CARGO "," HEAP "," MICRO("verlet", "planar") "}", { 0 } },
    { RUN_MICRO, "{" DOMAIN "," CARGO "," HEAP "," MICRO("implicit", "spatial") "}", { 0 } },
    { RUN_MICRO, "{" DOMAIN "," CARGO "," FEED "," MICRO("implicit", "planar") "}", { 0 } },
};

enum { EDIT_BYTES = 5 };

static bf_status take_checkpoint(void *context, const frame *f, bf_error *err)
{
    bf_buffer *checkpoint = context;

    if (f->type != FRAME_CHECKPOINT)
        return BF_OK;
    checkpoint->n = 0;
    return buffer_append(checkpoint, f->bytes.bytes, f->bytes.n);
}

static unsigned request_checkpoint(void *context)
{
    return RUN_CHECKPOINT;
}

static void read_scene(const fuzz_solver *solver, scene *ret_scene)
{
    bf_faults faults = { 0 };
    bf_error err;

    fuzz_require(scenario_read(solver->scenario, strlen(solver->scenario), ret_scene, &faults,
                               &err) == BF_OK,
                 "the scenario of the solver");
}

static void make_checkpoint(fuzz_solver *solver)
{
    const run_sink sink = { &solver->checkpoint, take_checkpoint, request_checkpoint };
    run *r = NULL;
    scene s;
    bf_error err;

    read_scene(solver, &s);
    fuzz_require(run_create(&s, solver->model, 1, &r, &err) == BF_OK, "a run of it");
    fuzz_require(run_execute(r, &sink, &err) == BF_OK && solver->checkpoint.n > 0, "a checkpoint");
    run_destroy(r);
    scene_fini(&s);
}

// Make one edit: set, add to or flip bits of a byte, set a word of eight bytes, or shorten.
static size_t edit(const uint8_t *how, uint8_t *bytes, size_t n)
{
    const size_t at = (how[1] | (size_t)how[2] << 8) % n;
    const uint64_t words[] = { 0, 1, UINT32_MAX, INT64_MAX, UINT64_MAX, how[3], how[4] };

    switch (how[0] % 5) {
    case 0:
        bytes[at] = how[3];
        return n;
    case 1:
        bytes[at] = (uint8_t)(bytes[at] + how[3]);
        return n;
    case 2:
        bytes[at] ^= how[3];
        return n;
    case 3:
        if (n - at >= sizeof *words)
            memcpy(bytes + at, &words[how[3] % (sizeof words / sizeof *words)], sizeof *words);
        return n;
    default:
        return at + 1;
    }
}

static void resume(const fuzz_solver *solver, const uint8_t *bytes, size_t n)
{
    scene s;
    bf_error err;
    run *r = NULL;

    read_scene(solver, &s);
    const bf_status status = run_resume(&s, solver->model, 1, bytes, n, &r, &err);

    fuzz_require(status == BF_OK || status == BF_ECORRUPT, "a checkpoint is taken or damaged");
    run_destroy(r);
    scene_fini(&s);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t n)
{
    if (n == 0)
        return 0;
    fuzz_solver *solver = &solvers[bytes[0] % (sizeof solvers / sizeof *solvers)];
    if (solver->checkpoint.n == 0)
        make_checkpoint(solver);
    size_t n_edited = solver->checkpoint.n;
    uint8_t *copy = (uint8_t *)fuzz_text((const uint8_t *)solver->checkpoint.bytes, n_edited);
    for (size_t k = 1; k + EDIT_BYTES <= n; k += EDIT_BYTES)
        n_edited = edit(bytes + k, copy, n_edited);
    // Reads beyond a shortened one are found on the heap only.
    uint8_t *cut = (uint8_t *)fuzz_text(copy, n_edited);
    if (fuzz_seal_checkpoint(cut, n_edited))
        resume(solver, cut, n_edited);
    free(cut);
    free(copy);
    return 0;
}
