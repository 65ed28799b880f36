#include "server/cli/progress_bar.h"

#include "server/base/clock.h"

#include <stdio.h>
#include <unistd.h>

enum { CELLS = 30 };

progress_bar progress_bar_start(void)
{
    return (progress_bar){ .is_shown = isatty(STDERR_FILENO) == 1, .start_s = clock_monotonic_s() };
}

void progress_bar_text(const frame_progress *p, uint64_t first_step, double elapsed_s,
                       char *ret_text)
{
    double fraction = p->n_steps == 0 ? 1.0 : (double)p->step / (double)p->n_steps;
    double rate = elapsed_s > 0.0 ? (double)(p->step - first_step) / elapsed_s : 0.0;
    char cells[CELLS + 1];

    for (int i = 0; i < CELLS; i++)
        cells[i] = i < (int)(fraction * CELLS) ? '#' : '.';
    cells[CELLS] = '\0';
    int n = snprintf(ret_text, PROGRESS_BAR_SIZE, "[%s] %3.0f %%  t = %.3g s", cells,
                     100.0 * fraction, p->t);
    if (rate > 0.0)
        snprintf(ret_text + n, (size_t)(PROGRESS_BAR_SIZE - n), "  %.3g steps/s  %.0f s left", rate,
                 (double)(p->n_steps - p->step) / rate);
}

void progress_bar_show(progress_bar *bar, const frame_progress *p)
{
    char text[PROGRESS_BAR_SIZE];

    if (!bar->is_shown)
        return;
    if (!bar->has_begun)
        bar->step = p->step;
    bar->has_begun = true;
    progress_bar_text(p, bar->step, clock_monotonic_s() - bar->start_s, text);
    fprintf(stderr, "\r%s\x1b[K", text);
    fflush(stderr);
}

void progress_bar_end(progress_bar *bar)
{
    if (bar->is_shown && bar->has_begun)
        fputs("\r\x1b[K", stderr);
}
