// SPDX-License-Identifier: GPL-3.0-or-later
#include "vessel/blood.h"

#include <math.h>
#include <string.h>

#include "cautery/assert.h"

// Depth of blood, m, up to which the film does not flow, because it clings to wet tissue. No
// measurement was found. The value has the order of the liquid layer that stays on a drained wall.
static const double clinging_m = 5e-5;
// Greatest depth of blood, m; more drips off. It is the height of a drop on a level surface that
// the drop half wets: sqrt(2) times the capillary length sqrt(gamma / (rho g)), with gamma = 0.056
// N/m.
static const double deepest_m = 3.3e-3;
// Largest share of the difference in level between two vertices that one step may remove, so that
// no wave begins.
static const double levelled_share = 0.25;
// Share of the blood that moves in a second, up to which the blood is taken to be at rest. A film
// never stops getting thinner, but does so ever more slowly.
static const double still_per_s = 1e-3;

cau_status cau_blood_create(cau_blood *blood, const cau_tissue *tissue, cau_arena *arena,
                            cau_error *error)
{
	size_t n = (size_t)tissue->vertex_count;
	*blood = (cau_blood){.vertex_count = tissue->vertex_count,
	                     .volume_m3 = cau_arena_array(arena, n, sizeof(double)),
	                     .area_m2 = cau_arena_array(arena, n, sizeof(double)),
	                     .degree = cau_arena_array(arena, n, sizeof(int32_t)),
	                     .change_m3 = cau_arena_array(arena, n, sizeof(double))};
	if (!blood->volume_m3 || !blood->area_m2 || !blood->degree || !blood->change_m3)
		return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for blood");
	for (int32_t e = 0; e < tissue->edges.edge_count; e++) {
		const int32_t *end = tissue->edges.vertex + 2 * (size_t)e;
		cau_vec3 way = cau_sub(cau_vec3_of(tissue->rest + 3 * (size_t)end[1]),
		                       cau_vec3_of(tissue->rest + 3 * (size_t)end[0]));
		for (int i = 0; i < 2; i++) {
			blood->area_m2[end[i]] += cau_dot(way, way);
			blood->degree[end[i]]++;
		}
	}
	for (size_t v = 0; v < n; v++)
		if (blood->degree[v])
			blood->area_m2[v] /= blood->degree[v];
	return CAU_OK;
}

double cau_blood_depth(const cau_blood *blood, int32_t vertex)
{
	CAU_ASSERT_INDEX(vertex, blood->vertex_count);
	return blood->volume_m3[vertex] > 0 ? blood->volume_m3[vertex] / blood->area_m2[vertex] : 0;
}

void cau_blood_recount(cau_blood *blood)
{
	blood->any = false;
	for (int32_t v = 0; v < blood->vertex_count; v++)
		blood->any |= blood->volume_m3[v] > 0;
}

void cau_blood_add(cau_blood *blood, const uint8_t *visible, const double *position, cau_vec3 at,
                   double volume_m3)
{
	CAU_ASSERT(volume_m3 >= 0, "%g m^3 of blood", volume_m3);
	int32_t nearest = -1;
	double least = INFINITY;
	for (int32_t v = 0; v < blood->vertex_count; v++) {
		cau_vec3 way = cau_sub(cau_vec3_of(position + 3 * (size_t)v), at);
		double squared = cau_dot(way, way);
		if (!visible[v] || !(blood->area_m2[v] > 0) || squared >= least)
			continue;
		nearest = v;
		least = squared;
	}
	if (nearest < 0)
		return;
	blood->volume_m3[nearest] += volume_m3;
	blood->any = true;
}

// Returns the volume, m^3, that flows along an edge from vertex `up` to the lower end. The film has
// the speed of a laminar film on a slope. The width of the flow is the distance between vertices.
static double film_m3(const cau_blood *blood, int32_t up, double fall_m, double way_m,
                      double gravity_m_s2, double duration_s)
{
	double film = cau_blood_depth(blood, up) - clinging_m;
	if (film <= 0 || way_m <= 0)
		return 0;
	double per_width_m2_s = CAU_BLOOD_DENSITY_KG_M3 * gravity_m_s2 * film * film * film /
	                        (3 * CAU_BLOOD_VISCOSITY_PA_S) * fall_m / way_m;
	double width_m = sqrt(blood->area_m2[up]);
	double most = fmin(film * blood->area_m2[up] / blood->degree[up],
	                   levelled_share * fall_m * blood->area_m2[up] / blood->degree[up]);
	return fmin(per_width_m2_s * width_m * duration_s, most);
}

void cau_blood_flow(cau_blood *blood, const cau_edge_table *edges, const uint8_t *visible,
                    const double *position, const double gravity_m_s2[3], double duration_s)
{
	cau_vec3 down = cau_vec3_of(gravity_m_s2);
	double gravity = cau_length(down), moved = 0;
	blood->flows = false;
	if (!blood->any || gravity <= 0)
		return;
	memset(blood->change_m3, 0, (size_t)blood->vertex_count * sizeof(double));
	for (int32_t e = 0; e < edges->edge_count; e++) {
		int32_t a = edges->vertex[2 * (size_t)e], b = edges->vertex[2 * (size_t)e + 1];
		if (!visible[a] || !visible[b] || !(blood->volume_m3[a] > 0 || blood->volume_m3[b] > 0))
			continue;
		cau_vec3 way =
			cau_sub(cau_vec3_of(position + 3 * (size_t)b), cau_vec3_of(position + 3 * (size_t)a));
		double fall =
			cau_dot(down, way) / gravity + cau_blood_depth(blood, a) - cau_blood_depth(blood, b);
		int32_t up = fall >= 0 ? a : b;
		double volume = film_m3(blood, up, fabs(fall), cau_length(way), gravity, duration_s);
		blood->change_m3[up] -= volume;
		blood->change_m3[up == a ? b : a] += volume;
		moved += volume;
	}
	double sum = 0;
	for (int32_t v = 0; v < blood->vertex_count; v++) {
		blood->volume_m3[v] =
			fmin(fmax(blood->volume_m3[v] + blood->change_m3[v], 0), deepest_m * blood->area_m2[v]);
		sum += blood->volume_m3[v];
	}
	blood->flows = moved > still_per_s * duration_s * sum;
}
