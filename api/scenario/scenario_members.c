#include "api/scenario/scenario_members.h"

#include "api/scenario/obstacle_form.h"
#include "core/scene/scene.h"

#include <math.h>
#include <string.h>

// Lines of the tables, by kind. Where the default `std` is NULL the member must be there.
#define LINE(name_, kind_, at, unit_, std, help_)                                                  \
    .name = (name_), .kind = (kind_), .offset = (at), .unit = (unit_), .standard = (std),          \
    .help = (help_)
#define NUMBER(name, at, unit, range_, std, help)                                                  \
    {                                                                                              \
        LINE(name, MEMBER_NUMBER, at, unit, std, help), .range = (range_)                          \
    }
#define NUMBER_OF(tags_, name, at, unit, range_, std, help)                                        \
    {                                                                                              \
        LINE(name, MEMBER_NUMBER, at, unit, std, help), .range = (range_), .tags = (tags_)         \
    }
#define STEP(name, at, std, help)                                                                  \
    {                                                                                              \
        LINE(name, MEMBER_STEP, at, "s", std, help), .range = &positive                            \
    }
#define COUNT(name, at, std, help)                                                                 \
    {                                                                                              \
        LINE(name, MEMBER_COUNT, at, NULL, std, help), .range = &from_one                          \
    }
#define SEED(name, at, std, help)                                                                  \
    {                                                                                              \
        LINE(name, MEMBER_SEED, at, NULL, std, help), .range = &seeds                              \
    }
#define BOOL(name, at, std, help)                                                                  \
    {                                                                                              \
        LINE(name, MEMBER_BOOL, at, NULL, std, help)                                               \
    }
#define POINT(name, at, help)                                                                      \
    {                                                                                              \
        LINE(name, MEMBER_POINT, at, "m", NULL, help)                                              \
    }
#define INTERVAL(name, at, std, help)                                                              \
    {                                                                                              \
        LINE(name, MEMBER_INTERVAL, at, "m", std, help)                                            \
    }
#define ID(at, std, help)                                                                          \
    {                                                                                              \
        LINE("id", MEMBER_TEXT, at, NULL, std, help), .least = 1, .limit = SCENE_ID_SIZE           \
    }
#define WORD(name, at, words_, std, help)                                                          \
    {                                                                                              \
        LINE(name, MEMBER_WORD, at, NULL, std, help), .words = (words_)                            \
    }
#define OBJECT(name, at, table_, std, help)                                                        \
    {                                                                                              \
        LINE(name, MEMBER_OBJECT, at, NULL, std, help), .table = &(table_)                         \
    }
#define FORM(name, kind, place, unit, help)                                                        \
    {                                                                                              \
        LINE(name, kind, offsetof(obstacle_form, place), unit, NULL, help), .flags = MEMBER_FORM   \
    }
#define TABLE(title_, array)                                                                       \
    .title = (title_), .members = (array), .n = sizeof(array) / sizeof *(array)

static const member_range positive = { "> 0", 0, INFINITY, true, false };
static const member_range not_negative = { ">= 0", 0, INFINITY, false, false };
static const member_range from_one = { ">= 1", 1, INFINITY, false, false };
static const member_range below_half = { ">= 0, < 0.5", 0, 0.5, false, true };
static const member_range seeds = { ">= 0, < 2^53", 0, 9007199254740991.0, false, false };

static const char *const edge_words[] = { "inflow", "outflow", "wall", NULL };
static const char *const treatment_words[] = { "sealed", "field", "wall", NULL };
static const char *const shape_words[] = { "cylinder", "box", "prism", "hull", NULL };
static const char *const scheme_words[] = { "roe", NULL };
static const char *const heaviside_words[] = { "sharp", "smooth", "none", NULL };
static const char *const integrator_words[] = { "verlet", "implicit", NULL };
static const char *const path_words[] = { "auto", "planar", "spatial", NULL };

#define HAS_WORDS(words, n)                                                                        \
    _Static_assert(sizeof(words) / sizeof *(words) == (n) + 1, "a word each")
HAS_WORDS(edge_words, SCENE_EDGE_COUNT);
HAS_WORDS(treatment_words, SCENE_TREATMENT_COUNT);
HAS_WORDS(shape_words, SCENE_SHAPE_COUNT);
HAS_WORDS(scheme_words, SCENE_SCHEME_COUNT);
HAS_WORDS(heaviside_words, SCENE_HEAVISIDE_COUNT);
HAS_WORDS(integrator_words, SCENE_INTEGRATOR_COUNT);
HAS_WORDS(path_words, SCENE_PATH_COUNT);
_Static_assert(sizeof(scene_edge) == sizeof(unsigned), "words are read into unsigned");

#define AT(place) offsetof(scene_rect, place)
static const member rect_members[] = {
    INTERVAL("x_m", AT(x_min), NULL, "from and to along the belt"),
    INTERVAL("y_m", AT(y_min), NULL, "from and to across the belt"),
};
static const member_table rect_table = { TABLE("rectangle", rect_members) };
#undef AT

#define AT(side) ((side) * sizeof(scene_edge))
static const member edge_members[] = {
    WORD("west", AT(SCENE_WEST), edge_words, "inflow", "the side x = x_min"),
    WORD("east", AT(SCENE_EAST), edge_words, "outflow", "the side x = x_max"),
    WORD("south", AT(SCENE_SOUTH), edge_words, "wall", "the side y = y_min"),
    WORD("north", AT(SCENE_NORTH), edge_words, "wall", "the side y = y_max"),
};
static const member_table edge_table = { TABLE("edges", edge_members) };
#undef AT

#define AT(place) offsetof(scene_belt, place)
static const member belt_members[] = {
    ID(AT(id), "main, belt-2, ...", "its name"),
    { LINE("velocity_m_s", MEMBER_POINT, AT(velocity), "m/s", "[0.395, 0]", "of the surface") },
    { LINE("polygon_m", MEMBER_POINTS, AT(polygon), "m", "the domain",
           "corners of a simple polygon"),
      .offset_n = AT(n_points), .least = 3, .limit = SCENE_POINTS_MAX, .flags = MEMBER_OMIT_EMPTY },
};
static void begin_belt(void *item)
{
    scene_belt_init(item);
}
static const member_table belt_table = { TABLE("belt", belt_members), .size = sizeof(scene_belt),
                                         .begin = begin_belt };
#undef AT

#define AT(place) offsetof(scene_obstacle, place)
static const member obstacle_members[] = {
    ID(AT(id), "obstacle-1, ...", "its name"),
    FORM("end_m", MEMBER_POINT, end, "m", "first form: end of the upstream face"),
    FORM("angle_deg", MEMBER_NUMBER, angle, "deg",
         "first form: direction from start to end, from the x axis"),
    FORM("length_m", MEMBER_NUMBER, length, "m", "first form: of the upstream face, > 0"),
    FORM("from_m", MEMBER_POINT, from, "m", "second form: start of the upstream face"),
    FORM("to_m", MEMBER_POINT, to, "m", "second form: end of the upstream face"),
    { LINE("path_m", MEMBER_POINTS, AT(path), "m", "from another form",
           "third form: corners of the upstream face"),
      .offset_n = AT(n_points), .least = 2, .limit = SCENE_POINTS_MAX },
    NUMBER("thickness_m", AT(thickness), "m", &positive, "0.005", "of the plate, downstream"),
    WORD("treatment", AT(treatment), treatment_words, "sealed",
         "how the macroscopic model holds cargo"),
    NUMBER("band_m", AT(band), "m", &positive, "8/sqrt(sigma)",
           "width of the outward field (sealed)"),
    NUMBER("slide_width_m", AT(slide_width), "m", &positive, "3/sqrt(sigma) if sealed, else 0.02",
           "width of the slide zone"),
};
static void begin_obstacle(void *item)
{
    scene_obstacle_init(item);
}
const member_table scenario_members_obstacle = {
    TABLE("obstacle", obstacle_members), .size = sizeof(scene_obstacle), .begin = begin_obstacle,
    .forms = obstacle_form_members, .finish = obstacle_form_read
};
#undef AT

#define AT(place) offsetof(scene_shape, place)
#define OF(shape) (1U << (shape))
#define UPRIGHT   (OF(SCENE_CYLINDER) | OF(SCENE_BOX) | OF(SCENE_PRISM))
static const member shape_members[] = {
    WORD("type", AT(type), shape_words, "cylinder",
         "kind of shape; says which other members there are"),
    NUMBER_OF(OF(SCENE_CYLINDER), "radius_m", AT(radius), "m", &positive, "0.012", "of a cylinder"),
    NUMBER_OF(OF(SCENE_BOX), "length_m", AT(length), "m", &positive, NULL, "of a box along x"),
    NUMBER_OF(OF(SCENE_BOX), "width_m", AT(width), "m", &positive, NULL, "of a box along y"),
    NUMBER_OF(UPRIGHT, "height_m", AT(height), "m", &positive, "0.008", "of cylinder, box, prism"),
    { LINE("outline_m", MEMBER_OUTLINE, AT(vertices), "m", NULL,
           "of a prism: convex, counter-clockwise"),
      .offset_n = AT(n_vertices), .least = 3, .limit = SCENE_VERTICES_MAX,
      .tags = OF(SCENE_PRISM) },
    { LINE("vertices_m", MEMBER_VERTICES, AT(vertices), "m", NULL, "of a convex hull"),
      .offset_n = AT(n_vertices), .least = 4, .limit = SCENE_VERTICES_MAX, .tags = OF(SCENE_HULL) },
};
static const member_table shape_table = { TABLE("shape", shape_members), .choice = MEMBER_TAGGED };
#undef AT

#define AT(place) offsetof(scene_material, place)
static const member material_members[] = {
    NUMBER("young_modulus_pa", AT(young_modulus), "Pa", &positive, "of the material", "E"),
    NUMBER("poisson_ratio", AT(poisson_ratio), NULL, &below_half, "of the material", "nu"),
};
static const member_table material_table = { TABLE("material", material_members) };
#undef AT

#define AT(place) offsetof(scene_cargo, place)
#define CARGO_MEMBERS                                                                              \
    OBJECT("shape", AT(shape), shape_table, "{}", "of every part"),                                \
        NUMBER("mass_kg", AT(mass), "kg", &positive, "7850 kg/m3 times the volume", "of a part"),  \
        OBJECT("material", AT(material), material_table, "210e9 Pa, 0.28", "steel")
static const member cargo_members[] = { CARGO_MEMBERS };
static const member_table cargo_table = { TABLE("cargo", cargo_members) };

static const member kind_members[] = {
    NUMBER("share", AT(share), NULL, &positive, "1",
           "how many parts are of the kind, in proportion to all shares"),
    CARGO_MEMBERS,
    NUMBER("spin_friction_radius_m", AT(spin_friction_radius), "m", &not_negative,
           "that of micro if given, else 2/3 of the footprint's radius",
           "lever of the spin friction"),
};
static void begin_kind(void *item)
{
    scene_cargo_init(item);
}
static const member_table kind_table = { TABLE("kind", kind_members), .size = sizeof(scene_cargo),
                                         .begin = begin_kind };
#undef AT

#define AT(place) offsetof(scene_initial, place)
static const member hexagonal_members[] = {
    COUNT("rows", AT(n_rows), NULL, "rows, each along the belt"),
    COUNT("columns", AT(n_columns), NULL, "parts a row"),
    POINT("first_m", AT(first), "first centre of the first row"),
    NUMBER("spacing_m", AT(spacing), "m", &positive, NULL, "between neighbours"),
};
static const member_table hexagonal_table = { TABLE("hexagonal", hexagonal_members) };

static const member random_members[] = {
    COUNT("count", AT(n_random), NULL, "parts"),
    OBJECT("region", AT(region), rect_table, NULL, "centres lie in it"),
    SEED("seed", AT(seed), "1", "of the generator"),
};
static const member_table random_table = { TABLE("random", random_members) };

static const member initial_members[SCENE_INITIAL_COUNT] = {
    [SCENE_INITIAL_POSITIONS] = { LINE("positions_m", MEMBER_POSES, AT(poses), "m, m, deg",
                                       "see initial", "[x, y] or [x, y, heading] of every part"),
                                  .offset_n = AT(n_poses), .least = 1, .limit = SCENE_PARTS_MAX },
    [SCENE_INITIAL_HEXAGONAL] =
        OBJECT("hexagonal", 0, hexagonal_table, "see initial", "rows of a hexagonal packing"),
    [SCENE_INITIAL_RANDOM] =
        OBJECT("random", 0, random_table, "see initial", "random places without overlaps"),
};
static const member_table initial_table = { TABLE("initial", initial_members),
                                            .choice = MEMBER_ONE_OF, .offset_choice = AT(type) };
#undef AT

#define AT(place) offsetof(scene_counter, place)
static const member counter_members[] = {
    ID(AT(id), "upstream, upstream-2, ...", "its name, a column of the curve"),
    INTERVAL("x_m", AT(rect.x_min), "the domain's", "parts from x on and before x"),
    INTERVAL("y_m", AT(rect.y_min), "the domain's", "parts from y on and before y"),
};
static void begin_counter(void *item)
{
    scene_counter_init(item);
}
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
static const member_table counter_table = { TABLE("counter", counter_members),
                                            .size = sizeof(scene_counter), .begin = begin_counter,
                                            .finish = refuse_reserved_id };
#undef AT

#define AT(place) offsetof(scene_output, place)
static const member output_members[] = {
    NUMBER("curve_every_s", AT(curve_every), "s", &positive, "0.01", "samples of the curve"),
    NUMBER("snapshot_every_s", AT(snapshot_every), "s", &positive, "0.1", "density snapshots"),
};
static const member_table output_table = { TABLE("output", output_members) };
#undef AT

#define AT(place) offsetof(scene_macro, place)
static const member macro_members[] = {
    NUMBER("cell_m", AT(cell), "m", &positive, "0.005", "edge of a cell"),
    STEP("step_s", AT(step), "0.00125", "time step; auto: the largest stable and positive one"),
    WORD("scheme", AT(scheme), scheme_words, "roe", "numerical scheme"),
    WORD("heaviside", AT(heaviside), heaviside_words, "sharp", "what lets the dispersion act"),
    NUMBER("heaviside_width", AT(heaviside_width), NULL, &positive, "0.05", "xi of smooth"),
    NUMBER("dispersion_m_s", AT(dispersion), "m/s", &not_negative,
           "twice the speed of the fastest belt", "epsilon"),
    NUMBER("mollifier_per_m2", AT(mollifier), "1/m2", &positive, "10000", "sigma"),
    NUMBER("initial_mollifier_per_m2", AT(initial_mollifier), "1/m2", &positive, "2500",
           "sigma_0 of the density at the start"),
    NUMBER("packing_density_per_m2", AT(packing), "1/m2", &positive,
           "close packing of the shape, cut to four digits", "rho_max, parts/m2 at density 1"),
};
static const member_table macro_table = { TABLE("macro", macro_members) };
#undef AT

#define AT(place) offsetof(scene_micro, place)
static const member micro_members[] = {
    WORD("integrator", AT(integrator), integrator_words, "verlet", "time integration"),
    WORD("path", AT(path), path_words, "auto",
         "equations of motion; auto: planar where all parts are cylinders"),
    STEP("step_s", AT(step), "1e-05; auto if implicit",
         "time step; auto: chosen by the integrator, and stable"),
    NUMBER("modulus_reduction", AT(modulus_reduction), NULL, &from_one, "1000000",
           "all moduli are divided by it"),
    BOOL("tension", AT(tension), "false", "contacts may pull"),
    NUMBER("damping_per_s", AT(damping), "1/s", &not_negative, "0.1", "D of the integration"),
    NUMBER("gravity_m_s2", AT(gravity), "m/s2", &not_negative, "9.81", "of the place"),
    NUMBER("spin_friction_radius_m", AT(spin_friction_radius), "m", &not_negative,
           "2/3 of the footprint's radius", "lever of the spin friction"),
};
static const member_table micro_table = { TABLE("micro", micro_members) };

static const member materials_members[] = {
    OBJECT("conveyor", AT(conveyor), material_table, "40e9 Pa, 0.05", "of the belts"),
    OBJECT("handling", AT(handling), material_table, "70e9 Pa, 0.34", "of obstacles and walls"),
};
static const member_table materials_table = { TABLE("materials", materials_members) };
#undef AT

#define AT(place) offsetof(scene_contact, place)
static const member contact_members[] = {
    NUMBER("length_m", AT(length), "m", &positive, "0.008", "of the contact line"),
    NUMBER("damping_n_s_m", AT(damping), "N s/m", &not_negative, "119, 230, 120", "d"),
    NUMBER("friction", AT(friction), NULL, &not_negative, "0.15, 1.0, 0.19", "mu"),
    NUMBER("tanh_linear_s_m", AT(tanh_linear), "s/m", &positive, "10", "lambda_lin"),
    NUMBER("tanh_spin_s", AT(tanh_spin), "s", &positive, "1", "lambda_ang"),
};
static const member_table contact_table = { TABLE("contact", contact_members) };
#undef AT

#define AT(pair) ((pair) * sizeof(scene_contact))
static const member contacts_members[] = {
    OBJECT("cargo_cargo", AT(SCENE_CARGO_CARGO), contact_table, "{}", "part on part"),
    OBJECT("conveyor_cargo", AT(SCENE_CONVEYOR_CARGO), contact_table, "{}", "belt on part"),
    OBJECT("handling_cargo", AT(SCENE_HANDLING_CARGO), contact_table, "{}",
           "obstacle or wall on part"),
};
static const member_table contacts_table = { TABLE("contacts", contacts_members) };
#undef AT

#define AT(place) offsetof(scene, place)
#define LIST(name, items, n_items, table_, least_, most, std, help)                                \
    {                                                                                              \
        LINE(name, MEMBER_LIST, AT(items), NULL, std, help),                                       \
            .offset_n = AT(n_items), .table = &(table_), .least = (least_), .limit = (most)        \
    }
static const member top_members[] = {
    { LINE("name", MEMBER_TEXT, AT(name), NULL, "empty", "for people"), .limit = SCENE_NAME_SIZE },
    NUMBER("duration_s", AT(duration), "s", &positive, NULL, "simulated time"),
    OBJECT("domain", AT(domain), rect_table, NULL, "the rectangle that is looked at"),
    OBJECT("edges", AT(edges), edge_table, "{}", "what the sides of the domain are"),
    LIST("belts", belts, n_belts, belt_table, 1, SCENE_BELTS_MAX, "[{}]",
         "conveyors; where they overlap the later one wins"),
    LIST("obstacles", obstacles, n_obstacles, scenario_members_obstacle, 0, SCENE_OBSTACLES_MAX,
         "[]", "deflectors standing on the belts"),
    { LINE("cargo", MEMBER_MIX, AT(cargo), NULL, NULL,
           "what is transported; a list is a mix of kinds"),
      .offset_n = AT(n_cargo), .offset_list = AT(is_mix), .table = &cargo_table,
      .items = &kind_table, .least = 1, .limit = SCENE_KINDS_MAX },
    SEED("cargo_seed", AT(cargo_seed), "1", "of the order in which parts of a mix get their kinds"),
    OBJECT("initial", AT(initial), initial_table, NULL, "where it is at the start; one member"),
    LIST("counters", counters, n_counters, counter_table, 1, SCENE_COUNTERS_MAX, "[{}]",
         "parts in a rectangle over time"),
    OBJECT("output", AT(output), output_table, "{}", "when results are taken"),
    OBJECT("macro", AT(macro), macro_table, "{}", "of the macroscopic model"),
    OBJECT("micro", AT(micro), micro_table, "{}", "of the microscopic model"),
    OBJECT("materials", AT(micro), materials_table, "{}", "elastic constants"),
    OBJECT("contacts", AT(micro.contact), contacts_table, "{}", "contact laws"),
};
const member_table scenario_members = { TABLE("scenario", top_members) };
