#include "api/json/suggest.h"

#include <stdint.h>
#include <string.h>

static size_t smaller(size_t a, size_t b)
{
    return a < b ? a : b;
}

size_t suggest_distance(const char *a, const char *b)
{
    size_t row[SUGGEST_LENGTH_MAX + 1]; // distances of a's first bytes to b's first k
    size_t n_a = strlen(a);
    size_t n_b = strlen(b);

    if (n_a > SUGGEST_LENGTH_MAX || n_b > SUGGEST_LENGTH_MAX)
        return SIZE_MAX;
    for (size_t k = 0; k <= n_b; k++)
        row[k] = k;
    for (size_t i = 0; i < n_a; i++) {
        size_t diagonal = row[0]++;
        for (size_t k = 0; k < n_b; k++) {
            size_t replaced = diagonal + (a[i] != b[k]);
            diagonal = row[k + 1];
            row[k + 1] = smaller(replaced, 1 + smaller(row[k], diagonal));
        }
    }
    return row[n_b];
}

bool suggest_is_near(const char *known, size_t distance)
{
    return distance <= strlen(known) / 2;
}
