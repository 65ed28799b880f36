/// The columns of a run's curve, from one table: names for files and resources, values for samples.
///
///     the counters, by their ids        parts inside
///     left_domain                       parts that left the domain since t = 0
///     fallen                            parts that fell off the belts since t = 0; where scene.may_drop
///     <feed>.offered, .admitted, .waiting, .discarded    of each feed, see feed_balance
///     <photo eye>.blocked               of each photo eye: 1 or 0
///     <belt>.speed_m_s                  of each belt that belt_range_may_change(), along its direction
///     <failure>.failed                  of each kind of failure: 1 while the belt is down by it, or 0
///     <belt>.left                       parts that left the domain from it since t = 0; of each outlet, where there are several, or sinks
///     <sink>.taken                      parts that the sink took since t = 0; of each sink
///
/// Names are unique: columns_check().

#pragma once

#include "core/base/faults.h"
#include "core/feed/balance.h"
#include "core/scene/scene.h"

#include <stdbool.h>
#include <stddef.h>

enum {
    COLUMN_NAME_SIZE = SCENE_ID_SIZE + 16, ///< bytes of a name with its terminator
    COLUMNS_OF_FEED = 4,                   ///< columns of each feed
};

/// How many columns there are.
size_t columns_count(const scene *s);

/// The name of column k into ret_name, which has COLUMN_NAME_SIZE bytes.
void columns_name(const scene *s, size_t k, char *ret_name);

/// True if the column counts parts since t = 0, so that it only rises: what is offered, admitted and discarded, what left, and what was taken.
/// Other columns of a scene with feeds rise and fall.
bool columns_is_count(const char *name);

/// Write the columns of a feed's balance.
void columns_put_feed(const feed_balance *balance, double *ret_values);

/// Note counters whose ids are the names of other columns.
void columns_check(const scene *s, bf_faults *faults);
