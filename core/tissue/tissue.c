// SPDX-License-Identifier: GPL-3.0-or-later
#include "tissue/tissue.h"

#include <math.h>
#include <string.h>

#include "tissue/tissue_internal.h"

// Of a link's reach: a truss between vertices that (nearly) coincide is as stiff as one this long.
static const double shortest_truss = 0.01;

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
	for (int32_t i = 0; i < scene->pin_count; ++i) {
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
	cau_status status = cau_tissue_gather(tissue, scene, arena, error);
	if (!status)
		status = cau_tissue_shape(tissue, arena, error);
	if (!status)
		status = cau_tissue_link(tissue, arena, error);
	view_primitives(tissue);
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

int32_t cau_tissue_find_layer(const cau_tissue *tissue, const char *name)
{
	for (int32_t i = 0; i < tissue->layer_count; ++i)
		if (!strcmp(tissue->layer[i].def.name, name))
			return i;
	return -1;
}

const cau_sheet_material *cau_triangle_material(const cau_tissue *tissue, int32_t triangle)
{
	return &tissue->layer[tissue->triangle_layer[triangle]]
	            .def.sheet[tissue->triangle_material[triangle]];
}

const cau_fat_material *cau_tetrahedron_material(const cau_tissue *tissue, int32_t tetrahedron)
{
	return &tissue->layer[tissue->tetrahedron_layer[tetrahedron]]
	            .def.fat[tissue->tetrahedron_material[tetrahedron]];
}

const cau_heat_material *cau_layer_heat(const cau_tissue_layer *layer, int32_t material)
{
	if (layer->def.kind == CAU_LAYER_FAT)
		return &layer->def.fat[material].heat;
	if (layer->def.kind == CAU_LAYER_LINKS)
		return &layer->def.link.heat;
	return &layer->def.sheet[material].heat;
}

void cau_fat_lame(const cau_fat_material *material, double *lambda, double *mu)
{
	double e = material->young_modulus_pa, nu = material->poisson_ratio;
	*mu = e / (2 * (1 + nu));
	*lambda = e * nu / ((1 + nu) * (1 - 2 * nu));
}

int32_t cau_tissue_element_count(const cau_tissue *tissue, int kind)
{
	switch (kind) {
	case CAU_ELEMENT_TRIANGLE:
		return tissue->triangle_count;
	case CAU_ELEMENT_TETRAHEDRON:
		return tissue->tetrahedron_count;
	case CAU_ELEMENT_LINK:
		return tissue->link_count;
	default:
		return tissue->hinge_count;
	}
}

// Coefficients of vertices 1..rank are the rows of D_m^-1; vertex 0 has minus their sum.
static void gradient_map(const double *dm_inverse, int rank, cau_element_map *map)
{
	map->rank = rank;
	map->vertex_count = rank + 1;
	for (int c = 0; c < rank; ++c) {
		double sum = 0;
		for (int i = 0; i < rank; ++i) {
			map->coefficient[c][i + 1] = dm_inverse[rank * i + c];
			sum += dm_inverse[rank * i + c];
		}
		map->coefficient[c][0] = -sum;
	}
}

static double triangle_weight(const cau_tissue *tissue, int32_t triangle)
{
	const cau_sheet_material *material = cau_triangle_material(tissue, triangle);
	return material->limit_stiffness_pa * material->thickness_m * tissue->triangle_area[triangle];
}

// The energy's stiffness at rest 2 mu + 3 lambda, and the limit's where one acts or shrinkage may
// set one.
static double tetrahedron_weight(const cau_tissue *tissue, int32_t tetrahedron)
{
	const cau_fat_material *material = cau_tetrahedron_material(tissue, tetrahedron);
	double lambda, mu;
	cau_fat_lame(material, &lambda, &mu);
	double stiffness = 2 * mu + 3 * lambda;
	int shrinks = material->shrink[0] != 1 || material->shrink[1] != 1 || material->shrink[2] != 1;
	if (material->limit != CAU_LIMIT_NONE || shrinks)
		stiffness += material->limit_stiffness_pa;
	return stiffness * tissue->tetrahedron_volume[tetrahedron];
}

void cau_tissue_element_map(const cau_tissue *tissue, int kind, int32_t index, cau_element_map *map)
{
	switch (kind) {
	case CAU_ELEMENT_TRIANGLE:
		memcpy(map->vertex, tissue->triangle + 3 * (size_t)index, 3 * sizeof(int32_t));
		gradient_map(tissue->triangle_dm_inverse + 4 * (size_t)index, 2, map);
		map->weight = triangle_weight(tissue, index);
		break;
	case CAU_ELEMENT_TETRAHEDRON:
		memcpy(map->vertex, tissue->tetrahedron + 4 * (size_t)index, 4 * sizeof(int32_t));
		gradient_map(tissue->tetrahedron_dm_inverse + 9 * (size_t)index, 3, map);
		map->weight = tetrahedron_weight(tissue, index);
		break;
	case CAU_ELEMENT_LINK: {
		const cau_link_material *material = &tissue->layer[tissue->link_layer[index]].def.link;
		memcpy(map->vertex, tissue->link + 2 * (size_t)index, 2 * sizeof(int32_t));
		map->vertex_count = 2;
		map->rank = 1;
		map->coefficient[0][0] = -1;
		map->coefficient[0][1] = 1;
		double length = fmax(tissue->link_length[index], shortest_truss * material->reach_m);
		map->weight = material->young_modulus_pa * material->area_m2 / length;
		break;
	}
	default:
		memcpy(map->vertex, tissue->hinge_vertex + 4 * (size_t)index, 4 * sizeof(int32_t));
		map->vertex_count = 4;
		map->rank = 1;
		memcpy(map->coefficient[0], tissue->hinge_coefficient + 4 * (size_t)index,
		       4 * sizeof(double));
		map->weight = tissue->hinge_weight[index];
		break;
	}
}
