// All results of a run in one file.

#include "api/http/exchange_priv.h"
#include "api/http/handlers.h"
#include "api/results/results_archive.h"

#include <inttypes.h>

bf_status handlers_archive_show(exchange *x, bf_error *err)
{
    uint64_t has_vtk = 0;
    api_run record;

    bf_status status = exchange__find_run(x, &record, err);
    if (status == BF_OK)
        status = query_number(&x->query, "vtk", 0, 1, &has_vtk, err);
    if (status != BF_OK)
        return status;
    if (!run_state_is_end(record.state))
        return bf_fail(err, BF_ECONFLICT, "", "the run is %s: results.zip comes at its end",
                       run_state_word(record.state));
    exchange__let_keep(x);
    if (exchange__is_unchanged(x, "%s-%" PRId64 "-zip%s", record.id, record.finished_ms,
                               has_vtk ? "-vtk" : ""))
        return BF_OK;
    api_response_header(x->response, "Content-Disposition", "attachment; filename=\"%s.zip\"",
                        record.id);
    return results_archive_open(&record, has_vtk ? RESULTS_ARCHIVE_VTK : RESULTS_ARCHIVE_PLAIN,
                                x->services, &x->response->source, err);
}
