// SPDX-License-Identifier: GPL-3.0-or-later
// Laws that hold at any speed: the forces and torques of elements sum to 0, momentum is conserved,
// tissue at rest stays at rest, a free body falls with g.
#include "core/session/stage.h"

#include <stdio.h>

static const double balance_tolerance = 1e-6; // largest sum of forces, times the sum of |f_i|
// Largest change of momentum: rounding of sums over a few hundred vertices and ticks, relative to
// the momentum.
static const double momentum_tolerance_double = 1e-9, momentum_tolerance_single = 1e-4;
static const double rest_tolerance = 1e-9; // largest motion at rest, times an edge length
// Largest error of a fall: rounding of a step's increment, relative to the fallen height.
static const double fall_tolerance_double = 1e-9, fall_tolerance_single = 1e-5;

enum { CONVERGED = 300 };

// ---- every material law
typedef struct law {
	int kind, model, limit, projection;
} law;

static cau_scene_def *scene_of_law(const law *l)
{
	const double size[3] = {0.04, 0.03, 0.02};
	const int32_t cells[3] = {4, 3, 2};
	cau_scene_def *scene = stage_scene(CAU_PRECISION_DOUBLE);
	scene->iterations = CONVERGED;
	scene->tolerance = 1e-10; // far below the tolerance of the balance
	scene->damping_per_s = 2;
	if (l->kind == CAU_LAYER_FAT) {
		cau_fat_material *fat = stage_add_slab(scene, "body", size, cells)->fat;
		fat->model = l->model;
		fat->poisson_ratio = 0.3;
		fat->limit = l->limit;
		fat->projection = l->projection;
		fat->shear_max = 0.05;
		fat->target[0] = l->limit == CAU_LIMIT_TARGET ? 0.6 : 1;
		fat->target[3] = l->limit == CAU_LIMIT_TARGET ? 0.1 : 0;
		for (int i = 0; i < 3; i++) {
			fat->strain_min[i] = -0.02;
			fat->strain_max[i] = 0.02;
		}
	} else {
		cau_sheet_material *sheet = stage_add_sheet(scene, "body", 0.04, 0.03, 6, 5)->sheet;
		sheet->limit = l->limit;
		sheet->projection = l->projection;
		sheet->limit_stiffness_pa = 1e4;
		sheet->bending_stiffness_nm = 1e-4;
		sheet->shear_max = 0.05;
		sheet->target[0] = l->limit == CAU_LIMIT_TARGET ? 0.6 : 1;
		for (int i = 0; i < 2; i++) {
			sheet->strain_min[i] = -0.02;
			sheet->strain_max[i] = 0.02;
		}
	}
	return scene;
}

static cau_selection half(int sign)
{
	const double least[3] = {sign > 0 ? 0.005 : -1, -1, -1};
	const double most[3] = {sign > 0 ? 1 : -0.005, 1, 1};
	return stage_box(least, most);
}

// Pulls, shears and twists the body by forces on its halves until it is in equilibrium.
static void strain(cau_session *session, double force_n, int ticks)
{
	stage_force(session, half(1), force_n, force_n / 2, force_n / 4);
	stage_force(session, half(-1), -force_n, -force_n / 2, -force_n / 4);
	stage_step(session, ticks);
}

static void check_balance(const law *l)
{
	cau_scene_def *scene = scene_of_law(l);
	cau_session *session = stage_open(scene, 1);
	// A sheet without limits does not resist in its plane. After a few more ticks it would be
	// stretched beyond any possible tissue, and the session would fault, as it should.
	bool unlimited = l->kind == CAU_LAYER_FASCIA && l->limit == CAU_LIMIT_NONE;
	strain(session, l->kind == CAU_LAYER_FAT ? 4e-3 : 2e-3, unlimited ? 3 : 40);
	cau_balance b = stage_balance(session);
	cau_frame frame = stage_frame(session);
	double net = cau_length(cau_vec3_of(b.net_force)), turn = cau_length(cau_vec3_of(b.net_torque));
	print_message(
		"kind %d model %d limit %d projection %d: force %.1e, torque %.1e; %d iterations\n",
		l->kind, l->model, l->limit, l->projection, net / b.force_sum, turn / b.torque_sum,
		frame.statistics.iterations);
	assert_true(b.force_sum > 1e-4); // the body is strained
	if (!(net <= balance_tolerance * b.force_sum && turn <= balance_tolerance * b.torque_sum))
		fail_msg(
			"kind %d model %d limit %d projection %d: net force %g of %g N, torque %g of %g N m",
			l->kind, l->model, l->limit, l->projection, net, b.force_sum, turn, b.torque_sum);
	cau_session_destroy(session);
	free(scene);
}

static void every_law_of_fat_is_balanced(void **state)
{
	(void)state;
	for (int model = 0; model < CAU_MODEL_COUNT; model++)
		for (int limit = 0; limit < CAU_LIMIT_COUNT; limit++)
			for (int projection = 0; projection < CAU_PROJECTION_COUNT; projection++)
				check_balance(&(law){CAU_LAYER_FAT, model, limit, projection});
}

static void every_law_of_sheets_is_balanced(void **state)
{
	(void)state;
	for (int limit = 0; limit < CAU_LIMIT_COUNT; limit++)
		for (int projection = 0; projection < CAU_PROJECTION_COUNT; projection++)
			check_balance(&(law){CAU_LAYER_FASCIA, 0, limit, projection});
}

// ---- momentum
static cau_scene_def *free_layers(int precision)
{
	const double size[3] = {0.04, 0.03, 0.01};
	const int32_t cells[3] = {4, 3, 2};
	cau_scene_def *scene = stage_scene(precision);
	cau_layer_def *fascia = stage_add_sheet(scene, "fascia", 0.04, 0.03, 6, 5);
	stage_mesh_of(scene, fascia)->translate_m[2] = 0.003;
	fascia->sheet[0].bending_stiffness_nm = 1e-4;
	stage_add_slab(scene, "fat", size, cells)->fat[0].yield_strain = 0.01;
	scene->layers[1].fat[0].plastic_strain_max = 0.1;
	stage_add_membrane(scene, "membrane", "fat");
	stage_add_links(scene, "links", "fascia", "membrane");
	return scene;
}

static void check_momentum(int precision, double tolerance)
{
	cau_scene_def *scene = free_layers(precision);
	cau_session *session = stage_open(scene, 1);
	// A push gives the body a momentum and makes it vibrate.
	stage_force(session, half(1), 2e-3, 1e-3, -1e-3);
	stage_step(session, 5);
	stage_force(session, half(1), 0, 0, 0);
	stage_step(session, 1);
	cau_vec3 before = cau_vec3_of(stage_balance(session).momentum);
	double size = cau_length(before), change = 0;
	assert_true(size > 1e-5);
	for (int tick = 0; tick < 300; tick++) {
		stage_step(session, 1);
		cau_vec3 now = cau_vec3_of(stage_balance(session).momentum);
		change = fmax(change, cau_length(cau_sub(now, before)));
	}
	print_message("momentum %g kg m/s: changed by %.1e of itself in 300 ticks\n", size,
	              change / size);
	if (!(change <= tolerance * size))
		fail_msg("momentum changed by %g of %g kg m/s", change, size);
	cau_session_destroy(session);
	free(scene);
}

static void a_free_body_keeps_its_momentum(void **state)
{
	(void)state;
	check_momentum(CAU_PRECISION_DOUBLE, momentum_tolerance_double);
	check_momentum(CAU_PRECISION_SINGLE, momentum_tolerance_single);
}

// ---- rest and fall
static void check_rest(int precision)
{
	cau_scene_def *scene = free_layers(precision);
	cau_session *session = stage_open(scene, 1);
	cau_session_info info = stage_info(session);
	stage_step(session, 10000);
	cau_frame frame = stage_frame(session);
	double moved = stage_farthest(&frame, info.rest_position, info.vertex_count);
	double edge = stage_mean_edge_m(&info);
	print_message("precision %d: moved by %.1e of an edge in 10,000 steps\n", precision,
	              moved / edge);
	if (!(moved <= rest_tolerance * edge))
		fail_msg("moved by %g of an edge", moved / edge);
	cau_session_destroy(session);
	free(scene);
}

static void rest_stays_at_rest(void **state)
{
	(void)state;
	check_rest(CAU_PRECISION_DOUBLE);
	check_rest(CAU_PRECISION_SINGLE);
}

// Checks a fall. With implicit Euler a body falls g dt^2 (1 + 2 + ... + n) in n ticks.
static void check_fall(int precision, double tolerance)
{
	enum { TICKS = 60 };
	cau_scene_def *scene = free_layers(precision);
	cau_default_gravity(scene->gravity_m_s2);
	cau_session *session = stage_open(scene, 1);
	cau_session_info info = stage_info(session);
	double above_j = stage_balance(session).gravitational_j;
	stage_step(session, TICKS);
	cau_frame frame = stage_frame(session);
	double way = scene->gravity_m_s2[2] * info.step_s * info.step_s * TICKS * (TICKS + 1) / 2,
		   off = 0;
	for (size_t i = 0; i < 3 * (size_t)info.vertex_count; i++) {
		double fallen = frame.position[i] - info.rest_position[i];
		off = fmax(off, fabs(fallen - (i % 3 == 2 ? way : 0)));
	}
	cau_balance balance = stage_balance(session);
	double speed = scene->gravity_m_s2[2] * info.step_s * TICKS, mass = balance.momentum[2] / speed;
	double lost_j = above_j - balance.gravitational_j;
	assert_true(fabs(lost_j / (mass * scene->gravity_m_s2[2] * way) - 1) <= tolerance);
	print_message("precision %d: off by %.1e of the way fallen\n", precision, off / fabs(way));
	if (!(off <= tolerance * fabs(way)))
		fail_msg("fell %g m, off by %g m", way, off);
	cau_session_destroy(session);
	free(scene);
}

static void a_free_body_falls(void **state)
{
	(void)state;
	check_fall(CAU_PRECISION_DOUBLE, fall_tolerance_double);
	check_fall(CAU_PRECISION_SINGLE, fall_tolerance_single);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(every_law_of_fat_is_balanced),
		cmocka_unit_test(every_law_of_sheets_is_balanced),
		cmocka_unit_test(a_free_body_keeps_its_momentum),
		cmocka_unit_test(rest_stays_at_rest),
		cmocka_unit_test(a_free_body_falls),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
