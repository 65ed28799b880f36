/// The choice between representations by the Accept header (RFC 9110, 12.5.1).

#pragma once

#include <stddef.h>

/// The media type among offers that the client wants most: by q-value, and where those are equal the
/// first of the offers. For each offer the most specific range counts (type/subtype before type/*
/// before */*); parameters other than q are passed over. header NULL or "" accepts everything; a
/// member that cannot be read accepts nothing. Returns its index, or -1 if none is acceptable.
int accept_choose(const char *header, const char *const *offers, size_t n_offers);

/// What a list of tokens with q-values ("gzip;q=0.8, *;q=0") thinks of one of them, in thousandths: by
/// its own member, else by `*`; -1 if neither is there. A member that cannot be read says nothing.
int accept_token_quality(const char *header, const char *token);
