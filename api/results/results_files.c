#include "api/results/results_files.h"

#include "core/base/check.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

static const struct {
    const char *folder;
    const char *stem;
    const char *ending;
} table[] = {
#define X(file, folder, stem, ending) [file] = { folder, stem, ending },
    RESULTS_FILES_LIST(X)
#undef X
};

const char *results_files_name(results_files file, uint64_t index, char *ret_name)
{
    BF_CHECK(file < RESULTS_FILES_COUNT);
    size_t n_folder = strlen(table[file].folder);
    char *base = ret_name + n_folder;
    size_t size = RESULTS_FILES_NAME_SIZE - n_folder;

    memcpy(ret_name, table[file].folder, n_folder);
    if (table[file].stem[0] != '\0')
        snprintf(base, size, "%s.%s", table[file].stem, table[file].ending);
    else
        snprintf(base, size, "%06" PRIu64 ".%s", index, table[file].ending);
    return base;
}
