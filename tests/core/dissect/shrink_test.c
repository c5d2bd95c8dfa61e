// SPDX-License-Identifier: GPL-3.0-or-later
// Shrinkage of tissue that a cut exposes, or that heat has denatured: against T' = T^(1/2) R^T
// diag(S) R T^(1/2). Also tests the ramp, and that a target is set only once.
#include <string.h>

#include "base/vector.h"
#include "core/dissect/cutting.h"

static const double RAMP_S = 0.2, STEP_S = 1.0 / 60;
// Largest error of a target: ten roundings, and two square roots of numbers between 0.01 and 1.
static const double TARGET_TOLERANCE = 1e-12;
static const double SHEET_SHRINK[2] = {0.1, 0.3}, FAT_SHRINK[3] = {0.1, 0.6, 0.9};
static const double SHEET_TARGET[3] = {0.4, 0.7, 0.1};
static const double FAT_TARGET[6] = {0.3, 0.8, 0.9, 0.05, -0.1, 0.02};

typedef struct burnt {
	rig r;
	cau_tool_def tool;
	cau_pose pose;
} burnt;

static void make(burnt *b, int fat, int targeted)
{
	rig_begin(&b->r);
	cau_layer_def *layer = fat ? rig_add_slab(&b->r, 4, 4, 2) : rig_add_sheet(&b->r, 5, 4);
	memcpy(layer->sheet[0].shrink, SHEET_SHRINK, sizeof SHEET_SHRINK);
	memcpy(layer->fat[0].shrink, FAT_SHRINK, sizeof FAT_SHRINK);
	layer->sheet[0].limit = targeted ? CAU_LIMIT_TARGET : CAU_LIMIT_NONE;
	layer->fat[0].limit = layer->sheet[0].limit;
	memcpy(layer->sheet[0].target, SHEET_TARGET, sizeof SHEET_TARGET);
	memcpy(layer->fat[0].target, FAT_TARGET, sizeof FAT_TARGET);
	rig_build(&b->r, NULL, 1);
	uint64_t random = 161;
	double a[3][3];
	rig_random_gradient(&random, 0.15, a);
	rig_deform(&b->r, a, 1e-3, &random, b->r.solver.position);
	b->tool = tool_with_defaults(CAU_TOOL_SPHERE);
	b->pose = pose_at(0.003, -0.002, fat ? -0.012 : 0.001);
}

// Parts the edge between the two vertices nearest to the tool, and starts the shrinkage of the
// exposed elements.
static void burn(burnt *b)
{
	const double *x = b->r.solver.position;
	cau_vec3 tip = cau_vec3_of(b->pose.position_m);
	int32_t nearest = -1;
	double least = INFINITY;
	for (int32_t e = 0; e < b->r.tissue.edges.edge_count; e++) {
		const int32_t *v = b->r.tissue.edges.vertex + 2 * e;
		double distance = cau_length(cau_sub(cau_vec3_of(x + 3 * v[0]), tip)) +
		                  cau_length(cau_sub(cau_vec3_of(x + 3 * v[1]), tip));
		if (distance < least) {
			least = distance;
			nearest = e;
		}
	}
	uint32_t layers = 0;
	cau_dissection_begin(&b->r.dissection);
	expose_by_hand(&b->r.dissection, nearest, 1e6);
	cau_dissection_part(&b->r.dissection, &layers);
	cau_shrink_expose(&b->r.shrink, &b->r.dissection, 0, x, &b->tool, &b->pose, 0,
	                  &b->r.solver.elements, &b->r.solver.slots);
}

// True if an element shares a face or an edge with a removed element, found by their vertices.
static int is_exposed(const burnt *b, int kind, int32_t element)
{
	int vertices = kind == CAU_ELEMENT_TRIANGLE ? 3 : 4;
	const int32_t *all = vertices == 3 ? b->r.tissue.triangle : b->r.tissue.tetrahedron;
	for (int32_t k = 0; k < b->r.dissection.removed_count; k++) {
		const cau_removed *gone = &b->r.dissection.removed[k];
		int shared = 0;
		for (int i = 0; i < vertices && gone->kind == kind; i++)
			for (int j = 0; j < vertices; j++)
				shared += all[vertices * element + i] == all[vertices * gone->element + j];
		if (shared == vertices - 1)
			return b->r.dissection.alive.element[kind][element];
	}
	return 0;
}

static void test_exposed_elements_and_no_others(void **state)
{
	(void)state;
	for (int fat = 0; fat < 2; fat++) {
		burnt b;
		make(&b, fat, 1);
		burn(&b);
		int kind = fat ? CAU_ELEMENT_TETRAHEDRON : CAU_ELEMENT_TRIANGLE;
		int32_t exposed = 0;
		for (int32_t e = 0; e < cau_tissue_element_count(&b.r.tissue, kind); e++) {
			assert_int_equal(b.r.shrink.shrunk[kind][e], is_exposed(&b, kind, e));
			exposed += is_exposed(&b, kind, e);
		}
		assert_true(exposed > 2);
		assert_int_equal(b.r.shrink.active_count, exposed);
		rig_finish(&b.r);
	}
}

// Computes F of an element by its map in the system.
static void gradient_of(const burnt *b, int kind, int32_t element, double f[3][3])
{
	cau_element_map map;
	cau_tissue_element_map(&b->r.tissue, kind, element, &map);
	memset(f, 0, 9 * sizeof(double));
	for (int c = 0; c < map.rank; c++)
		for (int i = 0; i < map.vertex_count; i++)
			for (int row = 0; row < 3; row++)
				f[row][c] += map.coefficient[c][i] * b->r.solver.position[3 * map.vertex[i] + row];
}

// Computes N_c: for a sphere, the direction from its centre to the element's centroid.
static void contact_normal(const burnt *b, int kind, int32_t element, double n[3])
{
	cau_element_map map;
	double length = 0;
	cau_tissue_element_map(&b->r.tissue, kind, element, &map);
	for (int c = 0; c < 3; c++) {
		n[c] = -b->pose.position_m[c];
		for (int i = 0; i < map.vertex_count; i++)
			n[c] += b->r.solver.position[3 * map.vertex[i] + c] / map.vertex_count;
		length += n[c] * n[c];
	}
	for (int c = 0; c < 3; c++)
		n[c] /= sqrt(length);
}

// Computes the first axis: the normalised F^T N_c.
static void first_axis(const burnt *b, int kind, int32_t element, double axis[3])
{
	double f[3][3], n[3], length = 0;
	gradient_of(b, kind, element, f);
	contact_normal(b, kind, element, n);
	for (int c = 0; c < 3; c++) {
		axis[c] = f[0][c] * n[0] + f[1][c] * n[1] + f[2][c] * n[2];
		length += axis[c] * axis[c];
	}
	for (int c = 0; c < 3; c++)
		axis[c] /= sqrt(length);
}

static void assert_triangle_target(const cau_shrinking *active, int targeted, const double axis[3])
{
	double root3[3] = {1, 1, 0}, root[3][3] = {{0}}, s[3][3] = {{0}}, got[3][3];
	if (targeted)
		cau_symmetric_power2(SHEET_TARGET, 0.5, 0, root3);
	root[0][0] = root3[0], root[1][1] = root3[1], root[0][1] = root[1][0] = root3[2];
	const double r[2][2] = {{axis[0], axis[1]}, {-axis[1], axis[0]}};
	for (int i = 0; i < 4; i++) // R^T diag(S) R
		s[i / 2][i % 2] = SHEET_SHRINK[0] * r[0][i / 2] * r[0][i % 2] +
		                  SHEET_SHRINK[1] * r[1][i / 2] * r[1][i % 2];
	mat_multiply(root, s, s);
	mat_multiply(s, root, s);
	double to[3][3] = {{active->to[0], active->to[2], 0}, {active->to[2], active->to[1], 0}};
	mat_multiply(to, to, got);
	assert_near(mat_distance(got, s), 0, TARGET_TOLERANCE);
}

// The second axis depends on the exposed face. The test checks values that do not: the trace and
// determinant of R^T diag(S) R, and its value along the first axis.
static void assert_tetrahedron_target(const cau_shrinking *active, int targeted,
                                      const double axis[3])
{
	double six[6] = {1, 1, 1, 0, 0, 0}, root[3][3], inverse[3][3], s[3][3], v[3][3], value[3];
	if (targeted)
		cau_symmetric_power3(FAT_TARGET, 0.5, 0, six);
	mat_of_symmetric(six, root);
	mat_inverse(root, inverse);
	mat_of_symmetric(active->to, s);
	mat_multiply(s, s, s); // T'
	mat_multiply(inverse, s, s);
	mat_multiply(s, inverse, s); // R^T diag(S) R
	double along[3];
	mat_apply(s, axis, along);
	for (int c = 0; c < 3; c++)
		assert_near(along[c], FAT_SHRINK[0] * axis[c], TARGET_TOLERANCE);
	const double packed[6] = {s[0][0], s[1][1], s[2][2], s[0][1], s[0][2], s[1][2]};
	cau_symmetric_eigen3(packed, value, v);
	double sum = value[0] + value[1] + value[2], product = value[0] * value[1] * value[2];
	assert_near(sum, FAT_SHRINK[0] + FAT_SHRINK[1] + FAT_SHRINK[2], TARGET_TOLERANCE);
	assert_near(product, FAT_SHRINK[0] * FAT_SHRINK[1] * FAT_SHRINK[2], TARGET_TOLERANCE);
}

static void assert_target(const cau_shrinking *active, int targeted, const double axis[3])
{
	if (active->kind == CAU_ELEMENT_TRIANGLE)
		assert_triangle_target(active, targeted, axis);
	else
		assert_tetrahedron_target(active, targeted, axis);
}

static void test_targets_by_hand(void **state)
{
	(void)state;
	for (int fat = 0; fat < 2; fat++)
		for (int targeted = 0; targeted < 2; targeted++) {
			burnt b;
			double axis[3];
			make(&b, fat, targeted);
			burn(&b);
			for (int32_t k = 0; k < b.r.shrink.active_count; k++) {
				first_axis(&b, b.r.shrink.active[k].kind, b.r.shrink.active[k].element, axis);
				assert_target(&b.r.shrink.active[k], targeted, axis);
			}
			rig_finish(&b.r);
		}
}

// ---- denatured tissue

// Heats the first `count` edges of the element to `share`. Then calls cau_shrink_denatured with a
// temperature that rises along `axis` at rest.
static void denature(burnt *b, int kind, int32_t element, int count, double share,
                     const double axis[3])
{
	int corners;
	const int32_t *v = cau_tissue_vertices_of(&b->r.tissue, kind, element, &corners);
	double temperature[4];
	for (int i = 0; i < corners; i++) {
		const double *x = b->r.tissue.rest + 3 * v[i];
		temperature[i] = 60 + 1e3 * (axis[0] * x[0] + axis[1] * x[1] + axis[2] * x[2]);
		for (int j = i + 1; j < corners && count-- > 0; j++)
			cau_dissection_show_heated(&b->r.dissection,
			                           cau_edge_table_find(&b->r.tissue.edges, v[i], v[j]), share);
	}
	cau_shrink_denatured(&b->r.shrink, &b->r.dissection, kind, element, temperature,
	                     &b->r.solver.elements, &b->r.solver.slots);
}

// If half of an element is denatured, the whole element shrinks, along the gradient of the
// temperature.
static void test_denatured_elements(void **state)
{
	(void)state;
	static const double AXIS[2][3] = {{0.6, -0.8, 0}, {0.36, 0.48, -0.8}};
	for (int fat = 0; fat < 2; fat++)
		for (int targeted = 0; targeted < 2; targeted++) {
			burnt b;
			make(&b, fat, targeted);
			int kind = fat ? CAU_ELEMENT_TETRAHEDRON : CAU_ELEMENT_TRIANGLE, edges = fat ? 6 : 3;
			// an edge heated by 0.5 is coagulated, so at 0.24 the element is less than half
			// coagulated
			denature(&b, kind, 7, edges, 0.24, AXIS[fat]);
			assert_int_equal(b.r.shrink.active_count, 0);
			denature(&b, kind, 7, edges, 0.26, AXIS[fat]);
			assert_int_equal(b.r.shrink.active_count, 1);
			assert_target(&b.r.shrink.active[0], targeted, AXIS[fat]);
			denature(&b, kind, 7, edges, 1, AXIS[fat]); // an element gets its target only once
			assert_int_equal(b.r.shrink.active_count, 1);
			rig_finish(&b.r);
		}
}

static void test_ramp(void **state)
{
	(void)state;
	burnt b;
	make(&b, 0, 1);
	burn(&b);
	cau_shrinking active = b.r.shrink.active[0];
	int ticks = 0;
	while (b.r.shrink.active_count) {
		double root[3];
		cau_shrink_advance(&b.r.shrink, &b.r.tissue, STEP_S, &b.r.solver.elements,
		                   &b.r.solver.slots);
		double s = fmin(++ticks * STEP_S / RAMP_S, 1);
		cau_elements_target(&b.r.solver.elements, &b.r.solver.slots, CAU_ELEMENT_TRIANGLE,
		                    active.element, root);
		for (int i = 0; i < 3; i++)
			assert_near(root[i], active.from[i] + s * (active.to[i] - active.from[i]),
			            TARGET_TOLERANCE);
		assert_true(ticks < 100);
	}
	assert_near(ticks * STEP_S, RAMP_S, STEP_S * 1.001); // the tolerance is one tick
	rig_finish(&b.r);
}

// A second cut beside the element, or new materials, leave its target unchanged.
static void test_set_once(void **state)
{
	(void)state;
	for (int fat = 0; fat < 2; fat++) {
		burnt b;
		make(&b, fat, 1);
		burn(&b);
		int kind = fat ? CAU_ELEMENT_TETRAHEDRON : CAU_ELEMENT_TRIANGLE;
		int32_t element = b.r.shrink.active[0].element, count = b.r.shrink.active_count;
		for (int tick = 0; tick < 20; tick++)
			cau_shrink_advance(&b.r.shrink, &b.r.tissue, STEP_S, &b.r.solver.elements,
			                   &b.r.solver.slots);
		double before[6], after[6];
		cau_elements_target(&b.r.solver.elements, &b.r.solver.slots, kind, element, before);
		b.pose.position_m[0] += 0.003;
		cau_shrink_expose(&b.r.shrink, &b.r.dissection, 0, b.r.solver.position, &b.tool, &b.pose, 0,
		                  &b.r.solver.elements, &b.r.solver.slots);
		assert_int_equal(b.r.shrink.active_count, 0);
		assert_true(count > 0);
		cau_elements_set_materials(&b.r.solver.elements, &b.r.solver.slots, &b.r.tissue,
		                           b.r.dissection.alive.element, b.r.shrink.shrunk);
		cau_elements_target(&b.r.solver.elements, &b.r.solver.slots, kind, element, after);
		assert_memory_equal(before, after, (fat ? 6 : 3) * sizeof(double));
		rig_finish(&b.r);
	}
}

// Elements beyond the capacity get their targets at once.
static void test_no_room(void **state)
{
	(void)state;
	for (int fat = 0; fat < 2; fat++) {
		burnt roomy, full;
		make(&roomy, fat, 1);
		make(&full, fat, 1);
		full.r.shrink.active_capacity = 1;
		burn(&roomy);
		burn(&full);
		int kind = fat ? CAU_ELEMENT_TETRAHEDRON : CAU_ELEMENT_TRIANGLE;
		assert_true(roomy.r.shrink.active_count > 2);
		assert_int_equal(full.r.shrink.active_count, 1);
		for (int32_t k = 0; k < roomy.r.shrink.active_count; k++) {
			const cau_shrinking *there = &roomy.r.shrink.active[k];
			double root[6];
			cau_elements_target(&full.r.solver.elements, &full.r.solver.slots, kind, there->element,
			                    root);
			const double *expected = k ? there->to : there->from;
			for (int i = 0; i < (fat ? 6 : 3); i++)
				assert_near(root[i], expected[i], TARGET_TOLERANCE);
			assert_true(full.r.shrink.shrunk[kind][there->element]);
		}
		rig_finish(&roomy.r);
		rig_finish(&full.r);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_exposed_elements_and_no_others),
		cmocka_unit_test(test_targets_by_hand),
		cmocka_unit_test(test_denatured_elements),
		cmocka_unit_test(test_ramp),
		cmocka_unit_test(test_set_once),
		cmocka_unit_test(test_no_room),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
