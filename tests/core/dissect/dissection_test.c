// SPDX-License-Identifier: GPL-3.0-or-later
// Edge counts, removed elements and drawn faces, against a recount from the parted edges alone.
#include <stdlib.h>
#include <string.h>

#include "core/dissect/cutting.h"

static void make(rig *r)
{
	rig_begin(r);
	add_all_layers(r);
	rig_build(r, NULL, 1);
	assert_true(r->tissue.link_count > 50 && r->tissue.hinge_count > 50);
}

// True if the edge between vertices a and b has parted in the layer.
static int parted(const cau_dissection *d, int32_t a, int32_t b, int32_t layer)
{
	return d->parted[cau_edge_table_find(&d->tissue->edges, a, b)] >> layer & 1;
}

// Counts an element's edges that have not parted in its layer, from its vertices.
static int count_shares(const cau_dissection *d, const int32_t *vertex, int vertices, int32_t layer)
{
	int count = 0;
	for (int i = 0; i < vertices; i++)
		for (int j = i + 1; j < vertices; j++)
			count += !parted(d, vertex[i], vertex[j], layer);
	return count;
}

static void assert_counts(const rig *r)
{
	const cau_tissue *t = &r->tissue;
	const cau_dissection *d = &r->dissection;
	int32_t *live = calloc((size_t)t->vertex_count, sizeof *live);
	for (int kind = 0; kind < CAU_PRIMITIVE_KINDS; kind++) {
		int vertices = kind == CAU_PRIMITIVE_TRIANGLE      ? 3
		               : kind == CAU_PRIMITIVE_TETRAHEDRON ? 4
		                                                   : 2;
		const int32_t *all[] = {t->triangle, t->tetrahedron, t->link};
		const int32_t *layer[] = {t->triangle_layer, t->tetrahedron_layer, t->link_layer};
		for (int32_t e = 0; e < cau_tissue_element_count(t, kind); e++) {
			const int32_t *vertex = all[kind] + vertices * e;
			int shares = count_shares(d, vertex, vertices, layer[kind][e]);
			int alive = shares == vertices * (vertices - 1) / 2;
			assert_int_equal(d->share_count[kind][e], shares);
			assert_int_equal(d->alive.element[kind][e], alive);
			for (int i = 0; i < vertices; i++)
				live[vertex[i]] += alive;
		}
	}
	assert_memory_equal(d->live_elements, live, (size_t)t->vertex_count * sizeof *live);
	free(live);
	const uint8_t *triangle = d->alive.element[CAU_ELEMENT_TRIANGLE];
	for (int32_t h = 0; h < t->hinge_count; h++)
		assert_int_equal(d->alive.element[CAU_ELEMENT_HINGE][h],
		                 triangle[t->hinge_triangle[2 * h]] &&
		                     triangle[t->hinge_triangle[2 * h + 1]]);
}

static int has_vertices(const int32_t *element, int count, const int32_t *face)
{
	int found = 0;
	for (int i = 0; i < count; i++)
		found += element[i] == face[0] || element[i] == face[1] || element[i] == face[2];
	return found == 3;
}

// A sheet's face is drawn while its triangle lives. A face of fat is drawn while exactly one live
// tetrahedron has its three vertices, and no live triangle has them.
static int is_drawn(const rig *r, int32_t face)
{
	const cau_tissue *t = &r->tissue;
	const uint8_t *const *alive = (const uint8_t *const *)r->dissection.alive.element;
	if (face < t->triangle_count)
		return alive[CAU_ELEMENT_TRIANGLE][face];
	const int32_t *vertex = t->faces.vertex + 3 * face;
	int owners = 0;
	for (int32_t e = 0; e < t->tetrahedron_count; e++)
		owners +=
			alive[CAU_ELEMENT_TETRAHEDRON][e] && has_vertices(t->tetrahedron + 4 * e, 4, vertex);
	for (int32_t e = 0; e < t->triangle_count; e++)
		if (alive[CAU_ELEMENT_TRIANGLE][e] && has_vertices(t->triangle + 3 * e, 3, vertex))
			return 0;
	return owners == 1;
}

static void assert_faces(const rig *r)
{
	for (int32_t f = 0; f < r->tissue.faces.face_count; f++)
		assert_int_equal(!(r->dissection.face_mask[f >> 5] >> (f & 31) & 1), is_drawn(r, f));
}

static void test_counts_after_random_cuts(void **state)
{
	(void)state;
	rig r;
	make(&r);
	uint64_t random = 141;
	assert_counts(&r);
	assert_faces(&r);
	int32_t removed = 0;
	for (int tick = 0; tick < 25; tick++) {
		int32_t before = r.dissection.edges_parted;
		cut_random_edges(&r, &random, 1 + tick);
		assert_true(r.dissection.edges_parted > before);
		assert_counts(&r);
		if (tick % 6 == 0)
			assert_faces(&r);
		for (int32_t k = 0; k < r.dissection.removed_count; k++) {
			const cau_removed *gone = &r.dissection.removed[k];
			assert_false(r.dissection.alive.element[gone->kind][gone->element]);
			removed += gone->kind != CAU_ELEMENT_HINGE;
		}
	}
	assert_faces(&r);
	int32_t dead = 0;
	for (int kind = 0; kind < CAU_PRIMITIVE_KINDS; kind++)
		for (int32_t e = 0; e < cau_tissue_element_count(&r.tissue, kind); e++)
			dead += !r.dissection.alive.element[kind][e];
	assert_int_equal(removed, dead); // each removed element was reported once
	assert_int_equal(r.dissection.elements_removed, dead);
	assert_true(dead > 200);
	rig_finish(&r);
}

// A recount, as after a restore, computes the same state from the parted edges alone.
static void test_recount_gives_the_same(void **state)
{
	(void)state;
	rig a, b;
	make(&a);
	make(&b);
	uint64_t random = 142;
	for (int tick = 0; tick < 10; tick++)
		cut_random_edges(&a, &random, 12);
	memcpy(b.dissection.parted, a.dissection.parted,
	       (size_t)a.tissue.edges.edge_count * sizeof *a.dissection.parted);
	cau_dissection_recount(&b.dissection);
	for (int kind = 0; kind < CAU_ELEMENT_KINDS; kind++)
		assert_memory_equal(a.dissection.alive.element[kind], b.dissection.alive.element[kind],
		                    (size_t)cau_tissue_element_count(&a.tissue, kind));
	assert_memory_equal(a.dissection.face_mask, b.dissection.face_mask,
	                    (size_t)(a.tissue.faces.face_count + 31) / 32 * sizeof(uint32_t));
	assert_memory_equal(a.dissection.face_owners, b.dissection.face_owners,
	                    (size_t)a.tissue.faces.face_count);
	assert_counts(&b);
	rig_finish(&a);
	rig_finish(&b);
}

// An edge parts in a layer when xi times its exposure exceeds that layer's ignition temperature.
// Membrane and fat share edges and part one after the other.
static void test_each_layer_has_its_own_ignition(void **state)
{
	(void)state;
	rig r;
	make(&r);
	enum { FAT, MEMBRANE, FASCIA };
	const cau_heat_material *fat = cau_layer_heat(&r.tissue.layer[FAT], 0);
	const cau_heat_material *membrane = cau_layer_heat(&r.tissue.layer[MEMBRANE], 0);
	double fat_at = fat->ignition_c / fat->absorption_per_s;
	double membrane_at = membrane->ignition_c / membrane->absorption_per_s;
	assert_true(fat_at < membrane_at);
	const int32_t *v = r.tissue.triangle + 3 * r.tissue.layer[MEMBRANE].first_triangle;
	int32_t edge = cau_edge_table_find(&r.tissue.edges, v[0], v[1]);
	const double exposure[] = {0.99 * fat_at, 1.01 * fat_at, 0.99 * membrane_at,
	                           1.01 * membrane_at};
	const uint16_t expected[] = {0, 1 << FAT, 1 << FAT, 1 << FAT | 1 << MEMBRANE};
	for (int k = 0; k < 4; k++) {
		uint32_t layers = 0;
		cau_dissection_begin(&r.dissection);
		expose_by_hand(&r.dissection, edge, exposure[k]);
		cau_dissection_part(&r.dissection, &layers);
		assert_int_equal(r.dissection.parted[edge], expected[k]);
		assert_int_equal(layers, k ? expected[k] & ~expected[k - 1] : 0);
		assert_counts(&r);
		// the layer that ignites first determines the value
		double charred = fmin(1, exposure[k] / fat_at);
		assert_near(cau_dissection_heated(&r.dissection, edge), charred, 1e-12);
	}
	rig_finish(&r);
}

// If the material has bundles, the middle of an edge at rest determines when the edge parts.
static void test_bundles_part_by_place(void **state)
{
	(void)state;
	rig r;
	make(&r);
	enum { FASCIA = 2 };
	cau_tissue_layer *fascia = &r.tissue.layer[FASCIA];
	cau_heat_material *heat = &fascia->def.sheet[0].heat;
	heat->ignition_spread_c = 30;
	heat->ignition_bundle_m = 0.01;
	const cau_vec3 fibre = {1, 0, 0}; // the layer's default
	for (int32_t k = 0; k < 3 * fascia->triangle_count; k += 7) {
		const int32_t *v = r.tissue.triangle + 3 * (fascia->first_triangle + k / 3);
		int32_t a = v[k % 3], b = v[(k + 1) % 3];
		int32_t edge = cau_edge_table_find(&r.tissue.edges, a, b);
		if (r.dissection.parted[edge])
			continue;
		cau_vec3 middle = cau_scale(0.5, cau_add(cau_vec3_of(r.tissue.rest + 3 * (size_t)a),
		                                         cau_vec3_of(r.tissue.rest + 3 * (size_t)b)));
		double at = cau_ignition_in_bundles(heat->ignition_c, 30, r.dissection.seed, FASCIA, middle,
		                                    fibre, 0.01) /
		            heat->absorption_per_s;
		for (int above = 0; above < 2; above++) {
			uint32_t layers = 0;
			cau_dissection_begin(&r.dissection);
			expose_by_hand(&r.dissection, edge, (above ? 1.01 : 0.99) * at);
			cau_dissection_part(&r.dissection, &layers);
			assert_int_equal(r.dissection.parted[edge], above ? 1 << FASCIA : 0);
		}
	}
	rig_finish(&r);
}

// After the membrane parts, the fat's surface is drawn. After a tetrahedron parts, the face under
// it is drawn.
static void test_what_lies_under_shows(void **state)
{
	(void)state;
	rig r;
	make(&r);
	int32_t triangle = r.tissue.layer[1].first_triangle;
	int32_t under = r.tissue.faces.triangle_covers[triangle];
	assert_true(under >= r.tissue.triangle_count);
	assert_true(is_drawn(&r, triangle) && !is_drawn(&r, under));
	r.dissection.parted[r.tissue.edges.triangle_edge[3 * triangle]] |= 1 << 1;
	cau_dissection_recount(&r.dissection);
	assert_true(!is_drawn(&r, triangle) && is_drawn(&r, under));
	assert_faces(&r);
	rig_finish(&r);
}

// Exposure by a hot sphere that contains a few edges: the integral of the mean temperature over the
// time. Only edges inside the tool and with a live element are exposed.
static void test_exposure_by_a_tool(void **state)
{
	(void)state;
	rig r;
	make(&r);
	cau_tool_def tool = tool_with_defaults(CAU_TOOL_SPHERE);
	tool.hot_radius_m = 0.012; // a sphere of this radius contains both ends of some edges
	tool.grid_step_m = 0.003;
	cau_pose pose = pose_at(0.011, 0.007, 0.004);
	cau_heat_grid grid;
	cau_near near = {0};
	const double duration = 0.05;
	assert_int_equal(cau_heat_grid_create(&grid, &tool, 37, duration, &pose, NULL), CAU_OK);
	for (int k = 0; k < 40; k++)
		cau_heat_grid_advance(&grid, &tool, &pose, 1, 1, duration);
	assert_int_equal(cau_near_create(&near, &r.tissue, &r.arena, NULL), CAU_OK);
	cau_near_refit(&near, r.tissue.rest);
	cau_dissection_begin(&r.dissection);
	double taken = cau_dissection_expose(&r.dissection, &near, r.tissue.rest, &grid, &tool, &pose,
	                                     1, duration);
	int32_t exposed = 0;
	for (int32_t e = 0; e < r.tissue.edges.edge_count; e++) {
		const int32_t *v = r.tissue.edges.vertex + 2 * e;
		double gain =
			cau_exposure_gain(&grid, &tool, &pose, 1, cau_vec3_of(r.tissue.rest + 3 * v[0]),
		                      cau_vec3_of(r.tissue.rest + 3 * v[1]), 1, duration);
		assert_true(r.dissection.exposure[e] == gain);
		exposed += gain > 0;
	}
	assert_true(exposed > 0 && exposed == r.dissection.touched_count);
	assert_true(taken > 0);
	// no edge is exposed once all elements are removed
	double before = r.dissection.exposure[r.dissection.touched[0]];
	int32_t first = r.dissection.touched[0];
	for (int32_t e = 0; e < r.tissue.edges.edge_count; e++)
		r.dissection.parted[e] = 0xffff;
	cau_dissection_recount(&r.dissection);
	cau_dissection_begin(&r.dissection);
	taken = cau_dissection_expose(&r.dissection, &near, r.tissue.rest, &grid, &tool, &pose, 1,
	                              duration);
	assert_true(taken == 0 && r.dissection.touched_count == 0);
	assert_true(r.dissection.exposure[first] == before);
	cau_heat_grid_finish(&grid);
	rig_finish(&r);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_counts_after_random_cuts),
		cmocka_unit_test(test_recount_gives_the_same),
		cmocka_unit_test(test_each_layer_has_its_own_ignition),
		cmocka_unit_test(test_bundles_part_by_place),
		cmocka_unit_test(test_what_lies_under_shows),
		cmocka_unit_test(test_exposure_by_a_tool),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
