/// Key figures (core/observe/figure.h) as JSON and CSV. What a run cannot say is left out.
///
///     {"throughput_per_h": 5400, "residence_s": {"mean": 2.5, "p50": ...}, ...,
///      "feeds": [{"id": "infeed", "offered": 240, ...}], "counters": [{"id": ...}], "photo_eyes": [{"id": ...}],
///      "belts": [{"id": ...}], "outlets": [{"id": ...}]}
///
/// `belts` has those that a schedule or a photo eye commands, `outlets` those from which cargo leaves the domain where there
/// are several; each is left out where there is none.
/// Ids are taken from the columns of the run's curve (core/observe/columns.h), which name all of them.

#pragma once

#include "api/json/json_out.h"
#include "core/base/status.h"
#include "core/observe/figure.h"

#include <stddef.h>

struct json_t;

/// The key figures of a run at a time; all borrowed.
typedef struct key_figures {
    const char *columns;  ///< of the run's curve
    double t;             ///< s
    size_t n;             ///< values
    const double *values; ///< in the order of figure.h
} key_figures;

/// The member in which the items of a scope stand, "feeds"; NULL for FIGURE_OF_RUN, whose figures stand in the object
/// itself.
const char *key_figures_list(figure_scope scope);

/// BF_OK if there are as many values as the columns ask for; else BF_ECORRUPT.
BF_MUST_CHECK bf_status key_figures_check(const key_figures *figures, bf_error *err);

/// Write the object of figures that key_figures_check() accepts.
void key_figures_write(json_out *w, const key_figures *figures);

/// Write those of the run alone, for lists of runs: at most API_FIGURES_SIZE - 1 bytes.
void key_figures_write_run(json_out *w, const double *values);

/// Append a stored object as CSV: a header "figure,of,id,value,unit", then a line for each figure that is there, as
/// "residence_s.p95,run,,3.25,s" or "wait_s.mean,feed,infeed,0.5,s". BF_ECORRUPT: not such an object.
BF_MUST_CHECK bf_status key_figures_csv(const char *json, size_t n, bf_buffer *out, bf_error *err);

/// Parse a stored object, for json_in_free(). BF_ECORRUPT: it is no JSON; BF_ENOMEM.
BF_MUST_CHECK bf_status key_figures_parse(const char *json, size_t n, struct json_t **ret_root,
                                          bf_error *err);

/// Read the object that key_figures_write() wrote of a run with these columns: n values in the order of figure.h, bit by bit;
/// NAN: missing. BF_ECORRUPT: it is not such an object, or there are not n values. BF_ENOMEM.
BF_MUST_CHECK bf_status key_figures_read(const char *json, size_t n_json, const char *columns,
                                         size_t n, double *ret_values, bf_error *err);

/// Read the figures of the run alone, FIGURE_OFFERED values, from that object, parsed; NULL: none is there.
void key_figures_read_run(const struct json_t *object, double *ret_values);
