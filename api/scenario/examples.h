/// The ready scenarios: the files of api/examples, compiled in.

#pragma once

#include "api/json/members.h"
#include "core/base/buffer.h"

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

/// The list of them as JSON, and an item of it.
extern const member_table examples_members;
extern const member_table examples_item_members;

/// Append the list: {"examples": [{"name", "title", "url"}]}; the title is the name of the scenario.
BF_MUST_CHECK bf_status examples_write(bf_buffer *out, bf_error *err);
