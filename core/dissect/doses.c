// SPDX-License-Identifier: GPL-3.0-or-later
// The second rule of parting: each triangle and tetrahedron parts by the dose at its middle.
//
// An edge that parts removes all elements at the edge. So the cut is wider than the burnt tissue by
// half a cell on all sides of the instrument. And as each edge has its own random ignition
// temperature, fraying depends on the mesh. With this rule an element is one point of quadrature,
// as for its strain. It parts by the dose (eq. 20) at its middle. The ignition temperature is drawn
// from a field over rest space. So the removed volume tends to the volume that the hot part has
// swept and burnt, whatever the mesh. Of the elements that the cut's surface crosses, half are
// removed.
//
// A hot part thinner than the elements would pass between their middles. So the hot part is widened
// to at least what the mesh can resolve (half_width_of).
#include "cautery/assert.h"
#include "dissect/dissection_internal.h"

// Length, m, over which the ignition temperature changes if the layer has no bundles.
static const double field_m = 1e-3;

enum { KINDS = CAU_PRIMITIVE_LINK }; // the kinds that have doses: triangles and tetrahedra

static int32_t count_of(const cau_tissue *tissue)
{
	return tissue->triangle_count + tissue->tetrahedron_count;
}

int32_t cau_dissection_dose_count(const cau_dissection *dissection)
{
	return dissection->doses.dose ? count_of(dissection->tissue) : 0;
}

static cau_vec3 middle_of(const cau_tissue *tissue, int primitive, int32_t index,
                          const double *position)
{
	int count;
	const int32_t *vertex = cau_tissue_vertices_of(tissue, primitive, index, &count);
	cau_vec3 sum = {0, 0, 0};
	for (int i = 0; i < count; i++)
		sum = cau_add(sum, cau_vec3_of(position + 3 * (size_t)vertex[i]));
	return cau_scale(1.0 / count, sum);
}

// Returns half the width of the thinnest cut that the element can resolve, m. For a triangle this
// is the longest distance of a vertex from the triangle's middle. Suppose that two triangles on
// either side of a cut still share a vertex. Then the cut passes within this distance of the middle
// of one of the triangles, and that triangle parts. A tetrahedron is taken to be regular, because
// no path of a tip divides a body.
static double half_width_of(const cau_tissue *tissue, int primitive, int32_t index)
{
	if (primitive == CAU_PRIMITIVE_TETRAHEDRON) {
		double edge = cbrt(6 * M_SQRT2 * tissue->tetrahedron_volume[index]);
		return sqrt(3.0 / 8) * edge;
	}
	cau_vec3 middle = middle_of(tissue, primitive, index, tissue->rest);
	double farthest = 0;
	for (int i = 0; i < 3; i++) {
		int32_t v = tissue->triangle[3 * (size_t)index + (size_t)i];
		cau_vec3 vertex = cau_vec3_of(tissue->rest + 3 * (size_t)v);
		farthest = fmax(farthest, cau_length(cau_sub(vertex, middle)));
	}
	return farthest;
}

cau_status cau_doses_create(cau_doses *doses, const cau_tissue *tissue, cau_arena *arena,
                            cau_error *error)
{
	size_t count = (size_t)count_of(tissue);
	doses->dose = cau_arena_array(arena, count, sizeof *doses->dose);
	doses->gone = cau_arena_array(arena, count, sizeof *doses->gone);
	doses->touched = cau_arena_array(arena, count, sizeof *doses->touched);
	doses->touched_mark = cau_arena_array(arena, count, sizeof *doses->touched_mark);
	if (!doses->dose || !doses->gone || !doses->touched || !doses->touched_mark)
		return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for the doses of elements");
	for (int32_t t = 0; t < tissue->triangle_count; t++)
		doses->widest_m = fmax(doses->widest_m, half_width_of(tissue, CAU_PRIMITIVE_TRIANGLE, t));
	for (int32_t t = 0; t < tissue->tetrahedron_count; t++)
		doses->widest_m =
			fmax(doses->widest_m, half_width_of(tissue, CAU_PRIMITIVE_TETRAHEDRON, t));
	return CAU_OK;
}

void cau_doses_begin(cau_doses *doses)
{
	for (int32_t k = 0; k < doses->touched_count; k++)
		doses->touched_mark[doses->touched[k]] = 0;
	doses->touched_count = 0;
}

// ---- exposure
typedef struct exposing {
	cau_dissection *dissection;
	const double *position;
	const cau_heat_grid *grid;
	const cau_tool_def *tool;
	const cau_pose *pose;
	double jaw, duration_s;
	cau_vec3 center; // centre of a ball around the hot part
	double radius, thinnest_m;
} exposing;

// Returns the length, m, by which the hot part is enlarged for elements of this half width.
static double widening(const exposing *work, double half_width_m)
{
	return fmax(half_width_m - work->thinnest_m, 0);
}

static void expose_element(const exposing *work, int primitive, int32_t index)
{
	const cau_tissue *tissue = work->dissection->tissue;
	cau_doses *doses = &work->dissection->doses;
	cau_vec3 middle = middle_of(tissue, primitive, index, work->position);
	cau_vec3 off = cau_sub(middle, work->center);
	double reach = work->radius + widening(work, doses->widest_m);
	if (cau_dot(off, off) > reach * reach)
		return;
	cau_vec3 outward;
	double distance =
		cau_tool_distance_at(work->tool, work->pose, work->jaw, CAU_PART_HOT, middle, &outward);
	if (distance > widening(work, half_width_of(tissue, primitive, index)))
		return;
	// In the space by which it is enlarged, the hot part is as warm as at its surface.
	double u = cau_heat_grid_at(work->grid, cau_add_scaled(middle, -fmax(distance, 0), outward));
	if (u <= CAU_LIVING_C)
		return;
	int32_t place = cau_doses_place(tissue, primitive, index);
	doses->dose[place] += u * work->duration_s;
	if (!doses->touched_mark[place]) {
		doses->touched_mark[place] = 1;
		CAU_ASSERT_INDEX(doses->touched_count, count_of(tissue));
		doses->touched[doses->touched_count++] = place;
	}
}

// True if the edge is the first of the element: the edge between its two lowest vertex indices.
// Every block of the broad phase that owns the lowest vertex owns this edge, and its box contains
// the whole element.
static bool is_first_edge(const int32_t *ends, const int32_t *vertex, int count)
{
	for (int i = 0; i < count; i++)
		if (vertex[i] < ends[1] && vertex[i] != ends[0])
			return false;
	return true;
}

static void expose_sharers(const exposing *work, int32_t edge)
{
	const cau_tissue *tissue = work->dissection->tissue;
	const cau_edge_table *edges = &tissue->edges;
	const int32_t *ends = edges->vertex + 2 * (size_t)edge;
	CAU_ASSERT(ends[0] < ends[1], "edge %d goes from %d to %d", edge, ends[0], ends[1]);
	for (int p = 0; p < KINDS; p++)
		for (int32_t k = edges->first[p][edge]; k < edges->first[p][edge + 1]; k++) {
			int32_t index = edges->sharer[p][k];
			int count;
			const int32_t *vertex = cau_tissue_vertices_of(tissue, p, index, &count);
			if (is_first_edge(ends, vertex, count) &&
			    cau_dissection_lives(work->dissection, p, index))
				expose_element(work, p, index);
		}
}

void cau_doses_expose(cau_dissection *dissection, const cau_near *near, const double *position,
                      const cau_heat_grid *grid, const cau_tool_def *tool, const cau_pose *pose,
                      double jaw, double duration_s)
{
	exposing work = {dissection, position, grid, tool, pose, jaw, duration_s, {0, 0, 0}, 0, 0};
	cau_tool_bound(tool, CAU_PART_HOT, &work.center, &work.radius);
	work.center = cau_pose_to_world(pose, work.center);
	work.thinnest_m = cau_tool_thinnest_hot_m(tool);
	double reach = work.radius + widening(&work, dissection->doses.widest_m);
	for (int32_t block = 0; block < near->block_count; block++)
		if (cau_box_meets(&near->edge_box[block], work.center, reach))
			for (int32_t k = near->edge_first[block]; k < near->edge_first[block + 1]; k++)
				expose_sharers(&work, near->edge[k]);
}

// ---- parting
static double ignition_of(const cau_dissection *dissection, int primitive, int32_t index)
{
	const cau_tissue *tissue = dissection->tissue;
	const cau_heat_material *heat = cau_dissection_heat_of(tissue, primitive, index);
	int32_t layer = cau_tissue_layer_of(tissue, primitive, index);
	cau_vec3 fibre = cau_unit_or(cau_vec3_of(tissue->layer[layer].def.fibre), (cau_vec3){1, 0, 0});
	return cau_ignition_in_bundles(heat->ignition_c, heat->ignition_spread_c, dissection->seed,
	                               layer, middle_of(tissue, primitive, index, tissue->rest), fibre,
	                               heat->ignition_bundle_m > 0 ? heat->ignition_bundle_m : field_m);
}

// Parts an edge in a layer once no live element of the layer is left at the edge.
static void lose_edge_between(cau_dissection *dissection, int32_t a, int32_t b, int32_t layer)
{
	const cau_tissue *tissue = dissection->tissue;
	const cau_edge_table *edges = &tissue->edges;
	int32_t edge = cau_edge_table_find(edges, a, b);
	CAU_ASSERT(edge >= 0, "no edge between %d and %d", a, b);
	cau_dissection_touch(dissection, edge);
	for (int p = 0; p < CAU_PRIMITIVE_KINDS; p++)
		for (int32_t k = edges->first[p][edge]; k < edges->first[p][edge + 1]; k++)
			if (cau_tissue_layer_of(tissue, p, edges->sharer[p][k]) == layer &&
			    cau_dissection_lives(dissection, p, edges->sharer[p][k]))
				return;
	cau_dissection_lose_edge(dissection, edge, (uint16_t)(1u << layer));
}

void cau_doses_lose(cau_dissection *dissection, int primitive, int32_t index)
{
	const cau_tissue *tissue = dissection->tissue;
	int32_t layer = cau_tissue_layer_of(tissue, primitive, index);
	dissection->doses.gone[cau_doses_place(tissue, primitive, index)] = 1;
	cau_dissection_remove(dissection, primitive, index);
	int count;
	const int32_t *vertex = cau_tissue_vertices_of(tissue, primitive, index, &count);
	for (int i = 0; i < count; i++)
		for (int j = 0; j < i; j++)
			lose_edge_between(dissection, vertex[i], vertex[j], layer);
}

static void part_element(cau_dissection *dissection, int32_t place, uint32_t *layers)
{
	const cau_tissue *tissue = dissection->tissue;
	bool is_triangle = place < tissue->triangle_count;
	int primitive = is_triangle ? CAU_PRIMITIVE_TRIANGLE : CAU_PRIMITIVE_TETRAHEDRON;
	int32_t index = is_triangle ? place : place - tissue->triangle_count;
	double absorption = cau_dissection_heat_of(tissue, primitive, index)->absorption_per_s;
	if (dissection->doses.gone[place] ||
	    absorption * dissection->doses.dose[place] <= ignition_of(dissection, primitive, index))
		return;
	*layers |= 1u << cau_tissue_layer_of(tissue, primitive, index);
	cau_doses_lose(dissection, primitive, index);
}

void cau_doses_part(cau_dissection *dissection, uint32_t *layers)
{
	const cau_doses *doses = &dissection->doses;
	for (int32_t k = 0; k < doses->touched_count; k++)
		part_element(dissection, doses->touched[k], layers);
}
