// Pictures of snapshots, read back by libpng's own reader.

#include "api/results/results.h"

#include "tests/unit/api/helper_appender.h"
#include "tests/unit/helper_cmocka.h"

#include <png.h>
#include <stdlib.h>
#include <string.h>

// Three cells by two, twice as long as wide; y = 0 is the first row.
static const bf_grid grid = { .n1 = 3, .n2 = 2, .d1 = 0.02, .d2 = 0.01 };
static const float rho[] = { 0.0F, 0.5F, 1.0F, 1.5F, 2.0F, 0.25F };

static bf_status give_cells(void *context, size_t j, const float **ret_cells, bf_error *err)
{
    *ret_cells = rho + 3 * j;
    return BF_OK;
}

static bf_status draw(size_t width, const char *map, bf_buffer *out)
{
    picture p;

    assert_int_equal(picture_layout(&grid, width, 1.5, &p, NULL), BF_OK);
    uint8_t *levels = malloc(p.width * p.height);
    assert_non_null(levels);
    bf_status status = picture_draw(&p, give_cells, NULL, levels, NULL);
    if (status == BF_OK)
        status = results_snapshot_png(&p, colormap_find(map), levels, 0.125, out, NULL);
    free(levels);
    return status;
}

// The pixels as red, green, blue. The caller frees them.
static uint8_t *read_back(const bf_buffer *file, uint32_t *ret_width, uint32_t *ret_height)
{
    png_image image = { .version = PNG_IMAGE_VERSION };

    assert_int_not_equal(png_image_begin_read_from_memory(&image, file->bytes, file->n), 0);
    image.format = PNG_FORMAT_RGB;
    uint8_t *pixels = malloc(PNG_IMAGE_SIZE(image));
    assert_non_null(pixels);
    assert_int_not_equal(png_image_finish_read(&image, NULL, pixels, 0, NULL), 0);
    *ret_width = image.width;
    *ret_height = image.height;
    return pixels;
}

static void assert_pixel(const uint8_t *pixels, size_t k, const char *map, unsigned level)
{
    colormap_color c = colormap_at(colormap_find(map), level);

    assert_memory_equal(pixels + 3 * k, ((const uint8_t[]){ c.red, c.green, c.blue }), 3);
}

// Pixels of 60 x 20: a cell is 20 x 10 of them. Levels of 255 / 1.5: 0, 85, 170; 255, 255, 43 (42.5).
static void a_picture_has_the_colors_of_its_cells_with_y_up(void **unused)
{
    static const unsigned levels[2][3] = { { 255, 255, 43 }, { 0, 85, 170 } };
    bf_buffer file = { 0 };
    uint32_t width, height;

    assert_int_equal(draw(60, "viridis", &file), BF_OK);
    uint8_t *pixels = read_back(&file, &width, &height);
    assert_int_equal(width, 60);
    assert_int_equal(height, 20);
    for (size_t row = 0; row < height; row++) {
        for (size_t k = 0; k < width; k++)
            assert_pixel(pixels, row * width + k, "viridis", levels[row / 10][k / 20]);
    }
    free(pixels);
    buffer_fini(&file);
}

static void an_empty_belt_is_white_in_grey(void **unused)
{
    bf_buffer file = { 0 };
    uint32_t width, height;

    assert_int_equal(draw(3, "grey", &file), BF_OK);
    uint8_t *pixels = read_back(&file, &width, &height);
    assert_int_equal(height, 1);          // 3 * 0.02 m by 2 * 0.01 m
    assert_pixel(pixels, 0, "grey", 128); // mean of 0 and 1.5
    free(pixels);
    file.n = 0;
    assert_int_equal(draw(6, "grey", &file), BF_OK);
    pixels = read_back(&file, &width, &height);
    assert_memory_equal(pixels + 3 * 6, ((const uint8_t[]){ 255, 255, 255 }), 3); // lower left
    free(pixels);
    buffer_fini(&file);
}

// Bit depth and colour type stand in IHDR.
static void a_picture_is_small_and_says_what_it_shows(void **unused)
{
    static const char text[] = "Density at t = 0.125 s, cividis from 0 to 1.5";
    bf_buffer file = { 0 };
    bool is_found = false;

    assert_int_equal(draw(3000, "cividis", &file), BF_OK);
    assert_int_equal(file.bytes[24], 8);
    assert_int_equal(file.bytes[25], PNG_COLOR_TYPE_PALETTE);
    assert_true(file.n < 20000); // of 3,000,000 pixels
    for (size_t k = 0; k + sizeof text < file.n; k++)
        is_found = is_found || memcmp(file.bytes + k, text, sizeof text - 1) == 0;
    assert_true(is_found);
    buffer_fini(&file);
}

static bf_status append_png(bf_buffer *out)
{
    return draw(60, "grey", out);
}

static void no_memory_leaves_what_was_there(void **unused)
{
    appender_survives_no_memory(append_png);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_picture_has_the_colors_of_its_cells_with_y_up),
        cmocka_unit_test(an_empty_belt_is_white_in_grey),
        cmocka_unit_test(a_picture_is_small_and_says_what_it_shows),
        cmocka_unit_test(no_memory_leaves_what_was_there),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
