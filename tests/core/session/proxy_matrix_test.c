// SPDX-License-Identifier: GPL-3.0-or-later
// Instruments of all kinds and sizes, pressed slowly and fast into a sheet, a slab and `layers`, on
// meshes of half, one and two times the resolution. Nothing crosses before a tool pushes with its
// full force, and a ball stands on the drawn surface. By default a ninth of the presses run,
// without the finest slab. The environment variable PROXY_MATRIX=N runs every N-th press, `all`
// every press.
#include <stdio.h>

#include "core/session/pressing.h"

typedef struct kind {
	const char *what;
	int shape;
	double radius_m;
} kind;

static const kind kinds[] = {
	{"ball of 0.25 mm", CAU_TOOL_SPHERE, 0.25e-3}, {"ball of 0.5 mm", CAU_TOOL_SPHERE, 0.5e-3},
	{"ball of 1.5 mm", CAU_TOOL_SPHERE, 1.5e-3},   {"ball of 6.5 mm", CAU_TOOL_SPHERE, 6.5e-3},
	{"ball of 40 mm", CAU_TOOL_SPHERE, 40e-3},     {"capsule of 1.5 mm", CAU_TOOL_CAPSULE, 1.5e-3},
	{"hook of 1.5 mm", CAU_TOOL_HOOK, 1.5e-3},     {"jaws of 1.5 mm", CAU_TOOL_GRASPER, 1.5e-3},
};
static const double speeds_m_s[] = {0.01, 0.1, 0.5, 1.5, 0.001};
static const double slow_m_s = 0.005; // the slow speed; slower presses take hundreds of ticks
static const double cells_m[] = {4e-3, 2e-3, 1e-3};
static const char *const tissues[] = {"sheet", "slab", "layers"};

enum {
	KINDS = sizeof kinds / sizeof *kinds,
	SPEEDS = sizeof speeds_m_s / sizeof *speeds_m_s,
	CELLS = sizeof cells_m / sizeof *cells_m,
	TISSUES = sizeof tissues / sizeof *tissues,
};

static const double most_penetration_m = 1e-4; // depth of a ball at rest in the drawn surface

// Returns the depth of a press. A thin tip that dents soft tissue farther than this finally passes.
static double depth_m(const kind *k)
{
	return fmin(4e-3, 5 * k->radius_m);
}

// Presses and holds. Returns whether nothing crossed while the tool had force left.
static bool is_held(const pressing *p, const kind *k)
{
	cau_scene_def *scene = pressing_scene(p);
	cau_session *session = stage_open(scene, 1);
	int ticks = (int)(60 * (p->depth_m + 1e-3) / p->speed_m_s) + 31, crossed = 0;
	double most = 0;
	for (int tick = 0; tick < 10; tick++) { // the jaws close meanwhile
		pressing_move(session, p, -1e-3);
		stage_step(session, 1);
	}
	for (int tick = 0; tick < ticks; tick++) {
		pressing_move(session, p, pressing_depth_m(p, tick));
		stage_step(session, 1);
		most = fmax(most, cau_length(cau_vec3_of(stage_tool(session, "tool")->raw_force_n)));
		crossed += pressing_is_crossed(session);
	}
	const cau_tool_state *tool = stage_tool(session, "tool");
	bool ball = p->shape == CAU_TOOL_SPHERE;
	double deep = ball ? pressing_penetration_m(session, p) : 0;
	bool whole = stage_frame(session).statistics.contacts_left_out == 0;
	bool pushed = most >= 0.99 * tool->definition.force_max_n;
	bool right = most > 0 && tool->slips == 0;
	bool stands = deep <= most_penetration_m;
	print_message("%-18s %-7s %g mm, %5.3f m/s: %s, %6.3f N, %.3f mm deep%s%s\n", k->what,
	              tissues[p->tissue], 1e3 * p->cell_m, p->speed_m_s, crossed ? "CROSSED" : "held",
	              most, 1e3 * deep, whole ? "" : ", points left out", stands ? "" : ": TOO DEEP");
	cau_session_destroy(session);
	free(scene);
	return (!crossed || pushed) && stands && right;
}

static void nothing_crosses(void **state)
{
	(void)state;
	// SHARE is odd, so that the presses take the four speeds in turn.
	enum { SHARE = CAU_TEST_SANITIZED ? 61 : 9, FIRST = 3 };
	const char *wanted = getenv("PROXY_MATRIX");
	bool all = wanted && !strcmp(wanted, "all");
	int share = wanted && atoi(wanted) > 0 ? atoi(wanted) : SHARE;
	int number = 0, failed = 0, tried = 0;
	for (int t = 0; t < TISSUES; t++)
		// `layers` has only its own mesh.
		for (int c = 0; c < (t == PRESSING_LAYERS ? 1 : CELLS); c++)
			for (int k = 0; k < KINDS; k++)
				for (int s = 0; s < SPEEDS; s++) {
					// True for the slab of 70,000 tetrahedra.
					bool heavy = t == PRESSING_SLAB && cells_m[c] < 2e-3;
					if ((heavy || speeds_m_s[s] < slow_m_s) && !all)
						continue;
					if (number++ % share != FIRST % share && !all)
						continue;
					pressing p = {.tissue = (pressing_tissue)t,
					              .shape = kinds[k].shape,
					              .radius_m = kinds[k].radius_m,
					              .cell_m = t == PRESSING_LAYERS ? 2e-3 : cells_m[c],
					              .speed_m_s = speeds_m_s[s],
					              .depth_m = depth_m(&kinds[k])};
					failed += !is_held(&p, &kinds[k]);
					tried++;
				}
	print_message("%d of %d presses, %d failed\n", tried, number, failed);
	assert_true(tried >= number / share && tried > 0);
	assert_int_equal(failed, 0);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(nothing_crosses),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
