// SPDX-License-Identifier: GPL-3.0-or-later
// Rest shape of the elements: D_m^-1, areas, volumes, lumped masses (eq. 8, 10).
#include "base/vector.h"
#include "cautery/assert.h"
#include "tissue/tissue_internal.h"

static cau_vec3 rest_edge(const cau_tissue *tissue, int32_t from, int32_t to)
{
	CAU_ASSERT_INDEX(from, tissue->vertex_count);
	CAU_ASSERT_INDEX(to, tissue->vertex_count);
	return cau_sub(cau_vec3_of(tissue->rest + 3 * (size_t)to),
	               cau_vec3_of(tissue->rest + 3 * (size_t)from));
}

// Relative bound below which an element counts as flat. The check prevents a division by 0.
// Cleaning has already refused elements flatter than 1e-6 (mesh/clean.c), so this second check is
// far below the first.
static const double flat = 1e-9;

static cau_status shape_triangle(cau_tissue *tissue, int32_t t, cau_error *error)
{
	const int32_t *vertex = tissue->triangle + 3 * (size_t)t;
	cau_vec3 j = rest_edge(tissue, vertex[0], vertex[1]),
			 k = rest_edge(tissue, vertex[0], vertex[2]);
	cau_vec3 u = cau_vec3_of(tissue->triangle_frame + 6 * (size_t)t);
	cau_vec3 v = cau_vec3_of(tissue->triangle_frame + 6 * (size_t)t + 3);
	double a = cau_dot(u, j), b = cau_dot(u, k), c = cau_dot(v, j), d = cau_dot(v, k);
	double det = a * d - b * c, area = cau_length(cau_cross(j, k)) / 2;
	double longest = fmax(cau_dot(j, j), cau_dot(k, k));
	if (!(area > flat * longest) || !(fabs(det) > area))
		return cau_fail(error, CAU_BAD_MESH, NULL, "triangle %d of layer \"%s\" has no area", t,
		                tissue->layer[tissue->triangle_layer[t]].def.name);
	double *m = tissue->triangle_dm_inverse + 4 * (size_t)t;
	m[0] = d / det, m[1] = -b / det, m[2] = -c / det, m[3] = a / det;
	tissue->triangle_area[t] = area;
	const cau_sheet_material *material = cau_triangle_material(tissue, t);
	for (int i = 0; i < 3; i++)
		tissue->mass[vertex[i]] += material->density_kg_m3 * material->thickness_m * area / 3;
	CAU_ASSERT(area > 0 && tissue->mass[vertex[0]] > 0, "triangle %d: %g m^2, %g kg", t, area,
	           tissue->mass[vertex[0]]);
	return CAU_OK;
}

static cau_status shape_tetrahedron(cau_tissue *tissue, int32_t t, cau_error *error)
{
	const int32_t *vertex = tissue->tetrahedron + 4 * (size_t)t;
	cau_vec3 d[3];
	double longest = 0;
	for (int i = 0; i < 3; i++) {
		d[i] = rest_edge(tissue, vertex[0], vertex[i + 1]);
		longest = fmax(longest, cau_length(d[i]));
	}
	cau_vec3 row[3] = {cau_cross(d[1], d[2]), cau_cross(d[2], d[0]), cau_cross(d[0], d[1])};
	double det = cau_dot(d[0], row[0]);
	if (!(det > flat * longest * longest * longest))
		return cau_fail(error, CAU_BAD_MESH, NULL, "tetrahedron %d of layer \"%s\" has no volume",
		                t, tissue->layer[tissue->tetrahedron_layer[t]].def.name);
	for (int i = 0; i < 3; i++)
		cau_vec3_to(cau_scale(1 / det, row[i]),
		            tissue->tetrahedron_dm_inverse + 9 * (size_t)t + 3 * i);
	tissue->tetrahedron_volume[t] = det / 6;
	CAU_ASSERT(tissue->tetrahedron_volume[t] > 0, "tetrahedron %d has %g m^3", t,
	           tissue->tetrahedron_volume[t]);
	for (int i = 0; i < 4; i++)
		tissue->mass[vertex[i]] += cau_tetrahedron_material(tissue, t)->density_kg_m3 * det / 24;
	return CAU_OK;
}

cau_status cau_tissue_shape(cau_tissue *tissue, cau_arena *arena, cau_error *error)
{
	CAU_ASSERT(!tissue->triangle_area, "%d triangles are shaped twice", tissue->triangle_count);
	size_t t = (size_t)tissue->triangle_count, k = (size_t)tissue->tetrahedron_count;
	tissue->triangle_dm_inverse = cau_arena_array(arena, 4 * t, sizeof(double));
	tissue->triangle_area = cau_arena_array(arena, t, sizeof(double));
	tissue->tetrahedron_dm_inverse = cau_arena_array(arena, 9 * k, sizeof(double));
	tissue->tetrahedron_volume = cau_arena_array(arena, k, sizeof(double));
	if (!tissue->triangle_dm_inverse || !tissue->triangle_area || !tissue->tetrahedron_dm_inverse ||
	    !tissue->tetrahedron_volume)
		return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for the elements");
	cau_status status = CAU_OK;
	for (int32_t i = 0; i < tissue->triangle_count && !status; i++)
		status = shape_triangle(tissue, i, error);
	for (int32_t i = 0; i < tissue->tetrahedron_count && !status; i++)
		status = shape_tetrahedron(tissue, i, error);
	for (int32_t v = 0; v < tissue->vertex_count && !status; v++)
		if (!(tissue->mass[v] > 0))
			status = cau_fail(error, CAU_BAD_MESH, NULL,
			                  "vertex %d belongs to no layer's elements and has no mass", v);
	return status;
}
