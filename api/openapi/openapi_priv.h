/// The tables of the OpenAPI document and what writes them. Types are short texts as in
/// api/json/schema.h; "#Name" is the schema of output_schemas.c with this name.

#pragma once

#include "api/http/media.h"
#include "api/http/routes.h"
#include "api/json/json_out.h"
#include "api/json/members.h"
#include "api/json/schema.h"

#include <stdbool.h>
#include <stddef.h>

/// A schema under /components/schemas. One of table, type, one_of and write says what it is.
typedef struct openapi_schema {
    const char *name;           ///< "Share"; NULL: the title of the table
    const char *help;           ///< what it is
    const member_table *table;  ///< an object with these members
    size_t tag;                 ///< of a table with a tag: which one
    const char *others;         ///< type of members of any other name, "" any; NULL: there are none
    const char *type;           ///< a type as short text, with the limits below
    const char *limits;         ///< JSON members that narrow type, "\"minimum\":0"; NULL: none
    const char *one_of;         ///< names of schemas, one of which it is: words
    void (*write)(json_out *w); ///< writes all of it but the description
} openapi_schema;

/// A parameter in a query, in a path or in a request's header.
typedef struct openapi_parameter {
    const char *name;     ///< as it is sent
    const char *in;       ///< "query", "path" or "header"
    const char *path;     ///< only of routes with this template; NULL: of all others
    const char *type;     ///< as above; a list is sent with commas. NULL: the route's formats
    const char *limits;   ///< as of a schema
    const char *standard; ///< default as JSON text; NULL: none
    bool is_required;     ///< it must be given
    const char *help;     ///< what it does
} openapi_parameter;

/// A header of answers.
typedef struct openapi_header {
    const char *name; ///< "ETag"
    const char *type; ///< as above
    bool may_lack;    ///< it is not always there
    const char *help; ///< what it says
} openapi_header;

enum { OPENAPI_ANSWERS_MAX = 3 }; ///< answers of an operation that are no refusals

/// An answer that is no refusal.
typedef struct openapi_answer {
    int status;          ///< HTTP status; 0: no answer
    const char *schema;  ///< name of the body's schema as JSON; NULL: no body, or no JSON
    const char *headers; ///< words of openapi_headers.c
    const char *help;    ///< when it is given
    const char *formats; ///< words of media.h where it comes in some of the route's only; else NULL
} openapi_answer;

/// What a document needs of a route beside its row in routes.c.
typedef struct openapi_operation {
    const char *method;       ///< of the route
    const char *path;         ///< of the route
    const char *id;           ///< operationId, for programs that are made from the document
    const char *tag;          ///< under which it is listed
    const char *help;         ///< what a client should know
    const char *body;         ///< schema of the request's body as JSON; NULL: there is none
    const char *body_formats; ///< formats of it, words of media.h; NULL: JSON only
    const char *headers;      ///< request headers that it heeds: words of the parameters
    const char *refusals;     ///< HTTP statuses beside those that any request can meet: words
    openapi_answer answers[OPENAPI_ANSWERS_MAX]; ///< the others
} openapi_operation;

/// The tables; *ret_n is how many rows.
const openapi_operation *openapi__operations(size_t *ret_n);
const openapi_schema *openapi__schemas(size_t *ret_n);
const openapi_parameter *openapi__parameters(size_t *ret_n);
const openapi_header *openapi__headers(size_t *ret_n);

/// A text that the build made from a file.
typedef struct openapi_text {
    const char *name; ///< of the file without its ending; NULL ends the list
    const char *text; ///< n bytes and a terminating zero
    size_t n;         ///< bytes
} openapi_text;

/// first_steps.md, Markdown, alone in its list.
extern const openapi_text openapi__first_steps[];

/// HTTP statuses of the refusals that any request can meet, and headers of every answer: words.
extern const char openapi__common_refusals[];
extern const char openapi__common_headers[];

/// A row, or NULL if there is none. words is of n bytes where it need not end.
const openapi_operation *openapi__operation(const char *method, const char *path);
const openapi_parameter *openapi__parameter(const char *in, const char *path, const char *name,
                                            size_t n);
const openapi_header *openapi__header(const char *name, size_t n);

/// Name of the schema of bodies in a format, NULL for JSON, whose schemas are the operations'.
const char *openapi__format_schema(media_format format);

/// Write the member `headers` of an answer, the words and those of every answer, and the members of
/// `responses` for the refusals of an operation, into an object that is open.
void openapi__write_headers(json_out *w, const char *words);
void openapi__write_refusals_of(json_out *w, const openapi_operation *operation);

/// Write the members of /components/schemas, /paths, /components/responses, /components/headers.
void openapi__write_output_schemas(json_out *w);
void openapi__write_input_schemas(json_out *w);
void openapi__write_paths(json_out *w);
void openapi__write_refusals(json_out *w);
void openapi__write_header_components(json_out *w);

/// Write what output_schemas.c has no rows for: enumerations of the code's tables.
void openapi__write_states(json_out *w);
void openapi__write_models(json_out *w);
void openapi__write_colormaps(json_out *w);
void openapi__write_status_words(json_out *w);
void openapi__write_problem_types(json_out *w);
