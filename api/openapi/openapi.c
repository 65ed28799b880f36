#include "api/openapi/openapi.h"

#include "api/http/problem.h"
#include "api/json/json_layout.h"
#include "api/openapi/openapi_priv.h"
#include "api/results/colormap.h"
#include "api/scenario/examples.h"
#include "core/run/run.h"

#include <stdio.h>
#include <string.h>

static const char description[] =
    "Beltflow predicts how parts on a conveyor belt jam in front of a deflector and how fast they "
    "get past it, by a macroscopic model (density) and a microscopic one (every part).\n\n"
    "Submit a scenario with `POST /v1/runs`, follow it with its `events` or poll it until its "
    "`status` is `succeeded`, `failed` or `cancelled`, and read its curve, snapshots and summary; "
    "they can be read while it is solved, too. The scenarios of `/v1/examples` are a good "
    "start.\n\n"
    "Units are SI and are the last part of each name: `_s`, `_m`, `_m_s`, `_per_m2`. A member that "
    "is not known is refused, with the most similar name. Samples, parts and parameters "
    "in answers read back to the same bits; what was computed of them has 12 digits. What is not "
    "known is null.\n\n"
    "HEAD is answered wherever GET is, and OPTIONS on every path with `Allow`. Where there are "
    "several formats each has a path of its own, that of the first with `.csv`, `.png` and so on "
    "behind it; the first path knows `?format=` and `Accept`, too. Text is compressed for clients "
    "that accept it. Errors are problem documents (RFC 9457). Where the service has access tokens, "
    "a request needs one that has the operation's scope.";

static const struct {
    const char *name;
    const char *help;
} tags[] = {
    { "Runs", "Submit, list, follow and end runs." },
    { "Results", "Results of a run, also while it is solved." },
    { "Studies", "Vary numbers of a scenario and find what is best, and how sure that is." },
    { "Events", "Events of a run or a study as a stream." },
    { "Comparison", "Measured curves and comparisons of results." },
    { "Scenarios", "Ready scenarios and validation." },
    { "Grants", "Links to one run or study for who has no access token." },
    { "Workers", "Runs for workers on other machines." },
    { "Service", "State and version of the service." },
};

void openapi__write_colormaps(json_out *w, size_t tag)
{
    const char *words = colormap_words();

    (void)tag;
    json_out_key_string(w, "type", "string");
    json_out_key(w, "enum");
    schema_write_words(w, words);
}

const char *openapi__text(const char *name)
{
    const openapi_text *text = openapi__texts;

    while (strcmp(text->name, name) != 0)
        text++;
    return text->text;
}

static void write_info(json_out *w)
{
    json_out_key(w, "info");
    json_out_object(w);
    json_out_key_string(w, "title", "Beltflow");
    json_out_key_string(w, "summary", "Material flow on conveyor belts");
    bf_buffer text = { 0 };
    if (buffer_printf(&text, "%s", description) == BF_OK && openapi__write_manual(&text) == BF_OK)
        json_out_key_string(w, "description", text.bytes);
    else
        w->has_failed = true;
    buffer_fini(&text);
    json_out_key(w, "contact");
    json_out_object(w);
    json_out_key_string(w, "name", "Beltflow");
    json_out_object_end(w);
    json_out_key_string(w, "version", BELTFLOW_VERSION);
    json_out_object_end(w);
}

// A ready scenario twice: as it is, and in the body that submits it.
static void write_example(json_out *w, const example *item)
{
    char name[96];

    snprintf(name, sizeof name, "%s-scenario", item->name);
    json_out_key(w, name);
    json_out_object(w);
    json_out_key(w, "value");
    json_out_raw(w, item->document, item->n);
    json_out_object_end(w);
    snprintf(name, sizeof name, "%s-run", item->name);
    json_out_key(w, name);
    json_out_object(w);
    json_out_key(w, "value");
    json_out_object(w);
    json_out_key(w, "scenario");
    json_out_raw(w, item->document, item->n);
    json_out_key_string(w, "model", run_model_words[RUN_MACRO]);
    json_out_key_string(w, "label", item->name);
    json_out_object_end(w);
    json_out_object_end(w);
}

static bool is_needed(api_scope scope)
{
    size_t n = 0;
    const route *table = routes_list(&n);

    for (size_t i = 0; i < n; i++) {
        if (table[i].scope == scope)
            return true;
    }
    return false;
}

static void write_security_scheme(json_out *w, api_scope scope)
{
    const char *word = api_access_word(scope);
    char which[64] = "any scope", help[160];

    if (!is_needed(scope))
        return;
    if (scope != API_SCOPE_ANY)
        snprintf(which, sizeof which, "the scope `%s` or `admin`", word);
    snprintf(help, sizeof help,
             "An access token with %s, if the service has tokens; `beltflowd token add` makes one.",
             which);
    json_out_key(w, word);
    json_out_object(w);
    json_out_key_string(w, "type", "http");
    json_out_key_string(w, "scheme", "bearer");
    json_out_key_string(w, "description", help);
    json_out_object_end(w);
}

// One for each scope that an operation needs: HTTP schemes have no scopes of their own.
static void write_security_schemes(json_out *w)
{
    json_out_key(w, "securitySchemes");
    json_out_object(w);
#define X(scope, flag, word) write_security_scheme(w, scope);
    API_SCOPE_LIST(X)
#undef X
    write_security_scheme(w, API_SCOPE_ANY);
    json_out_key(w, "ticket");
    json_out_object(w);
    json_out_key_string(w, "type", "apiKey");
    json_out_key_string(w, "in", "query");
    json_out_key_string(w, "name", "ticket");
    json_out_key_string(w, "description",
                        "What POST /v1/tickets answers, where no header can be sent.");
    json_out_object_end(w);
    json_out_object_end(w);
}

static void write_components(json_out *w)
{
    json_out_key(w, "components");
    json_out_object(w);
    write_security_schemes(w);
    json_out_key(w, "schemas");
    json_out_object(w);
    openapi__write_input_schemas(w);
    openapi__write_output_schemas(w);
    json_out_object_end(w);
    json_out_key(w, "responses");
    json_out_object(w);
    openapi__write_refusals(w);
    json_out_object_end(w);
    json_out_key(w, "headers");
    json_out_object(w);
    openapi__write_header_components(w);
    json_out_object_end(w);
    size_t n;
    const example *items = examples_list(&n);
    json_out_key(w, "examples");
    json_out_object(w);
    for (size_t k = 0; k < n; k++)
        write_example(w, &items[k]);
    json_out_object_end(w);
    json_out_object_end(w);
}

static void write_document(json_out *w)
{
    json_out_object(w);
    json_out_key_string(w, "openapi", "3.1.0");
    write_info(w);
    // The service that the document came from. Operations that want a token say so themselves.
    json_out_key(w, "servers");
    json_out_array(w);
    json_out_object(w);
    json_out_key_string(w, "url", "/");
    json_out_key_string(w, "description", "The daemon that this document came from");
    json_out_object_end(w);
    json_out_array_end(w);
    json_out_key(w, "security");
    json_out_array(w);
    json_out_array_end(w);
    json_out_key(w, "tags");
    json_out_array(w);
    for (size_t k = 0; k < sizeof tags / sizeof *tags; k++) {
        json_out_object(w);
        json_out_key_string(w, "name", tags[k].name);
        json_out_key_string(w, "description", tags[k].help);
        json_out_object_end(w);
    }
    json_out_array_end(w);
    json_out_key(w, "paths");
    json_out_object(w);
    openapi__write_paths(w);
    json_out_object_end(w);
    write_components(w);
    json_out_object_end(w);
}

bf_status openapi_write(bf_buffer *out, bf_error *err)
{
    bf_buffer text = { 0 };
    json_out w = json_out_to(&text);

    write_document(&w);
    bf_status status = json_out_status(&w, err);
    if (status == BF_OK)
        status = json_layout(text.bytes, text.n, out, err);
    buffer_fini(&text);
    return status;
}
