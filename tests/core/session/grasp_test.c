// SPDX-License-Identifier: GPL-3.0-or-later
// Jaws hold the tissue between them, even if the jaws are smaller than an element. They report that
// they slip or are empty. Nothing jumps when they close.
#include "core/session/stage.h"
#include "session/session_internal.h"

// Returns a scene: jaws 2 mm wide and 4 mm long on cells of 10 mm, half way between vertices.
static cau_scene_def *coarse_scene(double x, double y, double z)
{
	cau_scene_def *scene = stage_scene(CAU_PRECISION_SINGLE);
	stage_add_sheet(scene, "sheet", 0.06, 0.05, 6, 5)->sheet[0].limit_stiffness_pa = 1e6;
	cau_selection *rim = &scene->pins[scene->pin_count++];
	cau_default_selection(rim, CAU_SELECT_RIM);
	cau_tool_def *jaws = stage_add_tool(scene, "jaws", CAU_TOOL_GRASPER, x, y, z);
	jaws->shaft_radius_m = 1e-3;
	jaws->tip_length_m = 4e-3;
	return scene;
}

static cau_vec3 center_of_holds(const cau_session *session)
{
	const cau_tool *tool = &session->tool[0];
	cau_vec3 sum = {0, 0, 0};
	for (int32_t k = 0; k < tool->grasp_count; k++) {
		cau_contact_row row = cau_session_row_of_hold(session, &tool->grasp[k], 0);
		sum = cau_add_scaled(sum, 1.0 / tool->grasp_count,
		                     cau_contact_point(&row, session->vertices.position));
	}
	return sum;
}

static void jaws_smaller_than_a_cell_hold_and_pull(void **state)
{
	(void)state;
	const double way_m = 4e-3, speed_m = 2e-4, near_m = 1.5e-3;
	cau_scene_def *scene = coarse_scene(0.004, 0.003, -0.002);
	cau_session *session = stage_open(scene, 1), *other = stage_open(scene, 4);
	stage_step(session, 2);
	stage_grasp(session, "jaws");
	size_t bytes = 3 * (size_t)stage_info(session).vertex_count * sizeof(double);
	double *before = malloc(bytes);
	assert_non_null(before);
	memcpy(before, stage_frame(session).position, bytes);
	for (int tick = 0; tick < 20; tick++) { // the jaws close meanwhile
		stage_step(session, 1);
		cau_frame frame = stage_frame(session);
		assert_true(stage_farthest(&frame, before, stage_info(session).vertex_count) < 1e-4);
	}
	int32_t held = stage_tool(session, "jaws")->grasped_vertices;
	assert_in_range(held, 1, 4);
	assert_true(session->tool[0].grasp[0].face >= 0);
	assert_true(stage_tool(session, "jaws")->asked_jaw == 0);
	// Half a millimetre of sheet is between the jaws.
	assert_true(stage_tool(session, "jaws")->jaw < 0.3);
	cau_vec3 start = center_of_holds(session);
	for (int tick = 1; tick <= 40; tick++) {
		stage_move(session, "jaws", 0.004, 0.003, -0.002 + fmin(speed_m * tick, way_m));
		stage_step(session, 1);
		if (tick == 20) { // a snapshot must contain the holds on faces
			stage_bytes shot = stage_snapshot(session);
			bool exact = false;
			cau_error error = {0};
			assert_int_equal(cau_session_restore(other, shot.bytes, shot.count, &exact, &error),
			                 CAU_OK);
			assert_true(exact);
			free(shot.bytes);
		}
		if (tick > 20) {
			stage_move(other, "jaws", 0.004, 0.003, -0.002 + fmin(speed_m * tick, way_m));
			stage_step(other, 1);
			assert_true(cau_session_hash(other) == cau_session_hash(session));
		}
	}
	// The tissue moves with the jaws, except for the spring of the hold, and the jaws feel the
	// tissue.
	cau_vec3 way = cau_sub(center_of_holds(session), start);
	assert_true(fabs(way.z - way_m) < near_m);
	assert_true(stage_tool(session, "jaws")->force_n[2] < -0.05);
	assert_int_equal(stage_tool(session, "jaws")->grasped_vertices, held);
	free(before);
	cau_session_destroy(session);
	cau_session_destroy(other);
	free(scene);
}

static void empty_jaws_close_whole_and_say_so(void **state)
{
	(void)state;
	cau_scene_def *scene = coarse_scene(0.004, 0.003, 0.02);
	cau_session *session = stage_open(scene, 1);
	stage_grasp(session, "jaws");
	stage_step(session, 30);
	const cau_tool_state *jaws = stage_tool(session, "jaws");
	assert_true(jaws->grasping && !jaws->slipping);
	assert_int_equal(jaws->grasped_vertices, 0);
	assert_true(jaws->jaw == 0 && jaws->asked_jaw == 0 && jaws->jaw_force_n == 0);
	cau_session_destroy(session);
	free(scene);
}

// ---- jaws that stop at the tissue between them

// Returns a scene: a block on a pinned floor, 3 mm wide in x. Open jaws reach around it.
static cau_scene_def *block_scene(int shape, double young_pa)
{
	const double size[3] = {0.003, 0.012, 0.012},
				 floor_m[2][3] = {{-1, -1, -0.0121}, {1, 1, -0.0119}};
	const int32_t cells[3] = {3, 8, 8};
	cau_scene_def *scene = stage_scene(CAU_PRECISION_SINGLE);
	scene->iterations = 30;
	scene->damping_per_s = 20;
	cau_fat_material *fat = stage_add_slab(scene, "block", size, cells)->fat;
	fat->young_modulus_pa = young_pa;
	fat->poisson_ratio = 0.3;
	stage_pin_box(scene, floor_m[0], floor_m[1]);
	cau_tool_def *jaws = stage_add_tool(scene, "jaws", shape, 0, 0, -0.006);
	if (shape == CAU_TOOL_SHEARS)
		jaws->pose.position_m[0] = -0.0015 - jaws->hot_radius_m; // the blade is beside the block
	jaws->grasp_stiffness_n_m = 2000;
	jaws->slip_force_n = 1000;
	jaws->force_max_n = 1000;
	return scene;
}

typedef struct closing {
	double jaw, force_n, width_m; // values at the end; width of the block at the jaws
	double most_n;                // greatest force at any time
} closing;

static double width_held_m(const cau_session *session)
{
	const cau_tool *tool = &session->tool[0];
	double least = HUGE_VAL, most = -HUGE_VAL;
	for (int32_t k = 0; k < tool->grasp_count; k++) {
		cau_contact_row row = cau_session_row_of_hold(session, &tool->grasp[k], 0);
		double x = cau_contact_point(&row, session->vertices.position).x;
		least = fmin(least, x);
		most = fmax(most, x);
	}
	return most - least;
}

static closing close_on(int shape, double young_pa, double close_force_n)
{
	enum { TICKS = 240 };
	const double rounding_n = 1e-3, jump_m = 5e-4;
	closing c = {0};
	cau_scene_def *scene = block_scene(shape, young_pa);
	scene->tools[0].close_force_n = close_force_n;
	cau_session *session = stage_open(scene, 2);
	stage_grasp(session, "jaws");
	size_t bytes = 3 * (size_t)stage_info(session).vertex_count * sizeof(double);
	double *before = malloc(bytes);
	assert_non_null(before);
	for (int tick = 0; tick < TICKS; tick++) {
		memcpy(before, stage_frame(session).position, bytes);
		stage_step(session, 1);
		cau_frame frame = stage_frame(session);
		assert_true(stage_farthest(&frame, before, stage_info(session).vertex_count) < jump_m);
		c.most_n = fmax(c.most_n, stage_tool(session, "jaws")->jaw_force_n);
	}
	const cau_tool_state *jaws = stage_tool(session, "jaws");
	c.jaw = jaws->jaw;
	c.force_n = jaws->jaw_force_n;
	c.width_m = width_held_m(session);
	print_message("%.0f kPa, %.1f N: open by %.3f, %.2f N (%.2f at most), %.2f mm wide, %d held\n",
	              young_pa / 1000, close_force_n, c.jaw, c.force_n, c.most_n, 1000 * c.width_m,
	              jaws->grasped_vertices);
	assert_true(jaws->grasped_vertices > 10 && jaws->asked_jaw == 0);
	assert_true(c.most_n <= close_force_n + rounding_n);
	free(before);
	cau_session_destroy(session);
	free(scene);
	return c;
}

// Stiff tissue stops the jaws early, at their greatest force. Soft tissue stops them late.
static void jaws_stop_where_tissue_bears_what_they_press_with(void **state)
{
	(void)state;
	const double reached = 0.98, wide_m = 0.003, least_share = 0.4;
	closing soft = close_on(CAU_TOOL_GRASPER, 5e3, 8);
	closing firm = close_on(CAU_TOOL_GRASPER, 2e6, 8);
	closing weak = close_on(CAU_TOOL_GRASPER, 2e6, 4);
	assert_true(firm.force_n > reached * 8 && weak.force_n > reached * 4);
	assert_true(firm.jaw > soft.jaw + 0.02 && weak.jaw > firm.jaw + 0.02);
	assert_true(soft.width_m < firm.width_m && firm.width_m < weak.width_m);
	assert_true(weak.width_m < wide_m);
	// Soft tissue fills the jaws near the hinge. The jaws stop at its least thickness, and press
	// with less force.
	assert_true(fabs(soft.jaw - least_share) < 0.01 && soft.force_n < 1);
}

static void every_shape_with_jaws_stops(void **state)
{
	(void)state;
	closing bipolar = close_on(CAU_TOOL_BIPOLAR, 1e6, 4);
	closing shears = close_on(CAU_TOOL_SHEARS, 1e6, 4);
	assert_true(bipolar.jaw > 0.05 && bipolar.force_n > 3.9);
	assert_true(shears.jaw > 0.05 && shears.force_n > 3.9);
}

static void held_jaws_rest_and_open_again(void **state)
{
	(void)state;
	cau_scene_def *scene = block_scene(CAU_TOOL_GRASPER, 1e5);
	cau_session *session = stage_open(scene, 1), *other = stage_open(scene, 4);
	stage_grasp(session, "jaws");
	stage_step(session, 6); // the jaws are still closing
	stage_bytes shot = stage_snapshot(session);
	bool exact = false;
	cau_error error = {0};
	assert_int_equal(cau_session_restore(other, shot.bytes, shot.count, &exact, &error), CAU_OK);
	assert_true(exact);
	free(shot.bytes);
	for (int tick = 0; tick < 100; tick++) {
		stage_step(session, 1);
		stage_step(other, 1);
		assert_true(cau_session_hash(session) == cau_session_hash(other));
	}
	int tick = 0;
	for (; tick < 2000 && !stage_frame(session).statistics.resting; tick++)
		stage_step(session, 1);
	assert_true(stage_frame(session).statistics.resting);
	assert_true(stage_tool(session, "jaws")->jaw > 0);
	stage_release(session, "jaws");
	stage_step(session, 20);
	assert_true(stage_tool(session, "jaws")->jaw == 1);
	assert_true(stage_tool(session, "jaws")->jaw_force_n == 0);
	cau_frame frame = stage_frame(session); // the released tissue is where it was before
	cau_session_info info = stage_info(session);
	assert_true(stage_farthest(&frame, info.rest_position, info.vertex_count) < 2e-3);
	cau_session_destroy(session);
	cau_session_destroy(other);
	free(scene);
}

static void what_is_pulled_too_hard_slips_and_is_lost(void **state)
{
	(void)state;
	cau_scene_def *scene = coarse_scene(0.004, 0.003, -0.002);
	scene->tools[0].slip_force_n = 0.05;
	cau_session *session = stage_open(scene, 1);
	stage_grasp(session, "jaws");
	stage_step(session, 20);
	assert_true(stage_tool(session, "jaws")->grasped_vertices > 0);
	int32_t slips = 0;
	for (int tick = 1; tick <= 100 && stage_tool(session, "jaws")->grasped_vertices; tick++) {
		stage_move(session, "jaws", 0.004, 0.003, -0.002 + 2e-4 * tick);
		stage_step(session, 1);
		slips += stage_tool(session, "jaws")->slipping;
	}
	assert_true(slips > 5);
	assert_int_equal(stage_tool(session, "jaws")->grasped_vertices, 0);
	cau_session_destroy(session);
	free(scene);
}

// If a face tears or burns, its holds end.
static void a_hold_goes_with_its_face(void **state)
{
	(void)state;
	cau_scene_def *scene = coarse_scene(0.004, 0.003, -0.002);
	scene->layers[0].sheet[0].heat.tear_energy_j_m2 = 1; // so small that the sheet tears at once
	scene->tools[0].slip_force_n = 1000;
	cau_session *session = stage_open(scene, 1);
	stage_grasp(session, "jaws");
	stage_step(session, 20);
	assert_true(stage_tool(session, "jaws")->grasped_vertices > 0);
	for (int tick = 1; tick <= 100 && stage_tool(session, "jaws")->grasped_vertices; tick++) {
		stage_move(session, "jaws", 0.004, 0.003, -0.002 + 2e-4 * tick);
		stage_step(session, 1);
	}
	assert_true(stage_frame(session).statistics.elements_torn > 0);
	assert_int_equal(stage_tool(session, "jaws")->grasped_vertices, 0);
	cau_session_destroy(session);
	free(scene);
}

// ---- another definition of a tool that holds tissue
typedef struct change {
	const char *field;
	size_t offset;
	double value;
	bool form; // the change is in a size or in the grid, so the jaws open
} change;

#define OF(field, value, form)                                                                     \
	{                                                                                              \
#field, offsetof(cau_tool_def, field), value, form                                         \
	}

static void assert_change(const change *changed)
{
	cau_scene_def *scene = coarse_scene(0.004, 0.003, -0.002);
	scene->tools[0].shape = CAU_TOOL_BIPOLAR;
	cau_session *session = stage_open(scene, 1);
	cau_command configure = stage_command(CAU_COMMAND_TOOL_CONFIGURE);
	stage_grasp(session, "jaws");
	stage_energize(session, "jaws", true);
	stage_step(session, 20);
	int32_t held = stage_tool(session, "jaws")->grasped_vertices;
	double warmest_c = cau_heat_grid_warmest(&session->tool[0].grid);
	assert_true(held > 0 && warmest_c > 100);
	stage_energize(session, "jaws", false);
	strcpy(configure.tool, "jaws");
	configure.as.definition = stage_tool(session, "jaws")->definition;
	*(double *)((char *)&configure.as.definition + changed->offset) = changed->value;
	stage_submit(session, &configure);
	stage_step(session, 1);
	const cau_tool_state *jaws = stage_tool(session, "jaws");
	assert_true(*(const double *)((const char *)&jaws->definition + changed->offset) ==
	            changed->value);
	bool stays = jaws->grasping && jaws->grasped_vertices == held &&
	             cau_heat_grid_warmest(&session->tool[0].grid) > 60;
	if (stays == changed->form)
		fail_msg("%s: %d of %d held", changed->field, jaws->grasped_vertices, held);
	cau_session_destroy(session);
	free(scene);
}

// Forceps coagulate tissue between their jaws. A change of power must not open the jaws.
static void a_setting_keeps_what_jaws_hold(void **state)
{
	(void)state;
	static const change changes[] = {
		OF(hot_radius_m, 4e-3, true),     OF(tip_length_m, 5e-3, true),
		OF(shaft_radius_m, 1.2e-3, true), OF(shaft_length_m, 0.2, true),
		OF(jaw_open_rad, 0.7, true),      OF(temperature_c, 150, false),
		OF(grid_cells, 20, true),         OF(grid_step_m, 9e-4, true),
		OF(diffusivity_m2_s, 4e-6, true), OF(max_speed_m_s, 0.4, false),
		OF(max_turn_rad_s, 11, false),    OF(friction, 0.3, false),
		OF(drag_ns_m, 0.06, false),       OF(grasp_stiffness_n_m, 210, false),
		OF(slip_force_n, 2.1, false),     OF(force_max_n, 19, false),
		OF(close_force_n, 7.5, false),    OF(power_w, 40, false),
		OF(peak_v, 190, false),           OF(crest_factor, 2, false),
		OF(current_max_a, 1, false),      OF(force_filter_s, 0.05, false),
		OF(blade_heat_j_k, 0.3, false),   OF(blade_cooling_w_k, 0.01, false),
		OF(load_rise_off, 3, false),
	};
#define ONE(...) +1
	// Every member of the table is tested.
	assert_int_equal(sizeof changes / sizeof changes[0], CAU_TOOL_TABLE(ONE));
#undef ONE
	for (size_t i = 0; i < sizeof changes / sizeof changes[0]; i++)
		assert_change(&changes[i]);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(jaws_smaller_than_a_cell_hold_and_pull),
		cmocka_unit_test(empty_jaws_close_whole_and_say_so),
		cmocka_unit_test(jaws_stop_where_tissue_bears_what_they_press_with),
		cmocka_unit_test(every_shape_with_jaws_stops),
		cmocka_unit_test(held_jaws_rest_and_open_again),
		cmocka_unit_test(what_is_pulled_too_hard_slips_and_is_lost),
		cmocka_unit_test(a_hold_goes_with_its_face),
		cmocka_unit_test(a_setting_keeps_what_jaws_hold),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
