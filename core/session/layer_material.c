// SPDX-License-Identifier: GPL-3.0-or-later
// Sets a command's material in a layer's definition, or finds that the layer has this material
// already.
#include "cautery/assert.h"
#include "session/session_internal.h"

// Returns the index of the region's material; 0 (the default) if the region has no material of its
// own.
static int32_t find_material(const cau_layer_def *def, bool fat, int32_t region)
{
	CAU_ASSERT(def->material_count >= 1 && def->material_count <= CAU_MAX_MATERIALS, "%d materials",
	           def->material_count);
	for (int32_t m = 0; m < def->material_count; m++)
		if ((fat ? def->fat[m].region : def->sheet[m].region) == region)
			return m;
	return 0;
}

static bool fits(const cau_layer_def *def, const cau_command *command)
{
	bool fat = def->kind == CAU_LAYER_FAT, links = def->kind == CAU_LAYER_LINKS;
	int given = command->as.material.kind;
	return fat == (given == CAU_LAYER_FAT) && links == (given == CAU_LAYER_LINKS);
}

bool cau_layer_take_material(cau_layer_def *def, const cau_command *command)
{
	if (!fits(def, command))
		return false;
	if (def->kind == CAU_LAYER_FAT)
		def->fat[find_material(def, true, command->as.material.fat.region)] =
			command->as.material.fat;
	else if (def->kind == CAU_LAYER_LINKS)
		def->link = command->as.material.link;
	else
		def->sheet[find_material(def, false, command->as.material.sheet.region)] =
			command->as.material.sheet;
	return true;
}

// ---- whether the layer has the material already Compares field by field, because the padding
// bytes between fields may differ.

#define SAME(name, ...) &&a->name == b->name

static bool same_numbers(const double *a, const double *b, int count)
{
	for (int i = 0; i < count; i++)
		if (a[i] != b[i])
			return false;
	return true;
}

static bool same_heat(const cau_heat_material *a, const cau_heat_material *b)
{
	return true CAU_HEAT_TABLE(SAME);
}

static bool same_sheet(const cau_sheet_material *a, const cau_sheet_material *b)
{
	return a->region == b->region CAU_SHEET_TABLE(SAME) && a->limit == b->limit &&
	       a->projection == b->projection && same_numbers(a->target, b->target, 3) &&
	       same_numbers(a->strain_min, b->strain_min, 2) &&
	       same_numbers(a->strain_max, b->strain_max, 2) && same_numbers(a->shrink, b->shrink, 2) &&
	       same_heat(&a->heat, &b->heat);
}

static bool same_fat(const cau_fat_material *a, const cau_fat_material *b)
{
	return a->region == b->region CAU_FAT_TABLE(SAME) && a->model == b->model &&
	       a->limit == b->limit && a->projection == b->projection &&
	       same_numbers(a->target, b->target, 6) && same_numbers(a->strain_min, b->strain_min, 3) &&
	       same_numbers(a->strain_max, b->strain_max, 3) && same_numbers(a->shrink, b->shrink, 3) &&
	       same_heat(&a->heat, &b->heat);
}

static bool same_link(const cau_link_material *a, const cau_link_material *b)
{
	return true CAU_LINK_TABLE(SAME) && same_heat(&a->heat, &b->heat);
}

bool cau_layer_has_material(const cau_layer_def *def, const cau_command *command)
{
	if (!fits(def, command))
		return true;
	if (def->kind == CAU_LAYER_LINKS)
		return same_link(&def->link, &command->as.material.link);
	if (def->kind == CAU_LAYER_FAT) {
		const cau_fat_material *fat = &command->as.material.fat;
		return same_fat(&def->fat[find_material(def, true, fat->region)], fat);
	}
	const cau_sheet_material *sheet = &command->as.material.sheet;
	return same_sheet(&def->sheet[find_material(def, false, sheet->region)], sheet);
}
