// The tables of the documents that clients send (members.h) as schemas: each object once as it may
// be given, and, below the scenario, once as it is resolved, with every member there.

#include "api/openapi/openapi_priv.h"

#include "api/results/measurement.h"
#include "api/scenario/scenario_members.h"
#include "api/scenario/submission.h"
#include "core/base/check.h"

#include <ctype.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { TABLES_MAX = 40, NAME_SIZE = 64, HELP_SIZE = 300 };

// The tables that were written, so that none is written twice.
typedef struct seen {
    const member_table *tables[TABLES_MAX];
    size_t n;
} seen;

// How a table is written: as it may be given or resolved, and which of its choices.
typedef struct form {
    bool is_resolved;
    const char *const *names; // MEMBER_FORM: the members that are there; NULL: all
    size_t choice;            // MEMBER_ONE_OF, MEMBER_TAGGED: which
} form;

// "kind" is "Kind", or "ResolvedKind".
static void name_table(const member_table *table, bool is_resolved, char *ret_name)
{
    const char *prefix = is_resolved ? "Resolved" : "";
    int n = snprintf(ret_name, NAME_SIZE, "%s%s", prefix, table->title);

    BF_CHECK(n > 0 && n < NAME_SIZE);
    char *first = ret_name + strlen(prefix);
    *first = (char)toupper((unsigned char)*first);
}

static void write_table_ref(json_out *w, const member_table *table, bool is_resolved)
{
    char name[NAME_SIZE];

    name_table(table, is_resolved, name);
    schema_write_ref(w, "schemas", name, strlen(name));
}

static bool has_word(const char *const *words, const char *word)
{
    while (*words != NULL && strcmp(*words, word) != 0)
        words++;
    return *words != NULL;
}

static void write_range(json_out *w, const member_range *range, double most)
{
    double maximum = range == NULL ? most : fmin(range->maximum, most);

    if (range != NULL && isfinite(range->minimum))
        json_out_key_number(w, range->excludes_min ? "exclusiveMinimum" : "minimum",
                            range->minimum);
    if (isfinite(maximum))
        json_out_key_number(
            w, range != NULL && range->excludes_max ? "exclusiveMaximum" : "maximum", maximum);
}

static void write_numbers(json_out *w, size_t least, size_t most)
{
    json_out_key_string(w, "type", "array");
    json_out_key(w, "items");
    json_out_object(w);
    json_out_key_string(w, "type", "number");
    json_out_object_end(w);
    json_out_key_integer(w, "minItems", (int64_t)least);
    json_out_key_integer(w, "maxItems", (int64_t)most);
}

static void write_items_limits(json_out *w, const member *m)
{
    json_out_key_integer(w, "minItems", (int64_t)m->least);
    json_out_key_integer(w, "maxItems", (int64_t)m->limit);
}

static void write_tuples(json_out *w, const member *m, size_t least, size_t most)
{
    json_out_key_string(w, "type", "array");
    json_out_key(w, "items");
    json_out_object(w);
    write_numbers(w, least, most);
    json_out_object_end(w);
    write_items_limits(w, m);
}

static void write_number_list(json_out *w, const member *m)
{
    json_out_key_string(w, "type", "array");
    json_out_key(w, "items");
    json_out_object(w);
    json_out_key_string(w, "type", "number");
    write_range(w, m->range, INFINITY);
    json_out_object_end(w);
    write_items_limits(w, m);
}

static void write_objects(json_out *w, const member *m, const member_table *items, bool is_resolved)
{
    json_out_key_string(w, "type", "array");
    json_out_key(w, "items");
    json_out_object(w);
    write_table_ref(w, items, is_resolved);
    json_out_object_end(w);
    write_items_limits(w, m);
}

static void write_words(json_out *w, const char *const *words)
{
    json_out_key_string(w, "type", "string");
    json_out_key(w, "enum");
    json_out_array(w);
    for (; *words != NULL; words++)
        json_out_string(w, *words);
    json_out_array_end(w);
}

static void write_step(json_out *w, const member *m)
{
    json_out_key(w, "oneOf");
    json_out_array(w);
    json_out_object(w);
    json_out_key_string(w, "type", "number");
    write_range(w, m->range, INFINITY);
    json_out_object_end(w);
    schema_write(w, "=auto", NULL, NULL);
    json_out_array_end(w);
}

static void write_mix(json_out *w, const member *m, bool is_resolved)
{
    json_out_key(w, "oneOf");
    json_out_array(w);
    json_out_object(w);
    write_table_ref(w, m->table, is_resolved);
    json_out_object_end(w);
    json_out_object(w);
    write_objects(w, m, m->items, is_resolved);
    json_out_object_end(w);
    json_out_array_end(w);
}

static void write_number(json_out *w, const member *m)
{
    bool is_whole = m->kind != MEMBER_NUMBER;

    json_out_key_string(w, "type", is_whole ? "integer" : "number");
    write_range(w, m->range, m->kind == MEMBER_COUNT ? (double)UINT32_MAX : (double)INFINITY);
}

static void write_text(json_out *w, const member *m)
{
    json_out_key_string(w, "type", "string");
    if (m->least > 0)
        json_out_key_integer(w, "minLength", (int64_t)m->least);
    json_out_key_integer(w, "maxLength", (int64_t)m->limit - 1);
}

static void write_kind(json_out *w, const member *m, bool is_resolved)
{
    switch (m->kind) {
    case MEMBER_STEP:
        write_step(w, m);
        break;
    case MEMBER_BOOL:
        json_out_key_string(w, "type", "boolean");
        break;
    case MEMBER_TEXT:
        write_text(w, m);
        break;
    case MEMBER_WORD:
        write_words(w, m->words);
        break;
    case MEMBER_POINT:
    case MEMBER_INTERVAL:
        write_numbers(w, 2, 2);
        break;
    case MEMBER_NUMBERS:
        write_number_list(w, m);
        break;
    case MEMBER_POINTS:
    case MEMBER_OUTLINE:
        write_tuples(w, m, 2, 2);
        break;
    case MEMBER_VERTICES:
        write_tuples(w, m, 3, 3);
        break;
    case MEMBER_POSES:
        write_tuples(w, m, 2, 3);
        break;
    case MEMBER_OBJECT:
        write_table_ref(w, m->table, is_resolved);
        break;
    case MEMBER_LIST:
        write_objects(w, m, m->table, is_resolved);
        break;
    case MEMBER_MIX:
        write_mix(w, m, is_resolved);
        break;
    default:
        write_number(w, m);
        break;
    }
}

// The default as a JSON value, where its text in the table is one; else false, and nothing is
// written: then it is for people.
static bool write_default(json_out *w, const member *m)
{
    const char *text = m->standard;
    char *end;

    // A text's default is a word, or, with blanks, a way to make it.
    bool is_text = m->kind == MEMBER_TEXT && strchr(text, ' ') == NULL;

    if (m->kind == MEMBER_TEXT && strcmp(text, "empty") == 0)
        text = "";
    if (m->kind == MEMBER_WORD || is_text) {
        json_out_key_string(w, "default", text);
    } else if (*text == '[' || *text == '{' || m->kind == MEMBER_BOOL) {
        json_out_key(w, "default");
        json_out_raw(w, text, strlen(text));
    } else {
        double value = strtod(text, &end);
        if (end == text || *end != '\0')
            return false;
        json_out_key_number(w, "default", value);
    }
    return true;
}

static void write_help(json_out *w, const member *m, bool tells_default)
{
    char text[HELP_SIZE];
    int n = snprintf(text, sizeof text, "%s", m->help);

    text[0] = (char)toupper((unsigned char)text[0]);
    if (m->unit != NULL)
        n += snprintf(text + n, sizeof text - (size_t)n, " [%s]", m->unit);
    if (m->kind == MEMBER_TEXT)
        n += snprintf(text + n, sizeof text - (size_t)n, "; at most %zu bytes of UTF-8",
                      m->limit - 1);
    if (tells_default)
        n += snprintf(text + n, sizeof text - (size_t)n, ". Default: %s", m->standard);
    BF_CHECK(n > 0 && (size_t)n < sizeof text);
    json_out_key_string(w, "description", text);
}

static void write_member(json_out *w, const member_table *table, const member *m, const form *f)
{
    bool is_tag = table->choice == MEMBER_TAGGED && m == table->members;
    // What says which of several forms an object has has no default.
    bool chooses = is_tag || table->choice == MEMBER_ONE_OF ||
                   (f->names != NULL && has_word(f->names, m->name));
    bool has_default = !f->is_resolved && m->standard != NULL && !chooses;

    json_out_key(w, m->name);
    json_out_object(w);
    if (is_tag) {
        json_out_key_string(w, "type", "string");
        json_out_key_string(w, "const", m->words[f->choice]);
    } else {
        write_kind(w, m, f->is_resolved);
    }
    write_help(w, m, has_default && !write_default(w, m));
    json_out_object_end(w);
}

// True if the member can stand in this form of its object.
static bool belongs(const member_table *table, const member *m, const form *f)
{
    size_t index = (size_t)(m - table->members);

    if (f->is_resolved && (m->flags & MEMBER_FORM) != 0)
        return false;
    if (!f->is_resolved && table->forms != NULL) {
        bool is_of_a_form = false;
        for (const char *const *const *names = table->forms; *names != NULL; names++)
            is_of_a_form = is_of_a_form || has_word(*names, m->name);
        return !is_of_a_form || has_word(f->names, m->name);
    }
    if (table->choice == MEMBER_ONE_OF)
        return index == f->choice;
    return table->choice != MEMBER_TAGGED || m->tags == 0 || (m->tags >> f->choice & 1U) != 0;
}

static bool is_required(const member_table *table, const member *m, const form *f)
{
    if (f->is_resolved)
        return (m->flags & MEMBER_OMIT_EMPTY) == 0;
    if (f->names != NULL && has_word(f->names, m->name))
        return true;
    // Without its tag an object is of the kind that is the tag's default.
    if (table->choice == MEMBER_TAGGED && m == table->members)
        return strcmp(m->standard, m->words[f->choice]) != 0;
    return m->standard == NULL || table->choice == MEMBER_ONE_OF;
}

static void write_object(json_out *w, const member_table *table, const form *f)
{
    bool has_required = false;

    json_out_key_string(w, "type", "object");
    json_out_key(w, "properties");
    json_out_object(w);
    for (size_t k = 0; k < table->n; k++) {
        if (belongs(table, &table->members[k], f))
            write_member(w, table, &table->members[k], f);
    }
    json_out_object_end(w);
    for (size_t k = 0; k < table->n; k++) {
        const member *m = &table->members[k];
        if (!belongs(table, m, f) || !is_required(table, m, f))
            continue;
        if (!has_required) {
            json_out_key(w, "required");
            json_out_array(w);
        }
        has_required = true;
        json_out_string(w, m->name);
    }
    if (has_required)
        json_out_array_end(w);
    json_out_key_bool(w, "additionalProperties", false);
}

static void write_choice(json_out *w, const member_table *table, const form *f, const char *title)
{
    json_out_object(w);
    json_out_key_string(w, "title", title);
    write_object(w, table, f);
    json_out_object_end(w);
}

// An object of several forms is exactly one of them.
static void write_choices(json_out *w, const member_table *table, bool is_resolved)
{
    form f = { .is_resolved = is_resolved };

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

static void write_table(json_out *w, const member_table *table, bool is_resolved)
{
    bool has_choices = table->choice != MEMBER_ALL || (table->forms != NULL && !is_resolved);
    const form all = { .is_resolved = is_resolved };
    char name[NAME_SIZE];

    name_table(table, is_resolved, name);
    json_out_key(w, name);
    json_out_object(w);
    if (has_choices)
        write_choices(w, table, is_resolved);
    else
        write_object(w, table, &all);
    json_out_object_end(w);
}

// A table and, behind it, those of its members.
static void write_tables(json_out *w, const member_table *table, bool is_resolved, seen *done)
{
    for (size_t k = 0; k < done->n; k++) {
        if (done->tables[k] == table)
            return;
    }
    BF_CHECK(done->n < TABLES_MAX);
    done->tables[done->n++] = table;
    write_table(w, table, is_resolved);
    for (size_t k = 0; k < table->n; k++) {
        if (table->members[k].table != NULL)
            write_tables(w, table->members[k].table, is_resolved, done);
        if (table->members[k].items != NULL)
            write_tables(w, table->members[k].items, is_resolved, done);
    }
}

void openapi__write_member_schemas(json_out *w)
{
    seen given = { .n = 0 };
    seen resolved = { .n = 0 };

    write_tables(w, &submission_members, false, &given);
    write_tables(w, &measurement_members, false, &given);
    write_tables(w, &scenario_members, true, &resolved);
}
