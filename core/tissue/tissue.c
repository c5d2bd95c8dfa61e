// SPDX-License-Identifier: GPL-3.0-or-later
#include "tissue/tissue.h"

#include <stdio.h>
#include <string.h>

#include "cautery/assert.h"
#include "tissue/tissue_internal.h"

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
