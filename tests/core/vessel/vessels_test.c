// SPDX-License-Identifier: GPL-3.0-or-later
// Tests outflow and seals against closed forms, and an embedded vessel in deformed tissue.
#include "core/session/stage.h"

#include "cautery/defaults.h"
#include "session/session_internal.h"

static const double pi = 3.14159265358979323846;

static cau_vessel_def tube(double radius_m, double wall_m)
{
	cau_vessel_def def;
	cau_default_vessel_def(&def);
	def.radius_m = radius_m;
	def.wall_m = wall_m;
	return def;
}

static void assert_close(double found, double expected, double share)
{
	if (!(fabs(found - expected) <= share * fabs(expected)))
		fail_msg("%.9g is not %.9g", found, expected);
}

// The flow from a wide tube is that of an orifice: Q = C A sqrt(2 p / rho). The flow from a narrow
// tube is Poiseuille flow.
static void outflow_has_both_limits(void **state)
{
	(void)state;
	cau_vessel_def wide = tube(5e-3, 1e-3);
	wide.supply_m = 1e-3;
	double area = pi * 4e-3 * 4e-3;
	assert_close(cau_vessel_outflow(&wide, 12000, 1), 0.6 * area * sqrt(2 * 12000 / 1060.0), 1e-3);
	assert_close(cau_vessel_outflow(&wide, 12000, 0.5), 0.3 * area * sqrt(2 * 12000 / 1060.0),
	             1e-3);
	cau_vessel_def narrow = tube(1.2e-4, 2e-5);
	assert_close(cau_vessel_outflow(&narrow, 12000, 1),
	             pi * pow(1e-4, 4) * 12000 / (8 * 3.5e-3 * 0.1), 1e-3);
	assert_true(cau_vessel_outflow(&wide, 0, 1) == 0 && cau_vessel_outflow(&wide, 12000, 0) == 0);
}

// For thin walls, once all collagen has reacted: p = strength x wall / radius.
static void strength_grows_to_that_of_the_fused_wall(void **state)
{
	(void)state;
	cau_vessel_def def = tube(2e-3, 4e-4);
	assert_true(cau_seal_strength(&def, 0) == 0);
	assert_close(cau_seal_strength(&def, 1), 5e5 * (1 - exp(-1)) * 0.2, 1e-12);
	assert_close(cau_seal_strength(&def, 100), 5e5 * 0.2, 1e-12);
}

// Makes a block of 20 x 8 x 6 mm with a tube along x at half its height. All vertices are
// prescribed. The block is compressed to the share `flat` of its height.
static cau_session *block(double flat)
{
	static const double size[] = {0.02, 0.008, 0.006};
	static const int32_t cells[] = {10, 4, 3};
	cau_scene_def *scene = stage_scene(CAU_PRECISION_DOUBLE);
	scene->energy = CAU_ENERGY_TISSUE;
	scene->parting = CAU_PARTING_ELEMENTS;
	stage_add_slab(scene, "fat", size, cells);
	const double least[] = {-1, -1, -1}, most[] = {1, 1, -1e-9};
	stage_pin_box(scene, least, most);
	scene->vessel_count = 1;
	cau_default_vessel_def(&scene->vessels[0]);
	strcpy(scene->vessels[0].name, "vein");
	strcpy(scene->vessels[0].layer, "fat");
	scene->vessels[0].point_count = 3;
	const double line[3][3] = {{-0.009, 0, -0.003}, {0, 0.001, -0.003}, {0.009, 0, -0.003}};
	memcpy(scene->vessels[0].points_m, line, sizeof line);
	cau_session *session = stage_open(scene, 1);
	free(scene);
	for (int32_t v = 0; v < session->tissue.vertex_count; v++)
		session->vertices.position[3 * (size_t)v + 2] =
			flat * session->tissue.rest[3 * (size_t)v + 2];
	cau_session_look_at_vessels(session);
	return session;
}

static void assert_open(double flat, double expected)
{
	cau_session *session = block(flat);
	const cau_vessels *vessels = session->vessels;
	for (int32_t k = 0; k < vessels->station_count; k++)
		assert_true(fabs(vessels->open[k] - expected) < 1e-9);
	const cau_vessel_state *vein = stage_frame(session).vessels[0];
	for (int32_t i = 0; i < vein->point_count; i++)
		assert_true(fabs((double)vein->point[i].position_m[2] + 0.003 * flat) < 1e-8);
	assert_int_equal(vein->flags, expected > 0 ? 0 : CAU_VESSEL_SHUT);
	cau_session_destroy(session);
}

// If a plate is strained by e, a hole in it loses 3 e of its width.
static void the_lumen_closes_at_a_third(void **state)
{
	(void)state;
	assert_open(1, 1);
	assert_open(0.9, 0.7);
	assert_open(0.7, 0.1);
	assert_open(0.6, 0);
}

// Stations are a quarter of a radius apart. They are on the line and follow its bend.
static void stations_lie_on_the_line(void **state)
{
	(void)state;
	cau_session *session = block(1);
	const cau_vessels *vessels = session->vessels;
	double corner = 1;
	cau_vec3 before = vessels->station[0].point[0].rest;
	assert_true(fabs(before.x + 0.009) < 1e-12);
	for (int32_t k = 1; k < vessels->station_count; k++) {
		cau_vec3 at = vessels->station[k].point[0].rest;
		double step = cau_length(cau_sub(at, before));
		assert_true(step > 0.2 * 1.5e-3 && step <= 0.25 * 1.5e-3 + 1e-12);
		corner = fmin(corner, cau_length(cau_sub(at, (cau_vec3){0, 0.001, -0.003})));
		before = at;
	}
	assert_true(fabs(before.x - 0.009) < 1e-12 && fabs(before.y) < 1e-12);
	assert_true(corner <= 0.125 * 1.5e-3 + 1e-12);
	cau_session_destroy(session);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(outflow_has_both_limits),
		cmocka_unit_test(strength_grows_to_that_of_the_fused_wall),
		cmocka_unit_test(the_lumen_closes_at_a_third),
		cmocka_unit_test(stations_lie_on_the_line),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
