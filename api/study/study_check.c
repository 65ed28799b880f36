// What the tables of a study's document cannot say: what pointers lead to, and what fits together.

#include "api/scenario/scenario.h"
#include "api/study/study_priv.h"
#include "core/feed/arrivals.h"
#include "core/observe/columns.h"
#include "core/scene/regime.h"

#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

enum { TRIALS_DEFAULT = 500, REPLICATIONS_SCREEN = 10, SAMPLES_A_CURVE = 20 };

static bool is_sweep(study_method method)
{
    return method <= STUDY_SOBOL;
}

// The sweep of a document, or STUDY_METHODS.
static study_method sweep_of(const study_document *d)
{
    const study_method method = d->method.type == STUDY_SCREEN ? d->method.sweep : d->method.type;

    return is_sweep(method) ? method : STUDY_METHODS;
}

static void check_pointer(json_in *in, study_document *d, size_t k)
{
    study_document_parameter *p = &d->parameters[k];
    char place[BF_POINTER_SIZE];
    json_t *value = json_pointer_find(d->scenario, p->pointer);

    snprintf(place, sizeof place, "/parameters/%zu/pointer", k);
    if (value == NULL)
        faults_add(in->faults, place, "\"%.100s\" leads to nothing in the base's scenario",
                   p->pointer);
    else if (!json_is_real(value))
        faults_add(in->faults, place, "\"%.100s\" does not lead to a number", p->pointer);
    else if (strcmp(p->pointer, "/substream") == 0)
        faults_add(in->faults, place, "replications differ in the substream");
    for (size_t other = 0; other < k && value != NULL; other++)
        if (d->parameters[other].number == value)
            faults_add(in->faults, place, "is that of /parameters/%zu, too", other);
    p->number = value;
}

static void check_values(json_in *in, const study_document *d, size_t k)
{
    const study_document_parameter *p = &d->parameters[k];
    const study_method sweep = sweep_of(d);
    char place[BF_POINTER_SIZE];

    snprintf(place, sizeof place, "/parameters/%zu", k);
    if (p->form == STUDY_BY_VALUES) {
        if (sweep != STUDY_GRID && sweep != STUDY_LIST)
            faults_add(in->faults, place,
                       "values belong to the methods grid and list; a range is needed");
        else if (sweep == STUDY_LIST && p->n_values != d->parameters[0].n_values)
            faults_add(in->faults, place, "a list needs as many values of each parameter");
        return;
    }
    if (sweep == STUDY_LIST)
        faults_add(in->faults, place, "a list needs values");
    if (!(p->range[0] < p->range[1]))
        faults_add(in->faults, place, "the range ends at %g, and begins at %g", p->range[1],
                   p->range[0]);
    else if (p->is_log && !(p->range[0] > 0.0))
        faults_add(in->faults, place, "a range on a log scale must be > 0");
    else if (!isfinite(p->range[1] - p->range[0]) ||
             (p->is_log && !isfinite(p->range[1] / p->range[0])))
        faults_add(in->faults, place, "the range is too wide");
}

// The index of the item of an objective or curve among n ids.
static size_t find_id(const scene *s, figure_scope scope, const char *id)
{
    const size_t n = figure_items(s, scope);
    size_t k = 0;

    while (k < n && strcmp(figure_item_id(s, scope, k), id) != 0)
        k++;
    return k;
}

static void check_objective(json_in *in, study_document *d, const scene *s, size_t k)
{
    static const char *const words[FIGURE_SCOPES] = { "run",
                                                      "feed",
                                                      "counter",
                                                      "photo eye",
                                                      "belt whose speed changes",
                                                      "kind of failure",
                                                      "belt that is one of several outlets",
                                                      "sink" };
    study_document_objective *o = &d->objectives[k];
    const figure *f = &figure_table[o->figure];
    const bool needs_both = d->method.type == STUDY_SCREEN;
    const size_t n = figure_items(s, f->scope);
    char figure_place[BF_POINTER_SIZE], place[BF_POINTER_SIZE];

    snprintf(figure_place, sizeof figure_place, "/objectives/%zu/figure", k);
    snprintf(place, sizeof place, "/objectives/%zu/of", k);
    const unsigned by_density = FIGURE_BY_DENSITY | (s->n_feeds > 0 ? FIGURE_BY_FED_DENSITY : 0);
    if ((f->models & by_density) == 0 && (needs_both || d->model == RUN_MACRO))
        faults_add(in->faults, figure_place, "the macroscopic model does not have this figure%s",
                   (f->models & FIGURE_BY_FED_DENSITY) != 0 ? " without feeds" : "");
    if (n == 0)
        faults_add(in->faults, figure_place, "is of a %s, and the scenario has none",
                   words[f->scope]);
    else if (f->scope == FIGURE_OF_RUN && o->of[0] != '\0')
        faults_add(in->faults, place, "the figure is of the whole run");
    else if (f->scope != FIGURE_OF_RUN && o->of[0] == '\0' && n > 1)
        faults_add(in->faults, place, "is missing; the scenario has %zu of a %s", n,
                   words[f->scope]);
    else if (o->of[0] != '\0' && (o->item = find_id(s, f->scope, o->of)) == n)
        faults_add(in->faults, place, "the scenario has no %s \"%.64s\"", words[f->scope], o->of);
}

// Whether what is offered differs between the points of a study.
static bool varies_offer(const study_document *d)
{
    bool varies = false;

    for (size_t k = 0; k < d->n_parameters; k++)
        varies |= strncmp(d->parameters[k].pointer, "/feeds", strlen("/feeds")) == 0 ||
                  strcmp(d->parameters[k].pointer, "/duration_s") == 0 ||
                  strcmp(d->parameters[k].pointer, "/warmup_s") == 0;
    return varies;
}

static void check_demand(json_in *in, study_document *d, const scene *s)
{
    static const char place[] = "/objectives/0/demand";
    study_document_objective *o = &d->objectives[0];
    const study_document_parameter *p = &d->parameters[0];
    char other[BF_POINTER_SIZE];

    for (size_t k = 1; k < d->n_objectives; k++) {
        snprintf(other, sizeof other, "/objectives/%zu/demand", k);
        if (!isnan(d->objectives[k].demand))
            faults_add(in->faults, other, "belongs to the first objective");
    }
    if (d->n_objectives == 0 || isnan(o->demand))
        return;
    if (!is_sweep(d->method.type) || d->n_parameters == 0)
        faults_add(in->faults, place, "belongs to parameters by grid, list, lhs or sobol");
    for (size_t k = 1; p->form == STUDY_BY_VALUES && k < p->n_values; k++)
        if (!(p->values[k] > p->values[k - 1])) {
            faults_add(in->faults, "/parameters/0/values",
                       "must rise, as the least one is searched");
            break;
        }
    o->is_maximized = true;
    if (isfinite(o->demand))
        return;
    if (o->figure != FIGURE_THROUGHPUT && o->figure != FIGURE_SUSTAINED)
        faults_add(in->faults, place, "only a throughput can be what is offered");
    else if (s->n_feeds == 0)
        faults_add(in->faults, place, "the scenario has no feeds: give a number");
    else if (varies_offer(d))
        faults_add(in->faults, place, "what is offered depends on a parameter: give a number");
    else {
        // Parts/h that get through where all that is offered does: what is missing in the end is on the belt.
        double offered = (double)NAN;
        o->is_offered = true;
        if (feed_offered(s, s->warmup, s->duration, &offered, NULL) != BF_OK)
            in->has_failed = true;
        o->demand = STUDY_WHOLE_FEED * 3600.0 * offered / (s->duration - s->warmup);
        if (!in->has_failed && !(isfinite(o->demand) && o->demand > 0.0))
            faults_add(in->faults, "/objectives/0/demand",
                       "what is offered is not known: give a number");
    }
}

// The column of a curve that a measured one can be compared with: a counter's, or one that counts parts; columns_count(): none.
static size_t find_column(const scene *s, const char *name)
{
    char column[COLUMN_NAME_SIZE];

    for (size_t k = 0; k < columns_count(s); k++) {
        columns_name(s, k, column);
        if (strcmp(column, name) == 0 && (k < s->n_counters || columns_is_count(column)))
            return k;
    }
    return columns_count(s);
}

static void check_curve(json_in *in, study_document *d, const scene *s, size_t k)
{
    study_document_curve *c = &d->curves[k];
    char place[BF_POINTER_SIZE];

    snprintf(place, sizeof place, "/curves/%zu", k);
    if ((c->column = find_column(s, c->counter)) == columns_count(s))
        faults_add(in->faults, place, "the scenario has no counter \"%.64s\"", c->counter);
    if (c->n_t != c->n_count)
        faults_add(in->faults, place, "there are %zu times, and %zu counts", c->n_t, c->n_count);
    for (size_t i = 1; i < c->n_t; i++)
        if (!(c->t[i] > c->t[i - 1])) {
            faults_add(in->faults, place, "times must rise; that of sample %zu does not", i);
            break;
        }
    if (c->n_t > 0 && !(c->t[0] < s->duration))
        faults_add(in->faults, place, "begins when the run has ended");
}

static void check_base(json_in *in, study_document *d)
{
    const bool is_calibration = d->method.type == STUDY_CALIBRATE;
    scene s;

    const size_t mark = json_pointer_enter(&in->pointer, "base", strlen("base"));
    const size_t inner = json_pointer_enter(&in->pointer, "scenario", strlen("scenario"));
    const bool is_read = scenario_read_tree(in, d->scenario, d->model, &s);
    json_pointer_leave(&in->pointer, inner);
    json_pointer_leave(&in->pointer, mark);
    if (!is_read)
        return;
    d->substream = s.substream;
    d->has_chance = scene_has_chance(&s, d->model == RUN_MACRO && d->method.type != STUDY_SCREEN);
    for (size_t k = 0; k < d->n_objectives; k++)
        check_objective(in, d, &s, k);
    for (size_t k = 0; k < d->n_curves; k++)
        check_curve(in, d, &s, k);
    check_demand(in, d, &s);
    scene_fini(&s);
    // What decides between equal points where no other objective is given.
    const bool is_residence = d->objectives[0].figure >= FIGURE_RESIDENCE_MEAN &&
                              d->objectives[0].figure <= FIGURE_RESIDENCE_P99;
    d->has_own_second = d->n_objectives > 1;
    if (d->n_objectives == 1 && !is_residence &&
        (is_sweep(d->method.type) || d->method.type == STUDY_SCREEN))
        d->objectives[d->n_objectives++] =
            (study_document_objective){ .figure = FIGURE_RESIDENCE_MEAN, .demand = (double)NAN };
    if (is_calibration && d->n_curves == 0)
        faults_add(in->faults, "/curves", "a calibration needs one at least");
    if (is_calibration && d->n_objectives > 0)
        faults_add(in->faults, "/objectives", "a calibration has none: it is about its curves");
    if (!is_calibration && d->n_curves > 0)
        faults_add(in->faults, "/curves", "belong to the method calibrate");
    if (!is_calibration && d->n_objectives == 0)
        faults_add(in->faults, "/objectives", "there must be one at least");
}

static void check_limits(json_in *in, study_document *d)
{
    const study_definition definition = study_document_definition(d);
    const size_t n = study_first_trials(&definition);

    if (d->method.is_pruning && d->replications > 1)
        faults_add(in->faults, "/method/prune",
                   "of replications the mean counts, not a single run");
    if (d->method.type == STUDY_SCREEN && d->replications < 2)
        faults_add(in->faults, "/replications", "a selection needs two at least");
    if (d->method.type == STUDY_SCREEN && isnan(d->method.indifference))
        faults_add(in->faults, "/method/indifference", "a selection needs it");
    if (d->trials_max == STUDY_NOT_GIVEN && is_sweep(d->method.type) && n <= STUDY_TRIALS_MAX)
        d->trials_max = n;
    else if (d->trials_max == STUDY_NOT_GIVEN)
        d->trials_max = TRIALS_DEFAULT;
    if (n > STUDY_TRIALS_MAX)
        faults_add_limit(in->faults, "/parameters",
                         "the study has %.9g trials; at most %d are allowed", (double)n,
                         STUDY_TRIALS_MAX);
    else if (n > d->trials_max)
        faults_add_limit(in->faults, "/limits/trials", "the study begins with %zu trials", n);
}

void study__check(json_in *in, study_document *d)
{
    const size_t n_faults = in->faults->n;

    study__check_ranges(in, d);
    if (d->replications == STUDY_NOT_GIVEN)
        d->replications = d->method.type == STUDY_SCREEN ? REPLICATIONS_SCREEN : 1;
    if (isnan(d->method.n_independent))
        d->method.n_independent = SAMPLES_A_CURVE * (double)d->n_curves;
    if (d->n_parameters == 0 && d->method.type != STUDY_LIST)
        faults_add(in->faults, "/parameters",
                   "there must be one at least; the method list alone may repeat the base");
    for (size_t k = 0; k < d->n_parameters; k++) {
        check_pointer(in, d, k);
        check_values(in, d, k);
    }
    check_base(in, d);
    if (in->faults->n == n_faults && !in->has_failed)
        check_limits(in, d);
}
