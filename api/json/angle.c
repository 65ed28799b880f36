#include "api/json/angle.h"

#include "api/json/number.h"

#include <limits.h>
#include <math.h>

static const double RADIANS_PER_DEGREE = M_PI / 180.0;

double angle_from_degrees(double degrees)
{
    return degrees * RADIANS_PER_DEGREE;
}

// Both roundings, of the product and of the quotient, move the degrees by at most one unit in the
// last place of the larger binade: three neighbours on each side hold the number that was read.
double angle_to_degrees(double radians)
{
    enum { NEIGHBOURS = 3 };
    char text[NUMBER_SIZE];
    double nearest = radians / RADIANS_PER_DEGREE;
    double best = nearest;
    double candidate = nearest;
    int fewest = INT_MAX;

    if (radians == 0.0) // keeps its sign
        return radians;
    for (int k = 0; k < NEIGHBOURS; k++)
        candidate = nextafter(candidate, -INFINITY);
    for (int k = -NEIGHBOURS; k <= NEIGHBOURS; k++, candidate = nextafter(candidate, INFINITY)) {
        if (!isfinite(candidate) || angle_from_degrees(candidate) != radians)
            continue;
        int n = number_format(candidate, text);
        if (n < fewest) {
            fewest = n;
            best = candidate;
        }
    }
    return best;
}

void angle_direction(double degrees, double *ret_cos, double *ret_sin)
{
    static const double quarters[4][2] = { { 1, 0 }, { 0, 1 }, { -1, 0 }, { 0, -1 } };
    double quarter = fmod(degrees, 360.0) / 90.0;

    if (quarter == floor(quarter)) {
        int k = ((int)quarter + 4) % 4;
        *ret_cos = quarters[k][0];
        *ret_sin = quarters[k][1];
        return;
    }
    *ret_cos = cos(angle_from_degrees(degrees));
    *ret_sin = sin(angle_from_degrees(degrees));
}
