/// Objects of JSON documents as tables: which members they have, where each lies in a C struct, and
/// their descriptions. Documents of clients are read, answers are written, and both are
/// described (JSON Schema, README) by these tables, so that adding a member is one line.

#pragma once

#include "api/json/json_in.h"
#include "api/json/json_out.h"
#include "core/base/range.h"

#include <stdbool.h>
#include <stddef.h>

typedef struct member member;
typedef struct member_table member_table;

/// In which of its forms an object is described.
typedef enum member_view {
    MEMBER_GIVEN,    ///< as a client may send it: what has a default may be missing
    MEMBER_RESOLVED, ///< a client's document with every default filled in
    MEMBER_ANSWER,   ///< as the service answers
} member_view;

/// What a member is in JSON and in C. Those of member_kinds.c serve every table; a table whose
/// member is like no other has its own.
typedef struct member_kind {
    const char *text; ///< for people, "list of numbers"; of clients' documents
    const char *type; ///< its schema as short text (schema.h); NULL: write_schema has it
    /// Read a value into the member's place in *item; NULL: it stands in answers only.
    void (*read)(json_in *in, const struct json_t *value, const member *m, void *item);
    /// Write the member's value in *item; NULL: who writes the object does it (long lists).
    void (*write)(json_out *w, const member *m, const void *item);
    /// Write the members of its schema into an object that is open; NULL: type says it all.
    void (*write_schema)(json_out *w, const member *m, member_view view);
    const struct member_element *element; ///< lists of member_lists.c: what its items are
} member_kind;

/// Flags of a member.
enum {
    MEMBER_FORM = 1,       ///< another way to say something: the table's post_read reads it, and it
                           ///< is never written
    MEMBER_OMIT_EMPTY = 2, ///< not written when empty: a list without items, an object whose count
                           ///< is 0, a number that is not finite, a text or an id of a link of no
                           ///< bytes, an enum beyond its words, false, a size or time of 0; or as
                           ///< is_empty says
    MEMBER_OPTIONAL = 4,   ///< answers: it may be missing
    MEMBER_FILE = 8,       ///< in files only: not in the document of the API
    MEMBER_SERVED = 16,    ///< its rule is false in files only: in answers it is always there
    MEMBER_INIT = 32,      ///< its default is what the table's init puts there
    MEMBER_OMIT_DEFAULT = 64, ///< with MEMBER_INIT: not written where it has its default
    MEMBER_KEPT = 128, ///< must be given, unless another member put it there: post_read finds out
};

enum { MEMBER_TEXT_SIZE = 160 }; ///< bytes of a text that is made of a member, with its terminator

/// A member of an object.
struct member {
    const char *name; ///< in the document, with its unit; NULL: the members of `table`, whose
                      ///< struct is at offset, stand in this object (a common part)
    const member_kind *kind; ///< see there
    unsigned flags;          ///< MEMBER_FORM, ...
    unsigned tags;           ///< objects with a tag: bit k: is a member under tag k; 0: always
    size_t offset;           ///< of its place in the struct, bytes
    size_t offset_n;         ///< lists, MEMBER_OMIT_EMPTY: of the size_t count; links: of the
                             ///< uint64_t for {n}
    size_t offset_list;      ///< ONE_OR_LIST: of the bool that tells a list from one object
    size_t least;            ///< lists: fewest items; texts: fewest bytes
    size_t limit;            ///< lists: most items; texts: bytes with the terminator; 0: any
    const char *unit;        ///< "m", or NULL
    const bf_range *range;   ///< or NULL: any; core checks it, except of the document's own members
    const char *default_text; ///< a default that no number or word is: JSON "[]", "{}", or text for
                              ///< people; NULL without MEMBER_INIT: a fault if it is missing
    const char *const *words; ///< ENUM: the words, NULL-terminated
    const member_table *table; ///< OBJECT, LIST, ONE_OR_LIST
    const member_table *items; ///< ONE_OR_LIST: of an item of the list
    const char *help;          ///< one phrase for people
    const char *type; ///< answers: its schema as short text if it is narrower than its kind's
    const char *null; ///< answers: what null says; NULL: it is never null
    const char *path; ///< links: "/v1/runs/{id}/parts/{n}"
    /// Answers: true if the member stands in the object that *item is, which is optional then; NULL:
    /// always.
    bool (*applies)(const void *item);
    size_t offset_if; ///< instead of `applies`: of the bool in the struct that says so; 0: none
    bool (*is_empty)(
        const void *item); ///< MEMBER_OMIT_EMPTY: says so of the object; NULL: see there
};

/// How the members of an object exclude each other.
typedef enum member_choice {
    MEMBER_ALL,      ///< they do not
    MEMBER_TAGGED,   ///< the first member is a word, the tag, that says which others there are
    MEMBER_ONE_OF,   ///< exactly one stands there; its index is an enum of the struct
    MEMBER_ONE_FORM, ///< those of exactly one of the forms stand there, as the first one of each form
                     ///< tells; the index of the form is an enum of the struct
} member_choice;

/// An object.
struct member_table {
    const char *title;     ///< "belt"; of an answer the name of its schema, "RunError"
    size_t n;              ///< members
    const member *members; ///< in the order in which they are written
    size_t size;           ///< of the struct, bytes; lists and defaults only
    member_choice choice;  ///< see there
    size_t offset_choice;  ///< MEMBER_ONE_OF, MEMBER_ONE_FORM: of the enum
    /// Where something can be given in several forms: the names of the members of each form, exactly
    /// one of which stands there; both lists end with NULL. NULL: there are no forms.
    const char *const *const *forms;
    /// Give an item its defaults, to begin the reading of one in a list and to name them; NULL: zeros.
    /// place counts where the object stands at several places with defaults of their own.
    void (*init)(void *item, size_t place);
    size_t n_places; ///< of init; 0: one
    /// Read what the member table cannot express (MEMBER_FORM); NULL: nothing.
    void (*post_read)(json_in *in, const struct json_t *object, void *item);
};

/// A row of a table: MEMBER("t_s", number, offsetof(s, t), "Its time", .unit = "s"), with a kind of its
/// own, or for the members of another table; and a table of the rows of an array.
#define MEMBER(name_, kind_, offset_, ...) MEMBER_OF(name_, &member_##kind_, offset_, __VA_ARGS__)
#define MEMBER_OF(name_, kind_, offset_, ...)                                                      \
    {                                                                                              \
        .name = (name_), .kind = (kind_), .offset = (offset_), .help = __VA_ARGS__                 \
    }
#define MEMBER_INLINE(table_, offset_)                                                             \
    {                                                                                              \
        .table = (table_), .offset = (offset_)                                                     \
    }
#define MEMBER_TABLE(title_, array)                                                                \
    .title = (title_), .members = (array), .n = sizeof(array) / sizeof *(array)

/// The kinds, with what lies at the member's offset.
extern const member_kind member_number;   ///< number: double; not finite: null
extern const member_kind member_measure;  ///< number_round() of a double; not finite: null; answers
extern const member_kind member_degrees;  ///< number: double in radians
extern const member_kind member_step;     ///< number, not 0, or "auto": double, 0 for "auto"
extern const member_kind member_count;    ///< whole number: uint32_t
extern const member_kind member_seed;     ///< whole number below 2^53: uint64_t
extern const member_kind member_whole;    ///< whole number below 2^53: double
extern const member_kind member_int;      ///< whole number within the member's range: int
extern const member_kind member_size;     ///< whole number below 2^53: uint64_t; answers
extern const member_kind member_bool;     ///< boolean: bool
extern const member_kind member_flag;     ///< boolean: double, 1 or 0
extern const member_kind member_text;     ///< string: char[limit]
extern const member_kind member_string;   ///< string: const char *, NULL: null; answers
extern const member_kind member_enum;     ///< one of words: an enum, its index
extern const member_kind member_either;   ///< one of two words: bool, true for the second
extern const member_kind member_point;    ///< [x, y]: two doubles
extern const member_kind member_interval; ///< [from, to]: two doubles
extern const member_kind member_numbers;  ///< list of numbers: pointer to doubles, and a count
extern const member_kind member_angles;   ///< the same: radians
extern const member_kind member_numbers_or_null; ///< list of numbers or null: the same; NAN
extern const member_kind member_angles_or_null;  ///< the same: radians; NAN
extern const member_kind member_flags;           ///< list of booleans: pointer to doubles, 1 or 0
extern const member_kind member_counts;          ///< list of whole numbers: pointer to uint32_t
extern const member_kind member_line;            ///< [[x, y], [x, y]]: vec2[2]
extern const member_kind member_points;          ///< list of [x, y]: pointer to vec2, and a count
extern const member_kind member_outline;     ///< list of [x, y]: pointer to triples, and a count
extern const member_kind member_vertices;    ///< list of [x, y, z]: pointer to triples, and a count
extern const member_kind member_poses;       ///< list of [x, y] or [x, y, degrees]: pointer to
                                             ///< scene_pose, and a count
extern const member_kind member_object;      ///< object: a struct described by table
extern const member_kind member_list;        ///< list of objects: pointer to structs described by
                                             ///< table, and a count
extern const member_kind member_one_or_list; ///< object, or list of objects: structs in place,
                                             ///< described by table where there is one object and
                                             ///< by items where there is a list, and a count
extern const member_kind member_array;       ///< list of objects: structs in place, and a count
extern const member_kind member_time;        ///< string: int64_t, Unix time in ms, 0: null; answers
extern const member_kind member_raw;         ///< JSON text: const char *, and its bytes; answers
extern const member_kind member_shape;       ///< [rows, columns]: of a bf_grid; answers
extern const member_kind member_link; ///< path of a resource: its {id} is the char[] at offset, its
                                      ///< {n} the uint64_t at offset_n; answers
extern const member_kind member_described; ///< anything that its object's writer writes; answers

/// Read an object into its struct. Members that are missing leave their place as it was, faults
/// are noted and leave it too. What lists own is allocated and put into the struct, with faults too.
void members_read(json_in *in, const struct json_t *value, const member_table *table, void *item);

/// Write an object; or its members into an object that is open.
void members_write(json_out *w, const member_table *table, const void *item);
void members_write_into(json_out *w, const member_table *table, const void *item);

/// True if a member of a client's document may be missing.
bool members_has_default(const member *m);

/// The unit of the number that a JSON pointer below a table's object names; NULL: it has none, as a list by itself, or no
/// table tells.
const char *members_unit(const member_table *table, const char *pointer);

/// The default for people ("0.005", "inflow"), "" if there is none, and the range ("> 0"), "" if it
/// is any, in MEMBER_TEXT_SIZE bytes. False: there is no memory, and the text is "".
bool members_default_text(const member_table *table, const member *m, char *ret_text);
void members_range_text(const bf_range *range, char *ret_text);

/// Write the reference to the schema of a table's object.
void members_write_ref(json_out *w, const member_table *table, member_view view);

/// Copy the name of that schema, "Belt" or "ResolvedBelt", to ret_name (MEMBER_TEXT_SIZE bytes).
void members_schema_name(const member_table *table, member_view view, char *ret_name);
