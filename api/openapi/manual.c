#include "api/http/problem.h"
#include "api/json/members.h"
#include "api/json/text.h"
#include "api/openapi/openapi_priv.h"
#include "api/results/measurement.h"
#include "api/scenario/goods_json.h"
#include "api/scenario/scenario_members.h"
#include "api/scenario/submission.h"
#include "api/study/study_document.h"

#include <stdio.h>
#include <string.h>

// Files of api/docs/, in the order in which they are read.
static const char *const chapters[] = {
    "first_steps", "more_over_http", "scenario",  "goods",         "submitting", "results",
    "studies",     "measurements",   "comparing", "http",          "problems",   "guarantees",
    "limits",      "access",         "operating", "other_origins", "stability",
};

static bool is_of_a_form(const member_table *table, const member *m)
{
    for (size_t k = 0; table->choice == MEMBER_ONE_FORM && table->forms[k] != NULL; k++) {
        if (text_has_word(table->forms[k], m->name))
            return true;
    }
    return false;
}

static bf_status write_row(bf_buffer *out, const member_table *table, const member *m,
                           const char *pointer)
{
    char kind[120], range[MEMBER_TEXT_SIZE], standard[MEMBER_TEXT_SIZE];

    const size_t size = sizeof kind;
    size_t n = 0;
    if (m->kind == &member_text)
        snprintf(kind, size, "string, at most %zu bytes", m->limit - 1);
    else if (m->limit > 0)
        snprintf(kind, size, "%s, %zu to %zu", m->kind->text, m->least, m->limit);
    else if (m->kind->text != NULL)
        snprintf(kind, size, "%s", m->kind->text);
    for (size_t k = 0; m->kind->text == NULL && m->words != NULL && m->words[k] != NULL; k++)
        n += (size_t)snprintf(kind + n, size - n, "%s%s", k == 0 ? "" : ", ", m->words[k]);
    members_range_text(m->range, range);
    if (!members_default_text(table, m, standard))
        return BF_ENOMEM;
    if (!members_has_default(m) && (m->flags & MEMBER_FORM) == 0)
        snprintf(standard, sizeof standard, "%s",
                 is_of_a_form(table, m) ? "one of several" : "must be given");
    return buffer_printf(out, "| `%s` | %s | %s | %s | %s | %s |\n", pointer, kind,
                         m->unit == NULL ? "" : m->unit, range, standard, m->help);
}

// Rows for the members of an object and of the objects in it, but not for a scenario's, which have a table of their own.
static bf_status write_rows(bf_buffer *out, const member_table *table, const char *pointer)
{
    bf_status status = BF_OK;

    for (size_t k = 0; k < table->n && status == BF_OK; k++) {
        const member *m = &table->members[k];
        const bool is_list = m->kind == &member_list || m->kind == &member_array;
        char at[BF_POINTER_SIZE];
        snprintf(at, sizeof at, "%s/%s", pointer, m->name);
        status = write_row(out, table, m, at);
        snprintf(at, sizeof at, "%s/%s%s", pointer, m->name, is_list ? "/n" : "");
        if (status == BF_OK && m->table != NULL && m->table != &scenario_members)
            status = write_rows(out, m->table, at);
        snprintf(at, sizeof at, "%s/%s/n", pointer, m->name);
        if (status == BF_OK && m->items != NULL)
            status = write_rows(out, m->items, at);
    }
    return status;
}

static bf_status write_members(bf_buffer *out, const member_table *table)
{
    BF_TRY(buffer_printf(
        out, "| member | is | unit | range | default | meaning |\n|---|---|---|---|---|---|\n"));
    return write_rows(out, table, "");
}

static bf_status write_scenario(bf_buffer *out)
{
    return write_members(out, &scenario_members);
}

static bf_status write_submission(bf_buffer *out)
{
    return write_members(out, &submission_members);
}

static bf_status write_study(bf_buffer *out)
{
    return write_members(out, &study_document_members);
}

static bf_status write_measurement(bf_buffer *out)
{
    return write_members(out, &measurement_members);
}

static bf_status write_goods(bf_buffer *out)
{
    return goods_json_write_text(out, NULL);
}

// A paragraph for each kind, under the last segment of its type.
static bf_status write_problems(bf_buffer *out)
{
    size_t n;
    const problem_kind *kinds = problem_kinds(&n);

    for (size_t k = 0; k < n; k++)
        BF_TRY(buffer_printf(out, "%s### %d %s\n\n%s.\n\n%s.\n", k == 0 ? "" : "\n",
                             kinds[k].status, kinds[k].word, kinds[k].when, kinds[k].remedy));
    return BF_OK;
}

// What the line `<!-- table: name -->` of a chapter stands for.
static const struct {
    const char *name;
    bf_status (*write)(bf_buffer *out);
} tables[] = {
    { "scenario", write_scenario }, { "submission", write_submission },
    { "study", write_study },       { "measurement", write_measurement },
    { "goods", write_goods },       { "problems", write_problems },
};

// The table that a line stands for; NULL if it is another line.
static bf_status (*find_table(const char *line))(bf_buffer *)
{
    static const char before[] = "<!-- table: ", after[] = " -->\n";

    if (strncmp(line, before, sizeof before - 1) != 0)
        return NULL;
    line += sizeof before - 1;
    for (size_t k = 0; k < sizeof tables / sizeof tables[0]; k++) {
        const size_t n = strlen(tables[k].name);
        if (strncmp(line, tables[k].name, n) == 0 &&
            strncmp(line + n, after, sizeof after - 1) == 0)
            return tables[k].write;
    }
    return NULL;
}

// A chapter as a section of the description: with its tables, and its headings one level lower.
static bf_status write_chapter(bf_buffer *out, const char *line)
{
    bf_status status = BF_OK;
    bool is_code = false;

    while (*line != '\0' && status == BF_OK) {
        const char *next = strchr(line, '\n') + 1;
        bf_status (*write_table)(bf_buffer *) = find_table(line);
        if (strncmp(line, "```", 3) == 0)
            is_code = !is_code;
        if (write_table != NULL) {
            status = write_table(out);
        } else {
            if (*line == '#' && !is_code)
                status = buffer_append(out, "#", 1);
            if (status == BF_OK)
                status = buffer_append(out, line, (size_t)(next - line));
        }
        line = next;
    }
    return status;
}

bf_status openapi__write_manual(bf_buffer *out)
{
    for (size_t k = 0; k < sizeof chapters / sizeof chapters[0]; k++) {
        BF_TRY(buffer_append(out, "\n\n", 2));
        BF_TRY(write_chapter(out, openapi__text(chapters[k])));
    }
    return BF_OK;
}
