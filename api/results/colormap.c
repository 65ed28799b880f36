#include "api/results/colormap.h"

#include "core/base/check.h"

#include <stddef.h>
#include <string.h>

enum { DEGREE = 6, CHANNELS = 3 };

struct colormap {
    const char *word;
    double channels[CHANNELS][DEGREE + 1]; // polynomials of the fraction, constant term first
};

// Fitted to the tables of Matplotlib 3.6.3 with the largest error as the measure.
static const colormap maps[] = {
    { "viridis",
      { { 0.2769, -0.1361, 2.0771, -13.154, 20.1343, -5.8888, -2.3259 },
        { 0.0037, 1.4894, -0.7295, -2.0177, 7.3008, -7.8993, 2.7573 },
        { 0.3377, 0.9553, 5.1146, -40.5037, 97.2592, -101.2619, 38.2345 } } },
    { "cividis",
      { { 0.0035, -1.6359, 29.9781, -119.679, 216.5523, -182.1942, 57.9925 },
        { 0.1368, 0.5876, 1.2442, -5.6321, 11.4122, -10.3629, 3.5217 },
        { 0.3046, 2.643, -17.6533, 51.0052, -69.0996, 42.9906, -9.987 } } },
    { "grey", { { 1.0, -1.0 }, { 1.0, -1.0 }, { 1.0, -1.0 } } },
};

const char *colormap_words(void)
{
    return "viridis cividis grey";
}

const colormap *colormap_first(void)
{
    return &maps[0];
}

const colormap *colormap_find(const char *word)
{
    for (size_t i = 0; i < sizeof maps / sizeof *maps; i++) {
        if (strcmp(maps[i].word, word) == 0)
            return &maps[i];
    }
    return NULL;
}

const char *colormap_word(const colormap *map)
{
    return map->word;
}

static uint8_t evaluate(const double *coefficients, double fraction)
{
    double value = 0.0;

    for (int k = DEGREE; k >= 0; k--)
        value = value * fraction + coefficients[k];
    return value <= 0.0 ? 0 : value >= 1.0 ? 255 : (uint8_t)(value * 255.0 + 0.5);
}

colormap_color colormap_at(const colormap *map, unsigned level)
{
    BF_CHECK(level < COLORMAP_LEVELS);
    double fraction = (double)level / (COLORMAP_LEVELS - 1);

    return (colormap_color){ .red = evaluate(map->channels[0], fraction),
                             .green = evaluate(map->channels[1], fraction),
                             .blue = evaluate(map->channels[2], fraction) };
}
