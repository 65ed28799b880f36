/// The choice between representations by the Accept header (RFC 9110, 12.5.1).

#pragma once

#include <stddef.h>

/// The media type among offers with the highest q-value, the first one of those with the same. For each offer the most specific range counts (type/subtype before type/*
/// before */*); parameters other than q are ignored. header NULL or "" accepts everything; a
/// member that cannot be read accepts nothing. Returns its index, or -1 if none is acceptable.
int accept_choose(const char *header, const char *const *offers, size_t n_offers);

/// The q-value of a token in a list such as "gzip;q=0.8, *;q=0", in thousandths: of its own member, else
/// of `*`; -1 if neither is there. Members that cannot be read are ignored.
int accept_token_quality(const char *header, const char *token);
