/// Objects of a document as tables: which members they have, where each lies in a C struct, and
/// what a person must know of it. Reading and writing go by these tables, so that adding a member
/// is one line; the README's list is compared with them.

#pragma once

#include "api/json/json_in.h"
#include "api/json/json_out.h"

#include <stdbool.h>
#include <stddef.h>

/// What a member is in JSON and in C.
typedef enum member_kind {
    MEMBER_NUMBER,   ///< number: double
    MEMBER_STEP,     ///< number, not 0, or "auto": double, 0 for "auto"
    MEMBER_COUNT,    ///< whole number: uint32_t
    MEMBER_SEED,     ///< whole number below 2^53: uint64_t
    MEMBER_PRIORITY, ///< whole number within the member's range: int
    MEMBER_BOOL,     ///< boolean: bool
    MEMBER_TEXT,     ///< string: char[limit]
    MEMBER_WORD,     ///< one of words: an enum, its index
    MEMBER_POINT,    ///< [x, y]: two doubles
    MEMBER_INTERVAL, ///< [from, to]: two doubles
    MEMBER_NUMBERS,  ///< list of numbers: pointer to doubles, and a count
    MEMBER_POINTS,   ///< list of [x, y]: pointer to pairs of doubles, and a count
    MEMBER_OUTLINE,  ///< list of [x, y]: pointer to triples of doubles, and a count
    MEMBER_VERTICES, ///< list of [x, y, z]: the same
    MEMBER_POSES,    ///< list of [x, y] or [x, y, degrees]: pointer to scene_pose, and a count
    MEMBER_OBJECT,   ///< object: a struct described by table
    MEMBER_LIST,     ///< list of objects: pointer to structs described by table, and a count
    MEMBER_MIX,      ///< object, or list of objects: structs in place, described by table where
                     ///< there is one object and by items where there is a list, and a count
    MEMBER_KIND_COUNT
} member_kind;

/// Flags of a member.
enum {
    MEMBER_FORM = 1, ///< another form of giving something: the table's finish reads it, and it
                     ///< is never written
    MEMBER_OMIT_EMPTY = 2, ///< a list that is not written when it has no items
};

/// Which numbers are in range. Core checks it, except for the document's own members.
typedef struct member_range {
    const char *text;  ///< for people, "> 0"
    double minimum;    ///< smallest, -INFINITY: any
    double maximum;    ///< largest, INFINITY: any
    bool excludes_min; ///< minimum itself is out of range
    bool excludes_max; ///< maximum itself is out of range
} member_range;

typedef struct member_table member_table;

/// A member of an object.
typedef struct member {
    const char *name;          ///< in the document, with its unit
    member_kind kind;          ///< see there
    unsigned flags;            ///< MEMBER_FORM, MEMBER_OMIT_EMPTY
    unsigned tags;             ///< objects with a tag: bit k: is a member under tag k; 0: always
    size_t offset;             ///< of its place in the struct, bytes
    size_t offset_n;           ///< lists: of the size_t count
    size_t offset_list;        ///< MEMBER_MIX: of the bool that tells a list from one object
    size_t least;              ///< lists: fewest items; texts: fewest bytes
    size_t limit;              ///< lists: most items; texts: bytes with the terminator
    const char *unit;          ///< "m", or NULL
    const member_range *range; ///< or NULL: any
    const char *standard;      ///< the default as text; NULL: none, a fault if it is missing
    const char *const *words;  ///< MEMBER_WORD: the words, NULL-terminated
    const member_table *table; ///< MEMBER_OBJECT, MEMBER_LIST, MEMBER_MIX
    const member_table *items; ///< MEMBER_MIX: of an item of the list
    const char *help;          ///< one phrase for people
} member;

/// How the members of an object exclude each other.
typedef enum member_choice {
    MEMBER_ALL,    ///< they do not
    MEMBER_TAGGED, ///< the first member is a word, the tag, that says which others there are
    MEMBER_ONE_OF, ///< exactly one stands there; its index is an enum of the struct
} member_choice;

/// An object.
struct member_table {
    const char *title;     ///< "belt"
    size_t n;              ///< members
    const member *members; ///< in the order in which they are written
    size_t size;           ///< of the struct, bytes; lists only
    member_choice choice;  ///< see there
    size_t offset_choice;  ///< MEMBER_ONE_OF: of the enum
    /// Where something can be given in several forms: the names of the members of each form, exactly
    /// one of which stands there; both lists end with NULL. NULL: there are no forms.
    const char *const *const *forms;
    /// Give an item of a list its defaults before it is read; NULL: zeros.
    void (*begin)(void *item);
    /// Read what the members cannot say (MEMBER_FORM); NULL: nothing.
    void (*finish)(json_in *in, const struct json_t *object, void *item);
};

/// Read an object into its struct. Members that are missing leave their place as it was, faults
/// are noted and leave it too. What lists own is allocated and put into the struct, with faults too.
void members_read(json_in *in, const struct json_t *value, const member_table *table, void *item);

/// Read one member's value into its place.
void members_read_value(json_in *in, const struct json_t *value, const member *m, void *item);

/// Write an object.
void members_write(json_out *w, const member_table *table, const void *item);

/// True if the member can stand in the object that *item is (by its tag or its choice).
bool members_applies(const member_table *table, const member *m, const void *item);
