#include "api/results/run_json.h"

#include <string.h>

enum { USUAL_BYTES = 2048 }; // of a run with its links, so that the answer need not grow

static void write_status_word(json_out *w, const member *m, const void *item)
{
    bf_status code;

    memcpy(&code, (const char *)item + m->offset, sizeof code);
    json_out_string(w, bf_status_word(code));
}

static const member_kind member_status_word = { .type = "#ErrorCode", .write = write_status_word };

#define AT(place) offsetof(bf_error, place)
static const member error_members[] = {
    MEMBER("code", status_word, AT(code), "Kind of failure"),
    MEMBER("pointer", text, AT(pointer), "Place in the scenario; empty if there is none",
           .type = "#JsonPointer"),
    MEMBER("detail", text, AT(text), "What happened, for people"),
};
const member_table run_json_error = { MEMBER_TABLE("RunError", error_members) };
#undef AT

static void write_error(json_out *w, const member *m, const void *item)
{
    const bf_error *error = (const bf_error *)(const void *)((const char *)item + m->offset);

    if (error->code == BF_OK)
        json_out_null(w);
    else
        members_write(w, &run_json_error, error);
}

const member_kind run_json_error_kind = { .type = "#RunError", .write = write_error };

static void write_figures(json_out *w, const member *m, const void *item)
{
    const api_run *record = item;

    (void)m;
    json_out_raw(w, record->figures, strlen(record->figures));
}

static const member_kind member_figures = { .type = "#RunFigures", .write = write_figures };

static bool has_figures(const void *item)
{
    const api_run *record = item;

    return record->figures[0] != '\0';
}

static bool has_parts(const void *item)
{
    const api_run *record = item;

    return record->model == RUN_MICRO;
}

#define AT(place) offsetof(api_run, place)
#define LINK(name, path_, ...)                                                                     \
    MEMBER(name, link, AT(id), __VA_ARGS__, .path = "/v1/runs/{id}" path_)
static const member link_members[] = {
    LINK("self", "", "The run"),
    LINK("scenario", "/scenario", "Its resolved scenario"),
    LINK("summary", "/summary", "Its summary, once it has ended"),
    LINK("curve", "/curve", "Its outflow curve so far"),
    LINK("key_figures", "/key_figures", "Its key figures so far"),
    LINK("snapshots", "/snapshots", "Its snapshots so far"),
    LINK("series", "/snapshots.pvd", "Its snapshots in time, for ParaView"),
    LINK("parts_series", "/parts.pvd", "Its parts in time, for ParaView (microscopic model)",
         .applies = has_parts),
    LINK("results", "/results.zip", "All its results in one archive, once it has ended"),
    LINK("events", "/events", "Its event stream"),
    LINK("cancel", "/cancel", "POST here to stop it"),
    MEMBER("study", link, AT(study), "The study whose trial it is", .path = "/v1/studies/{id}",
           .flags = MEMBER_OMIT_EMPTY),
};
const member_table run_json_links = { MEMBER_TABLE("RunLinks", link_members) };

static const member run_members[] = {
    MEMBER("id", text, AT(id), "Identifier of the run", .type = "#Id"),
    MEMBER("status", enum, AT(state), "State of the run", .words = run_state_words,
           .type = "#RunStatus"),
    MEMBER("progress", measure, AT(progress), "Completed fraction of the simulated time",
           .type = "#Share"),
    MEMBER("model", enum, AT(model), "Which solver", .words = run_model_words, .type = "#Model"),
    MEMBER("closure", text, AT(closure),
           "Closure of the macroscopic model, as in the scenario; missing in runs of versions that "
           "did not say so",
           .flags = MEMBER_OMIT_EMPTY),
    MEMBER("label", text, AT(label), "The client's own name of the run; empty if none was given"),
    MEMBER("priority", int, AT(priority), "Runs of higher priority are solved first"),
    MEMBER("name", text, AT(name), "Name of the scenario, unless it was renamed"),
    MEMBER("line", text, AT(line), "The line that it belongs to", .flags = MEMBER_OMIT_EMPTY),
    MEMBER("line_version", size, AT(line_version),
           "Which of the line's scenarios it has, from 1 in the order of their first use; names do "
           "not count",
           .flags = MEMBER_OMIT_EMPTY),
    MEMBER("notes", text, AT(notes), "What its users noted of it", .flags = MEMBER_OMIT_EMPTY),
    MEMBER("starred", bool, AT(is_starred), "Its users want to find it again: true, or missing",
           .flags = MEMBER_OMIT_EMPTY),
    MEMBER("created_at", time, AT(created_ms), "When it was accepted"),
    MEMBER("started_at", time, AT(started_ms), "When it was last started", .null = "never"),
    MEMBER("finished_at", time, AT(finished_ms), "When it ended", .null = "not yet"),
    MEMBER("predicted_s", measure, AT(predicted_s),
           "CPU time that it will take on one core of the service's machine, while it waits",
           .unit = "s", .null = "not known yet, or it waits no longer"),
    MEMBER("eta_s", measure, AT(eta_s), "Remaining wall time", .unit = "s", .null = "not known"),
    MEMBER_OF("error", &run_json_error_kind, AT(error), "Why it failed", .null = "it did not"),
    MEMBER("owner", text, AT(owner), "Whose it is, where the service has tokens",
           .flags = MEMBER_OMIT_EMPTY),
    MEMBER("study", text, AT(study), "The study whose trial it is", .type = "#Id",
           .flags = MEMBER_OMIT_EMPTY),
    MEMBER("cached", bool, AT(is_cached), "Its results were known from an earlier run"),
    MEMBER("suspect", bool, AT(is_suspect),
           "Its results may be wrong, as the worker that sent them sent wrong ones, or another one "
           "has others; the same scenario is solved anew. True, or missing",
           .flags = MEMBER_OMIT_EMPTY),
    MEMBER("key_figures", figures, 0,
           "Its key figures so far, without those of feeds, counters and photo eyes",
           .applies = has_figures),
    MEMBER("links", object, 0, "Its resources", .table = &run_json_links),
};
const member_table run_json = { MEMBER_TABLE("Run", run_members), .size = sizeof(api_run) };
#undef AT

static const member list_members[] = {
    MEMBER("runs", array, offsetof(api_run_list, runs),
           "A page of the list, newest first unless `sort` says otherwise",
           .offset_n = offsetof(api_run_list, n), .table = &run_json),
    MEMBER("total", size, offsetof(api_run_list, total),
           "With `count`: runs on all pages, of the newest 50,000",
           .offset_if = offsetof(api_run_list, has_total)),
    MEMBER("has_more", bool, offsetof(api_run_list, has_more),
           "Further ones may follow: this page looked at 20,000 runs at most"),
    MEMBER("next_cursor", text, offsetof(api_run_list, next_cursor),
           "The `cursor` of the page that follows", .flags = MEMBER_OMIT_EMPTY),
};
const member_table run_json_list = { MEMBER_TABLE("RunList", list_members) };

bf_status run_json_write(const api_run *record, bf_buffer *out, bf_error *err)
{
    json_out w = json_out_to(out);

    if (buffer_reserve(out, USUAL_BYTES) == NULL)
        return bf_fail_memory(err);
    members_write(&w, &run_json, record);
    return json_out_status(&w, err);
}
