// SPDX-License-Identifier: GPL-3.0-or-later
// Selection of vertices, and the pins of a scene.
#include <string.h>

#include "cautery/defaults.h"
#include "core/dissect/cutting.h"

typedef struct choice {
	rig r;
	uint8_t *chosen;
	cau_selection selection;
} choice;

static void make(choice *c, int kind, const char *layer)
{
	rig_begin(&c->r);
	add_all_layers(&c->r);
	rig_build(&c->r, NULL, 1);
	c->chosen = cau_arena_array(&c->r.arena, (size_t)c->r.tissue.vertex_count, 1);
	cau_default_selection(&c->selection, kind);
	strcpy(c->selection.layer, layer);
}

static int32_t count(const choice *c)
{
	int32_t n = 0;
	for (int32_t v = 0; v < c->r.tissue.vertex_count; v++)
		n += c->chosen[v];
	return n;
}

static void test_rim(void **state)
{
	(void)state;
	choice c;
	make(&c, CAU_SELECT_RIM, "layer2");
	assert_int_equal(cau_tissue_select(&c.r.tissue, &c.selection, c.chosen), 2 * (7 + 6));
	assert_int_equal(count(&c), 2 * (7 + 6));
	for (int32_t v = c.r.tissue.layer[2].first_vertex; v < c.r.tissue.vertex_count; v++) {
		const double *x = c.r.tissue.rest + 3 * v;
		int rim = fabs(fabs(x[0]) - 0.05) < 1e-9 || fabs(fabs(x[1]) - 0.04) < 1e-9;
		assert_int_equal(c.chosen[v], rim);
	}
	rig_finish(&c.r);
	make(&c, CAU_SELECT_RIM, "layer1"); // a closed membrane has no rim
	assert_int_equal(cau_tissue_select(&c.r.tissue, &c.selection, c.chosen), 0);
	rig_finish(&c.r);
}

static void test_box_and_sphere(void **state)
{
	(void)state;
	static const int kinds[] = {CAU_SELECT_BOX, CAU_SELECT_SPHERE};
	for (int k = 0; k < 2; k++)
		for (int named = 0; named < 2; named++) {
			choice c;
			make(&c, kinds[k], named ? "layer0" : "");
			memcpy(c.selection.least_m, (double[]){-0.02, -0.05, -0.011}, 3 * sizeof(double));
			memcpy(c.selection.most_m, (double[]){0.03, 0.001, 0.005}, 3 * sizeof(double));
			memcpy(c.selection.center_m, (double[]){0.01, 0, 0}, 3 * sizeof(double));
			c.selection.radius_m = 0.02;
			int32_t expected = 0;
			int32_t reported = cau_tissue_select(&c.r.tissue, &c.selection, c.chosen);
			for (int32_t v = 0; v < c.r.tissue.vertex_count; v++) {
				const double *x = c.r.tissue.rest + 3 * v;
				int in = !named || v < c.r.tissue.layer[0].vertex_count;
				for (int i = 0; i < 3 && !k; i++)
					in &= x[i] >= c.selection.least_m[i] && x[i] <= c.selection.most_m[i];
				if (k)
					in &= hypot(hypot(x[0] - 0.01, x[1]), x[2]) <= 0.02;
				assert_int_equal(c.chosen[v], in);
				expected += in;
			}
			assert_true(expected > 0);
			assert_int_equal(reported, expected);
			rig_finish(&c.r);
		}
}

static void test_nearest(void **state)
{
	(void)state;
	choice c;
	make(&c, CAU_SELECT_NEAREST, "layer2");
	memcpy(c.selection.center_m, (double[]){0.013, -0.02, -0.5}, 3 * sizeof(double));
	assert_int_equal(cau_tissue_select(&c.r.tissue, &c.selection, c.chosen), 1);
	assert_int_equal(count(&c), 1);
	double least = INFINITY, got = 0;
	for (int32_t v = c.r.tissue.layer[2].first_vertex; v < c.r.tissue.vertex_count; v++) {
		cau_vec3 away =
			cau_sub(cau_vec3_of(c.r.tissue.rest + 3 * v), cau_vec3_of(c.selection.center_m));
		least = fmin(least, cau_length(away));
		got = c.chosen[v] ? cau_length(away) : got;
	}
	assert_true(got == least);
	rig_finish(&c.r);
}

static void test_a_layer_that_is_not_there(void **state)
{
	(void)state;
	choice c;
	make(&c, CAU_SELECT_BOX, "skin");
	assert_int_equal(cau_tissue_select(&c.r.tissue, &c.selection, c.chosen), -1);
	rig_finish(&c.r);
}

static void test_pins_that_hold_nothing_are_refused_by_name(void **state)
{
	(void)state;
	rig r;
	cau_error error = {0};
	rig_begin(&r);
	rig_add_slab(&r, 2, 2, 1);
	rig_pin_box(&r, (double[]){-1, -1, -1}, (double[]){1, 1, -0.0299});
	rig_pin_box(&r, (double[]){5, 5, 5}, (double[]){6, 6, 6});
	assert_int_equal(cau_tissue_make(r.scene, &r.arena, &r.tissue, &error), CAU_BAD_VALUE);
	assert_string_equal(error.path, "pins[1]");
	rig_finish(&r);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_rim),
		cmocka_unit_test(test_box_and_sphere),
		cmocka_unit_test(test_nearest),
		cmocka_unit_test(test_a_layer_that_is_not_there),
		cmocka_unit_test(test_pins_that_hold_nothing_are_refused_by_name),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
