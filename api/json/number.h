/// Numbers as text that reads back to the same bits, with as few digits as that takes; angles in degrees
/// (documents) and radians (structs).

#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { NUMBER_SIZE = 32 }; ///< bytes that hold any number with its terminator

/// Write a finite double as JSON reads it back ("0.1", "1e-05", "-0.0"): the shortest of 1 to 17
/// significant digits that round-trips. Independent of the locale. Returns the length.
int number_format(double value, char *ret_text);

/// Same for a float: 1 to 9 digits that read back to the same float.
int number_format_float(float value, char *ret_text);

/// The nearest number of 12 significant digits: what is behind them is the rounding of sums and products. What is not
/// finite stays.
double number_round(double value);

/// Read n bytes that are one decimal number and nothing else: no "nan", "inf" or hexadecimal. Returns
/// 0, or -1 if they are anything else, too many, or beyond what a double holds (*ret_value untouched).
int number_read(const char *text, size_t n, double *ret_value);

/// Read text that is nothing but decimal digits, at least one, and a number from least to most. False: it is anything else
/// (*ret_value untouched).
bool number_read_digits(const char *text, uint64_t least, uint64_t most, uint64_t *ret_value);

/// Degrees to radians.
double number_from_degrees(double degrees);

/// The degrees that number_from_degrees() turns into these radians, bit by bit, if there are any;
/// of several, those with the fewest digits. Else the nearest.
double number_to_degrees(double radians);

/// Cosine and sine of an angle in degrees; exact at multiples of 90.
void number_direction(double degrees, double *ret_cos, double *ret_sin);
