/// What is said of a figure that was not compared, for people.

#pragma once

#include "core/advice/validity.h"

/// Why a value was not compared.
typedef enum validity_way {
    VALIDITY_TOO_SMALL,      ///< for its range
    VALIDITY_TOO_LARGE,      ///< for its range
    VALIDITY_NEVER_COMPARED, ///< there is no range, or the value is not known
    VALIDITY_WAY_COUNT
} validity_way;

/// Fill in what follows from figure and value of an item: unit, range and texts.
void validity_complete(validity_item *item, validity_subject of, validity_way way);
