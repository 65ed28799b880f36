// Scenarios that are at fault: what is wrong, how it is made, and the place that must be named.
// Each is the good scenario below with one change.

// A scenario without fault that has every member a fault below needs.
export function goodScenario() {
  return {
    name: "good",
    duration_s: 0.5,
    domain: { x_m: [0.0, 1.0], y_m: [0.0, 0.6] },
    edges: { west: "inflow", east: "outflow", south: "wall", north: "wall" },
    belts: [{ id: "main", velocity_m_s: [0.395, 0.0] }],
    obstacles: [
      {
        id: "singularizer",
        end_m: [0.75, 0.5],
        angle_deg: 60.0,
        length_m: 0.57735027,
        thickness_m: 0.005,
        treatment: "sealed",
        band_m: 0.08,
        slide_width_m: 0.03,
      },
    ],
    cargo: { shape: { type: "cylinder", radius_m: 0.012, height_m: 0.008 }, mass_kg: 0.02841 },
    initial: { positions_m: [[0.1, 0.1], [0.2, 0.1], [0.3, 0.1]] },
    counters: [{ id: "upstream", x_m: [0.0, 0.75] }],
    output: { curve_every_s: 0.01, snapshot_every_s: 0.1 },
    macro: {
      cell_m: 0.01,
      step_s: 0.00125,
      scheme: "roe",
      heaviside: "sharp",
      dispersion_m_s: 0.79,
      mollifier_per_m2: 10000,
      initial_mollifier_per_m2: 2500,
    },
    micro: { step_s: 1e-5, modulus_reduction: 1e6, tension: false },
  };
}

const polygon = (n) => Array.from({ length: n }, (_, k) => [
  0.5 + 0.3 * Math.cos((2 * Math.PI * k) / n),
  0.3 + 0.2 * Math.sin((2 * Math.PI * k) / n),
]);

// [what is wrong, change of the good scenario, pointer within the scenario]
export const badScenarios = [
  // Members that are missing, unknown or of the wrong type.
  ["no duration", (s) => delete s.duration_s, "/duration_s"],
  ["no domain", (s) => delete s.domain, "/domain"],
  ["half a domain", (s) => delete s.domain.y_m, "/domain/y_m"],
  ["no cargo", (s) => delete s.cargo, "/cargo"],
  ["no source of cargo", (s) => delete s.initial, "/initial"],
  ["an unknown member", (s) => (s.duration = 6), "/duration"],
  ["an unknown member deep down", (s) => (s.macro.cells_m = 0.01), "/macro/cells_m"],
  ["a name that needs escapes", (s) => (s["a/b~c"] = 1), "/a~1b~0c"],
  ["a duration as text", (s) => (s.duration_s = "6"), "/duration_s"],
  ["a duration that is null", (s) => (s.duration_s = null), "/duration_s"],
  ["a domain as a list", (s) => (s.domain = []), "/domain"],
  ["belts that are no list", (s) => (s.belts = {}), "/belts"],
  ["a belt that is no object", (s) => (s.belts = [1]), "/belts/0"],
  ["a pair of three", (s) => (s.domain.x_m = [0, 1, 2]), "/domain/x_m"],
  ["a pair with text in it", (s) => (s.domain.x_m = [0, "1"]), "/domain/x_m/1"],
  ["a truth that is a number", (s) => (s.micro.tension = 1), "/micro/tension"],
  ["a name that is a number", (s) => (s.name = 7), "/name"],

  // Numbers out of range.
  ["a duration of zero", (s) => (s.duration_s = 0), "/duration_s"],
  ["a negative duration", (s) => (s.duration_s = -1), "/duration_s"],
  ["a cell of zero", (s) => (s.macro.cell_m = 0), "/macro/cell_m"],
  ["a negative dispersion", (s) => (s.macro.dispersion_m_s = -0.1), "/macro/dispersion_m_s"],
  ["a mollifier of zero", (s) => (s.macro.mollifier_per_m2 = 0), "/macro/mollifier_per_m2"],
  ["an initial mollifier of zero", (s) => (s.macro.initial_mollifier_per_m2 = 0),
    "/macro/initial_mollifier_per_m2"],
  ["a radius of zero", (s) => (s.cargo.shape.radius_m = 0), "/cargo/shape/radius_m"],
  ["a negative mass", (s) => (s.cargo.mass_kg = -1), "/cargo/mass_kg"],
  ["a plate without thickness", (s) => (s.obstacles[0].thickness_m = 0),
    "/obstacles/0/thickness_m"],
  ["a negative band", (s) => (s.obstacles[0].band_m = -0.08), "/obstacles/0/band_m"],
  ["an obstacle without length", (s) => (s.obstacles[0].length_m = 0), "/obstacles/0/length_m"],
  ["samples at no distance", (s) => (s.output.curve_every_s = 0), "/output/curve_every_s"],
  ["a modulus that is raised", (s) => (s.micro.modulus_reduction = 0.5),
    "/micro/modulus_reduction"],
  ["a micro step of zero", (s) => (s.micro.step_s = 0), "/micro/step_s"],

  // Words that are none.
  ["a shape of no kind", (s) => (s.cargo.shape.type = "ball"), "/cargo/shape/type"],
  ["an edge of no kind", (s) => (s.edges.west = "open"), "/edges/west"],
  ["a treatment of no kind", (s) => (s.obstacles[0].treatment = "glue"),
    "/obstacles/0/treatment"],
  ["a scheme of no kind", (s) => (s.macro.scheme = "godunov"), "/macro/scheme"],
  ["a step that is no number and not auto", (s) => (s.macro.step_s = "quick"), "/macro/step_s"],
  ["a Heaviside of no kind", (s) => (s.macro.heaviside = "soft"), "/macro/heaviside"],

  // Geometry.
  ["a domain inside out", (s) => (s.domain.x_m = [1, 0]), "/domain/x_m"],
  ["a domain without width", (s) => (s.domain.y_m = [0.3, 0.3]), "/domain/y_m"],
  ["a domain that is no whole number of cells", (s) => (s.domain.x_m = [0, 1.003]),
    "/macro/cell_m"],
  ["a belt of two corners", (s) => (s.belts[0].polygon_m = polygon(2)), "/belts/0/polygon_m"],
  ["a belt that crosses itself",
    (s) => (s.belts[0].polygon_m = [[0, 0], [1, 0.6], [1, 0], [0, 0.6]]), "/belts/0/polygon_m"],
  ["two belts of one id", (s) => s.belts.push({ id: "main", velocity_m_s: [0.1, 0] }),
    "/belts/1/id"],
  ["two counters of one id", (s) => s.counters.push({ id: "upstream", x_m: [0, 0.1] }),
    "/counters/1/id"],
  ["a counter inside out", (s) => (s.counters[0].x_m = [0.75, 0]), "/counters/0/x_m"],
  ["an obstacle of one point", (s) => (s.obstacles = [{ path_m: [[0.5, 0.1]] }]),
    "/obstacles/0/path_m"],
  ["an obstacle from a point to itself",
    (s) => (s.obstacles = [{ from_m: [0.5, 0.1], to_m: [0.5, 0.1] }]), "/obstacles/0"],
  ["an obstacle given twice", (s) => (s.obstacles[0].path_m = [[0.5, 0.1], [0.6, 0.1]]),
    "/obstacles/0"],

  // Sources of cargo.
  ["two sources of cargo",
    (s) => (s.initial.hexagonal = { rows: 1, columns: 1, first_m: [0.5, 0.3], spacing_m: 0.1 }),
    "/initial"],
  ["no parts", (s) => (s.initial.positions_m = []), "/initial/positions_m"],
  ["a part outside the domain", (s) => (s.initial.positions_m[1] = [1.2, 0.1]),
    "/initial/positions_m/1"],
  ["a part in a wall", (s) => (s.initial.positions_m[1] = [0.2, 0.005]),
    "/initial/positions_m/1"],
  ["parts that overlap", (s) => (s.initial.positions_m[2] = [0.21, 0.1]),
    "/initial/positions_m/2"],
  ["a part of four numbers", (s) => (s.initial.positions_m[0] = [0.1, 0.1, 0, 0]),
    "/initial/positions_m/0"],
  ["rows of no parts",
    (s) => (s.initial = { hexagonal: { rows: 0, columns: 2, first_m: [0.1, 0.1], spacing_m: 0.1 } }),
    "/initial/hexagonal/rows"],
  ["half a row",
    (s) => (s.initial = { hexagonal: { rows: 1.5, columns: 2, first_m: [0.1, 0.1], spacing_m: 0.1 } }),
    "/initial/hexagonal/rows"],
  ["rows that overlap",
    (s) => (s.initial = { hexagonal: { rows: 2, columns: 2, first_m: [0.1, 0.1], spacing_m: 0.01 } }),
    "/initial/hexagonal"],
  ["more random parts than there is room for",
    (s) => (s.initial = { random: { count: 1000, region: { x_m: [0.1, 0.2], y_m: [0.1, 0.2] } } }),
    "/initial/random"],

  // Too large, or unstable.
  ["10^12 cells", (s) => (s.macro.cell_m = 7.745966692e-7), "/macro/cell_m"],
  ["more parts than the limit",
    (s) => (s.initial = { hexagonal: { rows: 4e9, columns: 4e9, first_m: [0, 0], spacing_m: 1 } }),
    "/initial/hexagonal"],
  ["more samples than the limit", (s) => (s.output.curve_every_s = 1e-9), "/output/curve_every_s"],
  ["more snapshots than the limit", (s) => (s.output.snapshot_every_s = 1e-6),
    "/output/snapshot_every_s"],
  ["a step beyond CFL", (s) => (s.macro.step_s = 0.1), "/macro/step_s"],
  ["a step so small that there are too many",
    (s) => {
      s.duration_s = 1e4;
      s.output = { curve_every_s: 10, snapshot_every_s: 100 };
      s.macro.step_s = 1e-9;
    },
    "/macro/step_s"],
  ["a belt too fast for the step", (s) => (s.belts[0].velocity_m_s = [100, 0]), "/macro/step_s"],
  ["a belt faster than any", (s) => (s.belts[0].velocity_m_s = [1e9, 0]),
    "/belts/0/velocity_m_s"],
  ["a mollifier that reaches over too many cells", (s) => (s.macro.mollifier_per_m2 = 1e-6),
    "/macro/mollifier_per_m2"],
  ["a name of a million letters", (s) => (s.name = "x".repeat(900_000)), "/name"],
  ["an id of a hundred letters", (s) => (s.counters[0].id = "x".repeat(100)), "/counters/0/id"],
  ["more belts than the limit",
    (s) => (s.belts = Array.from({ length: 300 }, (_, k) => ({ id: `b${k}`, velocity_m_s: [0.1, 0] }))),
    "/belts"],
  ["more counters than the limit",
    (s) => (s.counters = Array.from({ length: 40 }, (_, k) => ({ id: `c${k}`, x_m: [0, 0.1] }))),
    "/counters"],
];

const nested = (n) => `/scenario/belts${"/0".repeat(n)}`;

// Texts that are no JSON, or not the strict kind that is read here. Where the place of the fault has
// a pointer, it is named (422); else the text is no document at all (400).
export const badTexts = [
  ["nothing", ""],
  ["blanks", "  \n"],
  ["half a document", '{"scenario": {"duration_s": 6'],
  ["a comma too many", '{"scenario": {},}'],
  ["two documents", "{} {}"],
  ["a word", "scenario"],
  ["a number that is not one", '{"scenario": {"duration_s": NaN}}', "/scenario/duration_s"],
  ["an infinite number", '{"scenario": {"duration_s": Infinity}}', "/scenario/duration_s"],
  ["a number beyond all doubles", '{"scenario": {"duration_s": 1e999}}', "/scenario/duration_s"],
  ["a hexadecimal number", '{"scenario": {"duration_s": 0x10}}'],
  ["a number with a leading zero", '{"scenario": {"duration_s": 06}}'],
  ["single quotes", "{'scenario': {}}"],
  ["a comment", '{"scenario": {} /* good */}'],
  ["a key given twice", '{"scenario": {"duration_s": 1, "duration_s": 2}}', "/scenario/duration_s"],
  ["a broken escape", '{"scenario": {"name": "\\q"}}'],
  ["half a surrogate pair", '{"scenario": {"name": "\\ud800"}}'],
  ["a NUL in a text", '{"scenario": {"name": "a\\u0000b"}}'],
  ["bytes that are not UTF-8", Buffer.from([0x7b, 0x22, 0xff, 0xfe, 0x22, 0x3a, 0x31, 0x7d])],
  ["a NUL byte", Buffer.from('{"scenario": {}}\0')],
  ["100,000 nested arrays", "[".repeat(100_000), "/0".repeat(32)],
  ["100,000 nested arrays, closed", "[".repeat(100_000) + "]".repeat(100_000),
    "/0".repeat(32)],
  ["33 nested arrays in a member", `{"scenario": {"belts": ${"[".repeat(33)}${"]".repeat(33)}}}`,
    nested(30)],
  ["nested objects", '{"a":'.repeat(50_000), "/a".repeat(32)],
];

// Bodies whose envelope is at fault: [what, body, pointer].
export const badEnvelopes = [
  ["a list", [], ""],
  ["no scenario", {}, "/scenario"],
  ["a scenario as text", { scenario: "example-1" }, "/scenario"],
  ["an unknown member", { scenario: goodScenario(), models: "macro" }, "/models"],
  ["a model of no kind", { scenario: goodScenario(), model: "nano" }, "/model"],
  ["a label as a number", { scenario: goodScenario(), label: 1 }, "/label"],
  ["a label that is too long", { scenario: goodScenario(), label: "x".repeat(101) }, "/label"],
  ["a priority as text", { scenario: goodScenario(), priority: "high" }, "/priority"],
  ["a priority beyond the limit", { scenario: goodScenario(), priority: 101 }, "/priority"],
  ["half a priority", { scenario: goodScenario(), priority: 0.5 }, "/priority"],
];
