/// The tables of the OpenAPI document and what writes them. Types are short texts as in
/// api/json/schema.h; "#Name" is the schema of output_schemas.c with this name.

#pragma once

#include "api/http/negotiation.h"
#include "api/http/routes.h"
#include "api/json/json_out.h"
#include "api/json/members.h"
#include "api/json/schema.h"
#include "core/base/buffer.h"

#include <stdbool.h>
#include <stddef.h>

/// A schema under /components/schemas. One of table, type, words, one_of and write says what it is.
typedef struct openapi_schema {
    const char *name;          ///< "Share"; NULL: the title of the table
    const char *help;          ///< what it is
    const member_table *table; ///< an object with these members
    size_t tag;         ///< of a table with a tag: which one; of figures of items: their scope
    const char *others; ///< type of members of any other name, "" any; NULL: there are none
    const char *type;   ///< a type as short text, with the limits below
    const char *limits; ///< JSON members that narrow type, "\"minimum\":0"; NULL: none
    const char *const *words;               ///< one of these; NULL-terminated
    const char *one_of;                     ///< names of schemas, one of which it is: words
    void (*write)(json_out *w, size_t tag); ///< writes all of it but the description
} openapi_schema;

/// A header of answers.
typedef struct openapi_header {
    const char *name; ///< "ETag"
    const char *type; ///< as above
    bool may_lack;    ///< it is not always there
    const char *help; ///< what it says
} openapi_header;

/// The tables; *ret_n is how many rows.
const openapi_schema *openapi__schemas(size_t *ret_n);
const openapi_header *openapi__headers(size_t *ret_n);

/// A text that the build made from a file.
typedef struct openapi_text {
    const char *name; ///< of the file without its ending; NULL ends the list
    const char *text; ///< n bytes and a terminating zero
    size_t n;         ///< bytes
} openapi_text;

/// The chapters of the manual (api/docs/), and samples.txt.
extern const openapi_text openapi__texts[];

/// The text of the file with this name, which is there.
const char *openapi__text(const char *name);

/// Append the manual: the chapters of api/docs/ as sections of the description, with their tables of members, goods
/// and problems. Errors: BF_ENOMEM.
BF_MUST_CHECK bf_status openapi__write_manual(bf_buffer *out);

/// Name of the schema of bodies in a format, NULL for JSON, whose schemas are the routes'.
const char *openapi__format_schema(media_format format);

/// Write the member `headers` of an answer, the words and those of every answer, and the members of
/// `responses` for the refusals of a route, into an object that is open.
void openapi__write_headers(json_out *w, const char *words);
void openapi__write_refusals_of(json_out *w, const route *r);

/// Write the member `examples` of a body in a media type into an object that is open, if the tests recorded one of the operation
/// with this id. where: "request", or the status of the answer.
void openapi__write_sample(json_out *w, const char *method, const char *id, const char *where,
                           const char *type);

/// Write the members of /components/schemas, /paths, /components/responses, /components/headers.
void openapi__write_output_schemas(json_out *w);
void openapi__write_input_schemas(json_out *w);
void openapi__write_paths(json_out *w);
void openapi__write_refusals(json_out *w);
void openapi__write_header_components(json_out *w);

/// Write what output_schemas.c has no rows for: key figures and what other tables name.
void openapi__write_figures(json_out *w, size_t tag);
void openapi__write_item_figures(json_out *w, size_t scope);
void openapi__write_colormaps(json_out *w, size_t tag);
void openapi__write_problem_types(json_out *w, size_t tag);
