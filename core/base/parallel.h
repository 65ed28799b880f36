/// Loops over several threads (OpenMP; one thread where it is not compiled in).

#pragma once

#include <stddef.h>

/// The work of one item of a parallel loop; items may run at the same time and in any order.
typedef void parallel_body(void *context, size_t item);

/// Call body(context, item) for item = 0 .. n_items - 1 on up to n_threads threads and return when
/// all are done. The caller gives each item its own outputs, so that results never depend on how
/// many threads there are.
void parallel_for(int n_threads, size_t n_items, parallel_body *body, void *context);

/// How many processors this process may use, at least 1.
int parallel_processors(void);
