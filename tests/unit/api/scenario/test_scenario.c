// Scenario documents: what is read stands in the struct, what is written reads back as the same.

#include "api/scenario/scenario.h"

#include "api/scenario/scenario_members.h"
#include "core/base/memory.h"
#include "core/base/random.h"
#include "core/scene/definition.h"
#include "tests/unit/api/helper_document.h"
#include "tests/unit/helper_cmocka.h"

#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static bf_faults faults;

static bf_status read_bytes(const bf_buffer *document, scene *ret_scene, bf_error *err)
{
    faults.n = 0;
    return scenario_read(document->bytes, document->n, ret_scene, &faults, err);
}

// Reads a document that is in order; ' stands for ".
static scene read_text(const char *text)
{
    bf_buffer document = document_quote(text);
    bf_error err = { 0 };
    scene s;

    bf_status status = read_bytes(&document, &s, &err);
    buffer_fini(&document);
    if (status != BF_OK)
        fail_msg("%s: %s", err.pointer, err.text);
    return s;
}

static bf_buffer write_scene(const scene *s)
{
    bf_buffer b = { 0 };

    assert_int_equal(scenario_write(s, &b, NULL), BF_OK);
    return b;
}

static bf_buffer resolve(const bf_buffer *document)
{
    bf_error err = { 0 };
    scene s;

    if (read_bytes(document, &s, &err) != BF_OK)
        fail_msg("%s: %s", err.pointer, err.text);
    bf_buffer written = write_scene(&s);
    scene_fini(&s);
    return written;
}

static void the_needed_members_suffice(void **unused)
{
    scene s = read_text("{" DOCUMENT_NEEDED "}");

    assert_string_equal(s.name, "");
    assert_true(s.duration == 1.0);
    assert_true(s.domain.x_min == 0.0 && s.domain.x_max == 1.0);
    assert_true(s.domain.y_min == 0.0 && s.domain.y_max == 0.6);
    assert_int_equal(s.n_belts, 1);
    assert_string_equal(s.belts[0].id, "main");
    assert_int_equal(s.n_obstacles, 0);
    assert_int_equal(s.n_counters, 1);
    assert_string_equal(s.counters[0].id, "upstream");
    assert_true(s.counters[0].rect.x_max == 1.0);
    assert_int_equal(s.initial.type, SCENE_INITIAL_POSITIONS);
    assert_int_equal(s.initial.n_poses, 1);
    scene_fini(&s);
}

static void every_member_finds_its_place(void **unused)
{
    bf_buffer document = document_complete();
    scene s;

    assert_int_equal(read_bytes(&document, &s, NULL), BF_OK);
    assert_string_equal(s.name, "All members");
    assert_true(s.domain.x_min == -0.5 && s.domain.y_max == 0.9);
    assert_int_equal(s.edges[SCENE_WEST], SCENE_EDGE_WALL);
    assert_int_equal(s.edges[SCENE_EAST], SCENE_EDGE_INFLOW);
    assert_int_equal(s.edges[SCENE_SOUTH], SCENE_EDGE_OUTFLOW);
    assert_int_equal(s.belts[0].n_points, 0);
    assert_true(s.belts[0].acceleration == 0.5 && s.belts[0].deceleration == 0.25);
    assert_int_equal(s.belts[0].speed_schedule.n_times, 3);
    assert_int_equal(s.belts[0].speed_schedule.n_factors, 3);
    assert_true(s.belts[0].speed_schedule.times[2] == 2.25);
    assert_true(s.belts[0].speed_schedule.factors[2] == 1.25);
    const scene_stops *stops = &s.belts[0].stops;
    assert_true(stops->n_failures == 2 && stops->n_breaks == 1);
    assert_string_equal(stops->failures[0].id, "rare");
    assert_true(stops->failures[0].type == SCENE_FAILURE_DRAWN);
    assert_true(stops->failures[0].between.mean == 600.0 && stops->failures[0].repair.mean == 60.0);
    assert_true(stops->failures[0].between.law == SCENE_TIME_WEIBULL);
    assert_true(stops->failures[0].between.shape == 1.5);
    assert_true(stops->failures[0].repair.law == SCENE_TIME_FIXED);
    assert_true(stops->failures[1].type == SCENE_FAILURE_LISTED);
    assert_true(stops->failures[1].times[1] == 2.0 && stops->failures[1].durations[1] == 0.5);
    assert_true(stops->breaks[0].start == 3.0 && stops->breaks[0].every == 2.0);
    assert_true(stops->substream == s.substream && stops->until == s.duration);
    assert_int_equal(s.belts[1].speed_schedule.n_times, 0);
    assert_true(s.belts[1].acceleration == INFINITY && s.belts[1].deceleration == INFINITY);
    assert_true(s.belts[1].velocity.y == 0.2 && s.belts[1].polygon[2].y == 0.8);
    assert_int_equal(s.obstacles[0].n_points, 3);
    assert_true(s.obstacles[0].path[2].x == 0.9 && s.obstacles[0].slide_width == 0.025);
    assert_int_equal(s.obstacles[0].treatment, SCENE_FIELD);
    assert_int_equal(s.cargo[0].shape.type, SCENE_BOX);
    assert_true(s.cargo[0].shape.width == 0.03 && s.cargo[0].mass == 0.5);
    assert_true(fabs(s.initial.poses[2].heading + 2.0 * M_PI / 3.0) < 1e-15);
    assert_true(s.counters[0].rect.y_min == 0.2 && s.counters[1].rect.x_min == -0.5);
    assert_true(s.output.snapshot_every == 0.25);
    assert_true(s.macro.step == 0.0 && s.macro.initial_mollifier == 3000);
    assert_int_equal(s.macro.closure, SCENE_CONGESTED);
    assert_true(s.macro.jam_density == 0.85);
    assert_int_equal(s.macro.heaviside, SCENE_HEAVISIDE_SMOOTH);
    assert_true(s.micro.tension && s.micro.spin_friction_radius == 0.01);
    assert_int_equal(s.micro.integrator, SCENE_IMPLICIT);
    assert_int_equal(s.micro.path, SCENE_PATH_SPATIAL);
    assert_true(s.micro.step == 2e-5 && s.cargo_seed == 7);
    assert_false(s.is_mix);
    assert_true(s.micro.handling.young_modulus == 6e10);
    assert_true(s.micro.contact[SCENE_HANDLING_CARGO].tanh_spin == 4);
    assert_true(s.micro.wall_friction == 0.1);
    assert_true(s.micro.contact[SCENE_CONVEYOR_CARGO].damping == 200);
    scene_fini(&s);
    buffer_fini(&document);
}

static void cargo_may_be_a_list_of_kinds(void **unused)
{
    scene s = read_text(
        "{'duration_s': 1, 'domain': {'x_m': [0, 1], 'y_m': [0, 0.6]}, 'cargo': [{'share': 3},"
        "{'shape': {'type': 'prism', 'outline_m': [[0, 0], [0.02, 0], [0, 0.02]]},"
        " 'spin_friction_radius_m': 0.5}], 'initial': {'positions_m': [[0.2, 0.3]]}}");

    assert_int_equal(s.n_cargo, 2);
    assert_true(s.is_mix && s.cargo_seed == 1);
    assert_true(s.cargo[0].share == 3.0 && s.cargo[1].share == 1.0);
    assert_int_equal(s.cargo[0].shape.type, SCENE_CYLINDER);
    assert_int_equal(s.cargo[1].shape.n_vertices, 3);
    // 2/3 of the first kind's radius, and the second kind's own.
    assert_true(fabs(s.cargo[0].spin_friction_radius - 0.008) < 1e-17);
    assert_true(s.cargo[1].spin_friction_radius == 0.5);
    scene_fini(&s);
}

// What a document says of one kind is one object again, without a share.
static void one_kind_is_written_as_one_object(void **unused)
{
    bf_buffer one = document_quote("{" DOCUMENT_NEEDED "}");
    bf_buffer list = document_quote("{'duration_s': 1, 'domain': {'x_m': [0, 1], 'y_m': [0, 0.6]},"
                                    "'cargo': [{}], 'initial': {'positions_m': [[0.2, 0.3]]}}");
    bf_buffer of_one = resolve(&one), of_list = resolve(&list);

    assert_non_null(strstr(of_one.bytes, "\"cargo\":{\"shape\":{\"type\":\"cylinder\""));
    assert_null(strstr(of_one.bytes, "share"));
    assert_non_null(strstr(of_list.bytes, "\"cargo\":[{\"share\":1,\"shape\":"));
    buffer_fini(&one);
    buffer_fini(&list);
    buffer_fini(&of_one);
    buffer_fini(&of_list);
}

// The integrator says which step is the default: the paper's, or its own choice.
static void the_default_step_follows_the_integrator(void **unused)
{
    scene verlet = read_text(DOCUMENT_WITH("'micro': {'integrator': 'verlet'}"));
    scene none = read_text("{" DOCUMENT_NEEDED "}");
    scene implicit = read_text(DOCUMENT_WITH("'micro': {'integrator': 'implicit'}"));
    scene automatic = read_text(DOCUMENT_WITH("'micro': {'step_s': 'auto'}"));

    assert_true(verlet.micro.step == 1e-5);
    assert_true(none.micro.step == 0.0);
    assert_true(implicit.micro.step == 0.0);
    assert_true(automatic.micro.step == 0.0);
    scene_fini(&verlet);
    scene_fini(&none);
    scene_fini(&implicit);
    scene_fini(&automatic);
}

// So the document of a belt without them is the one that it always was.
static void how_a_speed_changes_is_written_only_where_it_was_given(void **unused)
{
    bf_buffer without = document_quote("{" DOCUMENT_NEEDED "}");
    bf_buffer with = document_quote(DOCUMENT_WITH("'belts': [{'deceleration_m_s2': 2}]"));
    bf_buffer of_none = resolve(&without), of_one = resolve(&with);

    assert_non_null(strstr(of_none.bytes, "[{\"id\":\"main\",\"velocity_m_s\":[0.395,0]}]"));
    assert_non_null(strstr(of_one.bytes, "[0.395,0],\"deceleration_m_s2\":2}]"));
    buffer_fini(&without);
    buffer_fini(&with);
    buffer_fini(&of_none);
    buffer_fini(&of_one);
}

// Value by value, as a JSON library sees both; numbers may be written differently.
static void a_complete_document_is_written_as_it_was_read(void **unused)
{
    bf_buffer document = document_complete();
    bf_buffer written = resolve(&document);

    json_t *before = json_loadb(document.bytes, document.n, JSON_DECODE_INT_AS_REAL, NULL);
    json_t *after = json_loadb(written.bytes, written.n, JSON_DECODE_INT_AS_REAL, NULL);
    // What the document left to the defaults: the second counter is the domain.
    json_t *right = json_array_get(json_object_get(before, "counters"), 1);
    json_object_set_new(right, "x_m", json_pack("[f, f]", -0.5, 1.0));
    json_object_set_new(right, "y_m", json_pack("[f, f]", 0.1, 0.9));
    assert_true(json_equal(before, after));
    json_decref(before);
    json_decref(after);
    buffer_fini(&document);
    buffer_fini(&written);
}

// Documents of what moves and feeds: the definition is the same, and what is written of it.
static void a_fed_document_keeps_its_definition(void **unused)
{
    bf_buffer document = document_fed();
    scene s, back;

    bf_status status = read_bytes(&document, &s, NULL);
    if (status != BF_OK)
        fail_msg("%s: %s", faults.items[0].pointer, faults.items[0].text);
    bf_buffer once = write_scene(&s);
    assert_int_equal(read_bytes(&once, &back, NULL), BF_OK);
    bf_buffer twice = write_scene(&back);
    assert_string_equal(once.bytes, twice.bytes);
    assert_true(definition_digest(&s) == definition_digest(&back));
    scene_fini(&s);
    scene_fini(&back);
    buffer_fini(&document);
    buffer_fini(&once);
    buffer_fini(&twice);
}

static void what_feeds_and_moves_finds_its_place(void **unused)
{
    bf_buffer document = document_fed();
    scene s;

    assert_int_equal(read_bytes(&document, &s, NULL), BF_OK);
    const scene_obstacle *swing = &s.obstacles[0], *stop = &s.obstacles[1], *arm = &s.obstacles[2];
    assert_true(swing->pivot.x == 0.55 && swing->turn.n_times == 3 && swing->turn.repeat == 10);
    assert_true(swing->turn.values[2] == 35.3 * M_PI / 180.0 && swing->presence.n_times == 0);
    assert_true(stop->presence.values[0] == 1.0 && stop->presence.values[1] == 0.0);
    assert_true(stop->presence.times[1] == 5.5 && stop->presence.repeat == 6);
    assert_true(stop->pivot.x == 0.8 && stop->turn.n_times == 0 && stop->is_commanded);
    assert_true(arm->pivot.x == 0.4 && arm->is_commanded && !swing->is_commanded);
    assert_int_equal(s.initial.type, SCENE_INITIAL_EMPTY);
    assert_int_equal(s.n_feeds, 3);
    const scene_feed *mix = &s.feeds[0], *shift = &s.feeds[1], *list = &s.feeds[2];
    assert_true(mix->is_edge && mix->edge == SCENE_WEST && mix->line[1].y == 0.3);
    assert_true(mix->line[0].x == 0.0 && mix->line[1].x == 0.0 && mix->line[0].y == 0.05);
    assert_true(mix->start == 0.5 && mix->end == 10 && mix->count == 100 && mix->rate == 3.5);
    assert_true(mix->arrivals == SCENE_ARRIVALS_ERLANG && mix->shape == 3 && mix->batch_size == 4);
    assert_true(mix->demand == SCENE_DEMAND_RATE && mix->has_random_heading && mix->seed == 11);
    assert_true(mix->n_cargo == 2 && mix->cargo[0].kind == 1 && mix->cargo[0].share == 3);
    assert_true(mix->cargo[1].kind == 0 && mix->cargo[1].share == 1);
    assert_true(mix->when_blocked == SCENE_BLOCKED_DISCARD && mix->max_wait == 4);
    assert_true(!shift->is_edge && shift->line[0].y == 0.36 && shift->line[1].x == 0.12);
    assert_true(shift->demand == SCENE_DEMAND_PROFILE && shift->profile.values[1] == 2);
    assert_true(shift->profile.repeat == 12 && shift->end == INFINITY && shift->count == INFINITY);
    assert_true(shift->heading == 33.3 * M_PI / 180.0 && !shift->has_random_heading);
    assert_true(shift->n_cargo == 2 && shift->cargo[0].share == 2);
    assert_string_equal(list->id, "feed-3");
    assert_true(list->demand == SCENE_DEMAND_SCHEDULE && list->schedule.n == 3);
    assert_true(list->schedule.counts[2] == 3 && list->schedule.kinds[1] == 1);
    assert_true(isnan(list->schedule.places[1]) && list->schedule.places[2] == 1.0);
    assert_true(isnan(list->schedule.headings[1]));
    assert_string_equal(s.cargo[1].id, "cargo-2");
    assert_true(s.substream == 7 && s.warmup == 3 && s.jam_time == 6);
    assert_true(s.until == SCENE_UNTIL_STEADY && s.steady_precision == 0.02);
    assert_true(s.eyes[0].line[1].y == 0.6 && s.eyes[0].block_time == 1);
    assert_true(s.eyes[0].clear_time == 0.5 && s.eyes[0].density_ratio == 0.7);
    assert_true(s.actions[0].type == SCENE_ACTION_BELT && s.actions[0].target == 0);
    assert_true(s.actions[0].when_blocked && s.actions[0].value == 0.25);
    assert_true(s.actions[1].type == SCENE_ACTION_TURN && s.actions[1].target == 2);
    assert_true(!s.actions[1].when_blocked && s.actions[1].delay == 1.5);
    assert_true(s.actions[1].value == 35.3 * M_PI / 180.0 && s.actions[1].over == 0.75);
    assert_true(s.actions[2].type == SCENE_ACTION_PRESENCE && s.actions[2].target == 1);
    assert_true(s.actions[2].value == 0.0);
    assert_true(s.actions[3].type == SCENE_ACTION_FEED && s.actions[3].target == 1);
    assert_true(s.actions[3].value == 1.0);
    assert_true(s.output.windows[0].curve_every == 0.001);
    assert_true(s.output.windows[0].snapshot_every == 0.25 && s.output.windows[1].from == 2);
    scene_fini(&s);
    buffer_fini(&document);
}

// A document from before these members keeps its bytes.
static void later_members_are_written_only_where_they_say_something(void **unused)
{
    static const char *const names[] = {
        "feeds",    "substream",  "photo_eyes",    "actions", "merges",
        "warmup_s", "jam_time_s", "until",         "windows", "steady_precision",
        "motion",   "present",    "\"id\":\"cargo"
    };
    bf_buffer document = document_quote(DOCUMENT_WITH(
        "'obstacles': [{'from_m': [0.7, 0], 'to_m': [0.7, 0.2]}], 'warmup_s': 0, 'jam_time_s': 5,"
        "'until': 'duration', 'substream': 0, 'feeds': [], 'actions': []"));
    bf_buffer written = resolve(&document);

    for (size_t k = 0; k < sizeof names / sizeof *names; k++)
        assert_null(strstr(written.bytes, names[k]));
    buffer_fini(&document);
    buffer_fini(&written);
}

static void goods_stand_for_what_is_not_beside_them(void **unused)
{
    scene s = read_text("{'duration_s': 1, 'domain': {'x_m': [0, 1], 'y_m': [0, 1]}, 'cargo':"
                        "{'shape': {'height_m': 0.1}, 'goods': 'can-330'}, 'contacts':"
                        "{'conveyor_cargo': {'friction': 0.2}},"
                        "'initial': {'positions_m': [[0.5, 0.3]]}}");

    assert_int_equal(s.cargo[0].goods, SCENE_CAN_330);
    assert_int_equal(s.cargo[0].surface, SCENE_STEEL);
    assert_true(s.cargo[0].shape.radius == 0.033 && s.cargo[0].shape.height == 0.1);
    assert_true(s.cargo[0].mass == 0.382);
    assert_true(s.micro.contact[SCENE_CARGO_CARGO].friction == 0.27);
    assert_true(s.micro.contact[SCENE_CONVEYOR_CARGO].friction == 0.2);
    assert_true(s.micro.wall_friction == 0.27);
    scene_fini(&s);
}

static void what_was_written_reads_back_to_the_same_bytes(void **unused)
{
    static const char *const documents[] = {
        "{" DOCUMENT_NEEDED "}",
        DOCUMENT_WITH("'obstacles': [{'end_m': [0.7, 0.5], 'angle_deg': 37, 'length_m': 0.3}]"),
        DOCUMENT_WITH("'obstacles': [{'from_m': [0.1, 0.1], 'to_m': [0.30000000000000004, 0.5]}]"),
        "{'duration_s': 1, 'domain': {'x_m': [0, 1], 'y_m': [0, 1]}, 'cargo': {'shape': {'type':"
        "'prism', 'height_m': 0.1, 'outline_m': [[0, 0], [0.03, 0], [0.01, 0.02]]}},"
        "'initial': {'random': {'count': 5, 'seed': 9007199254740991,"
        "'region': {'x_m': [0.1, 0.9], 'y_m': [0.2, 0.8]}}}}",
        "{'duration_s': 1, 'domain': {'x_m': [0, 1], 'y_m': [0, 1]}, 'cargo_seed': 3, 'cargo': ["
        "{'share': 0.1}, {'share': 0.2, 'shape': {'type': 'prism', 'outline_m': [[0, 0], [0.03, 0],"
        "[0.01, 0.02]]}}, {'share': 0.3, 'mass_kg': 2}], 'micro': {'integrator': 'implicit'},"
        "'initial': {'random': {'count': 9, 'region': {'x_m': [0.1, 0.9], 'y_m': [0.2, 0.8]}}}}",
        "{'duration_s': 1, 'domain': {'x_m': [0, 1], 'y_m': [0, 1]}, 'cargo': {'shape': {'type':"
        "'hull', 'vertices_m': [[0, 0, 0], [0.03, 0, 0], [0, 0.03, 0], [0, 0, 0.03]]}},"
        "'initial': {'hexagonal': {'rows': 2, 'columns': 3, 'first_m': [0.3, 0.3],"
        "'spacing_m': 0.1}}}",
        "{'duration_s': 1, 'domain': {'x_m': [0, 1], 'y_m': [0, 1]}, 'cargo': {'goods': 'jar-440',"
        "'shape': {'radius_m': 0.04}, 'surface': 'pet', 'mass_kg': 0.3}, 'surfaces':"
        "{'conveyor': 'pu'}, 'initial': {'positions_m': [[0.5, 0.3]]}}",
        "{'duration_s': 1, 'domain': {'x_m': [0, 2], 'y_m': [0, 2]}, 'cargo': [{'goods':"
        "'carton-400x300', 'shape': {'height_m': 0.1}}, {'goods': 'tray-24x330', 'shape': {'type':"
        "'cylinder', 'radius_m': 0.1}}], 'initial': {'positions_m': [[0.5, 0.5], [1.2, 1.2]]}}",
    };

    for (size_t k = 0; k < sizeof documents / sizeof *documents; k++) {
        bf_buffer document = document_quote(documents[k]);
        bf_buffer once = resolve(&document);
        bf_buffer twice = resolve(&once);
        assert_string_equal(once.bytes, twice.bytes);
        assert_null(strchr(once.bytes, '\n'));
        buffer_fini(&document);
        buffer_fini(&once);
        buffer_fini(&twice);
    }
}

// Random doubles in every place of a part, heading too, come back with the same bits.
static void numbers_keep_their_bits(void **unused)
{
    bf_random random;

    random_init(&random, 11);
    for (int k = 0; k < 300; k++) {
        char text[400];
        double x = 0.1 + 0.8 * random_unit(&random);
        double y = 0.1 + 0.4 * random_unit(&random);
        double degrees = 720.0 * random_unit(&random) - 360.0;
        snprintf(text, sizeof text,
                 "{'duration_s': 1, 'domain': {'x_m': [0, 1], 'y_m': [0, 0.6]}, 'cargo': {},"
                 "'initial': {'positions_m': [[%.17g, %.17g, %.17g]]}}",
                 x, y, degrees);
        scene s = read_text(text);
        bf_buffer written = write_scene(&s);
        scene back;
        assert_int_equal(read_bytes(&written, &back, NULL), BF_OK);
        assert_memory_equal(s.initial.poses, back.initial.poses, sizeof *s.initial.poses);
        assert_true(s.initial.poses[0].x == x);
        scene_fini(&s);
        scene_fini(&back);
        buffer_fini(&written);
    }
}

static void the_three_forms_of_an_obstacle_agree(void **unused)
{
    static const char *const forms[] = {
        "'end_m': [0.75, 0.5], 'angle_deg': 90, 'length_m': 0.25",
        "'from_m': [0.75, 0.25], 'to_m': [0.75, 0.5]",
        "'path_m': [[0.75, 0.25], [0.75, 0.5]]",
    };

    for (size_t k = 0; k < sizeof forms / sizeof *forms; k++) {
        char text[500];
        snprintf(text, sizeof text, DOCUMENT_WITH("'obstacles': [{%s}]"), forms[k]);
        scene s = read_text(text);
        assert_int_equal(s.obstacles[0].n_points, 2);
        assert_true(s.obstacles[0].path[0].x == 0.75 && s.obstacles[0].path[0].y == 0.25);
        assert_true(s.obstacles[0].path[1].x == 0.75 && s.obstacles[0].path[1].y == 0.5);
        assert_string_equal(s.obstacles[0].id, "obstacle-1");
        scene_fini(&s);
    }
}

// The start is end - length (cos, sin), the angle from the x axis: at 60 degrees (0.5, sqrt(3)/2).
static void an_obstacle_starts_before_its_end(void **unused)
{
    scene s = read_text(DOCUMENT_WITH("'obstacles': [{'end_m': [0.75, 0.5], 'angle_deg': 60,"
                                      "'length_m': 0.2}]"));

    assert_true(fabs(s.obstacles[0].path[0].x - 0.65) < 1e-15);
    assert_true(fabs(s.obstacles[0].path[0].y - (0.5 - 0.1 * sqrt(3.0))) < 1e-15);
    scene_fini(&s);
}

static void whole_numbers_may_have_a_point(void **unused)
{
    scene s = read_text("{'duration_s': 1, 'domain': {'x_m': [0, 1], 'y_m': [0, 1]}, 'cargo': {},"
                        "'initial': {'hexagonal': {'rows': 2.0, 'columns': 3e0, 'first_m':"
                        "[0.3, 0.3], 'spacing_m': 0.1}}}");

    assert_int_equal(s.initial.n_rows, 2);
    assert_int_equal(s.initial.n_columns, 3);
    scene_fini(&s);
}

static void columns_are_the_counters_and_left_domain(void **unused)
{
    scene s = read_text(DOCUMENT_WITH("'counters': [{'id': 'a'}, {'id': 'b'}]"));
    bf_buffer columns = { 0 };

    assert_int_equal(scenario_columns(&s, &columns, NULL), BF_OK);
    assert_string_equal(columns.bytes, "a,b,left_domain");
    buffer_fini(&columns);
    scene_fini(&s);
}

// The n-th request of core's memory or jansson's fails, for every n until all is well.
static void check_reading_without_memory(bf_buffer document)
{
    bf_status status = BF_ENOMEM;

    for (size_t n = 1; status != BF_OK; n++) {
        scene s;
        scene before;
        memset(&s, 0x5a, sizeof s);
        before = s;
        memory_plan_fault(n, 0);
        status = read_bytes(&document, &s, NULL);
        memory_plan_fault(0, 0);
        if (status == BF_OK) {
            assert_true(n > 100);
            scene_fini(&s);
        } else {
            if (status != BF_ENOMEM)
                fail_msg("at request %zu: %s", n, faults.items[0].text);
            assert_memory_equal(&s, &before, sizeof s);
        }
        assert_true(n < 5000);
    }
    buffer_fini(&document);
}

static void no_memory_is_reported_and_leaves_the_output(void **unused)
{
    check_reading_without_memory(document_complete());
    check_reading_without_memory(document_fed());
}

static void check_writing_without_memory(bf_buffer document)
{
    scene s;
    bf_status status = BF_ENOMEM;

    assert_int_equal(read_bytes(&document, &s, NULL), BF_OK);
    for (size_t n = 1; status != BF_OK; n++) {
        bf_buffer out = { 0 };
        assert_int_equal(buffer_append(&out, "before", 6), BF_OK);
        memory_plan_fault(n, 0);
        status = scenario_write(&s, &out, NULL);
        if (status == BF_OK)
            status = scenario_columns(&s, &out, NULL);
        else
            assert_int_equal(out.n, 6);
        memory_plan_fault(0, 0);
        assert_memory_equal(out.bytes, "before", 6);
        buffer_fini(&out);
    }
    scene_fini(&s);
    buffer_fini(&document);
}

static void writing_without_memory_leaves_the_buffer(void **unused)
{
    check_writing_without_memory(document_complete());
    check_writing_without_memory(document_fed());
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_needed_members_suffice),
        cmocka_unit_test(every_member_finds_its_place),
        cmocka_unit_test(cargo_may_be_a_list_of_kinds),
        cmocka_unit_test(one_kind_is_written_as_one_object),
        cmocka_unit_test(the_default_step_follows_the_integrator),
        cmocka_unit_test(how_a_speed_changes_is_written_only_where_it_was_given),
        cmocka_unit_test(a_complete_document_is_written_as_it_was_read),
        cmocka_unit_test(a_fed_document_keeps_its_definition),
        cmocka_unit_test(what_feeds_and_moves_finds_its_place),
        cmocka_unit_test(later_members_are_written_only_where_they_say_something),
        cmocka_unit_test(goods_stand_for_what_is_not_beside_them),
        cmocka_unit_test(what_was_written_reads_back_to_the_same_bytes),
        cmocka_unit_test(numbers_keep_their_bits),
        cmocka_unit_test(the_three_forms_of_an_obstacle_agree),
        cmocka_unit_test(an_obstacle_starts_before_its_end),
        cmocka_unit_test(whole_numbers_may_have_a_point),
        cmocka_unit_test(columns_are_the_counters_and_left_domain),
        cmocka_unit_test(no_memory_is_reported_and_leaves_the_output),
        cmocka_unit_test(writing_without_memory_leaves_the_buffer),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
