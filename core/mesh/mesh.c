// SPDX-License-Identifier: GPL-3.0-or-later
// A mesh: its storage and its units.
#include "mesh/mesh.h"

#include <math.h>
#include <stddef.h>

#include "cautery/assert.h"

// ---- storage
static bool within_bounds(int64_t vertex_count, int64_t triangle_count, int64_t tetrahedron_count)
{
	return vertex_count >= 0 && vertex_count <= CAU_MESH_MAX_VERTICES && triangle_count >= 0 &&
	       triangle_count <= CAU_MESH_MAX_ELEMENTS && tetrahedron_count >= 0 &&
	       tetrahedron_count <= CAU_MESH_MAX_ELEMENTS;
}

cau_status cau_mesh_reserve(cau_mesh *mesh, int64_t vertex_count, int64_t triangle_count,
                            int64_t tetrahedron_count, bool texture, cau_error *error)
{
	*mesh = (cau_mesh){0};
	if (!within_bounds(vertex_count, triangle_count, tetrahedron_count))
		return cau_fail(error, CAU_LIMIT, NULL,
		                "a mesh has at most %d vertices and %d elements of a kind",
		                CAU_MESH_MAX_VERTICES, CAU_MESH_MAX_ELEMENTS);

	mesh->vertex_count = (int32_t)vertex_count;
	mesh->triangle_count = (int32_t)triangle_count;
	mesh->tetrahedron_count = (int32_t)tetrahedron_count;
	size_t vertices = (size_t)vertex_count, triangles = (size_t)triangle_count;
	size_t tetrahedra = (size_t)tetrahedron_count;
	mesh->position = cau_mesh_array(3 * vertices, sizeof *mesh->position);
	mesh->triangle = cau_mesh_array(3 * triangles, sizeof *mesh->triangle);
	mesh->triangle_region = cau_mesh_array(triangles, sizeof *mesh->triangle_region);
	mesh->tetrahedron = cau_mesh_array(4 * tetrahedra, sizeof *mesh->tetrahedron);
	mesh->tetrahedron_region = cau_mesh_array(tetrahedra, sizeof *mesh->tetrahedron_region);
	if (texture)
		mesh->texture = cau_mesh_array(6 * triangles, sizeof *mesh->texture);

	if (!mesh->position || !mesh->triangle || !mesh->triangle_region || !mesh->tetrahedron ||
	    !mesh->tetrahedron_region || (texture && !mesh->texture)) {
		cau_mesh_finish(mesh);
		return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for a mesh of %lld vertices",
		                (long long)vertex_count);
	}
	return CAU_OK;
}

void cau_mesh_finish(cau_mesh *mesh)
{
	free(mesh->position);
	free(mesh->triangle);
	free(mesh->triangle_region);
	free(mesh->texture);
	free(mesh->tetrahedron);
	free(mesh->tetrahedron_region);
	*mesh = (cau_mesh){0};
}

// ---- units
// Possible sizes of tissue: from a piece of a vessel's wall to a whole body.
static const double tissue_least_m = 0.0005, tissue_most_m = 3;
// Most frequent sizes in files: from a gall bladder to a torso.
static const double organ_least_m = 0.02, organ_most_m = 0.8;

static const struct {
	double unit_m;
	const char *name;
} units[] = {{1e-3, "millimetres"}, {1e-2, "centimetres"}, {1, "metres"},
             {1e-6, "micrometres"}, {0.1, "decimetres"},   {1e3, "kilometres"}};

bool cau_is_tissue_size(double longest_m)
{
	return longest_m >= tissue_least_m && longest_m <= tissue_most_m;
}

double cau_guess_unit(double longest)
{
	CAU_ASSERT(longest > 0, "a mesh of length %g", longest);
	for (size_t i = 0; i < sizeof units / sizeof *units; i++)
		if (longest * units[i].unit_m >= organ_least_m && longest * units[i].unit_m <= organ_most_m)
			return units[i].unit_m;
	return pow(10, floor(log10(organ_most_m / longest)));
}

const char *cau_unit_name(double unit_m)
{
	for (size_t i = 0; i < sizeof units / sizeof *units; i++)
		if (fabs(unit_m / units[i].unit_m - 1) < 1e-6)
			return units[i].name;
	return "another unit";
}
