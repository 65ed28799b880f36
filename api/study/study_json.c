#include "api/study/study_json.h"

#include "api/results/run_json.h"
#include "api/study/study_document.h"

#include <string.h>

#define AT(place)                 offsetof(api_study, place)
#define ENDED(name, state, help_) MEMBER(name, size, AT(n_ended[state]), help_)
static const member trials_members[] = {
    MEMBER("limit", size, AT(trials_max), "Most trials"),
    MEMBER("begun", size, AT(n_trials), "Made so far; those that have not ended wait or run"),
    ENDED("succeeded", API_TRIAL_SUCCEEDED, "Ended with values"),
    ENDED("failed", API_TRIAL_FAILED, "Their runs failed"),
    ENDED("infeasible", API_TRIAL_INFEASIBLE, "Their scenarios are not valid"),
    ENDED("pruned", API_TRIAL_PRUNED, "Stopped, as they could not become the best any more"),
    ENDED("cancelled", API_TRIAL_CANCELLED, "Cancelled, with the study or by themselves"),
};
const member_table study_json_trials = { MEMBER_TABLE("StudyTrials", trials_members) };

#define LINK(name, path_, help_) MEMBER(name, link, AT(id), help_, .path = "/v1/studies/{id}" path_)
static const member link_members[] = {
    LINK("self", "", "The study"),
    LINK("document", "/document", "What was submitted, with what it named by ids"),
    LINK("trials", "/trials", "Its trials so far"),
    LINK("best", "/best", "What it found so far"),
    LINK("events", "/events", "Its event stream"),
    LINK("pause", "/pause", "POST here to begin no further trial"),
    LINK("resume", "/resume", "POST here to go on"),
    LINK("cancel", "/cancel", "POST here to end it"),
};
const member_table study_json_links = { MEMBER_TABLE("StudyLinks", link_members) };

static const member study_members[] = {
    MEMBER("id", text, AT(id), "Identifier of the study", .type = "#Id"),
    MEMBER("status", enum, AT(state), "State of the study", .words = api_study_state_words,
           .type = "#StudyStatus"),
    MEMBER("name", text, AT(name), "For people; empty if none was given"),
    MEMBER("line", text, AT(line), "The line that it belongs to", .flags = MEMBER_OMIT_EMPTY),
    MEMBER("method", enum, AT(method), "How its points are chosen", .words = study_document_methods,
           .type = "#StudyMethodWord"),
    MEMBER("model", enum, AT(model), "Which solver its base asks for", .words = run_model_words,
           .type = "#Model"),
    MEMBER("priority", int, AT(priority), "Studies of higher priority come first"),
    MEMBER("created_at", time, AT(created_ms), "When it was accepted"),
    MEMBER("started_at", time, AT(started_ms), "When it was first started", .null = "never"),
    MEMBER("finished_at", time, AT(finished_ms), "When it ended", .null = "not yet"),
    MEMBER_OF("error", &run_json_error_kind, AT(error), "Why it failed", .null = "it did not"),
    MEMBER("suspect", bool, AT(is_suspect),
           "The results of one of its trials may be wrong, and so may be what it says: true, or "
           "missing",
           .flags = MEMBER_OMIT_EMPTY),
    MEMBER("owner", text, AT(owner), "Whose it is, where the service has tokens",
           .flags = MEMBER_OMIT_EMPTY),
    MEMBER("trials", object, 0, "How many trials it has", .table = &study_json_trials),
    MEMBER("links", object, 0, "Its resources", .table = &study_json_links),
};
const member_table study_json = { MEMBER_TABLE("Study", study_members), .size = sizeof(api_study) };
#undef AT

static const member list_members[] = {
    MEMBER("studies", array, offsetof(api_page, studies), "A page of the list, newest first",
           .offset_n = offsetof(api_page, n), .table = &study_json),
    MEMBER("has_more", bool, offsetof(api_page, has_more), "Older ones follow"),
    MEMBER("next_cursor", text, offsetof(api_page, next_cursor),
           "The `cursor` of the page that follows", .flags = MEMBER_OMIT_EMPTY),
};
const member_table study_json_list = { MEMBER_TABLE("StudyList", list_members) };

bf_status study_json_write(const api_study *about, bf_buffer *out, bf_error *err)
{
    json_out w = json_out_to(out);

    members_write(&w, &study_json, about);
    return json_out_status(&w, err);
}
