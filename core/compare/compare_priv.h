/// Private to compare*.c: integrals along lines.

#pragma once

/// The integral of |gap| over an interval of a width on which the gap goes linearly from one value
/// to another; exact where it crosses zero, too.
double compare__area(double width, double gap, double next_gap);
