#include "api/study/study_document.h"

#include "api/scenario/scenario.h"
#include "api/study/study_priv.h"
#include "core/base/memory.h"
#include "core/compare/compare.h"
#include "core/study/pruning.h"

#include <jansson.h>
#include <math.h>
#include <stdio.h>

bf_status study__read_tree(json_in *in, const json_t *root, study_document *ret_document,
                           bf_error *err)
{
    study_document d;

    study__init(&d, 0);
    members_read(in, root, &study_document_members, &d);
    bf_status status = json_in_status(in, err);
    if (status == BF_OK) {
        study__check(in, &d);
        status = json_in_status(in, err);
    }
    if (status == BF_OK)
        *ret_document = d;
    else
        study_document_fini(&d);
    return status;
}

bf_status study_document_read(const char *json, size_t n, study_document *ret_document,
                              bf_faults *faults, bf_error *err)
{
    json_in in = json_in_to(faults);
    json_t *root = json_in_parse(&in, json, n);

    if (root == NULL)
        return json_in_status(&in, err);
    const bf_status status = study__read_tree(&in, root, ret_document, err);
    json_in_free(root);
    return status;
}

void study_document_fini(study_document *d)
{
    if (d == NULL)
        return;
    for (size_t k = 0; k < STUDY_PARAMETERS; k++)
        memory_free((void *)d->parameters[k].values);
    for (size_t k = 0; k < STUDY_DOCUMENT_CURVES; k++) {
        memory_free((void *)d->curves[k].t);
        memory_free((void *)d->curves[k].count);
    }
    json_in_free(d->scenario);
    *d = (study_document){ .n_parameters = 0 };
}

study_definition study_document_definition(const study_document *d)
{
    study_definition def = { .method = d->method.type,
                             .d = d->n_parameters,
                             .n_values = d->n_curves > 0 ? d->n_curves : d->n_objectives,
                             .is_maximized = d->n_objectives > 0 && d->objectives[0].is_maximized,
                             .is_second_maximized =
                                 d->n_objectives > 1 && d->objectives[1].is_maximized,
                             .has_chance = d->has_chance,
                             .has_demand = d->n_objectives > 0 && !isnan(d->objectives[0].demand),
                             .demand = d->objectives[0].demand,
                             .seed = d->seed,
                             .n_trials_max = d->trials_max,
                             .n_replications = d->has_chance ? d->replications : 1,
                             .sweep = d->method.sweep,
                             .n_points = d->method.points,
                             .tolerance = d->method.tolerance,
                             .n_confirmed = d->method.confirm,
                             .confidence = d->method.confidence,
                             .indifference = d->method.indifference,
                             .n_independent = d->method.n_independent };

    for (size_t k = 0; k < d->n_parameters; k++) {
        const study_document_parameter *p = &d->parameters[k];
        def.steps[k] = p->form == STUDY_BY_VALUES ? p->n_values : p->steps;
    }
    if (d->method.type == STUDY_LIST ||
        (d->method.type == STUDY_SCREEN && d->method.sweep == STUDY_LIST))
        def.n_points = d->n_parameters > 0 ? d->parameters[0].n_values : 1;
    return def;
}

double study_document_value(const study_document_parameter *p, double coordinate)
{
    if (p->form == STUDY_BY_VALUES)
        return p->values[(size_t)(coordinate * (double)(p->n_values - 1) + 0.5)];
    if (coordinate >= 1.0)
        return p->range[1];
    if (p->is_log)
        return p->range[0] * pow(p->range[1] / p->range[0], coordinate);
    return p->range[0] + coordinate * (p->range[1] - p->range[0]);
}

run_model study_document_model(const study_document *d, study_model model)
{
    return model == STUDY_AS_SUBMITTED ? d->model : model == STUDY_MACRO ? RUN_MACRO : RUN_MICRO;
}

bf_status study_document_scene(study_document *d, const double *point, uint32_t substream,
                               run_model model, scene *ret_scene, bf_faults *faults, bf_error *err)
{
    json_in in = json_in_to(faults);

    for (size_t k = 0; k < d->n_parameters; k++)
        json_real_set(d->parameters[k].number, study_document_value(&d->parameters[k], point[k]));
    json_t *number = json_real((double)(d->substream + substream));
    if (number == NULL || json_object_set_new(d->scenario, "substream", number) != 0)
        return bf_fail_memory(err);
    return scenario_read_tree(&in, d->scenario, model, ret_scene) ? BF_OK
                                                                  : json_in_status(&in, err);
}

void study_document_column(const study_document *d, size_t value, char *ret_name)
{
    char word[MEMBER_TEXT_SIZE];

    if (d->n_curves > 0) {
        snprintf(ret_name, STUDY_DOCUMENT_COLUMN, "mse:%s", d->curves[value].counter);
        return;
    }
    const study_document_objective *o = &d->objectives[value];
    study__figure_word(o->figure, word);
    snprintf(ret_name, STUDY_DOCUMENT_COLUMN, "%.60s%s%s", word, o->of[0] != '\0' ? ":" : "",
             o->of);
}

// The mean square of the distance of a measured curve from the computed one, over the time that both have.
static bf_status mean_square(const study_document_curve *measured,
                             const study_document_outcome *outcome, double *ret_value,
                             bf_error *err)
{
    double *parts = memory_alloc(outcome->n, sizeof *parts);
    compare_measures measures;

    if (parts == NULL)
        return bf_fail_memory(err);
    for (size_t k = 0; k < outcome->n; k++)
        parts[k] = outcome->columns[k * outcome->n_columns + measured->column];
    const compare_curve computed = { outcome->n, outcome->t, parts };
    const compare_curve given = { measured->n_t, measured->t, measured->count };
    const bf_status status = compare_curves(&given, &computed, &measures, NULL);
    *ret_value = status == BF_OK ? measures.l2 * measures.l2 : (double)NAN;
    memory_free(parts);
    return BF_OK;
}

bf_status study_document_values(const study_document *d, const study_document_outcome *outcome,
                                double *ret_values, bf_error *err)
{
    for (size_t k = 0; k < d->n_objectives; k++)
        ret_values[k] = outcome->figures[figure_at(outcome->scene, d->objectives[k].figure,
                                                   d->objectives[k].item)];
    for (size_t k = 0; k < d->n_curves; k++)
        BF_TRY(mean_square(&d->curves[k], outcome, &ret_values[k], err));
    return BF_OK;
}

double study_document_better(const study_document *d, double a, double b)
{
    const bool is_maximized = d->n_objectives > 0 && d->objectives[0].is_maximized;

    if (!isfinite(a) || !isfinite(b))
        return isfinite(a) ? a : isfinite(b) ? b : (double)NAN;
    return is_maximized ? fmax(a, b) : fmin(a, b);
}

bool study_document_is_hopeless(const study_document *d, const scene *s, double t,
                                const double *figures, double best)
{
    const study_document_objective *o = &d->objectives[0];

    if (!d->method.is_pruning)
        return false;
    const pruning_state now = { .figure = o->figure,
                                .is_maximized = o->is_maximized,
                                .t = t,
                                .value = figures[figure_at(s, o->figure, o->item)] };
    return pruning_is_hopeless(&now, best);
}
