// Colour maps: evenly rising in lightness, and those that their authors published.

#include "api/results/colormap.h"
#include "tests/unit/helper_cmocka.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static double linear(uint8_t channel)
{
    double c = channel / 255.0;

    return c <= 0.04045 ? c / 12.92 : pow((c + 0.055) / 1.055, 2.4);
}

// L* of CIE 1976 under D65, from sRGB (IEC 61966-2-1).
static double lightness(colormap_color c)
{
    double y = 0.2126729 * linear(c.red) + 0.7151522 * linear(c.green) + 0.0721750 * linear(c.blue);

    return y > 216.0 / 24389.0 ? 116.0 * cbrt(y) - 16.0 : 24389.0 / 27.0 * y;
}

// A colour has 8 bits a channel, so that single steps are uneven by themselves: sixteen are not.
static void lightness_rises_evenly(void **unused)
{
    static const char *const words[] = { "viridis", "cividis" };
    enum { STRIDE = 16 };

    for (size_t i = 0; i < sizeof words / sizeof *words; i++) {
        const colormap *map = colormap_find(words[i]);
        double whole = lightness(colormap_at(map, 255)) - lightness(colormap_at(map, 0));
        double mean = whole * STRIDE / 255.0;
        assert_true(whole > 70.0);
        for (unsigned k = 0; k + STRIDE < COLORMAP_LEVELS; k++) {
            double step = lightness(colormap_at(map, k + STRIDE)) - lightness(colormap_at(map, k));
            assert_true(step > 0.7 * mean && step < 1.3 * mean);
        }
        for (unsigned k = 1; k < COLORMAP_LEVELS; k++)
            assert_true(lightness(colormap_at(map, k)) >= lightness(colormap_at(map, k - 1)) - 0.1);
    }
}

static void assert_near(const char *word, unsigned level, int red, int green, int blue, int within)
{
    colormap_color c = colormap_at(colormap_find(word), level);

    if (abs(c.red - red) > within || abs(c.green - green) > within || abs(c.blue - blue) > within)
        fail_msg("%s at %u is %d, %d, %d", word, level, c.red, c.green, c.blue);
}

// From the tables of Matplotlib 3.6.3 (_cm_listed.py).
static void colors_are_the_published_ones(void **unused)
{
    assert_near("viridis", 0, 68, 1, 84, 3);
    assert_near("viridis", 64, 59, 82, 139, 3);
    assert_near("viridis", 128, 33, 145, 140, 3);
    assert_near("viridis", 192, 94, 201, 98, 3);
    assert_near("viridis", 255, 253, 231, 37, 3);
    assert_near("cividis", 0, 0, 34, 78, 6);
    assert_near("cividis", 64, 67, 78, 108, 6);
    assert_near("cividis", 128, 125, 124, 120, 6);
    assert_near("cividis", 192, 188, 174, 108, 6);
    assert_near("cividis", 255, 254, 232, 56, 6);
}

static void grey_goes_from_white_to_black(void **unused)
{
    const colormap *map = colormap_find("grey");

    for (unsigned k = 0; k < COLORMAP_LEVELS; k++) {
        colormap_color c = colormap_at(map, k);
        assert_int_equal(c.red, 255 - k);
        assert_true(c.green == c.red && c.blue == c.red);
    }
}

static void every_word_finds_its_map_and_no_other_does(void **unused)
{
    char words[64];

    assert_true(strlen(colormap_words()) < sizeof words);
    strcpy(words, colormap_words());
    assert_string_equal(colormap_word(colormap_first()), "viridis");
    assert_memory_equal(words, "viridis ", 8);
    for (char *word = strtok(words, " "); word != NULL; word = strtok(NULL, " "))
        assert_string_equal(colormap_word(colormap_find(word)), word);
    assert_null(colormap_find(""));
    assert_null(colormap_find("viridi"));
    assert_null(colormap_find("viridis "));
    assert_null(colormap_find("Grey"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(lightness_rises_evenly),
        cmocka_unit_test(colors_are_the_published_ones),
        cmocka_unit_test(grey_goes_from_white_to_black),
        cmocka_unit_test(every_word_finds_its_map_and_no_other_does),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
