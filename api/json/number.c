#include "api/json/number.h"

#include <float.h>
#include <limits.h>
#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { DOUBLE_DIGITS_MAX = 17, FLOAT_DIGITS_MAX = 9, MEASURE_DIGITS = 12, READ_SIZE = 64 };

__extension__ typedef unsigned __int128 wide;

// A positive number, significand * 2^-shift, as a type with n_bits bits has it.
typedef struct binary {
    uint64_t significand;
    int shift;
} binary;

// A decimal number, digits * 10^-n_decimals.
typedef struct decimal {
    uint64_t digits;
    int n_decimals;
} decimal;

// 10^exponent for 0 to 20.
static wide power_of_ten(int exponent)
{
    static const uint64_t powers[] = { 1,       10,       100,       1000,       10000,      100000,
                                       1000000, 10000000, 100000000, 1000000000, 10000000000 };

    return (wide)powers[exponent / 2] * powers[(exponent + 1) / 2];
}

// The nearest decimal number with so many decimals, ties to even, as printf() rounds. True if it reads back: if it is
// nearer to the number than half of the distance to its neighbours.
static bool round_decimal(const binary *b, int n_decimals, decimal *ret_decimal)
{
    const wide unit = power_of_ten(n_decimals), scaled = b->significand * unit;
    const wide half = (wide)1 << (b->shift - 1), rest = scaled & (2 * half - 1);
    wide digits = scaled >> b->shift;

    digits += rest > half || (rest == half && (digits & 1) != 0);
    const wide read = digits << b->shift;
    const wide apart = 2 * (read > scaled ? read - scaled : scaled - read);
    *ret_decimal = (decimal){ .digits = (uint64_t)digits, .n_decimals = n_decimals };
    return apart < unit || (apart == unit && (b->significand & 1) == 0);
}

// format_shortest() for numbers of moderate size, which it writes without an exponent, in integers. 0: not one of these.
static int format_moderate(double value, int digits, int digits_max, int n_bits, char *text)
{
    const double magnitude = fabs(value);
    int exponent;
    decimal d;

    if (!(magnitude >= 1e-4 && magnitude < (n_bits == DBL_MANT_DIG ? 1e14 : 1e5)))
        return 0;
    const binary b = { .significand = (uint64_t)ldexp(frexp(magnitude, &exponent), n_bits),
                       .shift = n_bits - exponent };
    // The neighbour below a power of two is nearer than the one above.
    if ((b.significand & (b.significand - 1)) == 0)
        return 0;
    // The number of decimals that leave this many digits, by log10(2) = 0.30103, or one more.
    int n_decimals = digits - 1 - (int)floor((exponent - 1) * 0.30103);
    if ((b.significand * power_of_ten(n_decimals)) >> b.shift >= power_of_ten(digits))
        n_decimals--;
    while (!round_decimal(&b, n_decimals, &d) && digits < digits_max) {
        digits++;
        n_decimals++;
    }
    char reversed[NUMBER_SIZE];
    int n = 0, n_text = 0;
    for (; d.n_decimals > 0 && d.digits % 10 == 0; d.n_decimals--)
        d.digits /= 10;
    for (int i = 0; i <= d.n_decimals || d.digits > 0; i++, d.digits /= 10) {
        if (i == d.n_decimals && i > 0)
            reversed[n++] = '.';
        reversed[n++] = (char)('0' + d.digits % 10);
    }
    if (value < 0.0)
        reversed[n++] = '-';
    while (n > 0)
        text[n_text++] = reversed[--n];
    text[n_text] = '\0';
    return n_text;
}

// The first precision from `digits` on that reads back; %g leaves trailing zeros out, so that
// starting at 15 (6 for floats) finds all shorter numbers of the normal range as well.
static int format_shortest(double value, int digits, int digits_max, bool is_float, char *text)
{
    int n;

    do {
        n = snprintf(text, NUMBER_SIZE, "%.*g", digits, value);
    } while (++digits <= digits_max &&
             !(is_float ? strtof(text, NULL) == (float)value : strtod(text, NULL) == value));
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
    int n = format_moderate(value, DBL_DIG, DOUBLE_DIGITS_MAX, DBL_MANT_DIG, ret_text);
    if (n > 0)
        return n;
    // Subnormal numbers have fewer digits than 15.
    int digits = fabs(value) < DBL_MIN ? 1 : DBL_DIG;
    return format_shortest(value, digits, DOUBLE_DIGITS_MAX, false, ret_text);
}

int number_format_float(float value, char *ret_text)
{
    if (value == 0.0F)
        return format_zero((double)value, ret_text);
    int n = format_moderate((double)value, FLT_DIG, FLOAT_DIGITS_MAX, FLT_MANT_DIG, ret_text);
    if (n > 0)
        return n;
    int digits = fabsf(value) < FLT_MIN ? 1 : FLT_DIG;
    return format_shortest((double)value, digits, FLOAT_DIGITS_MAX, true, ret_text);
}

double number_round(double value)
{
    char text[NUMBER_SIZE];

    if (!isfinite(value))
        return value;
    (void)snprintf(text, sizeof text, "%.*e", MEASURE_DIGITS - 1, value);
    return strtod(text, NULL);
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

bool number_read_digits(const char *text, uint64_t least, uint64_t most, uint64_t *ret_value)
{
    uint64_t value = 0;

    if (*text == '\0')
        return false;
    for (; *text != '\0'; text++) {
        if (*text < '0' || *text > '9' || __builtin_mul_overflow(value, 10, &value) ||
            __builtin_add_overflow(value, (uint64_t)(*text - '0'), &value))
            return false;
    }
    if (value < least || value > most)
        return false;
    *ret_value = value;
    return true;
}

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
