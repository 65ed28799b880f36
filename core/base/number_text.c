#include "core/base/number_text.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const double whole_max = 1e15; // larger ones have a power of ten

// Puts a comma before each three digits of the whole part.
static void separate(char *text)
{
    const size_t sign = text[0] == '-' ? 1 : 0, n_whole = strspn(text + sign, "0123456789");

    for (size_t n = 3; n < n_whole; n += 3) {
        char *at = text + sign + n_whole - n;
        memmove(at + 1, at, strlen(at) + 1);
        *at = ',';
    }
}

const char *number_text(double value, int digits, char ret_text[NUMBER_TEXT_SIZE])
{
    // From there on numbers of so many digits are whole, when they are rounded.
    const double whole = pow(10.0, digits - 1) - 0.05;

    if (isnan(value)) {
        (void)snprintf(ret_text, NUMBER_TEXT_SIZE, "an unknown value");
        return ret_text;
    }
    if (fabs(value) < whole || !(fabs(value) < whole_max))
        (void)snprintf(ret_text, NUMBER_TEXT_SIZE, "%.*g", digits, value);
    else
        (void)snprintf(ret_text, NUMBER_TEXT_SIZE, "%.0f", value);
    if (fabs(value) < whole_max)
        separate(ret_text);
    return ret_text;
}
