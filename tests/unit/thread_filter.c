// Part of the core's tests under ThreadSanitizer: of their cases only those run whose names speak of threads.

#include "tests/unit/helper_cmocka.h"

__attribute__((constructor)) static void set_filter(void)
{
    cmocka_set_test_filter("*thread*");
}
