// SPDX-License-Identifier: GPL-3.0-or-later
// Pulls far beyond those of a hand, on a slab of every model under a membrane of every limit.
// Either the state stays possible for tissue, or the session is faulted, with the tick and the
// layer, and can be restored. It makes no difference whether a law has an energy.
#include "core/session/stage.h"

#include <stdio.h>

#include "constraint/elements.h"
#include "session/session_internal.h"

static const double SIZE_M[3] = {0.06, 0.04, 0.02};
static const int32_t CELLS[3] = {9, 6, 3};
static const double FORCE_N = 80, LEAP_M = 0.025;
// Greatest distance of a vertex, m, in a state without a fault: twice the size of the slab, and
// half of that again for the motion of a step before it is checked.
static const double FARTHEST_M = 3 * 0.0748;
enum { TICKS = 20, LIMITS = 4 };

static const char *const limit_names[LIMITS] = {"none", "target", "linearised", "range"};

// ---- scenes
static void set_sheet_limit(cau_sheet_material *sheet, int which)
{
	static const int limits[] = {CAU_LIMIT_NONE, CAU_LIMIT_TARGET, CAU_LIMIT_TARGET,
	                             CAU_LIMIT_RANGE};
	sheet->limit = limits[which];
	sheet->projection = which == 2 ? CAU_PROJECTION_LINEARISED : CAU_PROJECTION_CLOSED_FORM;
	sheet->limit_stiffness_pa = 1e5;
	for (int a = 0; a < 2; a++) {
		sheet->strain_min[a] = -0.05;
		sheet->strain_max[a] = 0.1;
	}
	sheet->shear_max = 0.1;
}

static void set_fat_limit(cau_fat_material *fat, int which)
{
	static const int limits[] = {CAU_LIMIT_NONE, CAU_LIMIT_TARGET, CAU_LIMIT_TARGET,
	                             CAU_LIMIT_RANGE};
	fat->limit = limits[which];
	fat->projection = which == 2 ? CAU_PROJECTION_LINEARISED : CAU_PROJECTION_CLOSED_FORM;
	for (int a = 0; a < 3; a++) {
		fat->strain_min[a] = -0.05;
		fat->strain_max[a] = 0.1;
	}
	fat->shear_max = 0.1;
}

static cau_scene_def *make_scene(int model, int fat_limit, int membrane_limit)
{
	const double floor_m[2][3] = {{-1, -1, -0.0201}, {1, 1, -0.0199}};
	cau_scene_def *scene = stage_scene(CAU_PRECISION_SINGLE);
	cau_layer_def *fat = stage_add_slab(scene, "fat", SIZE_M, CELLS);
	fat->fat[0].model = model;
	fat->fat[0].poisson_ratio = 0.3;
	set_fat_limit(&fat->fat[0], fat_limit);
	stage_add_membrane(scene, "membrane", "fat");
	set_sheet_limit(&scene->layers[1].sheet[0], membrane_limit);
	stage_pin_box(scene, floor_m[0], floor_m[1]);
	return scene;
}

// ---- pulls
static void push_patch(cau_session *session)
{
	const double least[3] = {-0.008, -0.008, -1e-4}, most[3] = {0.008, 0.008, 1};
	stage_force(session, stage_box(least, most), 0, 0, FORCE_N);
}

static void pull_corner(cau_session *session)
{
	const double least[3] = {0.0299, 0.0199, -1e-4}, most[3] = {1, 1, 1};
	stage_force(session, stage_box(least, most), FORCE_N, FORCE_N / 2, FORCE_N);
}

static void pull_corner_gently(cau_session *session)
{
	const double least[3] = {0.0299, 0.0199, -1e-4}, most[3] = {1, 1, 1};
	stage_force(session, stage_box(least, most), 0.2, 0.1, 0.3);
}

static void lead_patch(cau_session *session)
{
	const double least[3] = {-0.011, -0.011, -1e-4}, most[3] = {0.011, 0.011, 1};
	cau_command pin = stage_command(CAU_COMMAND_PIN);
	pin.as.selection = stage_box(least, most);
	stage_submit(session, &pin);
	stage_step(session, 1);
	cau_session_info info = stage_info(session);
	cau_error error = {0};
	int32_t vertex[64], count = 0;
	double at[3 * 64];
	for (int32_t v = 0; v < info.vertex_count; v++) {
		const double *x = info.rest_position + 3 * v;
		if (fabs(x[0]) > 0.011 || fabs(x[1]) > 0.011 || x[2] < -1e-4)
			continue;
		vertex[count] = v;
		for (int c = 0; c < 3; c++)
			at[3 * count + c] = x[c] + (c == 2 ? LEAP_M : 0);
		count++;
	}
	assert_true(count > 0);
	assert_int_equal(cau_session_drive(session, count, vertex, at, &error), CAU_OK);
}

typedef struct pull {
	const char *name;
	void (*begin)(cau_session *session);
	int beyond_tissue; // 1: the pull (80 N on a vertex) would tear fat of 5 kPa
} pull;
enum { PULLS = 4 };
static const pull pulls[PULLS] = {{"patch", push_patch, 1},
                                  {"corner", pull_corner, 1},
                                  {"gentle corner", pull_corner_gently, 0},
                                  {"leap", lead_patch, 0}};

// ---- results
static void describe(int model, int fat_limit, int membrane_limit, const pull *how, char *text,
                     size_t bytes)
{
	snprintf(text, bytes, "%s, fat %s, membrane %s, %s", cau_law_of(model)->word,
	         limit_names[fat_limit], limit_names[membrane_limit], how->name);
}

static void assert_possible(const cau_session *session, const char *what)
{
	cau_session_info info = stage_info(session);
	cau_frame frame = stage_frame(session);
	for (int32_t i = 0; i < 3 * info.vertex_count; i++)
		assert_true(isfinite(frame.position[i]) && isfinite(frame.velocity[i]));
	double far = stage_farthest(&frame, info.rest_position, info.vertex_count);
	if (far > FARTHEST_M || frame.statistics.inverted > info.tetrahedron_count / 2)
		fail_msg("%s: %g m away, %d inverted", what, far, frame.statistics.inverted);
}

// Asserts that the refusal names the tick and the layer, that the frame shows the state before the
// step, and that a snapshot restores the session.
static void assert_faulted(cau_session *session, const stage_bytes *shot, const cau_error *refusal,
                           const char *what)
{
	char tick[32];
	bool exact;
	cau_error error = {0};
	snprintf(tick, sizeof tick, "at tick %llu,", (unsigned long long)stage_frame(session).tick);
	if (!strstr(refusal->reason, tick) || !(strstr(refusal->reason, "in layer \"fat\"") ||
	                                        strstr(refusal->reason, "in layer \"membrane\"")))
		fail_msg("%s: \"%s\"", what, refusal->reason);
	assert_possible(session, what);
	assert_int_equal(cau_session_step(session, &error), CAU_FAULTED);
	assert_int_equal(cau_session_restore(session, shot->bytes, shot->count, &exact, &error),
	                 CAU_OK);
	stage_step(session, 1);
}

// Pulls the tissue. Returns whether the session was faulted.
static int try_pull(int model, int fat_limit, int membrane_limit, const pull *how)
{
	char what[128];
	describe(model, fat_limit, membrane_limit, how, what, sizeof what);
	cau_scene_def *scene = make_scene(model, fat_limit, membrane_limit);
	cau_session *session = stage_open(scene, 1);
	stage_step(session, 1);
	stage_bytes shot = stage_snapshot(session);
	how->begin(session);
	cau_status status = CAU_OK;
	cau_error error = {0};
	for (int tick = 0; tick < TICKS && !status; tick++) {
		status = cau_session_step(session, &error);
		assert_possible(session, what);
	}
	if (status)
		assert_faulted(session, &shot, &error, what);
	free(shot.bytes);
	cau_session_destroy(session);
	free(scene);
	return status != CAU_OK;
}

// Tissue holds the pulls of a hand, whatever its laws. A pull that it could not hold is a fault.
static void no_pull_ends_in_a_silent_disaster(void **state)
{
	(void)state;
	int faults[PULLS] = {0}, tries = 0;
	for (int model = 0; model < CAU_MODEL_COUNT; model++)
		for (int fat = 0; fat < LIMITS; fat++)
			for (int membrane = 0; membrane < LIMITS; membrane++) {
				if (fat && membrane) // only one of the two layers has a limit
					continue;
				tries++;
				for (int k = 0; k < PULLS; k++)
					faults[k] += try_pull(model, fat, membrane, &pulls[k]);
			}
	for (int k = 0; k < PULLS; k++) {
		print_message("%s: %d of %d faulted\n", pulls[k].name, faults[k], tries);
		assert_true(pulls[k].beyond_tissue || !faults[k]);
	}
}

static void expect_fault(int model, int fat_limit, int membrane_limit, double velocity_m_s)
{
	const pull how = {.name = isnan(velocity_m_s) ? "nowhere" : "fast"};
	char what[128];
	describe(model, fat_limit, membrane_limit, &how, what, sizeof what);
	cau_scene_def *scene = make_scene(model, fat_limit, membrane_limit);
	cau_session *session = stage_open(scene, 1);
	stage_step(session, 3);
	stage_bytes shot = stage_snapshot(session);
	for (int32_t i = 0; i < 3 * session->tissue.vertex_count; i++)
		session->vertices.velocity[i] = session->vertices.fixed[i / 3] ? 0 : velocity_m_s;
	cau_error error = {0};
	if (cau_session_step(session, &error) != CAU_NUMERICAL)
		fail_msg("%s: no fault", what);
	assert_faulted(session, &shot, &error, what);
	free(shot.bytes);
	cau_session_destroy(session);
	free(scene);
}

// A vertex faster than sound, and a vertex whose position is not a number, are faults, whatever the
// law and the limits.
static void what_no_vertex_does_is_a_fault(void **state)
{
	(void)state;
	expect_fault(CAU_MODEL_NEOHOOKEAN, 0, 0, 2e5);
	for (int model = 0; model < CAU_MODEL_COUNT; model++)
		for (int limit = 0; limit < LIMITS; limit++)
			expect_fault(model, limit, LIMITS - 1 - limit, NAN);
}

static int32_t nearest_vertex(const cau_session *session, double x, double y, double z)
{
	int32_t nearest = -1;
	double least = INFINITY;
	for (int32_t v = 0; v < session->tissue.vertex_count; v++) {
		const double *at = session->tissue.rest + 3 * v;
		double away = hypot(hypot(at[0] - x, at[1] - y), at[2] - z);
		if (away < least && !session->vertices.fixed[v]) {
			nearest = v;
			least = away;
		}
	}
	return nearest;
}

// A vertex has no position while a tool touches or holds other vertices. Then the tool's force is
// not a number either, and the step is a fault too.
static void nowhere_beside_a_tool_is_a_fault(void **state)
{
	(void)state;
	static const int shapes[] = {CAU_TOOL_SPHERE, CAU_TOOL_GRASPER};
	for (int k = 0; k < 2; k++)
		for (int corner = 0; corner < 2; corner++) {
			cau_scene_def *scene = make_scene(CAU_MODEL_NEOHOOKEAN, 0, 0);
			stage_add_tool(scene, "tool", shapes[k], SIZE_M[0] / 18, 0, k ? -0.001 : 0.009)
				->hot_radius_m = 0.01;
			cau_session *session = stage_open(scene, 1);
			if (k)
				stage_grasp(session, "tool");
			stage_step(session, 20);
			const cau_tool_state *tool = stage_tool(session, "tool");
			assert_true(k ? tool->grasped_vertices > 0 : tool->contact_vertices > 0);
			stage_bytes shot = stage_snapshot(session);
			int32_t at =
				corner ? nearest_vertex(session, 0.03, 0.02, 0) : nearest_vertex(session, 0, 0, 0);
			session->vertices.velocity[3 * at] = NAN;
			cau_error error = {0};
			assert_int_equal(cau_session_step(session, &error), CAU_NUMERICAL);
			assert_faulted(session, &shot, &error, "nowhere beside a tool");
			free(shot.bytes);
			cau_session_destroy(session);
			free(scene);
		}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(no_pull_ends_in_a_silent_disaster),
		cmocka_unit_test(what_no_vertex_does_is_a_fault),
		cmocka_unit_test(nowhere_beside_a_tool_is_a_fault),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
