// SPDX-License-Identifier: GPL-3.0-or-later
// A mesh that grows while a file is read, the triangles of its polygons, and the node numbers of
// the file.
#include "mesh/mesh_builder.h"

#include <math.h>
#include <string.h>

#include "cautery/assert.h"
#include "mesh/geometry.h"

// ---- polygons
static bool is_fan(const double *position, const int32_t *vertex, int32_t count,
                   const double normal[3])
{
	for (int32_t i = 2; i < count; i++) {
		const int32_t corner[3] = {vertex[0], vertex[i - 1], vertex[i]};
		double own[3];
		cau_triangle_normal(position, corner, own);
		if (cau_dot3(own, normal) <= 0)
			return false;
	}
	return true;
}

// Whether point p is in the triangle, as seen along the normal.
static bool holds_point(const double *position, const int32_t corner[3], int32_t p,
                        const double normal[3])
{
	for (int i = 0; i < 3; i++) {
		const int32_t side[3] = {corner[i], corner[(i + 1) % 3], p};
		double own[3];
		if (p == corner[i])
			return false;
		cau_triangle_normal(position, side, own);
		if (cau_dot3(own, normal) < 0)
			return false;
	}
	return true;
}

// Whether the corner at index `at` of the remaining corners can be cut off as a triangle.
static bool is_ear(const double *position, const int32_t *vertex, const int32_t *left,
                   int32_t left_count, int32_t at, const double normal[3])
{
	const int32_t ear[3] = {vertex[left[(at + left_count - 1) % left_count]], vertex[left[at]],
	                        vertex[left[(at + 1) % left_count]]};
	double own[3];
	cau_triangle_normal(position, ear, own);
	if (cau_dot3(own, normal) <= 0)
		return false;
	for (int32_t i = 0; i < left_count; i++)
		if (holds_point(position, ear, vertex[left[i]], normal))
			return false;
	return true;
}

static void cut_ears(const double *position, const int32_t *vertex, int32_t count,
                     const double normal[3], int32_t *left, int32_t (*triangle)[3])
{
	for (int32_t i = 0; i < count; i++)
		left[i] = i;
	for (int32_t made = 0; count > 3; count--, made++) {
		int32_t at = 0;
		while (at < count && !is_ear(position, vertex, left, count, at, normal))
			at++;
		if (at == count) // the polygon crosses itself, so no corner is better than another
			at = 1;
		triangle[made][0] = left[(at + count - 1) % count];
		triangle[made][1] = left[at];
		triangle[made][2] = left[(at + 1) % count];
		memmove(left + at, left + at + 1, (size_t)(count - at - 1) * sizeof *left);
		if (count == 4)
			memcpy(triangle[made + 1], left, sizeof triangle[0]);
	}
}

bool cau_polygon_cut(const double *position, const int32_t *vertex, int32_t count,
                     int32_t (*triangle)[3])
{
	CAU_ASSERT(count >= 3, "a polygon of %d corners", count);
	double normal[3] = {0};
	for (int32_t i = 2; i < count; i++) {
		const int32_t corner[3] = {vertex[0], vertex[i - 1], vertex[i]};
		double own[3];
		cau_triangle_normal(position, corner, own);
		for (int c = 0; c < 3; c++)
			normal[c] += own[c];
	}
	for (int32_t i = 2; i < count; i++)
		memcpy(triangle[i - 2], (int32_t[]){0, i - 1, i}, sizeof triangle[0]);
	if (count == 3 || count > 4096 || is_fan(position, vertex, count, normal))
		return true;
	int32_t *left = cau_mesh_array((size_t)count, sizeof *left);
	if (left)
		cut_ears(position, vertex, count, normal, left, triangle);
	free(left);
	return left != NULL;
}

// ---- growing
// Grows *array (of items of item_bytes) to `capacity` items. Returns false if memory ran out.
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

// Returns a capacity for at least one more item, or 0 if the capacity is `most` already.
static int32_t next_capacity(int32_t capacity, int32_t most)
{
	CAU_ASSERT(capacity >= 0 && capacity <= most, "room for %d of at most %d", capacity, most);
	if (capacity == most)
		return 0;
	return capacity > most / 2 ? most : capacity ? 2 * capacity : 64;
}

// Reports a failed growth to the scan. Returns whether the growth succeeded.
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

// ---- cells of every shape
static const struct {
	int corners;
	const char *name;
} shapes[CAU_SHAPE_COUNT] = {
	[CAU_SHAPE_TRIANGLE] = {3, "triangles"},     [CAU_SHAPE_QUADRANGLE] = {4, "quadrangles"},
	[CAU_SHAPE_TETRAHEDRON] = {4, "tetrahedra"}, [CAU_SHAPE_PYRAMID] = {5, "pyramids"},
	[CAU_SHAPE_WEDGE] = {6, "wedges"},           [CAU_SHAPE_HEXAHEDRON] = {8, "hexahedra"},
};

int cau_shape_corners(cau_shape shape)
{
	CAU_ASSERT_INDEX((int)shape, CAU_SHAPE_COUNT);
	return shapes[shape].corners;
}

const char *cau_shape_name(cau_shape shape)
{
	CAU_ASSERT_INDEX((int)shape, CAU_SHAPE_COUNT);
	return shapes[shape].name;
}

// Returns the report's entry of a kind. If all entries are used, the last entry counts all further
// kinds.
static cau_mesh_kind *kind_of(cau_mesh_builder *builder, const char *name)
{
	cau_mesh_report *report = &builder->report;
	for (int32_t i = 0; i < report->kind_count; i++)
		if (!strcmp(report->kind[i].name, name))
			return &report->kind[i];
	if (report->kind_count == CAU_MESH_KIND_MAX)
		return &report->kind[CAU_MESH_KIND_MAX - 1];
	cau_mesh_kind *made = &report->kind[report->kind_count++];
	snprintf(made->name, sizeof made->name, "%s",
	         report->kind_count == CAU_MESH_KIND_MAX ? "other elements" : name);
	return made;
}

static void add_cell(cau_mesh_builder *builder, const cau_cell *cell)
{
	if (builder->cell_count == builder->cell_capacity) {
		int32_t capacity = next_capacity(builder->cell_capacity, CAU_MESH_MAX_ELEMENTS);
		bool memory = capacity && grow_array(&builder->cell, sizeof *builder->cell, capacity);
		if (!has_grown(builder, capacity, memory, "elements"))
			return;
		builder->cell_capacity = capacity;
	}
	builder->cell[builder->cell_count++] = *cell;
}

void cau_mesh_builder_cell(cau_mesh_builder *builder, cau_shape shape, const int32_t *vertex,
                           int32_t region, const char *kind, bool reduced)
{
	CAU_ASSERT_INDEX((int)shape, CAU_SHAPE_COUNT);
	if (builder->scan->status)
		return;
	kind_of(builder, kind)->read++;
	builder->report.reduced_elements += reduced;
	cau_cell cell = {.shape = (int32_t)shape, .region = region};
	memcpy(cell.vertex, vertex, (size_t)shapes[shape].corners * sizeof *vertex);
	for (int c = 0; c < shapes[shape].corners; c++)
		CAU_ASSERT_INDEX(vertex[c], builder->mesh.vertex_count);
	if (shape == CAU_SHAPE_TRIANGLE)
		cau_mesh_builder_triangle(builder, cell.vertex, region, NULL);
	else if (shape == CAU_SHAPE_TETRAHEDRON)
		cau_mesh_builder_tetrahedron(builder, cell.vertex, region);
	else
		add_cell(builder, &cell);
}

void cau_mesh_builder_polygon(cau_mesh_builder *builder, const int32_t *vertex, int32_t count,
                              int32_t region, const double *texture)
{
	CAU_ASSERT(count >= 3, "a polygon of %d corners", count);
	if (builder->scan->status)
		return;
	kind_of(builder, count == 3 ? "triangles" : count == 4 ? "quadrangles" : "polygons")->read++;
	builder->report.split_polygons += count > 3;
	int32_t(*cut)[3] = cau_mesh_array((size_t)count - 2, sizeof *cut);
	if (!cut || !cau_polygon_cut(builder->mesh.position, vertex, count, cut)) {
		cau_scan_fail(builder->scan, CAU_NO_MEMORY, "no memory for a polygon of %d corners", count);
		free(cut);
		return;
	}
	for (int32_t i = 0; i < count - 2 && !builder->scan->status; i++) {
		int32_t corner[3];
		double uv[6] = {0};
		for (int c = 0; c < 3; c++) {
			corner[c] = vertex[cut[i][c]];
			if (texture)
				memcpy(uv + 2 * c, texture + 2 * (size_t)cut[i][c], 2 * sizeof *uv);
		}
		cau_mesh_builder_triangle(builder, corner, region, texture ? uv : NULL);
	}
	free(cut);
}

void cau_mesh_builder_skip(cau_mesh_builder *builder, const char *kind, int64_t count)
{
	CAU_ASSERT(count >= 0, "%lld %s passed over", (long long)count, kind);
	if (count)
		kind_of(builder, kind)->passed += count;
}

void cau_mesh_builder_name(cau_mesh_builder *builder, int32_t dimension, int32_t region,
                           cau_word name)
{
	CAU_ASSERT(builder->name_count <= builder->name_capacity, "%d names in room for %d",
	           builder->name_count, builder->name_capacity);
	if (builder->scan->status)
		return;
	if (builder->name_count == builder->name_capacity) {
		int32_t capacity = next_capacity(builder->name_capacity, CAU_REGION_NAMES_MAX);
		bool memory = capacity && grow_array(&builder->name, sizeof *builder->name, capacity);
		if (!has_grown(builder, capacity, memory, "names of regions"))
			return;
		builder->name_capacity = capacity;
	}
	builder->name[builder->name_count++] = (cau_region_name){dimension, region, name};
}

static void map_regions(int32_t *region, int32_t count, const int32_t *of, int64_t of_count)
{
	for (int32_t i = 0; i < count; i++)
		region[i] = region[i] >= 0 && region[i] < of_count ? of[region[i]] : 0;
}

void cau_mesh_builder_map_regions(cau_mesh_builder *builder, const int32_t *of, int64_t count)
{
	cau_mesh *mesh = &builder->mesh;
	map_regions(mesh->triangle_region, mesh->triangle_count, of, count);
	map_regions(mesh->tetrahedron_region, mesh->tetrahedron_count, of, count);
	for (int32_t i = 0; i < builder->cell_count; i++)
		map_regions(&builder->cell[i].region, 1, of, count);
}

void cau_mesh_builder_finish(cau_mesh_builder *builder)
{
	cau_mesh_finish(&builder->mesh);
	free(builder->cell);
	free(builder->name);
	builder->cell = NULL;
	builder->name = NULL;
}

// ---- node numbers
void cau_node_map_add(cau_node_map *map, int64_t number, cau_scan *scan)
{
	if (scan->status)
		return;
	CAU_ASSERT(map->count <= map->capacity, "%d nodes in room for %d", map->count, map->capacity);
	if (map->count == map->capacity) {
		int32_t capacity = map->capacity ? 2 * map->capacity : 64;
		if (capacity > 2 * CAU_MESH_MAX_VERTICES) {
			cau_scan_fail(scan, CAU_LIMIT, "more nodes than a mesh may have");
			return;
		}
		void *grown = realloc(map->node, (size_t)capacity * sizeof *map->node);
		if (!grown) {
			cau_scan_fail(scan, CAU_NO_MEMORY, "no memory for %d nodes", capacity);
			return;
		}
		map->node = grown;
		map->capacity = capacity;
	}
	map->node[map->count] = (struct cau_node){number, map->count};
	map->count++;
}

static int compare_numbers(const void *left, const void *right)
{
	const struct cau_node *a = left, *b = right;
	return (a->number > b->number) - (a->number < b->number);
}

static bool is_ascending(const cau_node_map *map)
{
	for (int32_t i = 1; i < map->count; i++)
		if (map->node[i - 1].number >= map->node[i].number)
			return false;
	return true;
}

void cau_node_map_seal(cau_node_map *map, cau_scan *scan)
{
	if (scan->status || is_ascending(map))
		return;
	qsort(map->node, (size_t)map->count, sizeof *map->node, compare_numbers);
	for (int32_t i = 1; i < map->count; i++)
		if (map->node[i - 1].number == map->node[i].number) {
			cau_scan_fail(scan, CAU_BAD_MESH, "the file has node number %lld twice",
			              (long long)map->node[i].number);
			return;
		}
}

int32_t cau_node_map_find(const cau_node_map *map, int64_t number)
{
	int32_t low = 0, high = map->count;
	while (low < high) {
		int32_t middle = low + (high - low) / 2;
		if (map->node[middle].number < number)
			low = middle + 1;
		else
			high = middle;
	}
	CAU_ASSERT(low >= map->count || low == 0 || map->node[low - 1].number < number,
	           "node %lld is looked for in a map that is not sealed", (long long)number);
	return low < map->count && map->node[low].number == number ? map->node[low].vertex : -1;
}

void cau_node_map_finish(cau_node_map *map)
{
	free(map->node);
	*map = (cau_node_map){0};
}
