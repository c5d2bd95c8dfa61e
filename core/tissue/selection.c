// SPDX-License-Identifier: GPL-3.0-or-later
// Selects vertices by their position at rest.
#include <string.h>

#include "base/vector.h"
#include "cautery/assert.h"
#include "tissue/tissue.h"

static bool in_box(const cau_selection *selection, const double *x)
{
	for (int i = 0; i < 3; i++)
		if (x[i] < selection->least_m[i] || x[i] > selection->most_m[i])
			return false;
	return true;
}

static double distance(const cau_selection *selection, const double *x)
{
	return cau_length(cau_sub(cau_vec3_of(x), cau_vec3_of(selection->center_m)));
}

// Selects the vertices at edges with exactly one triangle of the layer (or of all layers).
static int32_t select_rim(const cau_tissue *tissue, int32_t layer, uint8_t *chosen)
{
	CAU_ASSERT(layer < tissue->layer_count, "layer %d of %d", layer, tissue->layer_count);
	const cau_edge_table *edges = &tissue->edges;
	int32_t count = 0;
	for (int32_t e = 0; e < edges->edge_count; e++) {
		int32_t sharers = 0;
		const int32_t *first = edges->first[CAU_PRIMITIVE_TRIANGLE];
		for (int32_t k = first[e]; k < first[e + 1]; k++)
			sharers += layer < 0 ||
			           tissue->triangle_layer[edges->sharer[CAU_PRIMITIVE_TRIANGLE][k]] == layer;
		for (int i = 0; i < 2 && sharers == 1; i++) {
			count += !chosen[edges->vertex[2 * e + i]];
			chosen[edges->vertex[2 * e + i]] = 1;
		}
	}
	return count;
}

int32_t cau_tissue_select(const cau_tissue *tissue, const cau_selection *selection, uint8_t *chosen)
{
	CAU_ASSERT_INDEX(selection->kind, CAU_SELECT_COUNT);
	int32_t layer = -1, first = 0, last = tissue->vertex_count, count = 0, nearest = -1;
	if (selection->layer[0]) {
		layer = cau_tissue_find_layer(tissue, selection->layer);
		if (layer < 0)
			return -1;
		first = tissue->layer[layer].first_vertex;
		last = first + tissue->layer[layer].vertex_count;
		CAU_ASSERT(first >= 0 && last <= tissue->vertex_count,
		           "layer %d has vertices %d to %d of %d", layer, first, last,
		           tissue->vertex_count);
	}
	if (selection->kind == CAU_SELECT_RIM)
		return select_rim(tissue, layer, chosen);
	for (int32_t v = first; v < last; v++) {
		const double *x = tissue->rest + 3 * (size_t)v;
		if (selection->kind == CAU_SELECT_NEAREST) {
			if (nearest < 0 ||
			    distance(selection, x) < distance(selection, tissue->rest + 3 * (size_t)nearest))
				nearest = v;
			continue;
		}
		int in = selection->kind == CAU_SELECT_BOX ? in_box(selection, x)
		                                           : distance(selection, x) <= selection->radius_m;
		chosen[v] |= (uint8_t)in;
		count += in;
	}
	if (nearest >= 0) {
		chosen[nearest] = 1;
		count = 1;
	}
	CAU_ASSERT(count <= tissue->vertex_count, "%d vertices chosen of %d", count,
	           tissue->vertex_count);
	return count;
}
