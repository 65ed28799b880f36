#include "tests/unit/server/helper_await.h"
#include "tests/unit/helper_cmocka.h"

#include <unistd.h>

void helper_wait_more(int64_t until_ms, const char *fact, const char *file, int line)
{
    if (clock_monotonic_ms() >= until_ms) {
        print_error("not in time: %s\n", fact);
        _fail(file, line);
    }
    (void)usleep(5000);
}
