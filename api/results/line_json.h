/// Lines as JSON: a page of them.

#pragma once

#include "api/json/members.h"
#include "api/page.h"

extern const member_table line_json_item; ///< of an api_line
extern const member_table line_json_list; ///< of an api_page
