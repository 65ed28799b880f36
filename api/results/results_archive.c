#include "api/results/results_archive.h"

#include "api/results/results.h"
#include "api/results/zip_out.h"
#include "core/base/check.h"
#include "core/base/memory.h"

#include <string.h>

enum {
    SLICE_BYTES = 64 * 1024,      // deflated per call
    TURN_BYTES = 4 * 1024 * 1024, // of files read for one chunk: empty belts deflate to nothing
};

// The body's state.
typedef struct archive {
    char id[API_ID_SIZE];
    bool has_summary;
    bool has_vtk;
    api_snapshot_list list;
    bf_buffer eyes; // photo_eyes.csv; empty: there is none
    zip_out *zip;
    size_t kind;       // of the next file, in kinds
    uint64_t index;    // of the next file of that kind
    bf_buffer content; // of the current file
    size_t n_appended; // bytes of it that were deflated
    bool is_over;
} archive;

typedef bf_status content_writer(const archive *a, const api_services *services, uint64_t index,
                                 bf_buffer *out, bf_error *err);

// One snapshot as the services return it.
typedef struct grid_content {
    api_snapshot snapshot;
    bf_grid grid;
    bf_buffer bytes;
} grid_content;

typedef struct parts_content {
    api_snapshot snapshot;
    api_parts parts;
    bf_buffer bytes;
} parts_content;

static const float *floats_of(const grid_content *c)
{
    return (const float *)(const void *)c->bytes.bytes;
}

static const double *doubles_of(const parts_content *c)
{
    return (const double *)(const void *)c->bytes.bytes;
}

static bf_status write_scenario(const archive *a, const api_services *services, uint64_t index,
                                bf_buffer *out, bf_error *err)
{
    (void)index;
    return services->read_text(services->context, a->id, API_TEXT_SCENARIO, out, err);
}

static bf_status write_summary(const archive *a, const api_services *services, uint64_t index,
                               bf_buffer *out, bf_error *err)
{
    (void)index;
    return services->read_text(services->context, a->id, API_TEXT_SUMMARY, out, err);
}

static bf_status write_curve(const archive *a, const api_services *services, uint64_t index,
                             bf_buffer *out, bf_error *err)
{
    api_curve curve = { 0 };

    (void)index;
    bf_status status = services->read_curve(services->context, a->id, 0, &curve, err);
    if (status != BF_OK)
        return status;
    status = results_curve_csv(&curve, out, err);
    api_curve_fini(&curve);
    return status;
}

static bf_status write_photo_eyes(const archive *a, const api_services *services, uint64_t index,
                                  bf_buffer *out, bf_error *err)
{
    (void)services;
    (void)index;
    if (buffer_append(out, a->eyes.bytes, a->eyes.n) == BF_OK)
        return BF_OK;
    return bf_fail(err, BF_ENOMEM, "", "out of memory");
}

static bf_status write_list(const archive *a, const api_services *services, uint64_t index,
                            bf_buffer *out, bf_error *err)
{
    (void)services;
    (void)index;
    return results_snapshots_json(&a->list, NULL, out, err);
}

static bf_status write_snapshots_series(const archive *a, const api_services *services,
                                        uint64_t index, bf_buffer *out, bf_error *err)
{
    (void)services;
    (void)index;
    return results_series_pvd(&a->list, RESULTS_FILES_SNAPSHOT_VTK, out, err);
}

static bf_status write_parts_series(const archive *a, const api_services *services, uint64_t index,
                                    bf_buffer *out, bf_error *err)
{
    (void)services;
    (void)index;
    return results_series_pvd(&a->list, RESULTS_FILES_PARTS_VTK, out, err);
}

static bf_status read_grid(const archive *a, const api_services *services, uint64_t index,
                           grid_content *c, bf_error *err)
{
    return services->read_snapshot(services->context, a->id, index, &c->snapshot, &c->grid,
                                   &c->bytes, err);
}

static bf_status write_snapshot(const archive *a, const api_services *services, uint64_t index,
                                bf_buffer *out, bf_error *err)
{
    grid_content c = { .bytes = { 0 } };

    bf_status status = read_grid(a, services, index, &c, err);
    if (status == BF_OK)
        status = results_npy(floats_of(&c), c.grid.n1, c.grid.n2, out, err);
    buffer_fini(&c.bytes);
    return status;
}

static bf_status write_snapshot_vtk(const archive *a, const api_services *services, uint64_t index,
                                    bf_buffer *out, bf_error *err)
{
    grid_content c = { .bytes = { 0 } };

    bf_status status = read_grid(a, services, index, &c, err);
    if (status == BF_OK)
        status = results_snapshot_vti(floats_of(&c), &c.grid, c.snapshot.t, out, err);
    buffer_fini(&c.bytes);
    return status;
}

static bf_status read_parts(const archive *a, const api_services *services, uint64_t index,
                            parts_content *c, bf_error *err)
{
    return services->read_parts(services->context, a->id, index, &c->snapshot, &c->parts, &c->bytes,
                                err);
}

static bf_status write_parts(const archive *a, const api_services *services, uint64_t index,
                             bf_buffer *out, bf_error *err)
{
    parts_content c = { .bytes = { 0 } };

    bf_status status = read_parts(a, services, index, &c, err);
    if (status == BF_OK)
        status = results_parts_npy(doubles_of(&c), &c.parts, out, err);
    buffer_fini(&c.bytes);
    return status;
}

static bf_status write_parts_vtk(const archive *a, const api_services *services, uint64_t index,
                                 bf_buffer *out, bf_error *err)
{
    parts_content c = { .bytes = { 0 } };

    bf_status status = read_parts(a, services, index, &c, err);
    if (status == BF_OK)
        status = results_parts_vtp(doubles_of(&c), &c.parts, c.snapshot.t, out, err);
    buffer_fini(&c.bytes);
    return status;
}

// What a kind of file needs to be in an archive.
enum { NEEDS_PARTS = 1, NEEDS_VTK = 2, NEEDS_SUMMARY = 4, NEEDS_EYES = 8 };

typedef enum number_of { ONE, ONE_A_SNAPSHOT } number_of;

static const struct {
    results_files file;
    number_of number;
    int needs;
    content_writer *write;
} kinds[] = {
    { RESULTS_FILES_SCENARIO, ONE, 0, write_scenario },
    { RESULTS_FILES_CURVE, ONE, 0, write_curve },
    { RESULTS_FILES_PHOTO_EYES, ONE, NEEDS_EYES, write_photo_eyes },
    { RESULTS_FILES_SNAPSHOTS, ONE, 0, write_list },
    { RESULTS_FILES_SNAPSHOT, ONE_A_SNAPSHOT, 0, write_snapshot },
    { RESULTS_FILES_PARTS, ONE_A_SNAPSHOT, NEEDS_PARTS, write_parts },
    { RESULTS_FILES_SNAPSHOTS_SERIES, ONE, NEEDS_VTK, write_snapshots_series },
    { RESULTS_FILES_SNAPSHOT_VTK, ONE_A_SNAPSHOT, NEEDS_VTK, write_snapshot_vtk },
    { RESULTS_FILES_PARTS_SERIES, ONE, NEEDS_VTK | NEEDS_PARTS, write_parts_series },
    { RESULTS_FILES_PARTS_VTK, ONE_A_SNAPSHOT, NEEDS_VTK | NEEDS_PARTS, write_parts_vtk },
    { RESULTS_FILES_SUMMARY, ONE, NEEDS_SUMMARY, write_summary },
};

enum { N_KINDS = sizeof kinds / sizeof *kinds };

_Static_assert(sizeof kinds / sizeof *kinds == RESULTS_FILES_COUNT,
               "an archive can hold every file");

static uint64_t count_files(const archive *a, size_t kind)
{
    int missing = (a->list.parts.n_values == 0 ? NEEDS_PARTS : 0) | (a->has_vtk ? 0 : NEEDS_VTK) |
                  (a->has_summary ? 0 : NEEDS_SUMMARY) | (a->eyes.n > 0 ? 0 : NEEDS_EYES);

    if ((kinds[kind].needs & missing) != 0)
        return 0;
    return kinds[kind].number == ONE ? 1 : a->list.n;
}

// Moves on to a kind that has a file left. False: there is none.
static bool find_file(archive *a)
{
    while (a->kind < N_KINDS && a->index >= count_files(a, a->kind)) {
        a->kind++;
        a->index = 0;
    }
    return a->kind < N_KINDS;
}

static bf_status begin_file(archive *a, const api_services *services, bf_buffer *out, bf_error *err)
{
    char name[RESULTS_FILES_NAME_SIZE];

    a->content.n = a->n_appended = 0;
    bf_status status = kinds[a->kind].write(a, services, a->index, &a->content, err);
    if (status != BF_OK)
        return status;
    (void)results_files_name(kinds[a->kind].file, a->index++, name);
    return zip_out_file(a->zip, name, a->content.n, out, err);
}

static bf_status append_slice(archive *a, bf_buffer *out, bf_error *err)
{
    size_t n = a->content.n - a->n_appended;

    n = n < SLICE_BYTES ? n : SLICE_BYTES;
    bf_status status = zip_out_bytes(a->zip, a->content.bytes + a->n_appended, n, out, err);
    a->n_appended += n;
    return status;
}

static bf_status next_chunk(void *state, const api_services *services, size_t limit_bytes,
                            bf_buffer *out, body_state *ret_state, bf_error *err)
{
    archive *a = state;
    size_t start = out->n;
    bf_status status = BF_OK;

    for (size_t n_read = 0;
         status == BF_OK && !a->is_over && n_read < TURN_BYTES && out->n - start < limit_bytes;
         n_read += SLICE_BYTES) {
        if (a->n_appended < a->content.n) {
            status = append_slice(a, out, err);
        } else if (find_file(a)) {
            status = begin_file(a, services, out, err);
        } else {
            status = zip_out_finish(a->zip, out, err);
            a->is_over = true;
        }
    }
    if (status == BF_OK)
        *ret_state = a->is_over ? BODY_DONE : BODY_MORE;
    return status;
}

static void destroy(void *state)
{
    archive *a = state;

    if (a == NULL)
        return;
    zip_out_destroy(a->zip);
    buffer_fini(&a->list.items);
    buffer_fini(&a->eyes);
    buffer_fini(&a->content);
    memory_free(a);
}

// Reads the changes of photo eyes, where the columns of the curve say that there are some.
static bf_status read_photo_eyes(archive *a, const api_run *of, const api_services *services,
                                 bf_error *err)
{
    results_changes changes = { 0 };
    api_curve curve = { 0 };

    bf_status status = services->read_curve(services->context, a->id, of->n_samples, &curve, err);
    if (status == BF_OK && curve.columns.n > 0 && strstr(curve.columns.bytes, ".blocked") != NULL)
        status = results_changes_read(services, a->id, &changes, err);
    if (status == BF_OK && changes.eyes.n > 0)
        status = results_changes_csv(&changes, &a->eyes, err);
    results_changes_fini(&changes);
    api_curve_fini(&curve);
    return status;
}

bf_status results_archive_open(const api_run *of, results_archive_kind kind,
                               const api_services *services, body_source *ret_source, bf_error *err)
{
    archive *a = memory_alloc(1, sizeof *a);

    BF_CHECK(run_state_is_end(of->state));
    if (a == NULL)
        return bf_fail(err, BF_ENOMEM, "", "out of memory");
    memcpy(a->id, of->id, sizeof a->id);
    a->has_summary = of->has_summary;
    a->has_vtk = kind == RESULTS_ARCHIVE_VTK;
    bf_status status = services->list_snapshots(services->context, a->id, &a->list, err);
    if (status == BF_OK)
        status = read_photo_eyes(a, of, services, err);
    if (status == BF_OK)
        status = zip_out_create(of->finished_ms / 1000, &a->zip, err);
    if (status != BF_OK) {
        destroy(a);
        return status;
    }
    *ret_source = (body_source){ .state = a, .next_chunk = next_chunk, .destroy = destroy };
    return BF_OK;
}
