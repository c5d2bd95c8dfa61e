// SPDX-License-Identifier: GPL-3.0-or-later
// No tissue crosses a tool (core/DECISIONS.md, "Contact"). Balls smaller and larger than the
// elements are pressed into a sheet and a slab, slowly, and so fast that one tick takes them to the
// other side.
#include "core/session/stage.h"

#include <stdio.h>
#include <stdlib.h>

#include "session/session_internal.h"

typedef struct press {
	const char *what;
	bool slab;
	double radius_m, cell_m, speed_m_s, depth_m;
} press;

static const press presses[] = {
	{"1 mm ball, sheet of 2 mm cells, slow", false, 0.5e-3, 2e-3, 0.01, 3e-3},
	{"1 mm ball, sheet of 2 mm cells, 1 m/s", false, 0.5e-3, 2e-3, 1, 3e-3},
	{"3 mm ball, sheet of 2 mm cells, 0.1 m/s", false, 1.5e-3, 2e-3, 0.1, 4e-3},
	{"3 mm ball, sheet of 2 mm cells, 1.5 m/s", false, 1.5e-3, 2e-3, 1.5, 4e-3},
	{"3 mm ball, sheet of 1 mm cells, 1.5 m/s", false, 1.5e-3, 1e-3, 1.5, 4e-3},
	{"3 mm ball, sheet of 4 mm cells, 0.1 m/s", false, 1.5e-3, 4e-3, 0.1, 4e-3},
	{"1 mm ball, slab of 2.5 mm cells, slow", true, 0.5e-3, 2.5e-3, 0.02, 2e-3},
	{"3 mm ball, slab of 2.5 mm cells, 1 m/s", true, 1.5e-3, 2.5e-3, 1, 4e-3},
	{"13 mm ball, slab of 2.5 mm cells, 0.1 m/s", true, 6.5e-3, 2.5e-3, 0.1, 4e-3},
	{"80 mm ball, slab of 2.5 mm cells, 0.1 m/s", true, 40e-3, 2.5e-3, 0.1, 4e-3},
	{"80 mm ball, slab of 2 mm cells, 0.1 m/s", true, 40e-3, 2e-3, 0.1, 4e-3},
	// More vertices touch than there are whole columns.
	{"80 mm ball, slab of 1.25 mm cells, 0.1 m/s", true, 40e-3, 1.25e-3, 0.1, 4e-3},
};

static const double most_m = 1e-4; // m, greatest depth of a face in a ball at rest
static const double wide_ball_m = 0.04;

static cau_scene_def *press_scene(const press *p)
{
	cau_scene_def *scene = stage_scene(CAU_PRECISION_SINGLE);
	const double wide = p->slab ? 0.04 : 0.032;
	int32_t cells = (int32_t)(wide / p->cell_m + 0.5);
	if (p->slab) {
		const double size[3] = {wide, wide, 0.016};
		const int32_t counts[3] = {cells, cells, (int32_t)(0.016 / p->cell_m)};
		const double least[3] = {-1, -1, -0.0161}, most[3] = {1, 1, -0.0159};
		stage_add_slab(scene, "fat", size, counts);
		stage_pin_box(scene, least, most);
	} else {
		const double half = wide / 2 - 1e-6;
		const double sides[4][2][3] = {{{-1, -1, -1}, {-half, 1, 1}},
		                               {{half, -1, -1}, {1, 1, 1}},
		                               {{-1, -1, -1}, {1, -half, 1}},
		                               {{-1, half, -1}, {1, 1, 1}}};
		stage_add_sheet(scene, "fascia", wide, wide, cells, cells);
		for (int i = 0; i < 4; i++)
			stage_pin_box(scene, sides[i][0], sides[i][1]);
	}
	// The ball is beside the lines of the mesh, so that no vertex is below it.
	cau_tool_def *ball = stage_add_tool(scene, "ball", CAU_TOOL_SPHERE, 0.27 * p->cell_m,
	                                    0.31 * p->cell_m, p->radius_m + 1e-3);
	ball->hot_radius_m = p->radius_m;
	ball->grid_step_m = fmin(p->radius_m, 2e-3);
	ball->friction = 0.2;
	ball->max_speed_m_s = 2;
	return scene;
}

// ---- depth and crossing, measured by sampling, independently of the code under test

static cau_vec3 corner(const cau_session *session, int32_t face, int k)
{
	int32_t v = session->tissue.faces.vertex[3 * (size_t)face + (size_t)k];
	return cau_vec3_of(session->vertices.position + 3 * (size_t)v);
}

static bool is_drawn(const cau_session *session, int32_t face)
{
	return !(session->dissection.face_mask[face >> 5] >> (face & 31) & 1);
}

// Whether the vertical line up from the ball's middle, which is the path of the ball, meets the
// face.
static bool is_above(cau_vec3 from, cau_vec3 a, cau_vec3 b, cau_vec3 c)
{
	double ab = (b.x - a.x) * (from.y - a.y) - (b.y - a.y) * (from.x - a.x);
	double bc = (c.x - b.x) * (from.y - b.y) - (c.y - b.y) * (from.x - b.x);
	double ca = (a.x - c.x) * (from.y - c.y) - (a.y - c.y) * (from.x - c.x);
	double area = ab + bc + ca;
	bool within = (ab > 0 && bc > 0 && ca > 0) || (ab < 0 && bc < 0 && ca < 0);
	return within && (bc * a.z + ca * b.z + ab * c.z) / area > from.z;
}

static double depth_of_face(cau_vec3 middle, double radius, cau_vec3 a, cau_vec3 b, cau_vec3 c)
{
	enum { SAMPLES = 12 };
	double least = 1e300;
	for (int i = 0; i <= SAMPLES; i++)
		for (int j = 0; i + j <= SAMPLES; j++) {
			double u = (double)i / SAMPLES, v = (double)j / SAMPLES;
			cau_vec3 x = cau_add_scaled(cau_add_scaled(cau_scale(1 - u - v, a), u, b), v, c);
			least = fmin(least, cau_length(cau_sub(x, middle)));
		}
	return radius - least;
}

typedef struct seen {
	bool crossed;
	double depth_m, force_n;
	int32_t rows, left_out;
} seen;

static seen look(const cau_session *session, const press *p)
{
	const cau_tool_state *ball = stage_tool(session, "ball");
	cau_vec3 middle = cau_vec3_of(ball->pose.position_m);
	seen s = {.force_n = ball->raw_force_n[2], .depth_m = -1};
	for (int32_t f = 0; f < session->tissue.faces.face_count; f++) {
		if (!is_drawn(session, f))
			continue;
		cau_vec3 a = corner(session, f, 0), b = corner(session, f, 1), c = corner(session, f, 2);
		s.crossed = s.crossed || is_above(middle, a, b, c);
		if (cau_length(cau_sub(a, middle)) < p->radius_m + 3 * p->cell_m)
			s.depth_m = fmax(s.depth_m, depth_of_face(middle, p->radius_m, a, b, c));
	}
	return s;
}

// Presses the ball in and holds it for a second. Returns whether nothing crossed and the end is
// right. *end gets the measurements at the end.
static bool holds(const press *p, seen *end)
{
	cau_scene_def *scene = press_scene(p);
	cau_session *session = stage_open(scene, 1);
	double top = p->radius_m + 1e-3, step = p->speed_m_s / 60;
	int in = (int)((p->depth_m + 1e-3) / step) + 1, crossed = 0;
	seen s = {0};
	for (int tick = 0; tick < in + 60; tick++) {
		stage_move(session, "ball", 0.27 * p->cell_m, 0.31 * p->cell_m,
		           top - fmin((tick + 1) * step, p->depth_m + 1e-3));
		stage_step(session, 1);
		s = look(session, p);
		crossed += s.crossed;
	}
	print_message("%-44s %s: %.3f mm deep at rest, %.3g N\n", p->what, crossed ? "CROSSED" : "held",
	              1e3 * s.depth_m, s.force_n);
	*end = s;
	end->rows = stage_frame(session).statistics.contacts;
	end->left_out = stage_frame(session).statistics.contacts_left_out;
	cau_session_destroy(session);
	free(scene);
	return !crossed && s.depth_m <= most_m && s.force_n > 0;
}

static void nothing_crosses(void **state)
{
	(void)state;
	int failed = 0;
	seen end = {0};
	double wide_n = 0; // force on the wide ball in the first tissue
	for (size_t i = 0; i < sizeof presses / sizeof *presses; i++) {
		failed += !holds(&presses[i], &end);
		if (presses[i].radius_m < wide_ball_m)
			continue;
		wide_n = wide_n > 0 ? wide_n : end.force_n;
		// The same material gives the same force in finer cells.
		assert_true(fabs(end.force_n / wide_n - 1) < 0.1);
		assert_int_equal(end.left_out, 0);
	}
	assert_int_equal(failed, 0);
	assert_true(wide_n > 0.5);
	// The last case has more constraints than whole columns, and these constraints work too.
	assert_true(end.rows > CAU_WHOLE_COLUMNS);
}

// A ball on its side has no part left at the faces that it passes within a tick. (A ball that is
// pressed in upright has its shaft there.)
static void what_a_tick_takes_past_a_face_is_held_too(void **state)
{
	(void)state;
	static const press quick = {"3 mm ball on its side", false, 1.5e-3, 1e-3, 1, 8e-3};
	cau_scene_def *scene = press_scene(&quick);
	scene->tools[0].shaft_length_m = 4e-3;
	cau_pose pose = scene->tools[0].pose;
	pose.rotation[0] = pose.rotation[2] = sqrt(0.5); // the shaft is along x
	scene->tools[0].pose = pose;
	cau_session *session = stage_open(scene, 1);
	stage_step(session, 1);
	pose.position_m[2] = -quick.depth_m;
	stage_turn(session, "ball", &pose); // at most 2 m/s, so the ball arrives within the tick
	for (int tick = 0; tick < 30; tick++) {
		stage_step(session, 1);
		assert_false(look(session, &quick).crossed);
	}
	assert_true(stage_tool(session, "ball")->pose.position_m[2] < -0.9 * quick.depth_m);
	assert_true(look(session, &quick).force_n > 0);
	cau_session_destroy(session);
	free(scene);
}

// Compares a press with the same press on two threads, restored from a snapshot before each tick.
// Returns the number of ticks with contact memory, or for the wide ball the number of columns.
static int32_t press_twice(const press *p, int ticks, int snapshots_from)
{
	cau_scene_def *scene = press_scene(p);
	cau_session *session = stage_open(scene, 1), *other = stage_open(scene, 2);
	int32_t kept = 0;
	for (int tick = 0; tick < ticks; tick++) {
		double in = fmin((tick + 1) * p->speed_m_s / 60, p->depth_m + 1e-3);
		cau_error error = {0};
		bool exact = false;
		if (tick >= snapshots_from) {
			stage_bytes shot = stage_snapshot(session);
			if (cau_session_restore(other, shot.bytes, shot.count, &exact, &error))
				fail_msg("%s", error.reason);
			assert_true(exact);
			free(shot.bytes);
			assert_int_equal(other->contact.sides.memory_count,
			                 session->contact.sides.memory_count);
			assert_int_equal(other->contact.columns.count, session->contact.columns.count);
		}
		kept += session->contact.sides.memory_count > 0;
		stage_move(session, "ball", 0.27 * p->cell_m, 0.31 * p->cell_m, p->radius_m + 1e-3 - in);
		stage_move(other, "ball", 0.27 * p->cell_m, 0.31 * p->cell_m, p->radius_m + 1e-3 - in);
		stage_step(session, 1);
		stage_step(other, 1);
		assert_true(cau_session_hash(session) == cau_session_hash(other));
	}
	int32_t columns = session->contact.columns.count;
	cau_session_destroy(session);
	cau_session_destroy(other);
	free(scene);
	return p->radius_m < wide_ball_m ? kept : columns;
}

// The stored sides of faces are part of the state.
static void sides_are_part_of_the_state(void **state)
{
	(void)state;
	enum { TICKS = 30 };
	assert_true(press_twice(&presses[2], TICKS, 0) > TICKS / 2);
}

// Columns of which only the part for the constraints is stored are part of the state too.
static void columns_are_part_of_the_state(void **state)
{
	(void)state;
	static const press wide = {"", true, 40e-3, 1.6e-3, 0.3, 4e-3};
	assert_true(press_twice(&wide, 26, 18) > CAU_WHOLE_COLUMNS);
}

// When its energy goes off, a tool may begin to push from inside the tissue. Such tissue has no
// side: it may leave in any direction, and nothing diverges.
static void a_tool_that_begins_inside_throws_nothing(void **state)
{
	(void)state;
	cau_scene_def *scene = press_scene(&presses[4]);
	scene->tools[0].pose.position_m[2] = 0;
	cau_session *session = stage_open(scene, 1);
	for (int tick = 0; tick < 60; tick++) {
		stage_step(session, 1);
		cau_frame frame = stage_frame(session);
		cau_session_info info = stage_info(session);
		assert_true(stage_farthest(&frame, info.rest_position, info.vertex_count) <
		            2 * presses[4].radius_m);
	}
	cau_session_destroy(session);
	free(scene);
}

// A tool is pressed in and drawn across the tissue and over its rim, slowly, and so fast that each
// tick takes it past whole elements. The tissue behind it is not dragged along, and no tissue
// diverges.
static void what_is_drawn_across_drags_nothing_along(void **state)
{
	(void)state;
	static const struct {
		const char *scene;
		int shape;
		double speed_m_s;
	} ways[] = {
		{"fat", CAU_TOOL_SPHERE, 0.05},
		{"fat", CAU_TOOL_SPHERE, 0.5},
		{"fat", CAU_TOOL_HOOK, 0.05},
		{"fascia", CAU_TOOL_SPHERE, 0.05},
	};
	const double radius_m = 1.5e-3, depth_m = 2e-3;
	const double bounded_m = 3 * depth_m;
	for (size_t w = 0; w < sizeof ways / sizeof *ways; w++) {
		cau_scene_def *scene = stage_scene_light(ways[w].scene);
		scene->tool_count = 0;
		cau_tool_def *tool =
			stage_add_tool(scene, "ball", ways[w].shape, -0.02, 1.3e-3, radius_m + 1e-3);
		tool->hot_radius_m = tool->grid_step_m = radius_m;
		tool->max_speed_m_s = 2;
		cau_session *session = stage_open(scene, 1);
		cau_session_info info = stage_info(session);
		double far = 0, reach_m = 0.09; // the motion ends beyond the rim
		int ticks = 20 + (int)(60 * reach_m / ways[w].speed_m_s);
		for (int tick = 0; tick < ticks; tick++) {
			double in = fmin((tick + 1) * 1e-3, 1e-3 + depth_m);
			double along = tick > 20 ? (tick - 20) * ways[w].speed_m_s / 60 : 0;
			stage_move(session, "ball", -0.02 + along, 1.3e-3, radius_m + 1e-3 - in);
			stage_step(session, 1);
			cau_frame frame = stage_frame(session);
			far = fmax(far, stage_farthest(&frame, info.rest_position, info.vertex_count));
		}
		print_message("%s at %g m/s: %.1f mm at most\n", ways[w].scene, ways[w].speed_m_s,
		              1e3 * far);
		assert_true(far < bounded_m);
		cau_session_destroy(session);
		free(scene);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(nothing_crosses),
		cmocka_unit_test(what_a_tick_takes_past_a_face_is_held_too),
		cmocka_unit_test(sides_are_part_of_the_state),
		cmocka_unit_test(columns_are_part_of_the_state),
		cmocka_unit_test(a_tool_that_begins_inside_throws_nothing),
		cmocka_unit_test(what_is_drawn_across_drags_nothing_along),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
