
#include "api/scenario/scenario_priv.h"

#include "api/json/number.h"
#include "api/scenario/scenario_members.h"
#include "core/base/memory.h"

#include <jansson.h>
#include <string.h>

enum { BY_END, BY_ENDS, BY_PATH, FORM_COUNT };

static const char *const by_end[] = { "end_m", "angle_deg", "length_m", NULL };
static const char *const by_ends[] = { "from_m", "to_m", NULL };
static const char *const by_path[] = { "path_m", NULL };

const char *const *const obstacle_form__members[] = {
    [BY_END] = by_end, [BY_ENDS] = by_ends, [BY_PATH] = by_path, [FORM_COUNT] = NULL
};

static bool has_any(const json_t *object, const char *const *names)
{
    for (; *names != NULL; names++) {
        if (json_object_get(object, *names) != NULL)
            return true;
    }
    return false;
}

// False: a fault was noted.
static bool read_form(json_in *in, const json_t *object, const char *const *names,
                      obstacle_form *form)
{
    size_t n_faults = in->faults->n;

    for (const char *const *name = names; *name != NULL; name++) {
        const json_t *value = json_object_get(object, *name);
        size_t mark = json_pointer_enter(&in->pointer, *name, strlen(*name));
        const member *m = scenario_members_obstacle.members;
        while (strcmp(m->name, *name) != 0)
            m++;
        if (value != NULL)
            m->kind->read(in, value, m, form);
        else
            json_in_fault(in, "is missing beside %s", name == names ? names[1] : names[0]);
        json_pointer_leave(&in->pointer, mark);
    }
    return in->faults->n == n_faults;
}

static bool check_length(json_in *in, double length)
{
    if (length > 0.0)
        return true;
    size_t mark = json_pointer_enter(&in->pointer, "length_m", strlen("length_m"));
    json_in_fault(in, "must be > 0, not %.15g", length);
    json_pointer_leave(&in->pointer, mark);
    return false;
}

static void set_path(json_in *in, vec2 from, vec2 to, scene_obstacle *obstacle)
{
    vec2 *path = memory_alloc(2, sizeof *path);

    if (path == NULL) {
        in->has_failed = true;
        return;
    }
    path[0] = from;
    path[1] = to;
    obstacle->path = path;
    obstacle->n_points = 2;
}

static vec2 start_of(const obstacle_form *form)
{
    double cosine;
    double sine;

    number_direction(form->angle, &cosine, &sine);
    return (vec2){ form->end.x - form->length * cosine, form->end.y - form->length * sine };
}

void obstacle_form__read(json_in *in, const struct json_t *object, void *obstacle)
{
    obstacle_form form = { 0 };
    int n_forms = 0;
    int which = BY_PATH;

    for (int k = 0; k < FORM_COUNT; k++) {
        if (has_any(object, obstacle_form__members[k])) {
            n_forms++;
            which = k;
        }
    }
    if (n_forms != 1) {
        json_in_fault(in,
                      "must have exactly one of: end_m with angle_deg and length_m; from_m with "
                      "to_m; path_m");
        return;
    }
    if (which == BY_PATH || !read_form(in, object, obstacle_form__members[which], &form))
        return;
    if (which == BY_ENDS)
        set_path(in, form.from, form.to, obstacle);
    else if (check_length(in, form.length))
        set_path(in, start_of(&form), form.end, obstacle);
}
