/// One line on a terminal's stderr that shows how far a run is; silent where stderr is none.

#pragma once

#include "core/observe/frame.h"

#include <stdbool.h>

/// A bar. Begin with progress_bar_start().
typedef struct progress_bar {
    bool is_shown;  ///< stderr is a terminal
    double start_s; ///< when it began, clock_monotonic_s()
    uint64_t step;  ///< at the start
    bool has_begun; ///< step is known
} progress_bar;

enum { PROGRESS_BAR_SIZE = 120 }; ///< bytes of its text with the terminator

/// A bar that is not drawn yet.
progress_bar progress_bar_start(void);

/// Draw it.
void progress_bar_show(progress_bar *bar, const frame_progress *p);

/// Take it off the screen.
void progress_bar_end(progress_bar *bar);

/// The text of a bar after elapsed_s seconds for steps - first_step steps (PROGRESS_BAR_SIZE bytes).
void progress_bar_text(const frame_progress *p, uint64_t first_step, double elapsed_s,
                       char *ret_text);
