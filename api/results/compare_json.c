#include "api/results/compare_json.h"

#define NEVER      "never, or cargo enters while it leaves"
#define NO_OUTFLOW "nothing left, or cargo enters while it leaves"

#define AT(place)  offsetof(compare_figures, place)
static const member figures_members[] = {
    MEMBER("t_start_s", number, AT(t_start), "Time of the first sample", .unit = "s",
           .null = "not known"),
    MEMBER("t_end_s", number, AT(t_end), "Time of the last sample", .unit = "s",
           .null = "not known"),
    MEMBER("parts_start", number, AT(parts_start), "First value", .unit = "parts",
           .null = "not known"),
    MEMBER("parts_end", number, AT(parts_end), "Last value", .unit = "parts", .null = "not known"),
    MEMBER("drain_time_s", measure, AT(drain_time),
           "First time with at most 1 % of the first value", .unit = "s", .null = NEVER),
    MEMBER("t10_s", measure, AT(t10), "When 10 % of what leaves has left", .unit = "s",
           .null = NO_OUTFLOW),
    MEMBER("t90_s", measure, AT(t90), "When 90 % of what leaves has left", .unit = "s",
           .null = NO_OUTFLOW),
    MEMBER("throughput_per_s", measure, AT(throughput), "Mean outflow from t10_s to t90_s",
           .unit = "parts/s", .null = NO_OUTFLOW),
};
const member_table compare_json_figures = { MEMBER_TABLE("CompareFigures", figures_members) };
#undef AT

#define AT(place) offsetof(compare_json_entry, place)
static const member compared_members[] = {
    MEMBER("id", string, AT(id), "Identifier of the run or measurement", .type = "#Id"),
    MEMBER("kind", string, AT(kind), "Which of both it is", .type = "#ComparedKind"),
    MEMBER("label", string, AT(label), "The client's own name of it"),
    MEMBER("name", string, AT(name), "Name of the scenario", .null = "it was measured"),
    MEMBER("model", string, AT(model), "Which solver", .type = "#Model", .null = "it was measured"),
    MEMBER("status", string, AT(status), "State of the run", .type = "#RunStatus",
           .null = "it was measured"),
    MEMBER("column", string, AT(column), "The column of its curve", .type = "#ColumnName"),
    MEMBER_INLINE(&compare_json_figures, AT(figures)),
};
const member_table compare_json_compared = { MEMBER_TABLE("Compared", compared_members) };
#undef AT

#define AT(place) offsetof(compare_measures, place)
static const member measures_members[] = {
    MEMBER("t_start_s", number, AT(t_start), "Start of the common interval", .unit = "s"),
    MEMBER("t_end_s", number, AT(t_end), "End of the common interval", .unit = "s"),
    MEMBER("l1", measure, AT(l1), "Mean absolute difference", .unit = "parts", .null = "not known"),
    MEMBER("l2", measure, AT(l2), "Root mean square of the difference", .unit = "parts",
           .null = "not known"),
    MEMBER("largest", measure, AT(largest), "Largest absolute difference", .unit = "parts",
           .null = "not known"),
    MEMBER("largest_at_s", measure, AT(largest_at), "When it is reached first", .unit = "s",
           .null = "not known"),
    MEMBER("drain_time_a_s", measure, AT(drain_time_a),
           "First time with at most 1 % of a's first value", .unit = "s", .null = NEVER),
    MEMBER("drain_time_b_s", measure, AT(drain_time_b),
           "First time with at most 1 % of b's first value", .unit = "s", .null = NEVER),
    MEMBER("drain_time_gap_s", measure, AT(drain_gap), "That of b minus that of a", .unit = "s",
           .null = "one of them is null"),
    MEMBER("rate_a_per_s", measure, AT(rate_a), "Mean outflow of a", .unit = "parts/s",
           .null = NO_OUTFLOW),
    MEMBER("rate_b_per_s", measure, AT(rate_b), "Mean outflow of b", .unit = "parts/s",
           .null = NO_OUTFLOW),
    MEMBER("throughput_a_per_s", measure, AT(throughput_a),
           "Mean outflow of a between 10 and 90 % of what leaves", .unit = "parts/s",
           .null = NO_OUTFLOW),
    MEMBER("throughput_b_per_s", measure, AT(throughput_b),
           "Mean outflow of b between 10 and 90 % of what leaves", .unit = "parts/s",
           .null = NO_OUTFLOW),
    MEMBER("throughput_gap_per_s", measure, AT(throughput_gap), "That of b minus that of a",
           .unit = "parts/s", .null = "one of them is null"),
};
const member_table compare_json_measures = { MEMBER_TABLE("CurveMeasures", measures_members) };
#undef AT

#define AT(place) offsetof(compare_distance, place)
static const member distance_members[] = {
    MEMBER("mean_abs", measure, AT(mean_abs), "Mean absolute difference of a cell's density",
           .null = "not known"),
    MEMBER("l1", measure, AT(l1),
           "Sum of the absolute differences divided by the sum of the densities: 0 the same, 1 "
           "nothing in common",
           .null = "both are empty"),
    MEMBER("emd_x_m", measure, AT(emd_x),
           "Earth mover's distance of the densities summed across the belt", .unit = "m",
           .null = "one is empty"),
    MEMBER("emd_y_m", measure, AT(emd_y),
           "Earth mover's distance of the densities summed along the belt", .unit = "m",
           .null = "one is empty"),
};
const member_table compare_json_distance = { MEMBER_TABLE("Distance", distance_members) };
#undef AT

#define AT(place) offsetof(compare_json_snapshots, place)
static const member snapshots_members[] = {
    MEMBER("t_s", number, AT(t), "The common time", .unit = "s"),
    MEMBER("a", size, AT(a), "Number of a's snapshot"),
    MEMBER("b", size, AT(b), "Number of b's snapshot"),
    MEMBER("mass_a", number, AT(mass_a), "Parts in the domain of a", .null = "not known"),
    MEMBER("mass_b", number, AT(mass_b), "Parts in the domain of b", .null = "not known"),
    MEMBER_INLINE(&compare_json_distance, AT(distance)),
};
const member_table compare_json_density_distance = { MEMBER_TABLE("DensityDistance",
                                                                  snapshots_members) };
#undef AT
