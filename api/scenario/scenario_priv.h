/// Private to api/scenario.

#pragma once

#include "api/json/json_in.h"
#include "api/json/members.h"
#include "api/scenario/examples.h"
#include "core/run/run.h"
#include "core/scene/scene.h"

/// Resolve and check a scenario whose members were read from the document. Faults are pointed at from the
/// reading's present place. False: faults were noted, or there is no memory.
bool scenario__complete(json_in *in, const struct json_t *document, scene *s);

/// Check a complete scenario for a model; faults as above.
void scenario__check_model(json_in *in, const scene *s, run_model model);

/// A number of core's limits.h in a text.
#define TEXT_OF(number)    TEXT_OF_IT(number)
#define TEXT_OF_IT(number) #number

/// The words of an enum of n values.
#define HAS_WORDS(words, n)                                                                        \
    _Static_assert(sizeof(words) / sizeof *(words) == (n) + 1, "a word each")

/// The shape of a kind of cargo; its struct is scene_shape.
extern const member_table scenario__shape_members;

/// Belts, feeds, photo eyes, sinks, actions and merges; the structs are core's.
extern const member_table scenario__belt_members;
extern const member_table scenario__feed_members;
extern const member_table scenario__photo_eye_members;
extern const member_table scenario__sink_members;
extern const member_table scenario__action_members;
extern const member_table scenario__merge_members;

/// Members that name a part of the document by its id; in the struct is its index: of a kind of cargo
/// a uint32_t, or of kind_ids a list of them, of the others a size_t. They are read by scenario__look_up(), and
/// written by a writer whose `whole` is the scene.
extern const member_kind scenario__kind_id;
extern const member_kind scenario__kind_ids;
extern const member_kind scenario__belt_id;
extern const member_kind scenario__obstacle_id;
extern const member_kind scenario__feed_id;
extern const member_kind scenario__photo_eye_id;

/// Look up the ids that members of the document name, in a resolved scene; unknown ones are faults.
void scenario__look_up(json_in *in, const struct json_t *document, scene *s);

/// The kind of cargo of an id. False: there is none, and a fault was noted at the present place, its text after
/// `where`.
bool scenario__find_kind(json_in *in, const scene *s, const char *where, const char *id,
                         uint32_t *ret_kind);

/// The member of a profile or list of arrivals that has it as CSV, "csv", or names the stored text, "measurement"; NULL:
/// none does.
const char *scenario__text_member(const struct json_t *object);

/// The text of this member's value; a stored one, which must be of a kind, is read into the empty *stored. NULL: a fault
/// was noted, or the reading has failed.
const char *scenario__text_of(json_in *in, const struct json_t *value, const char *member_name,
                              const char *kind, bf_buffer *stored);

/// The ways to say where an obstacle is: `path_m`, `from_m` with `to_m`, or `end_m` with `angle_deg` and
/// `length_m`. All become the path of scene_obstacle.
///
/// What the members of the two shorter forms are read into.
typedef struct obstacle_form {
    vec2 end;      ///< end_m, m
    double angle;  ///< angle_deg, from the x axis, degrees
    double length; ///< length_m, m, > 0
    vec2 from;     ///< from_m, m
    vec2 to;       ///< to_m, m
} obstacle_form;

/// The names of the members of each form; both lists end with NULL. The first name of a form stands
/// for it in texts.
extern const char *const *const obstacle_form__members[];

/// Read the form that the object has into the path of *obstacle, a scene_obstacle. It is a fault if
/// there is not exactly one form, or half of one.
void obstacle_form__read(json_in *in, const struct json_t *object, void *obstacle);

/// The ready scenarios by rising name, made by the build from the files of api/scenario/examples; the
/// last one has no name.
extern const example examples__list[];
