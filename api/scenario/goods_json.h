/// Usual goods and the frictions of surfaces as JSON and as text, from the tables of core/scene/goods.h.

#pragma once

#include "api/json/members.h"
#include "core/base/buffer.h"

/// What GET /v1/goods answers, and an item of each of its lists.
extern const member_table goods_json_members;
extern const member_table goods_json_item;
extern const member_table goods_json_surface;
extern const member_table goods_json_friction;

/// Append the answer of GET /v1/goods.
BF_MUST_CHECK bf_status goods_json_write(bf_buffer *out, bf_error *err);

/// Append the same as Markdown: a table of goods and one of frictions.
BF_MUST_CHECK bf_status goods_json_write_text(bf_buffer *out, bf_error *err);
