// The tables of the documents agree with core, which checks what they describe.

#include "api/json/members.h"

#include "api/scenario/scenario_members.h"
#include "tests/unit/api/helper_document.h"

#include <jansson.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static bf_faults faults;

// With this number in the member's place the document must be refused at the member.
static void check_refused(json_t *root, json_t *object, const char *name, double number,
                          const char *pointer)
{
    bf_error err;

    json_object_set_new(object, name, json_real(number));
    char *text = json_dumps(root, 0);
    document_refuse(text, strlen(text), &faults, &err);
    if (!document_has_fault(&faults, pointer))
        fail_msg("%.17g at %s: fault at \"%s\"", number, pointer, err.pointer);
    free(text);
}

static void check_range(json_t *root, json_t *object, const member *m, const char *pointer)
{
    json_t *value = json_object_get(object, m->name);
    const member_range *range = m->range;

    if (value == NULL || range == NULL || !(json_is_number(value) || m->kind == &member_step))
        return;
    json_incref(value);
    double below = range->excludes_min ? range->minimum : range->minimum - 1.0;
    double above = range->excludes_max ? range->maximum : range->maximum + 1.0;
    if (isfinite(below))
        check_refused(root, object, m->name, below, pointer);
    if (isfinite(above))
        check_refused(root, object, m->name, above, pointer);
    check_refused(root, object, m->name, 1e300, pointer);
    json_object_set_new(object, m->name, value);
}

static void check_ranges(json_t *root, json_t *object, const member_table *table,
                         const char *pointer)
{
    for (size_t k = 0; k < table->n; k++) {
        const member *m = &table->members[k];
        json_t *value = json_object_get(object, m->name);
        char at[BF_POINTER_SIZE];
        snprintf(at, sizeof at, "%s/%s", pointer, m->name);
        check_range(root, object, m, at);
        if (m->table != NULL && json_is_object(value))
            check_ranges(root, value, m->table, at);
        for (size_t i = 0; m->table != NULL && i < json_array_size(value); i++) {
            char item[BF_POINTER_SIZE + 24];
            snprintf(item, sizeof item, "%s/%zu", at, i);
            check_ranges(root, json_array_get(value, i), m->items != NULL ? m->items : m->table,
                         item);
        }
    }
}

static void what_is_out_of_the_tables_ranges_is_refused(void **unused)
{
    static const char *const documents[] = {
        "{'duration_s': 1, 'domain': {'x_m': [0, 1], 'y_m': [0, 1]}, 'cargo': {'shape':"
        "{'type': 'cylinder', 'radius_m': 0.01, 'height_m': 0.01}}, 'initial': {'hexagonal':"
        "{'rows': 2, 'columns': 2, 'first_m': [0.3, 0.3], 'spacing_m': 0.1}}}",
        "{'duration_s': 1, 'domain': {'x_m': [0, 1], 'y_m': [0, 1]}, 'cargo': {},"
        "'initial': {'random': {'count': 2, 'seed': 3, 'region': {'x_m': [0.1, 0.9], 'y_m':"
        "[0.1, 0.9]}}}}",
        "{'duration_s': 1, 'domain': {'x_m': [0, 1], 'y_m': [0, 1]}, 'cargo': [{'share': 2,"
        "'mass_kg': 0.1, 'spin_friction_radius_m': 0.01, 'material': {'young_modulus_pa': 1e9,"
        "'poisson_ratio': 0.3}}, {'shape': {'type': 'box', 'length_m': 0.02, 'width_m': 0.03,"
        "'height_m': 0.01}}], 'cargo_seed': 5, 'initial': {'positions_m': [[0.5, 0.5]]}}",
    };

    (void)unused;
    for (size_t k = 0; k <= sizeof documents / sizeof *documents; k++) {
        bf_buffer document = k == 0 ? document_complete() : document_quote(documents[k - 1]);
        json_t *root = json_loadb(document.bytes, document.n, JSON_DECODE_INT_AS_REAL, NULL);
        check_ranges(root, root, &scenario_members, "");
        json_decref(root);
        buffer_fini(&document);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_is_out_of_the_tables_ranges_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
