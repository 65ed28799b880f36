/// Conditional requests (RFC 9110, 13): lists of entity tags against the tag of a resource.
///
/// A tag here is that of the plain representation, without quotes. The tags of its encoded forms
/// (coding.h) name the same state.

#pragma once

#include "api/http/coding.h"

#include <stdbool.h>

/// True if If-None-Match names the state: `*`, or by weak comparison the tag of the plain or of an
/// encoded form that the client accepts (accept_encoding may be NULL). *ret_tag (CODING_TAG_SIZE
/// bytes) is then the tag that the client has sent.
bool precondition_match_etag(const char *if_none_match, const char *tag,
                             const char *accept_encoding, char *ret_tag);

/// True if If-Match allows a change of this state: `*`, or by strong comparison the tag of any form.
bool precondition_holds(const char *if_match, const char *tag);
