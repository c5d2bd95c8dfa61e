// SPDX-License-Identifier: GPL-3.0-or-later
// The cleaning that real files need, before anything is computed on a mesh.
#include <math.h>
#include <string.h>

#include "cautery/assert.h"
#include "mesh/index_sort.h"
#include "mesh/mesh_memory.h"
#include "mesh/vertex_merge.h"

// Flat, relative to the longest edge L: a triangle's height 2 A / L^2, and a tetrahedron's
// 6 V / L^3. Coordinates written with six digits make flat elements come out near 1e-7.
static const double flat_triangle = 1e-6;
static const double flat_tetrahedron = 1e-8;
static const double merge_distance = 1e-9; // of the bounding diagonal
static const double diagonal_min_m = 1e-9;
static const double diagonal_max_m = 1e6;

static const double *position_of(const cau_mesh *mesh, int32_t vertex)
{
	CAU_ASSERT_INDEX(vertex, mesh->vertex_count);
	return mesh->position + 3 * (size_t)vertex;
}

static void subtract(const double *a, const double *b, double out[3])
{
	for (int c = 0; c < 3; c++)
		out[c] = a[c] - b[c];
}

static void cross(const double a[3], const double b[3], double out[3])
{
	for (int c = 0; c < 3; c++)
		out[c] = a[(c + 1) % 3] * b[(c + 2) % 3] - a[(c + 2) % 3] * b[(c + 1) % 3];
}

static double dot(const double a[3], const double b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static double longest_edge(const cau_mesh *mesh, const int32_t *element, int corners)
{
	double longest = 0;
	for (int i = 0; i < corners; i++)
		for (int j = 0; j < i; j++) {
			double edge[3];
			subtract(position_of(mesh, element[i]), position_of(mesh, element[j]), edge);
			longest = fmax(longest, dot(edge, edge));
		}
	CAU_ASSERT(longest > 0, "an element whose %d corners lie on one point", corners);
	return sqrt(longest);
}

// 2 A / L^2 of a triangle of three vertices.
static double relative_height(const cau_mesh *mesh, const int32_t *t)
{
	double e[2][3], normal[3], longest = longest_edge(mesh, t, 3);
	for (int i = 0; i < 2; i++)
		subtract(position_of(mesh, t[i + 1]), position_of(mesh, t[0]), e[i]);
	cross(e[0], e[1], normal);
	return sqrt(dot(normal, normal)) / (longest * longest);
}

// 6 V / L^3 of a tetrahedron of four vertices, with its sign.
static double relative_volume(const cau_mesh *mesh, const int32_t *t)
{
	double e[3][3], normal[3], longest = longest_edge(mesh, t, 4);
	for (int i = 0; i < 3; i++)
		subtract(position_of(mesh, t[i + 1]), position_of(mesh, t[0]), e[i]);
	cross(e[0], e[1], normal);
	return dot(normal, e[2]) / (longest * longest * longest);
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
	for (size_t i = 0; mesh->texture && i < 6 * (size_t)mesh->triangle_count; i++)
		if (!isfinite(mesh->texture[i]))
			return cau_fail(error, CAU_BAD_MESH, NULL,
			                "triangle %zu: a texture coordinate is not finite", i / 6);
	cau_status status = check_indices("triangle", mesh->triangle, mesh->triangle_count, 3,
	                                  mesh->vertex_count, error);
	if (!status)
		status = check_indices("tetrahedron", mesh->tetrahedron, mesh->tetrahedron_count, 4,
		                       mesh->vertex_count, error);
	return status;
}

// Applies map (old vertex to new) to every corner.
static void map_corners(cau_mesh *mesh, const int32_t *map)
{
	for (size_t i = 0; i < 3 * (size_t)mesh->triangle_count; i++)
		mesh->triangle[i] = map[mesh->triangle[i]];
	for (size_t i = 0; i < 4 * (size_t)mesh->tetrahedron_count; i++)
		mesh->tetrahedron[i] = map[mesh->tetrahedron[i]];
}

// Keeps the vertices that a corner names, in their order. Returns how many went. `map` is scratch.
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

typedef struct bounds {
	double least[3];
	double most[3];
	double diagonal;
} bounds;

static bounds bounds_of(const cau_mesh *mesh)
{
	CAU_ASSERT(mesh->vertex_count > 0, "the box of %d vertices", mesh->vertex_count);
	bounds b;
	double extent[3];
	for (int c = 0; c < 3; c++)
		b.least[c] = b.most[c] = mesh->position[c];
	for (size_t i = 3; i < 3 * (size_t)mesh->vertex_count; i++) {
		b.least[i % 3] = fmin(b.least[i % 3], mesh->position[i]);
		b.most[i % 3] = fmax(b.most[i % 3], mesh->position[i]);
	}
	subtract(b.most, b.least, extent);
	b.diagonal = hypot(hypot(extent[0], extent[1]), extent[2]);
	return b;
}

static cau_status check_bounds(const bounds *b, cau_error *error)
{
	double far = 0;
	for (int c = 0; c < 3; c++)
		far = fmax(far, fmax(fabs(b->least[c]), fabs(b->most[c])));
	if (b->diagonal == 0)
		return cau_fail(error, CAU_BAD_MESH, NULL, "all vertices lie on one point");
	if (b->diagonal < diagonal_min_m)
		return cau_fail(error, CAU_BAD_MESH, NULL,
		                "the mesh is %.3g m from corner to corner, less than %.0e m (is its unit "
		                "right?)",
		                b->diagonal, diagonal_min_m);
	if (!(b->diagonal <= diagonal_max_m) || !(far <= diagonal_max_m))
		return cau_fail(error, CAU_BAD_MESH, NULL,
		                "the mesh is %.3g m from corner to corner and reaches %.3g m from the "
		                "origin, more than %.0e m (is its unit right?)",
		                b->diagonal, far, diagonal_max_m);
	return CAU_OK;
}

// Lets every vertex near one of a lower number become that one. The position stays the lower one's.
static cau_status merge_vertices(cau_mesh *mesh, int32_t *map, int32_t *merged, cau_error *error)
{
	bounds b = bounds_of(mesh);
	cau_status status = check_bounds(&b, error);
	if (status)
		return status;
	if (!cau_vertex_merge(mesh->position, mesh->vertex_count, b.least, merge_distance * b.diagonal,
	                      map))
		return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for merging vertices");
	map_corners(mesh, map);
	*merged = drop_unused(mesh, map); // exactly the merged ones: all the rest are used
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

static cau_status refuse_degenerate(const char *kind, int32_t number, const char *why,
                                    cau_error *error)
{
	return cau_fail(error, CAU_BAD_MESH, NULL, "%s %d (counted from 0) is degenerate: %s", kind,
	                number, why);
}

static const char *const coincide = "two of its corners coincide";

static cau_status check_triangles(const cau_mesh *mesh, cau_error *error)
{
	for (int32_t i = 0; i < mesh->triangle_count; i++) {
		const int32_t *t = mesh->triangle + 3 * (size_t)i;
		if (has_corner_twice(t, 3))
			return refuse_degenerate("triangle", i, coincide, error);
		double height = relative_height(mesh, t);
		if (height < flat_triangle) {
			char why[120];
			snprintf(why, sizeof why, "its height is %.2g of its longest edge, less than %.0e",
			         height, flat_triangle);
			return refuse_degenerate("triangle", i, why, error);
		}
	}
	return CAU_OK;
}

// Also turns inverted ones to positive volume, and counts them.
static cau_status turn_tetrahedra(cau_mesh *mesh, int32_t *turned, cau_error *error)
{
	for (int32_t i = 0; i < mesh->tetrahedron_count; i++) {
		int32_t *t = mesh->tetrahedron + 4 * (size_t)i;
		if (has_corner_twice(t, 4))
			return refuse_degenerate("tetrahedron", i, coincide, error);
		double volume = relative_volume(mesh, t);
		if (fabs(volume) < flat_tetrahedron) {
			char why[120];
			snprintf(why, sizeof why,
			         "six volumes are %.2g of the cube of its longest edge, less than %.0e",
			         fabs(volume), flat_tetrahedron);
			return refuse_degenerate("tetrahedron", i, why, error);
		}
		if (volume < 0) {
			int32_t third = t[2];
			t[2] = t[3];
			t[3] = third;
			++*turned;
		}
	}
	return CAU_OK;
}

// Marks repeated[i] where an element of a lower number has the same vertices. Returns how many, or
// -1 when memory ran out.
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

static void keep_triangles(cau_mesh *mesh, const bool *repeated)
{
	size_t kept = 0;
	for (size_t t = 0; t < (size_t)mesh->triangle_count; t++) {
		if (repeated[t])
			continue;
		memmove(mesh->triangle + 3 * kept, mesh->triangle + 3 * t, 3 * sizeof *mesh->triangle);
		mesh->triangle_region[kept] = mesh->triangle_region[t];
		if (mesh->texture)
			memmove(mesh->texture + 6 * kept, mesh->texture + 6 * t, 6 * sizeof *mesh->texture);
		kept++;
	}
	mesh->triangle_count = (int32_t)kept;
	CAU_ASSERT(mesh->triangle_count > 0, "all triangles repeat %d others", mesh->triangle_count);
}

static void keep_tetrahedra(cau_mesh *mesh, const bool *repeated)
{
	size_t kept = 0;
	for (size_t t = 0; t < (size_t)mesh->tetrahedron_count; t++) {
		if (repeated[t])
			continue;
		memmove(mesh->tetrahedron + 4 * kept, mesh->tetrahedron + 4 * t,
		        4 * sizeof *mesh->tetrahedron);
		mesh->tetrahedron_region[kept++] = mesh->tetrahedron_region[t];
	}
	mesh->tetrahedron_count = (int32_t)kept;
	CAU_ASSERT(mesh->tetrahedron_count > 0, "all tetrahedra repeat %d others",
	           mesh->tetrahedron_count);
}

// Keeps the first of elements with the same vertices, whatever their order.
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

cau_status cau_mesh_clean(cau_mesh *mesh, cau_mesh_report *report, cau_error *error)
{
	cau_mesh_report done = {0};
	int32_t *map = cau_mesh_array((size_t)mesh->vertex_count, sizeof *map);
	if (!map)
		return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for cleaning a mesh");

	cau_status status = check_numbers(mesh, error);
	if (!status) {
		done.unused_vertices = drop_unused(mesh, map);
		status = merge_vertices(mesh, map, &done.duplicate_vertices, error);
	}
	if (!status)
		status = check_triangles(mesh, error);
	if (!status)
		status = turn_tetrahedra(mesh, &done.inverted_tetrahedra, error);
	if (!status)
		status = drop_repeated(mesh, &done.duplicate_elements, error);
	free(map);
	if (report)
		*report = done;
	return status;
}
