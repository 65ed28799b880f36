/// What is said about the results of a scenario before it is solved (core/advice/advice.h), as JSON:
/// in the answer of POST /v1/validate and, the same once more, in the summary of a run.

#pragma once

#include "api/json/members.h"
#include "core/advice/advice.h"

/// The validity of a model, scenes that are alike, and an item of it; the structs are validity, validity_like and
/// validity_item.
extern const member_table review_validity_members;
extern const member_table review_like_members;
extern const member_table review_outside_members;

/// A warning; the struct is warning.
extern const member_table review_warning_members;

/// Write the warnings as a list of texts, each with title and meaning.
void review_write_texts(json_out *w, const review_warnings *of);
