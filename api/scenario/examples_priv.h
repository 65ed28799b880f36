/// Between examples.c and the file that the build makes from api/examples (embed_examples.cmake).

#pragma once

#include "api/scenario/examples.h"

/// The ready scenarios by rising name, and how many there are.
extern const example examples__list[];
extern const size_t examples__n;
