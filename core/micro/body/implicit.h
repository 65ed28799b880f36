/// Inside of MICRO_IMPLICIT in space: implicit Euler for contacts and frictions, solved by impulses.
///
/// All that acts between two bodies in a step is one patch: up to BODY_POINTS contact points around
/// its middle o. With q = (V, W) the velocity and spin of b against a there, in the axes of the patch
/// (two tangents and the normal), and n_p the normal in point p, u_p the speed along it,
///
///     normal     J_p = share_p max(0, E (depth_p - h u_p+) - d max(depth_p, 0)), E = h k + d: for
///                depth > 0 h times (4a) at the end of the step; for a gap, depth < 0, nothing until
///                it closes, and then the dashpot on what it closed to
///     sliding    -mu |J_p| lambda theta(lambda |s_p|) s_p+, s_p the slip: (7), implicit by its secant
///     belt       the same in the centre of pressure, and (8) about the normal, both implicit
///     step       x+ = x + h v+, q+ as in (13)
///
/// All of this is -D q+ + c with a symmetric D >= 0, as long as it is known which points press and
/// what the secants are. M being the inertia that the patch meets in o, its impulses follow from
/// (M + D) q+ = M q0 + c, six equations, with q0 as q would be without the patch. Points and secants are
/// taken anew from q+ a few times. So each patch is solved exactly, with all its points, its tilting and
/// its sliding together; patches are relaxed one after the other (Gauss-Seidel), starting from the
/// impulses of the step before. Every impulse acts on both parts, so that momentum is kept however few
/// rounds are made.
///
/// Near     Regions are looked for up to a distance that parts could bridge in the step, see manifold.h.
///          It is the same for all, so that the list, when it was made, has no influence.
/// Order    In a round first all patches with solids, part by part; then those of pairs by colours, in
///          none of which a part occurs twice; last those for which there was no colour. Colours are
///          given in each step, by the numbers of the parts: they need not be saved.
/// State    The impulses, with pairs and parts, outlive a step and are saved; the rest is scratch.

#pragma once

#include "core/convex/mat6.h"
#include "core/micro/body/body_priv.h"

enum {
    BODY_POINTS = 8,   ///< of a patch
    BODY_COLOURS = 64, ///< of patches of pairs
    BODY_SLICE = 16,   ///< patches of a colour that a thread takes at a time
};

/// A contact point, in the axes of its patch.
typedef struct body_point {
    double x;        ///< from the middle along the first tangent, m
    double y;        ///< along the second
    vec3 normal;     ///< of length 1
    double depth;    ///< m; < 0: apart
    double share;    ///< of stiffness and dashpot
    double bias;     ///< J = bias - gain u
    double gain;     ///< N s per m/s
    double press;    ///< J as it was found last, N s
    bool is_stuck;   ///< it may pull
    double drive[2]; ///< velocity of the belt under it along the tangents, m/s
} body_point;

/// A body within a step, and how impulses change it.
typedef struct body_mover {
    vec3 v;         ///< m/s
    vec3 w;         ///< rad/s
    double give;    ///< 1/m, 1/kg
    mat3 give_spin; ///< inverse of the inertia in the world's frame, 1/(kg m2)
} body_mover;

/// See above.
typedef struct body_patch {
    uint32_t a;                    ///< part; BODY_STILL: a solid
    uint32_t b;                    ///< part
    body_hold *hold;               ///< where its impulse is kept; NULL: it is not
    uint32_t key;                  ///< of that
    uint8_t colour;                ///< of a patch of parts
    const body_kind *floor;        ///< the part's kind if the solid is the floor, else NULL
    vec3 axis[3];                  ///< tangents and normal; the normal points from a to b, or to b
    vec3 lever[2];                 ///< from the centres of a and b to the middle, m
    mat6 inertia;                  ///< M
    double impulse[6];             ///< so far, on b, in the axes: N s and N m s
    double friction;               ///< mu
    double rate;                   ///< lambda, s/m
    double depth;                  ///< of the region, m
    uint32_t n;                    ///< points
    bool is_flat;                  ///< the points' normals are that of the patch
    double press;                  ///< sum over the points, N s
    body_point point[BODY_POINTS]; ///< see there
} body_patch;

enum { BODY_STILL = UINT32_MAX }; ///< number of what does not move

/// What a block of parts has.
typedef struct body_shelf {
    size_t first;   ///< patch
    size_t n_pairs; ///< patches with other parts
    size_t n;       ///< of all; those with solids are last, part by part
    size_t room;    ///< for patches
    double speed;   ///< largest of any point of a part, before the step or without contacts, m/s
    double moved2;  ///< square of the farthest way since the list was made, m2
} body_shelf;

/// What body_state.implicit points to.
typedef struct implicit_solver {
    int rounds;                      ///< of relaxation in a step
    double keep;                     ///< what the damping leaves of a velocity in a step
    body_hold (*holds)[BODY_HOLDS];  ///< by part: of its contacts with solids
    body_mover *movers;              ///< scratch, by part
    uint64_t *used;                  ///< scratch, by part: colours taken
    body_shelf *shelves;             ///< by block of parts
    size_t patches_capacity;         ///< room
    body_patch *patches;             ///< scratch, by shelves
    size_t order_capacity;           ///< room
    body_patch **order;              ///< scratch: patches of pairs by colours
    size_t colour[BODY_COLOURS + 2]; ///< where each begins in order; the last one is the rest
} body_solver;

/// Find the patches of a block of parts that come nearer than `near`, m.
void body_implicit__meet(body_state *s, size_t block, double near);

/// Apply the impulse that a patch begins with.
void body_implicit__begin(const body_solver *z, body_patch *patch);

/// Solve a patch while all others stay as they are.
void body_implicit__relax(const body_solver *z, body_patch *patch);

/// Keep the impulse of a patch for the next step.
void body_implicit__keep(body_patch *patch);
