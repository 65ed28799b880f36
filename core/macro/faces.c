// The static velocity and the closed faces, sorted into the sets that a sweep treats differently.

#include "core/base/memory.h"
#include "core/macro/macro_priv.h"

#include <string.h>

// Where a direction's faces stand in the definition's arrays.
typedef struct face_source {
    const double *v;
    const uint8_t *closed;
    size_t row_stride; // elements from row to row
    ptrdiff_t first;   // face of the row's element 0
    ptrdiff_t n_faces; // faces of a row
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
    return faces->v != NULL && faces->mixed != NULL && faces->closable != NULL &&
                   faces->closed_blocks != NULL && faces->closed != NULL
               ? BF_OK
               : BF_ENOMEM;
}

// Copies the faces of block b of a row and puts it into the sets it belongs to.
static void fill_block(macro_solver *s, macro_faces *faces, const face_source *from, double uniform,
                       ptrdiff_t row, ptrdiff_t b)
{
    double *v = macro__row(s, faces->v, row);
    const size_t base = (size_t)row * from->row_stride;
    unsigned mask = 0, n_faces = 0, n_uniform = 0;

    for (ptrdiff_t k = 0; k < BLOCK_CELLS; k++) {
        ptrdiff_t face = b * BLOCK_CELLS + k;
        if (face < from->first || face >= from->first + from->n_faces)
            continue;
        size_t at = base + (size_t)(face - from->first);
        bool is_closed = from->closed != NULL && from->closed[at] != 0;
        v[face] = is_closed || from->v == NULL ? 0.0 : from->v[at];
        mask |= (unsigned)is_closed << k;
        n_uniform += !is_closed && v[face] == uniform;
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

static void fill_faces(macro_solver *s, macro_faces *faces, const face_source *from, double uniform)
{
    for (ptrdiff_t row = 0; row < from->n_rows; row++)
        for (ptrdiff_t b = -1; b < s->n_blocks; b++)
            fill_block(s, faces, from, uniform, row, b);
}

// The velocity that most faces of a sample have; a wrong guess costs time only.
static double guess_uniform(const macro_def *def)
{
    const bf_grid *g = &def->grid;
    double best = 0.0;
    size_t best_count = 0;

    if (def->v1 == NULL)
        return 0.0;
    for (size_t j = 0; j < g->n2; j += g->n2 / 8 + 1) {
        const double *row = def->v1 + j * (g->n1 + 1);
        for (size_t i = 0; i <= g->n1; i += g->n1 / 8 + 1) {
            size_t count = 0;
            for (size_t k = 0; k <= g->n1; k++)
                count += row[k] == row[i];
            if (count > best_count && row[i] >= 0.0) {
                best = row[i];
                best_count = count;
            }
        }
    }
    return best;
}

bf_status macro__faces_init(macro_solver *s, const macro_def *def)
{
    face_source from1 = { def->v1, def->closed1, def->grid.n1 + 1, -1, s->n1 + 1, s->n2 };
    face_source from2 = { def->v2, def->closed2, def->grid.n1, 0, s->n1, s->n2 + 1 };

    if (alloc_faces(s, &s->faces1, s->n2) != BF_OK ||
        alloc_faces(s, &s->faces2, s->n2 + 1) != BF_OK)
        return BF_ENOMEM;
    s->uniform1 = guess_uniform(def);
    fill_faces(s, &s->faces1, &from1, s->uniform1);
    fill_faces(s, &s->faces2, &from2, 0.0);
    return BF_OK;
}

static void free_faces(macro_faces *faces)
{
    memory_free(faces->v);
    memory_free(faces->mixed);
    memory_free(faces->closable);
    memory_free(faces->closed_blocks);
    memory_free(faces->closed);
    *faces = (macro_faces){ 0 };
}

void macro__faces_fini(macro_solver *s)
{
    free_faces(&s->faces1);
    free_faces(&s->faces2);
}
