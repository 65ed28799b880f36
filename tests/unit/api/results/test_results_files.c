// Names of the files of a run.

#include "api/results/results_files.h"
#include "tests/unit/helper_cmocka.h"

#include <string.h>

static void assert_name(results_files file, uint64_t index, const char *expected)
{
    char name[RESULTS_FILES_NAME_SIZE];
    const char *base = results_files_name(file, index, name);
    const char *slash = strrchr(name, '/');

    assert_string_equal(name, expected);
    assert_ptr_equal(base, slash == NULL ? name : slash + 1);
}

static void names_are_those_of_the_contract(void **unused)
{
    assert_name(RESULTS_FILES_SUMMARY, 0, "summary.json");
    assert_name(RESULTS_FILES_SCENARIO, 0, "scenario.json");
    assert_name(RESULTS_FILES_CURVE, 0, "curve.csv");
    assert_name(RESULTS_FILES_SNAPSHOTS, 0, "snapshots.json");
    assert_name(RESULTS_FILES_SNAPSHOT, 0, "snapshots/000000.npy");
    assert_name(RESULTS_FILES_PARTS, 123, "parts/000123.npy");
    assert_name(RESULTS_FILES_SNAPSHOT_VTK, 999999, "snapshots/999999.vti");
    assert_name(RESULTS_FILES_PARTS_VTK, 1000000, "parts/1000000.vtp");
    assert_name(RESULTS_FILES_SNAPSHOTS_SERIES, 0, "snapshots.pvd");
    assert_name(RESULTS_FILES_PARTS_SERIES, 0, "parts.pvd");
}

static void the_largest_index_fits(void **unused)
{
    assert_name(RESULTS_FILES_SNAPSHOT, UINT64_MAX, "snapshots/18446744073709551615.npy");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(names_are_those_of_the_contract),
        cmocka_unit_test(the_largest_index_fits),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
