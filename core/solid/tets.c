// SPDX-License-Identifier: GPL-3.0-or-later
#include "solid/mesher.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cautery/assert.h"
#include "mesh/geometry.h"
#include "mesh/mesh.h"

// ---- growing
static bool grow(void **array, int32_t capacity, size_t item_bytes)
{
	void *more = realloc(*array, (size_t)capacity * item_bytes);
	if (more)
		*array = more;
	return more != NULL;
}

int32_t cau_tets_vertex(cau_tets *tets, const double position[3], bool on_interface)
{
	if (tets->vertex_count == tets->vertex_capacity && !tets->failed) {
		int32_t wanted = tets->vertex_capacity ? 2 * tets->vertex_capacity : 4096;
		tets->failed = wanted > 2 * CAU_MESH_MAX_VERTICES ||
		               !grow((void **)&tets->position, wanted, 3 * sizeof(double)) ||
		               !grow((void **)&tets->on_interface, wanted, 1);
		tets->vertex_capacity = tets->failed ? tets->vertex_capacity : wanted;
	}
	if (tets->failed)
		return 0;
	CAU_ASSERT_INDEX(tets->vertex_count, tets->vertex_capacity);
	memcpy(tets->position + 3 * (size_t)tets->vertex_count, position, 3 * sizeof *position);
	tets->on_interface[tets->vertex_count] = on_interface;
	return tets->vertex_count++;
}

void cau_tets_add(cau_tets *tets, const int32_t vertex[4], int32_t label)
{
	if (tets->count == tets->capacity && !tets->failed) {
		int32_t wanted = tets->capacity ? 2 * tets->capacity : 16384;
		tets->failed = wanted > 2 * CAU_MESH_MAX_ELEMENTS ||
		               !grow((void **)&tets->vertex, wanted, 4 * sizeof(int32_t)) ||
		               !grow((void **)&tets->label, wanted, sizeof(int32_t));
		tets->capacity = tets->failed ? tets->capacity : wanted;
	}
	if (tets->failed)
		return;
	CAU_ASSERT_INDEX(tets->count, tets->capacity);
	int32_t *own = tets->vertex + 4 * (size_t)tets->count;
	memcpy(own, vertex, 4 * sizeof *own);
	if (cau_tetrahedron_volume6(tets->position, own) < 0) {
		own[2] = vertex[3];
		own[3] = vertex[2];
	}
	tets->label[tets->count++] = label;
}

void cau_tets_finish(cau_tets *tets)
{
	free(tets->position);
	free(tets->on_interface);
	free(tets->vertex);
	free(tets->label);
	*tets = (cau_tets){0};
}

// ---- around vertices
bool cau_around_make(cau_around *around, const int32_t *element, int32_t count, int corners,
                     int32_t vertex_count)
{
	size_t uses = (size_t)count * (size_t)corners;
	CAU_ASSERT(corners == 3 || corners == 4, "elements of %d corners", corners);
	around->first = calloc((size_t)vertex_count + 2, sizeof *around->first);
	around->item = malloc((uses ? uses : 1) * sizeof *around->item);
	if (!around->first || !around->item) {
		cau_around_finish(around);
		return false;
	}
	int32_t *next = around->first + 1; // next[v]: index of the next item of v
	for (size_t i = 0; i < uses; i++)
		next[element[i] + 1]++;
	for (int32_t v = 0; v < vertex_count; v++)
		next[v + 1] += next[v];
	for (size_t i = 0; i < uses; i++)
		around->item[next[element[i]]++] = (int32_t)(i / (size_t)corners);
	return true;
}

void cau_around_finish(cau_around *around)
{
	free(around->first);
	free(around->item);
	*around = (cau_around){0};
}

// ---- quality
static const int edge_of[6][2] = {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}};
static const int opposite_of[6][2] = {{2, 3}, {1, 3}, {1, 2}, {0, 3}, {0, 2}, {0, 1}};

// Computes the lengths of the normals of the four faces, which are twice the areas. Each face is
// opposite its vertex.
static void face_sizes(const double *position, const int32_t vertex[4], double size[4])
{
	for (int k = 0; k < 4; k++) {
		int32_t face[3] = {vertex[(k + 1) % 4], vertex[(k + 2) % 4], vertex[(k + 3) % 4]};
		double normal[3];
		cau_triangle_normal(position, face, normal);
		size[k] = sqrt(cau_dot3(normal, normal));
	}
}

// Uses that the sine of the angle at the edge ij is 6 V |ij| / (|n_k| |n_l|). The faces opposite k
// and l meet at this edge.
double cau_tet_quality(const double *position, const int32_t vertex[4])
{
	double size[4], least = 1, volume6 = cau_tetrahedron_volume6(position, vertex);
	face_sizes(position, vertex, size);
	for (int e = 0; e < 6; e++) {
		double edge[3];
		cau_subtract3(position + 3 * (size_t)vertex[edge_of[e][0]],
		              position + 3 * (size_t)vertex[edge_of[e][1]], edge);
		double product = size[opposite_of[e][0]] * size[opposite_of[e][1]];
		if (!(product > 0))
			return -1;
		least = fmin(least, volume6 * sqrt(cau_dot3(edge, edge)) / product);
	}
	return least;
}

double cau_least_around(const cau_tets *tets, const cau_around *around, int32_t vertex,
                        double enough)
{
	double least = 1;
	for (int32_t i = around->first[vertex]; i < around->first[vertex + 1] && least > enough; i++)
		least = fmin(least,
		             cau_tet_quality(tets->position, tets->vertex + 4 * (size_t)around->item[i]));
	return least;
}

double cau_least_angle_deg(const cau_tets *tets)
{
	double most_cosine = -1;
	for (int32_t i = 0; i < tets->count; i++) {
		const int32_t *vertex = tets->vertex + 4 * (size_t)i;
		double normal[4][3];
		for (int k = 0; k < 4; k++) { // the normals are all outward or all inward
			static const int face_of[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};
			int32_t face[3] = {vertex[face_of[k][0]], vertex[face_of[k][1]], vertex[face_of[k][2]]};
			cau_triangle_normal(tets->position, face, normal[k]);
			double size = sqrt(cau_dot3(normal[k], normal[k]));
			for (int c = 0; c < 3; c++)
				normal[k][c] /= size > 0 ? size : 1;
		}
		for (int e = 0; e < 6; e++)
			most_cosine =
				fmax(most_cosine, -cau_dot3(normal[opposite_of[e][0]], normal[opposite_of[e][1]]));
	}
	return acos(fmin(most_cosine, 1)) * 180 / M_PI;
}
