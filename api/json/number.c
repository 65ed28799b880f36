#include "api/json/number.h"

#include <float.h>
#include <limits.h>
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

static const double RADIANS_PER_DEGREE = M_PI / 180.0;

double number_from_degrees(double degrees)
{
    return degrees * RADIANS_PER_DEGREE;
}

// Both roundings, of the product and of the quotient, move the degrees by at most one unit in the
// last place of the larger binade: three neighbours on each side hold the number that was read.
double number_to_degrees(double radians)
{
    enum { NEIGHBOURS = 3 };
    char text[NUMBER_SIZE];
    double nearest = radians / RADIANS_PER_DEGREE;
    double best = nearest;
    double candidate = nearest;
    int fewest = INT_MAX;

    if (radians == 0.0) // -0 stays -0
        return radians;
    for (int k = 0; k < NEIGHBOURS; k++)
        candidate = nextafter(candidate, -INFINITY);
    for (int k = -NEIGHBOURS; k <= NEIGHBOURS; k++, candidate = nextafter(candidate, INFINITY)) {
        if (!isfinite(candidate) || number_from_degrees(candidate) != radians)
            continue;
        int n = number_format(candidate, text);
        if (n < fewest) {
            fewest = n;
            best = candidate;
        }
    }
    return best;
}

void number_direction(double degrees, double *ret_cos, double *ret_sin)
{
    static const double quarters[4][2] = { { 1, 0 }, { 0, 1 }, { -1, 0 }, { 0, -1 } };
    double quarter = fmod(degrees, 360.0) / 90.0;

    if (quarter == floor(quarter)) {
        int k = ((int)quarter + 4) % 4;
        *ret_cos = quarters[k][0];
        *ret_sin = quarters[k][1];
        return;
    }
    *ret_cos = cos(number_from_degrees(degrees));
    *ret_sin = sin(number_from_degrees(degrees));
}
