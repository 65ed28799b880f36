/// Microscopic belt model: every part is a rigid body that moves by Newton's and Euler's laws with
/// contact, friction and gravity (section 2, (1)-(9), (12)-(13)).
///
///     normal    f_c = (k delta + d delta') n, clamped at 0 unless tension is on           (4a)
///     stiffness cargo-cargo, cargo-handling: k = pi/4 E* l; cargo-conveyor: k = 2 E* r   (4b), (5)
///               1/E* = (1 - nu_i^2)/E_i + (1 - nu_j^2)/E_j, E divided by modulus_reduction
///     sliding   f_s = -mu |f_c| tanh(lambda_lin |v_tan|) v_tan/|v_tan|                        (7)
///     spin      t_s = -mu r_spin |f_c| tanh(lambda_ang |w_n|) sgn(w_n) n, on the belt         (8)
///     verlet    x+ = (2 - D dt) x - (1 - D dt) x- + dt^2 F/m, v = (x+ - x-)/(2 dt);
///               w+ = (1 - D)^dt w + dt Theta^-1 (torque)                                  (12), (13)
///
/// Two paths behind one interface. Planar: upright cylinders that stay on belts keep their axes vertical, so position,
/// heading, velocity and spin in the plane are exact for them. Spatial: everything else, as rigid bodies in 3-D with
/// quaternions, on belts as moving planes, between obstacles and walls as rigid boundaries; contacts by GJK/EPA or closed form.
///
/// A part whose centre leaves the domain over an edge that is no wall has left, and one that no belt carries after a step
/// (surroundings.h, by its own radius) has fallen: micro_is_gone() is true, and its last state stays, until
/// micro_take_departures() has reported it and its handle is used again.
///
/// Units    SI. The belt surface is z = 0; heights count from there.
/// Handles  A part is accessed by its handle k < micro_parts(), whatever order the solver stores parts in:
///          its index in the definition, or what micro_admit() returns. The lowest free handle is used first, so
///          that their number is that of the parts that were in the domain at the same time.
/// Ids      are never used again: 0 .. n_parts - 1 of the definition's parts, then rising in order of admission.
/// Threads  a solver belongs to one thread at a time and uses n_threads itself; any number gives the same bits.
/// Errors   as in core/macro/macro.h; pointers are those of a scenario.

#pragma once

#include "core/base/buffer.h"
#include "core/base/status.h"
#include "core/scene/scene.h"
#include "core/world/world.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/// Time integration.
typedef enum micro_integrator {
    MICRO_VERLET,   ///< (12)-(13), the paper's
    MICRO_IMPLICIT, ///< dashpot and frictions implicitly per contact; steps of 0.2 to 2 ms
    MICRO_INTEGRATOR_COUNT
} micro_integrator;

/// Which equations of motion.
typedef enum micro_path {
    MICRO_PATH_AUTO,   ///< planar if every part is an upright cylinder that lies flat, else spatial
    MICRO_PATH_PLANAR, ///< planar; parts must be cylinders
    MICRO_PATH_SPATIAL, ///< spatial for any shape
    MICRO_PATH_COUNT
} micro_path;

/// A kind of part.
typedef struct micro_kind {
    scene_shape shape;       ///< checked; arrays are read during micro_create() only
    scene_material material; ///< of its surface
    double mass;             ///< kg, > 0
    double spin_radius;      ///< r_spin of (8), m, >= 0
} micro_kind;

/// How to build a solver: numbers of a checked scenario. Begin with micro_def_default(). Arrays are read during micro_create() only
/// and stay the caller's.
typedef struct micro_def {
    scene_rect domain;                  ///< m (no default)
    scene_edge edges[SCENE_SIDE_COUNT]; ///< walls are solid (default inflow, outflow, wall, wall)
    size_t n_belts;                     ///< (default 0)
    const scene_belt *belts;            ///< later ones lie on top of earlier ones
    size_t n_obstacles;                 ///< (default 0)
    const scene_obstacle *obstacles;    ///< plates: path, thickness, motion; solid
    bf_world *world;  ///< of these belts and obstacles, borrowed; NULL: none moves (default)
    size_t n_actions; ///< (default 0)
    const scene_action *actions; ///< that may turn obstacles: bound the step
    size_t n_kinds;              ///< >= 1 (no default)
    const micro_kind *kinds;     ///< kinds of parts
    size_t n_parts;              ///< (no default)
    const scene_pose *poses;     ///< of the parts' centres at the start; they lie flat
    const uint32_t *part_kinds;  ///< kind of each part; NULL: all of kind 0
    size_t n_parts_expected;     ///< that steps are chosen for; 0: n_parts, none admitted (default)
    vec2 start_velocity; ///< of parts off every belt, m/s (default 0, 0); others have the belt's
    scene_contact contact[SCENE_PAIR_COUNT]; ///< laws (defaults as in scene_micro)
    double wall_friction;     ///< mu of SCENE_HANDLING_CARGO at walls, >= 0 (default its default)
    scene_material conveyor;  ///< (default 40e9 Pa, 0.05)
    scene_material handling;  ///< obstacles and walls (default 70e9 Pa, 0.34)
    double modulus_reduction; ///< >= 1 (default 1e6)
    bool hardens;             ///< it falls where overlaps are large, see hardness.h (default false)
    double overlap_limit;     ///< of the smaller radius: more fails, see press.h (default INFINITY)
    double damping;           ///< D, 1/s, >= 0 (default 0.1)
    double gravity;           ///< m/s2, >= 0 (default 9.81)
    double dt;                ///< s, > 0; 0: chosen (default 1e-5)
    bool tension;             ///< contacts may pull (default false)
    micro_integrator integrator; ///< (default MICRO_VERLET)
    micro_path path;             ///< (default MICRO_PATH_AUTO)
    int n_threads;               ///< >= 1 (default 1)
} micro_def;

/// A running solver; opaque, on the heap.
typedef struct micro_solver micro_solver;

/// The state of a part.
typedef struct micro_part {
    double x[3];     ///< centre of mass, m; x[2] is half its height for one that lies flat
    double q[4];     ///< orientation, unit quaternion w, x, y, z
    double v[3];     ///< velocity, m/s
    double w[3];     ///< angular velocity, rad/s
    double heading;  ///< rad, planar: the angle, not reduced; spatial: of the body's x axis
    bool is_gone;    ///< left the domain, or fell
    bool has_fallen; ///< the second, and it was not reported yet
} micro_part;

/// A part that enters: it lies flat.
typedef struct micro_arrival {
    uint32_t kind;   ///< < n_kinds
    scene_pose pose; ///< in the domain
    vec2 velocity;   ///< m/s
} micro_arrival;

/// A part that has left, or has fallen.
typedef struct micro_departure {
    size_t part;     ///< handle that it had
    uint64_t id;     ///< see there
    uint32_t kind;   ///< see there
    vec2 at;         ///< where it left, m
    bool has_fallen; ///< off the belts
} micro_departure;

/// Where a part is on the belt and how far it extends, seen from above.
typedef struct micro_extent {
    uint32_t kind;   ///< see there
    bool is_flat;    ///< as at its start: its footprint is that of its kind at pose
    scene_pose pose; ///< of the origin of its footprint; of its centre of mass if not is_flat
    double radius;   ///< of the disk around pose that holds it, m
    vec2 half; ///< sides of the rectangle that holds it if not is_flat, along and across, halved, m
} micro_extent;

/// Totals of the current state and of the run so far.
typedef struct micro_totals {
    size_t n_parts;    ///< parts in the domain
    size_t n_contacts; ///< contacts of a part with a part, obstacle or wall that have a force now
    double kinetic_energy;  ///< of all parts in the domain, J
    double largest_overlap; ///< of any such contact since the start, m
    double overlap_share;   ///< the largest of overlap divided by the smaller part's radius
} micro_totals;

/// The defaults above.
micro_def micro_def_default(void);

/// Largest step, s, for which the integrator is stable with this definition (contacts, frictions); dt = 0 chooses at most this.
double micro_dt_stable(const micro_def *def);

/// Largest step, s, in which no plate that moves goes farther than a quarter of the smallest radius; INFINITY: none moves.
double micro_dt_plates(const micro_def *def);

/// The step that dt = 0 stands for, s, at most micro_dt_plates(); of MICRO_IMPLICIT it depends on n_parts_expected.
double micro_dt_chosen(const micro_def *def);

/// True if the parts are solved in the plane.
bool micro_def_is_planar(const micro_def *def);

/// About the iterations in a step of dt; 0: MICRO_VERLET has none.
int micro_iterations(const micro_def *def);

/// Build a solver at t = 0. The caller owns *ret_solver: micro_destroy().
/// BF_EINPUT: dt beyond micro_dt_stable() or micro_dt_plates(), which the text names, or a plate moves too fast for its
/// contacts; BF_ENOMEM.
BF_MUST_CHECK bf_status micro_create(const micro_def *def, micro_solver **ret_solver,
                                     bf_error *err);

/// Free a solver and what it owns. NULL is fine. Always returns NULL.
micro_solver *micro_destroy(micro_solver *s);

/// Make n steps of dt. BF_ENUMERIC: a value is not finite, a part moved impossibly far in a step, or an overlap is
/// beyond overlap_limit; the text has time, part and place. BF_ENOMEM: no memory for a longer neighbour list.
BF_MUST_CHECK bf_status micro_advance(micro_solver *s, uint64_t n, bf_error *err);

/// The state of part k, 0 <= k < micro_parts().
micro_part micro_part_of(const micro_solver *s, size_t k);

/// True if part k has left the domain, or has fallen.
bool micro_is_gone(const micro_solver *s, size_t k);

/// Id of part k.
uint64_t micro_id_of(const micro_solver *s, size_t k);

/// Add a part, in the domain, where n_parts_expected is not 0; it moves from the next step on. It may overlap others:
/// micro_is_free(). BF_ELIMIT: SCENE_PARTS_MAX are in the domain; BF_ENOMEM. On an error s is as before.
BF_MUST_CHECK bf_status micro_admit(micro_solver *s, const micro_arrival *arrival, size_t *ret_part,
                                    bf_error *err);

/// Take part k, which is in the domain, out between two steps: it has left where it is.
void micro_take_out(micro_solver *s, size_t k);

/// The next parts, in order of their handles, that have left or fallen and were not reported yet, at most `room`. Returns how
/// many; fewer than room: that was all of them. Their handles are free from now on.
size_t micro_take_departures(micro_solver *s, micro_departure *ret_departures, size_t room);

/// Whether a part of a kind at a pose would overlap by more than SCENE_TOLERANCE no part, plate and wall, and have
/// its centre in the domain; parts by their footprints, those that do not lie flat by the disk around them. Constant
/// time, but for the first query after steps, which is O(n). BF_ENOMEM.
BF_MUST_CHECK bf_status micro_is_free(micro_solver *s, uint32_t kind, scene_pose pose,
                                      bool *ret_is_free, bf_error *err);

/// Velocity of the belt under a place now, m/s; zero off every belt.
vec2 micro_belt_velocity(const micro_solver *s, vec2 at);

/// Called with a part in the domain.
typedef void micro_visit(void *context, size_t part, const micro_extent *extent);

/// Call visit for the parts whose pose is within a distance, m, of the segment from a to b, in any order; s must
/// not be changed until this returns. Time as of micro_is_free(). BF_ENOMEM: before the first call.
BF_MUST_CHECK bf_status micro_visit_near(micro_solver *s, vec2 a, vec2 b, double distance,
                                         micro_visit *visit, void *context, bf_error *err);

/// True on the planar path.
bool micro_is_planar(const micro_solver *s);

/// Number of handles: parts in the domain, those that have left, and free ones.
size_t micro_parts(const micro_solver *s);

/// Totals; O(n).
micro_totals micro_measure(const micro_solver *s);

/// The step in use, s.
double micro_dt(const micro_solver *s);

/// Steps made, and parts that have fallen, since t = 0.
uint64_t micro_steps(const micro_solver *s);
uint64_t micro_fallen(const micro_solver *s);

/// Digest of step count and state, in order of handles, and of the ids where parts may be admitted.
uint64_t micro_digest(const micro_solver *s);

/// Append the state to *out, so that micro_load() into a solver of the same def goes on with the same
/// bits. BF_ENOMEM.
BF_MUST_CHECK bf_status micro_save(const micro_solver *s, bf_buffer *out, bf_error *err);

/// Take a state that micro_save() wrote of the same definition, into a solver without steps. If that fails, s can only be
/// destroyed. BF_ECORRUPT: damaged. BF_ENOMEM.
BF_MUST_CHECK bf_status micro_load(micro_solver *s, const void *bytes, size_t n, bf_error *err);
