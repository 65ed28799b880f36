// Bad scenario documents: each is refused with the pointer of what is at fault, and nothing else
// happens.

#include "tests/unit/api/helper_document.h"
#include "tests/unit/helper_cmocka.h"

#include <stdio.h>
#include <string.h>

#define START(initial)                                                                             \
    "{'duration_s': 1, 'domain': {'x_m': [0, 1], 'y_m': [0, 0.6]}, 'cargo': {}, "                  \
    "'initial': " initial "}"
#define SHAPE(shape)                                                                               \
    "{'duration_s': 1, 'domain': {'x_m': [0, 1], 'y_m': [0, 0.6]}, 'cargo': {'shape': " shape "}," \
    "'initial': {'positions_m': [[0.5, 0.3]]}}"
#define OBSTACLE(members) DOCUMENT_WITH("'obstacles': [{" members "}]")
#define CARGO(cargo)                                                                               \
    "{'duration_s': 1, 'domain': {'x_m': [0, 1], 'y_m': [0, 0.6]}, 'cargo': " cargo ","            \
    "'initial': {'positions_m': [[0.5, 0.3]]}}"
#define FLAT_HULL "'type': 'hull', 'vertices_m': [[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]]"
#define LINE      "'from_m': [0.5, 0], 'to_m': [0.6, 0.5]"

// ' stands for " in the documents. text, if any, must stand in the fault's text.
typedef struct bad_document {
    const char *pointer;
    const char *document;
    const char *text;
} bad_document;

static const bad_document not_json[] = {
    { "", "", NULL },
    { "", " \n ", NULL },
    { "", "{", "line 1" },
    { "", "[1, 2", NULL },
    { "", "{'duration_s': }", "not JSON" },
    { "", "{'duration_s': 1,}", NULL },
    { "", "{duration_s: 1}", NULL },
    { "", "{'duration_s': 01}", NULL },
    { "", "{'duration_s': +1}", NULL },
    { "", "{'duration_s': .5}", NULL },
    { "", "{'duration_s': 0x10}", NULL },
    { "", "{} {}", NULL },
    { "", "{'name': 'a\nb'}", NULL },
    { "", "{\n 'name': 'never ends\n", "line 2" },
    { "", "{'name': '\\q'}", NULL },
    { "", "{'name': '\\ud800'}", NULL },
    { "", "{'name': '\xff'}", NULL },
    { "", "\xef\xbb\xbf{}", NULL },
    { "", "// comment\n{}", NULL },
    { "/duration_s", "{'duration_s': NaN}", "line 1, column 16" },
    { "/duration_s", "{'duration_s': -Infinity}", "NaN and Infinity" },
    { "/duration_s", "{'duration_s': 1e999}", "line 1" },
    { "/domain/x_m/1", "{'domain': {'x_m': [0, -1e400]}}", NULL },
    { "/name", "{'name': 'a\\u0000b'}", "line 1, column 19: \\u0000 is not allowed" },
    { "/macro/a\\u0000b", "{'macro': {'a\\u0000b': 1}}",
      "line 1, column 21: \\u0000 is not allowed" },
    { "", "'a\\u0000'", "line 1, column 9: \\u0000 is not allowed" },
    { "/duration_s", "{'duration_s': 1, 'duration_s': 2}", "duplicate" },
    { "/macro/cell_m", "{'macro': {'cell_m': 1,\n\n 'cell_m': 2}}", "line 3" },
    { "/belts/1/id", "{'belts': [{'id': 'a'}, {'id': 'b', 'id': 'c'}]}", NULL },
};

static const bad_document wrong_documents[] = {
    { "", "5", "must be an object, not a number" },
    { "", "null", NULL },
    { "", "'text'", NULL },
    { "", "[]", "must be an object, not an array" },
    { "/duration_s", "{}", "is missing" },
    { "/duration", DOCUMENT_WITH("'duration': 3"), "\"duration_s\"" },
    { "/macros", DOCUMENT_WITH("'macros': {}"), "\"macro\"" },
    { "/zzzzzzzz", DOCUMENT_WITH("'zzzzzzzz': {}"), "unknown member" },
    { "/a~1b~0c", DOCUMENT_WITH("'a/b~c': 1"), "unknown member" },
    { "/", DOCUMENT_WITH("'': 1"), "unknown member" },
    { "/a?b", DOCUMENT_WITH("'a\\u001bb': 1"), "unknown member" },
    { "/macro/cell", DOCUMENT_WITH("'macro': {'cell': 0.005}"), "\"cell_m\"" },
    { "/macro/step_s", DOCUMENT_WITH("'macro': {'step_s': 'automatic'}"), "\"auto\"" },
    { "/macro/step_s", DOCUMENT_WITH("'macro': {'step_s': 0}"), "\"auto\"" },
    { "/macro/step_s", DOCUMENT_WITH("'macro': {'step_s': -0.0}"), NULL },
    { "/macro/step_s", DOCUMENT_WITH("'macro': {'step_s': -1}"), NULL },
    { "/macro/closure", DOCUMENT_WITH("'macro': {'closure': 'jammed'}"),
      "\"congested\", not \"jammed\"" },
    { "/macro/jam_density", DOCUMENT_WITH("'macro': {'jam_density': 1.2}"), "1.2" },
    { "/macro/scheme", DOCUMENT_WITH("'macro': {'scheme': 'upwind'}"),
      "\"roe\", \"muscl\", not \"upwind\"" },
    { "/macro/heaviside", DOCUMENT_WITH("'macro': {'heaviside': 'Sharp'}"), NULL },
    { "/macro/cell_m", DOCUMENT_WITH("'macro': {'cell_m': 0}"), NULL },
    { "/macro/cell_m", DOCUMENT_WITH("'macro': {'cell_m': 1e-6}"), NULL },
    { "/micro/tension", DOCUMENT_WITH("'micro': {'tension': 'no'}"), "true or false" },
    { "/micro/integrator", DOCUMENT_WITH("'micro': {'integrator': 'euler'}"), "\"implicit\"" },
    { "/micro/path", DOCUMENT_WITH("'micro': {'path': 'flat'}"), "\"planar\"" },
    { "/micro/path",
      "{'duration_s': 1, 'domain': {'x_m': [0, 1], 'y_m': [0, 0.6]}, 'cargo': {'shape': {'type':"
      "'box', 'length_m': 0.02, 'width_m': 0.02}}, 'micro': {'path': 'planar'},"
      "'initial': {'positions_m': [[0.5, 0.3]]}}",
      "cylinders" },
    { "/micro/step_s", DOCUMENT_WITH("'micro': {'step_s': 0}"), "\"auto\"" },
    { "/micro/step_s", DOCUMENT_WITH("'micro': {'step_s': 2}"), NULL },
    { "/cargo", CARGO("7"), "an object or a list" },
    { "/cargo", CARGO("[]"), "at least 1" },
    { "/cargo/share", CARGO("{'share': 2}"), "unknown member" },
    { "/cargo/mass_kg", CARGO("{'mass_kg': 0}"), "above 0" },
    { "/cargo/0", CARGO("[7]"), "must be an object" },
    { "/cargo/0/share", CARGO("[{'share': 0}]"), "above 0" },
    { "/cargo/1/share", CARGO("[{}, {'share': -1}]"), NULL },
    { "/cargo/1/mass_kg", CARGO("[{}, {'mass_kg': 0}]"), NULL },
    { "/cargo/1/shape/radius_m", CARGO("[{}, {'shape': {'radius_m': 0}}]"), NULL },
    { "/cargo/1/shape/vertices_m", CARGO("[{}, {'shape': {" FLAT_HULL "}}]"), "degenerate" },
    { "/cargo/1/shape/outline_m",
      CARGO("[{}, {'shape': {'type': 'prism', 'outline_m': [[0, 0], [2, 0], [1, 0.1], [0, 2]]}}]"),
      "convex" },
    { "/cargo/1/spin_friction_radius_m", CARGO("[{}, {'spin_friction_radius_m': -1}]"), NULL },
    { "/cargo", CARGO("[{}, {'shape': {'radius_m': 0.4}}]"), "too unlike" },
    { "/cargo_seed", DOCUMENT_WITH("'cargo_seed': 9007199254740992"), NULL },
    { "/edges/west", DOCUMENT_WITH("'edges': {'west': 'open'}"), NULL },
    { "/edges/middle", DOCUMENT_WITH("'edges': {'middle': 'wall'}"), NULL },
    { "/belts", DOCUMENT_WITH("'belts': []"), "at least 1" },
    { "/belts", DOCUMENT_WITH("'belts': {}"), "must be an array" },
    { "/belts/0", DOCUMENT_WITH("'belts': [7]"), "must be an object" },
    { "/belts/0/id", DOCUMENT_WITH("'belts': [{'id': ''}]"), "must not be empty" },
    { "/belts/0/id", DOCUMENT_WITH("'belts': [{'id': 'a\\nb'}]"), "control" },
    { "/belts/1/id", DOCUMENT_WITH("'belts': [{'id': 'a'}, {'id': 'a'}]"), NULL },
    { "/belts/0/velocity_m_s", DOCUMENT_WITH("'belts': [{'velocity_m_s': [1]}]"), "2 numbers" },
    { "/belts/0/velocity_m_s/1", DOCUMENT_WITH("'belts': [{'velocity_m_s': [1, '2']}]"), NULL },
    { "/belts/0/velocity_m_s",
      DOCUMENT_WITH("'macro': {'dispersion_m_s': 1}, 'belts': [{'velocity_m_s': [1e9, 0]}]"),
      NULL },
    { "/belts/0/polygon_m", DOCUMENT_WITH("'belts': [{'polygon_m': []}]"), "at least 3" },
    { "/belts/0/polygon_m", DOCUMENT_WITH("'belts': [{'polygon_m': [[0, 0], [1, 1]]}]"), NULL },
    { "/belts/0/polygon_m/1/0",
      DOCUMENT_WITH("'belts': [{'polygon_m': [[0, 0], [null, 1], [1, 1]]}]"), NULL },
    { "/obstacles/0", OBSTACLE(""), "exactly one of" },
    { "/obstacles/0", OBSTACLE(LINE ", 'path_m': [[0, 0], [1, 1]]"), "exactly one of" },
    { "/obstacles/0", OBSTACLE(LINE ", 'angle_deg': 1"), "exactly one of" },
    { "/obstacles/0/to_m", OBSTACLE("'from_m': [0, 0]"), "is missing beside from_m" },
    { "/obstacles/0/end_m", OBSTACLE("'angle_deg': 3, 'length_m': 1"), "is missing" },
    { "/obstacles/0/angle_deg", OBSTACLE("'end_m': [0, 0], 'length_m': 1"), NULL },
    { "/obstacles/0/length_m", OBSTACLE("'end_m': [0, 0], 'angle_deg': 1, 'length_m': 0"), "> 0" },
    { "/obstacles/0/length_m", OBSTACLE("'end_m': [0, 0], 'angle_deg': 1, 'length_m': []"), NULL },
    { "/obstacles/0/path_m", OBSTACLE("'path_m': [[0, 0]]"), "at least 2" },
    { "/obstacles/0/treatment", OBSTACLE(LINE ", 'treatment': 'glued'"), "\"sealed\", \"field\"" },
    { "/obstacles/0/thickness_m", OBSTACLE(LINE ", 'thickness_m': -1"), NULL },
    { "/obstacles/0/band", OBSTACLE(LINE ", 'band': 1"), "\"band_m\"" },
    { "/cargo/shape/type", SHAPE("{'type': 'ball'}"), "\"cylinder\"" },
    { "/cargo/shape/type", SHAPE("{'type': 3, 'radius_m': 'x'}"), "must be one of" },
    { "/cargo/shape/length_m", SHAPE("{'length_m': 1}"), "does not belong to this shape" },
    { "/cargo/shape/radius_m", SHAPE("{'type': 'box', 'radius_m': 1}"), "does not belong" },
    { "/cargo/shape/length_m", SHAPE("{'type': 'box', 'width_m': 0.1}"), "is missing" },
    { "/cargo/shape/outline_m", SHAPE("{'type': 'prism'}"), "is missing" },
    { "/cargo/shape/outline_m", SHAPE("{'type': 'prism', 'outline_m': [[0, 0], [1, 0]]}"), NULL },
    { "/cargo/shape/vertices_m/0", SHAPE("{'type': 'hull', 'vertices_m': [[1], [2], [3], [4]]}"),
      "3 numbers" },
    { "/cargo/shape/radius_m", SHAPE("{'radius_m': 0}"), NULL },
    { "/initial", START("{}"), "exactly one" },
    { "/initial", START("{'positions_m': [[0.5, 0.3]], 'random': {}}"), "exactly one" },
    { "/initial/positions_m", START("{'positions_m': []}"), "at least 1" },
    { "/initial/positions_m/1", START("{'positions_m': [[0.5, 0.3], [1]]}"), "2 to 3 numbers" },
    { "/initial/positions_m/0/2", START("{'positions_m': [[0.5, 0.3, 'north']]}"), NULL },
    { "/initial/positions_m/1", START("{'positions_m': [[0.5, 0.3], [0.5, 0.301]]}"), "overlaps" },
    { "/initial/positions_m/0", START("{'positions_m': [[5, 5]]}"), NULL },
    { "/initial/hexagonal/rows",
      START("{'hexagonal': {'rows': 1.5, 'columns': 1, 'first_m': [0.5, 0.3], 'spacing_m': 1}}"),
      "whole number" },
    { "/initial/hexagonal/rows",
      START("{'hexagonal': {'rows': -1, 'columns': 1, 'first_m': [0.5, 0.3], 'spacing_m': 1}}"),
      "not -1" },
    { "/initial/hexagonal/rows",
      START("{'hexagonal': {'rows': 0, 'columns': 1, 'first_m': [0.5, 0.3], 'spacing_m': 1}}"),
      NULL },
    { "/initial/hexagonal",
      START("{'hexagonal': {'rows': 2e3, 'columns': 1e3, 'first_m': [0.5, 0.3], 'spacing_m': 1}}"),
      "limit" },
    { "/initial/hexagonal/spacing_m",
      START("{'hexagonal': {'rows': 1, 'columns': 1, 'first_m': [0.5, 0.3]}}"), "is missing" },
    { "/initial/random/seed",
      START("{'random': {'count': 1, 'seed': 1e17, 'region': {'x_m': [0, 1], 'y_m': [0, 0.6]}}}"),
      "9007199254740991" },
    { "/initial/random/region", START("{'random': {'count': 1}}"), "is missing" },
    { "/counters/0/id", DOCUMENT_WITH("'counters': [{'id': 'a,b'}]"), NULL },
    { "/counters/0/id", DOCUMENT_WITH("'counters': [{'id': 'left_domain'}]"), NULL },
    { "/counters/0/id", DOCUMENT_WITH("'counters': [{'id': 'first'}]"), "curve event" },
    { "/counters/0/x_m", DOCUMENT_WITH("'counters': [{'x_m': [1, 0]}]"), NULL },
    { "/output/curve_every_s", DOCUMENT_WITH("'output': {'curve_every_s': 1e-9}"), NULL },
    { "/materials/conveyor/poisson_ratio",
      DOCUMENT_WITH("'materials': {'conveyor': {'poisson_ratio': 0.5}}"), NULL },
    { "/contacts/cargo_cargo/friction",
      DOCUMENT_WITH("'contacts': {'cargo_cargo': {'friction': -1}}"), NULL },
};

static bf_faults faults;

static void check_bad(const bad_document *bad)
{
    bf_buffer document = document_quote(bad->document);
    bf_error err = { 0 };

    document_refuse(document.bytes, document.n, &faults, &err);
    if (strcmp(err.pointer, bad->pointer) != 0)
        fail_msg("%s: at \"%s\" (%s), not at \"%s\"", bad->document, err.pointer, err.text,
                 bad->pointer);
    if (bad->text != NULL && strstr(err.text, bad->text) == NULL)
        fail_msg("%s: \"%s\" lacks \"%s\"", bad->document, err.text, bad->text);
    buffer_fini(&document);
}

static void what_is_not_json_is_refused_with_its_place(void **unused)
{
    for (size_t k = 0; k < sizeof not_json / sizeof *not_json; k++)
        check_bad(&not_json[k]);
}

static void what_is_wrong_is_pointed_at(void **unused)
{
    for (size_t k = 0; k < sizeof wrong_documents / sizeof *wrong_documents; k++)
        check_bad(&wrong_documents[k]);
}

static void all_faults_are_found_in_one_pass(void **unused)
{
    bf_buffer document = document_quote(
        DOCUMENT_WITH("'name': 3, 'belts': [{'id': 1}, {}, {'velocity_m_s': [0]}], 'macro':"
                      "{'cel_m': 1, 'step_s': true}, 'initials': 0"));
    static const char *const pointers[] = {
        "/name",        "/belts/0/id",   "/belts/2/velocity_m_s",
        "/macro/cel_m", "/macro/step_s", "/initials"
    };
    bf_error err;

    document_refuse(document.bytes, document.n, &faults, &err);
    assert_int_equal(faults.n, sizeof pointers / sizeof *pointers);
    for (size_t k = 0; k < sizeof pointers / sizeof *pointers; k++)
        assert_true(document_has_fault(&faults, pointers[k]));
    buffer_fini(&document);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_is_not_json_is_refused_with_its_place),
        cmocka_unit_test(what_is_wrong_is_pointed_at),
        cmocka_unit_test(all_faults_are_found_in_one_pass),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
