#include "api/results/results_archive.h"

#include "api/results/array_file.h"
#include "api/results/curve_file.h"
#include "api/results/results.h"
#include "api/results/zip_out.h"
#include "core/base/check.h"
#include "core/base/memory.h"

#include <string.h>

enum {
    SLICE_BYTES = 128 * 1024,     // deflated per call
    TURN_BYTES = 4 * 1024 * 1024, // of files read for one chunk: empty belts deflate to nothing
    ZIP_BYTES = 300 * 1024,       // that zip_out takes
    CURVE_VALUES =
        4000000, // numbers of a curve that is made as a whole: longer ones have no size before
};

// The body's state.
typedef struct archive {
    char id[API_ID_SIZE];
    bool has_summary;
    bool has_vtk;
    api_snapshot_list list;
    bf_buffer eyes; // photo_eyes.csv; empty: there is none
    zip_out *zip;
    size_t kind;      // of the next file, in kinds
    uint64_t index;   // of the next file of that kind
    array_file array; // the current file, if it is one; else item_size is 0
    curve_file curve; // curve.csv
    bf_buffer
        content; // of the current file; of an array or a long curve the piece that is being deflated
    uint64_t n_content;  // bytes of the current file
    uint64_t n_appended; // of them that were deflated
    bool is_over;
} archive;

typedef bf_status content_writer(const archive *a, const api_services *services, uint64_t index,
                                 bf_buffer *out, bf_error *err);

static bf_status write_scenario(const archive *a, const api_services *services, uint64_t index,
                                bf_buffer *out, bf_error *err)
{
    (void)index;
    return services->read_text(services->store, a->id, API_TEXT_SCENARIO, out, err);
}

static bf_status write_summary(const archive *a, const api_services *services, uint64_t index,
                               bf_buffer *out, bf_error *err)
{
    (void)index;
    return services->read_text(services->store, a->id, API_TEXT_SUMMARY, out, err);
}

static bf_status write_curve(const archive *a, const api_services *services, uint64_t index,
                             bf_buffer *out, bf_error *err)
{
    api_curve curve = { 0 };

    (void)index;
    BF_TRY(services->read_curve(services->store, a->id, 0, a->curve.n, &curve, err));
    bf_status status = results_curve_csv(&curve, out, err);
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
    return bf_fail_memory(err);
}

static bf_status write_list(const archive *a, const api_services *services, uint64_t index,
                            bf_buffer *out, bf_error *err)
{
    bf_buffer scenario = { 0 };
    part_kinds kinds = { 0 };

    (void)index;
    bf_status status =
        services->read_text(services->store, a->id, API_TEXT_SCENARIO, &scenario, err);
    if (status == BF_OK)
        status = kinds_find(scenario.bytes, scenario.n, &a->list.parts, &kinds, err);
    if (status == BF_OK)
        status = results_snapshots_json(&a->list, NULL, &kinds, out, err);
    kinds_fini(&kinds);
    buffer_fini(&scenario);
    return status;
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

static bf_status write_parts_vtk(const archive *a, const api_services *services, uint64_t index,
                                 bf_buffer *out, bf_error *err)
{
    api_array of;
    bf_buffer rows = { 0 };

    bf_status status =
        services->read_array(services->store, a->id, index, API_ARRAY_PARTS, &of, &rows, err);
    if (status == BF_OK)
        status = results_parts_vtp((const double *)(const void *)rows.bytes, &of.parts,
                                   of.snapshot.t, out, err);
    buffer_fini(&rows);
    return status;
}

// What a kind of file needs to be in an archive.
enum { NEEDS_PARTS = 1, NEEDS_VTK = 2, NEEDS_SUMMARY = 4, NEEDS_EYES = 8 };

typedef enum number_of { ONE, ONE_A_SNAPSHOT } number_of;

static const struct {
    results_files file;
    number_of number;
    int needs;
    content_writer *write; // NULL: it is an array
    array_file_form form;  // of an array
} kinds[] = {
    { RESULTS_FILES_SCENARIO, ONE, 0, write_scenario, 0 },
    { RESULTS_FILES_CURVE, ONE, 0, write_curve, 0 },
    { RESULTS_FILES_PHOTO_EYES, ONE, NEEDS_EYES, write_photo_eyes, 0 },
    { RESULTS_FILES_SNAPSHOTS, ONE, 0, write_list, 0 },
    { RESULTS_FILES_SNAPSHOT, ONE_A_SNAPSHOT, 0, NULL, ARRAY_FILE_NPY },
    { RESULTS_FILES_PARTS, ONE_A_SNAPSHOT, NEEDS_PARTS, NULL, ARRAY_FILE_PARTS_NPY },
    { RESULTS_FILES_SNAPSHOTS_SERIES, ONE, NEEDS_VTK, write_snapshots_series, 0 },
    { RESULTS_FILES_SNAPSHOT_VTK, ONE_A_SNAPSHOT, NEEDS_VTK, NULL, ARRAY_FILE_VTI },
    { RESULTS_FILES_PARTS_SERIES, ONE, NEEDS_VTK | NEEDS_PARTS, write_parts_series, 0 },
    { RESULTS_FILES_PARTS_VTK, ONE_A_SNAPSHOT, NEEDS_VTK | NEEDS_PARTS, write_parts_vtk, 0 },
    { RESULTS_FILES_SUMMARY, ONE, NEEDS_SUMMARY, write_summary, 0 },
};

enum { N_KINDS = sizeof kinds / sizeof *kinds };

_Static_assert(sizeof kinds / sizeof *kinds == RESULTS_FILES_COUNT,
               "an archive can hold every file");

static bool is_long_curve(const archive *a)
{
    return kinds[a->kind].file == RESULTS_FILES_CURVE && a->curve.n_values > CURVE_VALUES;
}

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
    const bool is_array = kinds[a->kind].write == NULL;

    array_file_fini(&a->array);
    a->content.n = 0;
    a->n_appended = 0;
    if (is_array)
        BF_TRY(array_file_open(services, a->id, a->index, kinds[a->kind].form, &a->array, err));
    else if (!is_long_curve(a))
        BF_TRY(kinds[a->kind].write(a, services, a->index, &a->content, err));
    a->n_content = is_array           ? array_file_size(&a->array)
                   : is_long_curve(a) ? ZIP_OUT_ANY_SIZE
                                      : a->content.n;
    (void)results_files_name(kinds[a->kind].file, a->index++, name);
    return zip_out_file(a->zip, name, (size_t)a->n_content, out, err);
}

static bf_status append_slice(archive *a, const api_services *services, bf_buffer *out,
                              bf_error *err)
{
    size_t n = (size_t)(a->n_content - a->n_appended);

    if (a->array.item_size > 0) {
        a->content.n = 0;
        bf_status status =
            array_file_read(&a->array, services, a->n_appended, SLICE_BYTES, &a->content, err);
        a->n_appended += a->content.n;
        return status == BF_OK ? zip_out_bytes(a->zip, a->content.bytes, a->content.n, out, err)
                               : status;
    }
    if (a->n_content == ZIP_OUT_ANY_SIZE) {
        a->content.n = 0;
        bf_status status = curve_file_read(&a->curve, services, &a->content, err);
        a->n_appended += a->content.n;
        if (curve_file_is_over(&a->curve))
            a->n_content = a->n_appended;
        return status == BF_OK ? zip_out_bytes(a->zip, a->content.bytes, a->content.n, out, err)
                               : status;
    }
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
        if (a->n_appended < a->n_content) {
            status = append_slice(a, services, out, err);
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
    array_file_fini(&a->array);
    memory_free(a);
}

// Reads the changes of photo eyes, where the columns of the curve say that there are some.
static bf_status read_photo_eyes(archive *a, const api_run *of, const api_services *services,
                                 bf_error *err)
{
    results_changes changes = { 0 };
    api_curve curve = { 0 };

    bf_status status = services->read_curve(services->store, a->id, of->n_samples, 0, &curve, err);
    if (status == BF_OK && curve.columns.n > 0 && strstr(curve.columns.bytes, ".blocked") != NULL)
        status = results_changes_read(services, a->id, &changes, err);
    if (status == BF_OK && changes.eyes.n > 0)
        status = results_changes_csv(&changes, &a->eyes, err);
    results_changes_fini(&changes);
    api_curve_fini(&curve);
    return status;
}

// What an archive takes of memory: curves that are not long are made as a whole, and VTK files of parts, from their
// rows.
static size_t count_held(const archive *a)
{
    const size_t n_rows = a->list.parts.n_parts * a->list.parts.n_values * sizeof(double);
    const size_t n_values = a->curve.n_values > CURVE_VALUES ? 0 : (size_t)a->curve.n_values;
    const size_t n_curve = 4 * sizeof(double) * n_values, n_parts = a->has_vtk ? 2 * n_rows : 0;

    return ZIP_BYTES + SLICE_BYTES + (n_curve > n_parts ? n_curve : n_parts);
}

bf_status results_archive_open(const api_run *of, results_archive_kind kind,
                               const api_services *services, body_source *ret_source, bf_error *err)
{
    archive *a = memory_alloc(1, sizeof *a);

    BF_CHECK(run_state_is_end(of->state));
    if (a == NULL)
        return bf_fail_memory(err);
    memcpy(a->id, of->id, sizeof a->id);
    a->has_summary = of->has_summary;
    a->has_vtk = kind == RESULTS_ARCHIVE_VTK;
    bf_status status = services->list_snapshots(services->store, a->id, &a->list, err);
    if (status == BF_OK)
        status = curve_file_open(services, a->id, of->n_samples, &a->curve, err);
    if (status == BF_OK)
        status = read_photo_eyes(a, of, services, err);
    if (status == BF_OK)
        status = zip_out_create(of->finished_ms / 1000, &a->zip, err);
    if (status != BF_OK) {
        destroy(a);
        return status;
    }
    *ret_source = (body_source){
        .state = a, .next_chunk = next_chunk, .destroy = destroy, .n_held = count_held(a)
    };
    return BF_OK;
}
