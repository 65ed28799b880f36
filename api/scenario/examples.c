#include "api/scenario/examples.h"

#include "api/scenario/scenario_priv.h"

#include <string.h>

const example *examples_list(size_t *ret_n)
{
    size_t n = 0;

    while (examples__list[n].name != NULL)
        n++;
    *ret_n = n;
    return examples__list;
}

const example *examples_find(const char *name)
{
    for (const example *at = examples__list; at->name != NULL; at++) {
        if (strcmp(at->name, name) == 0)
            return at;
    }
    return NULL;
}
