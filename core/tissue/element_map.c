// SPDX-License-Identifier: GPL-3.0-or-later
// The elements of a tissue: their materials and vertices, and the form that the system needs, a
// linear map G with a weight.
#include <math.h>
#include <string.h>

#include "cautery/assert.h"
#include "tissue/tissue.h"

// ---- layers and materials
int32_t cau_tissue_find_layer(const cau_tissue *tissue, const char *name)
{
	for (int32_t i = 0; i < tissue->layer_count; i++)
		if (!strcmp(tissue->layer[i].def.name, name))
			return i;
	return -1;
}

const cau_sheet_material *cau_triangle_material(const cau_tissue *tissue, int32_t triangle)
{
	CAU_ASSERT_INDEX(triangle, tissue->triangle_count);
	CAU_ASSERT_INDEX(tissue->triangle_material[triangle],
	                 tissue->layer[tissue->triangle_layer[triangle]].def.material_count);
	return &tissue->layer[tissue->triangle_layer[triangle]]
	            .def.sheet[tissue->triangle_material[triangle]];
}

const cau_fat_material *cau_tetrahedron_material(const cau_tissue *tissue, int32_t tetrahedron)
{
	CAU_ASSERT_INDEX(tetrahedron, tissue->tetrahedron_count);
	CAU_ASSERT_INDEX(tissue->tetrahedron_material[tetrahedron],
	                 tissue->layer[tissue->tetrahedron_layer[tetrahedron]].def.material_count);
	return &tissue->layer[tissue->tetrahedron_layer[tetrahedron]]
	            .def.fat[tissue->tetrahedron_material[tetrahedron]];
}

int32_t cau_tissue_layer_of(const cau_tissue *tissue, int primitive, int32_t index)
{
	CAU_ASSERT_INDEX(index, cau_tissue_element_count(tissue, primitive));
	switch (primitive) {
	case CAU_PRIMITIVE_TRIANGLE:
		return tissue->triangle_layer[index];
	case CAU_PRIMITIVE_TETRAHEDRON:
		return tissue->tetrahedron_layer[index];
	default:
		return tissue->link_layer[index];
	}
}

const cau_heat_material *cau_layer_heat(const cau_tissue_layer *layer, int32_t material)
{
	CAU_ASSERT_INDEX(layer->def.kind, CAU_LAYER_COUNT);
	CAU_ASSERT_INDEX(material, CAU_MAX_MATERIALS);
	if (layer->def.kind == CAU_LAYER_FAT)
		return &layer->def.fat[material].heat;
	if (layer->def.kind == CAU_LAYER_LINKS)
		return &layer->def.link.heat;
	return &layer->def.sheet[material].heat;
}

void cau_fat_lame(const cau_fat_material *material, double *lambda, double *mu)
{
	double e = material->young_modulus_pa, nu = material->poisson_ratio;
	CAU_ASSERT(e > 0 && nu >= 0 && nu < 0.5, "Young's modulus %g Pa, Poisson's ratio %g", e, nu);
	*mu = e / (2 * (1 + nu));
	*lambda = e * nu / ((1 + nu) * (1 - 2 * nu));
}

// ---- elements
// Least length of a link for its stiffness, as a share of its reach. A link between vertices that
// (nearly) coincide is as stiff as a link of this length.
static const double shortest_truss = 0.01;

int32_t cau_tissue_element_count(const cau_tissue *tissue, int kind)
{
	CAU_ASSERT_INDEX(kind, CAU_ELEMENT_KINDS);
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

const int32_t *cau_tissue_vertices_of(const cau_tissue *tissue, int primitive, int32_t index,
                                      int *count)
{
	CAU_ASSERT_INDEX(index, cau_tissue_element_count(tissue, primitive));
	*count = primitive == CAU_PRIMITIVE_TRIANGLE      ? 3
	         : primitive == CAU_PRIMITIVE_TETRAHEDRON ? 4
	                                                  : 2;
	const int32_t *base = primitive == CAU_PRIMITIVE_TRIANGLE      ? tissue->triangle
	                      : primitive == CAU_PRIMITIVE_TETRAHEDRON ? tissue->tetrahedron
	                                                               : tissue->link;
	return base + (size_t)*count * (size_t)index;
}

// Sets the coefficients: vertices 1 to rank have the rows of D_m^-1, vertex 0 has minus their sum.
static void gradient_map(const double *dm_inverse, int rank, cau_element_map *map)
{
	CAU_ASSERT(rank == 2 || rank == 3, "a gradient of rank %d", rank);
	map->rank = rank;
	map->vertex_count = rank + 1;
	for (int c = 0; c < rank; c++) {
		double sum = 0;
		for (int i = 0; i < rank; i++) {
			map->coefficient[c][i + 1] = dm_inverse[rank * i + c];
			sum += dm_inverse[rank * i + c];
		}
		map->coefficient[c][0] = -sum;
	}
}

// Returns by what factor viscosity makes an element stiffer for a step.
static double viscous_share(const cau_tissue *tissue, int32_t layer)
{
	CAU_ASSERT_INDEX(layer, tissue->layer_count);
	return 1 + tissue->layer[layer].def.viscosity_s / tissue->inertia_s;
}

static double triangle_weight(const cau_tissue *tissue, int32_t triangle)
{
	const cau_sheet_material *material = cau_triangle_material(tissue, triangle);
	return viscous_share(tissue, tissue->triangle_layer[triangle]) * material->limit_stiffness_pa *
	       material->thickness_m * tissue->triangle_area[triangle];
}

// Returns the tetrahedron's weight: the stiffness of its energy at rest, 2 mu + 3 lambda, and the
// stiffness of its strain limit, if there is one or if shrinkage may set one.
static double tetrahedron_weight(const cau_tissue *tissue, int32_t tetrahedron)
{
	const cau_fat_material *material = cau_tetrahedron_material(tissue, tetrahedron);
	double lambda, mu;
	cau_fat_lame(material, &lambda, &mu);
	double viscous = viscous_share(tissue, tissue->tetrahedron_layer[tetrahedron]);
	double stiffness = viscous * (2 * mu + 3 * lambda);
	bool shrinks = material->shrink[0] != 1 || material->shrink[1] != 1 || material->shrink[2] != 1;
	if (material->limit != CAU_LIMIT_NONE || shrinks)
		stiffness += material->limit_stiffness_pa;
	return stiffness * tissue->tetrahedron_volume[tetrahedron];
}

void cau_tissue_element_map(const cau_tissue *tissue, int kind, int32_t index, cau_element_map *map)
{
	CAU_ASSERT_INDEX(index, cau_tissue_element_count(tissue, kind));
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

double cau_element_map_scale(const cau_element_map *map)
{
	CAU_ASSERT(map->vertex_count >= 2 && map->vertex_count <= 4, "an element of %d vertices",
	           map->vertex_count);
	double sum = 0;
	for (int r = 0; r < map->rank; r++)
		for (int i = 0; i < map->vertex_count; i++)
			sum += map->coefficient[r][i] * map->coefficient[r][i];
	return sum / map->vertex_count;
}
