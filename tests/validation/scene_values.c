// The figures by which scenes are compared (core/advice/comparisons.h), for table.py: a line for each scenario that is named,
// with its values as C has them.
//
//     scene_values macro|micro scenario.json...

#include "api/scenario/scenario.h"
#include "core/advice/comparisons.h"
#include "core/base/buffer.h"
#include "core/base/check.h"
#include "server/base/file_io.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void print_values(const char *path, validity_subject subject)
{
    bf_buffer text = { 0 };
    bf_faults faults = { 0 };
    bf_error err = { 0 };
    double values[COMPARISON_COLUMNS];
    scene s;

    BF_CHECK(file_io_read(path, NULL, UINT64_C(1) << 26, &text, &err) == BF_OK);
    BF_CHECK(scenario_read(text.bytes, text.n, &s, &faults, &err) == BF_OK && faults.n == 0);
    BF_CHECK(validity_values(&s, subject, values, &err) == BF_OK);
    for (size_t k = 0; k < COMPARISON_COLUMNS; k++) {
        if (isnan(values[k]))
            printf("NAN%s", k + 1 < COMPARISON_COLUMNS ? ", " : "\n");
        else
            printf("%.4g%s", values[k], k + 1 < COMPARISON_COLUMNS ? ", " : "\n");
    }
    scene_fini(&s);
    buffer_fini(&text);
}

int main(int n_arguments, char **arguments)
{
    BF_CHECK(n_arguments > 1);
    for (int k = 2; k < n_arguments; k++)
        print_values(arguments[k], strcmp(arguments[1], "micro") == 0 ? VALIDITY_PARTS_MODEL
                                                                      : VALIDITY_CONGESTED);
    return EXIT_SUCCESS;
}
