// SPDX-License-Identifier: GPL-3.0-or-later
// Two sheets, one above the other. Random noise moves vertices of both sheets near each other.
#pragma once

#include "collide/collide.h"
#include "core/rig/rig.h"

typedef struct sheets {
	rig r;
	cau_collide collide;
	cau_pool *pool;
	uint32_t *mask;
	double *x; // m, (n x 3)
	uint64_t random;
} sheets;

static inline double sheets_draw(sheets *s) // returns a random number from -1 to 1
{
	s->random = s->random * 6364136223846793005ull + 1442695040888963407ull;
	return (double)(s->random >> 11) / 4503599627370496.0 - 1;
}

// Makes the sheets. Their contact has `thickness_m`. The upper sheet is `apart_m` above the lower
// one.
static inline void sheets_begin(sheets *s, double thickness_m, double friction, double apart_m)
{
	*s = (sheets){.random = 5};
	rig_begin(&s->r);
	rig_add_sheet(&s->r, 8, 6);
	rig_add_sheet(&s->r, 7, 6);
	rig_build(&s->r, NULL, 2);
	const cau_tissue *tissue = &s->r.tissue;
	size_t n = (size_t)tissue->vertex_count;
	for (int32_t v = tissue->layer[1].first_vertex; v < tissue->vertex_count; v++)
		tissue->rest[3 * (size_t)v + 2] += 0.05; // at rest no parts are near each other
	assert_int_equal(
		cau_collide_create(&s->collide, tissue, thickness_m, friction, 1.0 / 60, &s->r.arena, NULL),
		CAU_OK);
	s->pool = s->r.solver.pool;
	s->x = cau_arena_copy(&s->r.arena, tissue->rest, 3 * n, sizeof(double));
	s->mask = cau_arena_array(&s->r.arena, (size_t)tissue->faces.face_count / 32 + 1, 4);
	for (int32_t v = tissue->layer[1].first_vertex; v < tissue->vertex_count; v++)
		s->x[3 * (size_t)v + 2] += apart_m - 0.05;
	s->collide.fixed = s->r.fixed;
	s->collide.start = s->x;
	cau_surface_list(&s->collide.surface, s->mask);
	memset(s->collide.step, 0, 3 * n * sizeof(double));
}

static inline void sheets_shake(sheets *s, double by_m)
{
	for (int32_t i = 0; i < 3 * s->r.tissue.vertex_count; i++)
		s->x[i] += by_m * sheets_draw(s);
}

static inline double sheets_volume(const double *a, const double *b, const double *c,
                                   const double *d)
{
	cau_vec3 o = cau_vec3_of(a);
	return cau_dot(cau_sub(cau_vec3_of(b), o),
	               cau_cross(cau_sub(cau_vec3_of(c), o), cau_sub(cau_vec3_of(d), o)));
}

// Whether an edge pierces a face with which it shares no vertex.
static inline bool sheets_pierce(const double *x, const int32_t *edge, const int32_t *face)
{
	const double *a = x + 3 * edge[0], *b = x + 3 * edge[1], *c = x + 3 * face[0],
				 *d = x + 3 * face[1], *e = x + 3 * face[2];
	for (int k = 0; k < 3; k++)
		if (face[k] == edge[0] || face[k] == edge[1])
			return false;
	if (sheets_volume(a, c, d, e) * sheets_volume(b, c, d, e) >= 0)
		return false;
	double p = sheets_volume(a, b, c, d), q = sheets_volume(a, b, d, e),
		   r = sheets_volume(a, b, e, c);
	return (p > 0 && q > 0 && r > 0) || (p < 0 && q < 0 && r < 0);
}
