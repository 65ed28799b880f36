// The daemon's settings file. What is accepted is printed as a file that gives the same settings.

#include "tests/fuzz/fuzz.h"

#include "server/daemon/config.h"

#include <stdio.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

static bf_status read_settings(const void *bytes, size_t n, config *c)
{
    char path[64];
    bf_error err;
    const int fd = memfd_create("settings", MFD_CLOEXEC);

    fuzz_require(fd >= 0 && write(fd, bytes, n) == (ssize_t)n, "a file in memory");
    (void)snprintf(path, sizeof path, "/proc/self/fd/%d", fd);
    config_init(c);
    const bf_status status = config_read_file(c, path, &err);
    (void)close(fd);
    return status;
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t n)
{
    static config settings, again;
    bf_buffer printed = { 0 }, twice = { 0 };
    bf_error err;

    if (read_settings(bytes, n, &settings) != BF_OK)
        return 0;
    fuzz_require(config_print(&settings, &printed, &err) == BF_OK, "settings are printed");
    fuzz_require(read_settings(printed.bytes, printed.n, &again) == BF_OK, "and read back");
    memcpy(again.origins, settings.origins, sizeof again.origins);
    fuzz_require(config_print(&again, &twice, &err) == BF_OK, "and printed again");
    fuzz_require(twice.n == printed.n && memcmp(twice.bytes, printed.bytes, twice.n) == 0,
                 "as the same");
    buffer_fini(&printed);
    buffer_fini(&twice);
    return 0;
}
