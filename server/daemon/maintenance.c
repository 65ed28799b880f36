#include "server/daemon/maintenance.h"

#include "server/store/backup.h"

#include <stdio.h>
#include <stdlib.h>
#include <sys/stat.h>

enum { EXIT_ARGUMENTS = 2, PATH_SIZE = 1100 };

static int complain(const bf_error *err)
{
    (void)fprintf(stderr, "beltflowd: %s\n", err->text);
    return err->code == BF_EINPUT ? EXIT_ARGUMENTS : EXIT_FAILURE;
}

int maintenance_backup(const char *directory, const char *file)
{
    bf_error err = { 0 };
    struct stat facts;

    if (store_backup(directory, file, &err) != BF_OK)
        return complain(&err);
    if (stat(file, &facts) == 0)
        (void)printf("%s: %lld bytes\n", file, (long long)facts.st_size);
    return EXIT_SUCCESS;
}

static void print_outcome(void *context, const char *name, const char *claim, const char *finding)
{
    (void)context;
    if (finding == NULL)
        (void)printf("ok      %-10s %s\n", name, claim);
    else
        (void)printf("FAILED  %-10s %s: %s\n", name, claim, finding);
    (void)fflush(stdout);
}

int maintenance_verify(const char *directory, const char *file)
{
    char path[PATH_SIZE];
    bool is_sound = false;
    bf_error err = { 0 };

    (void)snprintf(path, sizeof path, "%s%s", file == NULL ? directory : file,
                   file == NULL ? "/beltflow.db" : "");
    if (store_verify(path, print_outcome, NULL, &is_sound, &err) != BF_OK)
        return complain(&err);
    (void)printf("%s is %s\n", path, is_sound ? "sound" : "damaged");
    return is_sound ? EXIT_SUCCESS : EXIT_FAILURE;
}
