#include "api/results/compare_json.h"

typedef struct figure {
    const char *key;
    double value;
} figure;

static void write_figures(json_out *w, const figure *figures, size_t n)
{
    for (size_t k = 0; k < n; k++)
        json_out_key_number(w, figures[k].key, figures[k].value);
}

void compare_json_figures(json_out *w, const compare_figures *f)
{
    const figure figures[] = {
        { "t_start_s", f->t_start },
        { "t_end_s", f->t_end },
        { "parts_start", f->parts_start },
        { "parts_end", f->parts_end },
        { "drain_time_s", f->drain_time },
        { "t10_s", f->t10 },
        { "t90_s", f->t90 },
        { "throughput_per_s", f->throughput },
    };
    write_figures(w, figures, sizeof figures / sizeof *figures);
}

void compare_json_measures(json_out *w, const compare_measures *m)
{
    const figure figures[] = {
        { "t_start_s", m->t_start },
        { "t_end_s", m->t_end },
        { "l1", m->l1 },
        { "l2", m->l2 },
        { "largest", m->largest },
        { "largest_at_s", m->largest_at },
        { "drain_time_a_s", m->drain_time_a },
        { "drain_time_b_s", m->drain_time_b },
        { "drain_time_gap_s", m->drain_gap },
        { "rate_a_per_s", m->rate_a },
        { "rate_b_per_s", m->rate_b },
        { "throughput_a_per_s", m->throughput_a },
        { "throughput_b_per_s", m->throughput_b },
        { "throughput_gap_per_s", m->throughput_gap },
    };

    json_out_object(w);
    write_figures(w, figures, sizeof figures / sizeof *figures);
    json_out_object_end(w);
}

void compare_json_distance(json_out *w, const compare_distance *d)
{
    const figure figures[] = {
        { "mean_abs", d->mean_abs },
        { "l1", d->l1 },
        { "emd_x_m", d->emd_x },
        { "emd_y_m", d->emd_y },
    };
    write_figures(w, figures, sizeof figures / sizeof *figures);
}
