// In place of libFuzzer in ordinary builds: gives a target the files of the folders and the files that its arguments
// name, one after the other.

#include "tests/fuzz/fuzz.h"

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/stat.h>

static void replay_file(const char *path)
{
    struct stat about;
    FILE *file = fopen(path, "re");

    fuzz_require(file != NULL && fstat(fileno(file), &about) == 0, path);
    const size_t n = (size_t)about.st_size;
    // malloc: of the exact size, so that AddressSanitizer finds reads beyond it.
    uint8_t *bytes = malloc(n > 0 ? n : 1);
    fuzz_require(bytes != NULL && fread(bytes, 1, n, file) == n, path);
    (void)fclose(file);
    printf("%s\n", path);
    (void)fflush(stdout);
    (void)LLVMFuzzerTestOneInput(bytes, n);
    free(bytes);
}

static size_t replay_folder(const char *path)
{
    struct dirent **entries;
    const int n = scandir(path, &entries, NULL, alphasort);
    size_t n_replayed = 0;

    fuzz_require(n >= 0, path);
    for (int k = 0; k < n; k++) {
        char name[4096];
        (void)snprintf(name, sizeof name, "%s/%s", path, entries[k]->d_name);
        if (entries[k]->d_name[0] != '.') {
            replay_file(name);
            n_replayed++;
        }
        free(entries[k]);
    }
    free(entries);
    return n_replayed;
}

int main(int argc, char **argv)
{
    size_t n_replayed = 0;

    for (int k = 1; k < argc; k++) {
        struct stat about;
        fuzz_require(stat(argv[k], &about) == 0, argv[k]);
        if (S_ISDIR(about.st_mode)) {
            n_replayed += replay_folder(argv[k]);
        } else {
            replay_file(argv[k]);
            n_replayed++;
        }
    }
    printf("%zu inputs\n", n_replayed);
    return n_replayed > 0 ? 0 : 1;
}
