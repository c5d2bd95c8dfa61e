// SPDX-License-Identifier: GPL-3.0-or-later
#include "mesh/polygon.h"

#include <string.h>

#include "cautery/assert.h"
#include "mesh/geometry.h"
#include "mesh/mesh_memory.h"

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
