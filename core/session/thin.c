// SPDX-License-Identifier: GPL-3.0-or-later
// Selects the vertices that get a contact constraint, if a tool has more vertices than the
// capacity.
//
// Near vertices that do not touch may come to touch within the tick, so they have constraints while
// there is capacity. Otherwise only drawn vertices that touch have a constraint. If these vertices
// are still too many, the constraints are spread over all of them. The deepest vertices alone would
// be crowded in the middle, and the tissue around them would sink in with the tool. The spread
// order is van der Corput's: positions along the Morton curve with their bits reversed. Any first
// part of this order is spread evenly, and most of it stays the same as vertices come and go. The
// tissue's elasticity holds the vertices between.
#include <math.h>
#include <stdlib.h>

#include "cautery/assert.h"
#include "session/session_internal.h"

static const double least_margin_m = 5e-4, most_margin_m = 2e-3;
static const double touching_m = 2e-4; // a vertex nearer than this touches; others are only near
// Largest ratio of touching vertices to constraints at which the least deep vertices, around the
// rim, are left out. Leaving out the rim is better than gaps between constraints. Above this ratio
// the constraints are spread.
static const int32_t most_crowded = 2;

double cau_session_margin(const cau_tool_def *def)
{
	return fmin(fmax(least_margin_m, 0.25 * def->hot_radius_m), most_margin_m);
}

static int compare_depth(const void *a, const void *b)
{
	const cau_touching *x = a, *y = b;
	if (x->gap != y->gap)
		return x->gap < y->gap ? -1 : 1;
	return (x->vertex > y->vertex) - (x->vertex < y->vertex);
}

static uint32_t reversed(uint32_t x)
{
	x = (x & 0x55555555u) << 1 | (x >> 1 & 0x55555555u);
	x = (x & 0x33333333u) << 2 | (x >> 2 & 0x33333333u);
	x = (x & 0x0F0F0F0Fu) << 4 | (x >> 4 & 0x0F0F0F0Fu);
	x = (x & 0x00FF00FFu) << 8 | (x >> 8 & 0x00FF00FFu);
	return x << 16 | x >> 16;
}

static int compare_spread(const void *a, const void *b)
{
	const cau_touching *x = a, *y = b;
	uint32_t first = reversed((uint32_t)x->place), second = reversed((uint32_t)y->place);
	return (first > second) - (first < second);
}

// Moves the vertices that are drawn and touch to the front. Returns their number.
static int32_t part_touching(const cau_session *session, cau_touching *list, int32_t count)
{
	int32_t touching = 0;
	for (int32_t i = 0; i < count; i++) {
		cau_touching each = list[i];
		CAU_ASSERT_INDEX(each.vertex, session->tissue.vertex_count);
		if (each.gap > touching_m || !session->view.frame.vertex_visible[each.vertex])
			continue;
		list[i] = list[touching];
		list[touching++] = each;
	}
	return touching;
}

int32_t cau_session_thin(const cau_session *session, cau_touching *list, int32_t count,
                         int32_t taken, int32_t *left_out)
{
	CAU_ASSERT(count >= 0 && count <= CAU_MAX_TOUCHING, "%d vertices touch", count);
	CAU_ASSERT(taken >= 0, "%d rows of vertices", taken);
	int32_t near_room = taken < CAU_NEAR_ROWS ? CAU_NEAR_ROWS - taken : 0;
	int32_t most = taken < CAU_MAX_VERTEX_ROWS ? CAU_MAX_VERTEX_ROWS - taken : 0;
	int32_t touching = count > near_room ? part_touching(session, list, count) : 0;
	int32_t room = touching < near_room ? near_room : touching < most ? touching : most;
	if (touching > most_crowded * room)
		qsort(list, (size_t)touching, sizeof *list, compare_spread);
	else
		qsort(list, (size_t)(touching > near_room ? touching : count), sizeof *list, compare_depth);
	*left_out = touching > room ? touching - room : 0;
	return count < room ? count : room;
}
