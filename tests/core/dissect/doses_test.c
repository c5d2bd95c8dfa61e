// SPDX-License-Identifier: GPL-3.0-or-later
// Elements that part one by one (core/dissect/doses.c). The volume that a cut removes does not
// depend on the mesh. A thin instrument still divides a sheet. The bookkeeping agrees with a
// recount.
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/dissect/cutting.h"
#include "dissect/dissection_internal.h"

enum { OFFSETS = 8 };
static const double step_s = 1.0 / 60, ambient_c = 37;

typedef struct drag { // straight motion of a hot ball through tissue at rest
	double radius_m, temperature_c, speed_m_s;
	double from[3], to[3];
} drag;

// Resets all exposure and restores all elements.
static void heal(rig *r)
{
	cau_dissection *d = &r->dissection;
	size_t edges = (size_t)r->tissue.edges.edge_count, doses = (size_t)cau_dissection_dose_count(d);
	cau_dissection_begin(d);
	memset(d->exposure, 0, edges * sizeof *d->exposure);
	memset(d->parted, 0, edges * sizeof *d->parted);
	if (doses) {
		memset(d->doses.dose, 0, doses * sizeof *d->doses.dose);
		memset(d->doses.gone, 0, doses);
	}
	cau_dissection_recount(d);
}

static void run(rig *r, const drag *way)
{
	cau_error error = {0};
	cau_arena arena = {0};
	cau_near near;
	cau_heat_grid grid;
	cau_tool_def ball = tool_with_defaults(CAU_TOOL_SPHERE);
	ball.hot_radius_m = way->radius_m;
	ball.grid_step_m = way->radius_m / 3;
	ball.temperature_c = way->temperature_c;
	cau_pose before = pose_at(way->from[0], way->from[1], way->from[2]), now = before;
	assert_int_equal(cau_near_create(&near, &r->tissue, &arena, &error), CAU_OK);
	cau_near_refit(&near, r->tissue.rest);
	assert_int_equal(cau_heat_grid_create(&grid, &ball, ambient_c, step_s, &before, &error),
	                 CAU_OK);
	double length = 0;
	for (int c = 0; c < 3; c++)
		length += (way->to[c] - way->from[c]) * (way->to[c] - way->from[c]);
	int ticks = (int)ceil(sqrt(length) / way->speed_m_s / step_s);
	for (int tick = 0; tick <= ticks; tick++, before = now) {
		for (int c = 0; c < 3; c++)
			now.position_m[c] = way->from[c] + (way->to[c] - way->from[c]) * tick / ticks;
		cau_heat_grid_advance(&grid, &ball, &now, 0, true, step_s);
		uint32_t layers = 0;
		cau_dissection_begin(&r->dissection);
		cau_dissection_expose(&r->dissection, &near, r->tissue.rest, &grid, &ball, &now, 0, step_s);
		cau_dissection_part(&r->dissection, &layers);
	}
	cau_heat_grid_finish(&grid);
	cau_arena_finish(&arena);
}

static double volume_taken_m3(const rig *r)
{
	double taken = 0;
	for (int32_t t = 0; t < r->tissue.tetrahedron_count; t++)
		if (!r->dissection.alive.element[CAU_ELEMENT_TETRAHEDRON][t])
			taken += r->tissue.tetrahedron_volume[t];
	return taken;
}

// ---- volume of a cut

static const double resolutions[] = {0.5, 1, 1.5, 2};
// Meshes that are tested: with sanitizers only the two coarse ones. The fine ones would take a
// minute, and run the same code.
enum { RESOLUTIONS = CAU_TEST_SANITIZED ? 2 : sizeof resolutions / sizeof *resolutions };

// Returns the mean volume of a cut of 60 mm, by a ball of 6 mm along the top of a slab, over paths
// with different offsets in the cells. At resolution 1 the cells are 4 mm.
static double mean_volume_m3(double resolution, int parting, double spread_c)
{
	rig r;
	rig_begin(&r);
	r.scene->parting = parting;
	cau_layer_def *fat =
		rig_add_slab(&r, (int32_t)(25 * resolution + 0.5), (int32_t)(20 * resolution + 0.5),
	                 (int32_t)(8 * resolution + 0.5));
	cau_heat_material *heat = &fat->fat[0].heat;
	heat->ignition_c = 78;
	heat->ignition_spread_c = spread_c;
	heat->ignition_bundle_m = spread_c > 0 ? 0.004 : 0;
	heat->absorption_per_s = 0.6;
	rig_build(&r, NULL, 1);
	double sum = 0;
	// offsets by the golden ratio over a cell, so that all paths differ
	for (int i = 0; i < OFFSETS; i++) {
		double share = fmod(0.618034 * i, 1), cell = 0.004 / resolution;
		drag way = {.radius_m = 0.006, .temperature_c = 90, .speed_m_s = 0.004};
		memcpy(way.from, (double[]){-0.03 + cell * i / OFFSETS, cell * share, 0}, sizeof way.from);
		memcpy(way.to, (double[]){0.03 + cell * i / OFFSETS, cell * share, 0}, sizeof way.to);
		heal(&r);
		run(&r, &way);
		sum += volume_taken_m3(&r);
	}
	rig_finish(&r);
	return sum / OFFSETS;
}

static void what_a_cut_takes_is_not_the_meshs(void **state)
{
	(void)state;
	for (int spread = 0; spread <= 1; spread++) {
		double volume[RESOLUTIONS];
		for (int i = 0; i < RESOLUTIONS; i++) {
			volume[i] = mean_volume_m3(resolutions[i], CAU_PARTING_ELEMENTS, spread * 20.0);
			print_message("%.1f times the cells, spread %d degC: %.0f mm^3\n", resolutions[i],
			              spread * 20, volume[i] * 1e9);
		}
		assert_true(volume[1] > 1e-7);
		for (int i = 0; i < RESOLUTIONS; i++)
			assert_near(volume[i] / volume[1], 1, resolutions[i] < 1 ? 0.3 : 0.15);
	}
}

// With the paper's rule, by edges, the volume depends on the mesh. This shows that the test above
// can fail.
static void by_edges_it_is(void **state)
{
	(void)state;
	double coarse = mean_volume_m3(0.5, CAU_PARTING_EDGES, 0);
	double fine = mean_volume_m3(1, CAU_PARTING_EDGES, 0);
	print_message("by edges: %.0f and %.0f mm^3\n", coarse * 1e9, fine * 1e9);
	assert_true(coarse > 1.2 * fine);
}

// ---- a thin instrument

// Marks the vertices that are connected with vertex `first` by live triangles. Returns their
// number.
static int32_t reached_from(const rig *r, int32_t first, uint8_t *reached)
{
	int32_t count = 1;
	bool grows = true;
	memset(reached, 0, (size_t)r->tissue.vertex_count);
	reached[first] = 1;
	while (grows) {
		grows = false;
		for (int32_t t = 0; t < r->tissue.triangle_count; t++) {
			const int32_t *v = r->tissue.triangle + 3 * t;
			if (!r->dissection.alive.element[CAU_ELEMENT_TRIANGLE][t] ||
			    !(reached[v[0]] | reached[v[1]] | reached[v[2]]))
				continue;
			for (int i = 0; i < 3; i++)
				if (!reached[v[i]]) {
					reached[v[i]] = 1;
					count++;
					grows = true;
				}
		}
	}
	return count;
}

static int32_t corner_at(const rig *r, double sign)
{
	for (int32_t v = 0; v < r->tissue.vertex_count; v++)
		if (fabs(r->tissue.rest[3 * v] - sign * 0.05) < 1e-9 &&
		    fabs(r->tissue.rest[3 * v + 1] + 0.04) < 1e-9)
			return v;
	fail_msg("the sheet has no such corner");
	return -1;
}

// A tip of 1 mm cuts through cells of 5 mm, along any path across. The halves are separated, and
// the removed strip is one or two cells wide.
static void a_thin_tip_divides_a_sheet(void **state)
{
	(void)state;
	rig r;
	uint64_t random = 5;
	rig_begin(&r);
	r.scene->parting = CAU_PARTING_ELEMENTS;
	rig_add_sheet(&r, 20, 16)->sheet[0].heat.absorption_per_s = 40; // the tissue parts at once
	rig_build(&r, NULL, 1);
	uint8_t *reached = malloc((size_t)r.tissue.vertex_count);
	assert_non_null(reached);
	for (int i = 0; i < 20; i++) {
		drag way = {.radius_m = 0.0005, .temperature_c = 1200, .speed_m_s = 0.01};
		memcpy(way.from, (double[]){random_between(&random, -0.03, 0.03), -0.05, 0},
		       sizeof way.from);
		memcpy(way.to, (double[]){random_between(&random, -0.03, 0.03), 0.05, 0}, sizeof way.to);
		heal(&r);
		run(&r, &way);
		reached_from(&r, corner_at(&r, -1), reached);
		if (reached[corner_at(&r, 1)])
			fail_msg("the way from x = %g to %g m leaves the sheet whole", way.from[0], way.to[0]);
		int32_t gone = r.dissection.elements_removed;
		r.dissection.elements_removed = 0;
		assert_in_range(gone, 16, 5 * 16);
	}
	free(reached);
	rig_finish(&r);
}

// ---- bookkeeping

static void books_are_those_of_a_recount(void **state)
{
	(void)state;
	rig r;
	rig_begin(&r);
	r.scene->parting = CAU_PARTING_ELEMENTS;
	add_all_layers(&r);
	rig_build(&r, NULL, 1);
	cau_dissection *d = &r.dissection;
	drag way = {.radius_m = 0.008, .temperature_c = 400, .speed_m_s = 0.01};
	memcpy(way.from, (double[]){-0.05, 0, 0}, sizeof way.from);
	memcpy(way.to, (double[]){0.05, 0.01, 0.002}, sizeof way.to);
	run(&r, &way);
	// of each kind, some elements are removed and some live
	for (int p = 0; p < CAU_PRIMITIVE_KINDS; p++) {
		int32_t lost = 0, count = cau_tissue_element_count(&r.tissue, p);
		uint8_t *shares = malloc((size_t)count), *alive = malloc((size_t)count);
		assert_true(shares && alive);
		for (int32_t i = 0; i < count; i++)
			lost += !cau_dissection_lives(d, p, i);
		assert_in_range(lost, 1, count - 1);
		memcpy(shares, d->share_count[p], (size_t)count);
		memcpy(alive, d->alive.element[p], (size_t)count);
		cau_dissection_recount(d);
		assert_memory_equal(shares, d->share_count[p], (size_t)count);
		assert_memory_equal(alive, d->alive.element[p], (size_t)count);
		free(shares);
		free(alive);
	}
	rig_finish(&r);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(what_a_cut_takes_is_not_the_meshs),
		cmocka_unit_test(by_edges_it_is),
		cmocka_unit_test(a_thin_tip_divides_a_sheet),
		cmocka_unit_test(books_are_those_of_a_recount),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
