// The tables of members (members.h) as schemas: each object of a client's document once as it may be
// given, and, below the scenario, once as it is resolved, with every member there; and the rows of
// output_schemas.c.

#include "api/openapi/openapi_priv.h"

#include "api/json/text.h"
#include "api/results/annotations_json.h"
#include "api/results/grant_json.h"
#include "api/results/lease_json.h"
#include "api/results/measurement.h"
#include "api/scenario/scenario_members.h"
#include "api/scenario/submission.h"
#include "api/study/study_document.h"
#include "core/base/check.h"

#include <ctype.h>
#include <stdio.h>
#include <string.h>

enum { TABLES_MAX = 64, HELP_SIZE = 300 };

// The tables that were written, so that none is written twice.
typedef struct seen {
    const member_table *tables[TABLES_MAX];
    size_t n;
} seen;

// How a table is written: in which view, and which of its choices.
typedef struct form {
    member_view view;
    const char *const *names; // of forms: the members that are there; NULL: all
    size_t choice;            // MEMBER_ONE_OF, MEMBER_TAGGED: which
} form;

static void append(char *text, const char *before, const char *what)
{
    size_t n = strlen(text);
    int added = what == NULL ? 0 : snprintf(text + n, HELP_SIZE - n, "%s%s", before, what);

    BF_CHECK(added >= 0 && n + (size_t)added < HELP_SIZE);
}

static void write_help(json_out *w, const member_table *table, const member *m, bool tells_default)
{
    char text[HELP_SIZE] = "", size[MEMBER_TEXT_SIZE], standard[MEMBER_TEXT_SIZE];

    append(text, "", m->help);
    text[0] = (char)toupper((unsigned char)text[0]);
    append(text, " [", m->unit);
    append(text, "]", m->unit == NULL ? NULL : "");
    snprintf(size, sizeof size, "%zu bytes of UTF-8", m->limit - 1);
    append(text, "; at most ", m->kind == &member_text && m->limit > 0 ? size : NULL);
    append(text, "; null: ", m->null);
    w->has_failed |= !members_default_text(table, m, standard);
    append(text, ". Default: ", tells_default ? standard : NULL);
    json_out_key_string(w, "description", text);
}

// In answers a type is a short text, which null may widen; clients' documents have limits, too.
static void write_type(json_out *w, const member *m, member_view view)
{
    const char *type = m->type != NULL ? m->type : m->kind->type;
    char text[MEMBER_TEXT_SIZE];

    if (type == NULL || (view != MEMBER_ANSWER && m->kind->write_schema != NULL)) {
        m->kind->write_schema(w, m, view);
        return;
    }
    snprintf(text, sizeof text, "%s%s", type, m->null == NULL ? "" : "?");
    schema_write_members(w, text);
}

// True if the member is there because of the form that its object has.
static bool is_chosen_by(const member_table *table, const member *m, const form *f)
{
    bool has_default_there = table->choice == MEMBER_ONE_FORM && members_has_default(m);

    return f->names != NULL && text_has_word(f->names, m->name) && !has_default_there;
}

static void write_member(json_out *w, const member_table *table, const member *m, const form *f)
{
    bool is_tag = table->choice == MEMBER_TAGGED && m == table->members;
    // The member that selects one of several forms of an object has no default.
    bool chooses = is_tag || table->choice == MEMBER_ONE_OF || is_chosen_by(table, m, f);
    bool has_default = f->view == MEMBER_GIVEN && members_has_default(m) && !chooses;

    json_out_key(w, m->name);
    json_out_object(w);
    if (is_tag) {
        json_out_key_string(w, "type", "string");
        json_out_key_string(w, "const", m->words[f->choice]);
    } else {
        write_type(w, m, f->view);
    }
    // Generators of clients take a member with the keyword `default` for one that is always there.
    write_help(w, table, m, has_default);
    json_out_object_end(w);
}

// True if the member can stand in this form of its object.
static bool belongs(const member_table *table, const member *m, const form *f)
{
    size_t index = (size_t)(m - table->members);

    if (f->view != MEMBER_GIVEN && (m->flags & (MEMBER_FORM | MEMBER_FILE)) != 0)
        return false;
    if (f->names != NULL) {
        bool is_of_a_form = false;
        for (const char *const *const *names = table->forms; *names != NULL; names++)
            is_of_a_form = is_of_a_form || text_has_word(*names, m->name);
        return !is_of_a_form || text_has_word(f->names, m->name);
    }
    if (table->choice == MEMBER_ONE_OF)
        return index == f->choice;
    return table->choice != MEMBER_TAGGED || m->tags == 0 || (m->tags >> f->choice & 1U) != 0;
}

static bool is_required(json_out *w, const member_table *table, const member *m, const form *f)
{
    char standard[MEMBER_TEXT_SIZE];

    if (f->view != MEMBER_GIVEN)
        return (m->flags & (MEMBER_OMIT_EMPTY | MEMBER_OMIT_DEFAULT | MEMBER_OPTIONAL)) == 0 &&
               ((m->applies == NULL && m->offset_if == 0) || (m->flags & MEMBER_SERVED) != 0);
    if (is_chosen_by(table, m, f))
        return true;
    // Without its tag an object is of the kind that is the tag's default.
    if (table->choice == MEMBER_TAGGED && m == table->members) {
        w->has_failed |= !members_default_text(table, m, standard);
        return strcmp(standard, m->words[f->choice]) != 0;
    }
    return !members_has_default(m) || table->choice == MEMBER_ONE_OF;
}

static void write_properties(json_out *w, const member_table *table, const form *f)
{
    for (size_t k = 0; k < table->n; k++) {
        const member *m = &table->members[k];
        if (m->name == NULL)
            write_properties(w, m->table, f);
        else if (belongs(table, m, f))
            write_member(w, table, m, f);
    }
}

// Opens the list, too, before the first name.
static void write_required(json_out *w, const member_table *table, const form *f, bool *is_open)
{
    for (size_t k = 0; k < table->n; k++) {
        const member *m = &table->members[k];
        if (m->name == NULL) {
            write_required(w, m->table, f, is_open);
            continue;
        }
        if (!belongs(table, m, f) || !is_required(w, table, m, f))
            continue;
        if (!*is_open) {
            json_out_key(w, "required");
            json_out_array(w);
        }
        *is_open = true;
        json_out_string(w, m->name);
    }
}

// others: the type of members of any other name, "" any; NULL: there are none.
static void write_object(json_out *w, const member_table *table, const form *f, const char *others)
{
    bool has_required = false;

    json_out_key_string(w, "type", "object");
    json_out_key(w, "properties");
    json_out_object(w);
    write_properties(w, table, f);
    json_out_object_end(w);
    write_required(w, table, f, &has_required);
    if (has_required)
        json_out_array_end(w);
    json_out_key(w, "additionalProperties");
    if (others == NULL || *others == '\0')
        json_out_bool(w, others != NULL);
    else
        schema_write(w, others, NULL, NULL);
}

static void write_choice(json_out *w, const member_table *table, const form *f, const char *title)
{
    json_out_object(w);
    json_out_key_string(w, "title", title);
    write_object(w, table, f, NULL);
    json_out_object_end(w);
}

// An object of several forms is exactly one of them.
static void write_choices(json_out *w, const member_table *table, member_view view)
{
    form f = { .view = view };

    json_out_key(w, "oneOf");
    json_out_array(w);
    if (table->forms != NULL) {
        for (const char *const *const *names = table->forms; *names != NULL; names++) {
            f.names = *names;
            write_choice(w, table, &f, **names);
        }
    } else if (table->choice == MEMBER_ONE_OF) {
        for (; f.choice < table->n; f.choice++)
            write_choice(w, table, &f, table->members[f.choice].name);
    } else {
        for (; table->members[0].words[f.choice] != NULL; f.choice++)
            write_choice(w, table, &f, table->members[0].words[f.choice]);
    }
    json_out_array_end(w);
}

// A table, then those of its members.
static void write_tables(json_out *w, const member_table *table, member_view view, seen *done)
{
    for (size_t k = 0; k < done->n; k++) {
        if (done->tables[k] == table)
            return;
    }
    BF_CHECK(done->n < TABLES_MAX);
    done->tables[done->n++] = table;
    bool has_choices =
        table->choice != MEMBER_ALL || (table->forms != NULL && view == MEMBER_GIVEN);
    const form all = { .view = view };
    char name[MEMBER_TEXT_SIZE];
    members_schema_name(table, view, name);
    json_out_key(w, name);
    json_out_object(w);
    if (has_choices)
        write_choices(w, table, view);
    else
        write_object(w, table, &all, NULL);
    json_out_object_end(w);
    for (size_t k = 0; k < table->n; k++) {
        if (table->members[k].table != NULL)
            write_tables(w, table->members[k].table, view, done);
        if (table->members[k].items != NULL)
            write_tables(w, table->members[k].items, view, done);
    }
}

void openapi__write_input_schemas(json_out *w)
{
    seen given = { .n = 0 };
    seen resolved = { .n = 0 };

    write_tables(w, &submission_members, MEMBER_GIVEN, &given);
    write_tables(w, &study_document_members, MEMBER_GIVEN, &given);
    write_tables(w, &measurement_members, MEMBER_GIVEN, &given);
    write_tables(w, &annotations_json_run, MEMBER_GIVEN, &given);
    write_tables(w, &annotations_json_study, MEMBER_GIVEN, &given);
    write_tables(w, &grant_json_request_members, MEMBER_GIVEN, &given);
    write_tables(w, &lease_json_worker_members, MEMBER_GIVEN, &given);
    write_tables(w, &lease_json_renewal_members, MEMBER_GIVEN, &given);
    write_tables(w, &scenario_members, MEMBER_RESOLVED, &resolved);
}

static void write_schema(json_out *w, const openapi_schema *schema)
{
    const form f = { .view = MEMBER_ANSWER, .choice = schema->tag };

    json_out_key(w, schema->name != NULL ? schema->name : schema->table->title);
    json_out_object(w);
    json_out_key_string(w, "description", schema->help);
    if (schema->table != NULL)
        write_object(w, schema->table, &f, schema->others);
    else if (schema->type != NULL)
        schema_write_members(w, schema->type);
    else if (schema->words != NULL)
        member_enum.write_schema(w, &(member){ .words = schema->words }, MEMBER_ANSWER);
    else if (schema->one_of != NULL) {
        const char *names = schema->one_of;
        json_out_key(w, "oneOf");
        json_out_array(w);
        for (size_t n; (n = schema_next_word(&names)) > 0; names += n) {
            json_out_object(w);
            schema_write_ref(w, "schemas", names, n);
            json_out_object_end(w);
        }
        json_out_array_end(w);
    } else {
        schema->write(w, schema->tag);
    }
    schema_write_limits(w, schema->limits);
    json_out_object_end(w);
}

void openapi__write_output_schemas(json_out *w)
{
    size_t n;
    const openapi_schema *schemas = openapi__schemas(&n);

    for (size_t k = 0; k < n; k++)
        write_schema(w, &schemas[k]);
}
