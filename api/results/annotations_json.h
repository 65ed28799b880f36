/// Changes of what users call a run or a study and note of it, as a JSON Merge Patch (RFC 7396): a member that is missing
/// leaves what it names as it is, and null empties it.

#pragma once

#include "api/json/members.h"
#include "api/services.h"

extern const member_table annotations_json_run;   ///< name, label, line, notes and starred
extern const member_table annotations_json_study; ///< name and line

/// Change *annotations by n bytes of a patch. BF_EINPUT: faults tell the places, and *annotations is as before.
BF_MUST_CHECK bf_status annotations_json_read(const char *json, size_t n, const member_table *table,
                                              api_annotations *annotations, bf_faults *faults,
                                              bf_error *err);
