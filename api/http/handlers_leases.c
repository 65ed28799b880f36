// Leases of workers: take, read, deliver, renew, leave; and who there is.

#include "api/http/http_priv.h"
#include "api/results/lease_json.h"
#include "core/base/memory.h"

// The services, where the daemon leaves solving to workers.
static bf_status find_services(exchange *x, const api_leases **ret_leases, bf_error *err)
{
    if (x->services->leases == NULL)
        return bf_fail(err, BF_ECONFLICT, "",
                       "this service solves runs itself, and has no jobs for workers");
    *ret_leases = x->services->leases;
    return BF_OK;
}

// The same, and the id of a path.
static bf_status find_lease(exchange *x, const api_leases **ret_leases, const char **ret_id,
                            bf_error *err)
{
    const char *id = x->params.values[0];

    if (!param_is_id(id))
        return bf_fail(err, BF_ENOTFOUND, "", "there is no lease '%s'", id);
    *ret_id = id;
    return find_services(x, ret_leases, err);
}

bf_status handlers_leases_take(exchange *x, bf_error *err)
{
    const api_leases *leases = NULL;
    api_lease lease = { .n_jobs = 0 };
    api_worker who;

    bf_status status = find_services(x, &leases, err);
    if (status == BF_OK)
        status =
            lease_json_read_worker(exchange__body(x), x->request->n_body, &who, &x->faults, err);
    if (status == BF_OK)
        who.token = x->who.token;
    if (status == BF_OK)
        status = leases->lease(leases->context, &who, &lease, err);
    lease.body_bytes = x->request->body_limit;
    if (status == BF_OK)
        status = lease_json_write(&lease, &x->response->body, err);
    api_lease_fini(&lease);
    return status;
}

bf_status handlers_leases_jobs(exchange *x, bf_error *err)
{
    const api_leases *leases = NULL;
    const char *id = NULL;

    BF_TRY(find_lease(x, &leases, &id, err));
    BF_TRY(leases->read_jobs(leases->context, x->who.token, id, &x->response->body, err));
    return exchange__reserve(x, (double)x->response->body.n, err);
}

static bf_status answer_states(exchange *x, api_job_states *states, bf_error *err)
{
    bf_status status = lease_json_write_states(states, &x->response->body, err);

    memory_free(states->items);
    return status;
}

static bf_status deliver(exchange *x, const api_leases *leases, const char *id,
                         api_lease_section *sections, bf_error *err)
{
    api_job_states states = { .n = 0 };
    size_t n = 0;

    bf_status status =
        lease_json_read_sections(exchange__body(x), x->request->n_body, sections, &n, err);
    if (status != BF_OK)
        return exchange__refuse(x, 422, "", err, "%s", err->text);
    status = leases->deliver(leases->context, x->who.token, id, sections, n, &states, err);
    return status == BF_OK ? answer_states(x, &states, err) : status;
}

bf_status handlers_leases_deliver(exchange *x, bf_error *err)
{
    const api_leases *leases = NULL;
    const char *id = NULL;

    BF_TRY(find_lease(x, &leases, &id, err));
    api_lease_section *sections = memory_alloc(LEASE_SECTIONS_MAX, sizeof *sections);
    bf_status status =
        sections == NULL ? bf_fail_memory(err) : deliver(x, leases, id, sections, err);
    memory_free(sections);
    return status;
}

bf_status handlers_leases_renew(exchange *x, bf_error *err)
{
    const api_leases *leases = NULL;
    api_renewal renewal = { .n_jobs = 0 };
    api_job_states states = { .n = 0 };
    const char *id = NULL;

    bf_status status = find_lease(x, &leases, &id, err);
    if (status == BF_OK)
        status = lease_json_read_renewal(exchange__body(x), x->request->n_body, &renewal,
                                         &x->faults, err);
    renewal.token = x->who.token;
    if (status == BF_OK)
        status = leases->renew(leases->context, id, &renewal, &states, err);
    api_renewal_fini(&renewal);
    return status == BF_OK ? answer_states(x, &states, err) : status;
}

bf_status handlers_leases_leave(exchange *x, bf_error *err)
{
    const api_leases *leases = NULL;
    const char *id = NULL;

    BF_TRY(find_lease(x, &leases, &id, err));
    BF_TRY(leases->leave(leases->context, x->who.token, id, err));
    x->response->status = 204;
    return BF_OK;
}

bf_status handlers_leases_list(exchange *x, bf_error *err)
{
    api_worker_list list = { .n = 0 };
    const api_leases *leases = NULL;

    const bool sees_all = x->credential != API_CREDENTIAL_VALID ||
                          api_access_includes(x->who.scopes, API_SCOPE_ADMIN);
    bf_status status = find_services(x, &leases, err);
    if (status == BF_OK)
        status = leases->list(leases->context, sees_all ? API_ANY_TOKEN : x->who.token, &list, err);
    if (status == BF_OK)
        status = lease_json_write_workers(&list, &x->response->body, err);
    api_worker_list_fini(&list);
    return status;
}
