// Part of the core's tests under ThreadSanitizer: of their cases only those run whose names speak of threads.

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

__attribute__((constructor)) static void set_filter(void)
{
    cmocka_set_test_filter("*thread*");
}
