// The results of a run so far: scenario, summary, curve, key figures, photo eyes, and all in one archive.

#include "api/http/http_priv.h"
#include "api/results/curve_file.h"
#include "api/results/results.h"
#include "api/results/results_archive.h"

#include <inttypes.h>

bf_status handlers_results_scenario(exchange *x, bf_error *err)
{
    const api_run *of = &x->named->run;

    exchange__cache_immutable(x);
    if (exchange__is_unchanged(x, "%s-scenario", of->id))
        return BF_OK;
    return x->services->read_text(x->services->store, of->id, API_TEXT_SCENARIO, &x->response->body,
                                  err);
}

bf_status handlers_results_summary(exchange *x, bf_error *err)
{
    const api_run *of = &x->named->run;

    if (!of->has_summary)
        return bf_fail(err, BF_ECONFLICT, "",
                       run_state_is_end(of->state) ? "the run is %s and has left no summary"
                                                   : "the run is %s: the summary comes at its end",
                       run_state_word(of->state));
    exchange__cache_revalidate(x);
    if (exchange__is_unchanged(x, "%s-summary", of->id))
        return BF_OK;
    return x->services->read_text(x->services->store, of->id, API_TEXT_SUMMARY, &x->response->body,
                                  err);
}

static bf_status write_curve(exchange *x, const curve_file *file, bf_error *err)
{
    api_curve curve = { 0 };

    BF_TRY(x->services->read_curve(x->services->store, file->id, 0, file->n, &curve, err));
    const bf_status status = x->media->format == MEDIA_CSV
                                 ? results_curve_csv(&curve, &x->response->body, err)
                                 : results_curve_json(&curve, &x->response->body, err);
    api_curve_fini(&curve);
    return status;
}

bf_status handlers_results_curve(exchange *x, bf_error *err)
{
    curve_file file;
    const api_run *of = &x->named->run;

    exchange__cache_revalidate(x);
    if (exchange__is_unchanged(x, "r%" PRIu64 "-%s", of->revision, x->media->word))
        return BF_OK;
    BF_TRY(curve_file_open(x->services, of->id, of->n_samples, &file, err));
    const bool is_long = file.n_values > EXCHANGE_WHOLE_MAX;
    if (is_long && x->media->format == MEDIA_CSV && exchange__accepts_plain(x))
        return curve_file_send(&file, &x->response->source, err);
    BF_TRY(exchange__reserve_whole(x, file.n_values, sizeof(double), "csv", err));
    return write_curve(x, &file, err);
}

bf_status handlers_results_figures(exchange *x, bf_error *err)
{
    bf_buffer text = { 0 };
    const api_run *of = &x->named->run;

    if (of->figures[0] == '\0')
        return bf_fail(err, BF_ECONFLICT, "", "the run is %s and has no key figures",
                       run_state_word(of->state));
    exchange__cache_revalidate(x);
    if (exchange__is_unchanged(x, "r%" PRIu64 "-figures-%s", of->revision, x->media->word))
        return BF_OK;
    bf_status status =
        x->services->read_text(x->services->store, of->id, API_TEXT_FIGURES, &text, err);
    if (status == BF_OK)
        status = x->media->format == MEDIA_CSV
                     ? key_figures_csv(text.bytes, text.n, &x->response->body, err)
                     : buffer_append(&x->response->body, text.bytes, text.n);
    buffer_fini(&text);
    return status;
}

bf_status handlers_results_photo_eyes(exchange *x, bf_error *err)
{
    results_changes changes = { 0 };
    const api_run *of = &x->named->run;

    exchange__cache_revalidate(x);
    if (exchange__is_unchanged(x, "r%" PRIu64 "-eyes-%s", of->revision, x->media->word))
        return BF_OK;
    BF_TRY(results_changes_read(x->services, of->id, &changes, err));
    const bf_status status = x->media->format == MEDIA_CSV
                                 ? results_changes_csv(&changes, &x->response->body, err)
                                 : results_changes_json(&changes, &x->response->body, err);
    results_changes_fini(&changes);
    return status;
}

bf_status handlers_results_archive(exchange *x, bf_error *err)
{
    bool has_vtk = exchange__whole(x, "vtk") == 1;
    const api_run *of = &x->named->run;

    if (!run_state_is_end(of->state))
        return bf_fail(err, BF_ECONFLICT, "", "the run is %s: results.zip comes at its end",
                       run_state_word(of->state));
    exchange__cache_immutable(x);
    if (exchange__is_unchanged(x, "%s-%" PRId64 "-zip%s", of->id, of->finished_ms,
                               has_vtk ? "-vtk" : ""))
        return BF_OK;
    api_response_header(x->response, "Content-Disposition", "attachment; filename=\"%s.zip\"",
                        of->id);
    return results_archive_open(of, has_vtk ? RESULTS_ARCHIVE_VTK : RESULTS_ARCHIVE_PLAIN,
                                x->services, &x->response->source, err);
}
