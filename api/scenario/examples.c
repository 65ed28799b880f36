#include "api/scenario/examples.h"

#include "api/scenario/examples_priv.h"

#include <string.h>

const example *examples_list(size_t *ret_n)
{
    *ret_n = examples__n;
    return examples__list;
}

const example *examples_find(const char *name)
{
    for (size_t k = 0; k < examples__n; k++) {
        if (strcmp(examples__list[k].name, name) == 0)
            return &examples__list[k];
    }
    return NULL;
}
