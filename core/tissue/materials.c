// SPDX-License-Identifier: GPL-3.0-or-later
// Finds layers by name, and the materials of layers and elements.
#include <string.h>

#include "cautery/assert.h"
#include "tissue/tissue.h"

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
