// SPDX-License-Identifier: GPL-3.0-or-later
// Rest shape: masses, volumes, D_m^-1 and the maps from which the system is built.
#include <string.h>

#include "core/dissect/cutting.h"

// Largest relative error of a mass: rounding of sums of thousands of terms.
static const double MASS_TOLERANCE = 1e-12;
// Largest error of an inverse: rounding of a 3x3 inverse of a well-shaped element.
static const double INVERSE_TOLERANCE = 1e-12;

static void make(rig *r)
{
	rig_begin(r);
	add_all_layers(r);
	rig_build(r, NULL, 1);
}

static void test_masses_are_density_times_volume(void **state)
{
	(void)state;
	rig r;
	make(&r);
	double mass = 0, volume = 0, area[2] = {0, 0}, expected;
	for (int32_t v = 0; v < r.tissue.vertex_count; v++)
		mass += r.tissue.mass[v];
	for (int32_t t = 0; t < r.tissue.tetrahedron_count; t++)
		volume += r.tissue.tetrahedron_volume[t];
	for (int32_t t = 0; t < r.tissue.triangle_count; t++)
		area[r.tissue.triangle_layer[t] == 2] += r.tissue.triangle_area[t];
	const double size[3] = {0.1, 0.08, 0.03};
	assert_near(volume, size[0] * size[1] * size[2], MASS_TOLERANCE * volume);
	double skin = 2 * (size[0] * size[1] + size[1] * size[2] + size[2] * size[0]);
	assert_near(area[0], skin, MASS_TOLERANCE * skin);
	assert_near(area[1], size[0] * size[1], MASS_TOLERANCE * skin);
	const cau_fat_material *fat = &r.tissue.layer[0].def.fat[0];
	const cau_sheet_material *sheet = &r.tissue.layer[1].def.sheet[0];
	expected = fat->density_kg_m3 * volume +
	           sheet->density_kg_m3 * sheet->thickness_m * (area[0] + area[1]);
	assert_near(mass, expected, MASS_TOLERANCE * expected);
	rig_finish(&r);
}

// G of an element's own rest shape is I (fat), the orthonormal frame (sheets) or the edge (links).
static void test_maps_reproduce_the_rest_shape(void **state)
{
	(void)state;
	rig r;
	make(&r);
	for (int kind = 0; kind < CAU_ELEMENT_KINDS; kind++)
		for (int32_t e = 0; e < cau_tissue_element_count(&r.tissue, kind); e++) {
			cau_element_map map;
			double f[3][3] = {{0}};
			cau_tissue_element_map(&r.tissue, kind, e, &map);
			for (int c = 0; c < map.rank; c++) {
				double sum = 0, size = 0;
				for (int i = 0; i < map.vertex_count; i++) {
					sum += map.coefficient[c][i];
					size += fabs(map.coefficient[c][i]);
					for (int row = 0; row < 3; row++)
						f[row][c] += map.coefficient[c][i] * r.tissue.rest[3 * map.vertex[i] + row];
				}
				assert_near(sum, 0, INVERSE_TOLERANCE * size);
			}
			for (int c = 0; c < map.rank; c++)
				for (int row = 0; row < 3; row++) {
					double expected = row == c; // the identity, for fat
					if (kind == CAU_ELEMENT_TRIANGLE)
						expected = r.tissue.triangle_frame[6 * e + 3 * c + row];
					else if (kind == CAU_ELEMENT_LINK)
						expected = r.tissue.rest[3 * map.vertex[1] + row] -
						           r.tissue.rest[3 * map.vertex[0] + row];
					else if (kind == CAU_ELEMENT_HINGE)
						expected = 0; // the sheet is flat
					assert_near(f[row][c], expected, INVERSE_TOLERANCE);
				}
			assert_true(map.weight > 0);
		}
	rig_finish(&r);
}

// Weights are k x area x thickness (sheets), (2 mu + 3 lambda + limit) x volume (fat), E A / L
// (links).
static void test_weights(void **state)
{
	(void)state;
	rig r;
	rig_begin(&r);
	add_all_layers(&r);
	// Shrinkage may set a limit, so the limit's stiffness counts.
	r.scene->layers[0].fat[0].shrink[1] = 0.5;
	rig_build(&r, NULL, 1);
	const cau_fat_material *fat = &r.tissue.layer[0].def.fat[0];
	const cau_sheet_material *sheet = &r.tissue.layer[2].def.sheet[0];
	const cau_link_material *link = &r.tissue.layer[3].def.link;
	double e = fat->young_modulus_pa, nu = fat->poisson_ratio, lambda, mu;
	cau_fat_lame(fat, &lambda, &mu);
	// E computed from lambda and mu.
	assert_near(mu * (3 * lambda + 2 * mu) / (lambda + mu), e, 1e-12 * e);
	assert_near(lambda / (2 * (lambda + mu)), nu, 1e-14);
	cau_element_map map;
	cau_tissue_element_map(&r.tissue, CAU_ELEMENT_TETRAHEDRON, 7, &map);
	double expected =
		(2 * mu + 3 * lambda + fat->limit_stiffness_pa) * r.tissue.tetrahedron_volume[7];
	assert_near(map.weight, expected, 1e-14 * expected);
	int32_t triangle = r.tissue.layer[2].first_triangle + 3;
	cau_tissue_element_map(&r.tissue, CAU_ELEMENT_TRIANGLE, triangle, &map);
	expected = sheet->limit_stiffness_pa * sheet->thickness_m * r.tissue.triangle_area[triangle];
	assert_near(map.weight, expected, 1e-14 * expected);
	cau_tissue_element_map(&r.tissue, CAU_ELEMENT_LINK, 5, &map);
	expected = link->young_modulus_pa * link->area_m2 / r.tissue.link_length[5];
	assert_near(map.weight, expected, 1e-14 * expected);
	rig_finish(&r);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_masses_are_density_times_volume),
		cmocka_unit_test(test_maps_reproduce_the_rest_shape),
		cmocka_unit_test(test_weights),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
