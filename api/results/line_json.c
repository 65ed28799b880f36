#include "api/results/line_json.h"

#define AT(place) offsetof(api_line, place)
static const member item_members[] = {
    MEMBER("line", text, AT(line), "What it is called"),
    MEMBER("owner", text, AT(owner), "Whose it is, where the service has tokens",
           .flags = MEMBER_OMIT_EMPTY),
    MEMBER("versions", size, AT(n_versions), "The greatest version of its runs; 0: it has none"),
    MEMBER("runs", size, AT(n_runs), "Its runs without trials"),
    MEMBER("studies", size, AT(n_studies), "Its studies"),
    MEMBER("newest_run", text, AT(newest_run), "Its newest run, where it has one", .type = "#Id",
           .flags = MEMBER_OMIT_EMPTY),
    MEMBER("used_at", time, AT(used_ms), "When its newest run or study was accepted"),
};
const member_table line_json_item = { MEMBER_TABLE("Line", item_members),
                                      .size = sizeof(api_line) };
#undef AT

#define AT(place) offsetof(api_page, place)
static const member list_members[] = {
    MEMBER("lines", array, AT(lines), "A page of the list, the last used one first",
           .offset_n = AT(n), .table = &line_json_item),
    MEMBER("has_more", bool, AT(has_more), "Lines used earlier follow"),
    MEMBER("next_cursor", text, AT(next_cursor), "The `cursor` of the page that follows",
           .flags = MEMBER_OMIT_EMPTY),
};
const member_table line_json_list = { MEMBER_TABLE("LineList", list_members) };
#undef AT
