// Densities as pictures: proportions, directions, cells below pixels.

#include "api/results/picture.h"
#include "tests/unit/helper_cmocka.h"

#include <math.h>
#include <string.h>

// One level more is one more in density.
static const double unit_top = 255.0;

static picture lay_out(size_t n1, size_t n2, double d1, double d2, size_t width)
{
    const bf_grid grid = { .n1 = n1, .n2 = n2, .d1 = d1, .d2 = d2 };
    picture p = { .width = 0 };

    assert_int_equal(picture_layout(&grid, width, unit_top, &p, NULL), BF_OK);
    return p;
}

static void assert_size(size_t n1, size_t n2, double d1, double d2, size_t width,
                        size_t expected_width, size_t expected_height)
{
    picture p = lay_out(n1, n2, d1, d2, width);

    assert_int_equal(p.width, expected_width);
    assert_int_equal(p.height, expected_height);
}

static void pixels_are_square(void **unused)
{
    assert_size(200, 120, 0.005, 0.005, 400, 400, 240);
    assert_size(10, 10, 0.01, 0.005, 300, 300, 150); // cells twice as long as wide
    assert_size(10, 10, 0.005, 0.01, 300, 300, 600);
    assert_size(3, 2, 1.0, 1.0, 100, 100, 67); // 66.7
    assert_size(1000, 1, 1.0, 1.0, 100, 100, 1);
}

static void the_usual_width_is_whole_pixels_a_cell(void **unused)
{
    assert_size(200, 120, 0.005, 0.005, 0, 1000, 600);
    assert_size(24, 12, 0.01, 0.01, 0, 984, 492);
    assert_size(1001, 1, 0.01, 0.01, 0, 1001, 1);
    assert_size(1, 1, 0.01, 0.01, 0, 1000, 1000);
    assert_size(10000, 10000, 0.01, 0.01, 0, 4096, 4096); // 8192 is too much
}

static void the_usual_width_is_within_the_limit(void **unused)
{
    for (size_t n2 = 1; n2 <= 10000000; n2 *= 10) {
        picture p = lay_out(10, n2, 1.0, 1.0, 0);
        assert_true(p.width * p.height <= PICTURE_PIXELS_MAX);
    }
}

static void too_large_a_picture_is_refused_with_the_figures(void **unused)
{
    const bf_grid grid = { .n1 = 100, .n2 = 400, .d1 = 1.0, .d2 = 1.0 };
    picture p = { .width = 7 };
    bf_error err = { 0 };

    assert_int_equal(picture_layout(&grid, 2048, 1.0, &p, &err), BF_OK); // 2048 x 8192
    p.width = 7;
    assert_int_equal(picture_layout(&grid, 2049, 1.0, &p, &err), BF_ELIMIT);
    assert_non_null(strstr(err.text, "2049"));
    assert_non_null(strstr(err.text, "16777216"));
    assert_non_null(strstr(err.text, "about 2048"));
    assert_int_equal(p.width, 7);
}

// Cells in memory, which are asked for row by row, each once.
typedef struct held_cells {
    const float *rho;
    size_t n1;
    size_t n_asked;
} held_cells;

static bf_status give_cells(void *context, size_t j, const float **ret_cells, bf_error *err)
{
    held_cells *cells = context;

    assert_int_equal(j, cells->n_asked++);
    *ret_cells = cells->rho + j * cells->n1;
    return BF_OK;
}

static void assert_row(const picture *p, const float *rho, size_t row, const uint8_t *expected)
{
    held_cells cells = { .rho = rho, .n1 = p->grid.n1 };
    uint8_t levels[256];

    assert_true(p->width * p->height <= sizeof levels);
    assert_int_equal(picture_draw(p, give_cells, &cells, levels, NULL), BF_OK);
    assert_int_equal(cells.n_asked, p->grid.n2);
    assert_memory_equal(levels + row * p->width, expected, p->width);
}

static bf_status fail_at_row_1(void *context, size_t j, const float **ret_cells, bf_error *err)
{
    *ret_cells = context;
    return j < 1 ? BF_OK : bf_fail(err, BF_ECORRUPT, "", "row %zu is damaged", j);
}

static void cells_that_cannot_be_read_are_no_picture(void **unused)
{
    const float rho[] = { 1, 2, 3 };
    picture p = lay_out(3, 2, 1.0, 1.0, 3);
    bf_error err = { 0 };
    uint8_t levels[6];

    assert_int_equal(picture_draw(&p, fail_at_row_1, (void *)(uintptr_t)rho, levels, &err),
                     BF_ECORRUPT);
    assert_string_equal(err.text, "row 1 is damaged");
}

static void y_points_up(void **unused)
{
    const float rho[] = { 1, 2, 3, 4, 5, 6 }; // y = 0: 1 2 3
    picture p = lay_out(3, 2, 1.0, 1.0, 3);

    assert_int_equal(p.height, 2);
    assert_row(&p, rho, 0, (const uint8_t[]){ 4, 5, 6 });
    assert_row(&p, rho, 1, (const uint8_t[]){ 1, 2, 3 });
}

static void cells_stay_cells_in_a_large_picture(void **unused)
{
    const float rho[] = { 10, 20, 30, 40 };
    picture p = lay_out(2, 2, 1.0, 1.0, 6), odd = lay_out(2, 1, 1.0, 1.0, 5);

    for (size_t row = 0; row < 3; row++) {
        assert_row(&p, rho, row, (const uint8_t[]){ 30, 30, 30, 40, 40, 40 });
        assert_row(&p, rho, row + 3, (const uint8_t[]){ 10, 10, 10, 20, 20, 20 });
    }
    assert_row(&odd, rho, 0, (const uint8_t[]){ 10, 10, 20, 20, 20 }); // the middle is the border
}

// Three cells below two pixels: (a + b/2) / 1.5 and (b/2 + c) / 1.5.
static void a_small_picture_shows_means_by_area(void **unused)
{
    const float rho[] = { 30, 60, 90, 30, 60, 90, 60, 90, 120 };
    picture p = lay_out(3, 3, 1.0, 1.0, 2);

    assert_int_equal(p.height, 2);
    assert_row(&p, rho, 1, (const uint8_t[]){ 40, 80 });
    assert_row(&p, rho, 0, (const uint8_t[]){ 60, 100 }); // (40/2 + 70)/1.5 and (80/2 + 110)/1.5
}

// What one pixel shows is the mean over all cells.
static void one_pixel_shows_the_mean(void **unused)
{
    float rho[15];
    picture p = lay_out(5, 3, 3.0, 5.0, 1);

    for (int k = 0; k < 15; k++)
        rho[k] = (float)(10 * k); // mean 70
    assert_row(&p, rho, 0, (const uint8_t[]){ 70 });
}

// Fewer pixels than cells along x, more along y.
static void each_axis_goes_its_own_way(void **unused)
{
    const float rho[] = { 10, 30, 50, 70, 20, 40, 60, 80 };
    picture p = lay_out(4, 2, 1.0, 4.0, 2);

    assert_int_equal(p.height, 4);
    assert_row(&p, rho, 0, (const uint8_t[]){ 30, 70 });
    assert_row(&p, rho, 1, (const uint8_t[]){ 30, 70 });
    assert_row(&p, rho, 2, (const uint8_t[]){ 20, 60 });
    assert_row(&p, rho, 3, (const uint8_t[]){ 20, 60 });
}

static void levels_end_where_the_scale_ends(void **unused)
{
    const float rho[] = { -1.0F, 0.0F, 0.75F, 1.5F, 7.0F, NAN };
    const bf_grid grid = { .n1 = 6, .n2 = 1, .d1 = 1.0, .d2 = 1.0 };
    picture p = { .width = 0 };

    assert_int_equal(picture_layout(&grid, 6, 1.5, &p, NULL), BF_OK);
    assert_row(&p, rho, 0, (const uint8_t[]){ 0, 0, 128, 255, 255, 0 });
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(pixels_are_square),
        cmocka_unit_test(the_usual_width_is_whole_pixels_a_cell),
        cmocka_unit_test(the_usual_width_is_within_the_limit),
        cmocka_unit_test(too_large_a_picture_is_refused_with_the_figures),
        cmocka_unit_test(cells_that_cannot_be_read_are_no_picture),
        cmocka_unit_test(y_points_up),
        cmocka_unit_test(cells_stay_cells_in_a_large_picture),
        cmocka_unit_test(a_small_picture_shows_means_by_area),
        cmocka_unit_test(one_pixel_shows_the_mean),
        cmocka_unit_test(each_axis_goes_its_own_way),
        cmocka_unit_test(levels_end_where_the_scale_ends),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
