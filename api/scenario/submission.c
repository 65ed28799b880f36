#include "api/scenario/submission.h"

#include "api/json/members.h"
#include "api/scenario/review_members.h"
#include "api/scenario/scenario.h"
#include "api/scenario/scenario_members.h"
#include "api/scenario/scenario_priv.h"
#include "core/base/memory.h"
#include "core/scene/placement.h"

#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

// What the body is read into.
typedef struct body {
    scene scenario;
    run_model model;
    char label[API_LABEL_SIZE];
    char line[API_LABEL_SIZE];
    int priority;
    bool is_fresh;
    uint64_t replications;
} body;

const bf_range submission_priorities = { .minimum = -API_PRIORITY_MAX,
                                         .maximum = API_PRIORITY_MAX };

static const bf_range replications_range = { .minimum = 1, .maximum = SUBMISSION_REPLICATIONS_MAX };

#define AT(place) offsetof(body, place)
static const member members[] = {
    MEMBER("scenario", object, AT(scenario), "what to solve", .table = &scenario_members),
    MEMBER("model", enum, AT(model), "which solver", .words = run_model_words,
           .flags = MEMBER_INIT),
    MEMBER("label", text, AT(label), "the client's own name of the run", .limit = API_LABEL_SIZE,
           .flags = MEMBER_INIT),
    MEMBER("line", text, AT(line),
           "the line that it belongs to: runs of one with other scenarios are its versions",
           .limit = API_LABEL_SIZE, .flags = MEMBER_INIT),
    MEMBER(
        "priority", int, AT(priority),
        "higher ones first; above 0 wants a token with the scope priority, where there are tokens",
        .range = &submission_priorities, .flags = MEMBER_INIT),
    MEMBER("fresh", bool, AT(is_fresh), "solve it even if the results are known",
           .flags = MEMBER_INIT),
    MEMBER(
        "replications", seed, AT(replications),
        "runs at successive substreams: 2 and more are a study, which is answered in place of the "
        "run; without chance it solves one",
        .range = &replications_range, .flags = MEMBER_INIT),
};
#undef AT

static void init_body(void *item, size_t place)
{
    body *b = item;

    (void)place;
    *b = (body){ .model = RUN_MACRO, .replications = 1 };
    scene_init(&b->scenario);
}

const member_table submission_members = { MEMBER_TABLE("submission", members), .size = sizeof(body),
                                          .init = init_body };

static bool check_model(json_in *in, run_model model)
{
    if (run_model_is_available(model))
        return true;
    size_t mark = json_pointer_enter(&in->pointer, "model", strlen("model"));
    json_in_fault(in, "this build does not have the model \"%s\"", run_model_words[model]);
    json_pointer_leave(&in->pointer, mark);
    return false;
}

static bf_status read_body(json_in *in, const struct json_t *root, body *b, bf_error *err)
{
    members_read(in, root, &submission_members, b);
    if (b->replications > 1 && b->is_fresh)
        faults_add(in->faults, "/fresh",
                   "belongs to one run; of replications, those that are known are taken");
    if (in->has_failed || in->faults->n > 0)
        return json_in_status(in, err);
    bool has_model = check_model(in, b->model);
    size_t mark = json_pointer_enter(&in->pointer, "scenario", strlen("scenario"));
    if (scenario__complete(in, json_object_get(root, "scenario"), &b->scenario) && has_model)
        scenario__check_model(in, &b->scenario, b->model);
    json_pointer_leave(&in->pointer, mark);
    return json_in_status(in, err);
}

bf_status submission_make(const scene *s, run_model model, api_submission *ret_submission,
                          bf_error *err)
{
    api_submission made = { .model = model };
    scene nameless = *s; // scenarios that differ in their names only have the same results

    nameless.name[0] = '\0';
    snprintf(made.name, sizeof made.name, "%s", s->name);
    if (model == RUN_MACRO)
        snprintf(made.closure, sizeof made.closure, "%s", scenario_closure_words[s->macro.closure]);
    bf_status status = scenario_write(s, &made.scenario, err);
    if (status == BF_OK)
        status = scenario_columns(s, &made.columns, err);
    if (status == BF_OK)
        status = scenario_write(&nameless, &made.identity, err);
    if (status == BF_OK)
        *ret_submission = made;
    else
        submission_fini(&made);
    return status;
}

bf_status submission_identity(const char *scenario, size_t n, bf_buffer *out, bf_error *err)
{
    scene s;

    BF_TRY(scenario_read_resolved(scenario, n, &s, err));
    s.name[0] = '\0';
    bf_status status = scenario_write(&s, out, err);
    scene_fini(&s);
    return status;
}

bf_status submission_read(const char *json, size_t n, json_in_texts *texts,
                          api_submission *ret_submission, bf_faults *faults, bf_error *err)
{
    json_in in = json_in_to(faults);
    struct json_t *root = json_in_parse(&in, json, n);
    body b;

    in.texts = texts;
    if (root == NULL)
        return json_in_status(&in, err);
    init_body(&b, 0);
    bf_status status = read_body(&in, root, &b, err);
    json_in_free(root);
    if (status == BF_OK)
        status = submission_make(&b.scenario, b.model, ret_submission, err);
    if (status == BF_OK) {
        snprintf(ret_submission->label, sizeof ret_submission->label, "%s", b.label);
        snprintf(ret_submission->line, sizeof ret_submission->line, "%s", b.line);
        ret_submission->priority = b.priority;
        ret_submission->is_fresh = b.is_fresh;
        ret_submission->replications = b.replications;
    }
    scene_fini(&b.scenario);
    return status;
}

static void write_true(json_out *w, const member *m, const void *item)
{
    (void)m;
    (void)item;
    json_out_bool(w, true);
}

static const member_kind member_true = { .type = "boolean", .write = write_true };

// A part at the start.
typedef struct start_part {
    scene_pose pose;
    uint64_t kind;
} start_part;

#define AT(place) offsetof(start_part, place)
static const member part_members[] = {
    MEMBER("x_m", number, AT(pose.x), "Its centre, along x", .unit = "m"),
    MEMBER("y_m", number, AT(pose.y), "Its centre, along y", .unit = "m"),
    MEMBER("heading_rad", number, AT(pose.heading), "Its turn about the vertical, from the x axis",
           .unit = "rad"),
    MEMBER("kind", size, AT(kind), "Its kind, an index in `cargo` of the scenario"),
};
const member_table submission_part_members = { MEMBER_TABLE("PartAtStart", part_members) };
#undef AT

// What a validation is written from.
typedef struct validation {
    const char *document; // the resolved one
    size_t n_document;
    advice advice;
    bf_grid grid;
    double predicted_s; // NAN: not known
    size_t parts_max;
    scene_placement placement; // where parts_max > 0
} validation;

static void write_warnings(json_out *w, const member *m, const void *item)
{
    const validation *of = item;

    (void)m;
    review_write_texts(w, &of->advice.warnings);
}

static bool has_parts(const void *item)
{
    const validation *of = item;

    return of->parts_max > 0;
}

static void write_parts(json_out *w, const member *m, const void *item)
{
    const validation *of = item;
    const scene_placement *p = &of->placement;
    const size_t n = p->n < of->parts_max ? p->n : of->parts_max;

    (void)m;
    json_out_array(w);
    for (size_t k = 0; k < n; k++) {
        const size_t at = k * p->n / n;
        const start_part part = { p->poses[at], p->kinds == NULL ? 0 : p->kinds[at] };
        members_write(w, &submission_part_members, &part);
    }
    json_out_array_end(w);
}

static const member_kind member_parts = { .type = "[#PartAtStart]", .write = write_parts };
static const member_kind member_warnings = { .type = "[string]", .write = write_warnings };

#define AT(place) offsetof(validation, place)
static const member validation_members[] = {
    MEMBER("valid", true, 0, "Always true: what is not valid is answered with a problem"),
    MEMBER("model", enum, AT(advice.model), "The model that it was checked for",
           .words = run_model_words, .type = "#Model"),
    MEMBER("cell_m", point, AT(grid.d1), "Edges of a cell along x and y, as fitted to the domain",
           .unit = "m, m"),
    MEMBER("shape", shape, AT(grid), "Rows of cells along y and columns along x"),
    MEMBER("warnings", warnings, 0,
           "Reasons to doubt the results; the summary will have them, too"),
    MEMBER("warning_details", array, AT(advice.warnings.items),
           "The same warnings, each with its parts", .table = &review_warning_members,
           .offset_n = AT(advice.warnings.n), .limit = REVIEW_WARNINGS_MAX),
    MEMBER("predicted_s", measure, AT(predicted_s),
           "CPU time that the run will take on one core of the service's machine", .unit = "s",
           .null = "not known in the first second of the service"),
    MEMBER("validity", object, AT(advice.validity),
           "Whether the model was compared for scenarios like this one",
           .table = &review_validity_members),
    MEMBER("parts", parts, 0,
           "With the parameter `parts`: where parts stand at the start, in the order of placement; "
           "where there are more, so many of them, evenly chosen",
           .applies = has_parts),
    MEMBER("resolved", raw, AT(document), "The scenario with every default filled in",
           .offset_n = AT(n_document), .type = "#ResolvedScenario"),
};
const member_table submission_validation_members = { MEMBER_TABLE("Validation",
                                                                  validation_members) };
#undef AT

static bf_status predict(const scene *s, run_model model, const prediction_speed *speed,
                         double *ret_seconds, bf_error *err)
{
    prediction_work work;

    if (speed == NULL)
        return BF_OK;
    BF_TRY(prediction_work_of(s, model, &work, err));
    *ret_seconds = prediction_seconds(&work, speed);
    return BF_OK;
}

bf_status submission_validation(const api_submission *submission, const prediction_speed *speed,
                                size_t parts_max, bf_buffer *out, bf_error *err)
{
    json_out w = json_out_to(out);
    scene s;

    BF_TRY(scenario_read_resolved(submission->scenario.bytes, submission->scenario.n, &s, err));
    validation *of = memory_alloc(1, sizeof *of);
    if (of == NULL) {
        scene_fini(&s);
        return bf_fail_memory(err);
    }
    of->document = submission->scenario.bytes;
    of->n_document = submission->scenario.n;
    of->predicted_s = (double)NAN;
    of->parts_max = parts_max;
    of->grid = scene_grid(&s);
    bf_status status = advice_of(&s, submission->model, &of->advice, err);
    if (status == BF_OK)
        status = predict(&s, submission->model, speed, &of->predicted_s, err);
    if (status == BF_OK && parts_max > 0)
        status = placement_make(&s, &of->placement, err);
    if (status == BF_OK) {
        members_write(&w, &submission_validation_members, of);
        status = json_out_status(&w, err);
    }
    placement_fini(&of->placement);
    memory_free(of);
    scene_fini(&s);
    return status;
}

void submission_fini(api_submission *submission)
{
    if (submission == NULL)
        return;
    buffer_fini(&submission->scenario);
    buffer_fini(&submission->columns);
    buffer_fini(&submission->identity);
    *submission = (api_submission){ 0 };
}
