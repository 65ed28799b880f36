/// Numbers in sentences, as the page has them: significant digits, whole numbers with all of theirs, thousands apart.
///
///     155578.8 with 3 digits "155,579"    99.96 "100"    12.34 "12.3"    0.00012 "0.00012"    1e-7 "1e-07"

#pragma once

enum { NUMBER_TEXT_SIZE = 32 }; ///< bytes of a text with its terminator

/// Write a number with at least so many significant digits, 1 to 9, as far as it has them. "an unknown value" for NAN.
/// Returns ret_text.
const char *number_text(double value, int digits, char ret_text[NUMBER_TEXT_SIZE]);
