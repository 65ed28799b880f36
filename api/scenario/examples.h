/// The ready scenarios: the files of api/examples, compiled in.

#pragma once

#include <stddef.h>

/// One ready scenario.
typedef struct example {
    const char *name;     ///< in addresses and on the command line: the file's name without .json
    const char *document; ///< the scenario as JSON, n bytes and a terminating zero
    size_t n;             ///< bytes of the document
} example;

/// All of them, by rising name. Static: never freed. *ret_n is how many there are.
const example *examples_list(size_t *ret_n);

/// The example of a name, or NULL if there is none.
const example *examples_find(const char *name);
