/// Angles between documents (degrees) and structs (radians).

#pragma once

/// Degrees to radians.
double angle_from_degrees(double degrees);

/// The degrees that angle_from_degrees() turns into these radians, bit by bit, if there are any;
/// of several, those with the fewest digits. Else the nearest.
double angle_to_degrees(double radians);

/// Cosine and sine of an angle in degrees; exact at multiples of 90.
void angle_direction(double degrees, double *ret_cos, double *ret_sin);
