/// Reading JSON documents of clients: text to a tree, values of the tree to C, faults with their
/// pointers. Reading continues after a fault, so that one pass finds all of them.
///
/// Numbers are read as doubles, whole ones too, so each is the double nearest to what was written.

#pragma once

#include "api/json/json_pointer.h"
#include "core/base/buffer.h"
#include "core/base/faults.h"
#include "core/base/status.h"

#include <stdbool.h>
#include <stddef.h>

struct json_t; ///< jansson's; only api/*.c look inside

/// Texts that a document may name by their ids instead of holding them.
typedef struct json_in_texts {
    const void *context; ///< first argument of read
    /// Append the text of an id to *out, which must be of a kind. BF_EINPUT: err->text says why the document cannot
    /// name it.
    bf_status (*read)(const void *context, const char *id, const char *kind, bf_buffer *out,
                      bf_error *err);
    size_t n_left;    ///< bytes that the document may still ask for
    bf_error failure; ///< of read, other than BF_EINPUT; code BF_OK: none
} json_in_texts;

/// The reading of one document. Begin with json_in_to().
typedef struct json_in {
    bf_faults *faults;    ///< where faults go; the caller's
    json_pointer pointer; ///< of the value that is being read
    bool has_failed;      ///< out of memory, or a failure of texts
    bool is_answer;       ///< of a service: members that no table has are ignored, and null where
                          ///< the table says what it means leaves a value as it is
    json_in_texts *texts; ///< the caller's; NULL: there are none
} json_in;

/// Seed the hashes of objects with a random number, so that nobody can choose names that collide; 0 counts as none.
/// Where this is not called the first document that is parsed takes one from /dev/urandom or, if it cannot be opened,
/// the time.
void json_in_seed(size_t seed);

/// A reading that notes faults in *faults.
json_in json_in_to(bf_faults *faults);

/// Parse n bytes. NULL: a fault was noted, or there is no memory. The caller owns the tree:
/// json_in_free(). What is not JSON at all is a fault of the whole document, pointer ""; too deep
/// nesting, a duplicate key, NaN and a number beyond double are faults where they stand. The text
/// has line and column.
struct json_t *json_in_parse(json_in *in, const char *json, size_t n);

/// Free a tree. NULL is fine.
void json_in_free(struct json_t *root);

/// The status of the reading: BF_ENOMEM or the failure of texts, else that of the first fault, else BF_OK.
BF_MUST_CHECK bf_status json_in_status(const json_in *in, bf_error *err);

/// Note a fault at the present place; control characters in the text become "?".
void json_in_fault(json_in *in, const char *format, ...) __attribute__((format(printf, 2, 3)));

/// Same for a limit that is exceeded.
void json_in_fault_limit(json_in *in, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

/// True if the value is an object (array); else a fault is noted.
bool json_in_is_object(json_in *in, const struct json_t *value);
bool json_in_is_array(json_in *in, const struct json_t *value);

/// Read a value of a type; false: a fault was noted and the output is untouched.
bool json_in_number(json_in *in, const struct json_t *value, double *ret_number);
bool json_in_bool(json_in *in, const struct json_t *value, bool *ret_bool);

/// Read a whole number from least to most, which are below 2^53 in magnitude.
bool json_in_integer(json_in *in, const struct json_t *value, double least, double most,
                     double *ret_integer);

/// Read a text of at least `least` bytes without control characters into size bytes with its
/// terminator.
bool json_in_text(json_in *in, const struct json_t *value, size_t least, size_t size,
                  char *ret_text);

/// Append the text of a kind whose id the value is to *out. False: a fault was noted, or has_failed.
bool json_in_stored_text(json_in *in, const struct json_t *value, const char *kind, bf_buffer *out);

/// Read one of the words of a NULL-terminated list as its index.
bool json_in_word(json_in *in, const struct json_t *value, const char *const *words,
                  unsigned *ret_index);

/// Read an array of least to most numbers; the numbers beyond its end stay as they are. *ret_n is
/// how many there were; NULL is fine.
bool json_in_tuple(json_in *in, const struct json_t *value, size_t least, size_t most,
                   double *ret_numbers, size_t *ret_n);
