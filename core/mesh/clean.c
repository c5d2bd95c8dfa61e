// SPDX-License-Identifier: GPL-3.0-or-later
// Repairs a mesh from a file before anything is computed on the mesh.
#include <math.h>
#include <string.h>

#include "cautery/assert.h"
#include "mesh/edge_table.h"
#include "mesh/geometry.h"
#include "mesh/mesh.h"

// Limits below which an element counts as flat, relative to its longest edge L. They apply to the
// height of a triangle, 2 A / L^2, and to 6 V / L^3 of a tetrahedron. If coordinates have six
// digits, a flat element has a value of about 1e-7.
static const double flat_triangle = 1e-6;
static const double flat_tetrahedron = 1e-8;
static const double diagonal_min_m = 1e-9;
static const double diagonal_max_m = 1e6;

static const double *position_of(const cau_mesh *mesh, int32_t vertex)
{
	CAU_ASSERT_INDEX(vertex, mesh->vertex_count);
	return mesh->position + 3 * (size_t)vertex;
}

static double longest_edge(const cau_mesh *mesh, const int32_t *element, int corners)
{
	double longest = 0;
	for (int i = 0; i < corners; i++)
		for (int j = 0; j < i; j++) {
			double edge[3];
			cau_subtract3(position_of(mesh, element[i]), position_of(mesh, element[j]), edge);
			longest = fmax(longest, cau_dot3(edge, edge));
		}
	CAU_ASSERT(longest > 0, "an element whose %d corners lie on one point", corners);
	return sqrt(longest);
}

// Returns 2 A / L^2 of a triangle.
static double relative_height(const cau_mesh *mesh, const int32_t *t)
{
	double e[2][3], normal[3], longest = longest_edge(mesh, t, 3);
	for (int i = 0; i < 2; i++)
		cau_subtract3(position_of(mesh, t[i + 1]), position_of(mesh, t[0]), e[i]);
	cau_cross3(e[0], e[1], normal);
	return sqrt(cau_dot3(normal, normal)) / (longest * longest);
}

// Returns 6 V / L^3 of a tetrahedron, with its sign.
static double relative_volume(const cau_mesh *mesh, const int32_t *t)
{
	double e[3][3], normal[3], longest = longest_edge(mesh, t, 4);
	for (int i = 0; i < 3; i++)
		cau_subtract3(position_of(mesh, t[i + 1]), position_of(mesh, t[0]), e[i]);
	cau_cross3(e[0], e[1], normal);
	return cau_dot3(normal, e[2]) / (longest * longest * longest);
}

static cau_status check_indices(const char *kind, const int32_t *element, int32_t count,
                                int corners, int32_t vertex_count, cau_error *error)
{
	for (int32_t i = 0; i < count; i++)
		for (int c = 0; c < corners; c++) {
			int32_t vertex = element[(size_t)i * (size_t)corners + (size_t)c];
			if (vertex < 0 || vertex >= vertex_count)
				return cau_fail(error, CAU_BAD_MESH, NULL,
				                "%s %d names vertex %d, but there are %d vertices", kind, i, vertex,
				                vertex_count);
		}
	return CAU_OK;
}

static cau_status check_numbers(const cau_mesh *mesh, cau_error *error)
{
	if (!mesh->triangle_count && !mesh->tetrahedron_count)
		return cau_fail(error, CAU_BAD_MESH, NULL, "the mesh has no triangles and no tetrahedra");
	for (size_t i = 0; i < 3 * (size_t)mesh->vertex_count; i++)
		if (!isfinite(mesh->position[i]))
			return cau_fail(error, CAU_BAD_MESH, NULL, "vertex %zu: its %c is not finite", i / 3,
			                "xyz"[i % 3]);
	cau_status status = check_indices("triangle", mesh->triangle, mesh->triangle_count, 3,
	                                  mesh->vertex_count, error);
	if (!status)
		status = check_indices("tetrahedron", mesh->tetrahedron, mesh->tetrahedron_count, 4,
		                       mesh->vertex_count, error);
	return status;
}

// Replaces the vertex v of every corner by map[v].
static void map_corners(cau_mesh *mesh, const int32_t *map)
{
	for (size_t i = 0; i < 3 * (size_t)mesh->triangle_count; i++)
		mesh->triangle[i] = map[mesh->triangle[i]];
	for (size_t i = 0; i < 4 * (size_t)mesh->tetrahedron_count; i++)
		mesh->tetrahedron[i] = map[mesh->tetrahedron[i]];
}

// Removes vertices that no element uses; the others keep their order. Returns how many were
// removed. `map` is scratch.
static int32_t drop_unused(cau_mesh *mesh, int32_t *map)
{
	memset(map, 0, (size_t)mesh->vertex_count * sizeof *map);
	for (size_t i = 0; i < 3 * (size_t)mesh->triangle_count; i++)
		map[mesh->triangle[i]] = 1;
	for (size_t i = 0; i < 4 * (size_t)mesh->tetrahedron_count; i++)
		map[mesh->tetrahedron[i]] = 1;

	int32_t kept = 0;
	for (int32_t v = 0; v < mesh->vertex_count; v++)
		if (map[v]) {
			memmove(mesh->position + 3 * (size_t)kept, position_of(mesh, v), 3 * sizeof(double));
			map[v] = kept++;
		}
	map_corners(mesh, map);
	int32_t dropped = mesh->vertex_count - kept;
	CAU_ASSERT(dropped >= 0, "%d vertices kept of %d", kept, mesh->vertex_count);
	mesh->vertex_count = kept;
	return dropped;
}

// Checks the bounding diagonal against both limits, and the coordinates against the upper limit.
static cau_status check_bounds(const cau_mesh *mesh, cau_error *error)
{
	double least[3] = {INFINITY, INFINITY, INFINITY}, most[3] = {-INFINITY, -INFINITY, -INFINITY};
	double far = 0;
	for (size_t i = 0; i < 3 * (size_t)mesh->vertex_count; i++) {
		least[i % 3] = fmin(least[i % 3], mesh->position[i]);
		most[i % 3] = fmax(most[i % 3], mesh->position[i]);
		far = fmax(far, fabs(mesh->position[i]));
	}
	double diagonal = hypot(hypot(most[0] - least[0], most[1] - least[1]), most[2] - least[2]);
	if (diagonal == 0)
		return cau_fail(error, CAU_BAD_MESH, NULL, "all vertices lie on one point");
	if (diagonal < diagonal_min_m)
		return cau_fail(error, CAU_BAD_MESH, NULL,
		                "the mesh is %.3g m from corner to corner, less than %.0e m (check unit_m)",
		                diagonal, diagonal_min_m);
	if (!(diagonal <= diagonal_max_m) || !(far <= diagonal_max_m))
		return cau_fail(error, CAU_BAD_MESH, NULL,
		                "the mesh is %.3g m from corner to corner and reaches %.3g m from the "
		                "origin, more than %.0e m (check unit_m)",
		                diagonal, far, diagonal_max_m);
	return CAU_OK;
}

// Merges each vertex into a near vertex of lower index. The position of the lower vertex remains.
static cau_status merge_vertices(cau_mesh *mesh, int32_t *map, int32_t *merged, cau_error *error)
{
	cau_status status = check_bounds(mesh, error);
	if (status)
		return status;
	if (!cau_vertex_merge_near(mesh->position, mesh->vertex_count, map))
		return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for merging vertices");
	map_corners(mesh, map);
	// These are exactly the merged vertices, because all other vertices are used.
	*merged = drop_unused(mesh, map);
	CAU_ASSERT(*merged >= 0 && mesh->vertex_count > 0, "%d vertices merged, %d left", *merged,
	           mesh->vertex_count);
	return CAU_OK;
}

static bool has_corner_twice(const int32_t *element, int corners)
{
	for (int i = 0; i < corners; i++)
		for (int j = 0; j < i; j++)
			if (element[i] == element[j])
				return true;
	return false;
}

// ---- elements to remove are marked, and then removed together
static void keep_triangles(cau_mesh *mesh, const bool *dropped)
{
	size_t kept = 0;
	for (size_t t = 0; t < (size_t)mesh->triangle_count; t++) {
		if (dropped[t])
			continue;
		memmove(mesh->triangle + 3 * kept, mesh->triangle + 3 * t, 3 * sizeof *mesh->triangle);
		mesh->triangle_region[kept] = mesh->triangle_region[t];
		if (mesh->texture)
			memmove(mesh->texture + 6 * kept, mesh->texture + 6 * t, 6 * sizeof *mesh->texture);
		kept++;
	}
	mesh->triangle_count = (int32_t)kept;
}

static void keep_tetrahedra(cau_mesh *mesh, const bool *dropped)
{
	size_t kept = 0;
	for (size_t t = 0; t < (size_t)mesh->tetrahedron_count; t++) {
		if (dropped[t])
			continue;
		memmove(mesh->tetrahedron + 4 * kept, mesh->tetrahedron + 4 * t,
		        4 * sizeof *mesh->tetrahedron);
		mesh->tetrahedron_region[kept++] = mesh->tetrahedron_region[t];
	}
	mesh->tetrahedron_count = (int32_t)kept;
}

static int32_t drop_flat_triangles(cau_mesh *mesh, bool *dropped)
{
	int32_t count = 0;
	for (int32_t i = 0; i < mesh->triangle_count; i++) {
		const int32_t *t = mesh->triangle + 3 * (size_t)i;
		dropped[i] = has_corner_twice(t, 3) || relative_height(mesh, t) < flat_triangle;
		count += dropped[i];
	}
	if (count)
		keep_triangles(mesh, dropped);
	return count;
}

// Removes flat tetrahedra. Turns inverted tetrahedra to positive volume, and counts them in
// *turned.
static int32_t drop_flat_tetrahedra(cau_mesh *mesh, bool *dropped, int32_t *turned)
{
	int32_t count = 0;
	for (int32_t i = 0; i < mesh->tetrahedron_count; i++) {
		int32_t *t = mesh->tetrahedron + 4 * (size_t)i, third = t[2];
		double volume = has_corner_twice(t, 4) ? 0 : relative_volume(mesh, t);
		dropped[i] = fabs(volume) < flat_tetrahedron;
		count += dropped[i];
		if (dropped[i] || volume > 0)
			continue;
		t[2] = t[3];
		t[3] = third;
		++*turned;
	}
	if (count)
		keep_tetrahedra(mesh, dropped);
	return count;
}

static cau_status drop_degenerate(cau_mesh *mesh, cau_mesh_report *done, cau_error *error)
{
	int32_t triangles = mesh->triangle_count, tetrahedra = mesh->tetrahedron_count;
	bool *dropped = cau_mesh_array((size_t)(triangles > tetrahedra ? triangles : tetrahedra), 1);
	if (!dropped)
		return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory to clean a mesh");
	done->degenerate_triangles += drop_flat_triangles(mesh, dropped);
	done->degenerate_tetrahedra += drop_flat_tetrahedra(mesh, dropped, &done->inverted_tetrahedra);
	free(dropped);
	if (!mesh->triangle_count && !mesh->tetrahedron_count)
		return cau_fail(error, CAU_BAD_MESH, NULL,
		                "every element is degenerate: %d flat triangles, %d flat tetrahedra",
		                triangles, tetrahedra);
	return CAU_OK;
}

// Sets flat texture triangles to zero, because they give no material direction. Returns their
// number.
static int32_t drop_flat_textures(cau_mesh *mesh)
{
	int32_t count = 0;
	for (size_t t = 0; t < (size_t)mesh->triangle_count && mesh->texture; t++) {
		if (!cau_texture_is_flat(mesh->texture + 6 * t))
			continue;
		memset(mesh->texture + 6 * t, 0, 6 * sizeof *mesh->texture);
		count++;
	}
	return count;
}

// Marks repeated[i] if an element of lower index has the same vertices. Returns how many are
// marked, or -1 if memory ran out.
static int32_t mark_repeated(const int32_t *element, int32_t count, int corners,
                             int32_t vertex_count, bool *repeated)
{
	size_t row_bytes = (size_t)corners * sizeof(int32_t);
	int32_t *key = cau_mesh_array((size_t)count, row_bytes);
	int32_t *order = cau_mesh_array((size_t)count, sizeof *order);
	int32_t marked = -1;
	if (!key || !order)
		goto done;
	for (size_t i = 0; i < (size_t)count; i++) {
		int32_t *row = key + i * (size_t)corners;
		memcpy(row, element + i * (size_t)corners, row_bytes);
		cau_index_order_row(row, corners);
	}
	if (!cau_index_sort(key, corners, count, vertex_count, order))
		goto done;
	marked = 0;
	for (int32_t i = 0; i < count; i++) {
		const int32_t *row = key + (size_t)order[i] * (size_t)corners;
		CAU_ASSERT_INDEX(order[i], count);
		const int32_t *before = i ? key + (size_t)order[i - 1] * (size_t)corners : NULL;
		repeated[order[i]] = before && !memcmp(row, before, row_bytes);
		marked += repeated[order[i]];
	}
done:
	free(key);
	free(order);
	return marked;
}

// Removes all but the first of the elements that have the same vertices, in any order.
static cau_status drop_repeated(cau_mesh *mesh, int32_t *dropped, cau_error *error)
{
	int32_t most = mesh->triangle_count > mesh->tetrahedron_count ? mesh->triangle_count
	                                                              : mesh->tetrahedron_count;
	bool *repeated = cau_mesh_array((size_t)most, sizeof *repeated);
	int32_t triangles = -1, tetrahedra = -1;
	if (repeated) {
		triangles =
			mark_repeated(mesh->triangle, mesh->triangle_count, 3, mesh->vertex_count, repeated);
		if (triangles > 0)
			keep_triangles(mesh, repeated);
		tetrahedra = mark_repeated(mesh->tetrahedron, mesh->tetrahedron_count, 4,
		                           mesh->vertex_count, repeated);
		if (tetrahedra > 0)
			keep_tetrahedra(mesh, repeated);
	}
	free(repeated);
	if (triangles < 0 || tetrahedra < 0)
		return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for finding repeated elements");
	*dropped = triangles + tetrahedra;
	return CAU_OK;
}

// Marks dropped[i] if a face of tetrahedron i belongs to two kept tetrahedra of lower index. `key`
// has the four faces of each tetrahedron, sorted by `order`. Returns how many are marked.
static int32_t mark_thirds(const int32_t *key, const int32_t *order, int32_t face_count,
                           bool *dropped)
{
	int32_t marked = 0, kept = 0;
	for (int32_t i = 0; i < face_count; i++) {
		const int32_t *face = key + 3 * (size_t)order[i];
		const int32_t *before = i ? key + 3 * (size_t)order[i - 1] : NULL;
		bool *at = &dropped[order[i] / 4];
		if (!before || memcmp(face, before, 3 * sizeof *face) != 0)
			kept = 0;
		if (*at)
			continue;
		*at = kept == 2;
		marked += *at;
		kept += !*at;
	}
	return marked;
}

// Removes tetrahedra beyond the second at a face. At most two tetrahedra can share a face, so
// further ones overlap these two.
static cau_status drop_thirds(cau_mesh *mesh, int32_t *thirds, cau_error *error)
{
	int32_t faces = 4 * mesh->tetrahedron_count;
	int32_t *key = cau_mesh_array((size_t)faces, 3 * sizeof *key);
	int32_t *order = cau_mesh_array((size_t)faces, sizeof *order);
	bool *dropped = cau_mesh_array((size_t)mesh->tetrahedron_count, sizeof *dropped);
	cau_status status = CAU_OK;
	for (int32_t f = 0; f < faces && key; f++) {
		int32_t *row = key + 3 * (size_t)f;
		for (int c = 0, n = 0; c < 4; c++)
			if (c != f % 4)
				row[n++] = mesh->tetrahedron[4 * (size_t)(f / 4) + (size_t)c];
		cau_index_order_row(row, 3);
	}
	if (!key || !order || !dropped || !cau_index_sort(key, 3, faces, mesh->vertex_count, order)) {
		status = cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for the faces of a mesh");
	} else {
		memset(dropped, 0, (size_t)mesh->tetrahedron_count * sizeof *dropped);
		int32_t marked = mark_thirds(key, order, faces, dropped);
		*thirds += marked;
		if (marked)
			keep_tetrahedra(mesh, dropped);
	}
	free(key);
	free(order);
	free(dropped);
	return status;
}

cau_status cau_mesh_clean(cau_mesh *mesh, cau_mesh_report *report, cau_error *error)
{
	cau_mesh_report unwanted = {0}, *done = report ? report : &unwanted;
	int32_t unused = 0, repeated = 0;
	int32_t *map = cau_mesh_array((size_t)mesh->vertex_count, sizeof *map);
	if (!map)
		return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory to clean a mesh");

	cau_status status = check_numbers(mesh, error);
	if (!status) {
		done->unused_vertices += drop_unused(mesh, map);
		status = merge_vertices(mesh, map, &done->duplicate_vertices, error);
	}
	if (!status)
		status = drop_degenerate(mesh, done, error);
	if (!status)
		status = drop_repeated(mesh, &repeated, error);
	if (!status)
		status = drop_thirds(mesh, &done->third_tetrahedra, error);
	if (!status)
		unused = drop_unused(mesh, map); // vertices of removed elements
	if (!status)                         // the remaining mesh may be far smaller than before
		status = check_bounds(mesh, error);
	done->unused_vertices += unused;
	done->duplicate_elements += repeated;
	if (!status)
		done->degenerate_textures += drop_flat_textures(mesh);
	free(map);
	return status;
}
