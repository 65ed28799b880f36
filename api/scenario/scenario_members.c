#include "api/scenario/scenario_members.h"

#include "api/scenario/scenario_priv.h"
#include "core/scene/goods.h"
#include "core/scene/ranges.h"
#include "core/scene/scene.h"

#include <jansson.h>
#include <math.h>
#include <string.h>

static const char *const edge_words[] = { "inflow", "outflow", "wall", NULL };
static const char *const shape_words[] = { "cylinder", "box", "prism", "hull", NULL };
const char *const scenario_closure_words[] = { "dispersive", "congested", NULL };
static const char *const scheme_words[] = { "roe", "muscl", NULL };
static const char *const until_words[] = { "duration", "drained", "steady", NULL };
static const char *const heaviside_words[] = { "sharp", "smooth", "none", NULL };
static const char *const integrator_words[] = { "verlet", "implicit", "auto", NULL };
static const char *const path_words[] = { "auto", "planar", "spatial", NULL };

HAS_WORDS(edge_words, SCENE_EDGE_COUNT);
HAS_WORDS(until_words, SCENE_UNTIL_COUNT);
HAS_WORDS(shape_words, SCENE_SHAPE_COUNT);
HAS_WORDS(scheme_words, SCENE_SCHEME_COUNT);
HAS_WORDS(scenario_closure_words, SCENE_CLOSURE_COUNT);
HAS_WORDS(heaviside_words, SCENE_HEAVISIDE_COUNT);
HAS_WORDS(integrator_words, SCENE_INTEGRATOR_COUNT);
HAS_WORDS(path_words, SCENE_PATH_COUNT);
_Static_assert(sizeof(scene_edge) == sizeof(unsigned), "words are read into unsigned");

// A function that gives the struct of a table the defaults that core has for this part of a scene.
#define INIT_PART(name, part)                                                                      \
    static void init_##name(void *item, size_t place)                                              \
    {                                                                                              \
        scene s;                                                                                   \
        (void)place;                                                                               \
        scene_init(&s);                                                                            \
        memcpy(item, &(part), sizeof(part));                                                       \
    }
INIT_PART(scene, s)
INIT_PART(edges, s.edges)
INIT_PART(shape, s.cargo[0].shape)
INIT_PART(cargo, s.cargo[0])
INIT_PART(initial, s.initial)
INIT_PART(output, s.output)
INIT_PART(macro, s.macro)
INIT_PART(micro, s.micro)
INIT_PART(contact, s.micro.contact[place])

static void init_counter(void *item, size_t place)
{
    (void)place;
    scene_counter_init(item);
}

#define AT(place) offsetof(scene_rect, place)
static const member rect_members[] = {
    MEMBER("x_m", interval, AT(x_min), "from and to along the belt", .unit = "m"),
    MEMBER("y_m", interval, AT(y_min), "from and to across the belt", .unit = "m"),
};
static const member_table rect_table = { MEMBER_TABLE("rectangle", rect_members) };
#undef AT

#define AT(side) ((side) * sizeof(scene_edge))
static const member edge_members[] = {
    MEMBER("west", enum, AT(SCENE_WEST), "the side x = x_min", .words = edge_words,
           .flags = MEMBER_INIT),
    MEMBER("east", enum, AT(SCENE_EAST), "the side x = x_max", .words = edge_words,
           .flags = MEMBER_INIT),
    MEMBER("south", enum, AT(SCENE_SOUTH), "the side y = y_min", .words = edge_words,
           .flags = MEMBER_INIT),
    MEMBER("north", enum, AT(SCENE_NORTH), "the side y = y_max", .words = edge_words,
           .flags = MEMBER_INIT),
};
static const member_table edge_table = { MEMBER_TABLE("edges", edge_members),
                                         .size = sizeof(scene_edge[SCENE_SIDE_COUNT]),
                                         .init = init_edges };
#undef AT

// A size that goods gave may be left out.
static void note_missing(json_in *in, const struct json_t *object, const char *name, double value)
{
    if (!isnan(value) || json_object_get(object, name) != NULL)
        return;
    size_t mark = json_pointer_enter(&in->pointer, name, strlen(name));
    json_in_fault(in, "is missing");
    json_pointer_leave(&in->pointer, mark);
}

static void note_missing_sizes(json_in *in, const struct json_t *object, void *item)
{
    const scene_shape *shape = item;

    if (shape->type == SCENE_CYLINDER)
        note_missing(in, object, "radius_m", shape->radius);
    if (shape->type != SCENE_BOX)
        return;
    note_missing(in, object, "length_m", shape->length);
    note_missing(in, object, "width_m", shape->width);
}

#define AT(place) offsetof(scene_shape, place)
#define OF(shape) (1U << (shape))
#define UPRIGHT   (OF(SCENE_CYLINDER) | OF(SCENE_BOX) | OF(SCENE_PRISM))
static const member shape_members[] = {
    MEMBER("type", enum, AT(type), "kind of shape; says which other members there are",
           .words = shape_words, .flags = MEMBER_INIT),
    MEMBER("radius_m", number, AT(radius), "of a cylinder", .unit = "m",
           .range = &scene_range_length, .tags = OF(SCENE_CYLINDER), .flags = MEMBER_INIT),
    MEMBER("length_m", number, AT(length), "of a box along x", .unit = "m",
           .range = &scene_range_length, .tags = OF(SCENE_BOX), .flags = MEMBER_KEPT),
    MEMBER("width_m", number, AT(width), "of a box along y", .unit = "m",
           .range = &scene_range_length, .tags = OF(SCENE_BOX), .flags = MEMBER_KEPT),
    MEMBER("height_m", number, AT(height), "of cylinder, box, prism", .unit = "m",
           .range = &scene_range_length, .tags = UPRIGHT, .flags = MEMBER_INIT),
    MEMBER("outline_m", outline, AT(vertices), "of a prism: convex, counter-clockwise", .unit = "m",
           .offset_n = AT(n_vertices), .least = 3, .limit = SCENE_VERTICES_MAX,
           .tags = OF(SCENE_PRISM)),
    MEMBER("vertices_m", vertices, AT(vertices), "of a convex hull", .unit = "m",
           .offset_n = AT(n_vertices), .least = 4, .limit = SCENE_VERTICES_MAX,
           .tags = OF(SCENE_HULL)),
};
const member_table scenario__shape_members = { MEMBER_TABLE("shape", shape_members),
                                               .size = sizeof(scene_shape), .init = init_shape,
                                               .choice = MEMBER_TAGGED,
                                               .post_read = note_missing_sizes };
#undef AT

#define AT(place) offsetof(scene_material, place)
static const member material_members[] = {
    MEMBER("young_modulus_pa", number, AT(young_modulus), "E", .unit = "Pa",
           .range = &scene_range_young_modulus, .default_text = "of the material"),
    MEMBER("poisson_ratio", number, AT(poisson_ratio), "nu", .range = &scene_range_poisson_ratio,
           .default_text = "of the material"),
};
static const member_table material_table = { MEMBER_TABLE("material", material_members) };
#undef AT

// What goods give is there before the members beside them are read.
static void read_goods(json_in *in, const struct json_t *value, const member *m, void *item)
{
    unsigned goods;

    if (json_in_word(in, value, m->words, &goods))
        goods_apply(goods, item);
}

static void write_goods(json_out *w, const member *m, const void *item)
{
    member_enum.write(w, m, item);
}

static void describe_goods(json_out *w, const member *m, member_view view)
{
    member_enum.write_schema(w, m, view);
}

static const member_kind member_goods = { .text = "name in GET /v1/goods",
                                          .read = read_goods,
                                          .write = write_goods,
                                          .write_schema = describe_goods };

static bool is_of_no_goods(const void *item)
{
    return ((const scene_cargo *)item)->goods == SCENE_GOODS_COUNT;
}

#define AT(place) offsetof(scene_cargo, place)
#define CARGO_GOODS                                                                                \
    MEMBER("goods", goods, AT(goods),                                                              \
           "usual goods: shape, mass and surface that stand beside it outrank its own",            \
           .words = scene_goods_words, .flags = MEMBER_OMIT_EMPTY, .is_empty = is_of_no_goods,     \
           .default_text = "none")
#define CARGO_ID                                                                                   \
    MEMBER("id", text, AT(id), "its name, by which feeds call it",                                 \
           .default_text = "cargo, cargo-2, ... where there are feeds", .least = 1,                \
           .limit = SCENE_ID_SIZE, .flags = MEMBER_OMIT_EMPTY)
#define CARGO_MEMBERS                                                                              \
    MEMBER("shape", object, AT(shape), "of every part", .table = &scenario__shape_members,         \
           .default_text = "{}"),                                                                  \
        MEMBER("mass_kg", number, AT(mass), "of a part", .unit = "kg", .range = &scene_range_mass, \
               .default_text = TEXT_OF(SCENE_STEEL_DENSITY) " kg/m3 times the volume"),            \
        MEMBER("surface", enum, AT(surface), "what it is made of outside: frictions follow",       \
               .words = scene_surface_words, .flags = MEMBER_OMIT_EMPTY,                           \
               .default_text = "of the goods, else none: the paper's frictions"),                  \
        MEMBER("material", object, AT(material), "steel", .table = &material_table,                \
               .flags = MEMBER_INIT)
static const member cargo_members[] = { CARGO_ID, CARGO_GOODS, CARGO_MEMBERS };
static const member_table cargo_table = { MEMBER_TABLE("cargo", cargo_members),
                                          .size = sizeof(scene_cargo), .init = init_cargo };

static const member kind_members[] = {
    CARGO_ID,
    CARGO_GOODS,
    MEMBER("share", number, AT(share),
           "how many parts are of the kind, in proportion to all shares",
           .range = &scene_range_share, .flags = MEMBER_INIT),
    CARGO_MEMBERS,
    MEMBER("spin_friction_radius_m", number, AT(spin_friction_radius), "lever of the spin friction",
           .unit = "m", .range = &scene_range_lever,
           .default_text = "that of micro if given, else 2/3 of the footprint's radius"),
};
static const member_table kind_table = { MEMBER_TABLE("kind", kind_members),
                                         .size = sizeof(scene_cargo), .init = init_cargo };
#undef AT

#define AT(place) offsetof(scene_initial, place)
static const member hexagonal_members[] = {
    MEMBER("rows", count, AT(n_rows), "rows, each along the belt", .range = &scene_range_count),
    MEMBER("columns", count, AT(n_columns), "parts a row", .range = &scene_range_count),
    MEMBER("first_m", point, AT(first), "first centre of the first row", .unit = "m"),
    MEMBER("spacing_m", number, AT(spacing), "between neighbours", .unit = "m",
           .range = &scene_range_length),
};
static const member_table hexagonal_table = { MEMBER_TABLE("hexagonal", hexagonal_members) };

static const member random_members[] = {
    MEMBER("count", count, AT(n_random), "parts", .range = &scene_range_count),
    MEMBER("region", object, AT(region), "centres lie in it", .table = &rect_table),
    MEMBER("seed", seed, AT(seed), "of the generator", .range = &scene_range_seed,
           .flags = MEMBER_INIT),
};
static const member_table random_table = { MEMBER_TABLE("random", random_members),
                                           .size = sizeof(scene_initial), .init = init_initial };

static const member initial_members[SCENE_INITIAL_EMPTY] = {
    [SCENE_INITIAL_POSITIONS] =
        MEMBER("positions_m", poses, AT(poses), "[x, y] or [x, y, heading] of every part",
               .unit = "m, m, deg", .offset_n = AT(n_poses), .least = 1, .limit = SCENE_PARTS_MAX,
               .default_text = "see initial"),
    [SCENE_INITIAL_HEXAGONAL] = MEMBER("hexagonal", object, 0, "rows of a hexagonal packing",
                                       .table = &hexagonal_table, .default_text = "see initial"),
    [SCENE_INITIAL_RANDOM] = MEMBER("random", object, 0, "random places without overlaps",
                                    .table = &random_table, .default_text = "see initial"),
};
static const member_table initial_table = { MEMBER_TABLE("initial", initial_members),
                                            .choice = MEMBER_ONE_OF, .offset_choice = AT(type) };
#undef AT

#define AT(place) offsetof(scene_counter, place)
static bool counts_all(const void *item)
{
    return ((const scene_counter *)item)->kind == SCENE_KIND_ANY;
}

static const member counter_members[] = {
    MEMBER("id", text, AT(id), "its name, a column of the curve",
           .default_text = "upstream, upstream-2, ...", .least = 1, .limit = SCENE_ID_SIZE),
    MEMBER("x_m", interval, AT(rect.x_min), "parts from x on and before x", .unit = "m",
           .default_text = "the domain's"),
    MEMBER("y_m", interval, AT(rect.y_min), "parts from y on and before y", .unit = "m",
           .default_text = "the domain's"),
    MEMBER_OF("kind", &scenario__kind_id, AT(kind), "id of the kind of cargo that it counts",
              .flags = MEMBER_OMIT_EMPTY, .is_empty = counts_all, .default_text = "all kinds"),
};
// A curve event has these members beside one for each counter.
static void refuse_reserved_id(json_in *in, const struct json_t *object, void *item)
{
    static const char *const reserved[] = { "run", "first" };
    const scene_counter *counter = item;

    (void)object;
    for (size_t k = 0; k < sizeof reserved / sizeof *reserved; k++) {
        if (strcmp(counter->id, reserved[k]) != 0)
            continue;
        size_t mark = json_pointer_enter(&in->pointer, "id", strlen("id"));
        json_in_fault(in, "'%s' is a member of every curve event", reserved[k]);
        json_pointer_leave(&in->pointer, mark);
    }
}
static const member_table counter_table = { MEMBER_TABLE("counter", counter_members),
                                            .size = sizeof(scene_counter), .init = init_counter,
                                            .post_read = refuse_reserved_id };
#undef AT

static void init_window(void *item, size_t place)
{
    (void)place;
    scene_output_window_init(item);
}

#define AT(place) offsetof(scene_output_window, place)
static const member window_members[] = {
    MEMBER("t_s", interval, AT(from), "from this time on, until before that one", .unit = "s"),
    MEMBER("curve_every_s", number, AT(curve_every), "samples of the curve", .unit = "s",
           .range = &scene_range_time, .default_text = "that of output"),
    MEMBER("snapshot_every_s", number, AT(snapshot_every), "density snapshots", .unit = "s",
           .range = &scene_range_time, .default_text = "that of output"),
};
static const member_table window_table = { MEMBER_TABLE("outputWindow", window_members),
                                           .size = sizeof(scene_output_window),
                                           .init = init_window };
#undef AT

#define AT(place) offsetof(scene_output, place)
static const member output_members[] = {
    MEMBER("curve_every_s", number, AT(curve_every), "samples of the curve", .unit = "s",
           .range = &scene_range_time, .flags = MEMBER_INIT),
    MEMBER("snapshot_every_s", number, AT(snapshot_every), "density snapshots", .unit = "s",
           .range = &scene_range_time, .flags = MEMBER_INIT),
    MEMBER("windows", list, AT(windows), "spans of time with other periods, rising",
           .table = &window_table, .offset_n = AT(n_windows), .least = 0,
           .limit = SCENE_WINDOWS_MAX, .flags = MEMBER_OMIT_EMPTY, .default_text = "[]"),
};
static const member_table output_table = { MEMBER_TABLE("output", output_members),
                                           .size = sizeof(scene_output), .init = init_output };
#undef AT

#define AT(place) offsetof(scene_macro, place)
static const member macro_members[] = {
    MEMBER("cell_m", step, AT(cell),
           "edge of a cell, fitted to the domain; auto: a third (dispersive: a fifth) of the "
           "diameter of the smallest kind",
           .unit = "m", .range = &scene_range_length, .flags = MEMBER_INIT),
    MEMBER("step_s", step, AT(step), "time step; auto: the largest stable and positive one",
           .unit = "s", .range = &scene_range_time,
           .default_text = "auto; " TEXT_OF(SCENE_MACRO_STEP) " if dispersive with a given cell_m"),
    MEMBER("closure", enum, AT(closure), "how packed cargo moves", .words = scenario_closure_words,
           .flags = MEMBER_INIT),
    MEMBER("jam_density", number, AT(jam_density), "rho_j of congested",
           .range = &scene_range_jam_density, .flags = MEMBER_INIT),
    MEMBER("scheme", enum, AT(scheme), "numerical scheme", .words = scheme_words,
           .flags = MEMBER_INIT),
    MEMBER("heaviside", enum, AT(heaviside), "what lets the dispersion act",
           .words = heaviside_words, .flags = MEMBER_INIT),
    MEMBER("heaviside_width", number, AT(heaviside_width), "xi of smooth",
           .range = &scene_range_heaviside_width, .flags = MEMBER_INIT),
    MEMBER("dispersion_m_s", number, AT(dispersion), "epsilon", .unit = "m/s",
           .range = &scene_range_dispersion, .default_text = "twice the speed of the fastest belt"),
    MEMBER("mollifier_per_m2", number, AT(mollifier), "sigma", .unit = "1/m2",
           .range = &scene_range_per_area, .flags = MEMBER_INIT),
    MEMBER("initial_mollifier_per_m2", number, AT(initial_mollifier),
           "sigma_0 of the density at the start", .unit = "1/m2", .range = &scene_range_per_area,
           .default_text = "in proportion to the footprint: 2500 for cylinders of 12 mm"),
    MEMBER("packing_density_per_m2", number, AT(packing), "rho_max, parts/m2 at density 1",
           .unit = "1/m2", .range = &scene_range_per_area,
           .default_text = "close packing of the shape, cut to four digits"),
};
static const member_table macro_table = { MEMBER_TABLE("macro", macro_members),
                                          .size = sizeof(scene_macro), .init = init_macro };
#undef AT

#define AT(place) offsetof(scene_micro, place)
static const member micro_members[] = {
    MEMBER("integrator", enum, AT(integrator), "time integration; auto: implicit",
           .words = integrator_words, .flags = MEMBER_INIT),
    MEMBER("path", enum, AT(path),
           "equations of motion; auto: planar where all parts are cylinders", .words = path_words,
           .flags = MEMBER_INIT),
    MEMBER("step_s", step, AT(step), "time step; auto: chosen by the integrator, and stable",
           .unit = "s", .range = &scene_range_time,
           .default_text = "auto; " TEXT_OF(SCENE_MICRO_STEP) " if verlet"),
    MEMBER("modulus_reduction", step, AT(modulus_reduction),
           "all moduli are divided by it; auto: from the loads that parts may bear",
           .range = &scene_range_modulus_reduction, .flags = MEMBER_INIT),
    MEMBER(
        "overlap_limit", number, AT(overlap_limit),
        "overlap of two parts, or of a part and a plate, beyond which a run fails, as a share of "
        "the smaller radius",
        .range = &scene_range_overlap_limit, .flags = MEMBER_INIT),
    MEMBER("tension", bool, AT(tension), "contacts may pull", .flags = MEMBER_INIT),
    MEMBER("damping_per_s", number, AT(damping), "D of the integration", .unit = "1/s",
           .range = &scene_range_damping_rate, .flags = MEMBER_INIT),
    MEMBER("gravity_m_s2", number, AT(gravity), "of the place", .unit = "m/s2",
           .range = &scene_range_gravity, .flags = MEMBER_INIT),
    MEMBER("spin_friction_radius_m", number, AT(spin_friction_radius), "lever of the spin friction",
           .unit = "m", .range = &scene_range_lever,
           .default_text = "2/3 of the footprint's radius"),
};
static const member_table micro_table = { MEMBER_TABLE("micro", micro_members),
                                          .size = sizeof(scene_micro), .init = init_micro };

static const member materials_members[] = {
    MEMBER("conveyor", object, AT(conveyor), "of the belts", .table = &material_table,
           .flags = MEMBER_INIT),
    MEMBER("handling", object, AT(handling), "of obstacles and walls", .table = &material_table,
           .flags = MEMBER_INIT),
};
static const member_table materials_table = { MEMBER_TABLE("materials", materials_members),
                                              .size = sizeof(scene_micro), .init = init_micro };
#undef AT

#define AT(place) offsetof(scene_surfaces, place)
static const member surfaces_members[] = {
    MEMBER("conveyor", enum, AT(conveyor), "of all belts", .words = scene_surface_words,
           .flags = MEMBER_OMIT_EMPTY, .default_text = "acetal where a cargo has a surface"),
    MEMBER("handling", enum, AT(handling), "of obstacles and walls", .words = scene_surface_words,
           .flags = MEMBER_OMIT_EMPTY, .default_text = "steel where a cargo has a surface"),
};
static const member_table surfaces_table = { MEMBER_TABLE("surfaces", surfaces_members) };
#undef AT

#define AT(place) offsetof(scene_contact, place)
static const member contact_members[] = {
    MEMBER("length_m", number, AT(length), "of the contact line", .unit = "m",
           .range = &scene_range_length, .flags = MEMBER_INIT),
    MEMBER("damping_n_s_m", number, AT(damping), "d", .unit = "N s/m",
           .range = &scene_range_contact_damping, .flags = MEMBER_INIT),
    MEMBER("friction", number, AT(friction), "mu", .range = &scene_range_friction,
           .default_text = "of the surfaces; 0.15, 1, 0.19 where no cargo has one"),
    MEMBER("tanh_linear_s_m", number, AT(tanh_linear), "lambda_lin", .unit = "s/m",
           .range = &scene_range_tanh, .flags = MEMBER_INIT),
    MEMBER("tanh_spin_s", number, AT(tanh_spin), "lambda_ang", .unit = "s",
           .range = &scene_range_tanh, .flags = MEMBER_INIT),
};
static const member_table contact_table = { MEMBER_TABLE("contact", contact_members),
                                            .size = sizeof(scene_contact), .init = init_contact,
                                            .n_places = SCENE_PAIR_COUNT };
#undef AT

#define AT(pair) (offsetof(scene_micro, contact) + (pair) * sizeof(scene_contact))
static const member contacts_members[] = {
    MEMBER("cargo_cargo", object, AT(SCENE_CARGO_CARGO), "part on part", .table = &contact_table,
           .default_text = "{}"),
    MEMBER("conveyor_cargo", object, AT(SCENE_CONVEYOR_CARGO), "belt on part",
           .table = &contact_table, .default_text = "{}"),
    MEMBER("handling_cargo", object, AT(SCENE_HANDLING_CARGO), "obstacle or wall on part",
           .table = &contact_table, .default_text = "{}"),
    MEMBER("wall_friction", number, offsetof(scene_micro, wall_friction),
           "mu of handling_cargo at walls of the domain", .range = &scene_range_friction,
           .default_text = "that of handling_cargo"),
};
static const member_table contacts_table = { MEMBER_TABLE("contacts", contacts_members) };
#undef AT

static bool has_no_surfaces(const void *item)
{
    const scene *s = item;

    return s->surfaces.conveyor == SCENE_SURFACE_COUNT &&
           s->surfaces.handling == SCENE_SURFACE_COUNT;
}

static bool is_empty_at_start(const void *item)
{
    const scene *s = item;

    return s->initial.type == SCENE_INITIAL_EMPTY;
}

#define AT(place) offsetof(scene, place)
static const member top_members[] = {
    MEMBER("name", text, AT(name), "for people", .limit = SCENE_NAME_SIZE, .flags = MEMBER_INIT),
    MEMBER("duration_s", number, AT(duration), "simulated time", .unit = "s",
           .range = &scene_range_time),
    MEMBER("domain", object, AT(domain), "the rectangle that is looked at", .table = &rect_table),
    MEMBER("edges", object, AT(edges), "what the sides of the domain are", .table = &edge_table,
           .default_text = "{}"),
    MEMBER("belts", list, AT(belts), "conveyors; where they overlap the later one wins",
           .table = &scenario__belt_members, .offset_n = AT(n_belts), .least = 1,
           .limit = SCENE_BELTS_MAX, .default_text = "[{}]"),
    MEMBER("obstacles", list, AT(obstacles), "deflectors standing on the belts",
           .table = &scenario_members_obstacle, .offset_n = AT(n_obstacles), .least = 0,
           .limit = SCENE_OBSTACLES_MAX, .default_text = "[]"),
    MEMBER("cargo", one_or_list, AT(cargo), "what is transported; a list is a mix of kinds",
           .offset_n = AT(n_cargo), .offset_list = AT(is_mix), .table = &cargo_table,
           .items = &kind_table, .least = 1, .limit = SCENE_KINDS_MAX),
    MEMBER("cargo_seed", seed, AT(cargo_seed),
           "of the order in which parts of a mix get their kinds", .range = &scene_range_seed,
           .flags = MEMBER_INIT),
    MEMBER("initial", object, AT(initial), "where it is at the start; one member",
           .table = &initial_table, .flags = MEMBER_OMIT_EMPTY, .is_empty = is_empty_at_start,
           .default_text = "no parts, where there are feeds"),
    MEMBER("feeds", list, AT(feeds), "sources of cargo while the run goes on",
           .table = &scenario__feed_members, .offset_n = AT(n_feeds), .least = 0,
           .limit = SCENE_FEEDS_MAX, .flags = MEMBER_OMIT_EMPTY, .default_text = "[]"),
    MEMBER("substream", seed, AT(substream),
           "of the draws of all feeds; replications differ in it alone", .range = &scene_range_seed,
           .flags = MEMBER_INIT | MEMBER_OMIT_DEFAULT),
    MEMBER("photo_eyes", list, AT(eyes), "light barriers", .table = &scenario__photo_eye_members,
           .offset_n = AT(n_eyes), .least = 0, .limit = SCENE_EYES_MAX, .flags = MEMBER_OMIT_EMPTY,
           .default_text = "[]"),
    MEMBER("sinks", list, AT(sinks), "places at which goods are taken off the line",
           .table = &scenario__sink_members, .offset_n = AT(n_sinks), .least = 0,
           .limit = SCENE_SINKS_MAX, .flags = MEMBER_OMIT_EMPTY, .default_text = "[]"),
    MEMBER("actions", list, AT(actions), "what photo eyes command",
           .table = &scenario__action_members, .offset_n = AT(n_actions), .least = 0,
           .limit = SCENE_ACTIONS_MAX, .flags = MEMBER_OMIT_EMPTY, .default_text = "[]"),
    MEMBER("merges", list, AT(merges), "lanes that are released one at a time",
           .table = &scenario__merge_members, .offset_n = AT(n_merges), .least = 0,
           .limit = SCENE_MERGES_MAX, .flags = MEMBER_OMIT_EMPTY, .default_text = "[]"),
    MEMBER("warmup_s", number, AT(warmup), "time that key figures leave out", .unit = "s",
           .range = &scene_range_instant, .flags = MEMBER_INIT | MEMBER_OMIT_DEFAULT),
    MEMBER("jam_time_s", number, AT(jam_time), "time without an exit that counts as a jam",
           .unit = "s", .range = &scene_range_time, .flags = MEMBER_INIT | MEMBER_OMIT_DEFAULT),
    MEMBER("until", enum, AT(until), "when the run ends before duration_s", .words = until_words,
           .flags = MEMBER_INIT | MEMBER_OMIT_DEFAULT),
    MEMBER("steady_precision", number, AT(steady_precision),
           "until steady: half width of the confidence interval of the throughput, relative to it",
           .range = &scene_range_ratio, .flags = MEMBER_INIT | MEMBER_OMIT_DEFAULT),
    MEMBER("counters", list, AT(counters), "parts in a rectangle over time",
           .table = &counter_table, .offset_n = AT(n_counters), .least = 1,
           .limit = SCENE_COUNTERS_MAX, .default_text = "[{}]"),
    MEMBER("output", object, AT(output), "when results are taken", .table = &output_table,
           .default_text = "{}"),
    MEMBER("macro", object, AT(macro), "of the macroscopic model", .table = &macro_table,
           .default_text = "{}"),
    MEMBER("micro", object, AT(micro), "of the microscopic model", .table = &micro_table,
           .default_text = "{}"),
    MEMBER("materials", object, AT(micro), "elastic constants", .table = &materials_table,
           .default_text = "{}"),
    MEMBER("surfaces", object, AT(surfaces), "what belts, obstacles and walls are made of",
           .table = &surfaces_table, .flags = MEMBER_OMIT_EMPTY, .is_empty = has_no_surfaces,
           .default_text = "{}"),
    MEMBER("contacts", object, AT(micro), "contact laws", .table = &contacts_table,
           .default_text = "{}"),
};
const member_table scenario_members = { MEMBER_TABLE("scenario", top_members),
                                        .size = sizeof(scene), .init = init_scene };
