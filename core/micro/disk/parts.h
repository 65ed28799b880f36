/// Parts seen from outside of steps: they enter, are read and measured, saved and loaded.

#pragma once

#include "core/micro/disk/disk_priv.h"

/// Give all arrays room for a number of parts, more than now. The list stays usable, but not for steps. BF_ENOMEM: s
/// is as before.
BF_MUST_CHECK bf_status disk__resize(disk_state *s, size_t capacity);

/// The slot that stands for no part with room for a number of parts: behind them and their padding.
static inline uint32_t disk__void_slot(size_t capacity)
{
    return (uint32_t)((capacity / DISK_GROUP + 2) * DISK_GROUP);
}

/// The record of a part that left after the last list was made, or NULL.
disk_border_part *disk__find_left(const disk_state *s, uint32_t slot);

/// Members of micro_backend.
bf_status disk__admit(void *state, size_t k, const micro_arrival *arrival, bf_error *err);
void disk__take_out(void *state, size_t k);
void disk__forget_gone(void *state);
micro_extent disk__extent(const void *state, size_t k);
micro_part disk__part(const void *state, size_t k);
micro_totals disk__measure(const void *state);
void disk__save(const void *state, checkpoint_writer *w);
bf_status disk__load(void *state, size_t n, checkpoint_reader *r, bf_error *err);

/// What is counted of contacts.
typedef struct disk_contacts {
    micro_totals totals; ///< their number, and the largest overlaps
    micro_press press;   ///< the largest overlap_share
} disk_contacts;

/// Count a contact of the part in a slot with another one, by its id, UINT64_MAX for the boundary, if it overlaps, m; radius is
/// the smaller one, m.
void disk__count_contact(const disk_state *s, size_t slot, uint64_t other, double overlap,
                         double radius, disk_contacts *all);
