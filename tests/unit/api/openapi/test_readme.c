// The README of api lists what the tables have: every member of the documents, every route.

#include "api/http/query.h"
#include "api/http/routes.h"
#include "api/json/members.h"
#include "api/results/measurement.h"
#include "api/scenario/scenario_members.h"
#include "api/scenario/submission.h"
#include "api/study/study_document.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

static char readme[100000];

static void describe_kind(const member *m, char *text, size_t size)
{
    size_t n = 0;

    if (m->kind == &member_text)
        snprintf(text, size, "string, at most %zu bytes", m->limit - 1);
    else if (m->limit > 0)
        snprintf(text, size, "%s, %zu to %zu", m->kind->text, m->least, m->limit);
    else if (m->kind->text != NULL)
        snprintf(text, size, "%s", m->kind->text);
    for (size_t k = 0; m->kind->text == NULL && m->words != NULL && m->words[k] != NULL; k++)
        n += (size_t)snprintf(text + n, size - n, "%s%s", k == 0 ? "" : ", ", m->words[k]);
}

static bool is_of_a_form(const member_table *table, const member *m)
{
    for (size_t k = 0; table->choice == MEMBER_ONE_FORM && table->forms[k] != NULL; k++) {
        for (const char *const *name = table->forms[k]; *name != NULL; name++) {
            if (strcmp(*name, m->name) == 0)
                return true;
        }
    }
    return false;
}

// The line of the README for a member.
static void describe(const member_table *table, const member *m, const char *pointer, char *text,
                     size_t size)
{
    char kind[120], range[MEMBER_TEXT_SIZE], standard[MEMBER_TEXT_SIZE];

    describe_kind(m, kind, sizeof kind);
    members_range_text(m->range, range);
    members_default_text(table, m, standard);
    if (!members_has_default(m) && (m->flags & MEMBER_FORM) == 0)
        snprintf(standard, sizeof standard, "%s",
                 is_of_a_form(table, m) ? "one of several" : "must be given");
    snprintf(text, size, "| `%s` | %s | %s | %s | %s | %s |\n", pointer, kind,
             m->unit == NULL ? "" : m->unit, range, standard, m->help);
}

static bool is_list(const member *m)
{
    return m->kind == &member_list || m->kind == &member_array;
}

static void check_lines(const member_table *table, const char *pointer)
{
    for (size_t k = 0; k < table->n; k++) {
        const member *m = &table->members[k];
        char at[BF_POINTER_SIZE];
        char line[1000];
        snprintf(at, sizeof at, "%s/%s", pointer, m->name);
        describe(table, m, at, line, sizeof line);
        if (strstr(readme, line) == NULL)
            fail_msg("api/README.md lacks the line\n%s", line);
        snprintf(at, sizeof at, "%s/%s%s", pointer, m->name, is_list(m) ? "/n" : "");
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
    check_lines(&study_document_members, "");
}

static void every_route_is_listed(void **unused)
{
    size_t n;
    const route *routes = routes_list(&n);

    (void)unused;
    for (size_t k = 0; k < n; k++) {
        char line[400], known[QUERY_KNOWN_SIZE];
        query_list_known(routes[k].params, known);
        snprintf(line, sizeof line, "| `%s %s` | %s | %s | %s |\n", routes[k].method,
                 routes[k].path, known, routes[k].formats, routes[k].summary);
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
