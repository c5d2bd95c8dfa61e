// SPDX-License-Identifier: GPL-3.0-or-later
// Tests blood on a sheet. It flows down, keeps its volume, comes to rest level, and drips off where
// it is deep.
#include "core/session/stage.h"

#include "session/session_internal.h"

enum { ACROSS = 12 };
static const double down[3] = {0, 0, -9.81}, tick_s = 1.0 / 60;

typedef struct pool {
	cau_session *session;
	cau_arena arena;
	cau_blood blood;
	uint8_t *visible;
	double *position;
} pool;

// Makes a sheet of 24 mm with cells of 2 mm, tilted by `slope` along x.
static pool make_pool(double slope)
{
	cau_scene_def *scene = stage_scene(CAU_PRECISION_DOUBLE);
	stage_add_sheet(scene, "fascia", 0.024, 0.024, ACROSS, ACROSS);
	scene->pin_count = 1;
	cau_default_selection(&scene->pins[0], CAU_SELECT_RIM);
	pool out = {.session = stage_open(scene, 1)};
	free(scene);
	const cau_tissue *tissue = &out.session->tissue;
	size_t n = (size_t)tissue->vertex_count;
	assert_int_equal(cau_blood_create(&out.blood, tissue, &out.arena, NULL), CAU_OK);
	out.visible = malloc(n);
	out.position = malloc(3 * n * sizeof(double));
	memset(out.visible, 1, n);
	memcpy(out.position, tissue->rest, 3 * n * sizeof(double));
	for (size_t v = 0; v < n; v++)
		out.position[3 * v + 2] = -slope * out.position[3 * v];
	return out;
}

static void drop(pool *on)
{
	cau_arena_finish(&on->arena);
	free(on->visible);
	free(on->position);
	cau_session_destroy(on->session);
}

static void flow(pool *on, int ticks)
{
	for (int k = 0; k < ticks; k++)
		cau_blood_flow(&on->blood, &on->session->tissue.edges, on->visible, on->position, down,
		               tick_s);
}

static double volume(const pool *on, double *middle_x)
{
	double sum = 0, moment = 0;
	for (int32_t v = 0; v < on->blood.vertex_count; v++) {
		sum += on->blood.volume_m3[v];
		moment += on->blood.volume_m3[v] * on->position[3 * (size_t)v];
	}
	if (middle_x)
		*middle_x = moment / sum;
	return sum;
}

static void it_spreads_evenly_and_comes_to_rest(void **state)
{
	(void)state;
	pool level = make_pool(0);
	cau_blood_add(&level.blood, level.visible, level.position, (cau_vec3){0, 0, 0}, 2e-8);
	flow(&level, 20000);
	double middle, sum = volume(&level, &middle);
	assert_true(fabs(sum - 2e-8) < 1e-16 && fabs(middle) < 5e-4);
	assert_false(level.blood.flows);
	double deepest = 0;
	for (int32_t v = 0; v < level.blood.vertex_count; v++)
		deepest = fmax(deepest, cau_blood_depth(&level.blood, v));
	// A film of 0.05 mm clings. At rest the film is nowhere much deeper.
	assert_true(deepest < 3e-4);
	drop(&level);
}

static void it_runs_down(void **state)
{
	(void)state;
	pool tilted = make_pool(0.5);
	cau_blood_add(&tilted.blood, tilted.visible, tilted.position, (cau_vec3){-0.008, 0, 0}, 5e-9);
	double before, after;
	volume(&tilted, &before);
	flow(&tilted, 120);
	double sum = volume(&tilted, &after);
	assert_true(fabs(sum - 5e-9) < 1e-17);
	assert_true(after > before + 2e-3);
	drop(&tilted);
}

// Blood never leaves or enters a vertex that is not visible.
static void it_stays_on_what_is_drawn(void **state)
{
	(void)state;
	pool split = make_pool(0.5);
	for (int32_t v = 0; v < split.blood.vertex_count; v++)
		split.visible[v] = split.position[3 * (size_t)v] < 1e-3;
	cau_blood_add(&split.blood, split.visible, split.position, (cau_vec3){-0.008, 0, 0}, 5e-9);
	flow(&split, 600);
	for (int32_t v = 0; v < split.blood.vertex_count; v++)
		assert_true(split.visible[v] || split.blood.volume_m3[v] == 0);
	drop(&split);
}

static void it_drips_off_where_it_is_deep(void **state)
{
	(void)state;
	pool level = make_pool(0);
	cau_blood_add(&level.blood, level.visible, level.position, (cau_vec3){0, 0, 0}, 1e-5);
	flow(&level, 60);
	for (int32_t v = 0; v < level.blood.vertex_count; v++)
		assert_true(cau_blood_depth(&level.blood, v) <= 3.3e-3 * (1 + 1e-12));
	assert_true(volume(&level, NULL) < 1e-5);
	drop(&level);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(it_spreads_evenly_and_comes_to_rest),
		cmocka_unit_test(it_runs_down),
		cmocka_unit_test(it_stays_on_what_is_drawn),
		cmocka_unit_test(it_drips_off_where_it_is_deep),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
