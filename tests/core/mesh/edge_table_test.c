// SPDX-License-Identifier: GPL-3.0-or-later
#include "mesh_fixture.h"

// Counts how often edge e names primitive p of a kind.
static int times_listed(const cau_edge_table *table, int kind, int32_t e, int32_t p)
{
	int times = 0;
	for (int32_t i = table->first[kind][e]; i < table->first[kind][e + 1]; i++)
		times += table->sharer[kind][i] == p;
	return times;
}

// Checks that every primitive is listed once at each of its edges, that these edges have its
// vertices, and that the lists hold nothing else.
static void recount(const cau_edge_table *table, int kind, int32_t count, int corners,
                    const int32_t *corner, int slots, const int (*end)[2])
{
	assert_int_equal(table->first[kind][0], 0);
	assert_int_equal(table->first[kind][table->edge_count], count * slots);
	for (int32_t p = 0; p < count; p++)
		for (int s = 0; s < slots; s++) {
			int32_t a = corner[p * corners + end[s][0]], b = corner[p * corners + end[s][1]];
			int32_t e = cau_edge_table_find(table, a, b);
			assert_true(e >= 0);
			if (kind == CAU_PRIMITIVE_TRIANGLE)
				assert_int_equal(table->triangle_edge[p * slots + s], e);
			assert_int_equal(times_listed(table, kind, e, p), 1);
			assert_int_equal(table->vertex[2 * e], a < b ? a : b);
			assert_int_equal(table->vertex[2 * e + 1], a < b ? b : a);
			assert_int_equal(cau_edge_table_find(table, b, a), e);
		}
	for (int32_t e = 0; e < table->edge_count; e++)
		for (int32_t i = table->first[kind][e] + 1; i < table->first[kind][e + 1]; i++)
			assert_true(table->sharer[kind][i - 1] < table->sharer[kind][i]);
}

static void check_table(const cau_primitives *p, const cau_edge_table *table)
{
	static const int triangle_end[3][2] = {{0, 1}, {1, 2}, {2, 0}};
	static const int tetrahedron_end[6][2] = {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}};
	for (int32_t e = 0; e < table->edge_count; e++) {
		const int32_t *v = table->vertex + 2 * e;
		assert_true(v[0] < v[1]);
		assert_true(e == 0 || v[-2] < v[0] || (v[-2] == v[0] && v[-1] < v[1]));
	}
	recount(table, CAU_PRIMITIVE_TRIANGLE, p->triangle_count, 3, p->triangle, 3, triangle_end);
	recount(table, CAU_PRIMITIVE_TETRAHEDRON, p->tetrahedron_count, 4, p->tetrahedron, 6,
	        tetrahedron_end);
	recount(table, CAU_PRIMITIVE_LINK, p->link_count, 2, p->link, 1, triangle_end);
}

static void sheet_keeps_eulers_characteristic(void **state)
{
	(void)state;
	cau_mesh_def def = fixture_def(60, 50, 1);
	cau_mesh mesh;
	assert_int_equal(cau_mesh_make_sheet(&def, &mesh, NULL), CAU_OK);
	cau_primitives primitives = fixture_primitives(&mesh);
	int32_t *layer = calloc((size_t)mesh.triangle_count, sizeof *layer);
	cau_edge_table table;
	assert_int_equal(cau_edge_table_make(&primitives, layer, &table, NULL), CAU_OK);
	check_table(&primitives, &table);
	// Euler's characteristic of a disc is 1.
	assert_int_equal(mesh.vertex_count - table.edge_count + mesh.triangle_count, 1);
	// All edges except those of the rim have a hinge.
	assert_int_equal(table.hinge_count, table.edge_count - 2 * (60 + 50));
	cau_edge_table_finish(&table);
	cau_mesh_finish(&mesh);
	free(layer);
}

static void slab_keeps_eulers_characteristic(void **state)
{
	(void)state;
	cau_mesh_def def = fixture_def(50, 25, 4);
	cau_mesh mesh;
	assert_int_equal(cau_mesh_make_slab(&def, &mesh, NULL), CAU_OK);
	cau_primitives primitives = fixture_primitives(&mesh);
	cau_edge_table table;
	cau_face_table faces;
	assert_int_equal(cau_edge_table_make(&primitives, NULL, &table, NULL), CAU_OK);
	assert_int_equal(cau_face_table_make(&primitives, &faces, NULL), CAU_OK);
	check_table(&primitives, &table);
	// Euler's characteristic of a ball is 1.
	assert_int_equal(
		mesh.vertex_count - table.edge_count + faces.face_count - mesh.tetrahedron_count, 1);
	assert_int_equal(table.hinge_count, 0);
	cau_face_table_finish(&faces);
	cau_edge_table_finish(&table);
	cau_mesh_finish(&mesh);
}

// A tetrahedron, two triangles on its faces 012 and 013, and links on its edges and elsewhere.
static void kinds_share_edges(void **state)
{
	(void)state;
	const int32_t triangle[] = {2, 1, 0, 0, 1, 3}, tetrahedron[] = {0, 1, 2, 3};
	const int32_t link[] = {4, 0, 1, 0, 0, 4}, layer[] = {0, 0};
	cau_primitives primitives = {5, 2, triangle, 1, tetrahedron, 3, link};
	cau_edge_table table;
	assert_int_equal(cau_edge_table_make(&primitives, layer, &table, NULL), CAU_OK);
	check_table(&primitives, &table);
	assert_int_equal(table.edge_count, 7);
	int32_t edge = cau_edge_table_find(&table, 1, 0);
	assert_int_equal(edge, 0);
	assert_int_equal(table.first[CAU_PRIMITIVE_TRIANGLE][1], 2);
	assert_int_equal(table.first[CAU_PRIMITIVE_TETRAHEDRON][1], 1);
	assert_int_equal(table.first[CAU_PRIMITIVE_LINK][1], 1);
	const int32_t *of_links = table.first[CAU_PRIMITIVE_LINK] + cau_edge_table_find(&table, 0, 4);
	assert_int_equal(of_links[1] - of_links[0], 2); // two links on one edge
	assert_int_equal(cau_edge_table_find(&table, 4, 3), -1);
	assert_int_equal(cau_edge_table_find(&table, 4, 4), -1);
	assert_int_equal(table.hinge_count, 1);
	assert_int_equal(table.hinge_edge[0], edge);
	assert_int_equal(table.hinge_triangle[0], 0);
	assert_int_equal(table.hinge_triangle[1], 1);
	cau_edge_table_finish(&table);
}

// Five triangles at the edge 01. A hinge exists where exactly two of them have the same layer.
static void hinges_need_exactly_two_of_a_layer(void **state)
{
	(void)state;
	const int32_t triangle[] = {0, 1, 2, 0, 1, 3, 0, 1, 4, 0, 1, 5, 0, 1, 6};
	cau_primitives primitives = {.vertex_count = 7, .triangle_count = 5, .triangle = triangle};
	const struct {
		int32_t layer[5];
		int32_t hinge_count;
		int32_t hinge[4];
	} cases[] = {
		{{0, 0, 0, 0, 0}, 0, {0}},
		{{0, 1, 2, 3, 4}, 0, {0}},
		{{7, 1, 1, 1, 7}, 1, {0, 4}},
		{{9, 2, 9, 5, 2}, 2, {1, 4, 0, 2}},
	};
	for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
		cau_edge_table table;
		assert_int_equal(cau_edge_table_make(&primitives, cases[i].layer, &table, NULL), CAU_OK);
		assert_int_equal(table.hinge_count, cases[i].hinge_count);
		for (int32_t h = 0; h < table.hinge_count; h++) {
			assert_int_equal(table.hinge_edge[h], 0);
			assert_int_equal(table.hinge_triangle[2 * h], cases[i].hinge[2 * h]);
			assert_int_equal(table.hinge_triangle[2 * h + 1], cases[i].hinge[2 * h + 1]);
		}
		cau_edge_table_finish(&table);
	}
}

static void nothing_makes_an_empty_table(void **state)
{
	(void)state;
	cau_primitives primitives = {0};
	cau_edge_table table;
	assert_int_equal(cau_edge_table_make(&primitives, NULL, &table, NULL), CAU_OK);
	assert_int_equal(table.edge_count, 0);
	assert_int_equal(table.hinge_count, 0);
	assert_int_equal(cau_edge_table_find(&table, 0, 1), -1);
	cau_edge_table_finish(&table);
}

static void bad_primitives_are_named(void **state)
{
	(void)state;
	const int32_t good[] = {0, 1, 2, 3}, outside[] = {0, 1, 2, 4}, twice[] = {0, 1, 2, 1};
	const int32_t negative[] = {0, -1}, layer[] = {0};
	const struct {
		cau_primitives primitives;
		cau_status status;
		const char *reason;
	} cases[] = {
		{{4, 0, NULL, 1, outside, 0, NULL}, CAU_BAD_MESH, "tetrahedron 0 names vertex 4"},
		{{4, 0, NULL, 1, twice, 0, NULL}, CAU_BAD_MESH, "tetrahedron 0 has vertex 1 twice"},
		{{4, 1, twice + 1, 0, NULL, 0, NULL}, CAU_BAD_MESH, "triangle 0 has vertex 1 twice"},
		{{4, 0, NULL, 0, NULL, 1, negative}, CAU_BAD_MESH, "link 0 names vertex -1"},
		{{4, 0, NULL, INT32_MAX / 6, good, 100, good}, CAU_LIMIT, "counts are at least 0"},
		{{4, -1, NULL, 0, NULL, 0, NULL}, CAU_LIMIT, "counts are at least 0"},
	};
	for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
		cau_edge_table table;
		cau_error error = {0};
		assert_int_equal(cau_edge_table_make(&cases[i].primitives, layer, &table, &error),
		                 cases[i].status);
		assert_non_null(strstr(error.reason, cases[i].reason));
		assert_null(table.vertex);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(sheet_keeps_eulers_characteristic),
		cmocka_unit_test(slab_keeps_eulers_characteristic),
		cmocka_unit_test(kinds_share_edges),
		cmocka_unit_test(hinges_need_exactly_two_of_a_layer),
		cmocka_unit_test(nothing_makes_an_empty_table),
		cmocka_unit_test(bad_primitives_are_named),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
