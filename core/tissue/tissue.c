// SPDX-License-Identifier: GPL-3.0-or-later
// Makes a tissue, and selects vertices by their position at rest.
#include "tissue/tissue.h"

#include <stdio.h>
#include <string.h>

#include "base/vector.h"
#include "cautery/assert.h"
#include "tissue/tissue_internal.h"

// ---- selection
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

// ---- the tissue
static void view_primitives(cau_tissue *tissue)
{
	tissue->primitives = (cau_primitives){
		.vertex_count = tissue->vertex_count,
		.triangle_count = tissue->triangle_count,
		.triangle = tissue->triangle,
		.tetrahedron_count = tissue->tetrahedron_count,
		.tetrahedron = tissue->tetrahedron,
		.link_count = tissue->link_count,
		.link = tissue->link,
	};
}

static cau_status pin(cau_tissue *tissue, const cau_scene_def *scene, cau_error *error)
{
	for (int32_t i = 0; i < scene->pin_count; i++) {
		char path[64];
		snprintf(path, sizeof path, "pins[%d]", i);
		int32_t count = cau_tissue_select(tissue, &scene->pins[i], tissue->pinned);
		if (count <= 0)
			return cau_fail(error, CAU_BAD_VALUE, path,
			                count < 0 ? "there is no layer of this name"
			                          : "no vertex lies in this selection");
	}
	return CAU_OK;
}

cau_status cau_tissue_make(const cau_scene_def *scene, cau_arena *arena, cau_tissue *tissue,
                           cau_error *error)
{
	memset(tissue, 0, sizeof *tissue);
	tissue->inertia_s = scene->integrator == CAU_INTEGRATOR_SDIRK2
	                        ? CAU_SDIRK2_GAMMA * scene->step_s
	                        : scene->step_s;
	for (int32_t i = 0; i < scene->layer_count; i++)
		tissue->viscous = tissue->viscous || scene->layers[i].viscosity_s > 0;
	cau_status status = cau_tissue_gather(tissue, scene, arena, error);
	if (!status)
		status = cau_tissue_shape(tissue, arena, error);
	if (!status)
		status = cau_tissue_link(tissue, arena, error);
	view_primitives(tissue);
	CAU_ASSERT(status || tissue->link_count <= tissue->vertex_count * 8 * CAU_MAX_LAYERS,
	           "%d links over %d vertices", tissue->link_count, tissue->vertex_count);
	if (!status)
		status =
			cau_edge_table_make(&tissue->primitives, tissue->triangle_layer, &tissue->edges, error);
	if (!status)
		status = cau_face_table_make(&tissue->primitives, &tissue->faces, error);
	if (!status)
		status = cau_tissue_hinge(tissue, arena, error);
	if (!status)
		status = pin(tissue, scene, error);
	return status;
}

void cau_tissue_finish(cau_tissue *tissue)
{
	cau_edge_table_finish(&tissue->edges);
	cau_face_table_finish(&tissue->faces);
}
