// SPDX-License-Identifier: GPL-3.0-or-later
// Tests that solids are valid. Faces meet, no tetrahedron is inverted, and volumes and borders are
// as expected. The same bytes give the same solid.
#include "cautery/solid.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "mesh/edge_table.h"
#include "mesh/geometry.h"
#include "mesh/mesh.h"

enum { SIDE = 40, LABELS = 3 };
// Radius of the ball, in voxels of one millimetre; its centre is the middle.
static const double radius = 16;

// ---- a ball of voxels in sectors, one label each
static int label_of(const double x[3], int labels)
{
	double r = sqrt(x[0] * x[0] + x[1] * x[1] + x[2] * x[2]);
	if (r > radius)
		return 0;
	if (labels == 1 || x[0] > 2.3)
		return 1;
	return labels == 2 || x[1] > 3.1 ? 2 : 3;
}

static unsigned char *ball_of_voxels(int labels, size_t *byte_count)
{
	char head[512];
	int length = snprintf(head, sizeof head,
	                      "NRRD0004\ntype: uint8\ndimension: 3\nspace: RAS\nsizes: %d %d %d\n"
	                      "space directions: (1,0,0) (0,1,0) (0,0,1)\nspace origin: (0,0,0)\n"
	                      "encoding: raw\n\n",
	                      SIDE, SIDE, SIDE);
	*byte_count = (size_t)length + SIDE * SIDE * SIDE;
	unsigned char *bytes = malloc(*byte_count);
	assert_non_null(bytes);
	memcpy(bytes, head, (size_t)length);
	for (int i = 0; i < SIDE * SIDE * SIDE; i++) {
		const double x[3] = {i % SIDE - SIDE / 2.0, i / SIDE % SIDE - SIDE / 2.0,
		                     i / (SIDE * SIDE) - SIDE / 2.0};
		bytes[length + i] = (unsigned char)label_of(x, labels);
	}
	return bytes;
}

// ---- a box as STL; every `turned`-th facet faces inward, all of them if `turned` < 0
static void put_facet(FILE *out, double corner[8][3], const int *at, bool inward)
{
	fputs("facet normal 0 0 0\nouter loop\n", out);
	for (int k = 0; k < 3; k++) {
		const double *x = corner[at[inward ? 2 - k : k]];
		fprintf(out, "vertex %g %g %g\n", x[0], x[1], x[2]);
	}
	fputs("endloop\nendfacet\n", out);
}

static void put_box(FILE *out, double size, int turned)
{
	static const int facets[12][3] = {{0, 2, 1}, {0, 3, 2}, {4, 5, 6}, {4, 6, 7},
	                                  {0, 1, 5}, {0, 5, 4}, {1, 2, 6}, {1, 6, 5},
	                                  {2, 3, 7}, {2, 7, 6}, {3, 0, 4}, {3, 4, 7}};
	double corner[8][3];
	for (int k = 0; k < 8; k++) {
		corner[k][0] = size * ((k & 3) == 1 || (k & 3) == 2 ? 0.5 : -0.5);
		corner[k][1] = size * ((k & 3) >= 2 ? 0.5 : -0.5);
		corner[k][2] = size * (k >= 4 ? 0.5 : -0.5);
	}
	for (int k = 0; k < 12; k++)
		put_facet(out, corner, facets[k], turned < 0 || (turned && k % turned == 0));
}

// ---- measurements of a solid
typedef struct measured {
	// Volume of each region; area of the faces that have one tetrahedron.
	double volume[LABELS + 1], border;
	// `odd_edges`: edges of the border that an odd number of its faces share.
	int32_t tetrahedra, odd_edges;
} measured;

static void measure_border(const cau_mesh *mesh, const cau_face_table *faces, measured *of)
{
	int32_t *face = calloc(3 * (size_t)faces->face_count, sizeof *face), count = 0;
	int32_t *layer = calloc((size_t)faces->face_count, sizeof *layer);
	assert_true(face && layer);
	for (int32_t f = 0; f < faces->face_count; f++) {
		double normal[3];
		if (faces->owner[2 * (size_t)f + 1] >= 0)
			continue;
		memcpy(face + 3 * (size_t)count++, faces->vertex + 3 * (size_t)f, 3 * sizeof *face);
		cau_triangle_normal(mesh->position, faces->vertex + 3 * (size_t)f, normal);
		of->border += sqrt(cau_dot3(normal, normal)) / 2;
	}
	cau_primitives border = {
		.vertex_count = mesh->vertex_count, .triangle_count = count, .triangle = face};
	cau_edge_table edges;
	assert_int_equal(cau_edge_table_make(&border, layer, &edges, NULL), CAU_OK);
	const int32_t *first = edges.first[CAU_PRIMITIVE_TRIANGLE];
	for (int32_t e = 0; e < edges.edge_count; e++)
		of->odd_edges += (first[e + 1] - first[e]) % 2;
	cau_edge_table_finish(&edges);
	free(face);
	free(layer);
}

static measured measure(const cau_solid *solid)
{
	measured of = {0};
	cau_mesh mesh;
	cau_mesh_report report = {0};
	cau_error error = {0};
	if (cau_mesh_read("solid", solid->bytes, solid->byte_count, &mesh, &report, &error) ||
	    cau_mesh_clean(&mesh, &report, &error))
		fail_msg("%s", error.reason);
#define X(field, strict, words) assert_int_equal(report.field, 0);
	CAU_MESH_MEND_TABLE(X)
#undef X
	of.tetrahedra = mesh.tetrahedron_count;
	for (int32_t i = 0; i < mesh.tetrahedron_count; i++) {
		assert_in_range(mesh.tetrahedron_region[i], 1, LABELS);
		of.volume[mesh.tetrahedron_region[i]] +=
			cau_tetrahedron_volume6(mesh.position, mesh.tetrahedron + 4 * (size_t)i) / 6;
	}
	cau_primitives solids = {.vertex_count = mesh.vertex_count,
	                         .tetrahedron_count = mesh.tetrahedron_count,
	                         .tetrahedron = mesh.tetrahedron};
	cau_face_table faces;
	assert_int_equal(cau_face_table_make(&solids, &faces, NULL), CAU_OK);
	measure_border(&mesh, &faces, &of);
	cau_face_table_finish(&faces);
	cau_mesh_finish(&mesh);
	return of;
}

static cau_solid make(const void *bytes, size_t byte_count, double edge)
{
	cau_solid solid;
	cau_error error = {0};
	cau_solid_wish wish = {.file = "test", .bytes = bytes, .byte_count = byte_count, .edge = edge};
	if (cau_solid_make(&wish, &solid, &error))
		fail_msg("%s: %s", error.path, error.reason);
	return solid;
}

static double least_angle(const cau_solid *solid)
{
	const char *at = strstr(solid->text, "least angle between faces ");
	assert_non_null(at);
	return strtod(at + strlen("least angle between faces "), NULL);
}

// ---- tests

// The volumes of the sectors are those of their voxels. The border has the area of a ball.
static void labels_meet(void **state)
{
	(void)state;
	static const double edges[] = {2.5, 3.7, 6};
	for (int labels = 1; labels <= LABELS; labels++)
		for (size_t k = 0; k < sizeof edges / sizeof *edges; k++) {
			size_t byte_count;
			double voxels[LABELS + 1] = {0}, all = 0, sum = 0;
			unsigned char *bytes = ball_of_voxels(labels, &byte_count);
			cau_solid solid = make(bytes, byte_count, edges[k]);
			measured of = measure(&solid);
			for (size_t i = byte_count - SIDE * SIDE * SIDE; i < byte_count; i++)
				voxels[bytes[i]]++;
			for (int label = 1; label <= labels; label++) {
				if (fabs(of.volume[label] - voxels[label]) > 0.1 * voxels[label])
					fail_msg("edge %g: label %d of %d has %g mm^3, of %g", edges[k], label, labels,
					         of.volume[label], voxels[label]);
				sum += of.volume[label];
				all += voxels[label];
			}
			// A chord of length e sags by e^2 / 8r. The missing share of the volume is three times
			// the missing share of r.
			assert_true(fabs(sum - all) < (0.02 + 0.375 * pow(edges[k] / 0.911 / radius, 2)) * all);
			assert_int_equal(of.odd_edges, 0);
			double area = 4 * M_PI * radius * radius;
			assert_true(of.border > 0.92 * area && of.border < 1.05 * area);
			assert_true(least_angle(&solid) > (labels == 1 ? 15 : 5));
			cau_solid_finish(&solid);
			free(bytes);
		}
}

static void the_same_bytes_give_the_same_solid(void **state)
{
	(void)state;
	size_t byte_count;
	unsigned char *bytes = ball_of_voxels(LABELS, &byte_count);
	cau_solid a = make(bytes, byte_count, 4), b = make(bytes, byte_count, 4);
	assert_int_equal(a.byte_count, b.byte_count);
	assert_memory_equal(a.bytes, b.bytes, a.byte_count);
	assert_string_equal(a.text, b.text);
	cau_solid_finish(&a);
	cau_solid_finish(&b);
	free(bytes);
}

// Boxes of 20 mm: unchanged, partly turned, wholly turned, and with a cavity of 10 mm.
static void surfaces_are_filled(void **state)
{
	(void)state;
	static const struct {
		int turned;
		double cavity, volume;
	} boxes[] = {{0, 0, 8000}, {5, 0, 8000}, {-1, 0, 8000}, {0, 10, 7000}};
	for (size_t k = 0; k < sizeof boxes / sizeof *boxes; k++) {
		char *text = NULL;
		size_t byte_count;
		FILE *out = open_memstream(&text, &byte_count);
		assert_non_null(out);
		fputs("solid box\n", out);
		put_box(out, 20, boxes[k].turned);
		if (boxes[k].cavity > 0)
			put_box(out, boxes[k].cavity, -1);
		fputs("endsolid\n", out);
		fclose(out);
		cau_solid solid = make(text, byte_count, 1.5);
		measured of = measure(&solid);
		assert_true(fabs(of.volume[1] - boxes[k].volume) < 0.04 * boxes[k].volume);
		assert_int_equal(of.odd_edges, 0);
		cau_solid_finish(&solid);
		free(text);
	}
}

static void a_chosen_edge_makes_as_many_as_a_session_steps(void **state)
{
	(void)state;
	size_t byte_count;
	unsigned char *bytes = ball_of_voxels(1, &byte_count);
	cau_solid solid = make(bytes, byte_count, 0);
	measured of = measure(&solid);
	assert_in_range(of.tetrahedra, 6000, 12000);
	cau_solid_finish(&solid);
	free(bytes);
}

// Every beginning of a file is refused with a reason.
static void beginnings_are_refused(void **state)
{
	(void)state;
	size_t byte_count;
	unsigned char *bytes = ball_of_voxels(1, &byte_count);
	for (size_t count = 1; count < byte_count; count += count < 300 ? 1 : 4999) {
		cau_solid solid;
		cau_error error = {0};
		void *part = malloc(count);
		assert_non_null(part);
		memcpy(part, bytes, count);
		cau_solid_wish wish = {.file = "part", .bytes = part, .byte_count = count};
		assert_int_not_equal(cau_solid_make(&wish, &solid, &error), CAU_OK);
		assert_true(error.reason[0]);
		cau_solid_finish(&solid);
		free(part);
	}
	free(bytes);
}

// One layer of nine voxels with three labels. With the first edge that is tried, the lattice has no
// tetrahedron. This is not an error, and a shorter edge is tried.
static void what_is_thinner_than_any_edge_is_refused(void **state)
{
	(void)state;
	static const char file[] =
		"NRRD0004\ntype: uint8\ndimension: 3\nsizes: 1 3 3\nencoding: raw\n\n"
		"\1\0\x1d\0\0\0\xff\xff\xff";
	cau_solid solid;
	cau_error error = {0};
	cau_solid_wish wish = {.file = "thin", .bytes = file, .byte_count = sizeof file - 1};
	assert_int_not_equal(cau_solid_make(&wish, &solid, &error), CAU_OK);
	print_message("%s: %s\n", error.path, error.reason);
	assert_true(error.reason[0]);
	cau_solid_finish(&solid);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(labels_meet),
		cmocka_unit_test(the_same_bytes_give_the_same_solid),
		cmocka_unit_test(surfaces_are_filled),
		cmocka_unit_test(a_chosen_edge_makes_as_many_as_a_session_steps),
		cmocka_unit_test(beginnings_are_refused),
		cmocka_unit_test(what_is_thinner_than_any_edge_is_refused),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
