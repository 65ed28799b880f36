#include "server/store/lines.h"

#include "server/store/texts.h"

#include "api/scenario/submission.h"

#include <sodium.h>

static bool has_version(const api_run *record)
{
    return record->line[0] != '\0' && record->study[0] == '\0';
}

bf_status store__number_version(store__connection *writer, store__row *row,
                                const bf_buffer *identity, bf_error *err)
{
    unsigned char digest[STORE__DIGEST_SIZE];
    api_run *record = &row->run;
    int64_t version = 0;

    row->line_scenario[0] = '\0';
    record->line_version = 0;
    if (!has_version(record))
        return BF_OK;
    (void)crypto_hash_sha256(digest, (const unsigned char *)identity->bytes, identity->n);
    (void)sodium_bin2hex(row->line_scenario, sizeof row->line_scenario, digest, sizeof digest);
    const bf_status status =
        store__find_number(writer, STORE__SQL_LINE_VERSION, &version, err, TEXT(record->owner),
                           TEXT(record->line), TEXT(row->line_scenario));
    record->line_version = (uint64_t)version;
    return status;
}

bf_status store__renumber_version(store__connection *writer, store__row *row, bf_error *err)
{
    bf_buffer scenario = { 0 }, identity = { 0 };
    bf_status status = BF_OK;

    if (has_version(&row->run))
        status = store__get_run_text(writer, row, STORE__TEXT_SCENARIO, &scenario, err);
    if (status == BF_OK && has_version(&row->run))
        status = submission_identity(scenario.bytes, scenario.n, &identity, err);
    if (status == BF_OK)
        status = store__number_version(writer, row, &identity, err);
    buffer_fini(&identity);
    buffer_fini(&scenario);
    return status;
}

// As STORE__LINES selects them.
static const store__column columns[] = {
    COLUMN(TEXT, api_line, owner),         COLUMN(TEXT, api_line, line),
    COLUMN(INTEGER, api_line, n_versions), COLUMN(INTEGER, api_line, n_runs),
    COLUMN(INTEGER, api_line, n_studies),  COLUMN(TEXT, api_line, newest_run),
    COLUMN(TEXT, api_line, newest),        COLUMN(INTEGER, api_line, used_ms),
};
static const store__record line_record = RECORD(columns, api_line, NULL);

bf_status store_list_lines(store *s, const api_page_query *query, api_page *ret_page, bf_error *err)
{
    static const store__listing lines = { "lines", &line_record, 0, sizeof(api_line), 3 };

    return store__list_page(&s->pool, STORE__SQL_LIST_LINES, &lines, query, ret_page, err);
}
