// Schemas of key figures, from their table (core/observe/figure.h).

#include "api/openapi/openapi_priv.h"

#include "api/results/key_figures.h"

#include <stdio.h>
#include <string.h>

enum { HELP_SIZE = 400 };

static const char *const titles[FIGURE_SCOPES] = { "RunFigures",     "FeedFigures",
                                                   "CounterFigures", "PhotoEyeFigures",
                                                   "BeltFigures",    "FailureFigures",
                                                   "OutletFigures",  "SinkFigures" };

static void end_object(json_out *w)
{
    json_out_object_end(w);
    json_out_key_bool(w, "additionalProperties", false);
    json_out_object_end(w);
}

// The properties of a scope: those that share a word are neighbours, and an object.
static void write_properties(json_out *w, figure_scope scope)
{
    const figure *open = NULL;

    for (figure_id id = figure_first(scope); id < figure_first(scope + 1); id++) {
        const figure *f = &figure_table[id];
        if (open != NULL && strcmp(open->word, f->word) != 0) {
            end_object(w);
            open = NULL;
        }
        if (open == NULL && f->part != NULL) {
            json_out_key(w, f->word);
            json_out_object(w);
            json_out_key_string(w, "type", "object");
            json_out_key(w, "properties");
            json_out_object(w);
            open = f;
        }
        static const char *const models[] = { [FIGURE_BY_DENSITY] = " (macroscopic model)",
                                              [FIGURE_BY_PARTS] = " (microscopic model)",
                                              [FIGURE_BY_BOTH] = "",
                                              [FIGURE_BY_BOTH_FED] = " (microscopic model; "
                                                                     "macroscopic with feeds)" };
        char help[HELP_SIZE];
        snprintf(help, sizeof help, "%s%s%s%s%s", f->definition, f->unit != NULL ? " [" : "",
                 f->unit != NULL ? f->unit : "", f->unit != NULL ? "]" : "", models[f->models]);
        json_out_key(w, f->part != NULL ? f->part : f->word);
        json_out_object(w);
        json_out_key_string(w, "type", "number");
        json_out_key_string(w, "description", help);
        json_out_object_end(w);
    }
    if (open != NULL)
        end_object(w);
}

void openapi__write_item_figures(json_out *w, size_t tag)
{
    const figure_scope scope = (figure_scope)tag;

    json_out_key_string(w, "type", "object");
    json_out_key(w, "properties");
    json_out_object(w);
    if (scope != FIGURE_OF_RUN) {
        json_out_key(w, "id");
        schema_write(w, "#ScenarioId", NULL, "Of which one");
    }
    write_properties(w, scope);
    json_out_object_end(w);
    if (scope != FIGURE_OF_RUN) {
        json_out_key(w, "required");
        schema_write_words(w, "id");
    }
    json_out_key_bool(w, "additionalProperties", false);
}

void openapi__write_figures(json_out *w, size_t tag)
{
    static const char *const of_some[FIGURE_SCOPES] = {
        [FIGURE_OF_BELT] =
            "Of each belt whose speed changes: by its schedule, photo eyes, failures or "
            "breaks; absent: none",
        [FIGURE_OF_FAILURE] = "Of each kind of failure of belts; absent: none",
        [FIGURE_OF_OUTLET] =
            "With feeds, of each belt from which cargo leaves the domain, where there "
            "are several, or sinks; absent: none",
        [FIGURE_OF_SINK] = "Of each sink; absent: none"
    };
    char type[MEMBER_TEXT_SIZE];

    (void)tag;
    json_out_key_string(w, "type", "object");
    json_out_key(w, "properties");
    json_out_object(w);
    write_properties(w, FIGURE_OF_RUN);
    for (figure_scope scope = FIGURE_OF_RUN + 1; scope < FIGURE_SCOPES; scope++) {
        snprintf(type, sizeof type, "[#%s]", titles[scope]);
        json_out_key(w, key_figures_list(scope));
        schema_write(w, type, NULL, of_some[scope] != NULL ? of_some[scope] : "Of each of them");
    }
    json_out_object_end(w);
    json_out_key(w, "required");
    schema_write_words(w, "feeds counters photo_eyes");
    json_out_key_bool(w, "additionalProperties", false);
}
