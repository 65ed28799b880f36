#include "api/results/lease_client.h"

#include "core/base/memory.h"

#include <endian.h>
#include <jansson.h>
#include <math.h>
#include <string.h>

enum { FRAME_ALIGNMENT = 8 }; // core/run/frame.h

#define WORD(name, word) word,
static const char *const cause_words[] = { API_JOB_CAUSE_LIST(WORD) };
static const char *const stop_words[] = { API_JOB_STOP_LIST(WORD) };
#undef WORD

// ---- documents

// Append the document and free it; NULL: there was no memory to make it.
static bf_status write_document(json_t *root, bf_buffer *out, bf_error *err)
{
    char *text = root == NULL ? NULL : json_dumps(root, JSON_COMPACT);
    bf_status status = text == NULL ? BF_ENOMEM : buffer_append(out, text, strlen(text));

    free(text);
    json_decref(root);
    return status == BF_OK ? BF_OK : bf_fail(err, status, "", "no memory for a document");
}

bf_status lease_client_write_worker(const api_worker *worker, bf_buffer *out, bf_error *err)
{
    json_t *root =
        json_pack("{ss ss sI sI}", "worker", worker->name, "solver", worker->solver, "cores",
                  (json_int_t)worker->cores, "memory_bytes", (json_int_t)worker->memory_bytes);

    return write_document(root, out, err);
}

static json_t *make_report(const api_job_report *report)
{
    return json_pack("{sI ss sI sf}", "job", (json_int_t)report->job, "run", report->run, "attempt",
                     (json_int_t)report->attempt, "cpu_s", report->cpu_s);
}

static json_t *make_error(const bf_error *error)
{
    return error->code == BF_OK
               ? json_null()
               : json_pack("{ss ss}", "code", bf_status_word(error->code), "text", error->text);
}

static json_t *make_end(const api_job_end *end)
{
    json_t *root = make_report(&end->report);
    const char *digest = end->digest[0] == '\0' ? NULL : end->digest;
    json_t *more =
        json_pack("{ss so sI ss?}", "cause", cause_words[end->cause], "error",
                  make_error(&end->error), "bytes", (json_int_t)end->n_bytes, "digest", digest);

    if (root == NULL || more == NULL || json_object_update(root, more) != 0) {
        json_decref(root);
        root = NULL;
    }
    json_decref(more);
    return root;
}

bf_status lease_client_write_renewal(const api_renewal *renewal, bf_buffer *out, bf_error *err)
{
    json_t *jobs = json_array();
    json_t *ended = json_array();
    bool ok = true;

    for (size_t k = 0; k < renewal->n_jobs; k++)
        ok = json_array_append_new(jobs, make_report(&renewal->jobs[k])) == 0 && ok;
    for (size_t k = 0; k < renewal->n_ended; k++)
        ok = json_array_append_new(ended, make_end(&renewal->ended[k])) == 0 && ok;
    json_t *root = json_pack("{ss ss so so}", "worker", renewal->worker, "solver", renewal->solver,
                             "jobs", jobs, "ended", ended);
    if (!ok) {
        json_decref(root);
        root = NULL;
    }
    return write_document(root, out, err);
}

bf_status lease_client_write_section(const api_lease_section *section, bf_buffer *out,
                                     bf_error *err)
{
    const uint32_t job = htole32(section->job), n = htole32((uint32_t)section->n);
    const uint64_t offset = htole64(section->offset);
    const size_t before = out->n;

    if (buffer_append(out, &job, sizeof job) == BF_OK &&
        buffer_append(out, &n, sizeof n) == BF_OK &&
        buffer_append(out, &offset, sizeof offset) == BF_OK &&
        buffer_append(out, section->bytes, section->n) == BF_OK)
        return BF_OK;
    buffer_truncate(out, before);
    return bf_fail(err, BF_ENOMEM, "", "no memory for frames");
}

// ---- answers

static bf_status fail_answer(bf_error *err, const char *what)
{
    return bf_fail(err, BF_ECORRUPT, "", "the service's answer is not what was expected: %s", what);
}

static bf_status parse(const char *json, size_t n, json_t **ret_root, bf_error *err)
{
    json_error_t why;

    *ret_root = json_loadb(json, n, JSON_REJECT_DUPLICATES, &why);
    return *ret_root == NULL ? fail_answer(err, why.text) : BF_OK;
}

// Copy a text that fits with its terminator.
static bool copy_text(const char *text, size_t size, char *ret_text)
{
    const size_t n = strlen(text);

    if (n == 0 || n >= size)
        return false;
    memcpy(ret_text, text, n + 1);
    return true;
}

static bool find_word(const char *word, const char *const *words, int n, int *ret_k)
{
    for (int k = 0; k < n; k++) {
        if (strcmp(word, words[k]) != 0)
            continue;
        *ret_k = k;
        return true;
    }
    return false;
}

static bool read_job(const json_t *value, size_t place, api_lease_job *ret_job, json_error_t *why)
{
    const char *id = "", *model_word = "";
    json_int_t job = 0, attempt = 0, threads = 0, checkpoint = 0, memory = 0, cpu = 0, step = 0,
               bytes = 0;
    json_t *predicted = NULL;
    int model = 0, is_trial = 0;

    if (json_unpack_ex((json_t *)value, why, 0, "{sI ss sI ss sI sb sI sI sI sI so sI}", "job",
                       &job, "run", &id, "attempt", &attempt, "model", &model_word, "threads",
                       &threads, "trial", &is_trial, "checkpoint_ms", &checkpoint, "memory_bytes",
                       &memory, "cpu_s", &cpu, "step", &step, "predicted_s", &predicted, "bytes",
                       &bytes) != 0)
        return false;
    *ret_job = (api_lease_job){
        .job = (uint32_t)place,
        .attempt = (uint64_t)attempt,
        .n_threads = (uint32_t)threads,
        .is_trial = is_trial != 0,
        .checkpoint_ms = (uint64_t)checkpoint,
        .memory_bytes = (uint64_t)memory,
        .cpu_s = (uint64_t)cpu,
        .step = (uint64_t)step,
        .predicted_s = json_is_number(predicted) ? json_number_value(predicted) : NAN,
        .n_bytes = (uint64_t)bytes,
    };
    snprintf(why->text, sizeof why->text, "a job has values beyond their limits");
    if (!copy_text(id, sizeof ret_job->run, ret_job->run) ||
        !find_word(model_word, run_model_words, RUN_MODEL_COUNT, &model))
        return false;
    ret_job->model = (run_model)model;
    return job == (json_int_t)place && attempt >= 0 && threads >= 1 && threads <= INT16_MAX &&
           checkpoint >= 0 && memory >= 0 && cpu >= 0 && step >= 0 && bytes >= 0 &&
           bytes % FRAME_ALIGNMENT == 0;
}

static bf_status read_jobs(const json_t *list, api_lease *lease, bf_error *err)
{
    const size_t n = json_array_size(list);
    json_error_t why;

    if (n > API_LEASE_JOBS_MAX)
        return fail_answer(err, "too many jobs");
    lease->jobs = memory_alloc(n, sizeof *lease->jobs);
    if (lease->jobs == NULL)
        return bf_fail(err, BF_ENOMEM, "", "no memory for a lease");
    for (; lease->n_jobs < n; lease->n_jobs++)
        if (!read_job(json_array_get(list, lease->n_jobs), lease->n_jobs,
                      &lease->jobs[lease->n_jobs], &why))
            return fail_answer(err, why.text);
    return BF_OK;
}

// It becomes a part of paths.
static bool is_lease_id(const char *text)
{
    return text[strspn(text, "0123456789abcdef-")] == '\0';
}

static bf_status read_lease(json_t *root, api_lease *lease, bf_error *err)
{
    json_t *id = NULL, *jobs = NULL;
    json_int_t retry = 0, body_bytes = 0;
    json_error_t why;

    if (json_unpack_ex(root, &why, 0, "{so sI s?I so}", "id", &id, "retry_s", &retry, "body_bytes",
                       &body_bytes, "jobs", &jobs) != 0)
        return fail_answer(err, why.text);
    const char *text = json_is_string(id) ? json_string_value(id) : NULL;
    const bool is_id = json_is_null(id) || (text != NULL && is_lease_id(text) &&
                                            copy_text(text, sizeof lease->id, lease->id));
    if (retry < 0 || retry > UINT16_MAX || body_bytes < 0 || !json_is_array(jobs) || !is_id)
        return fail_answer(err, "a lease has values beyond their limits");
    lease->retry_s = (uint32_t)retry;
    lease->body_bytes = (uint64_t)body_bytes;
    return text == NULL ? BF_OK : read_jobs(jobs, lease, err);
}

bf_status lease_client_read_lease(const char *json, size_t n, api_lease *ret_lease, bf_error *err)
{
    api_lease lease = { .id = "" };
    json_t *root = NULL;

    bf_status status = parse(json, n, &root, err);
    if (status == BF_OK)
        status = read_lease(root, &lease, err);
    json_decref(root);
    if (status == BF_OK)
        *ret_lease = lease;
    else
        api_lease_fini(&lease);
    return status;
}

static bool read_state(json_t *value, api_job_state *ret_state, json_error_t *why)
{
    const char *word = "";
    json_int_t job = 0, next = 0;
    int stop = 0;

    if (json_unpack_ex(value, why, 0, "{sI sI ss}", "job", &job, "next", &next, "stop", &word) != 0)
        return false;
    snprintf(why->text, sizeof why->text, "a state has values beyond their limits");
    if (job < 0 || job >= API_LEASE_JOBS_MAX || next < 0 ||
        !find_word(word, stop_words, API_JOB_STOPS, &stop))
        return false;
    *ret_state =
        (api_job_state){ .job = (uint32_t)job, .next = (uint64_t)next, .stop = (api_job_stop)stop };
    return true;
}

static bf_status read_states(const json_t *list, api_job_states *states, bf_error *err)
{
    const size_t n = json_array_size(list);
    json_error_t why;

    states->items = memory_alloc(n, sizeof *states->items);
    if (states->items == NULL)
        return bf_fail(err, BF_ENOMEM, "", "no memory for states of jobs");
    for (; states->n < n; states->n++)
        if (!read_state(json_array_get(list, states->n), &states->items[states->n], &why))
            return fail_answer(err, why.text);
    return BF_OK;
}

bf_status lease_client_read_states(const char *json, size_t n, api_job_states *ret_states,
                                   bf_error *err)
{
    api_job_states states = { .n = 0 };
    json_t *root = NULL;

    bf_status status = parse(json, n, &root, err);
    if (status == BF_OK)
        status = read_states(json_object_get(root, "jobs"), &states, err);
    json_decref(root);
    if (status == BF_OK)
        *ret_states = states;
    else
        memory_free(states.items);
    return status;
}

bf_status lease_client_read_problem(const char *body, size_t n, bf_status code, bf_error *err)
{
    json_t *root = json_loadb(body, n, 0, NULL);
    const char *detail = json_string_value(json_object_get(root, "detail"));

    if (detail != NULL)
        (void)bf_fail(err, code, "", "%s", detail);
    else
        (void)bf_fail(err, code, "", "the service said: %.*s", n > 200 ? 200 : (int)n, body);
    json_decref(root);
    return code;
}
