// The loops of a step of kinds.h over the cells of a row, compiled once per instruction set; all builds give the same bits.

#include "core/base/simd_compare.h"
#include "core/macro/congested/congested_priv.h"
#include "core/macro/congested/half_rows.h"
#include "core/macro/flux.h"
#include "core/macro/kinds_priv.h"

#include <string.h>

// Cells of a span.
typedef struct cells {
    ptrdiff_t first;
    ptrdiff_t end;
} cells;

static cells cells_of(block_span span)
{
    return (cells){ span.first * BLOCK_CELLS, span.last * BLOCK_CELLS };
}

static simd size_of(simd x)
{
    return simd_max(x, 0.0 - x);
}

static const double *plane_row(const macro_solver *s, double *planes, size_t kind, ptrdiff_t j)
{
    const double *nothing = s->zero_row + s->margin;

    return j < 0 || j >= s->n2 ? nothing
                               : macro__row(s, planes + (ptrdiff_t)kind * s->kinds->plane, j);
}

static const double *density_row(const macro_solver *s, ptrdiff_t j)
{
    return j < 0 || j >= s->n2 ? s->zero_row + s->margin : macro__row(s, s->next.rho, j);
}

// G of the x1-faces of a row, or of the x2-faces south of it, where cells beside them are active; else 0. False: all are 0, and
// nothing was filled.
static bool fill_correction(const macro_solver *s, int axis, ptrdiff_t j, cells at,
                            double *correction)
{
    const congested *c = s->congested;
    ptrdiff_t first = s->n1, last = 0;

    for (ptrdiff_t row = j - axis; row <= j; row++) {
        if (row < 0 || row >= s->n2 || c->range[row].first >= c->range[row].last)
            continue;
        first = 2 * c->range[row].first < first ? 2 * c->range[row].first : first;
        last = 2 * c->range[row].last > last ? 2 * c->range[row].last : last;
    }
    // Element i is of the face east, or south, of cell i. Of two neighbours one belongs to a red cell of this row.
    const ptrdiff_t low = first - (axis == 0) > at.first ? first - (axis == 0) : at.first;
    const ptrdiff_t high = last < at.end ? last : at.end, end = high < s->n1 ? high : s->n1;
    if (low >= end)
        return false;
    const float *faces[2] = {
        axis == 0 ? CONGESTED_FACE1(c, flux, low + 1, j) : CONGESTED_FACE2(c, flux, low, j),
        axis == 0 ? CONGESTED_FACE1(c, flux, low + 2, j) : CONGESTED_FACE2(c, flux, low + 1, j)
    };
    const ptrdiff_t n[2] = { (end - low + 1) / 2, (end - low) / 2 };
    bool has_any = false;
    for (int k = 0; k < 2; k++) {
        unsigned bits = 0;
        for (ptrdiff_t m = 0; m < n[k]; m++)
            bits |= faces[k][m] != 0.0F;
        has_any = has_any || bits != 0;
    }
    if (!has_any)
        return false;
    memset(correction + at.first, 0, (size_t)(at.end - at.first) * sizeof *correction);
    for (int k = 0; k < 2; k++)
        for (ptrdiff_t m = 0; m < n[k]; m++)
            correction[low + k + 2 * m] = s->lambda1 * (double)faces[k][m];
    return true;
}

// Parts F_stat and G at a row of faces between two rows of cells, the second of which is one cell on. What cargo comes from is where it
// was before. ret_any: there are fluxes, and corrections.
static void part(const macro_solver *s, int axis, ptrdiff_t j, cells at, bool ret_any[2])
{
    const kinds *k = s->kinds;
    const double *v = macro__row(s, axis == 0 ? s->faces1.v : s->faces2.v, j);
    const double *left = density_row(s, axis == 0 ? j : j - 1);
    const double *right = axis == 0 ? left + 1 : density_row(s, j);
    const double lambda = axis == 0 ? s->lambda1 : s->lambda2;
    double *flux = macro__row(s, k->flux[axis], j),
           *correction = macro__row(s, k->correction[axis], j);
    const bool may_correct = fill_correction(s, axis, j, at, correction);
    const simd none = simd_all(0.0);
    unsigned flows = 0, corrects = 0;

    for (ptrdiff_t i = at.first; i < at.end; i += SIMD_LANES) {
        const simd f = lambda * flux_upwind_one(simd_load(v + i), simd_load_any(left + i),
                                                simd_load_any(right + i));
        simd_store(flux + i, f);
        flows |= simd_less(none, size_of(f));
        if (!may_correct)
            continue;
        // Of both, where they have two signs, only the sum, by the larger one.
        const simd g = simd_load(correction + i), sum = f + g, apart = f * g;
        simd_store(flux + i, simd_select_less(apart, none, simd_where_less(none, f * sum, sum), f));
        const simd corrected =
            simd_select_less(apart, none, simd_where_less(none, g * sum, sum), g);
        simd_store(correction + i, corrected);
        corrects |= simd_less(none, size_of(corrected));
    }
    ret_any[0] = flows != 0;
    ret_any[1] = corrects != 0;
}

static void split(const macro_solver *s, ptrdiff_t j)
{
    const kinds *k = s->kinds;
    const block_span own = kinds__columns(s, j);
    const cells at = cells_of(own);
    const ptrdiff_t end = at.end < s->n1 ? at.end : s->n1;
    bool any[2] = { false, false };

    part(s, 1, j, cells_of(block_span_hull(kinds__columns(s, j - 1), own)), any);
    k->flows[1][j] = any[0];
    k->corrects[1][j] = any[1];
    if (j == s->n2)
        return;
    any[0] = any[1] = false;
    if (at.first < at.end)
        part(s, 0, j, (cells){ at.first - BLOCK_CELLS, at.end }, any);
    k->flows[0][j] = any[0];
    k->corrects[0][j] = any[1];
    for (size_t m = 0; m < k->n; m++) {
        const double *from = k->fractions + (size_t)(j * s->n1) * k->n + m;
        double *to = macro__row(s, k->before + (ptrdiff_t)m * k->plane, j);
        for (ptrdiff_t i = at.first; i < end; i++)
            to[i] = from[(size_t)i * k->n];
    }
}

// theta/2 of the cells of a row along an axis, by what all slopes of a cell are scaled by.
static void limit(const macro_solver *s, int axis, ptrdiff_t j, cells at, const double *scale)
{
    const kinds *k = s->kinds;
    const simd none = simd_all(0.0), one = simd_all(1.0);
    const double *rho = density_row(s, j),
                 *v = macro__row(s, axis == 0 ? s->faces1.v : s->faces2.v, j);
    const double *rho_before = axis == 0 ? rho - 1 : density_row(s, j - 1);
    const double *rho_behind = axis == 0 ? rho + 1 : density_row(s, j + 1);
    const double *v_before = axis == 0 ? v - 1 : v, *v_behind = axis == 0 ? v : v + s->stride;
    double *slope = macro__row(s, k->slope[axis], j);

    for (ptrdiff_t i = at.first; i < at.end; i += SIMD_LANES) {
        const simd comes = simd_load_any(v_before + i) * simd_load_any(v_behind + i);
        const simd beside = simd_min(simd_load_any(rho_before + i), simd_load_any(rho_behind + i));
        const simd open = simd_where_less(none, comes, simd_where_less(none, beside, one));
        simd theta = one, over = one; // theta, times over
        if (simd_less(none, open) == 0) {
            simd_store(slope + i, none);
            continue;
        }
        for (size_t m = 0; m < k->n; m++) {
            const double *here = plane_row(s, k->before, m, j) + i;
            const double *before = axis == 0 ? here - 1 : plane_row(s, k->before, m, j - 1) + i;
            const double *behind = axis == 0 ? here + 1 : plane_row(s, k->before, m, j + 1) + i;
            const simd c = simd_load(here);
            const simd back = c - simd_load_any(before), on = simd_load_any(behind) - c;
            // superbee, by the sum of both differences; without any it says nothing.
            const simd a = size_of(back), b = size_of(on), sum = a + b;
            const simd bee = simd_where_less(none, back * on,
                                             simd_max(simd_min(2.0 * a, b), simd_min(a, 2.0 * b)));
            const simd less = bee * over, than = theta * sum;
            theta = simd_select_less(less, than, bee, theta);
            over = simd_select_less(less, than, sum, over);
        }
        simd_store(slope + i, 0.5 * open * (theta / over) * simd_load(scale + i));
    }
}

static void prepare(const macro_solver *s, ptrdiff_t j)
{
    const kinds *k = s->kinds;
    const cells at = cells_of(kinds__columns(s, j));
    const simd none = simd_all(0.0), one = simd_all(1.0);
    const double *rho = density_row(s, j), *east = macro__row(s, k->flux[0], j);
    const double *south = macro__row(s, k->flux[1], j), *north = south + s->stride;
    double *density = macro__row(s, k->density, j), *inverse = macro__row(s, k->inverse, j);
    double *scale = macro__row(s, k->carried, j); // free until carry

    for (ptrdiff_t i = at.first; i < at.end; i += SIMD_LANES) {
        const simd here = simd_load(rho + i);
        const simd w = simd_load_any(east + i - 1), e = simd_load(east + i);
        const simd d = simd_load(south + i), u = simd_load(north + i);
        const simd inv = 1.0 / simd_select_less(none, here, here, one);
        const simd out[4] = { simd_positive(0.0 - w), simd_positive(e), simd_positive(0.0 - d),
                              simd_positive(u) };
        simd leaving = none, weight = none;
        for (int side = 0; side < 4; side++) {
            leaving += out[side];
            weight += out[side] * (1.0 - out[side] * inv);
        }
        const simd staying = here - leaving;
        simd_store(inverse + i, inv);
        simd_store(density + i, here - (e - w) - (u - d));
        simd_store(scale + i, one);
        if (simd_less(staying, weight) != 0)
            simd_store(scale + i,
                       simd_select_less(staying, weight,
                                        simd_positive(staying) / simd_max(weight, simd_all(1e-300)),
                                        one));
    }
    for (int axis = 0; axis < 2; axis++)
        if (k->flows[axis][j] || (axis == 1 && k->flows[axis][j + 1]))
            limit(s, axis, j, at, scale);
}

// The rows on both sides of a row of faces.
typedef struct face_rows {
    const double *before_left, *left, *right, *behind_right;
} face_rows;

// What of a kind crosses a row of faces, of which `lean` is known.
static void carry_faces(const double *flux, const double *lean, face_rows of, cells at, double *ret)
{
    const simd none = simd_all(0.0);

    for (ptrdiff_t i = at.first; i < at.end; i += SIMD_LANES) {
        const simd f = simd_load(flux + i);
        const simd left = simd_load_any(of.left + i), right = simd_load_any(of.right + i);
        const simd from = simd_select_less(f, none, right, left);
        const simd rises = simd_select_less(f, none, simd_load_any(of.behind_right + i) - left,
                                            right - simd_load_any(of.before_left + i));
        simd_store(ret + i, f * (from + simd_load(lean + i) * rises));
    }
}

// (1 - nu) theta/2 of the cell that cargo comes from, towards the face.
static void find_lean(const macro_solver *s, int axis, ptrdiff_t j, cells at, double *ret)
{
    const kinds *k = s->kinds;
    const double *nothing = s->zero_row + s->margin, *flux = macro__row(s, k->flux[axis], j);
    const bool has_left = axis == 0 || j > 0, has_right = axis == 0 || j < s->n2;
    const ptrdiff_t to_left = axis == 0 ? 0 : -s->stride, to_right = axis == 0 ? 1 : 0;
    const double *slope = macro__row(s, k->slope[axis], j), *inverse = macro__row(s, k->inverse, j);
    const double *slopes[2] = { has_left ? slope + to_left : nothing,
                                has_right ? slope + to_right : nothing };
    const double *inverses[2] = { has_left ? inverse + to_left : nothing,
                                  has_right ? inverse + to_right : nothing };
    const simd none = simd_all(0.0);

    for (ptrdiff_t i = at.first; i < at.end; i += SIMD_LANES) {
        const simd f = simd_load(flux + i);
        const simd of = simd_select_less(f, none, 0.0 - simd_load_any(slopes[1] + i),
                                         simd_load_any(slopes[0] + i));
        const simd inv = simd_select_less(f, none, simd_load_any(inverses[1] + i),
                                          simd_load_any(inverses[0] + i));
        simd_store(ret + i, of * (1.0 - size_of(f) * inv));
    }
}

// What of each kind crosses the x2-faces south of row j.
static void carry_south(const macro_solver *s, ptrdiff_t j, kinds_rows *rows)
{
    const kinds *k = s->kinds;
    const cells at = cells_of(block_span_hull(kinds__columns(s, j - 1), kinds__columns(s, j)));

    if (!k->flows[1][j])
        return;
    find_lean(s, 1, j, at, rows->lean);
    for (size_t m = 0; m < k->n; m++) {
        const face_rows of = { plane_row(s, k->before, m, j - 2), plane_row(s, k->before, m, j - 1),
                               plane_row(s, k->before, m, j), plane_row(s, k->before, m, j + 1) };
        carry_faces(macro__row(s, k->flux[1], j), rows->lean, of, at,
                    rows->flux2[j & 1] + (ptrdiff_t)m * s->stride);
    }
}

// Lets masses be fractions, by their sum; where there is none, they are those before.
static void divide(const macro_solver *s, ptrdiff_t j, cells at, const double *sum, double *before,
                   double *planes)
{
    const kinds *k = s->kinds;
    const simd none = simd_all(0.0), one = simd_all(1.0);

    for (ptrdiff_t i = at.first; i < at.end; i += SIMD_LANES) {
        const simd all = simd_load(sum + i), inv = 1.0 / simd_select_less(none, all, all, one);
        for (size_t m = 0; m < k->n; m++) {
            double *of = macro__row(s, planes + (ptrdiff_t)m * k->plane, j) + i;
            simd_store(of, simd_select_less(none, all, simd_load(of) * inv,
                                            simd_load(plane_row(s, before, m, j) + i)));
        }
    }
}

static void carry(const macro_solver *s, ptrdiff_t j, kinds_rows *rows)
{
    const kinds *k = s->kinds;
    const cells at = cells_of(kinds__columns(s, j));
    const cells faces = { at.first - BLOCK_CELLS, at.end };
    const double *rho = density_row(s, j), *nothing = s->zero_row + s->margin;

    carry_south(s, j + 1, rows);
    if (at.first == at.end)
        return;
    find_lean(s, 0, j, faces, rows->lean);
    memset(rows->sum + at.first, 0, (size_t)(at.end - at.first) * sizeof *rows->sum);
    for (size_t m = 0; m < k->n; m++) {
        const double *here = plane_row(s, k->before, m, j);
        const ptrdiff_t row = (ptrdiff_t)m * s->stride;
        const double *south = k->flows[1][j] ? rows->flux2[j & 1] + row : nothing;
        const double *north = k->flows[1][j + 1] ? rows->flux2[(j + 1) & 1] + row : nothing;
        double *to = macro__row(s, k->carried + (ptrdiff_t)m * k->plane, j);
        carry_faces(macro__row(s, k->flux[0], j), rows->lean,
                    (face_rows){ here - 1, here, here + 1, here + 2 }, faces, rows->flux1);
        for (ptrdiff_t i = at.first; i < at.end; i += SIMD_LANES) {
            const simd along = simd_load(rows->flux1 + i) - simd_load_any(rows->flux1 + i - 1);
            const simd across = simd_load(north + i) - simd_load(south + i);
            const simd mass =
                simd_positive(simd_load(rho + i) * simd_load(here + i) - along - across);
            simd_store(to + i, mass);
            simd_store(rows->sum + i, simd_load(rows->sum + i) + mass);
        }
    }
    divide(s, j, at, rows->sum, k->before, k->carried);
}

static void correct(const macro_solver *s, ptrdiff_t j, kinds_rows *rows)
{
    const kinds *k = s->kinds;
    const cells at = cells_of(kinds__columns(s, j));
    const simd none = simd_all(0.0);
    const double *density = macro__row(s, k->density, j);
    const double *nothing = s->zero_row + s->margin, *across = macro__row(s, k->correction[1], j);
    const double *east = k->corrects[0][j] ? macro__row(s, k->correction[0], j) : nothing;
    const double *south = k->corrects[1][j] ? across : nothing;
    const double *north = k->corrects[1][j + 1] ? across + s->stride : nothing;
    const bool is_corrected = k->corrects[0][j] || k->corrects[1][j] || k->corrects[1][j + 1];
    double *planes = is_corrected ? k->before : k->carried;

    if (at.first == at.end)
        return;
    memset(rows->sum + at.first, 0, (size_t)(at.end - at.first) * sizeof *rows->sum);
    for (size_t m = 0; is_corrected && m < k->n; m++) {
        const double *here = plane_row(s, k->carried, m, j);
        const double *below = plane_row(s, k->carried, m, j - 1);
        const double *above = plane_row(s, k->carried, m, j + 1);
        double *to = macro__row(s, k->before + (ptrdiff_t)m * k->plane, j);
        for (ptrdiff_t i = at.first; i < at.end; i += SIMD_LANES) {
            const simd c = simd_load(here + i), w = simd_load_any(east + i - 1);
            const simd e = simd_load(east + i), d = simd_load(south + i), u = simd_load(north + i);
            const simd from_west = simd_select_less(w, none, c, simd_load_any(here + i - 1));
            const simd from_east = simd_select_less(e, none, simd_load_any(here + i + 1), c);
            const simd from_below = simd_select_less(d, none, c, simd_load(below + i));
            const simd from_above = simd_select_less(u, none, simd_load(above + i), c);
            const simd mass =
                simd_positive(simd_load(density + i) * c - (e * from_east - w * from_west) -
                              (u * from_above - d * from_below));
            simd_store(to + i, mass);
            simd_store(rows->sum + i, simd_load(rows->sum + i) + mass);
        }
    }
    if (is_corrected)
        divide(s, j, at, rows->sum, k->carried, k->before);
    const ptrdiff_t end = at.end < s->n1 ? at.end : s->n1;
    for (size_t m = 0; m < k->n; m++) {
        const double *from = plane_row(s, planes, m, j);
        double *to = k->fractions + (size_t)(j * s->n1) * k->n + m;
        for (ptrdiff_t i = at.first; i < end; i++)
            to[(size_t)i * k->n] = from[i];
    }
}

const kinds_kernels kinds__kernels = {
    .split = split, .prepare = prepare, .begin = carry_south, .carry = carry, .correct = correct
};
