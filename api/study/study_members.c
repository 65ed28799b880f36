// The document of a study as tables.

#include "api/scenario/submission.h"
#include "api/study/study_priv.h"

#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

const char *const study_document_methods[] = { "grid",  "list",   "lhs",       "sobol", "direct",
                                               "cmaes", "screen", "calibrate", NULL };
_Static_assert(sizeof study_document_methods / sizeof *study_document_methods == STUDY_METHODS + 1,
               "a word each");
// Methods begin with the sweeps.
static const char *const sweep_words[] = { "grid", "list", "lhs", "sobol", NULL };
static const char *const goal_words[] = { "minimize", "maximize", NULL };
static const char *const scale_words[] = { "linear", "log", NULL };

#define DEMAND_FORMS "[{\"type\":\"number\"},{\"type\":\"string\",\"const\":\"offered\"}]"

static const bf_range positive = { .minimum = 0, .maximum = INFINITY, .excludes_min = true };
static const bf_range at_least_one = { .minimum = 1, .maximum = INFINITY };
static const bf_range trials_range = { .minimum = 1, .maximum = STUDY_TRIALS_MAX };
static const bf_range steps_range = { .minimum = 1, .maximum = STUDY_TRIALS_MAX };
static const bf_range confirm_range = { .minimum = 1, .maximum = 1000 };
static const bf_range replications_range = { .minimum = 1, .maximum = 10000 };
static const bf_range workers_range = { .minimum = 1, .maximum = STUDY_DOCUMENT_WORKERS };
static const bf_range confidence_range = {
    .minimum = 0.5, .maximum = 1, .excludes_min = true, .excludes_max = true
};
static const bf_range tolerance_range = { .minimum = 1e-9, .maximum = 0.5 };

// ---- a scenario as a tree

static void read_tree(json_in *in, const json_t *value, const member *m, void *item)
{
    json_t **tree = (json_t **)(void *)((char *)item + m->offset);

    if (json_in_is_object(in, value))
        *tree = json_incref((json_t *)value);
}

static const member_kind member_tree = { .text = "object", .type = "#Scenario", .read = read_tree };

// ---- a measured curve by its id

// Where there are texts the curve stands in its place already, or a fault was noted (study_submission.h).
static void read_stored(json_in *in, const json_t *value, const member *m, void *item)
{
    (void)value;
    (void)m;
    (void)item;
    if (in->texts == NULL)
        json_in_fault(in, "names a stored measurement, which needs a daemon: give t_s and count");
}

static const member_kind member_stored = { .text = "id", .type = "#Id", .read = read_stored };

// ---- key figures by their words

void study__figure_word(figure_id id, char *ret_word)
{
    const figure *f = &figure_table[id];

    snprintf(ret_word, MEMBER_TEXT_SIZE, "%s%s%s", f->word, f->part != NULL ? "." : "",
             f->part != NULL ? f->part : "");
}

static void read_figure(json_in *in, const json_t *value, const member *m, void *item)
{
    char word[MEMBER_TEXT_SIZE];
    const char *given = json_string_value(value);

    for (figure_id id = 0; given != NULL && id < FIGURE_COUNT; id++) {
        study__figure_word(id, word);
        if (strcmp(given, word) == 0) {
            memcpy((char *)item + m->offset, &id, sizeof id);
            return;
        }
    }
    json_in_fault(in, "must be a key figure such as \"throughput_per_h\" or \"residence_s.p95\"");
}

static void describe_figure(json_out *w, const member *m, member_view view)
{
    char word[MEMBER_TEXT_SIZE];
    (void)m;
    (void)view;

    json_out_key_string(w, "type", "string");
    json_out_key(w, "enum");
    json_out_array(w);
    for (figure_id id = 0; id < FIGURE_COUNT; id++) {
        study__figure_word(id, word);
        json_out_string(w, word);
    }
    json_out_array_end(w);
}

static const member_kind member_figure = { .text = "key figure",
                                           .read = read_figure,
                                           .write_schema = describe_figure };

// ---- a demand: a number, or what feeds offer

static void read_demand(json_in *in, const json_t *value, const member *m, void *item)
{
    double *demand = (double *)(void *)((char *)item + m->offset);

    if (json_is_number(value))
        *demand = json_number_value(value);
    else if (json_is_string(value) && strcmp(json_string_value(value), "offered") == 0)
        *demand = (double)INFINITY;
    else
        json_in_fault(in, "must be a number, or \"offered\": what all feeds offer");
}

static void describe_demand(json_out *w, const member *m, member_view view)
{
    (void)m;
    (void)view;
    json_out_key(w, "oneOf");
    json_out_raw(w, DEMAND_FORMS, strlen(DEMAND_FORMS));
}

static const member_kind member_demand = { .text = "number, offered",
                                           .read = read_demand,
                                           .write_schema = describe_demand };

// ---- the tables

#define AT(place) offsetof(study_document, place)
static const member base_members[] = {
    MEMBER_OF("scenario", &member_tree, AT(scenario), "what is solved, but for its parameters"),
    MEMBER("model", enum, AT(model), "which solver; of `screen` both are used",
           .words = run_model_words, .flags = MEMBER_INIT),
};
#undef AT

#define AT(place) offsetof(study_document_parameter, place)
static const char *const range_form[] = { "range", "scale", "steps", NULL };
static const char *const values_form[] = { "values", NULL };
static const char *const *const parameter_forms[] = { range_form, values_form, NULL };
static const member parameter_members[] = {
    MEMBER("pointer", text, AT(pointer), "JSON pointer to a number of the base's scenario",
           .least = 1, .limit = BF_POINTER_SIZE),
    MEMBER("range", interval, AT(range), "least and largest number"),
    MEMBER("scale", either, AT(is_log), "log: equal ratios are equally far", .words = scale_words,
           .flags = MEMBER_INIT),
    MEMBER("steps", count, AT(steps), "of a grid: numbers, with both ends", .range = &steps_range,
           .flags = MEMBER_INIT),
    MEMBER("values", numbers, AT(values), "of a grid or list", .offset_n = AT(n_values), .least = 1,
           .limit = STUDY_DOCUMENT_VALUES),
};
#undef AT

static void init_parameter(void *item, size_t place)
{
    (void)place;
    *(study_document_parameter *)item = (study_document_parameter){ .steps = 5 };
}

static const member_table parameter_table = { MEMBER_TABLE("studyParameter", parameter_members),
                                              .size = sizeof(study_document_parameter),
                                              .init = init_parameter,
                                              .choice = MEMBER_ONE_FORM,
                                              .offset_choice =
                                                  offsetof(study_document_parameter, form),
                                              .forms = parameter_forms };

#define AT(place) offsetof(study_document_objective, place)
static const member objective_members[] = {
    MEMBER_OF("figure", &member_figure, AT(figure),
              "a key figure; what stands in an inner object as residence_s.p95"),
    MEMBER("of", text, AT(of), "id of the feed, counter or photo eye that it is of",
           .limit = SCENE_ID_SIZE, .default_text = "the only one"),
    MEMBER("goal", either, AT(is_maximized), "what is better", .words = goal_words,
           .flags = MEMBER_INIT),
    MEMBER("demand", demand, AT(demand),
           "of the first objective, of grid, list, lhs and sobol: best is the least value of the "
           "first parameter at which the figure is at least this, with the method's confidence",
           .default_text = "none: the largest or least value of the figure is best"),
};
#undef AT

static void init_objective(void *item, size_t place)
{
    (void)place;
    *(study_document_objective *)item = (study_document_objective){ .demand = (double)NAN };
}

static const member_table objective_table = { MEMBER_TABLE("studyObjective", objective_members),
                                              .size = sizeof(study_document_objective),
                                              .init = init_objective };

#define AT(place) offsetof(study_document_curve, place)
static const char *const sampled_form[] = { "t_s", "count", NULL };
static const char *const stored_form[] = { "measurement", NULL };
static const char *const *const curve_forms[] = { sampled_form, stored_form, NULL };
static const member curve_members[] = {
    MEMBER("counter", text, AT(counter),
           "id of the counter that was measured, or a column that counts parts: left_domain",
           .least = 1, .limit = SCENE_ID_SIZE),
    MEMBER("t_s", numbers, AT(t), "rising times of the run", .offset_n = AT(n_t), .unit = "s",
           .least = 2, .limit = STUDY_DOCUMENT_SAMPLES),
    MEMBER("count", numbers, AT(count), "parts in the counter, or since t = 0, one for each time",
           .offset_n = AT(n_count), .least = 2, .limit = STUDY_DOCUMENT_SAMPLES),
    MEMBER("measurement", stored, 0, "both from a stored measurement, in the service"),
};
#undef AT

static void init_curve(void *item, size_t place)
{
    (void)place;
    *(study_document_curve *)item = (study_document_curve){ .n_t = 0 };
}

static const member_table curve_table = { MEMBER_TABLE("studyCurve", curve_members),
                                          .size = sizeof(study_document_curve),
                                          .init = init_curve,
                                          .choice = MEMBER_ONE_FORM,
                                          .offset_choice = offsetof(study_document_curve, form),
                                          .forms = curve_forms };

#define OF(method) (1U << (method))
#define SEARCHES   (OF(STUDY_DIRECT) | OF(STUDY_CMAES) | OF(STUDY_CALIBRATE))
#define SWEEPS     (OF(STUDY_GRID) | OF(STUDY_LIST) | OF(STUDY_LHS) | OF(STUDY_SOBOL))
#define AT(place)  offsetof(study_document_method, place)
static const member method_members[] = {
    MEMBER("type", enum, AT(type), "how points are chosen; says which other members there are",
           .words = study_document_methods),
    MEMBER("sweep", enum, AT(sweep), "of screen: the points that the macroscopic model tries",
           .words = sweep_words, .tags = OF(STUDY_SCREEN), .flags = MEMBER_INIT),
    MEMBER("points", count, AT(points), "of lhs and sobol; of calibrate, where it starts",
           .range = &trials_range,
           .tags = OF(STUDY_LHS) | OF(STUDY_SOBOL) | OF(STUDY_SCREEN) | OF(STUDY_CALIBRATE),
           .flags = MEMBER_INIT),
    MEMBER("confirm", count, AT(confirm), "of screen: the best points, for the microscopic model",
           .range = &confirm_range, .tags = OF(STUDY_SCREEN), .flags = MEMBER_INIT),
    MEMBER("indifference", number, AT(indifference),
           "a difference of the first objective that does not matter; screen wants it",
           .range = &positive, .tags = SWEEPS | OF(STUDY_SCREEN),
           .default_text = "0.5 % of the best value"),
    MEMBER(
        "confidence", number, AT(confidence),
        "with which the best point is in the set, and that selected by screen is best but for the "
        "indifference; of calibrate, of profiles",
        .range = &confidence_range, .tags = SWEEPS | OF(STUDY_SCREEN) | OF(STUDY_CALIBRATE),
        .flags = MEMBER_INIT),
    MEMBER("tolerance", number, AT(tolerance),
           "of the ranges; searches that move by less have ended", .range = &tolerance_range,
           .tags = SEARCHES, .flags = MEMBER_INIT),
    MEMBER("prune", bool, AT(is_pruning),
           "of grid, list, lhs and sobol: stop runs that cannot be the best any more",
           .tags = SWEEPS, .flags = MEMBER_INIT),
    MEMBER("independent_samples", number, AT(n_independent),
           "of calibrate: how many of all samples are independent of each other",
           .range = &at_least_one, .tags = OF(STUDY_CALIBRATE), .default_text = "20 a curve"),
};
#undef AT

static void init_method(void *item, size_t place)
{
    (void)place;
    *(study_document_method *)item = (study_document_method){ .sweep = STUDY_SOBOL,
                                                              .points = 32,
                                                              .confirm = 8,
                                                              .confidence = 0.95,
                                                              .indifference = (double)NAN,
                                                              .tolerance = 0.001,
                                                              .n_independent = (double)NAN };
}

static const member_table method_table = { MEMBER_TABLE("studyMethod", method_members),
                                           .size = sizeof(study_document_method),
                                           .init = init_method, .choice = MEMBER_TAGGED };

#define AT(place) offsetof(study_document, place)
static const member limit_members[] = {
    MEMBER("trials", seed, AT(trials_max), "most trials", .range = &trials_range,
           .default_text = "those of a sweep, else 500"),
    MEMBER("workers", int, AT(workers), "trials at a time", .range = &workers_range,
           .default_text = "one for each core"),
};

static const member_table base_table = { MEMBER_TABLE("studyBase", base_members),
                                         .size = sizeof(study_document), .init = study__init };
static const member_table limit_table = { MEMBER_TABLE("studyLimits", limit_members),
                                          .size = sizeof(study_document), .init = study__init };

static const member members[] = {
    MEMBER("name", text, AT(name), "for people", .limit = STUDY_DOCUMENT_NAME,
           .flags = MEMBER_INIT),
    MEMBER("line", text, AT(line), "of the service: the line that it belongs to",
           .limit = API_LABEL_SIZE, .flags = MEMBER_INIT),
    MEMBER("base", object, 0, "what all trials have in common", .table = &base_table),
    MEMBER("parameters", array, AT(parameters),
           "what trials differ in; of list it may be empty: the base is repeated",
           .table = &parameter_table, .offset_n = AT(n_parameters), .limit = STUDY_PARAMETERS),
    MEMBER(
        "objectives", array, AT(objectives),
        "what is best, the first one; between equal points the second one decides, of sweeps and "
        "screen residence_s.mean where there is none. The others are told only; calibrate has none",
        .table = &objective_table, .offset_n = AT(n_objectives), .limit = STUDY_VALUES,
        .default_text = "[]"),
    MEMBER("curves", array, AT(curves), "of calibrate: what was measured", .table = &curve_table,
           .offset_n = AT(n_curves), .limit = STUDY_DOCUMENT_CURVES, .default_text = "[]"),
    MEMBER("method", object, AT(method), "how points are chosen", .table = &method_table),
    MEMBER(
        "replications", seed, AT(replications),
        "runs of each point, at successive substreams; of screen, of each confirmed one at first; "
        "one where nothing is left to chance",
        .range = &replications_range, .default_text = "1; of screen 10"),
    MEMBER("seed", seed, AT(seed), "of what is drawn", .flags = MEMBER_INIT),
    MEMBER("priority", int, AT(priority),
           "in the service: higher ones first; above 0 wants a token with the scope priority, "
           "where there are tokens",
           .range = &submission_priorities, .flags = MEMBER_INIT),
    MEMBER("limits", object, 0, "what it may use", .table = &limit_table, .default_text = "{}"),
};
#undef AT

void study__init(void *item, size_t place)
{
    study_document *document = item;

    (void)place;
    *document = (study_document){ .model = RUN_MACRO,
                                  .seed = 1,
                                  .replications = STUDY_NOT_GIVEN,
                                  .trials_max = STUDY_NOT_GIVEN };
    init_method(&document->method, 0);
}

const member_table study_document_members = { MEMBER_TABLE("studyDocument", members),
                                              .size = sizeof(study_document), .init = study__init };

void study__check_ranges(json_in *in, const study_document *d)
{
    const study_document_method *m = &d->method;
    const bool is_screen = m->type == STUDY_SCREEN;
    const struct {
        const char *pointer;
        const bf_range *range;
        double value;
        bool is_there;
    } values[] = {
        { "/method/points", &trials_range, m->points, true },
        { "/method/confirm", &confirm_range, m->confirm, is_screen },
        { "/method/indifference", &positive, m->indifference, !isnan(m->indifference) },
        { "/method/confidence", &confidence_range, m->confidence, true },
        { "/method/tolerance", &tolerance_range, m->tolerance, true },
        { "/method/independent_samples", &at_least_one, m->n_independent,
          !isnan(m->n_independent) },
    };
    char pointer[BF_POINTER_SIZE];

    for (size_t k = 0; k < sizeof values / sizeof *values; k++)
        if (values[k].is_there)
            range_check(values[k].range, values[k].value, values[k].pointer, in->faults);
    for (size_t k = 0; k < d->n_parameters; k++) {
        snprintf(pointer, sizeof pointer, "/parameters/%zu/steps", k);
        range_check(&steps_range, d->parameters[k].steps, pointer, in->faults);
    }
}
