/// Requests to a daemon in a few arrays, and looks at its answers, for tests of the API.

#pragma once

#include "tests/unit/api/helper_services.h"

#include <stdbool.h>

/// Ids of the first three runs that a test adds, and what is built of them.
#define ID_1   "0190a0b0-0000-7000-8000-000000000001"
#define ID_2   "0190a0b0-0000-7000-8000-000000000002"
#define ID_3   "0190a0b0-0000-7000-8000-000000000003"
#define RUN_1  "/v1/runs/" ID_1
#define NO_RUN "/v1/runs/0190a0b0-0000-7000-8000-0000000000ff"

/// A scenario of one part, bodies with it and with a duration that is at fault, and their header.
#define CARGO                                                                                      \
    "\"cargo\":{\"shape\":{\"type\":\"cylinder\",\"radius_m\":0.012,\"height_m\":0.008},"          \
    "\"mass_kg\":0.02841},\"initial\":{\"positions_m\":[[0.3,0.3]]}"
#define DOMAIN   "\"domain\":{\"x_m\":[0,1],\"y_m\":[0,0.6]}"
#define SCENARIO "{\"name\":\"one part\",\"duration_s\":1," DOMAIN "," CARGO "}"
#define BODY     "{\"scenario\":" SCENARIO ",\"label\":\"night\",\"priority\":5}"
#define BAD_BODY "{\"scenario\":{\"duration_s\":-1," DOMAIN "," CARGO "}}"
#define IS_JSON  "Content-Type: application/json\n"

/// A test that begins with an empty daemon.
#define ASK_TEST(name) cmocka_unit_test_setup_teardown(name, ask_set_up, ask_tear_down)

extern helper_daemon ask_daemon;  ///< of the test
extern api_response ask_response; ///< to the request before

/// Set up and tear down a test.
int ask_set_up(void **state);
int ask_tear_down(void **state);

/// Add a run to the daemon, helper_add_run().
helper_run *ask_add_run(run_state where);

/// Send a request; fails the test if the status of the answer is another, or a refusal is no whole
/// problem document. Arguments as of helper_request().
void ask(const char *method, const char *path, const char *query, const char *headers,
         const char *body, int status);

/// A GET.
void ask_get(const char *path, const char *query, const char *headers, int status);

/// True if the body of the answer has the text.
bool ask_body_has(const char *text);

/// Fails the test if the answer does not have the header with this value.
void ask_assert_header(const char *name, const char *value);
