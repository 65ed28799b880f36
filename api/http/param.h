/// Parameters of requests: one row describes a parameter. Requests are parsed by it, and the OpenAPI
/// document is generated from it.

#pragma once

#include "api/json/json_out.h"
#include "api/services.h"

#include <stdbool.h>
#include <stdint.h>

typedef struct param param;

/// A value as its kind reads it.
typedef union param_value {
    uint64_t whole; ///< of param_whole and param_flag; of param_time Unix time, ms
    double real;    ///< of param_real
    struct {
        size_t n;                                     ///< how many
        char items[API_STREAM_RUNS_MAX][API_ID_SIZE]; ///< in the order of the request
    } ids;                                            ///< of param_ids
} param_value;

/// A kind of value.
typedef struct param_kind {
    /// Type in the document, as a short text of api/json/schema.h; NULL: the row's.
    const char *type;
    /// Read text by the row. *ret_value is untouched on failure, and by kinds that are texts. BF_EINPUT:
    /// no such value; BF_ENOTFOUND: nothing can have this id. NULL: any text will do.
    bf_status (*read)(const param *row, const char *text, param_value *ret_value, bf_error *err);
    /// Write the bounds of the row into a schema that is open; NULL: there are none.
    void (*write_bounds)(const param *row, json_out *w);
} param_kind;

extern const param_kind param_text;   ///< text of at most `most` bytes; 0: of any length
extern const param_kind param_member; ///< text that is checked with the document in the body
extern const param_kind param_word;   ///< a text for which `is_word` is true
extern const param_kind param_format; ///< one of the route's formats; negotiation.h chooses it
extern const param_kind param_whole;  ///< whole number of least .. most
extern const param_kind param_flag;   ///< 0 or 1
extern const param_kind
    param_time; ///< moment in UTC, "2026-11-24T09:00:00Z" (RFC 3339), with fractions of a second or none
extern const param_kind param_real;   ///< number of least_real .. most_real
extern const param_kind param_id;     ///< id of a run or a measurement
extern const param_kind param_cursor; ///< id of the last item of the page before
extern const param_kind param_ids;    ///< least .. most different ids with commas between

/// A parameter.
struct param {
    const char *name;                  ///< as it is sent
    const char *in;                    ///< "path", "query" or "header"
    const param_kind *kind;            ///< what values it has
    const char *type;                  ///< in the document, if not that of the kind
    const char *limits;                ///< further JSON members of its schema; NULL: none
    const char *default_text;          ///< value where the request has none; NULL: there is none
    uint64_t least;                    ///< smallest number, fewest ids
    uint64_t most;                     ///< largest number, most ids, bytes of a text
    double least_real;                 ///< smallest real number
    double most_real;                  ///< largest real number
    bool (*is_word)(const char *text); ///< of param_word: true for its words
    const char *(*list_words)(void); ///< of param_word: its words, for a refusal; NULL: not listed
    bool is_required;                ///< the request must have it
    const char *formats; ///< of answers, or bodies, that it is for, words of MEDIA_LIST; NULL: all
    const char *help;    ///< what it does
};

/// Read a value of a parameter in a query; see param_kind.
BF_MUST_CHECK bf_status param_read(const param *row, const char *text, param_value *ret_value,
                                   bf_error *err);

/// True if text has the form of the ids of runs and measurements.
bool param_is_id(const char *text);
