/// The lines of obstacles that close faces, as links between cell centres are tested against them.
///
/// Closed lines have no gaps: a link between cell centres is closed if it touches the line, so that no
/// path along links leads across a line that ends at walls or is closed. But where a cell centre lies on
/// the line itself all its links touch it, and the cell would be cut off. Therefore the links are tested against the
/// line moved downstream by the tolerance, as one piece with its corners: cell centres on the line lie
/// upstream of it, as in the rules of the regions, and the moved line has no gaps either. The line of an obstacle that
/// moves is moved to its right, seen from its start, whatever its angle: so it is the same in the obstacle's own
/// frame at all times.

#pragma once

#include "core/scene/scene.h"
#include "core/scene/surroundings.h"

/// Nearer than this a link touches a line, m: well above rounding, well below the move.
#define CLOSED_LINES_TOUCH (0.1 * SCENE_TOLERANCE)

/// A straight piece of a closed line, longer than the obstacle's by the tolerance at both ends.
typedef struct closed_line {
    vec2 start; ///< m
    vec2 end;   ///< m
} closed_line;

/// What is done with a line; true ends the visit.
typedef bool closed_lines_fn(void *context, const closed_line *l);

/// True if an obstacle closes faces.
bool closed_lines_has(const scene *s, const scene_obstacle *obstacle);

/// Visit the lines of an obstacle, or those of all that close faces. True if a visit was ended.
bool closed_lines_visit_one(const surroundings *around, const scene_obstacle *obstacle,
                            closed_lines_fn *visit, void *context);
bool closed_lines_visit(const scene *s, closed_lines_fn *visit, void *context);

/// True if a line touches the link between two points.
bool closed_line_crosses(const closed_line *l, vec2 from, vec2 to);

/// The part of the segment from a to b whose second coordinate lies in [low, high], as a range of its first one.
/// False if there is none.
bool closed_lines_clip(vec2 a, vec2 b, double low, double high, double *ret_low, double *ret_high);
