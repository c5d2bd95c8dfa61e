// SPDX-License-Identifier: GPL-3.0-or-later
// Bending: one hinge for each edge that two triangles of a sheet share. The vector e = sum of c_i
// x_i, with the cotangent coefficients of the isometric bending model [Bergou et al. 2006], is 0 on
// a flat patch. A curved sheet keeps the |e| of its rest shape.
#include "base/vector.h"
#include "cautery/assert.h"
#include "tissue/tissue_internal.h"

static cau_vec3 rest_of(const cau_tissue *tissue, int32_t vertex)
{
	CAU_ASSERT_INDEX(vertex, tissue->vertex_count);
	return cau_vec3_of(tissue->rest + 3 * (size_t)vertex);
}

static double cotangent(cau_vec3 at, cau_vec3 a, cau_vec3 b)
{
	cau_vec3 u = cau_sub(a, at), v = cau_sub(b, at);
	double sine = cau_length(cau_cross(u, v));
	return sine > 0 ? cau_dot(u, v) / sine : 0;
}

static int32_t opposite(const cau_tissue *tissue, int32_t triangle, int32_t a, int32_t b)
{
	CAU_ASSERT_INDEX(triangle, tissue->triangle_count);
	const int32_t *vertex = tissue->triangle + 3 * (size_t)triangle;
	for (int i = 0; i < 2; i++)
		if (vertex[i] != a && vertex[i] != b)
			return vertex[i];
	CAU_ASSERT(vertex[2] != a && vertex[2] != b, "triangle %d has no vertex beside %d and %d",
	           triangle, a, b);
	return vertex[2];
}

static void make_hinge(cau_tissue *tissue, int32_t hinge, int32_t edge, const int32_t triangle[2],
                       double stiffness)
{
	CAU_ASSERT_INDEX(edge, tissue->edges.edge_count);
	CAU_ASSERT(triangle[0] != triangle[1], "hinge %d has triangle %d twice", hinge, triangle[0]);
	CAU_ASSERT(stiffness > 0, "hinge %d has stiffness %g", hinge, stiffness);
	int32_t *v = tissue->hinge_vertex + 4 * (size_t)hinge;
	v[0] = tissue->edges.vertex[2 * edge];
	v[1] = tissue->edges.vertex[2 * edge + 1];
	v[2] = opposite(tissue, triangle[0], v[0], v[1]);
	v[3] = opposite(tissue, triangle[1], v[0], v[1]);
	cau_vec3 a = rest_of(tissue, v[0]), b = rest_of(tissue, v[1]);
	cau_vec3 c = rest_of(tissue, v[2]), d = rest_of(tissue, v[3]);
	double cot_a = cotangent(a, b, c) + cotangent(a, b, d); // cotangents of the angles at a
	double cot_b = cotangent(b, a, c) + cotangent(b, a, d); // cotangents of the angles at b
	double length = cau_length(cau_sub(b, a));
	CAU_ASSERT(length > 0, "edge %d has no length", edge);
	double height[2] = {2 * tissue->triangle_area[triangle[0]] / length,
	                    2 * tissue->triangle_area[triangle[1]] / length};
	double *k = tissue->hinge_coefficient + 4 * (size_t)hinge;
	k[0] = cot_b;
	k[1] = cot_a;
	k[2] = -length / height[0];
	k[3] = -length / height[1];
	double area = tissue->triangle_area[triangle[0]] + tissue->triangle_area[triangle[1]];
	tissue->hinge_weight[hinge] = 3 * stiffness / area;
	tissue->hinge_triangle[2 * hinge] = triangle[0];
	tissue->hinge_triangle[2 * hinge + 1] = triangle[1];
}

static double stiffness_of(const cau_tissue *tissue, const int32_t triangle[2])
{
	return fmin(cau_triangle_material(tissue, triangle[0])->bending_stiffness_nm,
	            cau_triangle_material(tissue, triangle[1])->bending_stiffness_nm);
}

cau_status cau_tissue_hinge(cau_tissue *tissue, cau_arena *arena, cau_error *error)
{
	CAU_ASSERT(tissue->edges.edge_count > 0, "hinges before the %d edges",
	           tissue->edges.edge_count);
	const cau_edge_table *edges = &tissue->edges;
	int32_t count = 0;
	for (int32_t h = 0; h < edges->hinge_count; h++)
		count += stiffness_of(tissue, edges->hinge_triangle + 2 * h) > 0;
	tissue->hinge_vertex = cau_arena_array(arena, 4 * (size_t)count, sizeof(int32_t));
	tissue->hinge_triangle = cau_arena_array(arena, 2 * (size_t)count, sizeof(int32_t));
	tissue->hinge_coefficient = cau_arena_array(arena, 4 * (size_t)count, sizeof(double));
	tissue->hinge_weight = cau_arena_array(arena, (size_t)count, sizeof(double));
	if (!tissue->hinge_vertex || !tissue->hinge_triangle || !tissue->hinge_coefficient ||
	    !tissue->hinge_weight)
		return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for %d hinges", count);
	for (int32_t h = 0; h < edges->hinge_count; h++) {
		const int32_t *triangle = edges->hinge_triangle + 2 * h;
		double stiffness = stiffness_of(tissue, triangle);
		if (stiffness > 0)
			make_hinge(tissue, tissue->hinge_count++, edges->hinge_edge[h], triangle, stiffness);
	}
	CAU_ASSERT(tissue->hinge_count == count, "%d hinges made of %d", tissue->hinge_count, count);
	return CAU_OK;
}
