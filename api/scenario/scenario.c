#include "api/scenario/scenario.h"

#include "api/json/json_out.h"
#include "api/json/members.h"
#include "api/scenario/scenario_members.h"
#include "api/scenario/scenario_priv.h"
#include "core/observe/columns.h"

#include <stdio.h>
#include <string.h>

// Faults of core point into the scenario, which may be a member of a larger document.
static void prefix_pointers(json_in *in, size_t n_kept)
{
    char pointer[BF_POINTER_SIZE];

    for (size_t k = n_kept; k < faults_kept(in->faults); k++) {
        bf_error *fault = &in->faults->items[k];
        memcpy(pointer, fault->pointer, sizeof pointer);
        const size_t n =
            (size_t)snprintf(fault->pointer, sizeof fault->pointer, "%s", in->pointer.text);
        snprintf(fault->pointer + n, sizeof fault->pointer - n, "%s", pointer);
    }
}

// Ids must be there before they are looked up; other derived values follow from what they name.
static bool resolve(json_in *in, const struct json_t *document, scene *s)
{
    size_t n_faults = in->faults->n;

    in->has_failed = in->has_failed || scene_resolve(s, NULL) != BF_OK;
    if (!in->has_failed)
        scenario__look_up(in, document, s);
    in->has_failed = in->has_failed || scene_resolve(s, NULL) != BF_OK;
    return !in->has_failed && in->faults->n == n_faults;
}

bool scenario__complete(json_in *in, const struct json_t *document, scene *s)
{
    if (!resolve(in, document, s))
        return false;
    size_t n_kept = faults_kept(in->faults);
    size_t n_faults = in->faults->n;
    scene_check(s, in->faults);
    prefix_pointers(in, n_kept);
    return in->faults->n == n_faults;
}

void scenario__check_model(json_in *in, const scene *s, run_model model)
{
    size_t n_kept = faults_kept(in->faults);

    run_check(s, model, in->faults);
    prefix_pointers(in, n_kept);
}

// Reads a tree and completes the scene. False: faults were noted, or there is no memory.
static bool read_tree(json_in *in, const struct json_t *tree,
                      bool (*complete)(json_in *, const struct json_t *, scene *), scene *ret_scene)
{
    const size_t n_faults = in->faults->n;
    scene s;

    scene_init(&s);
    members_read(in, tree, &scenario_members, &s);
    const bool is_read = in->faults->n == n_faults && !in->has_failed && complete(in, tree, &s);
    if (is_read)
        *ret_scene = s;
    else
        scene_fini(&s);
    return is_read;
}

bf_status scenario_read(const char *json, size_t n, scene *ret_scene, bf_faults *faults,
                        bf_error *err)
{
    json_in in = json_in_to(faults);
    struct json_t *root = json_in_parse(&in, json, n);

    if (root != NULL)
        (void)read_tree(&in, root, scenario__complete, ret_scene);
    json_in_free(root);
    return json_in_status(&in, err);
}

bool scenario_read_tree(json_in *in, const struct json_t *tree, run_model model, scene *ret_scene)
{
    scene s;

    if (!read_tree(in, tree, scenario__complete, &s))
        return false;
    const size_t n_faults = in->faults->n;
    scenario__check_model(in, &s, model);
    if (in->faults->n > n_faults) {
        scene_fini(&s);
        return false;
    }
    *ret_scene = s;
    return true;
}

bf_status scenario_read_resolved_tree(const struct json_t *tree, scene *ret_scene, bf_error *err)
{
    bf_faults faults = { 0 };
    json_in in = json_in_to(&faults);

    if (tree != NULL && read_tree(&in, tree, resolve, ret_scene))
        return BF_OK;
    return in.has_failed ? json_in_status(&in, err)
                         : bf_fail(err, BF_ECORRUPT, "", "the scenario is damaged");
}

bf_status scenario_read_resolved(const char *json, size_t n, scene *ret_scene, bf_error *err)
{
    bf_faults faults = { 0 };
    json_in in = json_in_to(&faults);
    struct json_t *root = json_in_parse(&in, json, n);

    const bf_status status = in.has_failed ? json_in_status(&in, err)
                                           : scenario_read_resolved_tree(root, ret_scene, err);
    json_in_free(root);
    return status;
}

bf_status scenario_write(const scene *s, bf_buffer *out, bf_error *err)
{
    size_t n = out->n;
    json_out w = json_out_to(out);

    w.whole = s;
    members_write(&w, &scenario_members, s);
    bf_status status = json_out_status(&w, err);
    if (status != BF_OK)
        buffer_truncate(out, n);
    return status;
}

bf_status scenario_columns(const scene *s, bf_buffer *out, bf_error *err)
{
    size_t n = out->n;
    bf_status status = BF_OK;

    for (size_t k = 0; k < columns_count(s) && status == BF_OK; k++) {
        char name[COLUMN_NAME_SIZE];
        columns_name(s, k, name);
        status = buffer_printf(out, "%s%s", k == 0 ? "" : ",", name);
    }
    if (status != BF_OK) {
        buffer_truncate(out, n);
        return bf_fail_memory(err);
    }
    return BF_OK;
}
