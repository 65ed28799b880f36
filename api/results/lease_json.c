#include "api/results/lease_json.h"

#include "core/base/memory.h"

#include <ctype.h>
#include <endian.h>
#include <jansson.h>
#include <math.h>
#include <string.h>

enum {
    SECTION_HEADER = 16,
    FRAME_ALIGNMENT = 8, // core/observe/frame.h
};

#define WORD(name, word) word,
static const char *const cause_words[] = { API_JOB_CAUSE_LIST(WORD) NULL };
static const char *const stop_words[] = { API_JOB_STOP_LIST(WORD) NULL };
static const char *const error_words[] = { BF_STATUS_LIST(WORD) NULL };
#undef WORD

// ---- documents of workers

static void read_text_or_null(json_in *in, const json_t *value, const member *m, void *item)
{
    if (!json_is_null(value))
        member_text.read(in, value, m, item);
}

static void write_text_or_null(json_out *w, const member *m, const void *item)
{
    const char *text = (const char *)item + m->offset;

    json_out_string(w, text[0] == '\0' ? NULL : text);
}

static const member_kind member_text_or_null = { .text = "string or null",
                                                 .type = "string?",
                                                 .read = read_text_or_null,
                                                 .write = write_text_or_null };

static const member error_members[] = {
    MEMBER("code", enum, offsetof(bf_error, code), "kind of failure", .words = error_words),
    MEMBER("text", text, offsetof(bf_error, text), "why, one sentence", .limit = BF_TEXT_SIZE),
};
static const member_table error_table = { MEMBER_TABLE("jobError", error_members),
                                          .size = sizeof(bf_error) };

static void read_error_or_null(json_in *in, const json_t *value, const member *m, void *item)
{
    if (!json_is_null(value))
        members_read(in, value, m->table, (char *)item + m->offset);
}

static void write_error_or_null(json_out *w, const member *m, const void *item)
{
    const bf_error *error = (const bf_error *)(const void *)((const char *)item + m->offset);

    if (error->code == BF_OK)
        json_out_null(w);
    else
        members_write(w, m->table, error);
}

static const member_kind member_error_or_null = { .text = "object or null",
                                                  .type = "#JobError?",
                                                  .read = read_error_or_null,
                                                  .write = write_error_or_null };

#define AT(place) offsetof(api_worker, place)
#define NAME(offset_)                                                                              \
    MEMBER("worker", text, offset_, "the worker's name: letters, digits, '.', '_' and '-'",        \
           .least = 1, .limit = API_WORKER_SIZE)
#define SOLVER(offset_)                                                                            \
    MEMBER("solver", text, offset_,                                                                \
           "version of its solver, as beltflow worker says it: that of the service", .least = 1,   \
           .limit = API_VERSION_SIZE)
static const bf_range cores_range = { .minimum = 1, .maximum = API_WORKER_CORES };
static const member worker_members[] = {
    NAME(AT(name)),
    SOLVER(AT(solver)),
    MEMBER("cores", count, AT(cores), "cores that it has for jobs", .range = &cores_range),
    MEMBER("memory_bytes", seed, AT(memory_bytes), "memory of its machine", .unit = "bytes"),
    MEMBER("wait_s", count, AT(wait_s),
           "how long it would wait for jobs; it is answered at once all the same", .unit = "s",
           .default_text = "0"),
};
const member_table lease_json_worker_members = { MEMBER_TABLE("leaseRequest", worker_members),
                                                 .size = sizeof(api_worker) };
#undef AT

#define AT(place) offsetof(api_job_report, place)
static const member report_members[] = {
    MEMBER("job", count, AT(job), "its number in the lease"),
    MEMBER("run", text, AT(run), "which run", .least = API_ID_SIZE - 1, .limit = API_ID_SIZE),
    MEMBER("attempt", seed, AT(attempt), "which attempt at the run"),
    MEMBER("cpu_s", number, AT(cpu_s), "CPU time so far", .unit = "s"),
};
static const member_table report_table = { MEMBER_TABLE("jobReport", report_members),
                                           .size = sizeof(api_job_report) };
#undef AT

#define AT(place)     offsetof(api_job_end, place)
#define REPORT(place) offsetof(api_job_end, report.place)
static const member end_members[] = {
    MEMBER("job", count, REPORT(job), "its number in the lease"),
    MEMBER("run", text, REPORT(run), "which run", .least = API_ID_SIZE - 1, .limit = API_ID_SIZE),
    MEMBER("attempt", seed, REPORT(attempt), "which attempt at the run"),
    MEMBER("cpu_s", number, REPORT(cpu_s), "CPU time that it used", .unit = "s"),
    MEMBER("cause", enum, AT(cause), "how it ended", .words = cause_words),
    MEMBER_OF("error", &member_error_or_null, AT(error), "why, if its frames do not say",
              .table = &error_table, .default_text = "null"),
    MEMBER("bytes", seed, AT(n_bytes), "bytes of all its frames"),
    MEMBER_OF("digest", &member_text_or_null, AT(digest),
              "digest of its last frame, in hexadecimal", .limit = API_DIGEST_SIZE,
              .default_text = "null"),
};
static const member_table end_table = { MEMBER_TABLE("jobEnd", end_members),
                                        .size = sizeof(api_job_end) };
#undef REPORT
#undef AT

#define AT(place) offsetof(api_renewal, place)
static const member renewal_members[] = {
    NAME(AT(worker)),
    SOLVER(AT(solver)),
    MEMBER("jobs", list, AT(jobs), "jobs of the lease that have not ended", .offset_n = AT(n_jobs),
           .limit = API_LEASE_JOBS_MAX, .table = &report_table),
    MEMBER("ended", list, AT(ended), "jobs that have ended and were not taken yet",
           .offset_n = AT(n_ended), .limit = API_LEASE_JOBS_MAX, .table = &end_table),
};
const member_table lease_json_renewal_members = { MEMBER_TABLE("leaseRenewal", renewal_members),
                                                  .size = sizeof(api_renewal) };
#undef AT

static void fault_at(json_in *in, const char *name, const char *text)
{
    const size_t mark = json_pointer_enter(&in->pointer, name, strlen(name));

    json_in_fault(in, "%s", text);
    json_pointer_leave(&in->pointer, mark);
}

static void check_name(json_in *in, const char *name)
{
    for (const char *at = name; *at != '\0'; at++) {
        if (isalnum((unsigned char)*at) || strchr("._-", *at) != NULL)
            continue;
        fault_at(in, "worker", "must have letters, digits, '.', '_' and '-' only");
        return;
    }
}

static bf_status read_document(const char *json, size_t n, const member_table *table, void *item,
                               json_in *in, bf_error *err)
{
    struct json_t *root = json_in_parse(in, json, n);

    if (root != NULL)
        members_read(in, root, table, item);
    json_in_free(root);
    return json_in_status(in, err);
}

bf_status lease_json_read_worker(const char *json, size_t n, api_worker *ret_worker,
                                 bf_faults *faults, bf_error *err)
{
    json_in in = json_in_to(faults);
    api_worker worker = { .name = "" };

    BF_TRY(read_document(json, n, &lease_json_worker_members, &worker, &in, err));
    check_name(&in, worker.name);
    if (worker.cores < 1 || worker.cores > API_WORKER_CORES)
        fault_at(&in, "cores", "must be from 1 to 1024");
    BF_TRY(json_in_status(&in, err));
    *ret_worker = worker;
    return BF_OK;
}

bf_status lease_json_read_renewal(const char *json, size_t n, api_renewal *ret_renewal,
                                  bf_faults *faults, bf_error *err)
{
    json_in in = json_in_to(faults);
    api_renewal renewal = { .n_jobs = 0 };

    bf_status status = read_document(json, n, &lease_json_renewal_members, &renewal, &in, err);
    if (status == BF_OK) {
        bool are_good = true; // numbers of jobs are places in lists of this size
        for (size_t k = 0; k < renewal.n_jobs; k++)
            are_good = are_good && renewal.jobs[k].job < API_LEASE_JOBS_MAX;
        for (size_t k = 0; k < renewal.n_ended; k++)
            are_good = are_good && renewal.ended[k].report.job < API_LEASE_JOBS_MAX;
        check_name(&in, renewal.worker);
        if (!are_good)
            fault_at(&in, "jobs", "no lease has a job of this number");
        status = json_in_status(&in, err);
    }
    if (status == BF_OK)
        *ret_renewal = renewal;
    else
        api_renewal_fini(&renewal);
    return status;
}

static bf_status read_section(const char *bytes, size_t n, api_lease_section *ret_section,
                              bf_error *err)
{
    uint32_t job, length;
    uint64_t offset;

    if (n < SECTION_HEADER)
        return bf_fail(err, BF_EINPUT, "", "the body ends inside the header of a section");
    memcpy(&job, bytes, sizeof job);
    memcpy(&length, bytes + 4, sizeof length);
    memcpy(&offset, bytes + 8, sizeof offset);
    const api_lease_section section = { .job = le32toh(job),
                                        .offset = le64toh(offset),
                                        .n = le32toh(length),
                                        .bytes = bytes + SECTION_HEADER };
    if (section.n > n - SECTION_HEADER)
        return bf_fail(err, BF_EINPUT, "", "the body ends inside a section");
    if (section.job >= API_LEASE_JOBS_MAX || section.offset > INT64_MAX)
        return bf_fail(err, BF_EINPUT, "", "a section is of no job or place that can be");
    *ret_section = section;
    return BF_OK;
}

bf_status lease_json_read_sections(const void *bytes, size_t n, api_lease_section *ret_sections,
                                   size_t *ret_n, bf_error *err)
{
    size_t at = 0, count = 0;

    while (at < n) {
        if (count == LEASE_SECTIONS_MAX)
            return bf_fail(err, BF_EINPUT, "", "the body has more than %d sections",
                           LEASE_SECTIONS_MAX);
        BF_TRY(read_section((const char *)bytes + at, n - at, &ret_sections[count], err));
        at += SECTION_HEADER + ret_sections[count++].n;
    }
    *ret_n = count;
    return BF_OK;
}

// ---- answers

static void begin_job(void *item, size_t place)
{
    (void)place;
    *(api_lease_job *)item = (api_lease_job){ .predicted_s = (double)NAN };
}

#define AT(place) offsetof(api_lease_job, place)
static const member job_members[] = {
    MEMBER("job", count, AT(job), "Its number in the lease"),
    MEMBER_OF("run", &member_text_or_null, AT(run), "Which run", .type = "#Id",
              .limit = API_ID_SIZE),
    MEMBER("attempt", size, AT(attempt), "Which attempt at the run; rises with each one"),
    MEMBER("model", enum, AT(model), "Which solver", .words = run_model_words, .type = "#Model"),
    MEMBER("threads", count, AT(n_threads), "Threads of the solver"),
    MEMBER("trial", bool, AT(is_trial), "Of a study: others come first"),
    MEMBER("checkpoint_ms", size, AT(checkpoint_ms), "Between checkpoints", .unit = "ms"),
    MEMBER("memory_bytes", size, AT(memory_bytes), "Address space; 0: unlimited", .unit = "bytes"),
    MEMBER("cpu_s", size, AT(cpu_s), "CPU time that it may use; 0: unlimited", .unit = "s"),
    MEMBER("step", size, AT(step), "Of the checkpoint that it resumes from; 0: none"),
    MEMBER("predicted_s", number, AT(predicted_s), "CPU time that it is likely to take",
           .unit = "s", .null = "not known"),
    MEMBER("bytes", size, AT(n_bytes), "Bytes of its input"),
};
const member_table lease_json_job = { MEMBER_TABLE("LeaseJob", job_members),
                                      .size = sizeof(api_lease_job), .init = begin_job };
#undef AT

#define AT(place) offsetof(api_lease, place)
static const member lease_members[] = {
    MEMBER_OF("id", &member_text_or_null, AT(id), "Identifier of the lease", .type = "#Id",
              .null = "no jobs", .limit = API_ID_SIZE),
    MEMBER("renew_s", count, AT(renew_s), "Longest time between two renewals", .unit = "s"),
    MEMBER("expires_s", count, AT(expires_s), "After so long without a word it is over",
           .unit = "s"),
    MEMBER("retry_s", count, AT(retry_s), "Without jobs: when it helps to ask again", .unit = "s"),
    MEMBER("body_bytes", size, AT(body_bytes), "Of a request at most; 0: any number",
           .unit = "bytes"),
    MEMBER("jobs", list, AT(jobs), "What is to be solved, in this order", .offset_n = AT(n_jobs),
           .table = &lease_json_job),
};
const member_table lease_json_lease = { MEMBER_TABLE("Lease", lease_members) };
#undef AT

#define AT(place) offsetof(api_job_state, place)
static const member state_members[] = {
    MEMBER("job", count, AT(job), "Its number in the lease"),
    MEMBER("next", size, AT(next), "Offset of the byte that is expected next"),
    MEMBER("stop", enum, AT(stop),
           "`save`: write a checkpoint, send what is left, end; `gone`: drop it, it is not the "
           "worker's any more",
           .words = stop_words),
};
const member_table lease_json_state = { MEMBER_TABLE("LeaseJobState", state_members),
                                        .size = sizeof(api_job_state) };
#undef AT

#define AT(place) offsetof(api_job_states, place)
static const member states_members[] = {
    MEMBER("jobs", list, AT(items), "Jobs that were named, and those of which something is asked",
           .offset_n = AT(n), .table = &lease_json_state),
};
const member_table lease_json_states = { MEMBER_TABLE("LeaseJobStates", states_members) };
#undef AT

#define AT(place) offsetof(api_lease_view, place)
static const member view_members[] = {
    MEMBER("id", text, AT(id), "Identifier of the lease", .type = "#Id"),
    MEMBER("jobs", size, AT(n_jobs), "Jobs that it began with"),
    MEMBER("done", size, AT(n_done), "Of them, ended"),
    MEMBER("expires_in_s", number, AT(expires_in_s), "Unless its worker is heard of", .unit = "s"),
};
const member_table lease_json_view = { MEMBER_TABLE("LeaseView", view_members),
                                       .size = sizeof(api_lease_view) };
#undef AT

#define AT(place) offsetof(api_worker_view, place)
static const member view_of_worker_members[] = {
    MEMBER("worker", text, AT(about.name), "Its name"),
    MEMBER("cores", count, AT(about.cores), "Cores that it has for jobs"),
    MEMBER("memory_bytes", size, AT(about.memory_bytes), "Memory of its machine", .unit = "bytes"),
    MEMBER("solver", text, AT(about.solver), "Version of its solver"),
    MEMBER("seen_s", number, AT(seen_s), "Since it was last heard of", .unit = "s"),
    MEMBER("leases", list, AT(leases), "Its leases", .offset_n = AT(n_leases),
           .table = &lease_json_view),
};
const member_table lease_json_worker = { MEMBER_TABLE("Worker", view_of_worker_members),
                                         .size = sizeof(api_worker_view) };
#undef AT

#define AT(place) offsetof(api_worker_list, place)
static const member workers_members[] = {
    MEMBER("workers", list, AT(workers), "Those that were heard of lately", .offset_n = AT(n),
           .table = &lease_json_worker),
};
const member_table lease_json_workers = { MEMBER_TABLE("WorkerList", workers_members) };
#undef AT

static bf_status write(const member_table *table, const void *item, bf_buffer *out, bf_error *err)
{
    json_out w = json_out_to(out);

    members_write(&w, table, item);
    return json_out_status(&w, err);
}

bf_status lease_json_write(const api_lease *lease, bf_buffer *out, bf_error *err)
{
    api_lease written = *lease;

    written.renew_s = API_LEASE_RENEW_S;
    written.expires_s = API_LEASE_EXPIRES_S;
    return write(&lease_json_lease, &written, out, err);
}

bf_status lease_json_write_states(const api_job_states *states, bf_buffer *out, bf_error *err)
{
    return write(&lease_json_states, states, out, err);
}

bf_status lease_json_write_workers(const api_worker_list *list, bf_buffer *out, bf_error *err)
{
    return write(&lease_json_workers, list, out, err);
}

// ---- the worker's side

bf_status lease_json_write_worker(const api_worker *worker, bf_buffer *out, bf_error *err)
{
    return write(&lease_json_worker_members, worker, out, err);
}

bf_status lease_json_write_renewal(const api_renewal *renewal, bf_buffer *out, bf_error *err)
{
    return write(&lease_json_renewal_members, renewal, out, err);
}

bf_status lease_json_write_section(const api_lease_section *section, bf_buffer *out, bf_error *err)
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

// Read an answer that the service made of a table; BF_ECORRUPT: it is none.
static bf_status read_answer(const char *json, size_t n, const member_table *table, void *item,
                             bf_error *err)
{
    bf_faults faults = { .n = 0 };
    json_in in = json_in_to(&faults);
    bf_error why = { .code = BF_OK };

    in.is_answer = true;
    const bf_status status = read_document(json, n, table, item, &in, &why);
    if (status == BF_OK || status == BF_ENOMEM)
        return status == BF_OK ? BF_OK : bf_fail(err, status, "", "%s", why.text);
    return bf_fail(err, BF_ECORRUPT, "", "the service's answer is not what was expected: %s %s",
                   why.pointer, why.text);
}

static bf_status fail_limits(bf_error *err)
{
    return bf_fail(err, BF_ECORRUPT, "", "the service's answer has values beyond their limits");
}

// Its id becomes a part of paths.
static bool is_lease_good(const api_lease *lease)
{
    bool is_good = lease->id[strspn(lease->id, "0123456789abcdef-")] == '\0' &&
                   lease->retry_s <= UINT16_MAX && lease->n_jobs <= API_LEASE_JOBS_MAX &&
                   (lease->id[0] != '\0' || lease->n_jobs == 0);

    for (size_t k = 0; k < lease->n_jobs && is_good; k++) {
        const api_lease_job *job = &lease->jobs[k];
        is_good = job->job == k && job->run[0] != '\0' && job->n_threads >= 1 &&
                  job->n_threads <= INT16_MAX && job->n_bytes % FRAME_ALIGNMENT == 0;
    }
    return is_good;
}

bf_status lease_json_read(const char *json, size_t n, api_lease *ret_lease, bf_error *err)
{
    api_lease lease = { .id = "" };

    bf_status status = read_answer(json, n, &lease_json_lease, &lease, err);
    if (status == BF_OK && !is_lease_good(&lease))
        status = fail_limits(err);
    if (status == BF_OK)
        *ret_lease = lease;
    else
        api_lease_fini(&lease);
    return status;
}

bf_status lease_json_read_states(const char *json, size_t n, api_job_states *ret_states,
                                 bf_error *err)
{
    api_job_states states = { .n = 0 };

    bf_status status = read_answer(json, n, &lease_json_states, &states, err);
    for (size_t k = 0; k < states.n && status == BF_OK; k++)
        if (states.items[k].job >= API_LEASE_JOBS_MAX)
            status = fail_limits(err);
    if (status == BF_OK)
        *ret_states = states;
    else
        memory_free(states.items);
    return status;
}

bf_status lease_json_read_problem(const char *body, size_t n, bf_status code, bf_error *err)
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
