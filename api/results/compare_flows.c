#include "api/results/compare_flows.h"

#include "api/results/key_figures.h"

#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

// The figures that are flows.
static const struct {
    const char *of;
    figure_scope scope;
    figure_id flow;
    figure_id error;
} kinds[] = { { "counter", FIGURE_OF_COUNTER, FIGURE_FLOW, FIGURE_FLOW_ERROR },
              { "outlet", FIGURE_OF_OUTLET, FIGURE_OUTFLOW, FIGURE_OUTFLOW_ERROR },
              { "sink", FIGURE_OF_SINK, FIGURE_SINK_FLOW, FIGURE_SINK_FLOW_ERROR } };

#define AT(place) offsetof(compare_flow_pair, place)
static const member pair_members[] = {
    MEMBER("of", string, AT(of), "What the flow is of: counter, outlet or sink", .type = "string"),
    MEMBER("id", string, AT(id), "Id of the counter, of the outlet's belt, or of the sink"),
    MEMBER("flow_a_per_h", measure, AT(a_per_h), "Flow of a", .unit = "parts/h"),
    MEMBER("flow_error_a_per_h", measure, AT(a_error), "Half the width of its 95 % interval",
           .unit = "parts/h", .null = "nothing is left to chance, or nothing can be said"),
    MEMBER("flow_b_per_h", measure, AT(b_per_h), "Flow of b", .unit = "parts/h"),
    MEMBER("flow_error_b_per_h", measure, AT(b_error), "Half the width of its 95 % interval",
           .unit = "parts/h", .null = "nothing is left to chance, or nothing can be said"),
    MEMBER("flow_gap_per_h", measure, AT(gap_per_h), "That of b minus that of a",
           .unit = "parts/h"),
};
const member_table compare_flow_members = { MEMBER_TABLE("CompareFlow", pair_members),
                                            .size = sizeof(compare_flow_pair) };
#undef AT

static void take_flows(const json_t *root, size_t kind, compare_flows *to)
{
    const json_t *list = json_object_get(root, key_figures_list(kinds[kind].scope));

    for (size_t k = 0; k < json_array_size(list) && to->n < COMPARE_FLOWS_MAX; k++) {
        const json_t *item = json_array_get(list, k);
        const json_t *flow = json_object_get(item, figure_table[kinds[kind].flow].word);
        const json_t *error = json_object_get(item, figure_table[kinds[kind].error].word);
        const char *id = json_string_value(json_object_get(item, "id"));
        if (id == NULL || !json_is_number(flow))
            continue;
        compare_flow *f = &to->items[to->n++];
        *f = (compare_flow){ .of = kinds[kind].of,
                             .per_h = json_number_value(flow),
                             .error_per_h =
                                 json_is_number(error) ? json_number_value(error) : (double)NAN };
        (void)snprintf(f->id, sizeof f->id, "%s", id);
    }
}

void compare_flows_read(const json_t *figures, compare_flows *ret_flows)
{
    ret_flows->n = 0;
    for (size_t kind = 0; kind < sizeof kinds / sizeof *kinds; kind++)
        take_flows(figures, kind, ret_flows);
}

size_t compare_flows_match(const compare_flows *a, const compare_flows *b,
                           compare_flow_pair *ret_pairs)
{
    size_t n = 0;

    for (size_t i = 0; i < a->n; i++) {
        const compare_flow *of_a = &a->items[i];
        for (size_t k = 0; k < b->n; k++) {
            const compare_flow *of_b = &b->items[k];
            if (of_a->of != of_b->of || strcmp(of_a->id, of_b->id) != 0)
                continue;
            ret_pairs[n++] = (compare_flow_pair){ .of = of_a->of,
                                                  .id = of_a->id,
                                                  .a_per_h = of_a->per_h,
                                                  .a_error = of_a->error_per_h,
                                                  .b_per_h = of_b->per_h,
                                                  .b_error = of_b->error_per_h,
                                                  .gap_per_h = of_b->per_h - of_a->per_h };
            break;
        }
    }
    return n;
}

void compare_flows_write(json_out *w, const compare_flows *a, const compare_flows *b)
{
    compare_flow_pair pairs[COMPARE_FLOWS_MAX];
    const size_t n = compare_flows_match(a, b, pairs);

    json_out_array(w);
    for (size_t k = 0; k < n; k++)
        members_write(w, &compare_flow_members, &pairs[k]);
    json_out_array_end(w);
}
