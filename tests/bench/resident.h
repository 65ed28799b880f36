/// Memory of the calling process that is resident, as /proc has it.

#pragma once

#include <stdio.h>
#include <string.h>

/// What the line of /proc/self/status with this name says, bytes; 0 if it is not there.
static inline double resident_read(const char *name)
{
    FILE *file = fopen("/proc/self/status", "r");
    char line[256];
    long kb = 0;

    while (file != NULL && fgets(line, sizeof line, file) != NULL)
        if (strncmp(line, name, strlen(name)) == 0 &&
            sscanf(line + strlen(name), ": %ld", &kb) == 1)
            break;
    if (file != NULL)
        fclose(file);
    return 1024.0 * (double)kb;
}

/// Now, bytes.
static inline double resident_bytes(void)
{
    return resident_read("VmRSS");
}

/// The most so far, bytes.
static inline double resident_peak_bytes(void)
{
    return resident_read("VmHWM");
}
