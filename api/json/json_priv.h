/// Private to api/json: what the kinds of members share.

#pragma once

#include "api/json/members.h"

#include <string.h>

/// Where a member's value lies in its struct, and the count of a list.
static inline void *member__place(void *item, const member *m)
{
    return (char *)item + m->offset;
}

static inline const void *member__value(const void *item, const member *m)
{
    return (const char *)item + m->offset;
}

static inline size_t member__count(const void *item, const member *m)
{
    size_t n;

    memcpy(&n, (const char *)item + m->offset_n, sizeof n);
    return n;
}

/// The items of a list whose pointer lies at the member's place.
const void *member__items(const void *item, const member *m);

/// True if the value is a list of neither too few nor too many items, known before anything is
/// allocated; else a fault is noted.
bool member__check_list(json_in *in, const struct json_t *value, const member *m);

/// Room for n items of a list, put into the struct at once with their count, so that it is freed with
/// it. NULL: no memory.
void *member__allocate(json_in *in, const member *m, size_t n, size_t size, void *item);

/// Write the type and the bounds of a number, of which the C type holds at most `most`; the length of a
/// list.
void member__describe_bounded(json_out *w, const char *type, const member *m, double most);
void member__describe_length(json_out *w, const member *m);
