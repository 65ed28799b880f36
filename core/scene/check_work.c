#include "core/scene/check_work.h"

#include "core/scene/surroundings.h"

#include <math.h>

// Steps for a pair of sides that may touch, and for a pair of outlines whose distance is measured.
enum { STEPS_SIDES = 20, STEPS_OUTLINES = 120 };

// Points of the line of a feed, for its check and its capacity, and of a beam, that belts are looked for under.
enum { POINTS_OF_LINE = 101 + 1000, POINTS_OF_BEAM = 101 };

/// How many items of a list are checked one by one: none where there are more than may be.
static size_t checked(size_t n, size_t most)
{
    return n <= most ? n : 0;
}

bool check_work(const scene *s, bf_faults *faults)
{
    const size_t n_belts = checked(s->n_sections, SCENE_BELTS_MAX);
    const double n_feeds = (double)checked(s->n_feeds, SCENE_FEEDS_MAX);
    // Belts are looked for under the beams that actions and merges wait for.
    const bool are_awaited = s->n_actions > 0 || s->n_merges > 0;
    const double n_beams = are_awaited ? (double)checked(s->n_eyes, SCENE_EYES_MAX) : 0.0;
    double lookup = (double)n_belts; // steps to find the belt under a point
    double n_pieces = 0.0, belt_sides = 0.0, sink_sides = 0.0, sum = 0.0, most = 0.0;
    const char *pointer = "";

    for (size_t k = 0; k < n_belts; k++)
        lookup += (double)s->belts[k].n_points;
    for (size_t k = 0; k < checked(s->n_obstacles, SCENE_OBSTACLES_MAX); k++)
        n_pieces += (double)s->obstacles[k].n_points;
    // Pairs of the sides of an outline; those of a sink are compared with the lines of feeds, too.
    for (size_t k = 0; k < checked(s->n_belts, SCENE_BELTS_MAX); k++) {
        const double n = fmin((double)s->belts[k].n_points, SCENE_POINTS_MAX);
        belt_sides += 0.5 * n * n;
    }
    for (size_t k = 0; k < checked(s->n_sinks, SCENE_SINKS_MAX); k++) {
        const double n = fmin((double)s->sinks[k].n_points, SCENE_POINTS_MAX);
        sink_sides += n * (0.5 * n + n_feeds);
    }
    const struct {
        const char *pointer;
        double steps;
    } works[] = {
        { "/belts", STEPS_SIDES * belt_sides },
        // The belt under each piece, and under those that it may take its side from.
        { "/obstacles", (3.0 + 4.0 * SURROUNDINGS_JOINED) * n_pieces * lookup },
        // Belts under the line, and the line with each piece of a plate, below which the belt is looked for, too.
        { "/feeds", n_feeds * (POINTS_OF_LINE * lookup + n_pieces * (STEPS_OUTLINES + lookup)) },
        { "/photo_eyes", POINTS_OF_BEAM * n_beams * lookup },
        { "/sinks", STEPS_SIDES * sink_sides },
    };
    for (size_t k = 0; k < sizeof works / sizeof *works; k++) {
        sum += works[k].steps;
        if (works[k].steps > most)
            pointer = works[k].pointer;
        most = fmax(most, works[k].steps);
    }
    if (sum <= SCENE_CHECK_STEPS_MAX)
        return true;
    faults_add_limit(faults, pointer,
                     "the outlines of belts have too many points to check all that lies on them: "
                     "%.3g steps, the limit is %.3g",
                     sum, SCENE_CHECK_STEPS_MAX);
    return false;
}
