#include "tests/unit/api/helper_document.h"

#include "api/scenario/scenario.h"
#include "core/base/check.h"
#include "tests/unit/helper_cmocka.h"

#include <string.h>

bf_buffer document_quote(const char *text)
{
    bf_buffer b = { 0 };

    BF_CHECK(buffer_append(&b, text, strlen(text)) == BF_OK);
    for (char *at = b.bytes; *at != '\0'; at++)
        *at = *at == '\'' ? '"' : *at;
    return b;
}

bf_buffer document_resolve(const char *text)
{
    bf_buffer json = document_quote(text), resolved = { 0 };
    bf_faults faults = { 0 };
    scene s;

    assert_int_equal(scenario_read(json.bytes, json.n, &s, &faults, NULL), BF_OK);
    assert_int_equal(scenario_write(&s, &resolved, NULL), BF_OK);
    scene_fini(&s);
    buffer_fini(&json);
    return resolved;
}

bf_buffer document_complete(void)
{
    return document_quote(
        "{'name': 'All members', 'duration_s': 2.5,"
        "'domain': {'x_m': [-0.5, 1.0], 'y_m': [0.1, 0.9]},"
        "'edges': {'west': 'wall', 'east': 'inflow', 'south': 'outflow', 'north': 'wall'},"
        "'belts': [{'id': 'a', 'velocity_m_s': [0.3, -0.1], 'acceleration_m_s2': 0.5,"
        "           'deceleration_m_s2': 0.25,"
        "           'speed_schedule': {'t_s': [0, 1.5, 2.25], 'factor': [0.5, 0, 1.25]},"
        "           'failures': [{'id': 'rare', 'mtbf_s': 600, 'mtbf_distribution': 'weibull',"
        "                         'mtbf_shape': 1.5, 'mttr_s': 60, 'mttr_distribution': 'fixed'},"
        "                        {'id': 'given', 't_s': [1, 2], 'duration_s': [0.25, 0.5]}],"
        "           'breaks': [{'start_s': 3, 'duration_s': 0.5, 'every_s': 2}]},"
        "          {'id': 'b', 'velocity_m_s': [0.0, 0.2],"
        "           'polygon_m': [[0, 0.2], [0.5, 0.2], [0.5, 0.8]]}],"
        "'obstacles': [{'id': 'long', 'path_m': [[0.6, 0.2], [0.7, 0.5], [0.9, 0.55]],"
        "               'thickness_m': 0.004, 'treatment': 'field', 'band_m': 0.07,"
        "               'slide_width_m': 0.025}],"
        "'cargo': {'shape': {'type': 'box', 'length_m': 0.04, 'width_m': 0.03, 'height_m': 0.02},"
        "          'mass_kg': 0.5, 'material': {'young_modulus_pa': 1e9, 'poisson_ratio': 0.3}},"
        "'cargo_seed': 7,"
        "'initial': {'positions_m': [[0.1, 0.4], [0.2, 0.5, 33.3], [0.3, 0.6, -120]]},"
        "'counters': [{'id': 'left', 'x_m': [0, 0.5], 'y_m': [0.2, 0.7]}, {'id': 'right'}],"
        "'output': {'curve_every_s': 0.02, 'snapshot_every_s': 0.25},"
        "'macro': {'cell_m': 0.01, 'step_s': 'auto', 'closure': 'congested', 'jam_density': 0.85,"
        "          'scheme': 'roe', 'heaviside': 'smooth',"
        "          'heaviside_width': 0.1, 'dispersion_m_s': 0.6, 'mollifier_per_m2': 9000,"
        "          'initial_mollifier_per_m2': 3000, 'packing_density_per_m2': 1999.5},"
        "'micro': {'integrator': 'implicit', 'path': 'spatial', 'step_s': 2e-5, "
        "'modulus_reduction': 1e4, 'overlap_limit': 0.3, 'tension': true,"
        "          'damping_per_s': 0.2, 'gravity_m_s2': 9.8, 'spin_friction_radius_m': 0.01},"
        "'materials': {'conveyor': {'young_modulus_pa': 3e10, 'poisson_ratio': 0.1},"
        "              'handling': {'young_modulus_pa': 6e10, 'poisson_ratio': 0.2}},"
        "'contacts': {'cargo_cargo': {'length_m': 0.01, 'damping_n_s_m': 100, 'friction': 0.2,"
        "                             'tanh_linear_s_m': 11, 'tanh_spin_s': 2},"
        "             'conveyor_cargo': {'length_m': 0.02, 'damping_n_s_m': 200, 'friction': 0.9,"
        "                                'tanh_linear_s_m': 12, 'tanh_spin_s': 3},"
        "             'handling_cargo': {'length_m': 0.03, 'damping_n_s_m': 300, 'friction': 0.3,"
        "                                'tanh_linear_s_m': 13, 'tanh_spin_s': 4},"
        "             'wall_friction': 0.1}}");
}

bf_buffer document_fed(void)
{
    return document_quote(
        "{'name': 'All that feeds and moves', 'duration_s': 20,"
        "'domain': {'x_m': [0, 1], 'y_m': [0, 0.6]},"
        "'belts': [{'id': 'infeed', 'velocity_m_s': [0.5, 0]}],"
        "'obstacles': [{'id': 'swing', 'from_m': [0.5, 0.1], 'to_m': [0.6, 0.2],"
        "    'motion': {'pivot_m': [0.55, 0.15], 't_s': [0, 2, 2.5], 'turn_deg': [0, 0, 35.3],"
        "               'repeat_s': 10}},"
        "   {'id': 'stop', 'path_m': [[0.8, 0], [0.8, 0.5]],"
        "    'present': {'t_s': [0, 5.5], 'value': [true, false], 'repeat_s': 6}},"
        "   {'id': 'arm', 'path_m': [[0.3, 0], [0.4, 0.1]], 'motion': {'pivot_m': [0.4, 0.1]}}],"
        "'cargo': [{'id': 'box', 'share': 2}, {'shape': {'radius_m': 0.02}}],"
        "'feeds': [{'id': 'mix', 'edge': 'west', 'y_m': [0.05, 0.3], 'start_s': 0.5, 'end_s': 10,"
        "    'count': 100, 'arrivals': 'erlang', 'shape': 3, 'batch_size': 4, 'rate_per_s': 3.5,"
        "    'heading_deg': 'random', 'cargo': [{'kind': 'cargo-2', 'share': 3}, {'kind': 'box'}],"
        "    'when_blocked': 'discard', 'max_wait_s': 4, 'seed': 11},"
        "   {'id': 'shift', 'line_m': [[0.1, 0.36], [0.12, 0.56]], 'heading_deg': 33.3,"
        "    'profile': {'t_s': [0, 10], 'rate_per_s': [1, 2], 'repeat_s': 12}},"
        "   {'edge': 'west', 'y_m': [0.4, 0.5], 'schedule': {'t_s': [0, 1, 1], 'count': [1, 2, 3],"
        "    'kind': ['box', 'cargo-2', 'box'], 'place': [0, null, 1],"
        "    'heading_deg': [10.1, null, 3]}}],"
        "'substream': 7,"
        "'photo_eyes': [{'id': 'pe', 'line_m': [[0.7, 0], [0.7, 0.6]], 'block_time_s': 1,"
        "                'clear_time_s': 0.5, 'density_ratio': 0.7}],"
        "'actions': [{'when': {'photo_eye': 'pe', 'state': 'blocked'},"
        "             'do': {'belt': 'infeed', 'factor': 0.25}},"
        "   {'when': {'photo_eye': 'pe', 'state': 'clear'}, 'delay_s': 1.5,"
        "    'do': {'obstacle': 'arm', 'turn_deg': 35.3, 'over_s': 0.75}},"
        "   {'when': {'photo_eye': 'pe', 'state': 'clear'},"
        "    'do': {'obstacle': 'stop', 'present': false}},"
        "   {'when': {'photo_eye': 'pe', 'state': 'blocked'},"
        "    'do': {'feed': 'shift', 'hold': true}}],"
        "'warmup_s': 3, 'jam_time_s': 6, 'until': 'steady', 'steady_precision': 0.02,"
        "'output': {'curve_every_s': 0.02, 'snapshot_every_s': 0.25,"
        "           'windows': [{'t_s': [1, 2], 'curve_every_s': 0.001},"
        "                       {'t_s': [2, 3], 'snapshot_every_s': 0.1}]}}");
}

bf_status document_refuse(const char *json, size_t n, bf_faults *faults, bf_error *err)
{
    scene s;
    scene before;

    memset(&s, 0x5a, sizeof s);
    before = s;
    faults->n = 0;
    bf_status status = scenario_read(json, n, &s, faults, err);
    if (status == BF_OK)
        fail_msg("%.*s was read", (int)n, json);
    assert_memory_equal(&s, &before, sizeof s);
    assert_true(faults->n > 0);
    assert_int_equal(err->code, status);
    return status;
}

bool document_has_fault(const bf_faults *faults, const char *pointer)
{
    for (size_t k = 0; k < faults_kept(faults); k++) {
        if (strcmp(faults->items[k].pointer, pointer) == 0)
            return true;
    }
    return false;
}
