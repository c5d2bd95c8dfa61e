// SPDX-License-Identifier: GPL-3.0-or-later
// Sets laws and weights from the tissue's materials, and applies removals and shrinkage to the
// elements.
#include <math.h>
#include <string.h>

#include "base/vector.h"
#include "cautery/assert.h"
#include "constraint/elements_internal.h"

// ---- laws
const cau_law *cau_law_of(int model)
{
#define X(code, word, poisson_most, has_energy, keeps_rotation, lambda_mu, mu_mu, meaning)         \
	{#word, poisson_most, has_energy, keeps_rotation, lambda_mu, mu_mu, meaning},
	static const cau_law laws[] = {CAU_MODEL_TABLE(X)};
#undef X
	CAU_ASSERT_INDEX(model, CAU_MODEL_COUNT);
	return &laws[model];
}

// ---- elements
static void set_sheet_law(cau_sheet_group *group, const cau_sheet_material *material)
{
	group->limit = material->limit;
	group->projection = material->projection;
	for (int a = 0; a < 2; a++) {
		group->stretch_min[a] = 1 + material->strain_min[a];
		group->stretch_max[a] = 1 + material->strain_max[a];
		CAU_ASSERT(group->stretch_min[a] <= group->stretch_max[a], "stretches from %g to %g",
		           group->stretch_min[a], group->stretch_max[a]);
	}
	group->shear_max = material->shear_max;
}

// Finds the material axes of fat as rows of a rotation: first the fibre direction, then two
// perpendicular directions.
static void fat_axes(const double fibre[3], double axes[3][3])
{
	cau_vec3 a = cau_unit_or(cau_vec3_of(fibre), (cau_vec3){1, 0, 0});
	cau_vec3 helper = fabs(a.z) < 0.9 ? (cau_vec3){0, 0, 1} : (cau_vec3){1, 0, 0};
	cau_vec3 b = cau_unit_or(cau_cross(helper, a), (cau_vec3){0, 1, 0});
	cau_vec3_to(a, axes[0]);
	cau_vec3_to(b, axes[1]);
	cau_vec3_to(cau_cross(a, b), axes[2]);
}

// Turns a symmetric matrix from material axes to world axes: R^T S R. It is computed as I + R^T (S
// - I) R, so that I stays exactly I.
static void to_world(const double s[6], double axes[3][3], double out[6])
{
	static const int row[6] = {0, 1, 2, 0, 0, 1}, column[6] = {0, 1, 2, 1, 2, 2};
	const double full[3][3] = {
		{s[0] - 1, s[3], s[4]}, {s[3], s[1] - 1, s[5]}, {s[4], s[5], s[2] - 1}};
	for (int k = 0; k < 6; k++) {
		out[k] = k < 3;
		for (int i = 0; i < 3; i++)
			for (int j = 0; j < 3; j++)
				out[k] += axes[i][row[k]] * full[i][j] * axes[j][column[k]];
	}
}

// Computes T^(1/2) in world axes; 0 without a target.
static void fat_target_root(const cau_fat_material *material, const double fibre[3], double root[6])
{
	double axes[3][3], world[6];
	memset(root, 0, 6 * sizeof *root);
	if (material->limit != CAU_LIMIT_TARGET)
		return;
	fat_axes(fibre, axes);
	to_world(material->target, axes, world);
	cau_symmetric_power3(world, 0.5, 0, root);
	CAU_ASSERT(root[0] > 0 && root[1] > 0 && root[2] > 0, "a target of %g, %g, %g", root[0],
	           root[1], root[2]);
}

static void set_fat_law(cau_fat_group *group, const cau_fat_material *material,
                        const double fibre[3], double viscosity_s)
{
	double lambda, mu;
	const cau_law *law = cau_law_of(material->model);
	cau_fat_lame(material, &lambda, &mu);
	group->model = material->model;
	group->keeps_rotation = law->keeps_rotation;
	group->limit = material->limit;
	group->projection = material->projection;
	group->plastic = material->plastic_strain_max > 0;
	group->stiffness = 2 * mu + 3 * lambda;
	group->mu = law->mu_mu * mu;
	group->lambda = lambda + law->lambda_mu * mu;
	CAU_ASSERT(group->stiffness > 0 && group->mu > 0 && group->lambda >= 0,
	           "stiffness %g, mu %g, lambda %g Pa", group->stiffness, group->mu, group->lambda);
	group->limit_stiffness = material->limit_stiffness_pa;
	fat_target_root(material, fibre, group->target);
	for (int a = 0; a < 3; a++) {
		group->stretch_min[a] = 1 + material->strain_min[a];
		group->stretch_max[a] = 1 + material->strain_max[a];
	}
	group->shear_max = material->shear_max;
	group->yield_strain = material->yield_strain;
	group->plastic_strain_max = material->plastic_strain_max;
	group->viscous_mu = viscosity_s * mu;
	group->viscous_lambda = viscosity_s * lambda;
}

static void set_sheet_slot(cau_sheet_set *set, bool single, int32_t slot, const cau_tissue *tissue,
                           int32_t element, int alive, int keep_target)
{
	CAU_ASSERT_INDEX(slot, set->slot_count);
	const cau_sheet_material *material = cau_triangle_material(tissue, element);
	cau_element_map map;
	cau_tissue_element_map(tissue, CAU_ELEMENT_TRIANGLE, element, &map);
	double viscosity_s = tissue->layer[tissue->triangle_layer[element]].def.viscosity_s;
	// map.weight is the element's weight in A, which includes viscosity's part
	double weight = map.weight / (1 + viscosity_s / tissue->inertia_s);
	cau_real_set(set->weight, single, slot, alive ? weight : 0);
	if (keep_target)
		return;
	double root[3] = {0, 0, 0}; // no target
	if (material->limit == CAU_LIMIT_TARGET)
		cau_symmetric_power2(material->target, 0.5, 0, root);
	for (int i = 0; i < 3; i++)
		cau_real_set(set->target[i], single, slot, root[i]);
}

static void set_fat_slot(cau_fat_set *set, bool single, int32_t slot, const cau_tissue *tissue,
                         int32_t element, int alive, int keep_target)
{
	CAU_ASSERT_INDEX(slot, set->slot_count);
	const cau_fat_material *material = cau_tetrahedron_material(tissue, element);
	double volume = alive ? tissue->tetrahedron_volume[element] : 0;
	int limited = material->limit != CAU_LIMIT_NONE || keep_target;
	cau_real_set(set->volume, single, slot, volume);
	cau_real_set(set->limit_weight, single, slot,
	             limited ? volume * material->limit_stiffness_pa : 0);
	set->limited[slot / CAU_BATCH] |= (uint8_t)limited;
	if (keep_target)
		return;
	double root[6];
	fat_target_root(material, tissue->layer[tissue->tetrahedron_layer[element]].def.fibre, root);
	for (int i = 0; i < 6; i++)
		cau_real_set(set->target[i], single, slot, root[i]);
}

void cau_elements_remove(cau_elements *elements, const cau_element_slots *slots, int kind,
                         int32_t element)
{
	CAU_ASSERT_INDEX(kind, CAU_ELEMENT_KINDS);
	CAU_ASSERT(element >= 0, "element %d of kind %d", element, kind);
	int32_t slot = slots->slot_of[kind][element];
	CAU_ASSERT(slots->element_at[kind][slot] == element, "slot %d has element %d, not %d", slot,
	           slots->element_at[kind][slot], element);
	bool single = elements->single;
	switch (kind) {
	case CAU_ELEMENT_TRIANGLE:
		cau_real_set(elements->sheet.weight, single, slot, 0);
		break;
	case CAU_ELEMENT_TETRAHEDRON:
		cau_real_set(elements->fat.volume, single, slot, 0);
		cau_real_set(elements->fat.limit_weight, single, slot, 0);
		break;
	case CAU_ELEMENT_LINK:
		cau_real_set(elements->link.weight, single, slot, 0);
		break;
	default:
		cau_real_set(elements->hinge.weight, single, slot, 0);
		break;
	}
}

void cau_elements_set_target(cau_elements *elements, const cau_element_slots *slots,
                             const cau_tissue *tissue, int kind, int32_t element,
                             const double *root)
{
	CAU_ASSERT(kind == CAU_ELEMENT_TRIANGLE || kind == CAU_ELEMENT_TETRAHEDRON,
	           "a target for kind %d", kind);
	CAU_ASSERT_INDEX(element, cau_tissue_element_count(tissue, kind));
	int32_t slot = slots->slot_of[kind][element];
	bool single = elements->single;
	if (kind == CAU_ELEMENT_TRIANGLE) {
		for (int i = 0; i < 3; i++)
			cau_real_set(elements->sheet.target[i], single, slot, root[i]);
		return;
	}
	for (int i = 0; i < 6; i++)
		cau_real_set(elements->fat.target[i], single, slot, root[i]);
	double stiffness = cau_tetrahedron_material(tissue, element)->limit_stiffness_pa;
	cau_real_set(elements->fat.limit_weight, single, slot,
	             stiffness * cau_real_get(elements->fat.volume, single, slot));
	elements->fat.limited[slot / CAU_BATCH] = elements->fat.targeted[slot / CAU_BATCH] = 1;
}

void cau_elements_target(const cau_elements *elements, const cau_element_slots *slots, int kind,
                         int32_t element, double *root)
{
	CAU_ASSERT(kind == CAU_ELEMENT_TRIANGLE || kind == CAU_ELEMENT_TETRAHEDRON,
	           "a target of kind %d", kind);
	int32_t slot = slots->slot_of[kind][element];
	CAU_ASSERT(slots->element_at[kind][slot] == element, "slot %d has element %d, not %d", slot,
	           slots->element_at[kind][slot], element);
	int count = kind == CAU_ELEMENT_TRIANGLE ? 3 : 6;
	void *const *target =
		kind == CAU_ELEMENT_TRIANGLE ? elements->sheet.target : elements->fat.target;
	for (int i = 0; i < count; i++)
		root[i] = cau_real_get(target[i], elements->single, slot);
}

void cau_elements_set_laws(cau_elements *elements, const cau_tissue *tissue)
{
	for (int32_t g = 0; g < elements->sheet.group_count; g++) {
		cau_sheet_group *group = &elements->sheet.group[g];
		CAU_ASSERT_INDEX(group->layer, tissue->layer_count);
		set_sheet_law(group, &tissue->layer[group->layer].def.sheet[group->material]);
		group->viscosity_s = tissue->layer[group->layer].def.viscosity_s;
	}
	for (int32_t g = 0; g < elements->fat.group_count; g++) {
		cau_fat_group *group = &elements->fat.group[g];
		CAU_ASSERT(tissue->layer[group->layer].def.kind == CAU_LAYER_FAT,
		           "group %d of fat in a layer of kind %d", g,
		           tissue->layer[group->layer].def.kind);
		const cau_layer_def *layer = &tissue->layer[group->layer].def;
		set_fat_law(group, &layer->fat[group->material], layer->fibre, layer->viscosity_s);
	}
}

static bool has_target(const cau_fat_set *set, bool single, int32_t slot, const double root[6])
{
	for (int i = 0; i < 6; i++) {
		double common = single ? (double)(float)root[i] : root[i];
		if (cau_real_get(set->target[i], single, slot) != common)
			return false;
	}
	return true;
}

void cau_elements_mark_targets(cau_elements *elements, const cau_element_slots *slots)
{
	cau_fat_set *set = &elements->fat;
	memset(set->targeted, 0, (size_t)(set->slot_count / CAU_BATCH));
	for (int32_t g = 0; g < set->group_count; g++) {
		const cau_fat_group *group = &set->group[g];
		CAU_ASSERT(group->first_slot + group->slot_count <= set->slot_count, "slots %d + %d of %d",
		           group->first_slot, group->slot_count, set->slot_count);
		for (int32_t s = group->first_slot; s < group->first_slot + group->slot_count; s++)
			set->targeted[s / CAU_BATCH] |= slots->element_at[CAU_ELEMENT_TETRAHEDRON][s] >= 0 &&
			                                !has_target(set, elements->single, s, group->target);
	}
}

void cau_elements_set_materials(cau_elements *elements, const cau_element_slots *slots,
                                const cau_tissue *tissue, uint8_t *const alive[CAU_ELEMENT_KINDS],
                                uint8_t *const shrunk[2])
{
	bool single = elements->single;
	cau_elements_set_laws(elements, tissue);
	for (int32_t t = 0; t < tissue->triangle_count; t++)
		set_sheet_slot(&elements->sheet, single, slots->slot_of[CAU_ELEMENT_TRIANGLE][t], tissue, t,
		               alive[CAU_ELEMENT_TRIANGLE][t], shrunk[CAU_ELEMENT_TRIANGLE][t]);
	memset(elements->fat.limited, 0, (size_t)(elements->fat.slot_count / CAU_BATCH));
	for (int32_t t = 0; t < tissue->tetrahedron_count; t++)
		set_fat_slot(&elements->fat, single, slots->slot_of[CAU_ELEMENT_TETRAHEDRON][t], tissue, t,
		             alive[CAU_ELEMENT_TETRAHEDRON][t], shrunk[CAU_ELEMENT_TETRAHEDRON][t]);
	cau_elements_mark_targets(elements, slots);
	cau_element_map map;
	for (int32_t k = 0; k < tissue->link_count; k++) {
		cau_tissue_element_map(tissue, CAU_ELEMENT_LINK, k, &map);
		cau_real_set(elements->link.weight, single, k, alive[CAU_ELEMENT_LINK][k] ? map.weight : 0);
	}
	for (int32_t k = 0; k < tissue->hinge_count; k++) {
		cau_tissue_element_map(tissue, CAU_ELEMENT_HINGE, k, &map);
		cau_real_set(elements->hinge.weight, single, k,
		             alive[CAU_ELEMENT_HINGE][k] ? map.weight : 0);
	}
}
