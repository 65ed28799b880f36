// Unit tests of the ids of runs.

#include "server/base/run_id.h"

#include "server/base/clock.h"
#include "tests/unit/helper_cmocka.h"

#include <pthread.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

enum { N_THREADS = 4, N_IDS = 5000 };

static bool is_form(const char *id)
{
    static const char form[] = "xxxxxxxx-xxxx-7xxx-vxxx-xxxxxxxxxxxx";

    if (strlen(id) != sizeof form - 1)
        return false;
    for (size_t i = 0; form[i] != '\0'; i++) {
        const char *allowed = form[i] == 'x'   ? "0123456789abcdef"
                              : form[i] == 'v' ? "89ab"
                              : form[i] == '7' ? "7"
                                               : "-";
        if (strchr(allowed, id[i]) == NULL)
            return false;
    }
    return true;
}

// RFC 9562: version 7 in the 13th digit, variant binary 10 in the 17th, time in the first 48 bits.
static void an_id_is_a_uuid_of_version_7_of_now(void **state)
{
    char id[API_ID_SIZE];
    unsigned long long high = 0, low = 0;

    int64_t before_ms = clock_unix_ms();
    assert_int_equal(run_id_make(id, NULL), BF_OK);
    int64_t after_ms = clock_unix_ms();
    assert_true(is_form(id));
    assert_int_equal(sscanf(id, "%8llx-%4llx", &high, &low), 2);
    int64_t id_ms = (int64_t)(high << 16 | low);
    assert_true(id_ms >= before_ms && id_ms <= after_ms);
}

// Far more than 4096 in a millisecond are asked for at times: the counter runs over, too.
static void ids_rise_strictly(void **state)
{
    char before[API_ID_SIZE], id[API_ID_SIZE];

    assert_int_equal(run_id_make(before, NULL), BF_OK);
    for (int i = 0; i < 50000; i++) {
        assert_int_equal(run_id_make(id, NULL), BF_OK);
        assert_true(is_form(id));
        // All but the random tail: the order must not rest on it.
        assert_true(memcmp(before, id, 18) < 0);
        memcpy(before, id, sizeof id);
    }
}

/// Ids that one thread made.
typedef struct made {
    char ids[N_IDS][API_ID_SIZE];
} made;

static void *make_ids(void *context)
{
    made *m = context;

    for (int i = 0; i < N_IDS; i++)
        if (run_id_make(m->ids[i], NULL) != BF_OK)
            return NULL;
    return m;
}

// Each thread's ids rise, so a merge finds equal ones side by side.
static void threads_never_share_an_id(void **state)
{
    static made all[N_THREADS];
    pthread_t threads[N_THREADS];
    size_t next[N_THREADS] = { 0 };
    const char *before = "";

    for (int i = 0; i < N_THREADS; i++)
        assert_int_equal(pthread_create(&threads[i], NULL, make_ids, &all[i]), 0);
    for (int i = 0; i < N_THREADS; i++) {
        void *result = NULL;
        assert_int_equal(pthread_join(threads[i], &result), 0);
        assert_ptr_equal(result, &all[i]);
    }
    for (size_t n = 0; n < (size_t)N_THREADS * N_IDS; n++) {
        int least = -1;
        for (int i = 0; i < N_THREADS; i++)
            if (next[i] < N_IDS &&
                (least < 0 || strcmp(all[i].ids[next[i]], all[least].ids[next[least]]) < 0))
                least = i;
        assert_true(strcmp(before, all[least].ids[next[least]]) < 0);
        before = all[least].ids[next[least]++];
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(an_id_is_a_uuid_of_version_7_of_now),
        cmocka_unit_test(ids_rise_strictly),
        cmocka_unit_test(threads_never_share_an_id),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
