// Curves as CSV, made piece by piece.

#include "api/results/curve_file.h"

#include "api/results/results.h"
#include "tests/unit/helper_cmocka.h"

enum { N_COLUMNS = 2 };

static uint64_t n_stored; // samples

static bf_status read_curve(api_store *store, const char *id, uint64_t first, uint64_t n_most,
                            api_curve *ret_curve, bf_error *err)
{
    const uint64_t n_left = first < n_stored ? n_stored - first : 0;
    api_curve curve = { .n = (size_t)(n_left < n_most ? n_left : n_most), .n_columns = N_COLUMNS };

    assert_int_equal(buffer_printf(&curve.columns, "upstream,left_domain"), BF_OK);
    for (uint64_t k = first; k < first + curve.n; k++) {
        const double t = (double)k / 7.0, values[N_COLUMNS] = { -t, 1.0 / (1.0 + t) };
        assert_int_equal(buffer_append(&curve.t, &t, sizeof t), BF_OK);
        assert_int_equal(buffer_append(&curve.values, values, sizeof values), BF_OK);
    }
    *ret_curve = curve;
    return BF_OK;
}

static const api_services services = { .read_curve = read_curve };

static void a_file_has_the_bytes_of_the_whole_curve(void **state)
{
    static const uint64_t lengths[] = { 0, 1, 1365, 1366, 5000 }; // 4096 numbers are 1365 samples

    for (size_t i = 0; i < sizeof lengths / sizeof *lengths; i++) {
        bf_buffer whole = { 0 }, pieces = { 0 };
        api_curve curve = { 0 };
        curve_file file;
        n_stored = lengths[i];
        assert_int_equal(read_curve(NULL, "", 0, UINT64_MAX, &curve, NULL), BF_OK);
        assert_int_equal(results_curve_csv(&curve, &whole, NULL), BF_OK);
        assert_int_equal(curve_file_open(&services, "", n_stored, &file, NULL), BF_OK);
        assert_int_equal(file.n_values, n_stored * (N_COLUMNS + 1));
        while (!curve_file_is_over(&file)) {
            const size_t n_before = pieces.n;
            assert_int_equal(curve_file_read(&file, &services, &pieces, NULL), BF_OK);
            assert_true(pieces.n - n_before < 4096 * 26); // digits and separator of a double
        }
        assert_int_equal(pieces.n, whole.n);
        assert_memory_equal(pieces.bytes, whole.bytes, whole.n);
        api_curve_fini(&curve);
        buffer_fini(&whole);
        buffer_fini(&pieces);
    }
}

static void samples_that_are_gone_are_told(void **state)
{
    bf_buffer out = { 0 };
    curve_file file;

    n_stored = 2000;
    assert_int_equal(curve_file_open(&services, "", n_stored, &file, NULL), BF_OK);
    assert_int_equal(curve_file_read(&file, &services, &out, NULL), BF_OK);
    n_stored = 1000;
    assert_int_equal(curve_file_read(&file, &services, &out, NULL), BF_ENOTFOUND);
    buffer_fini(&out);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_file_has_the_bytes_of_the_whole_curve),
        cmocka_unit_test(samples_that_are_gone_are_told),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
