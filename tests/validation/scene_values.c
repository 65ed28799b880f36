// The figures by which scenes are compared (core/advice/comparisons.h), for table.py: a line for each scenario that is named,
// with its values as C has them. With `validity`, for equipment.py, what validity says of the density instead: "compared", or the
// words of the figures that were not.
//
//     scene_values macro|micro|validity scenario.json...

#include "api/scenario/scenario.h"
#include "core/advice/comparisons.h"
#include "core/base/buffer.h"
#include "core/base/check.h"
#include "server/base/file_io.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void print_values(const scene *s, validity_subject subject)
{
    bf_error err = { 0 };
    double values[COMPARISON_COLUMNS];

    BF_CHECK(validity_values(s, subject, values, &err) == BF_OK);
    for (size_t k = 0; k < COMPARISON_COLUMNS; k++) {
        if (isnan(values[k]))
            printf("NAN%s", k + 1 < COMPARISON_COLUMNS ? ", " : "\n");
        else
            printf("%.4g%s", values[k], k + 1 < COMPARISON_COLUMNS ? ", " : "\n");
    }
}

static void print_validity(const scene *s)
{
    bf_error err = { 0 };
    validity *v = calloc(1, sizeof *v);

    BF_CHECK(v != NULL && validity_of(s, v, &err) == BF_OK);
    printf("%s", v->is_compared ? "compared" : "");
    for (size_t k = 0; k < v->n + v->n_never; k++) {
        const validity_item *item = k < v->n ? &v->items[k] : &v->never[k - v->n];
        printf("%s%s", k > 0 ? ", " : "", validity_words[item->figure]);
    }
    printf("\n");
    free(v);
}

static void print_scene(const char *path, const char *what)
{
    bf_buffer text = { 0 };
    bf_faults faults = { 0 };
    bf_error err = { 0 };
    scene s;

    BF_CHECK(file_io_read(path, NULL, UINT64_C(1) << 26, &text, &err) == BF_OK);
    BF_CHECK(scenario_read(text.bytes, text.n, &s, &faults, &err) == BF_OK && faults.n == 0);
    if (strcmp(what, "validity") == 0)
        print_validity(&s);
    else
        print_values(&s, strcmp(what, "micro") == 0 ? VALIDITY_PARTS_MODEL : VALIDITY_CONGESTED);
    scene_fini(&s);
    buffer_fini(&text);
}

int main(int n_arguments, char **arguments)
{
    BF_CHECK(n_arguments > 1);
    for (int k = 2; k < n_arguments; k++)
        print_scene(arguments[k], arguments[1]);
    return EXIT_SUCCESS;
}
