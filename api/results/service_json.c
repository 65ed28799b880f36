#include "api/results/service_json.h"

// The answers are constants, so the kind of a member has its value in the type: "=alive".
static void write_constant(json_out *w, const member *m, const void *item)
{
    (void)item;
    json_out_string(w, m->type + 1);
}

static const member_kind member_constant = { .write = write_constant };

static const member alive_members[] = {
    MEMBER("status", constant, 0, "The process answers", .type = "=alive"),
};
const member_table service_json_alive_members = { MEMBER_TABLE("Alive", alive_members) };

static const member ready_members[] = {
    MEMBER("status", constant, 0, "Runs are accepted", .type = "=ready"),
};
const member_table service_json_ready_members = { MEMBER_TABLE("Ready", ready_members) };

typedef struct version {
    const char *version;
    const char *compiler;
} version;

static const member version_members[] = {
    MEMBER("name", constant, 0, "Name of the program", .type = "=beltflow"),
    MEMBER("version", string, offsetof(version, version), "Version of the program"),
    MEMBER("api", constant, 0, "Version of the API", .type = "=v1"),
    MEMBER("compiler", string, offsetof(version, compiler), "Compiler that built it"),
};
const member_table service_json_version_members = { MEMBER_TABLE("Version", version_members) };

static const member ticket_members[] = {
    MEMBER("ticket", text, offsetof(api_ticket, text), "For `?ticket=` of a GET or HEAD"),
    MEMBER("expires_at", time, offsetof(api_ticket, expires_ms), "From then on it does not count"),
};
const member_table service_json_ticket_members = { MEMBER_TABLE("Ticket", ticket_members) };

#define AT(place) offsetof(api_quota, place)
static const member quota_members[] = {
    MEMBER("used", size, AT(used), "Used at the moment"),
    MEMBER("allowed", size, AT(allowed),
           "With as much, nothing more is accepted; missing: no limit", .flags = MEMBER_OMIT_EMPTY),
    MEMBER("available_at", time, AT(release_ms),
           "CPU time that is used up: when a part of it is given back", .flags = MEMBER_OMIT_EMPTY),
};
const member_table service_json_quota_members = { MEMBER_TABLE("Quota", quota_members) };
#undef AT

#define QUOTA(name, place, ...)                                                                    \
    MEMBER(name, object, offsetof(api_quotas, place), __VA_ARGS__,                                 \
           .table = &service_json_quota_members)
static const member quotas_members[] = {
    MEMBER("owner", text, offsetof(api_quotas, owner),
           "Owner of the access token; missing without one", .flags = MEMBER_OMIT_EMPTY),
    QUOTA("waiting_runs", waiting, "Runs that wait"),
    QUOTA("cpu_s", cpu_s, "CPU time of solvers in the last 24 hours, counted by the hour",
          .unit = "s"),
    QUOTA(
        "result_bytes", bytes,
        "Bytes of stored results, compressed as they are; what several own runs share counts once"),
};
const member_table service_json_quotas_members = { MEMBER_TABLE("Quotas", quotas_members) };
#undef QUOTA

static bf_status write(const member_table *table, const void *item, bf_buffer *out, bf_error *err)
{
    json_out w = json_out_to(out);

    members_write(&w, table, item);
    return json_out_status(&w, err);
}

bf_status service_json_alive(bf_buffer *out, bf_error *err)
{
    return write(&service_json_alive_members, NULL, out, err);
}

bf_status service_json_ready(bf_buffer *out, bf_error *err)
{
    return write(&service_json_ready_members, NULL, out, err);
}

bf_status service_json_version(bf_buffer *out, bf_error *err)
{
    const version view = { .version = BELTFLOW_VERSION, .compiler = __VERSION__ };

    return write(&service_json_version_members, &view, out, err);
}

bf_status service_json_ticket(const api_ticket *ticket, bf_buffer *out, bf_error *err)
{
    return write(&service_json_ticket_members, ticket, out, err);
}

bf_status service_json_quotas(const api_quotas *quotas, bf_buffer *out, bf_error *err)
{
    return write(&service_json_quotas_members, quotas, out, err);
}
