// The checks of merges.

#include "core/scene/ranges.h"
#include "core/scene/scene_priv.h"

#include <math.h>
#include <stdio.h>

/// True if a lane before this one, of any merge, has its belt, or its eye.
static bool is_taken(const scene *s, size_t merge, size_t lane, bool by_eye)
{
    const scene_lane *of = &s->merges[merge].lanes[lane];

    for (size_t k = 0; k <= merge; k++) {
        const size_t n = k < merge ? s->merges[k].n_lanes : lane;
        for (size_t i = 0; i < n; i++) {
            const scene_lane *other = &s->merges[k].lanes[i];
            if (by_eye ? other->eye == of->eye : other->belt == of->belt)
                return true;
        }
    }
    return false;
}

/// Note what is wrong with the belt of a lane: nothing else may command it.
static void check_belt(const scene *s, size_t merge, size_t lane, const char *pointer,
                       bf_faults *faults)
{
    const size_t belt = s->merges[merge].lanes[lane].belt;
    bool is_target = false;

    for (size_t k = 0; k < s->n_actions && s->n_actions <= SCENE_ACTIONS_MAX; k++)
        is_target =
            is_target || (s->actions[k].type == SCENE_ACTION_BELT && s->actions[k].target == belt);
    if (belt >= s->n_belts)
        faults_add(faults, pointer, "must be the id of a belt in the scenario");
    else if (is_taken(s, merge, lane, false))
        faults_add(faults, pointer, "is the belt of another lane, too");
    else if (is_target)
        faults_add(faults, pointer, "is commanded by an action, too");
    else if (s->belts[belt].speed_schedule.n_times > 0)
        faults_add(faults, pointer, "has a speed_schedule, which its merge would replace");
}

static void check_eye(const scene *s, size_t merge, size_t lane, const char *pointer,
                      bf_faults *faults)
{
    const size_t eye = s->merges[merge].lanes[lane].eye;

    if (eye >= s->n_eyes)
        faults_add(faults, pointer, "must be the id of a photo eye in the scenario");
    else if (is_taken(s, merge, lane, true))
        faults_add(faults, pointer, "is the photo eye of another lane, too");
    else if (s->eyes[eye].density_ratio != 0.0)
        faults_add(faults, pointer, "an eye that sees a density (density_ratio) sees no parts");
}

void scene__check_merges(const scene *s, bf_faults *faults)
{
    char pointer[BF_POINTER_SIZE], at[BF_POINTER_SIZE + 2 * ROOM_FOR_INDEX];

    if (!scene__check_count(s->n_merges, SCENE_MERGES_MAX, "/merges", "merges", faults))
        return;
    for (size_t k = 0; k < s->n_merges; k++) {
        const scene_merge *merge = &s->merges[k];
        scene__check_id(s->merges, sizeof *s->merges, "merges", k, faults);
        snprintf(pointer, sizeof pointer, "/merges/%zu", k);
        snprintf(at, sizeof at, "%s/order", pointer);
        if ((unsigned)merge->order >= SCENE_MERGE_ORDER_COUNT)
            faults_add(faults, at, "is not an order of lanes");
        snprintf(at, sizeof at, "%s/parts", pointer);
        scene__check_limit(merge->parts, at, faults);
        snprintf(at, sizeof at, "%s/time_s", pointer);
        if (merge->time != INFINITY)
            range_check(&scene_range_time, merge->time, at, faults);
        snprintf(at, sizeof at, "%s/gap_s", pointer);
        range_check(&scene_range_instant, merge->gap, at, faults);
        snprintf(at, sizeof at, "%s/lanes", pointer);
        if (merge->n_lanes < 2 || merge->n_lanes > SCENE_LANES_MAX) {
            faults_add(faults, at, "must have 2 to %d lanes, not %zu", SCENE_LANES_MAX,
                       merge->n_lanes);
            return;
        }
        for (size_t i = 0; i < merge->n_lanes; i++) {
            snprintf(at, sizeof at, "%s/lanes/%zu/belt", pointer, i);
            check_belt(s, k, i, at, faults);
            snprintf(at, sizeof at, "%s/lanes/%zu/photo_eye", pointer, i);
            check_eye(s, k, i, at, faults);
        }
    }
}
