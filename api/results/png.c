// Pictures by libpng, which reports failures by a jump: what lives across it is in one struct, and
// everything that may jump is called below one setjmp().

#include "api/results/results.h"

#include "api/results/results_priv.h"
#include "core/base/memory.h"

#include <png.h>
#include <setjmp.h>
#include <stdio.h>
#include <stdlib.h>

enum { PALETTE_BITS = 8, DESCRIPTION_SIZE = 160 };

// What is written, and room for it.
typedef struct drawing {
    const picture *picture;
    const colormap *map;
    const uint8_t *levels; // of all pixels
    double t;
    bf_buffer *out;
    png_struct *png;
    png_info *info;
} drawing;

static void *allocate(png_struct *png, size_t n)
{
    (void)png;
    return memory_alloc_plain(n);
}

static void release(png_struct *png, void *block)
{
    (void)png;
    free(block);
}

static void jump(png_struct *png, const char *text)
{
    (void)text;
    png_longjmp(png, 1);
}

static void pass_over(png_struct *png, const char *text)
{
    (void)png;
    (void)text;
}

static void append(png_struct *png, uint8_t *bytes, size_t n)
{
    if (buffer_append(png_get_io_ptr(png), bytes, n) != BF_OK)
        png_error(png, "out of memory");
}

static void flush(png_struct *png)
{
    (void)png;
}

static void write_all(const drawing *d)
{
    const picture *p = d->picture;

    png_set_write_fn(d->png, d->out, append, flush);
    png_set_IHDR(d->png, d->info, (png_uint_32)p->width, (png_uint_32)p->height, PALETTE_BITS,
                 PNG_COLOR_TYPE_PALETTE, PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT,
                 PNG_FILTER_TYPE_DEFAULT);
    png_color colors[COLORMAP_LEVELS];
    for (unsigned level = 0; level < COLORMAP_LEVELS; level++) {
        colormap_color c = colormap_at(d->map, level);
        colors[level] = (png_color){ c.red, c.green, c.blue };
    }
    png_set_PLTE(d->png, d->info, colors, COLORMAP_LEVELS);
    char key[] = "Description", text[DESCRIPTION_SIZE];
    png_text item = { .compression = PNG_TEXT_COMPRESSION_NONE, .key = key, .text = text };
    snprintf(text, sizeof text,
             "Density at t = %g s, %s from 0 to %g (1 is close packing), x to the right, y up",
             d->t, colormap_word(d->map), d->picture->top);
    png_set_text(d->png, d->info, &item, 1);
    png_write_info(d->png, d->info);
    for (size_t row = 0; row < p->height; row++)
        png_write_row(d->png, d->levels + row * p->width);
    png_write_end(d->png, d->info);
}

static bool draw(drawing *d)
{
    d->png = png_create_write_struct_2(PNG_LIBPNG_VER_STRING, NULL, jump, pass_over, NULL, allocate,
                                       release);
    if (d->png == NULL)
        return false;
    if (setjmp(png_jmpbuf(d->png)) != 0)
        return false;
    d->info = png_create_info_struct(d->png);
    if (d->info == NULL)
        return false;
    write_all(d);
    return true;
}

bf_status results_snapshot_png(const picture *p, const colormap *map, const uint8_t *levels,
                               double t, bf_buffer *out, bf_error *err)
{
    size_t n_before = out->n;
    drawing d = { .picture = p, .map = map, .levels = levels, .t = t, .out = out };

    bool is_drawn = draw(&d);
    png_destroy_write_struct(&d.png, &d.info);
    return results__finish(is_drawn ? BF_OK : BF_ENOMEM, out, n_before, err);
}
