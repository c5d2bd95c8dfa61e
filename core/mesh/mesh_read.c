// SPDX-License-Identifier: GPL-3.0-or-later
// From bytes to a mesh, by the ending of the file's name.
#include <string.h>
#include <strings.h>

#include "cautery/assert.h"
#include "mesh/gmsh.h"
#include "mesh/mesh_memory.h"
#include "mesh/obj.h"
#include "mesh/vtk.h"

static const struct {
	const char *ending;
	cau_status (*read)(cau_mesh_builder *builder);
} formats[] = {
	{".msh", cau_mesh_read_gmsh},
	{".obj", cau_mesh_read_obj},
	{".vtk", cau_mesh_read_vtk},
};

static bool has_ending(const char *name, const char *ending)
{
	size_t name_length = strlen(name), length = strlen(ending);
	return name_length >= length && !strcasecmp(name + name_length - length, ending);
}

// The readers leave room for growth.
static cau_status copy_tight(const cau_mesh *from, cau_mesh *mesh, cau_error *error)
{
	CAU_ASSERT(from->vertex_count >= 0 && from->triangle_count >= 0 && from->tetrahedron_count >= 0,
	           "%d vertices, %d triangles, %d tetrahedra", from->vertex_count, from->triangle_count,
	           from->tetrahedron_count);
	cau_status status = cau_mesh_reserve(mesh, from->vertex_count, from->triangle_count,
	                                     from->tetrahedron_count, from->texture != NULL, error);
	if (status)
		return status;
	size_t triangles = (size_t)from->triangle_count, tetrahedra = (size_t)from->tetrahedron_count;
	memcpy(mesh->position, from->position, 3 * (size_t)from->vertex_count * sizeof(double));
	if (triangles) {
		memcpy(mesh->triangle, from->triangle, 3 * triangles * sizeof(int32_t));
		memcpy(mesh->triangle_region, from->triangle_region, triangles * sizeof(int32_t));
	}
	if (triangles && from->texture)
		memcpy(mesh->texture, from->texture, 6 * triangles * sizeof(double));
	if (tetrahedra) {
		memcpy(mesh->tetrahedron, from->tetrahedron, 4 * tetrahedra * sizeof(int32_t));
		memcpy(mesh->tetrahedron_region, from->tetrahedron_region, tetrahedra * sizeof(int32_t));
	}
	return CAU_OK;
}

cau_status cau_mesh_read(const char *name, const void *bytes, size_t byte_count, cau_mesh *mesh,
                         cau_error *error)
{
	CAU_ASSERT(bytes || !byte_count, "%zu bytes that are nowhere", byte_count);
	*mesh = (cau_mesh){0};
	for (size_t i = 0; i < sizeof formats / sizeof formats[0]; i++) {
		if (!has_ending(name, formats[i].ending))
			continue;
		cau_scan scan = cau_scan_make(bytes, byte_count, error);
		cau_mesh_builder builder = {.scan = &scan};
		cau_status status = formats[i].read(&builder);
		if (!status)
			status = copy_tight(&builder.mesh, mesh, error);
		cau_mesh_finish(&builder.mesh);
		return status;
	}
	return cau_fail(error, CAU_UNSUPPORTED, NULL,
	                "a mesh file ends in .msh, .obj or .vtk; this one is called '%.100s'", name);
}
