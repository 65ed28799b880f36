// The program of a folder of tests: its argument names the file, e.g. test_polygon, whose tests run. Each file is a group
// with a process of its own, so that groups share no state.

#include <stdio.h>
#include <string.h>

// GROUP(file) for each file of the folder: CMake writes the list of GROUPS.
#define GROUP(file) int group_##file(void);
#include GROUPS
#undef GROUP

static const struct {
    const char *name;
    int (*run)(void);
} groups[] = {
#define GROUP(file) { #file, group_##file },
#include GROUPS
#undef GROUP
};

int main(int argc, char **argv)
{
    const size_t n_groups = sizeof groups / sizeof groups[0];

    for (size_t k = 0; argc == 2 && k < n_groups; k++) {
        if (strcmp(argv[1], groups[k].name) == 0)
            return groups[k].run();
    }
    fprintf(stderr, "usage: %s GROUP\ngroups:\n", argv[0]);
    for (size_t k = 0; k < n_groups; k++)
        fprintf(stderr, "    %s\n", groups[k].name);
    return 2;
}
