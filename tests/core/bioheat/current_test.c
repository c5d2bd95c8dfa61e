// SPDX-License-Identifier: GPL-3.0-or-later
// Tests current against closed forms, within 1 %: a bar, a sphere, a needle, a disc in a sheet.
// Also tests that the current that enters returns, and that its power becomes heat.
#include "bioheat/current.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "bar.h"
#include "base/vector.h"

static const double PI = 3.14159265358979323846, SIDE_M = 1e-4, SIGMA = 0.15;

static void solve(cau_current *current, cau_bioheat *bioheat, double reach_m, bool grounded)
{
	cau_current_solve(current, bioheat, reach_m, grounded, 1e-6, 2000);
	assert_true(current->residual <= 1e-6);
	assert_within(current->returned_s, current->conductance_s, 0.01);
}

// Current between the ends of a bar: unchanged, stretched to twice its length, and compressed to
// half.
static void a_bar_between_two_jaws(void **state)
{
	(void)state;
	enum { LENGTH = 30 };
	const double stretch[] = {1, 2, 0.5};
	for (int k = 0; k < 3; k++) {
		cau_arena arena = {0};
		cau_bioheat bar = bar_of(&plain_tissue, LENGTH, SIDE_M, 37, &arena);
		cau_current current;
		assert_int_equal(cau_current_create(&current, &bar, &arena, NULL), CAU_OK);
		double pull = 1 / (stretch[k] * stretch[k]);
		for (int i = 0; i < LENGTH; i++)
			bar.cells.pull[3 * i] = (float)pull;
		current.electrode[0] = (cau_electrode_cell){0, 2 * SIDE_M * pull, 1};
		current.electrode[1] = (cau_electrode_cell){LENGTH - 1, 2 * SIDE_M * pull, 0};
		current.electrode_count = 2;
		solve(&current, &bar, 1e-2, false);
		// Stretching multiplies the bar's length by the stretch, and divides the bar's cross
		// section by the stretch.
		double ohm = LENGTH * SIDE_M * stretch[k] / (SIGMA * SIDE_M * SIDE_M / stretch[k]);
		assert_within(1 / current.conductance_s, ohm, 1e-4);
		cau_current_heat(&current, &bar, 30);
		double sum = 0;
		for (int i = 0; i < LENGTH; i++)
			sum += bar.power_w[i];
		assert_within(sum, 900 / ohm, 1e-4);
		cau_arena_finish(&arena);
	}
}

typedef double distance_function(cau_vec3 point, const double *size_m);

static double from_sphere(cau_vec3 point, const double *size_m)
{
	return cau_length(point) - size_m[0];
}

// Returns the distance from a spheroid around z with half axes size_m[0] and size_m[1], to first
// order. The distance is exact at the surface.
static double from_spheroid(cau_vec3 p, const double *size_m)
{
	cau_vec3 scaled = {p.x / size_m[0], p.y / size_m[0], p.z / size_m[1]};
	cau_vec3 slope = {scaled.x / size_m[0], scaled.y / size_m[0], scaled.z / size_m[1]};
	double length = cau_length(scaled);
	return length > 0 ? (length - 1) * length / cau_length(slope) : -size_m[0];
}

static double from_disc(cau_vec3 point, const double *size_m)
{
	return hypot(point.x, point.y) - size_m[0];
}

typedef struct electrode_stage {
	cau_bioheat bioheat;
	cau_current current;
} electrode_stage;

static cau_vec3 middle_of(int32_t x, int32_t y, int32_t z)
{
	return (cau_vec3){(x + 0.5) * SIDE_M, (y + 0.5) * SIDE_M, (z + 0.5) * SIDE_M};
}

// Adds tissue outside the electrode, within `reach` cells of the origin, in `layers` layers of
// cells.
static void fill(electrode_stage *stage, distance_function *distance, const double *size_m,
                 int reach, int lowest, int layers)
{
	for (int z = lowest; z < lowest + layers; z++)
		for (int y = -reach; y < reach; y++)
			for (int x = -reach; x < reach; x++) {
				cau_vec3 at = middle_of(x, y, z);
				if (cau_length(at) < (reach - 1) * SIDE_M && distance(at, size_m) > 0)
					assert_true(cau_bioheat_add(&stage->bioheat, (int32_t[]){x, y, z}, 0, 1) >= 0);
			}
}

// Connects the cells next to the electrode. The length of a connection is from the cell's middle to
// the electrode's surface, along the line to a neighbour inside the electrode.
static void touch(electrode_stage *stage, distance_function *distance, const double *size_m)
{
	const cau_cells *cells = &stage->bioheat.cells;
	for (int32_t i = 0; i < cells->count; i++) {
		const int32_t *place = cells->place + 3 * i;
		double own = distance(middle_of(place[0], place[1], place[2]), size_m), over = 0;
		for (int side = 0; side < CAU_CELL_SIDES; side++) {
			int32_t to[] = {place[0], place[1], place[2]};
			to[side / 2] += side % 2 ? 1 : -1;
			double others = distance(middle_of(to[0], to[1], to[2]), size_m);
			if (others <= 0)
				over += SIDE_M * (own - others) / own;
		}
		if (over > 0)
			stage->current.electrode[stage->current.electrode_count++] =
				(cau_electrode_cell){i, over, 1};
	}
}

static electrode_stage make_stage(cau_bioheat_material *material, int32_t capacity,
                                  cau_arena *arena)
{
	electrode_stage made;
	assert_int_equal(
		cau_bioheat_create(&made.bioheat, SIDE_M, capacity, material, 1, 37, arena, NULL), CAU_OK);
	assert_int_equal(cau_current_create(&made.current, &made.bioheat, arena, NULL), CAU_OK);
	return made;
}

static void assert_heat_is_what_the_current_does(electrode_stage *stage)
{
	double sum = 0;
	cau_current_heat(&stage->current, &stage->bioheat, 1);
	for (int32_t i = 0; i < stage->bioheat.cells.count; i++)
		sum += stage->bioheat.power_w[i];
	assert_within(sum + stage->current.far_w, stage->current.conductance_s, 0.01);
}

static void a_sphere_in_tissue_without_end(void **state)
{
	(void)state;
	cau_bioheat_material material = plain_tissue;
	cau_arena arena = {0};
	electrode_stage stage = make_stage(&material, 48 * 48 * 48, &arena);
	const double size_m[] = {8 * SIDE_M};
	fill(&stage, from_sphere, size_m, 24, -24, 48);
	touch(&stage, from_sphere, size_m);
	solve(&stage.current, &stage.bioheat, 12 * SIDE_M, true);
	assert_within(1 / stage.current.conductance_s, 1 / (4 * PI * SIGMA * size_m[0]), 0.01);
	assert_heat_is_what_the_current_does(&stage);
	cau_arena_finish(&arena);
}

static void a_needle_in_tissue_without_end(void **state)
{
	(void)state;
	cau_bioheat_material material = plain_tissue;
	cau_arena arena = {0};
	electrode_stage stage = make_stage(&material, 64 * 64 * 64, &arena);
	const double size_m[] = {4 * SIDE_M, 12 * SIDE_M};
	fill(&stage, from_spheroid, size_m, 32, -32, 64);
	touch(&stage, from_spheroid, size_m);
	solve(&stage.current, &stage.bioheat, 18 * SIDE_M, true);
	double e = sqrt(1 - 1.0 / 9);
	assert_within(1 / stage.current.conductance_s, atanh(e) / (4 * PI * SIGMA * size_m[1] * e),
	              0.01);
	assert_heat_is_what_the_current_does(&stage);
	cau_arena_finish(&arena);
}

// The closed form of a disc in a sheet, with the return electrode 30 mm away.
static void a_disc_in_a_sheet(void **state)
{
	(void)state;
	cau_bioheat_material material = plain_tissue;
	material.sheet = true;
	cau_arena arena = {0};
	electrode_stage stage = make_stage(&material, 80 * 80, &arena);
	const double size_m[] = {10 * SIDE_M};
	fill(&stage, from_disc, size_m, 40, 0, 1);
	touch(&stage, from_disc, size_m);
	solve(&stage.current, &stage.bioheat, 27 * SIDE_M, true);
	assert_within(1 / stage.current.conductance_s,
	              log(0.03 / size_m[0]) / (2 * PI * SIGMA * SIDE_M), 0.01);
	cau_arena_finish(&arena);
}

// The potential of the last solve is the start of the next one.
static void a_second_solve_has_nothing_to_do(void **state)
{
	(void)state;
	cau_arena arena = {0};
	cau_bioheat bar = bar_of(&plain_tissue, 30, SIDE_M, 37, &arena);
	cau_current current;
	assert_int_equal(cau_current_create(&current, &bar, &arena, NULL), CAU_OK);
	current.electrode[current.electrode_count++] = (cau_electrode_cell){0, SIDE_M, 1};
	current.electrode[current.electrode_count++] = (cau_electrode_cell){29, SIDE_M, 0};
	solve(&current, &bar, 1e-2, false);
	assert_true(current.iterations > 10);
	solve(&current, &bar, 1e-2, false);
	assert_int_equal(current.iterations, 0);
	cau_bioheat_take_out(&bar, 15); // removes a cell, so that a gap interrupts the current
	cau_current_solve(&current, &bar, 1e-2, false, 1e-9, 2000);
	assert_near(current.conductance_s, 0, 1e-9 * SIGMA * SIDE_M);
	cau_arena_finish(&arena);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_bar_between_two_jaws),
		cmocka_unit_test(a_sphere_in_tissue_without_end),
		cmocka_unit_test(a_needle_in_tissue_without_end),
		cmocka_unit_test(a_disc_in_a_sheet),
		cmocka_unit_test(a_second_solve_has_nothing_to_do),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
