#include "api/results/grant_json.h"

#include <jansson.h>

static const bf_range expiry_range = { .minimum = API_GRANT_MIN_S, .maximum = API_GRANT_MAX_S };

static void init_request(void *item, size_t place)
{
    grant_json_request *asked = item;

    (void)place;
    asked->expires_in_s = API_GRANT_USUAL_S;
}

static const member request_members[] = {
    MEMBER("expires_in_s", count, offsetof(grant_json_request, expires_in_s),
           "how long it counts from now on", .flags = MEMBER_INIT, .unit = "s",
           .range = &expiry_range),
};
const member_table grant_json_request_members = { MEMBER_TABLE("grantRequest", request_members),
                                                  .size = sizeof(grant_json_request),
                                                  .init = init_request };

#define AT(place) offsetof(api_grant, place)
static const member grant_members[] = {
    MEMBER("id", size, AT(id), "Number of the grant"),
    MEMBER("resource", text, AT(resource), "Path of the run or study that it reads"),
    MEMBER("owner", text, AT(owner), "Who made it"),
    MEMBER("created_at", time, AT(created_ms), "When it was made"),
    MEMBER("expires_at", time, AT(expires_ms), "From then on it does not count"),
    MEMBER("token", text, AT(token), "The access token; shown only when the grant is made",
           .flags = MEMBER_OMIT_EMPTY),
};
const member_table grant_json_members = { MEMBER_TABLE("Grant", grant_members),
                                          .size = sizeof(api_grant) };
#undef AT

static const member list_members[] = {
    MEMBER("grants", list, offsetof(api_grant_list, grants), "Those that count, the oldest first",
           .offset_n = offsetof(api_grant_list, n), .table = &grant_json_members),
};
const member_table grant_json_list_members = { MEMBER_TABLE("GrantList", list_members) };

bf_status grant_json_read(const char *json, size_t n, grant_json_request *ret_request,
                          bf_faults *faults, bf_error *err)
{
    json_in in = json_in_to(faults);
    json_t *root = json_in_parse(&in, json, n);

    init_request(ret_request, 0);
    if (root != NULL)
        members_read(&in, root, &grant_json_request_members, ret_request);
    range_check(&expiry_range, (double)ret_request->expires_in_s, "/expires_in_s", faults);
    json_in_free(root);
    return json_in_status(&in, err);
}
