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

/// Steps to find the belt under a point.
static double steps_of_lookup(const scene *s)
{
    const size_t n_belts = checked(s->n_sections, SCENE_BELTS_MAX);
    double steps = (double)n_belts;

    for (size_t k = 0; k < n_belts; k++)
        steps += (double)s->belts[k].n_points;
    return steps;
}

static double count_pieces(const scene *s)
{
    double n = 0.0;

    for (size_t k = 0; k < checked(s->n_obstacles, SCENE_OBSTACLES_MAX); k++)
        n += (double)s->obstacles[k].n_points;
    return n;
}

/// An outline's sides with each other.
static double belts_work(const scene *s)
{
    double n_pairs = 0.0;

    for (size_t k = 0; k < checked(s->n_belts, SCENE_BELTS_MAX); k++) {
        const double n = fmin((double)s->belts[k].n_points, SCENE_POINTS_MAX);
        n_pairs += 0.5 * n * n;
    }
    return STEPS_SIDES * n_pairs;
}

/// The belt under each piece, and under those that it may take its side from.
static double obstacles_work(const scene *s)
{
    return (3.0 + 4.0 * SURROUNDINGS_JOINED) * count_pieces(s) * steps_of_lookup(s);
}

/// Belts under the line, and the line with each piece of a plate, below which the belt is looked for, too.
static double feeds_work(const scene *s)
{
    const double lookup = steps_of_lookup(s);

    return (double)checked(s->n_feeds, SCENE_FEEDS_MAX) *
           (POINTS_OF_LINE * lookup + count_pieces(s) * (STEPS_OUTLINES + lookup));
}

/// Belts under the beams that actions and merges wait for.
static double photo_eyes_work(const scene *s)
{
    return s->n_actions == 0 && s->n_merges == 0
               ? 0.0
               : POINTS_OF_BEAM * (double)checked(s->n_eyes, SCENE_EYES_MAX) * steps_of_lookup(s);
}

/// The sides of each outline with each other, and with the lines of feeds.
static double sinks_work(const scene *s)
{
    double n_pairs = 0.0;

    for (size_t k = 0; k < checked(s->n_sinks, SCENE_SINKS_MAX); k++) {
        const double n = fmin((double)s->sinks[k].n_points, SCENE_POINTS_MAX);
        n_pairs += n * (0.5 * n + (double)checked(s->n_feeds, SCENE_FEEDS_MAX));
    }
    return STEPS_SIDES * n_pairs;
}

static const struct {
    const char *pointer;
    double (*work)(const scene *s);
} works[] = {
    { "/belts", belts_work },           { "/obstacles", obstacles_work }, { "/feeds", feeds_work },
    { "/photo_eyes", photo_eyes_work }, { "/sinks", sinks_work },
};

bool check_work(const scene *s, bf_faults *faults)
{
    double sum = 0.0, most = 0.0;
    const char *pointer = "";

    for (size_t k = 0; k < sizeof works / sizeof *works; k++) {
        const double work = works[k].work(s);
        sum += work;
        if (work > most)
            pointer = works[k].pointer;
        most = fmax(most, work);
    }
    if (sum <= SCENE_CHECK_STEPS_MAX)
        return true;
    faults_add_limit(faults, pointer,
                     "the outlines of belts have too many points to check all that lies on them: "
                     "%.3g steps, the limit is %.3g",
                     sum, SCENE_CHECK_STEPS_MAX);
    return false;
}
