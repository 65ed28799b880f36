/// Profiles and lists of arrivals as CSV: a header with the names of columns, then rows.
///
///     t_s,rate_per_s      or rate_per_h: the profile's rate at these times
///     t_s,count           parts from each time to the next; the last row lasts as long as the one before it, and no
///                         part arrives before the first time and after that
///     t_s,...             a list of arrivals, with any of: count, kind (id), x_m or y_m (place on the feed's line),
///                         heading_deg; an empty place or heading is one that is not given
///
/// Lines end with LF or CRLF; fields are not quoted. A fault is noted at the reading's present place, and its text names
/// the line, from 1; of a text that is the whole document it is noted at "/line/<number>". What follows is not read.

#pragma once

#include "api/json/json_in.h"
#include "core/scene/scene.h"

/// What a text alone says.
typedef struct feed_csv_about {
    size_t n;       ///< rows
    double t_start; ///< time of the first one, s
    double t_end;   ///< of the last one
} feed_csv_about;

/// Check a text that is the whole document; of a list of arrivals kinds and places are looked up only when a scenario
/// reads it. True: *ret_about is filled. False: a fault was noted, or
/// there is no memory.
bool feed_csv_check_profile(json_in *in, const char *text, feed_csv_about *ret_about);
bool feed_csv_check_schedule(json_in *in, const char *text, feed_csv_about *ret_about);

/// Read a profile; its times are put into *profile, to be freed with it.
void feed_csv__read_profile(json_in *in, const char *text, scene_series *profile);

/// Read the list of arrivals of a feed whose line is resolved, into feed->schedule. s NULL: kinds and places are not
/// looked up.
void feed_csv__read_schedule(json_in *in, const char *text, const scene *s, scene_feed *feed);
