#include "tests/unit/api/helper_appender.h"

#include "core/base/memory.h"
#include "tests/unit/helper_cmocka.h"

#include <stdbool.h>

void appender_survives_no_memory(appender *append)
{
    bf_status status = BF_ENOMEM;

    for (size_t n = 1; status != BF_OK; n++) {
        bf_buffer out = { 0 };
        assert_int_equal(buffer_append(&out, "0123456789", 10), BF_OK);
        memory_plan_fault(n, 0);
        status = append(&out);
        bool has_struck = memory_faults() > 0;
        memory_plan_fault(0, 0);
        assert_int_equal(status, has_struck ? BF_ENOMEM : BF_OK);
        if (status != BF_OK)
            assert_int_equal(out.n, 10);
        assert_memory_equal(out.bytes, "0123456789", 10);
        buffer_fini(&out);
        assert_true(n < 1000);
    }
}
