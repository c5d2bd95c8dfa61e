// SPDX-License-Identifier: GPL-3.0-or-later
// Finds tissue that already crosses tissue. Vertices that jaws hold, that diverged or that are
// inverted are excluded from contact. They may come to lie in other tissue. Then no plane shows
// from which side they came, and pairs would keep them there. So before vertices take part in
// contact again, edges that pierce faces are searched exactly. The corners of these edges and faces
// stay exempt until they cross no longer.
#include <string.h>

#include "cautery/assert.h"
#include "collide/collide.h"

static const cau_collide_box nowhere = {{1e300, 1e300, 1e300}, {-1e300, -1e300, -1e300}};

static void widen(cau_collide_box *box, const double *by)
{
	for (int c = 0; c < 3; c++) {
		box->least[c] = by[c] < box->least[c] ? by[c] : box->least[c];
		box->most[c] = by[c] > box->most[c] ? by[c] : box->most[c];
	}
}

static cau_collide_box box_of(const double *x, const int32_t *vertex, int corners)
{
	cau_collide_box box = nowhere;
	for (int k = 0; k < corners; k++)
		widen(&box, x + 3 * (size_t)vertex[k]);
	return box;
}

static bool meets(const cau_collide_box *a, const cau_collide_box *b)
{
	return (a->least[0] <= b->most[0]) & (b->least[0] <= a->most[0]) & (a->least[1] <= b->most[1]) &
	       (b->least[1] <= a->most[1]) & (a->least[2] <= b->most[2]) & (b->least[2] <= a->most[2]);
}

// Returns six times the volume of a tetrahedron.
static double volume(cau_vec3 a, cau_vec3 b, cau_vec3 c, cau_vec3 d)
{
	return cau_dot(cau_sub(b, a), cau_cross(cau_sub(c, a), cau_sub(d, a)));
}

static bool pierces(const double *x, const int32_t edge[2], const int32_t face[3])
{
	cau_vec3 p = cau_vec3_of(x + 3 * (size_t)edge[0]), q = cau_vec3_of(x + 3 * (size_t)edge[1]);
	cau_vec3 a = cau_vec3_of(x + 3 * (size_t)face[0]), b = cau_vec3_of(x + 3 * (size_t)face[1]),
			 c = cau_vec3_of(x + 3 * (size_t)face[2]);
	if (!(volume(p, a, b, c) * volume(q, a, b, c) < 0))
		return false;
	double beside[] = {volume(p, q, a, b), volume(p, q, b, c), volume(p, q, c, a)};
	return (beside[0] > 0 && beside[1] > 0 && beside[2] > 0) ||
	       (beside[0] < 0 && beside[1] < 0 && beside[2] < 0);
}

static bool shares(const int32_t edge[2], const int32_t face[3])
{
	for (int i = 0; i < 2; i++)
		for (int k = 0; k < 3; k++)
			if (edge[i] == face[k])
				return true;
	return false;
}

// Parts of a block that meet another block's box.
typedef struct near_parts {
	int32_t count, item[3 * CAU_SURFACE_FACES];
	cau_collide_box box[3 * CAU_SURFACE_FACES];
} near_parts;

static void list_near(const cau_surface_parts *parts, int32_t block, const int32_t *vertex,
                      int corners, const double *x, const cau_collide_box *within, near_parts *near)
{
	near->count = 0;
	for (int32_t i = parts->first[block]; i < parts->first[block + 1]; i++) {
		int32_t part = parts->item[i];
		cau_collide_box box = box_of(x, vertex + (size_t)corners * (size_t)part, corners);
		if (!meets(&box, within))
			continue;
		near->item[near->count] = part;
		near->box[near->count++] = box;
	}
}

// Finds edges of the block `of_edges` that pierce faces of the block `of_faces`. Exempts the
// corners of both.
static void look_at(cau_collide *collide, const double *x, int32_t of_edges, int32_t of_faces)
{
	const cau_surface *surface = &collide->surface;
	const int32_t *edge_vertex = collide->tissue->edges.vertex,
				  *face_vertex = collide->tissue->faces.vertex;
	uint8_t *exempt = collide->exempt;
	near_parts edges, faces;
	list_near(&surface->edges, of_edges, edge_vertex, 2, x, &collide->search.place_box[of_faces],
	          &edges);
	list_near(&surface->faces, of_faces, face_vertex, 3, x, &collide->search.place_box[of_edges],
	          &faces);
	for (int32_t i = 0; i < edges.count; i++)
		for (int32_t k = 0; k < faces.count; k++) {
			const int32_t *edge = edge_vertex + 2 * (size_t)edges.item[i],
						  *face = face_vertex + 3 * (size_t)faces.item[k];
			if (meets(&edges.box[i], &faces.box[k]) && !shares(edge, face) &&
			    pierces(x, edge, face))
				exempt[edge[0]] = exempt[edge[1]] = exempt[face[0]] = exempt[face[1]] =
					exempt[face[2]] = 1;
		}
}

static void find_boxes(cau_collide *collide, const double *x)
{
	const cau_surface_parts *faces = &collide->surface.faces;
	for (int32_t b = 0; b < collide->surface.block_count; b++) {
		cau_collide_box *all = &collide->search.place_box[b];
		*all = nowhere;
		for (int32_t i = faces->first[b]; i < faces->first[b + 1]; i++) {
			const int32_t *vertex = collide->tissue->faces.vertex + 3 * (size_t)faces->item[i];
			for (int k = 0; k < 3; k++)
				widen(all, x + 3 * (size_t)vertex[k]);
		}
	}
}

void cau_collide_exempt_crossed(cau_collide *collide, const double *x)
{
	int32_t blocks = collide->surface.block_count;
	CAU_ASSERT(collide->surface.listed, "%d faces drawn", collide->surface.faces.count);
	find_boxes(collide, x);
	for (int32_t a = 0; a < blocks; a++)
		for (int32_t b = 0; b < blocks; b++)
			if (meets(&collide->search.place_box[a], &collide->search.place_box[b]))
				look_at(collide, x, a, b);
}

// ---- changes of the excluded vertices from tick to tick

void cau_collide_note_exempt(cau_collide *collide)
{
	size_t n = (size_t)collide->tissue->vertex_count;
	if (memcmp(collide->exempt, collide->search.exempt_before, n) == 0)
		return;
	for (size_t v = 0; v < n; v++)
		if (collide->exempt[v] != collide->search.exempt_before[v])
			collide->surface.changed[v] = 1;
	memcpy(collide->search.exempt_before, collide->exempt, n);
}

bool cau_collide_touches_again(const cau_collide *collide)
{
	for (size_t v = 0; v < (size_t)collide->tissue->vertex_count; v++)
		if (collide->search.exempt_before[v] > collide->exempt[v])
			return true;
	return false;
}

void cau_collide_forget_crossed(cau_collide *collide)
{
	memset(collide->search.exempt_before, 1, (size_t)collide->tissue->vertex_count);
}

void cau_collide_forget(cau_collide *collide)
{
	collide->range.found = false;
	cau_collide_forget_crossed(collide);
}

void cau_collide_let_go(cau_collide *collide, int32_t vertex)
{
	CAU_ASSERT_INDEX(vertex, collide->tissue->vertex_count);
	collide->exempt[vertex] = collide->search.exempt_before[vertex] = 1;
	collide->surface.changed[vertex] = 1;
}
