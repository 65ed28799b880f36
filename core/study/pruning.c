#include "core/study/pruning.h"

#include <math.h>

// The least value that the figure can have at the end.
static double least_value(const pruning_state *now)
{
    switch (now->figure) {
    case FIGURE_JAM_COUNT:
    case FIGURE_JAM_TOTAL:
    case FIGURE_QUEUE_END:
    case FIGURE_PEAK:
    case FIGURE_OFFERED:
    case FIGURE_ADMITTED:
    case FIGURE_DISCARDED:
    case FIGURE_WAITING_MAX:
    case FIGURE_CONTENT_MAX:
        return now->value;
    case FIGURE_DRAINED_AT:
        return isnan(now->value) ? now->t : now->value;
    default:
        return (double)-INFINITY;
    }
}

bool pruning_is_hopeless(const pruning_state *now, double best)
{
    if (!now->is_maximized)
        return least_value(now) > best;
    return now->figure == FIGURE_GAP_MIN && now->value < best; // others may still grow
}
