// The README of api lists what the tables have: every member of the documents, every route.

#include "api/http/routes.h"
#include "api/json/members.h"
#include "api/results/measurement.h"
#include "api/scenario/scenario_members.h"
#include "api/scenario/submission.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

static char readme[100000];

static const char *const kind_words[MEMBER_KIND_COUNT] = {
    [MEMBER_NUMBER] = "number",
    [MEMBER_STEP] = "number or \"auto\"",
    [MEMBER_COUNT] = "whole number",
    [MEMBER_SEED] = "whole number",
    [MEMBER_PRIORITY] = "whole number",
    [MEMBER_BOOL] = "boolean",
    [MEMBER_TEXT] = "string",
    [MEMBER_POINT] = "[x, y]",
    [MEMBER_INTERVAL] = "[from, to]",
    [MEMBER_NUMBERS] = "list of numbers",
    [MEMBER_POINTS] = "list of [x, y]",
    [MEMBER_OUTLINE] = "list of [x, y]",
    [MEMBER_VERTICES] = "list of [x, y, z]",
    [MEMBER_POSES] = "list of [x, y] or [x, y, heading]",
    [MEMBER_OBJECT] = "object",
    [MEMBER_LIST] = "list of objects",
    [MEMBER_MIX] = "object, or list of objects",
};

static void describe_kind(const member *m, char *text, size_t size)
{
    size_t n = 0;

    if (m->kind == MEMBER_TEXT)
        snprintf(text, size, "string, at most %zu bytes", m->limit - 1);
    else if (m->offset_n != 0)
        snprintf(text, size, "%s, %zu to %zu", kind_words[m->kind], m->least, m->limit);
    else if (m->kind != MEMBER_WORD)
        snprintf(text, size, "%s", kind_words[m->kind]);
    for (size_t k = 0; m->kind == MEMBER_WORD && m->words[k] != NULL; k++)
        n += (size_t)snprintf(text + n, size - n, "%s%s", k == 0 ? "" : ", ", m->words[k]);
}

// The line of the README for a member.
static void describe(const member *m, const char *pointer, char *text, size_t size)
{
    char kind[120];
    const char *standard = m->standard != NULL             ? m->standard
                           : (m->flags & MEMBER_FORM) != 0 ? ""
                                                           : "must be given";

    describe_kind(m, kind, sizeof kind);
    snprintf(text, size, "| `%s` | %s | %s | %s | %s | %s |\n", pointer, kind,
             m->unit == NULL ? "" : m->unit, m->range == NULL ? "" : m->range->text, standard,
             m->help);
}

static void check_lines(const member_table *table, const char *pointer)
{
    for (size_t k = 0; k < table->n; k++) {
        const member *m = &table->members[k];
        char at[BF_POINTER_SIZE];
        char line[600];
        snprintf(at, sizeof at, "%s/%s", pointer, m->name);
        describe(m, at, line, sizeof line);
        if (strstr(readme, line) == NULL)
            fail_msg("api/README.md lacks the line\n%s", line);
        snprintf(at, sizeof at, "%s/%s%s", pointer, m->name, m->kind == MEMBER_LIST ? "/n" : "");
        if (m->table != NULL && m->table != &scenario_members)
            check_lines(m->table, at);
        snprintf(at, sizeof at, "%s/%s/n", pointer, m->name);
        if (m->items != NULL)
            check_lines(m->items, at);
    }
}

static int read_readme(void **unused)
{
    FILE *file = fopen(SOURCE_DIR "/api/README.md", "rb");

    (void)unused;
    assert_non_null(file);
    readme[fread(readme, 1, sizeof readme - 1, file)] = '\0';
    fclose(file);
    return 0;
}

static void every_member_of_a_document_is_listed(void **unused)
{
    (void)unused;
    check_lines(&scenario_members, "");
    check_lines(&submission_members, "");
    check_lines(&measurement_members, "");
}

static void every_route_is_listed(void **unused)
{
    size_t n;
    const route *routes = routes_list(&n);

    (void)unused;
    for (size_t k = 0; k < n; k++) {
        char line[400];
        snprintf(line, sizeof line, "| `%s %s` | %s | %s | %s |\n", routes[k].method,
                 routes[k].path, routes[k].query, routes[k].formats, routes[k].summary);
        if (strstr(readme, line) == NULL)
            fail_msg("api/README.md lacks the line\n%s", line);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_member_of_a_document_is_listed),
        cmocka_unit_test(every_route_is_listed),
    };
    return cmocka_run_group_tests(tests, read_readme, NULL);
}
