// SPDX-License-Identifier: GPL-3.0-or-later
// Tears (core/dissect/tears.c): the stretch at which an element is overloaded, how long it must be
// overloaded, which of several neighbours tears, and that the bookkeeping agrees with a recount.
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/dissect/cutting.h"
#include "dissect/dissection_internal.h"

static const double stiffness_pa = 1e6, tear_j_m2 = 200;
// share of the released energy that an element at the tip of a cut stores, as in tears.c
static const double band_share = 0.4;
// relative distance from the stretch at which an element tears, to either side
static const double near_share = 1e-6;

static double *stretched(const rig *r, double x, double y, double z)
{
	const double by[3] = {x, y, z};
	size_t n = 3 * (size_t)r->tissue.vertex_count;
	double *position = malloc(n * sizeof *position);
	assert_non_null(position);
	for (size_t i = 0; i < n; i++)
		position[i] = r->tissue.rest[i] * by[i % 3];
	return position;
}

// Runs two converged ticks at this stretch. Returns the number of elements torn in the second.
static int32_t torn_at(rig *r, double x, double y, double z)
{
	cau_dissection *d = &r->dissection;
	double *position = stretched(r, x, y, z);
	d->tears.over_count = 0;
	int32_t before = d->tears.elements_torn;
	cau_dissection_tear(d, position, true, r->solver.pool);
	assert_int_equal(d->tears.elements_torn, before);
	cau_dissection_tear(d, position, true, r->solver.pool);
	free(position);
	return d->tears.elements_torn - before;
}

static void build(rig *r, int parting)
{
	r->scene->parting = parting;
	rig_build(r, NULL, 1);
}

static void a_sheet_bears_what_its_parameters_say(void **state)
{
	(void)state;
	for (int ranged = 0; ranged < 2; ranged++) {
		rig r;
		rig_begin(&r);
		cau_sheet_material *sheet = rig_add_sheet(&r, 5, 4)->sheet; // cells of 20 mm
		sheet->limit_stiffness_pa = stiffness_pa;
		sheet->heat.tear_energy_j_m2 = tear_j_m2;
		// the sheet is taut at rest, which adds no load
		sheet->target[0] = sheet->target[1] = 0.1;
		sheet->limit = ranged ? CAU_LIMIT_RANGE : CAU_LIMIT_TARGET;
		sheet->strain_max[0] = 0.3; // stretch within the range adds no load
		build(&r, CAU_PARTING_ELEMENTS);
		double beyond = sqrt(2 * band_share * tear_j_m2 / 0.02 / stiffness_pa);
		double least = (ranged ? 1.3 : 1) + beyond;
		assert_int_equal(torn_at(&r, 1, 1, 1), 0);
		assert_int_equal(torn_at(&r, 0.2, 0.2, 1), 0); // compressed
		assert_int_equal(torn_at(&r, least * (1 - near_share), 0.5, 1), 0);
		assert_true(torn_at(&r, least * (1 + near_share), 0.5, 1) > 0);
		rig_finish(&r);
	}
}

// A sheet whose edges have an exposure of 0.5 or more tears at a quarter of its energy. Below 0.5
// the energy falls in proportion to the exposure.
static void coagulated_tissue_bears_less(void **state)
{
	(void)state;
	for (int quarters = 0; quarters <= 8; quarters++) { // exposures of 0 to 1, in quarters of 0.5
		rig r;
		rig_begin(&r);
		cau_layer_def *layer = rig_add_sheet(&r, 5, 4);
		layer->coagulated_tear = 0.25;
		layer->sheet->limit_stiffness_pa = stiffness_pa;
		layer->sheet->heat.tear_energy_j_m2 = tear_j_m2;
		build(&r, CAU_PARTING_ELEMENTS);
		for (int32_t e = 0; e < r.tissue.edges.edge_count; e++)
			cau_dissection_show_heated(&r.dissection, e, quarters / 8.0);
		double strength = 1 - 0.75 * fmin(quarters / 4.0, 1);
		double least = 1 + sqrt(2 * band_share * strength * tear_j_m2 / 0.02 / stiffness_pa);
		assert_int_equal(torn_at(&r, least * (1 - near_share), 0.5, 1), 0);
		assert_true(torn_at(&r, least * (1 + near_share), 0.5, 1) > 0);
		rig_finish(&r);
	}
}

static void fat_and_links_bear_what_their_parameters_say(void **state)
{
	(void)state;
	rig r;
	rig_begin(&r);
	cau_fat_material *fat = rig_add_slab(&r, 5, 4, 3)->fat; // cells of 20 x 20 x 10 mm
	fat->young_modulus_pa = stiffness_pa;
	fat->heat.tear_energy_j_m2 = tear_j_m2;
	build(&r, CAU_PARTING_ELEMENTS);
	double size = cbrt(0.02 * 0.02 * 0.01),
		   least = 1 + sqrt(2 * band_share * tear_j_m2 / size / stiffness_pa);
	assert_int_equal(torn_at(&r, 1, 1, least * (1 - near_share)), 0);
	assert_true(torn_at(&r, 1, 1, least * (1 + near_share)) > 0);
	rig_finish(&r);

	rig_begin(&r);
	rig_add_sheet(&r, 5, 4);
	rig_add_sheet(&r, 5, 4);
	r.scene->meshes[1].translate_m[2] = 0.004;
	// straight up: one link for each vertex
	cau_link_material *link = &rig_add_links(&r, 1, 0, 0.005)->link;
	link->young_modulus_pa = stiffness_pa;
	link->heat.tear_energy_j_m2 = tear_j_m2;
	build(&r, CAU_PARTING_ELEMENTS);
	least = 1 + sqrt(2 * tear_j_m2 / 0.004 / stiffness_pa);
	assert_int_equal(torn_at(&r, 1, 1, least * (1 - near_share)), 0);
	assert_true(torn_at(&r, 1, 1, least * (1 + near_share)) > 0);
	rig_finish(&r);
}

// Tissue does not tear if the scene has no tear energy.
static void what_has_no_energy_does_not_tear(void **state)
{
	(void)state;
	rig r;
	rig_begin(&r);
	add_all_layers(&r);
	build(&r, CAU_PARTING_EDGES);
	assert_int_equal(torn_at(&r, 20, 20, 20), 0);
	rig_finish(&r);
}

static void one_overshoot_tears_nothing(void **state)
{
	(void)state;
	rig r;
	rig_begin(&r);
	rig_add_sheet(&r, 5, 4)->sheet[0].heat.tear_energy_j_m2 = tear_j_m2;
	build(&r, CAU_PARTING_EDGES);
	cau_dissection *d = &r.dissection;
	double *far = stretched(&r, 3, 1, 1), *near = stretched(&r, 1, 1, 1);
	for (int k = 0; k < 4; k++) { // the element is overloaded in every other tick
		cau_dissection_tear(d, far, true, r.solver.pool);
		cau_dissection_tear(d, near, true, r.solver.pool);
	}
	assert_int_equal(d->tears.elements_torn, 0);
	for (int k = 0; k < 5; k++) // these are consecutive ticks that have not converged
		cau_dissection_tear(d, far, false, r.solver.pool);
	assert_int_equal(d->tears.elements_torn, 0);
	cau_dissection_tear(d, far, false, r.solver.pool);
	assert_true(d->tears.elements_torn > 0);
	free(far);
	free(near);
	rig_finish(&r);
}

// Of the overloaded elements, no two that tear in one tick share a vertex. If edges part, elements
// at the same edge tear together.
static void neighbours_wait(void **state)
{
	(void)state;
	for (int parting = 0; parting < CAU_PARTING_COUNT; parting++) {
		rig r;
		rig_begin(&r);
		rig_add_sheet(&r, 12, 10)->sheet[0].heat.tear_energy_j_m2 = tear_j_m2;
		build(&r, parting);
		int32_t torn = torn_at(&r, 3, 1.5, 1), count = r.tissue.triangle_count;
		assert_in_range(torn, 1, count / 4);
		uint8_t *at = calloc((size_t)r.tissue.vertex_count, 1);
		assert_non_null(at);
		for (int32_t t = 0; t < count; t++)
			for (int i = 0; i < 3; i++)
				if (!r.dissection.alive.element[CAU_ELEMENT_TRIANGLE][t])
					at[r.tissue.triangle[3 * t + i]]++;
		for (int32_t v = 0; v < r.tissue.vertex_count; v++)
			assert_true(at[v] <= (parting == CAU_PARTING_EDGES ? 2 : 1));
		free(at);
		rig_finish(&r);
	}
}

static void books_are_those_of_a_recount(void **state)
{
	(void)state;
	for (int parting = 0; parting < CAU_PARTING_COUNT; parting++) {
		rig r;
		rig_begin(&r);
		add_all_layers(&r);
		for (int32_t i = 0; i < r.scene->layer_count; i++) {
			cau_layer_def *layer = &r.scene->layers[i];
			layer->sheet[0].heat.tear_energy_j_m2 = layer->fat[0].heat.tear_energy_j_m2 =
				layer->link.heat.tear_energy_j_m2 = 1;
		}
		build(&r, parting);
		cau_dissection *d = &r.dissection;
		assert_true(torn_at(&r, 2, 2, 2) > 3);
		assert_true(torn_at(&r, 2, 2, 3) > 3);
		assert_int_equal(d->elements_removed, d->tears.elements_torn);
		int32_t lost = 0, all = 0;
		for (int p = 0; p < CAU_PRIMITIVE_KINDS; p++) {
			int32_t count = cau_tissue_element_count(&r.tissue, p);
			uint8_t *shares = malloc((size_t)count), *alive = malloc((size_t)count);
			assert_true(shares && alive);
			for (int32_t i = 0; i < count; i++)
				lost += !cau_dissection_lives(d, p, i);
			all += count;
			memcpy(shares, d->share_count[p], (size_t)count);
			memcpy(alive, d->alive.element[p], (size_t)count);
			cau_dissection_recount(d);
			assert_memory_equal(shares, d->share_count[p], (size_t)count);
			assert_memory_equal(alive, d->alive.element[p], (size_t)count);
			free(shares);
			free(alive);
		}
		assert_int_equal(lost, d->tears.elements_torn);
		assert_true(lost < all);
		rig_finish(&r);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_sheet_bears_what_its_parameters_say),
		cmocka_unit_test(coagulated_tissue_bears_less),
		cmocka_unit_test(fat_and_links_bear_what_their_parameters_say),
		cmocka_unit_test(what_has_no_energy_does_not_tear),
		cmocka_unit_test(one_overshoot_tears_nothing),
		cmocka_unit_test(neighbours_wait),
		cmocka_unit_test(books_are_those_of_a_recount),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
