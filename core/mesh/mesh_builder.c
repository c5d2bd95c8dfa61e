// SPDX-License-Identifier: GPL-3.0-or-later
#include "mesh/mesh_builder.h"

#include <math.h>
#include <string.h>

#include "cautery/assert.h"
#include "mesh/mesh_memory.h"

// Makes *array (of items of item_bytes) hold `capacity`. False: memory ran out.
static bool grow_array(void *array, size_t item_bytes, int32_t capacity)
{
	CAU_ASSERT(capacity > 0 && item_bytes > 0, "room for %d items of %zu bytes", capacity,
	           item_bytes);
	void *old;
	memcpy(&old, array, sizeof old);
	void *grown = realloc(old, (size_t)capacity * item_bytes);
	if (grown)
		memcpy(array, &grown, sizeof grown);
	return grown != NULL;
}

// The capacity that holds one item more, or 0 where `most` are held already.
static int32_t next_capacity(int32_t capacity, int32_t most)
{
	CAU_ASSERT(capacity >= 0 && capacity <= most, "room for %d of at most %d", capacity, most);
	if (capacity == most)
		return 0;
	return capacity > most / 2 ? most : capacity ? 2 * capacity : 64;
}

// Decides what growing came to.
static bool has_grown(cau_mesh_builder *builder, int32_t capacity, bool memory, const char *what)
{
	if (capacity == 0)
		cau_scan_fail(builder->scan, CAU_LIMIT, "more %s than a mesh may have", what);
	else if (!memory)
		cau_scan_fail(builder->scan, CAU_NO_MEMORY, "no memory for %d %s", capacity, what);
	return capacity && memory;
}

void cau_mesh_builder_vertex(cau_mesh_builder *builder, const double position[3])
{
	cau_mesh *mesh = &builder->mesh;
	CAU_ASSERT(mesh->vertex_count <= builder->vertex_capacity, "%d vertices in room for %d",
	           mesh->vertex_count, builder->vertex_capacity);
	if (builder->scan->status)
		return;
	for (int c = 0; c < 3; c++)
		if (!isfinite(position[c])) {
			cau_scan_fail(builder->scan, CAU_BAD_MESH, "vertex %d: its %c is not finite",
			              mesh->vertex_count, "xyz"[c]);
			return;
		}
	if (mesh->vertex_count == builder->vertex_capacity) {
		int32_t capacity = next_capacity(builder->vertex_capacity, CAU_MESH_MAX_VERTICES);
		bool memory = capacity && grow_array(&mesh->position, 3 * sizeof(double), capacity);
		if (!has_grown(builder, capacity, memory, "vertices"))
			return;
		builder->vertex_capacity = capacity;
	}
	memcpy(mesh->position + 3 * (size_t)mesh->vertex_count++, position, 3 * sizeof *position);
}

void cau_mesh_builder_triangle(cau_mesh_builder *builder, const int32_t vertex[3], int32_t region,
                               const double *texture)
{
	cau_mesh *mesh = &builder->mesh;
	CAU_ASSERT(mesh->triangle_count <= builder->triangle_capacity, "%d triangles in room for %d",
	           mesh->triangle_count, builder->triangle_capacity);
	if (builder->scan->status)
		return;
	for (int c = 0; c < 3; c++)
		CAU_ASSERT_INDEX(vertex[c], mesh->vertex_count);
	if (mesh->triangle_count == builder->triangle_capacity) {
		int32_t capacity = next_capacity(builder->triangle_capacity, CAU_MESH_MAX_ELEMENTS);
		bool memory =
			capacity && grow_array(&mesh->triangle, 3 * sizeof(int32_t), capacity) &&
			grow_array(&mesh->triangle_region, sizeof(int32_t), capacity) &&
			(!builder->texture || grow_array(&mesh->texture, 6 * sizeof(double), capacity));
		if (!has_grown(builder, capacity, memory, "triangles"))
			return;
		builder->triangle_capacity = capacity;
	}
	size_t t = (size_t)mesh->triangle_count++;
	memcpy(mesh->triangle + 3 * t, vertex, 3 * sizeof *vertex);
	mesh->triangle_region[t] = region;
	if (builder->texture && texture)
		memcpy(mesh->texture + 6 * t, texture, 6 * sizeof *texture);
	else if (builder->texture)
		memset(mesh->texture + 6 * t, 0, 6 * sizeof *texture);
}

void cau_mesh_builder_tetrahedron(cau_mesh_builder *builder, const int32_t vertex[4],
                                  int32_t region)
{
	cau_mesh *mesh = &builder->mesh;
	CAU_ASSERT(mesh->tetrahedron_count <= builder->tetrahedron_capacity,
	           "%d tetrahedra in room for %d", mesh->tetrahedron_count,
	           builder->tetrahedron_capacity);
	if (builder->scan->status)
		return;
	for (int c = 0; c < 4; c++)
		CAU_ASSERT_INDEX(vertex[c], mesh->vertex_count);
	if (mesh->tetrahedron_count == builder->tetrahedron_capacity) {
		int32_t capacity = next_capacity(builder->tetrahedron_capacity, CAU_MESH_MAX_ELEMENTS);
		bool memory = capacity && grow_array(&mesh->tetrahedron, 4 * sizeof(int32_t), capacity) &&
		              grow_array(&mesh->tetrahedron_region, sizeof(int32_t), capacity);
		if (!has_grown(builder, capacity, memory, "tetrahedra"))
			return;
		builder->tetrahedron_capacity = capacity;
	}
	size_t t = (size_t)mesh->tetrahedron_count++;
	memcpy(mesh->tetrahedron + 4 * t, vertex, 4 * sizeof *vertex);
	mesh->tetrahedron_region[t] = region;
}

void cau_mesh_builder_skip(cau_mesh_builder *builder, int64_t kind, int64_t count)
{
	CAU_ASSERT(count >= 0, "%lld elements passed over", (long long)count);
	if (kind >= 0 && kind < CAU_SKIPPED_KINDS)
		builder->skipped[kind] += count;
}

void cau_mesh_builder_check(cau_mesh_builder *builder, const char *(*name_of)(int kind))
{
	CAU_ASSERT(name_of != NULL, "no names for what was passed over, and %d vertices",
	           builder->mesh.vertex_count);
	if (builder->scan->status || builder->mesh.triangle_count || builder->mesh.tetrahedron_count)
		return;
	char found[160] = "nothing";
	size_t length = 0;
	for (int kind = 0; kind < CAU_SKIPPED_KINDS && length < sizeof found; kind++)
		if (builder->skipped[kind])
			length += (size_t)snprintf(found + length, sizeof found - length, "%s%lld %s",
			                           length ? ", " : "", (long long)builder->skipped[kind],
			                           name_of(kind));
	cau_scan_fail(builder->scan, CAU_BAD_MESH,
	              "no three-node triangles or four-node tetrahedra in this file, but %s", found);
}
