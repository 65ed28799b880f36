#include "api/results/line_json.h"

#define AT(place) offsetof(api_line, place)
static bool has_owner(const void *item)
{
    const api_line *line = item;

    return line->owner[0] != '\0';
}

static bool has_run(const void *item)
{
    const api_line *line = item;

    return line->newest_run[0] != '\0';
}

static const member item_members[] = {
    MEMBER("line", text, AT(line), "What it is called"),
    MEMBER("owner", text, AT(owner), "Whose it is, where the service has tokens",
           .applies = has_owner),
    MEMBER("versions", size, AT(n_versions), "The greatest version of its runs; 0: it has none"),
    MEMBER("runs", size, AT(n_runs), "Its runs without trials"),
    MEMBER("studies", size, AT(n_studies), "Its studies"),
    MEMBER("newest_run", text, AT(newest_run), "Its newest run, where it has one", .type = "#Id",
           .applies = has_run),
    MEMBER("used_at", time, AT(used_ms), "When its newest run or study was accepted"),
};
const member_table line_json_item = { MEMBER_TABLE("Line", item_members),
                                      .size = sizeof(api_line) };
#undef AT

#define AT(place) offsetof(api_line_list, place)
static bool has_more(const void *item)
{
    const api_line_list *list = item;

    return list->has_more;
}

static const member list_members[] = {
    MEMBER("lines", array, AT(items), "A page of the list, the last used one first",
           .offset_n = AT(n), .table = &line_json_item),
    MEMBER("has_more", bool, AT(has_more), "Lines used earlier follow"),
    MEMBER("next_cursor", text, AT(next_cursor), "The `cursor` of the page that follows",
           .applies = has_more),
};
const member_table line_json_list = { MEMBER_TABLE("LineList", list_members) };
#undef AT
