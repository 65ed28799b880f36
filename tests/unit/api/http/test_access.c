// Unit tests of the decision about access, and of what requests with and without a token are answered.

#include "api/http/access.h"
#include "tests/unit/helper_cmocka.h"

#include <stdio.h>
#include <string.h>
#include <strings.h>

static const unsigned all_scopes[] = { API_SCOPE_NONE, API_SCOPE_READ,  API_SCOPE_SUBMIT,
                                       API_SCOPE_WORK, API_SCOPE_ADMIN, API_SCOPE_PRIORITY };

enum { N_SCOPES = sizeof all_scopes / sizeof *all_scopes };

// The methods and paths that everybody may use; all others want a token.
static const char *const public_paths[] = { "/livez", "/readyz", "/version", "/problems/{kind}",
                                            "/openapi.json" };

static bool is_public(const route *r)
{
    for (size_t i = 0; i < sizeof public_paths / sizeof *public_paths; i++) {
        if (strcmp(r->path, public_paths[i]) == 0)
            return true;
    }
    return false;
}

// The scopes of which a route needs one, from its method: validation is a POST that stores nothing, and leases are for
// workers.
static unsigned needed_by(const route *r)
{
    if (strcmp(r->path, "/v1/tickets") == 0)
        return API_SCOPE_READ | API_SCOPE_SUBMIT | API_SCOPE_WORK | API_SCOPE_PRIORITY;
    if (strncmp(r->path, "/v1/leases", 10) == 0)
        return API_SCOPE_WORK;
    bool reads = strcmp(r->method, "GET") == 0 || strcmp(r->path, "/v1/validate") == 0;
    return reads ? API_SCOPE_READ : API_SCOPE_SUBMIT;
}

static void every_route_is_decided_for_every_scope(void **state)
{
    size_t n = 0;
    const route *table = routes_list(&n);

    for (size_t i = 0; i < n; i++) {
        for (size_t k = 0; k < N_SCOPES; k++) {
            bool may = is_public(&table[i]) || (all_scopes[k] & needed_by(&table[i])) != 0 ||
                       all_scopes[k] == API_SCOPE_ADMIN;
            int status = access_decide(&table[i], API_CREDENTIAL_VALID, all_scopes[k]);
            if (status != (may ? 0 : 403))
                fail_msg("%s %s with scopes %u: %d", table[i].method, table[i].path, all_scopes[k],
                         status);
        }
    }
}

// What a granted token may use, of all routes; what is missing here is refused.
static void a_granted_token_may_use_what_reads_runs_and_studies_by_name(void **state)
{
    static const char *const paths[] = {
        "/v1/runs/{id}",
        "/v1/runs/{id}/scenario",
        "/v1/runs/{id}/summary",
        "/v1/runs/{id}/curve",
        "/v1/runs/{id}/photo_eyes",
        "/v1/runs/{id}/key_figures",
        "/v1/runs/{id}/snapshots",
        "/v1/runs/{id}/snapshots/{n}",
        "/v1/runs/{id}/snapshots.pvd",
        "/v1/runs/{id}/parts/{n}",
        "/v1/runs/{id}/parts.pvd",
        "/v1/runs/{id}/results.zip",
        "/v1/runs/{id}/events",
        "/v1/events",
        "/v1/studies/{id}",
        "/v1/studies/{id}/document",
        "/v1/studies/{id}/trials",

        "/v1/studies/{id}/best",
        "/v1/studies/{id}/events",
    };
    size_t n = 0, n_allowed = 0;
    const route *table = routes_list(&n);

    for (size_t i = 0; i < n; i++) {
        bool may = is_public(&table[i]) || strcmp(table[i].path, "/v1/tickets") == 0;
        for (size_t k = 0; k < sizeof paths / sizeof *paths; k++) {
            const bool is_it =
                strcmp(table[i].method, "GET") == 0 && strcmp(table[i].path, paths[k]) == 0;
            n_allowed += is_it;
            may = may || is_it;
        }
        if (access_decide(&table[i], API_CREDENTIAL_VALID, API_SCOPE_GRANTED) != (may ? 0 : 403))
            fail_msg("%s %s", table[i].method, table[i].path);
    }
    assert_int_equal(n_allowed, sizeof paths / sizeof *paths);
}

static void scopes_of_a_token_that_does_not_count_are_worth_nothing(void **state)
{
    size_t n = 0;
    const route *table = routes_list(&n);

    for (size_t i = 0; i < n; i++) {
        const int wanted = is_public(&table[i]) ? 0 : 401;
        for (int c = API_CREDENTIAL_MISSING; c < API_CREDENTIAL_VALID; c++)
            assert_int_equal(access_decide(&table[i], (api_credential)c, API_SCOPE_ADMIN), wanted);
        assert_int_equal(access_decide(&table[i], API_CREDENTIAL_UNUSED, API_SCOPE_NONE), 0);
    }
}

static void tickets_are_for_what_reads_and_needs_a_token(void **state)
{
    size_t n = 0;
    const route *table = routes_list(&n);

    for (size_t i = 0; i < n; i++)
        assert_int_equal(access_takes_ticket(&table[i]),
                         strcmp(table[i].method, "GET") == 0 && !is_public(&table[i]));
}

static void scopes_are_read_as_they_are_written(void **state)
{
    char text[API_SCOPES_SIZE];
    unsigned scopes = 77;

    for (unsigned flags = 1; flags < 32; flags++) {
        assert_true(api_access_read_scopes(api_access_write_scopes(flags, text), &scopes));
        assert_int_equal(scopes, flags);
    }
    assert_string_equal(api_access_write_scopes(63, text),
                        "read,submit,work,admin,priority,metrics");
    assert_true(api_access_includes(API_SCOPE_READ, API_SCOPE_METRICS));
    assert_false(api_access_includes(API_SCOPE_GRANTED, API_SCOPE_METRICS));
    assert_false(api_access_includes(API_SCOPE_SUBMIT, API_SCOPE_METRICS));
    assert_false(api_access_includes(API_SCOPE_METRICS, API_SCOPE_READ));
    assert_string_equal(api_access_write_scopes(0, text), "");
    static const char *const bad[] = { "",    ",",     "read,",       ",read",
                                       "rea", "reads", "read submit", "READ" };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        assert_false(api_access_read_scopes(bad[i], &scopes));
    assert_int_equal(scopes, 31);
}

// A service with three tokens: "reads", "submits" and "old".
static api_credential identify(api_service *service, const char *token, api_identity *ret_who)
{
    if (token == NULL)
        return API_CREDENTIAL_MISSING;
    if (strcmp(token, "old") == 0)
        return API_CREDENTIAL_EXPIRED;
    bool submits = strcmp(token, "submits") == 0;
    if (!submits && strcmp(token, "reads") != 0)
        return API_CREDENTIAL_UNKNOWN;
    *ret_who = (api_identity){ .token = submits ? 2 : 1,
                               .owner = "alice",
                               .scopes = submits ? API_SCOPE_SUBMIT : API_SCOPE_READ };
    return API_CREDENTIAL_VALID;
}

// Tokens by their numbers: 1 and 2 as above, 3 was revoked.
static api_credential identify_by_id(api_service *service, uint64_t token, api_identity *ret_who)
{
    if (token == 3)
        return API_CREDENTIAL_REVOKED;
    return identify(service, token == 2 ? "submits" : "reads", ret_who);
}

// Tickets: "good", "sent" and "gone" of tokens 1 to 3, and "late".
static api_credential read_ticket(api_service *service, const char *ticket, uint64_t *ret_token)
{
    static const char *const known[] = { "good", "sent", "gone" };

    if (strcmp(ticket, "late") == 0)
        return API_CREDENTIAL_EXPIRED;
    for (size_t i = 0; i < sizeof known / sizeof *known; i++) {
        if (strcmp(ticket, known[i]) != 0)
            continue;
        *ret_token = i + 1;
        return API_CREDENTIAL_VALID;
    }
    return API_CREDENTIAL_UNKNOWN;
}

static void make_ticket(api_service *service, uint64_t token, api_ticket *ret_ticket)
{
    *ret_ticket = (api_ticket){ .expires_ms = 1767225600000 }; // 2026-01-01
    (void)snprintf(ret_ticket->text, sizeof ret_ticket->text, "ticket-%u", (unsigned)token);
}

static const api_services services = { .identify = identify,
                                       .identify_by_id = identify_by_id,
                                       .read_ticket = read_ticket,
                                       .make_ticket = make_ticket };

static const char *find_header(void *context, const char *name)
{
    return strcasecmp(name, "Authorization") == 0 ? context : NULL;
}

static void ask_for(const char *method, const char *path, const char *query,
                    const char *authorization, api_response *response)
{
    char header[80];

    (void)snprintf(header, sizeof header, "%s", authorization == NULL ? "" : authorization);
    const api_request request = { .method = method,
                                  .path = path,
                                  .query = query,
                                  .header = find_header,
                                  .header_context = authorization == NULL ? NULL : header };
    api_handle(&services, &request, response);
}

static void a_body_is_decided_by_the_header(void **state)
{
    static const struct {
        const char *method, *path, *authorization;
        api_body what;
        int status;
    } cases[] = {
        { "POST", "/v1/runs", "Bearer submits", API_BODY_NEEDED, 0 },
        { "POST", "/v1/runs", "Bearer reads", API_BODY_REFUSED, 403 },
        { "POST", "/v1/runs", "Bearer old", API_BODY_REFUSED, 401 },
        { "POST", "/v1/measurements", NULL, API_BODY_REFUSED, 401 },
        { "GET", "/v1/runs", NULL, API_BODY_REFUSED, 401 },
        { "GET", "/v1/runs", "Bearer reads", API_BODY_UNUSED, 0 },
        { "GET", "/version", NULL, API_BODY_UNUSED, 0 },
        { "POST", "/version", NULL, API_BODY_UNUSED, 0 },
        { "POST", "/nothing", NULL, API_BODY_UNUSED, 0 },
        { "OPTIONS", "/v1/runs", NULL, API_BODY_UNUSED, 0 },
    };

    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const char *header = cases[i].authorization;
        const api_request request = { .method = cases[i].method,
                                      .path = cases[i].path,
                                      .query = "",
                                      .header = find_header,
                                      .header_context = (void *)(uintptr_t)header };
        api_response response;
        assert_int_equal(api_admit_body(&services, &request, &response), cases[i].what);
        assert_int_equal(response.status, cases[i].status);
        assert_int_equal(response.n_headers > 0, cases[i].status != 0);
        api_response_fini(&response);
    }
}

static void a_refusal_says_what_is_wanted(void **state)
{
    static const struct {
        const char *method, *path, *query, *authorization;
        int status;
        const char *challenge;
    } cases[] = {
        { "GET", "/v1/examples", "", NULL, 401, "Bearer realm=\"beltflow\"" },
        { "GET", "/v1/examples", "access_token=reads", NULL, 401, "Bearer realm=\"beltflow\"" },
        { "GET", "/v1/examples", "access_token=reads", "Bearer reads", 400, NULL },
        { "GET", "/v1/examples", "", "Basic cmVhZHM6", 401, "Bearer realm=\"beltflow\"" },
        { "GET", "/v1/examples", "", "reads", 401, "Bearer realm=\"beltflow\"" },
        { "GET", "/v1/examples", "", "Bearer nonsense", 401,
          "Bearer realm=\"beltflow\", error=\"invalid_token\"" },
        { "GET", "/v1/examples", "", "Bearer old", 401,
          "Bearer realm=\"beltflow\", error=\"invalid_token\"" },
        { "GET", "/v1/examples", "", "Bearer submits", 403,
          "Bearer realm=\"beltflow\", error=\"insufficient_scope\", scope=\"read\"" },
        { "POST", "/v1/runs", "", "Bearer reads", 403,
          "Bearer realm=\"beltflow\", error=\"insufficient_scope\", scope=\"submit\"" },
        { "GET", "/v1/examples", "", "Bearer reads", 200, NULL },
        { "HEAD", "/v1/examples", "", "bearer  reads", 200, NULL },
        { "HEAD", "/v1/examples", "", NULL, 401, "Bearer realm=\"beltflow\"" },
        { "OPTIONS", "/v1/examples", "", NULL, 204, NULL },
        { "GET", "/version", "", "Bearer nonsense", 200, NULL },
        { "GET", "/v1/examples", "ticket=good", NULL, 200, NULL },
        { "HEAD", "/v1/examples", "ticket=good", NULL, 200, NULL },
        { "GET", "/v1/examples", "ticket=good", "Basic cmVhZHM6", 200, NULL },
        { "GET", "/v1/examples", "ticket=good", "Bearer reads", 200, NULL },
        { "GET", "/v1/examples", "ticket=late", "Bearer reads", 200, NULL },
        { "GET", "/v1/examples", "ticket=good&colour=red", NULL, 400, NULL },
        { "GET", "/v1/examples", "ticket=good&ticket=good", NULL, 400, NULL },
        { "GET", "/v1/examples", "ticket=good", "Bearer nonsense", 401,
          "Bearer realm=\"beltflow\", error=\"invalid_token\"" },
        { "GET", "/v1/examples", "ticket=late", NULL, 401,
          "Bearer realm=\"beltflow\", error=\"invalid_token\"" },
        { "GET", "/v1/examples", "ticket=gone", NULL, 401,
          "Bearer realm=\"beltflow\", error=\"invalid_token\"" },
        { "GET", "/v1/examples", "ticket=reads", NULL, 401,
          "Bearer realm=\"beltflow\", error=\"invalid_token\"" },
        { "GET", "/v1/examples", "ticket", NULL, 401,
          "Bearer realm=\"beltflow\", error=\"invalid_token\"" },
        { "GET", "/v1/examples", "ticket=sent", NULL, 403,
          "Bearer realm=\"beltflow\", error=\"insufficient_scope\", scope=\"read\"" },
        { "POST", "/v1/runs", "ticket=sent", NULL, 401, "Bearer realm=\"beltflow\"" },
        { "POST", "/v1/runs", "ticket=sent", "Bearer submits", 400, NULL },
        { "DELETE", "/v1/runs/1", "ticket=sent", NULL, 401, "Bearer realm=\"beltflow\"" },
        { "POST", "/v1/tickets", "ticket=good", NULL, 401, "Bearer realm=\"beltflow\"" },
        { "POST", "/v1/tickets", "", "Bearer reads", 200, NULL },
        { "POST", "/v1/tickets", "", "Bearer submits", 200, NULL },
    };

    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        api_response response;
        ask_for(cases[i].method, cases[i].path, cases[i].query, cases[i].authorization, &response);
        const char *challenge = api_response_find(&response, "WWW-Authenticate");
        if (response.status != cases[i].status ||
            (challenge == NULL) != (cases[i].challenge == NULL))
            fail_msg("case %zu: %d, %s", i, response.status, challenge == NULL ? "-" : challenge);
        if (challenge != NULL)
            assert_string_equal(challenge, cases[i].challenge);
        api_response_fini(&response);
    }
}

static void an_answer_says_whose_it_is_and_that_caches_must_not_share_it(void **state)
{
    api_response response;

    ask_for("GET", "/v1/examples", "", "Bearer reads", &response);
    assert_int_equal(response.who.token, 1);
    assert_string_equal(response.who.owner, "alice");
    assert_string_equal(api_response_find(&response, "Vary"), "Authorization");
    api_response_fini(&response);
    ask_for("GET", "/version", "", "Bearer reads", &response);
    assert_null(api_response_find(&response, "Vary"));
    api_response_fini(&response);
}

static void a_ticket_is_answered_with_its_end_and_not_kept(void **state)
{
    api_response response;

    ask_for("POST", "/v1/tickets", "", "Bearer submits", &response);
    assert_string_equal(response.body.bytes,
                        "{\"ticket\":\"ticket-2\",\"expires_at\":\"2026-01-01T00:00:00.000Z\"}");
    assert_string_equal(api_response_find(&response, "Cache-Control"), "no-store");
    api_response_fini(&response);
}

static void after_a_wait_the_token_has_to_count_and_the_ticket_need_not(void **state)
{
    const api_request request = {
        .method = "GET", .path = "/v1/examples", .query = "ticket=late", .header = find_header
    };
    api_response response;

    ask_for("GET", "/v1/examples", "ticket=good", NULL, &response);
    assert_int_equal(response.who.token, 1);
    api_handle_again(&services, &request, &response);
    assert_int_equal(response.status, 200);
    assert_int_equal(response.who.token, 1);
    response.who.token = 3;
    api_handle_again(&services, &request, &response);
    assert_int_equal(response.status, 401);
    api_response_fini(&response);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_route_is_decided_for_every_scope),
        cmocka_unit_test(a_granted_token_may_use_what_reads_runs_and_studies_by_name),
        cmocka_unit_test(scopes_of_a_token_that_does_not_count_are_worth_nothing),
        cmocka_unit_test(tickets_are_for_what_reads_and_needs_a_token),
        cmocka_unit_test(scopes_are_read_as_they_are_written),
        cmocka_unit_test(a_body_is_decided_by_the_header),
        cmocka_unit_test(a_refusal_says_what_is_wanted),
        cmocka_unit_test(an_answer_says_whose_it_is_and_that_caches_must_not_share_it),
        cmocka_unit_test(a_ticket_is_answered_with_its_end_and_not_kept),
        cmocka_unit_test(after_a_wait_the_token_has_to_count_and_the_ticket_need_not),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
