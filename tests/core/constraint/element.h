// SPDX-License-Identifier: GPL-3.0-or-later
// One element of each kind at a given deformation gradient, and the stress of its law.
#pragma once

#include <string.h>

#include "core/rig/rig.h"

// A tetrahedron without right angles or equal edges, and a triangle that is oblique to the axes
// (m).
static const double element_points[4][3] = {
	{0.004, -0.002, 0.001}, {0.024, 0.003, -0.002}, {0.006, 0.021, 0.004}, {0.009, 0.005, 0.019}};

static inline cau_layer_def *element_add_tetrahedron(rig *r)
{
	static const int32_t vertex[4] = {0, 1, 2, 3};
	return rig_add_tetrahedra(r, 4, element_points[0], 1, vertex);
}

static inline cau_layer_def *element_add_triangle(rig *r)
{
	static const int32_t vertex[3] = {0, 1, 2};
	return rig_add_triangles(r, 3, element_points[0], 1, vertex);
}

// Computes the edge vectors from vertex 0 as columns. For a triangle, the third column is the unit
// normal.
static inline void element_edges(const rig *r, int triangle, const double *x, double out[3][3])
{
	const int32_t *v = triangle ? r->tissue.triangle : r->tissue.tetrahedron;
	for (int k = 0; k < (triangle ? 2 : 3); k++)
		for (int c = 0; c < 3; c++)
			out[c][k] = x[3 * v[k + 1] + c] - x[3 * v[0] + c];
	if (!triangle)
		return;
	double n[3];
	for (int c = 0; c < 3; c++)
		n[c] =
			out[(c + 1) % 3][0] * out[(c + 2) % 3][1] - out[(c + 2) % 3][0] * out[(c + 1) % 3][1];
	for (int c = 0; c < 3; c++)
		out[c][2] = n[c] / sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
}

// Computes the axes in which F is expressed: for a triangle the columns t_u, t_v and normal; for a
// tetrahedron I.
static inline void element_axes(const rig *r, int triangle, double axes[3][3])
{
	mat_identity(axes);
	if (!triangle)
		return;
	double edges[3][3];
	element_edges(r, 1, r->tissue.rest, edges);
	for (int c = 0; c < 3; c++) {
		axes[c][0] = r->tissue.triangle_frame[c];
		axes[c][1] = r->tissue.triangle_frame[3 + c];
		axes[c][2] = edges[c][2];
	}
}

// Computes the positions at which F, in the element's axes, is f: x = f axes^T X.
static inline void element_place(const rig *r, int triangle, double f[3][3], double *x)
{
	double axes[3][3], map[3][3];
	element_axes(r, triangle, axes);
	mat_transpose(axes, map);
	mat_multiply(f, map, map);
	for (int32_t v = 0; v < (triangle ? 3 : 4); v++)
		mat_apply(map, r->tissue.rest + 3 * v, x + 3 * v);
}

// Computes the columns of the law's stress times volume (N m), from the forces on the vertices.
// Vertex i + 1 has the force S m_i, where m_i are the rows of D_m^-1. The third column of a
// triangle is zero.
static inline void element_stress(const rig *r, int triangle, const double *gradient,
                                  double stress[3][3])
{
	double axes[3][3], d[3][3], forces[3][3] = {{0}};
	const int32_t *v = triangle ? r->tissue.triangle : r->tissue.tetrahedron;
	element_axes(r, triangle, axes);
	element_edges(r, triangle, r->tissue.rest, d);
	for (int k = 0; k < (triangle ? 2 : 3); k++)
		for (int c = 0; c < 3; c++)
			forces[c][k] = gradient[3 * v[k + 1] + c];
	mat_transpose_multiply(axes, d, d); // D_m in the element's axes
	mat_transpose(d, d);
	mat_multiply(forces, d, stress); // S = [g_1 g_2 g_3] D_m^T
}

// Computes the law's stress times volume at F = f.
static inline void element_answer(rig *r, int triangle, double f[3][3], double stress[3][3])
{
	double x[12], gradient[12];
	element_place(r, triangle, f, x);
	rig_local(r, x, gradient);
	element_stress(r, triangle, gradient, stress);
}
