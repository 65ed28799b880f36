#include "api/json/number.h"

#include <float.h>
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { DOUBLE_DIGITS_MAX = 17, FLOAT_DIGITS_MAX = 9, READ_SIZE = 64 };

static bool reads_back(const char *text, double value, bool is_float)
{
    return is_float ? strtof(text, NULL) == (float)value : strtod(text, NULL) == value;
}

// The first precision from `digits` on that reads back; %g leaves trailing zeros out, so that
// starting at 15 (6 for floats) finds all shorter numbers of the normal range as well.
static int format_shortest(double value, int digits, int digits_max, bool is_float, char *text)
{
    int n;

    do {
        n = snprintf(text, NUMBER_SIZE, "%.*g", digits, value);
    } while (++digits <= digits_max && !reads_back(text, value, is_float));
    char *comma = strchr(text, ','); // the point of some locales
    if (comma != NULL)
        *comma = '.';
    return n;
}

// "-0" would read back as the integer 0 where integers are a type of their own.
static int format_zero(double value, char *text)
{
    return snprintf(text, NUMBER_SIZE, signbit(value) ? "-0.0" : "0");
}

int number_format(double value, char *ret_text)
{
    if (value == 0.0)
        return format_zero(value, ret_text);
    // Subnormal numbers have fewer digits than 15.
    int digits = fabs(value) < DBL_MIN ? 1 : DBL_DIG;
    return format_shortest(value, digits, DOUBLE_DIGITS_MAX, false, ret_text);
}

int number_format_float(float value, char *ret_text)
{
    if (value == 0.0F)
        return format_zero((double)value, ret_text);
    int digits = fabsf(value) < FLT_MIN ? 1 : FLT_DIG;
    return format_shortest((double)value, digits, FLOAT_DIGITS_MAX, true, ret_text);
}

int number_read(const char *text, size_t n, double *ret_value)
{
    char copy[READ_SIZE];
    char *end;

    if (n == 0 || n >= sizeof copy)
        return -1;
    memcpy(copy, text, n);
    copy[n] = '\0';
    if (strspn(copy, "0123456789+-.eE") != n)
        return -1;
    double value = strtod(copy, &end);
    if (*end != '\0' || !isfinite(value))
        return -1;
    *ret_value = value;
    return 0;
}
