/// JSON Schema (draft 2020-12, as in OpenAPI 3.1), written from types as short texts:
///
///     number integer string boolean object   as in JSON Schema
///     #Name                                  a reference to /components/schemas/Name
///     =word                                  this string and no other
///     [T]  [T 3]  [T 1-32]                   list of T; of 3 of them; of 1 to 32
///     T?                                     T or null

#pragma once

#include "api/json/json_out.h"

#include <stddef.h>

/// Write an object {..., "description": help} for a type. limits are JSON members that narrow it,
/// "\"minimum\":0"; limits and help may be NULL.
void schema_write(json_out *w, const char *type, const char *limits, const char *help);

/// Write into an object that is open: the members of a schema for a type; limits, if not NULL; a
/// reference to a component of a kind ("schemas"), its name being of n bytes.
void schema_write_members(json_out *w, const char *type);
void schema_write_limits(json_out *w, const char *limits);
void schema_write_ref(json_out *w, const char *kind, const char *name, size_t n);

/// Write a list of strings, the words of a text.
void schema_write_words(json_out *w, const char *words);

/// Move *words to the next word and return its length; 0: there is none.
size_t schema_next_word(const char **words);
