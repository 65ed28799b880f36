// The studies of the daemon in arrays.

#include "tests/unit/api/helper_services.h"

#include "api/study/study_json.h"
#include "tests/unit/helper_cmocka.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static helper_study *lookup(helper_daemon *d, const char *id)
{
    for (size_t i = 0; i < d->n_studies; i++) {
        if (strcmp(d->studies[i].about.id, id) == 0)
            return &d->studies[i];
    }
    return NULL;
}

static bf_status no_study(bf_error *err)
{
    return bf_fail(err, BF_ENOTFOUND, "", "there is no such study");
}

static bf_status do_submit_study(api_service *service, const api_study_submission *submission,
                                 api_acceptance *ret_acceptance, bf_error *err)
{
    helper_daemon *d = (void *)service;

    if (d->refusal != BF_OK)
        return bf_fail(err, d->refusal, "", "there are 1000 studies");
    helper_study *item = helper_add_study(d, API_STUDY_QUEUED);
    api_acceptance accepted = { .revision = item->about.revision, .is_replay = d->is_replay };
    item->about.method = submission->method;
    item->about.priority = submission->priority;
    item->about.trials_max = submission->trials_max;
    memcpy(item->about.name, submission->name, sizeof item->about.name);
    memcpy(accepted.id, item->about.id, sizeof accepted.id);
    snprintf(d->document, sizeof d->document, "%s", submission->document.bytes);
    snprintf(d->columns, sizeof d->columns, "%s", submission->columns.bytes);
    const bf_status status = study_json_write(&item->about, &accepted.answer, err);
    assert_int_equal(status, BF_OK);
    *ret_acceptance = accepted;
    return BF_OK;
}

static bf_status do_find_study(api_store *store, const char *id, api_study *ret_study,
                               bf_error *err)
{
    const helper_study *item = lookup((void *)store, id);

    if (item == NULL)
        return no_study(err);
    *ret_study = item->about;
    return BF_OK;
}

static bf_status do_list_studies(api_store *store, const api_page_query *query, api_page *ret_page,
                                 bf_error *err)
{
    const helper_daemon *d = (void *)store;

    ret_page->n = 0;
    ret_page->has_more = false;
    for (size_t i = d->n_studies; i-- > 0 && !ret_page->has_more;) {
        const api_study *about = &d->studies[i].about;
        const bool fits = about->id[0] != '\0' &&
                          (query->state < 0 || (int)about->state == query->state) &&
                          (query->before[0] == '\0' || strcmp(about->id, query->before) < 0);
        if (fits && ret_page->n == query->limit)
            ret_page->has_more = true;
        else if (fits)
            ret_page->studies[ret_page->n++] = *about;
    }
    return BF_OK;
}

// Another client is faster, if the test wants that.
static bf_status check_revision(helper_daemon *d, helper_study *item, uint64_t expected,
                                bf_error *err)
{
    if (d->n_changes_between > 0) {
        d->n_changes_between--;
        item->about.revision++;
    }
    if (expected == API_ANY_REVISION || expected == item->about.revision)
        return BF_OK;
    return bf_fail(err, BF_EINPUT, "", "the study has another revision");
}

static bf_status do_change_study(api_service *service, const char *id, uint64_t revision,
                                 api_study_change change, api_study *ret_study, bf_error *err)
{
    static const api_study_state to[] = { [API_STUDY_PAUSE] = API_STUDY_PAUSED,
                                          [API_STUDY_RESUME] = API_STUDY_QUEUED,
                                          [API_STUDY_CANCEL] = API_STUDY_CANCELLED };
    helper_study *item = lookup((void *)service, id);

    if (item == NULL)
        return no_study(err);
    bf_status status = check_revision((void *)service, item, revision, err);
    if (status != BF_OK)
        return status;
    if (api_study_state_is_end(item->about.state) || item->about.state == to[change])
        return bf_fail(err, BF_ECONFLICT, "", "the study is %s",
                       api_study_state_word(item->about.state));
    // One that is running ends soon after.
    if (item->about.state != API_STUDY_RUNNING)
        item->about.state = to[change];
    item->about.revision++;
    *ret_study = item->about;
    return BF_OK;
}

static bf_status do_annotate_study(api_store *store, const char *id, uint64_t revision,
                                   const api_annotations *annotations, api_study *ret_study,
                                   bf_error *err)
{
    helper_study *item = lookup((void *)store, id);

    if (item == NULL)
        return no_study(err);
    bf_status status = check_revision((void *)store, item, revision, err);
    if (status != BF_OK)
        return status;
    snprintf(item->about.name, sizeof item->about.name, "%.100s", annotations->name);
    memcpy(item->about.line, annotations->line, sizeof item->about.line);
    item->about.revision++;
    *ret_study = item->about;
    return BF_OK;
}

static bf_status do_remove_study(api_service *service, const char *id, uint64_t revision,
                                 bf_error *err)
{
    helper_study *item = lookup((void *)service, id);

    if (item == NULL)
        return no_study(err);
    bf_status status = check_revision((void *)service, item, revision, err);
    if (status == BF_OK)
        item->about.id[0] = '\0';
    return status;
}

static bf_status do_read_study(api_store *store, const char *id, api_study_text which,
                               bf_buffer *out, bf_error *err)
{
    const helper_study *item = lookup((void *)store, id);

    if (item == NULL)
        return no_study(err);
    const char *const texts[] = { [API_STUDY_DOCUMENT] = "{\"name\":\"\"}",
                                  [API_STUDY_COLUMNS] =
                                      "{\"parameters\":[\"/p\"],\"values\":[\"v\"]}",
                                  [API_STUDY_BEST] = item->best };
    if (texts[which] == NULL)
        return bf_fail(err, BF_ECONFLICT, "", "there is nothing best yet");
    return buffer_append(out, texts[which], strlen(texts[which]));
}

static bf_status do_read_trials(api_store *store, const char *id, const api_trial_query *query,
                                api_trial_fn *on_trial, void *context, bf_error *err)
{
    const helper_study *item = lookup((void *)store, id);
    bf_status status = BF_OK;
    size_t n = 0;

    if (item == NULL)
        return no_study(err);
    assert_true(query->limit >= 1 && query->limit <= API_TRIALS_PAGE_MAX);
    for (uint64_t at = query->from; n < query->limit && status == BF_OK; at++, n++) {
        size_t k = (size_t)at;
        if (query->order == API_TRIALS_BY_END)
            for (k = 0; k < item->about.n_trials && item->trials[k].ended != at; k++)
                continue;
        if (k >= item->about.n_trials)
            break;
        status = on_trial(context, &item->trials[k], err);
    }
    return status;
}

void helper_serve_studies(api_services *services)
{
    services->submit_study = do_submit_study;
    services->find_study = do_find_study;
    services->list_studies = do_list_studies;
    services->change_study = do_change_study;
    services->annotate_study = do_annotate_study;
    services->remove_study = do_remove_study;
    services->read_study = do_read_study;
    services->read_trials = do_read_trials;
}

helper_study *helper_add_study(helper_daemon *d, api_study_state state)
{
    assert_true(d->n_studies < HELPER_STUDIES_MAX);
    helper_study *item = &d->studies[d->n_studies++];

    *item = (helper_study){ .about = { .state = state,
                                       .revision = 1,
                                       .created_ms = 1769860800000 + 1000 * (int64_t)d->n_studies,
                                       .trials_max = 500 } };
    snprintf(item->about.id, sizeof item->about.id, "0190a0b0-0000-7000-a000-%012zx", d->n_studies);
    return item;
}

api_trial *helper_add_trial(helper_study *of, api_trial_state state)
{
    assert_true(of->about.n_trials < HELPER_TRIALS_MAX);
    const uint64_t number = of->about.n_trials++;
    api_trial *trial = &of->trials[number];

    *trial = (api_trial){ .number = number,
                          .point = number,
                          .state = state,
                          .n_parameters = 1,
                          .parameters = { 10.0 * (double)number },
                          .n_values = 1,
                          .values = { (double)NAN } };
    if (api_trial_state_is_end(state)) {
        of->about.n_ended[state]++;
        trial->ended = api_study_ended(&of->about);
        trial->values[0] = 0.5;
    }
    of->about.revision++;
    return trial;
}
