// SPDX-License-Identifier: GPL-3.0-or-later
// Contact of tools (core/DECISIONS.md, "Contact"): no tissue is inside a tool, friction stays in
// its cone, forces balance, and jaws hold up to their slip force.
#include "core/session/stage.h"

#include <stdio.h>

#include "session/session_internal.h"
#include "tool/tool_shape.h"

// Greatest depth, m, of a vertex inside a pushing tool at the end of a step, with ten iterations
// and a tool that moves at 2 cm/s.
static const double penetration_m = 2e-5;
// Largest excess over the cone: rounding, relative to the normal force.
static const double cone_tolerance = 1e-6;
static const double weight_tolerance = 0.01;

// ---- pushing
static cau_scene_def *block_of(const int32_t cells[3], double friction)
{
	const double size[3] = {0.04, 0.04, 0.016}, least[3] = {-1, -1, -0.0161},
				 most[3] = {1, 1, -0.0159};
	cau_scene_def *scene = stage_scene(CAU_PRECISION_SINGLE);
	stage_add_slab(scene, "fat", size, cells);
	stage_pin_box(scene, least, most);
	cau_tool_def *ball = stage_add_tool(scene, "ball", CAU_TOOL_SPHERE, 0, 0, 0.0065);
	ball->hot_radius_m = 0.006;
	ball->friction = friction;
	return scene;
}

static cau_scene_def *block_scene(double friction)
{
	return block_of((const int32_t[3]){16, 16, 6}, friction);
}

static double deepest(const cau_session *session, const char *tool)
{
	const cau_tool_state *state = stage_tool(session, tool);
	cau_frame frame = stage_frame(session);
	double depth = 0;
	for (size_t v = 0; v < (size_t)session->tissue.vertex_count; v++)
		if (!session->vertices.fixed[v])
			depth = fmax(depth, -cau_tool_distance_at(&state->definition, &state->pose, state->jaw,
			                                          CAU_PART_BOTH,
			                                          cau_vec3_of(frame.position + 3 * v), NULL));
	return depth;
}

static void nothing_is_inside_a_cold_tool(void **state)
{
	(void)state;
	cau_scene_def *scene = block_scene(0.2);
	cau_session *session = stage_open(scene, 1);
	double worst = 0;
	for (int tick = 0; tick < 120; tick++) { // 4 mm in, then along, at 2 cm/s
		double in = fmin(tick, 14) * 0.02 / 60, along = fmax(tick - 20, 0) * 0.006 / 60;
		stage_move(session, "ball", along, 0, 0.0065 - in);
		stage_step(session, 1);
		worst = fmax(worst, deepest(session, "ball"));
	}
	print_message("deepest vertex %.2g m inside\n", worst);
	assert_true(stage_tool(session, "ball")->contact_vertices > 5);
	assert_true(worst <= penetration_m);
	cau_session_destroy(session);
	free(scene);
}

static void friction_keeps_to_its_cone(void **state)
{
	(void)state;
	const double friction[] = {0, 0.3};
	double sideways[2];
	for (int k = 0; k < 2; k++) {
		cau_scene_def *scene = block_scene(friction[k]);
		cau_session *session = stage_open(scene, 1);
		for (int tick = 0; tick < 80; tick++) {
			stage_move(session, "ball", fmax(tick - 20, 0) * 0.006 / 60, 0,
			           0.0065 - fmin(tick, 10) * 0.0003);
			stage_step(session, 1);
			for (int32_t i = 0; i < session->contact.row_count; i++) {
				const cau_contact_row *row = &session->contact.row[i];
				cau_vec3 r = cau_vec3_of(row->reaction), n = cau_vec3_of(row->normal);
				double normal = cau_dot(r, n), along = cau_length(cau_add_scaled(r, -normal, n));
				assert_true(normal >= -1e-12); // the tool never pulls, except for rounding (N)
				assert_true(along <= friction[k] * normal + cone_tolerance * fabs(normal));
			}
		}
		sideways[k] = -stage_tool(session, "ball")->raw_force_n[0];
		assert_true(stage_tool(session, "ball")->raw_force_n[2] > 0);
		cau_session_destroy(session);
		free(scene);
	}
	print_message("dragging costs %.3g N without friction, %.3g N with\n", sideways[0],
	              sideways[1]);
	assert_true(sideways[1] > 1.5 * fmax(sideways[0], 0));
}

// Energized surfaces do not push. Tissue must be able to enter the hot part, where heat parts it.
static void an_energized_ball_does_not_push(void **state)
{
	(void)state;
	cau_scene_def *scene = block_scene(0.2);
	cau_session *session = stage_open(scene, 1);
	stage_energize(session, "ball", 1);
	stage_move(session, "ball", 0, 0, 0.003);
	stage_step(session, 20);
	assert_int_equal(stage_tool(session, "ball")->contact_vertices, 0);
	assert_true(deepest(session, "ball") > 0.001);
	cau_session_destroy(session);
	free(scene);
}

// A taut sheet that was pushed out in one tick is guessed to move on in the next. The sheet must
// stay in contact all the same. Otherwise it would spring back into the tool in every second tick.
// At rest the force stays, and nothing is inside the tool.
static void what_is_pressed_stays_in_contact(void **state)
{
	(void)state;
	static const double radius_m[] = {0.003, 0.006, 0.012};
	for (int k = 0; k < 3; k++) {
		cau_scene_def *scene = stage_scene(CAU_PRECISION_SINGLE);
		stage_add_taut_sheet(scene);
		cau_tool_def *ball = stage_add_tool(scene, "ball", CAU_TOOL_SPHERE, 0, 0, 0.02);
		ball->hot_radius_m = radius_m[k];
		cau_session *session = stage_open(scene, 1);
		stage_move(session, "ball", 0, 0, radius_m[k] - 0.001);
		stage_step(session, 60);
		double least = 1e300, most = 0, worst = 0;
		for (int tick = 0; tick < 30; tick++) {
			stage_step(session, 1);
			double force = cau_length(cau_vec3_of(stage_tool(session, "ball")->raw_force_n));
			least = fmin(least, force);
			most = fmax(most, force);
			worst = fmax(worst, deepest(session, "ball"));
		}
		print_message("radius %g m: %.4g to %.4g N at rest, deepest %.2g m inside\n", radius_m[k],
		              least, most, worst);
		assert_true(most > 0 && least >= 0.98 * most);
		assert_true(worst <= penetration_m);
		cau_session_destroy(session);
		free(scene);
	}
}

// ---- more vertices than the capacity
static int32_t vertices_within(const cau_session *session, double margin_m, bool drawn)
{
	const cau_tool_state *state = stage_tool(session, "ball");
	cau_frame frame = stage_frame(session);
	int32_t count = 0;
	for (size_t v = 0; v < (size_t)session->tissue.vertex_count; v++)
		count += !session->vertices.fixed[v] && (!drawn || frame.vertex_visible[v]) &&
		         cau_tool_distance_at(&state->definition, &state->pose, state->jaw, CAU_PART_BOTH,
		                              cau_vec3_of(frame.position + 3 * v), NULL) <= margin_m;
	return count;
}

// Puts a ball into a block with this many cells, and checks the constraints. Near vertices have
// contact constraints; if there are too many, only touching vertices have constraints. Touching
// vertices without a constraint are reported.
static void check_rows(const int32_t cells[3], double radius_m, double depth_m, int32_t *left_out)
{
	const double touching_m = 2e-4; // a vertex nearer than this touches (thin.c)
	cau_scene_def *scene = block_of(cells, 0.2);
	scene->tools[0].hot_radius_m = radius_m;
	scene->tools[0].grid_step_m = radius_m / 5;
	scene->tools[0].pose.position_m[2] = radius_m - depth_m;
	cau_session *session = stage_open(scene, 1);
	stage_frame(session);
	int32_t near = vertices_within(session, fmin(fmax(5e-4, 0.25 * radius_m), 2e-3), false);
	int32_t touching = vertices_within(session, touching_m, true);
	stage_step(session, 1);
	cau_statistics statistics = stage_frame(session).statistics;
	print_message("%d near, %d touch: %d rows, %d left out\n", near, touching, statistics.contacts,
	              statistics.contacts_left_out);
	int32_t rows = near <= CAU_NEAR_ROWS ? near : touching;
	if (rows > CAU_MAX_VERTEX_ROWS)
		rows = CAU_MAX_VERTEX_ROWS;
	assert_int_equal(statistics.contacts - session->contact.face_count, rows);
	assert_true(touching > CAU_NEAR_ROWS || near <= CAU_NEAR_ROWS);
	assert_int_equal(statistics.contacts_left_out, near == rows ? 0 : touching - rows);
	*left_out = statistics.contacts_left_out;
	stage_move(session, "ball", 0, 0, 1);
	stage_step(session, 60);
	statistics = stage_frame(session).statistics;
	assert_int_equal(statistics.contacts, 0);
	assert_int_equal(statistics.contacts_left_out, 0);
	cau_session_destroy(session);
	free(scene);
}

static void contact_says_what_it_left_out(void **state)
{
	(void)state;
	int32_t left_out;
	check_rows((const int32_t[3]){16, 16, 6}, 0.006, 1e-4, &left_out);
	assert_int_equal(left_out, 0);
	// This ball has many constraints, within the capacity.
	check_rows((const int32_t[3]){16, 16, 6}, 0.04, 8e-3, &left_out);
	assert_int_equal(left_out, 0);
	check_rows((const int32_t[3]){40, 40, 2}, 0.05, 5e-3,
	           &left_out); // beyond the capacity
	assert_true(left_out > 0);
}

// ---- a block of tissue lying on a tool
static cau_scene_def *resting_scene(void)
{
	const double size[3] = {0.01, 0.01, 0.004};
	const int32_t cells[3] = {4, 4, 2};
	cau_scene_def *scene = stage_scene(CAU_PRECISION_DOUBLE);
	cau_default_gravity(scene->gravity_m_s2);
	scene->damping_per_s = 2;
	scene->iterations = 50;
	cau_layer_def *fat = stage_add_slab(scene, "block", size, cells);
	fat->fat[0].young_modulus_pa = 50000;
	stage_mesh_of(scene, fat)->translate_m[2] = 0.0041;
	cau_tool_def *table = stage_add_tool(scene, "table", CAU_TOOL_SPHERE, 0, 0, -0.05);
	table->hot_radius_m = 0.05; // the ball's top is at z = 0, its shaft below
	table->grid_step_m = 0.01;
	table->pose.rotation[0] = 0;
	table->pose.rotation[1] = 1;
	table->friction = 0.3;
	return scene;
}

static double centre_x(const cau_session *session)
{
	cau_frame frame = stage_frame(session);
	double sum = 0;
	for (size_t v = 0; v < (size_t)session->tissue.vertex_count; v++)
		sum += frame.position[3 * v] / session->tissue.vertex_count;
	return sum;
}

static void the_tool_feels_the_weight_on_it(void **state)
{
	(void)state;
	cau_scene_def *scene = resting_scene();
	cau_session *session = stage_open(scene, 1);
	stage_step(session, 240);
	double weight = 0;
	for (int32_t v = 0; v < session->tissue.vertex_count; v++)
		weight += 9.81 * session->tissue.mass[v];
	const cau_tool_state *table = stage_tool(session, "table");
	print_message("a weight of %.5g N is felt as %.5g N, filtered %.5g N\n", weight,
	              -table->raw_force_n[2], -table->force_n[2]);
	assert_true(fabs(-table->raw_force_n[2] - weight) <= weight_tolerance * weight);
	assert_true(fabs(-table->force_n[2] - weight) <= weight_tolerance * weight);
	cau_session_destroy(session);
	free(scene);
}

// Gravity is tilted. Below the friction angle the block stays, above it the block slides.
static void it_sticks_and_slips(void **state)
{
	(void)state;
	const double slope[] = {0.15, 0.6};
	double way[2];
	for (int k = 0; k < 2; k++) {
		cau_scene_def *scene = resting_scene();
		cau_session *session = stage_open(scene, 1);
		stage_step(session, 120);
		double before = centre_x(session);
		stage_gravity(session, 9.81 * slope[k], 0, -9.81);
		stage_step(session, 30);
		way[k] = centre_x(session) - before;
		cau_session_destroy(session);
		free(scene);
	}
	print_message("friction 0.3: at a slope of 0.15 it goes %.2g m, at 0.6 %.2g m\n", way[0],
	              way[1]);
	assert_true(fabs(way[0]) < 1e-3); // the block leans, as elastic tissue does
	// a = g (0.6 - 0.3) for half a second gives 0.37 m. The block leaves the round table earlier.
	assert_true(way[1] > 0.05);
}

// ---- grasping
static cau_scene_def *strip_scene(double slip_force_n)
{
	const double least[3] = {-0.1, -0.1, -0.1}, most[3] = {-0.0299, 0.1, 0.1};
	cau_scene_def *scene = stage_scene(CAU_PRECISION_SINGLE);
	stage_add_sheet(scene, "strip", 0.06, 0.01, 30, 5)->sheet[0].limit_stiffness_pa = 1e5;
	stage_pin_box(scene, least, most);
	cau_tool_def *jaws = stage_add_tool(scene, "jaws", CAU_TOOL_GRASPER, 0.024, 0, 0);
	jaws->pose.rotation[0] = sqrt(0.5);
	jaws->pose.rotation[2] = sqrt(0.5);
	jaws->slip_force_n = slip_force_n;
	return scene;
}

static void draw_jaws(cau_session *session, const cau_scene_def *scene, double x)
{
	cau_pose pose = scene->tools[0].pose;
	pose.position_m[0] += x;
	stage_turn(session, "jaws", &pose);
	stage_step(session, 1);
}

static void jaws_hold_up_to_their_slip_force(void **state)
{
	(void)state;
	const double slip = 0.02;
	cau_scene_def *scene = strip_scene(slip);
	cau_session *session = stage_open(scene, 1);
	stage_grasp(session, "jaws");
	stage_step(session, 5);
	int32_t held = stage_tool(session, "jaws")->grasped_vertices;
	assert_true(held > 5);
	double most = 0;
	for (int tick = 0; tick < 240; tick++) {
		int32_t before = stage_tool(session, "jaws")->grasped_vertices;
		draw_jaws(session, scene, tick * 2e-4);
		const cau_tool_state *jaws = stage_tool(session, "jaws");
		double pull = cau_length(cau_vec3_of(jaws->raw_force_n));
		most = fmax(most, pull);
		// The pull is at most that of the attachments and of the closed jaws' edge.
		assert_true(pull <= slip * before * 1.5 + 1e-3);
	}
	print_message("%d vertices held, most pull %.3g N of %.3g N, %d held after 48 mm\n", held, most,
	              slip * held, stage_tool(session, "jaws")->grasped_vertices);
	assert_true(most > 0.3 * slip * held);
	assert_int_equal(stage_tool(session, "jaws")->grasped_vertices, 0);
	assert_true(stage_tool(session, "jaws")->grasping); // the jaws are empty and still closed
	cau_session_destroy(session);
	free(scene);
}

static void jaws_hold_what_pulls_less(void **state)
{
	(void)state;
	cau_scene_def *scene = strip_scene(1000);
	cau_session *session = stage_open(scene, 1);
	stage_grasp(session, "jaws");
	stage_step(session, 5);
	int32_t held = stage_tool(session, "jaws")->grasped_vertices;
	for (int tick = 0; tick < 60; tick++)
		draw_jaws(session, scene, tick * 2e-4);
	stage_step(session, 120);
	const cau_tool_state *jaws = stage_tool(session, "jaws");
	assert_int_equal(jaws->grasped_vertices, held);
	assert_true(jaws->raw_force_n[0] < -0.01); // the strip pulls back
	assert_true(jaws->force_n[0] <= 0 &&
	            cau_length(cau_vec3_of(jaws->force_n)) <= jaws->definition.force_max_n);
	cau_session_destroy(session);
	free(scene);
}

static void empty_jaws_say_so(void **state)
{
	(void)state;
	cau_scene_def *scene = strip_scene(2);
	scene->tools[0].pose.position_m[2] = 0.05;
	cau_session *session = stage_open(scene, 1);
	stage_grasp(session, "jaws");
	stage_step(session, 3);
	const cau_tool_state *jaws = stage_tool(session, "jaws");
	assert_true(jaws->grasping);
	assert_int_equal(jaws->grasped_vertices, 0);
	assert_true(cau_length(cau_vec3_of(jaws->raw_force_n)) == 0);
	cau_session_destroy(session);
	free(scene);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(nothing_is_inside_a_cold_tool),
		cmocka_unit_test(friction_keeps_to_its_cone),
		cmocka_unit_test(an_energized_ball_does_not_push),
		cmocka_unit_test(what_is_pressed_stays_in_contact),
		cmocka_unit_test(contact_says_what_it_left_out),
		cmocka_unit_test(the_tool_feels_the_weight_on_it),
		cmocka_unit_test(it_sticks_and_slips),
		cmocka_unit_test(jaws_hold_up_to_their_slip_force),
		cmocka_unit_test(jaws_hold_what_pulls_less),
		cmocka_unit_test(empty_jaws_say_so),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
