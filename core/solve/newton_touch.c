// SPDX-License-Identifier: GPL-3.0-or-later
// Adds tissue contact to a region: energy, force and stiffness of pairs and grips. Also finds how
// far each vertex may move in one step of Newton's method, so that no pair crosses.
#include <math.h>
#include <stdlib.h>

#include "cautery/assert.h"
#include "solve/newton.h"
#include "solve/solver.h"

// Share of the gap by which a vertex in contact may move in one step of Newton's method. Both parts
// of a pair may move, so one step does not close the gap.
static const double ROOM_SHARE = 0.45;

static bool has_row(const cau_newton *newton, const int32_t vertex[4])
{
	return newton->place[vertex[0]] >= 0 || newton->place[vertex[1]] >= 0 ||
	       newton->place[vertex[2]] >= 0 || newton->place[vertex[3]] >= 0;
}

static bool add_to(int32_t **list, int32_t *count, int32_t *room, int32_t item)
{
	if (*count == *room) {
		int32_t *more = realloc(*list, (2 * (size_t)*room + 64) * sizeof *more);
		if (!more)
			return false;
		*list = more;
		*room = 2 * *room + 64;
	}
	(*list)[(*count)++] = item;
	return true;
}

// Lists the pairs that can touch if no vertex moves farther than way_m from its present position.
static bool find_pairs(cau_newton *newton, const cau_collide *collide, double way_m)
{
	for (int32_t k = 0; k < collide->pair_count; k++) {
		const cau_collide_pair *pair = &collide->pair[k];
		if (has_row(newton, pair->vertex) && !cau_collide_is_exempt(collide, pair) &&
		    !cau_collide_is_far(collide, k, collide->seen.away_m + way_m, pair->thickness_m) &&
		    !add_to(&newton->pair, &newton->pair_count, &newton->capacity.pairs, k))
			return false;
	}
	return true;
}

static bool find_grips(cau_newton *newton, const cau_collide *collide)
{
	for (int32_t k = 0; k < collide->grip_count; k++)
		if (has_row(newton, collide->grip[k].vertex) &&
		    !add_to(&newton->grip, &newton->grip_count, &newton->capacity.grips, k))
			return false;
	return true;
}

bool cau_newton_find_touching(cau_newton *newton, const cau_step_solver *solver,
                              const cau_newton *from)
{
	const cau_collide *collide = solver->collide;
	newton->pair_count = newton->grip_count = 0;
	if (!collide)
		return true;
	if (!from)
		return find_pairs(newton, collide, solver->loose.way_m) && find_grips(newton, collide);
	for (int32_t k = 0; k < from->pair_count; k++)
		if (has_row(newton, collide->pair[from->pair[k]].vertex) &&
		    !add_to(&newton->pair, &newton->pair_count, &newton->capacity.pairs, from->pair[k]))
			return false;
	for (int32_t k = 0; k < from->grip_count; k++)
		if (has_row(newton, collide->grip[from->grip[k]].vertex) &&
		    !add_to(&newton->grip, &newton->grip_count, &newton->capacity.grips, from->grip[k]))
			return false;
	return true;
}

// Adds force and stiffness to the rows. Vertex i gets the force weight_i f. The stiffness is
// `along` in the direction of the normal and `across` perpendicular to it, N/m. Couplings between a
// pair's vertices are added to their diagonal blocks instead, so that H stays above the true
// Hessian.
static void add_touch(cau_newton *newton, const int32_t vertex[4], const double weight[4],
                      cau_vec3 force, cau_vec3 normal, double along, double across)
{
	const double n[3] = {normal.x, normal.y, normal.z}, f[3] = {force.x, force.y, force.z};
	double sum = 0;
	for (int i = 0; i < 4; i++)
		sum += newton->place[vertex[i]] >= 0 ? fabs(weight[i]) : 0;
	for (int i = 0; i < 4; i++) {
		int32_t row = newton->place[vertex[i]];
		if (row < 0)
			continue;
		double scale = fabs(weight[i]) * sum;
		double *pivot = newton->pivot + (int64_t)CAU_BLOCK * row;
		for (int c = 0; c < 3; c++) {
			newton->gradient[4 * (int64_t)row + c] += weight[i] * f[c];
			pivot[5 * c] += scale * across;
			for (int r = 0; r < 3; r++)
				pivot[4 * c + r] += scale * (along - across) * n[r] * n[c];
		}
	}
}

static void narrow(cau_newton *newton, const int32_t vertex[4], double distance)
{
	for (int i = 0; i < 4; i++) {
		int32_t row = newton->place[vertex[i]];
		if (row >= 0)
			newton->room[row] = fmin(newton->room[row], ROOM_SHARE * distance);
	}
}

void cau_newton_touch(cau_newton *newton, const cau_step_solver *solver)
{
	const cau_collide *collide = solver->collide;
	for (int32_t i = 0; i < newton->n; i++)
		newton->room[i] = INFINITY;
	for (int32_t k = 0; k < newton->pair_count; k++) {
		const cau_collide_pair *pair = &collide->pair[newton->pair[k]];
		cau_gap gap;
		double slope, curvature;
		newton->energy +=
			cau_collide_press(collide, newton->pair[k], solver->position, &gap, &slope, &curvature);
		if (slope == 0)
			continue;
		narrow(newton, pair->vertex, gap.distance);
		add_touch(newton, pair->vertex, gap.weight, cau_scale(slope, gap.normal), gap.normal,
		          curvature, 0);
	}
	for (int32_t k = 0; k < newton->grip_count; k++) {
		const cau_collide_grip *grip = &collide->grip[newton->grip[k]];
		cau_vec3 slip;
		double present;
		newton->energy += cau_collide_slip(collide, grip, solver->position, &slip, &present);
		add_touch(newton, grip->vertex, grip->weight, cau_scale(present, slip), grip->normal, 0,
		          present);
	}
}
