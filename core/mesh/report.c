// SPDX-License-Identifier: GPL-3.0-or-later
#include "mesh/mesh_builder.h"

#include <math.h>
#include <string.h>

#include "cautery/assert.h"
#include "mesh/edge_table.h"
#include "mesh/geometry.h"
#include "mesh/mesh.h"

// ---- regions
// Returns the index of a region in the ascending list. If the region is not in the list, returns
// the index at which it would be inserted.
static int32_t place_of(const cau_mesh_region *list, int32_t count, int32_t dimension,
                        int32_t region)
{
	int32_t low = 0, high = count;
	while (low < high) {
		int32_t middle = low + (high - low) / 2;
		const cau_mesh_region *at = &list[middle];
		bool before = at->dimension != dimension ? at->dimension < dimension : at->region < region;
		low = before ? middle + 1 : low;
		high = before ? high : middle;
	}
	return low;
}

static bool is_at(const cau_mesh_region *list, int32_t count, int32_t place, int32_t dimension,
                  int32_t region)
{
	return place < count && list[place].dimension == dimension && list[place].region == region;
}

// Counts the elements of one dimension by region. If the list is full, each run of elements of an
// unlisted region counts as one more region.
static void count_regions(const int32_t *region, int32_t count, int32_t dimension,
                          cau_mesh_report *report)
{
	cau_mesh_region *list = report->region;
	int32_t listed =
		report->region_count < CAU_MESH_REGION_MAX ? report->region_count : CAU_MESH_REGION_MAX;
	int32_t place = -1;
	for (int32_t i = 0; i < count; i++) {
		if (place >= 0 && is_at(list, listed, place, dimension, region[i])) {
			list[place].element_count++;
			continue;
		}
		place = place_of(list, listed, dimension, region[i]);
		if (!is_at(list, listed, place, dimension, region[i])) {
			if (listed == CAU_MESH_REGION_MAX) {
				report->region_count += i == 0 || region[i] != region[i - 1];
				continue;
			}
			memmove(list + place + 1, list + place, (size_t)(listed - place) * sizeof *list);
			list[place] = (cau_mesh_region){.dimension = dimension, .region = region[i]};
			report->region_count = ++listed;
		}
		list[place].element_count++;
	}
}

static void count_all(const cau_mesh *mesh, cau_mesh_report *report)
{
	count_regions(mesh->triangle_region, mesh->triangle_count, 2, report);
	count_regions(mesh->tetrahedron_region, mesh->tetrahedron_count, 3, report);
}

// Copies a name without the quotes around it. Characters that cannot be printed become '?'.
static void copy_name(cau_word word, char name[static CAU_MESH_NAME_BYTES])
{
	if (word.length >= 2 && word.text[0] == '"' && word.text[word.length - 1] == '"') {
		word.text++;
		word.length -= 2;
	}
	size_t length = word.length < CAU_MESH_NAME_BYTES - 1 ? word.length : CAU_MESH_NAME_BYTES - 1;
	for (size_t i = 0; i < length; i++)
		name[i] = (char)(word.text[i] >= ' ' && word.text[i] <= '~' ? word.text[i] : '?');
	name[length] = 0;
}

void cau_mesh_report_regions(const cau_mesh_builder *builder, cau_mesh_report *report)
{
	count_all(&builder->mesh, report);
	int32_t listed =
		report->region_count < CAU_MESH_REGION_MAX ? report->region_count : CAU_MESH_REGION_MAX;
	for (int32_t i = 0; i < builder->name_count; i++) {
		const cau_region_name *named = &builder->name[i];
		for (int32_t dimension = 2; dimension <= 3; dimension++) {
			int32_t place = place_of(report->region, listed, dimension, named->region);
			if ((!named->dimension || named->dimension == dimension) &&
			    is_at(report->region, listed, place, dimension, named->region))
				copy_name(named->name, report->region[place].name);
		}
	}
}

// Counts the elements of the regions again after repairs. Removes regions without elements.
static void recount_regions(const cau_mesh *mesh, cau_mesh_report *report)
{
	int32_t listed =
		report->region_count < CAU_MESH_REGION_MAX ? report->region_count : CAU_MESH_REGION_MAX;
	for (int32_t i = 0; i < listed; i++)
		report->region[i].element_count = 0;
	report->region_count = listed;
	count_all(mesh, report);
	int32_t kept = 0;
	for (int32_t i = 0; i < listed; i++)
		if (report->region[i].element_count)
			report->region[kept++] = report->region[i];
	report->region_count -= listed - kept;
}

// ---- components
static int32_t root_of(int32_t *parent, int32_t vertex)
{
	while (parent[vertex] != vertex) {
		parent[vertex] = parent[parent[vertex]];
		vertex = parent[vertex];
	}
	return vertex;
}

// Counts the connected components of the elements. `parent` is scratch for a union-find over the
// vertices.
static int32_t count_components(const int32_t *element, int32_t count, int corners,
                                int32_t vertex_count, int32_t *parent)
{
	int32_t components = 0;
	for (int32_t v = 0; v < vertex_count; v++)
		parent[v] = -1; // the vertex belongs to no element yet
	for (size_t i = 0; i < (size_t)count * (size_t)corners; i++)
		if (parent[element[i]] < 0) {
			parent[element[i]] = element[i];
			components++;
		}
	for (size_t i = 0; i < (size_t)count; i++)
		for (int c = 1; c < corners; c++) {
			const int32_t *corner = element + i * (size_t)corners;
			int32_t a = root_of(parent, corner[0]), b = root_of(parent, corner[c]);
			components -= a != b;
			parent[a > b ? a : b] = a > b ? b : a;
		}
	return components;
}

// ---- surface

// Adds the vector area of an open edge to the sum of its hole. The sum over all edges around a hole
// is the vector area of the hole, for any origin.
static void add_to_hole(const cau_mesh *mesh, const cau_edge_table *edges, int32_t e,
                        int32_t *parent, double *hole)
{
	const double *x = mesh->position;
	const int32_t *end = edges->vertex + 2 * (size_t)e;
	const int32_t *t =
		mesh->triangle +
		3 * (size_t)edges->sharer[CAU_PRIMITIVE_TRIANGLE][edges->first[CAU_PRIMITIVE_TRIANGLE][e]];
	double turn = 1, area[3], from[2][3];
	for (int k = 0; k < 3; k++)
		turn = t[k] == end[1] && t[(k + 1) % 3] == end[0] ? -1 : turn;
	for (int k = 0; k < 2; k++) // the first vertex of the mesh is the origin, for accuracy
		cau_subtract3(x + 3 * (size_t)end[k], x, from[k]);
	cau_cross3(from[0], from[1], area);
	for (int c = 0; c < 3; c++)
		hole[3 * (size_t)root_of(parent, end[0]) + (size_t)c] += turn * area[c] / 2;
}

static bool is_open(const cau_edge_table *edges, int32_t e)
{
	const int32_t *first = edges->first[CAU_PRIMITIVE_TRIANGLE];
	return first[e + 1] - first[e] == 1;
}

// Returns the total area of the holes over the area of the surface.
static double measure_opening(const cau_mesh *mesh, const cau_edge_table *edges, int32_t *parent,
                              double *hole)
{
	double open = 0, all = 0;
	for (int32_t v = 0; v < mesh->vertex_count; v++)
		parent[v] = v;
	for (int32_t e = 0; e < edges->edge_count; e++) {
		const int32_t *end = edges->vertex + 2 * (size_t)e;
		if (is_open(edges, e))
			parent[root_of(parent, end[0])] = root_of(parent, end[1]);
	}
	for (int32_t e = 0; e < edges->edge_count; e++)
		if (is_open(edges, e))
			add_to_hole(mesh, edges, e, parent, hole);
	for (size_t v = 0; v < (size_t)mesh->vertex_count; v++)
		open += sqrt(cau_dot3(hole + 3 * v, hole + 3 * v));
	for (size_t t = 0; t < (size_t)mesh->triangle_count; t++) {
		double normal[3];
		cau_triangle_normal(mesh->position, mesh->triangle + 3 * t, normal);
		all += sqrt(cau_dot3(normal, normal)) / 2;
	}
	return all > 0 ? open / all : 1;
}

static cau_status measure_rim(const cau_mesh *mesh, cau_mesh_report *report, cau_error *error)
{
	cau_primitives triangles = {.vertex_count = mesh->vertex_count,
	                            .triangle_count = mesh->triangle_count,
	                            .triangle = mesh->triangle};
	cau_edge_table edges;
	int32_t *layer = cau_mesh_array((size_t)mesh->triangle_count, sizeof *layer);
	int32_t *parent = cau_mesh_array((size_t)mesh->vertex_count, sizeof *parent);
	double *hole = cau_mesh_array((size_t)mesh->vertex_count, 3 * sizeof *hole);
	cau_status status = layer && parent && hole
	                        ? cau_edge_table_make(&triangles, layer, &edges, error)
	                        : cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for the edges");
	for (int32_t e = 0; !status && e < edges.edge_count; e++)
		report->open_edge_count += is_open(&edges, e);
	if (!status) {
		report->opening = measure_opening(mesh, &edges, parent, hole);
		cau_edge_table_finish(&edges);
	}
	free(layer);
	free(parent);
	free(hole);
	return status;
}

// ---- quality
static void count_quality(double quality, cau_mesh_report *report)
{
	int bin = (int)(quality * CAU_MESH_QUALITY_BINS);
	report->quality[bin < 0 ? 0 : bin < CAU_MESH_QUALITY_BINS ? bin : CAU_MESH_QUALITY_BINS - 1]++;
	report->least_quality = fmin(report->least_quality, quality);
}

// Measures quality as the mean ratio: Liu and Joe, "Relationship between tetrahedron shape
// measures" (1994). A triangle has the corresponding ratio, 4 sqrt(3) A over the sum of the squares
// of its edges.
static void measure_quality(const cau_mesh *mesh, cau_mesh_report *report)
{
	const double *x = mesh->position;
	bool solid = mesh->tetrahedron_count > 0;
	double squares = 0; // sum of the squares of all edges, m^2
	report->least_quality = 1;
	for (size_t i = 0; i < (size_t)mesh->tetrahedron_count; i++) {
		const int32_t *t = mesh->tetrahedron + 4 * i;
		double volume = fabs(cau_tetrahedron_volume6(x, t)) / 6;
		double own = cau_edge_squares(x, t, 4);
		count_quality(12 * pow(3 * volume, 2.0 / 3.0) / own, report);
		squares += own;
	}
	for (size_t i = 0; i < (size_t)mesh->triangle_count && !solid; i++) {
		const int32_t *t = mesh->triangle + 3 * i;
		double normal[3];
		cau_triangle_normal(x, t, normal);
		double own = cau_edge_squares(x, t, 3);
		count_quality(2 * sqrt(3) * sqrt(cau_dot3(normal, normal)) / own, report);
		squares += own;
	}
	report->mean_edge_m =
		sqrt(squares / (solid ? 6.0 * mesh->tetrahedron_count : 3.0 * mesh->triangle_count));
}

// ---- size
static void measure_size(const cau_mesh *mesh, double unit_m, cau_mesh_report *report)
{
	double longest_m = 0;
	for (size_t c = 0; c < 3; c++) {
		report->least_m[c] = INFINITY;
		report->most_m[c] = -INFINITY;
		for (size_t v = 0; v < (size_t)mesh->vertex_count; v++) {
			report->least_m[c] = fmin(report->least_m[c], mesh->position[3 * v + c]);
			report->most_m[c] = fmax(report->most_m[c], mesh->position[3 * v + c]);
		}
		longest_m = fmax(longest_m, report->most_m[c] - report->least_m[c]);
	}
	report->unit_m = unit_m;
	report->proposed_unit_m =
		cau_is_tissue_size(longest_m) ? 0 : cau_guess_unit(longest_m / unit_m);
}

cau_status cau_mesh_report_measure(const cau_mesh *mesh, double unit_m, cau_mesh_report *report,
                                   cau_error *error)
{
	CAU_ASSERT(mesh->vertex_count > 0, "a report of %d vertices", mesh->vertex_count);
	report->vertex_count = mesh->vertex_count;
	report->triangle_count = mesh->triangle_count;
	report->tetrahedron_count = mesh->tetrahedron_count;
	bool solid = mesh->tetrahedron_count > 0;
	int32_t *parent = cau_mesh_array((size_t)mesh->vertex_count, sizeof *parent);
	if (!parent)
		return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for the report of a mesh");
	report->component_count =
		count_components(solid ? mesh->tetrahedron : mesh->triangle,
	                     solid ? mesh->tetrahedron_count : mesh->triangle_count, solid ? 4 : 3,
	                     mesh->vertex_count, parent);
	free(parent);
	recount_regions(mesh, report);
	measure_quality(mesh, report);
	measure_size(mesh, unit_m, report);
	report->open_edge_count = 0;
	report->opening = 0;
	return solid ? CAU_OK : measure_rim(mesh, report, error);
}
