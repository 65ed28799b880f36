// The static velocity and the closed faces, sorted into the sets that a sweep treats differently.
//
// Where speeds of belts change, the velocities of a step are v_full times the size of the factor of the belt under the
// face. The sets are the same at all times: faces of the uniform velocity are those over one belt, so
// that they have one factor.

#include "core/base/memory.h"
#include "core/base/team.h"
#include "core/macro/congested.h"
#include "core/macro/macro_priv.h"
#include "core/macro/velocity_field.h"

#include <math.h>
#include <string.h>

enum { ROWS_AT_ONCE = 16 }; // that a thread updates

// Where a direction's faces stand in the definition's arrays.
typedef struct face_source {
    const double *v;
    const double *aperture; // NULL: all open
    const uint8_t *closed;
    const uint16_t *belt; // NULL: no speed changes
    size_t row_stride;    // elements from row to row
    ptrdiff_t first;      // face of the row's element 0
    ptrdiff_t n_faces;    // faces of a row
    ptrdiff_t n_rows;
} face_source;

static bf_status alloc_faces(const macro_solver *s, macro_faces *faces, ptrdiff_t n_rows)
{
    size_t words = (size_t)n_rows * s->n_words;

    faces->v = memory_alloc((size_t)(n_rows * s->stride), sizeof *faces->v);
    faces->mixed = memory_alloc(words, sizeof *faces->mixed);
    faces->closable = memory_alloc(words, sizeof *faces->closable);
    faces->closed_blocks = memory_alloc(words, sizeof *faces->closed_blocks);
    faces->closed = memory_alloc((size_t)(n_rows * (s->n_blocks + 1)), sizeof *faces->closed);
    bool is_whole = faces->v != NULL && faces->mixed != NULL && faces->closable != NULL &&
                    faces->closed_blocks != NULL && faces->closed != NULL;
    if (is_whole && s->speeds != NULL) {
        faces->v_full = memory_alloc((size_t)(n_rows * s->stride), sizeof *faces->v_full);
        faces->belt = memory_alloc((size_t)(n_rows * s->stride), sizeof *faces->belt);
        is_whole = faces->v_full != NULL && faces->belt != NULL;
    }
    return is_whole ? BF_OK : BF_ENOMEM;
}

// A velocity at the factor 1, and the belt under the faces that have it.
typedef struct uniform_faces {
    double v;
    uint16_t belt; // 0 where no speed changes
} uniform_faces;

// Velocity of the flux through a face, by its index in the definition's arrays.
static double velocity_of(const face_source *from, size_t at)
{
    const double v = from->v != NULL ? from->v[at] : 0.0;

    return from->aperture != NULL ? v * from->aperture[at] : v;
}

// True if a face, by its index in the definition's arrays, has the uniform velocity at all times.
static bool is_uniform(const face_source *from, size_t at, const uniform_faces *uniform)
{
    const double v = velocity_of(from, at);

    return v == uniform->v && (v == 0.0 || from->belt == NULL || from->belt[at] == uniform->belt);
}

// Copies the faces of block b of a row and puts it into the sets it belongs to.
static void fill_block(macro_solver *s, macro_faces *faces, const face_source *from,
                       const uniform_faces *uniform, ptrdiff_t row, ptrdiff_t b)
{
    const size_t base = (size_t)row * from->row_stride;
    unsigned mask = 0, n_faces = 0, n_uniform = 0;

    for (ptrdiff_t k = 0; k < BLOCK_CELLS; k++) {
        ptrdiff_t face = b * BLOCK_CELLS + k;
        if (face < from->first || face >= from->first + from->n_faces)
            continue;
        size_t at = base + (size_t)(face - from->first);
        const bool is_closed = from->closed != NULL && from->closed[at] != 0;
        const double v = is_closed ? 0.0 : velocity_of(from, at);
        macro__row(s, faces->v, row)[face] = v;
        if (faces->belt != NULL) {
            macro__row(s, faces->v_full, row)[face] = v;
            macro__belts(s, faces, row)[face] = from->belt[at];
        }
        mask |= (unsigned)is_closed << k;
        n_uniform += !is_closed && is_uniform(from, at, uniform);
        n_faces++;
    }
    faces->closed[row * (s->n_blocks + 1) + 1 + b] = (uint8_t)mask;
    if (n_uniform != n_faces)
        block_set_add(macro__set(s, faces->mixed, row), b);
    if (mask != 0)
        block_set_add(macro__set(s, faces->closable, row), b);
    if (n_faces > 0 && (unsigned)__builtin_popcount(mask) == n_faces)
        block_set_add(macro__set(s, faces->closed_blocks, row), b);
}

static void fill_faces(macro_solver *s, macro_faces *faces, const face_source *from,
                       const uniform_faces *uniform)
{
    const size_t n_bytes = (size_t)from->n_rows * s->n_words * sizeof *faces->mixed;

    memset(faces->mixed, 0, n_bytes);
    memset(faces->closable, 0, n_bytes);
    memset(faces->closed_blocks, 0, n_bytes);
    for (ptrdiff_t row = 0; row < from->n_rows; row++)
        for (ptrdiff_t b = -1; b < s->n_blocks; b++)
            fill_block(s, faces, from, uniform, row, b);
}

// The velocity, >= 0, that most faces of a sample have; a wrong guess costs time only.
static uniform_faces guess_uniform(const face_source *from)
{
    const ptrdiff_t row_step = from->n_rows / 8 + 1, face_step = from->n_faces / 8 + 1;
    uniform_faces best = { 0.0, 0 };
    size_t best_count = 0;

    for (ptrdiff_t row = 0; from->v != NULL && row < from->n_rows; row += row_step) {
        const size_t base = (size_t)row * from->row_stride;
        for (ptrdiff_t face = 0; face < from->n_faces; face += face_step) {
            const size_t at = base + (size_t)face;
            const uniform_faces guess = { velocity_of(from, at),
                                          from->belt != NULL ? from->belt[at] : 0 };
            size_t count = 0;
            for (ptrdiff_t k = 0; k < from->n_faces; k++)
                count += is_uniform(from, base + (size_t)k, &guess);
            if (count > best_count && guess.v >= 0.0) {
                best = guess;
                best_count = count;
            }
        }
    }
    return best;
}

// Fills rows of cells: 0 where one of the two faces of a cell is closed, else 1. Face k of a row of faces is the one
// before cell k; the one behind it follows to_next faces later.
static void fill_open(const macro_solver *s, const uint8_t *closed, ptrdiff_t n_faces,
                      ptrdiff_t to_next, double *open)
{
    for (ptrdiff_t j = 0; j < s->n2; j++)
        for (ptrdiff_t i = 0; i < s->n1; i++) {
            const uint8_t *face = closed == NULL ? NULL : closed + j * n_faces + i;
            macro__row(s, open, j)[i] =
                face == NULL || (face[0] == 0 && face[to_next] == 0) ? 1.0 : 0.0;
        }
}

// Where the faces along x1 and x2 stand in a definition.
static void find_sources(const macro_solver *s, const macro_def *def, face_source ret_sources[2])
{
    const bool changes = s->speeds != NULL;
    const bool is_congested = def->closure == SCENE_CONGESTED;

    for (int axis = 0; axis < 2; axis++) {
        const velocity_field_faces *faces = &def->faces[axis];
        ret_sources[axis] = (face_source){ .v = faces->v,
                                           .aperture = is_congested ? faces->aperture : NULL,
                                           .closed = faces->closed,
                                           .belt = changes ? faces->belt : NULL,
                                           .row_stride = def->grid.n1 + (axis == 0),
                                           .first = axis == 0 ? -1 : 0,
                                           .n_faces = s->n1 + (axis == 0),
                                           .n_rows = s->n2 + (axis == 1) };
    }
}

// Fills both sets of faces from a definition's arrays.
static void fill_all(macro_solver *s, const macro_def *def)
{
    const uniform_faces uniform1 = { s->uniform1_full, s->uniform_belt }, uniform2 = { 0.0, 0 };
    face_source sources[2];

    find_sources(s, def, sources);
    fill_faces(s, &s->faces1, &sources[0], &uniform1);
    fill_faces(s, &s->faces2, &sources[1], &uniform2);
    if (s->open1 != NULL) {
        fill_open(s, def->faces[0].closed, s->n1 + 1, 1, s->open1);
        fill_open(s, def->faces[1].closed, s->n1, s->n1, s->open2);
    }
}

bf_status macro__faces_init(macro_solver *s, const macro_def *def)
{
    face_source sources[2];

    if (alloc_faces(s, &s->faces1, s->n2) != BF_OK ||
        alloc_faces(s, &s->faces2, s->n2 + 1) != BF_OK)
        return BF_ENOMEM;
    if (def->scheme == SCENE_SCHEME_MUSCL) {
        s->open1 = memory_alloc((size_t)(s->n2 * s->stride), sizeof *s->open1);
        s->open2 = memory_alloc((size_t)(s->n2 * s->stride), sizeof *s->open2);
        if (s->open1 == NULL || s->open2 == NULL)
            return BF_ENOMEM;
    }
    find_sources(s, def, sources);
    const uniform_faces uniform1 = guess_uniform(&sources[0]);
    s->uniform1 = s->uniform1_full = uniform1.v;
    s->uniform_belt = uniform1.belt;
    fill_all(s, def);
    return BF_OK;
}

// The first face of a block, within a row.
static ptrdiff_t clamp_face(const macro_solver *s, ptrdiff_t b)
{
    const ptrdiff_t face = b * BLOCK_CELLS;

    return face < -1 ? -1 : face > s->n1 ? s->n1 : face;
}

// Brings the faces of a row to the present factors; uniform is the velocity of the blocks that are not mixed, NULL: it is always 0.
static void update_row(const macro_solver *s, const macro_faces *faces, ptrdiff_t row,
                       const double *uniform)
{
    const uint64_t *mixed = macro__set(s, faces->mixed, row);
    const double *v_full = macro__row(s, faces->v_full, row);
    const uint16_t *belt = macro__belts(s, faces, row);
    double *v = macro__row(s, faces->v, row);
    ptrdiff_t b = -1, done = -1;
    block_span run;

    while (done < s->n1) {
        if (!block_set_next_run(mixed, s->n_words, &b, &run))
            run = (block_span){ s->n_blocks, s->n_blocks };
        const ptrdiff_t first = clamp_face(s, run.first), last = clamp_face(s, run.last);
        for (ptrdiff_t i = done; uniform != NULL && i < first; i++)
            v[i] = *uniform;
        for (ptrdiff_t i = first; i < last; i++)
            v[i] = v_full[i] * s->factors[belt[i]];
        done = last;
    }
}

static void update_rows(void *context, size_t item)
{
    const macro_solver *s = context;
    const ptrdiff_t first = (ptrdiff_t)item * ROWS_AT_ONCE;

    for (ptrdiff_t row = first; row < first + ROWS_AT_ONCE && row <= s->n2; row++) {
        if (row < s->n2)
            update_row(s, &s->faces1, row, s->uniform1_full != 0.0 ? &s->uniform1 : NULL);
        update_row(s, &s->faces2, row, NULL);
    }
}

// Brings the velocities, which are those at the factor 1 or of the step before, to the present factors.
static void scale_faces(macro_solver *s)
{
    s->uniform1 = s->uniform1_full * s->factors[s->uniform_belt];
    team_for(s->n_bands, (size_t)s->n2 / ROWS_AT_ONCE + 1, update_rows, s);
}

bool macro__faces_update(macro_solver *s)
{
    const size_t n_bytes = (s->def.n_belts + 1) * sizeof *s->factors;

    if (s->speeds == NULL)
        return false;
    belt_speeds_in_step(s->speeds, s->steps, s->def.dt, s->factors_next);
    for (size_t k = 0; k < s->def.n_belts; k++)
        s->factors_next[k] = fabs(s->factors_next[k]);
    if (memcmp(s->factors, s->factors_next, n_bytes) == 0)
        return false;
    memcpy(s->factors, s->factors_next, n_bytes);
    scale_faces(s);
    return true;
}

void macro_set_field(macro_solver *s, const velocity_field *field, const scene_belt *belts)
{
    macro_def def = s->def;

    def.belts = belts;
    memcpy(def.faces, field->faces, sizeof def.faces);
    s->n_fields++;
    fill_all(s, &def);
    if (s->speeds != NULL)
        scale_faces(s);
    if (s->congested != NULL)
        congested_set_faces(s, &def);
}

static void free_faces(macro_faces *faces)
{
    memory_free(faces->v);
    memory_free(faces->mixed);
    memory_free(faces->closable);
    memory_free(faces->closed_blocks);
    memory_free(faces->closed);
    memory_free(faces->v_full);
    memory_free(faces->belt);
    *faces = (macro_faces){ 0 };
}

void macro__faces_fini(macro_solver *s)
{
    free_faces(&s->faces1);
    free_faces(&s->faces2);
    memory_free(s->open1);
    memory_free(s->open2);
}
