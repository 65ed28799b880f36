#include "server/base/metrics.h"

#include <dirent.h>
#include <inttypes.h>
#include <stdio.h>
#include <sys/resource.h>
#include <time.h>
#include <unistd.h>

enum { NS_PER_S = 1000000000 };

static void read_memory(void)
{
    FILE *file = fopen("/proc/self/statm", "re");
    int64_t n_virtual = 0, n_resident = 0, page = sysconf(_SC_PAGESIZE);

    if (file == NULL)
        return;
    if (fscanf(file, "%" SCNd64 " %" SCNd64, &n_virtual, &n_resident) == 2) {
        metrics_set(METRICS_PROCESS_VIRTUAL, 0, n_virtual * page);
        metrics_set(METRICS_PROCESS_RESIDENT, 0, n_resident * page);
    }
    (void)fclose(file);
}

static void read_files(void)
{
    DIR *folder = opendir("/proc/self/fd");
    struct rlimit limit;
    int64_t n = -1; // without the folder's own

    if (folder == NULL)
        return;
    for (const struct dirent *d = readdir(folder); d != NULL; d = readdir(folder))
        n += d->d_name[0] != '.';
    (void)closedir(folder);
    metrics_set(METRICS_PROCESS_FDS, 0, n);
    if (getrlimit(RLIMIT_NOFILE, &limit) == 0)
        metrics_set(METRICS_PROCESS_FDS_MAX, 0, (int64_t)limit.rlim_cur);
}

void metrics_read_process(void)
{
    struct timespec spent;

    if (clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &spent) == 0)
        metrics_set(METRICS_PROCESS_TIME, 0, (int64_t)spent.tv_sec * NS_PER_S + spent.tv_nsec);
    read_memory();
    read_files();
}
