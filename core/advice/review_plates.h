/// Plates that stand so that cargo gets past them: warnings about how a deflector stands to the cargo and to the
/// ends of its belt.
///
/// A place is behind a plate if the plate lies upstream of it, along the belt that carries it, and does not lie
/// downstream of it, too. Looked at are plates that neither move nor come and go, along the belts under them. Of those that are
/// shifted it is told if they come nowhere near the domain.

#pragma once

#include "core/advice/review.h"
#include "core/base/status.h"
#include "core/scene/scene.h"

/// Warn of parts that begin behind a plate, of feeds whose parts enter behind one, and of plates that lead cargo to
/// an end beyond the end of the belt, and of plates that are shifted far off the domain. What takes longer than a tenth of a second is left out. BF_ENOMEM.
BF_MUST_CHECK bf_status review_plates(const scene *s, review_warnings *ret_warnings, bf_error *err);
