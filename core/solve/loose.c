// SPDX-License-Identifier: GPL-3.0-or-later
// Chooses the vertices that a step leaves to Newton's method: vertices of slack sheets and of
// sheets with a range. Vertices of fat and vertices near a tool are excluded.
#include <stdlib.h>
#include <string.h>

#include "cautery/assert.h"
#include "solve/contact.h"
#include "solve/newton.h"
#include "solve/solver.h"

static int32_t vertex_of(const cau_step_solver *solver, const cau_local_work *work, int32_t slot,
                         int corner)
{
	const cau_elements *elements = &solver->elements;
	return elements
	           ->record_vertex[work->first_record + elements->sheet.record_at[corner][slot] / 4] /
	       4;
}

static double weight_of(const cau_step_solver *solver, int32_t slot)
{
	return cau_real_get(solver->elements.sheet.weight, solver->elements.single, slot);
}

static bool is_on_fat(const cau_step_solver *solver, const cau_local_work *work, int32_t slot)
{
	for (int i = 0; i < 3; i++)
		if (solver->loose.in_fat[vertex_of(solver, work, slot, i)])
			return true;
	return false;
}

static int64_t count_chosen(const cau_step_solver *solver)
{
	int64_t count = 0;
	for (int32_t v = 0; v < solver->tissue->vertex_count; v++)
		count += solver->loose.region.chosen[v];
	return count;
}

// True if a live triangle, without vertices of fat, has a range.
static bool has_range(const cau_step_solver *solver, int32_t share, int32_t slot)
{
	return weight_of(solver, slot) > 0 &&
	       cau_newton_stiffness(solver, &(cau_newton_element){share, slot}) == CAU_NEWTON_RANGE;
}

// Lists the shares with triangles that have no vertex of fat. Only these shares are examined. If
// sheets with a range have too many vertices for a region, their vertices are left to A.
static bool list_shares(cau_step_solver *solver)
{
	cau_loose *loose = &solver->loose;
	const cau_element_slots *slots = &solver->slots;
	loose->share = calloc((size_t)slots->work_count + 1, sizeof *loose->share);
	loose->ranged = calloc((size_t)slots->work_count + 1, sizeof *loose->ranged);
	for (int32_t w = 0; loose->share && loose->ranged && w < slots->work_count; w++) {
		const cau_local_work *work = &slots->work[w];
		bool any = false;
		for (int32_t slot = work->first; slot < work->last; slot++) {
			bool own = work->kind == CAU_ELEMENT_TRIANGLE && !is_on_fat(solver, work, slot);
			any |= own;
			if (!own || !has_range(solver, w, slot))
				continue;
			loose->ranged[w] = true;
			for (int i = 0; i < 3; i++)
				loose->region.chosen[vertex_of(solver, work, slot, i)] = 1;
		}
		if (any)
			loose->share[loose->share_count++] = w;
	}
	if (loose->ranged && count_chosen(solver) > CAU_NEWTON_ROWS)
		memset(loose->ranged, 0, (size_t)slots->work_count * sizeof *loose->ranged);
	return loose->share && loose->ranged;
}

static bool make_loose(cau_step_solver *solver)
{
	cau_loose *loose = &solver->loose;
	const cau_tissue *tissue = solver->tissue;
	size_t n = (size_t)tissue->vertex_count;
	if (loose->ranged)
		return true;
	loose->region.chosen = calloc(n, 1);
	loose->part.chosen = calloc(n, 1);
	loose->before = calloc(n, 1);
	loose->in_fat = calloc(n, 1);
	if (!loose->region.chosen || !loose->part.chosen || !loose->before || !loose->in_fat)
		return false;
	for (int64_t i = 0; i < 4 * (int64_t)tissue->tetrahedron_count; i++)
		loose->in_fat[tissue->tetrahedron[i]] = 1;
	return list_shares(solver);
}

static void choose_slack(const cau_step_solver *solver, int32_t share, bool ranges, uint8_t *chosen)
{
	const cau_local_work *work = &solver->slots.work[share];
	bool all = solver->settings.newton_chosen, ranged = ranges && solver->loose.ranged[share];
	if (!all && !ranged && !solver->elements.slack[work->number])
		return;
	for (int32_t slot = work->first; slot < work->last; slot++) {
		if (!(weight_of(solver, slot) > 0) || is_on_fat(solver, work, slot))
			continue;
		double stiffness =
			all ? 0 : cau_newton_stiffness(solver, &(cau_newton_element){share, slot});
		if (stiffness == CAU_NEWTON_RANGE ? ranged : stiffness < CAU_SLACK)
			for (int i = 0; i < 3; i++)
				chosen[vertex_of(solver, work, slot, i)] = 1;
	}
}

enum { CHOSEN = 1, LEFT_OUT = 2, BESIDE = 4 };

// Excludes the vertices that share a triangle with an excluded vertex.
static void leave_out_ring(const cau_step_solver *solver, uint8_t *chosen)
{
	const cau_loose *loose = &solver->loose;
	for (int32_t k = 0; k < loose->share_count; k++) {
		const cau_local_work *work = &solver->slots.work[loose->share[k]];
		for (int32_t slot = work->first; slot < work->last; slot++) {
			int32_t vertex[3];
			int any = 0;
			for (int i = 0; i < 3; i++)
				any |= chosen[vertex[i] = vertex_of(solver, work, slot, i)];
			for (int i = 0; (any & LEFT_OUT) && weight_of(solver, slot) > 0 && i < 3; i++)
				chosen[vertex[i]] |= BESIDE;
		}
	}
	for (int32_t v = 0; v < solver->tissue->vertex_count; v++)
		if (chosen[v] & BESIDE)
			chosen[v] = LEFT_OUT;
}

// Rings of vertices around a tool's contact that are left to A. If vertices beside a tool were
// settled by Newton's method, they might pass through the tool.
enum { RINGS = 2 };

// Vertices of contact constraints stay with A, because contact is corrected by columns of A^-1.
static void leave_out(const cau_step_solver *solver, uint8_t *chosen)
{
	const cau_contact_set *contact = solver->contact;
	for (int32_t i = 0; contact && i < contact->columns.corner_count; i++)
		chosen[contact->columns.corner[i]] = LEFT_OUT;
	for (int ring = 0; contact && contact->columns.corner_count && ring < RINGS; ring++)
		leave_out_ring(solver, chosen);
	for (int32_t v = 0; v < solver->tissue->vertex_count; v++)
		chosen[v] = chosen[v] == CHOSEN && !solver->fixed[v];
}

// Chooses the region, with or without sheets that have a range. Returns the number of its vertices.
static int64_t choose(cau_step_solver *solver, bool ranges)
{
	cau_loose *loose = &solver->loose;
	memset(loose->region.chosen, 0, (size_t)solver->tissue->vertex_count);
	for (int32_t k = 0; k < loose->share_count; k++)
		choose_slack(solver, loose->share[k], ranges, loose->region.chosen);
	if (!count_chosen(solver))
		return 0;
	leave_out(solver, loose->region.chosen);
	return count_chosen(solver);
}

cau_status cau_loose_choose(cau_step_solver *solver, cau_error *error)
{
	cau_loose *loose = &solver->loose;
	size_t n = (size_t)solver->tissue->vertex_count;
	loose->settled = true; // remains true if there is no region
	loose->given_up = loose->moved = false;
	loose->left = 0;
	loose->work = 0;
	if (solver->settings.diagonal || solver->none_loose || !solver->tissue->triangle_count) {
		loose->region.n = 0;
		return CAU_OK;
	}
	if (!make_loose(solver)) {
		cau_loose_finish(loose);
		return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for Newton's steps");
	}
	int64_t count = choose(solver, true);
	if (count > CAU_NEWTON_ROWS && !solver->settings.newton_chosen)
		count = choose(solver, false);
	if (count > CAU_NEWTON_ROWS && !solver->settings.newton_chosen)
		count = 0;
	if (!count) {
		loose->region.n = 0;
		return CAU_OK;
	}
	loose->settled = false;
	if (loose->region.n && loose->epoch == solver->age.epoch &&
	    !memcmp(loose->region.chosen, loose->before, n))
		return CAU_OK;
	loose->epoch = solver->age.epoch;
	memcpy(loose->before, loose->region.chosen, n);
	loose->region.n = 0;
	if (!cau_newton_create(&loose->region, solver, NULL))
		return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for Newton's steps");
	return CAU_OK;
}

void cau_loose_finish(cau_loose *loose)
{
	cau_newton_finish(&loose->region);
	cau_newton_finish(&loose->part);
	free(loose->before);
	free(loose->in_fat);
	free(loose->share);
	free(loose->ranged);
	*loose = (cau_loose){0};
}
