// SPDX-License-Identifier: GPL-3.0-or-later
// A layer's definition takes the material that a command sets.
#include "cautery/assert.h"
#include "session/session_internal.h"

// Where the region's material stands; the first, which is the default, if the region has none.
static int32_t find_material(const cau_layer_def *def, bool fat, int32_t region)
{
	CAU_ASSERT(def->material_count >= 1 && def->material_count <= CAU_MAX_MATERIALS, "%d materials",
	           def->material_count);
	for (int32_t m = 0; m < def->material_count; m++)
		if ((fat ? def->fat[m].region : def->sheet[m].region) == region)
			return m;
	return 0;
}

bool cau_layer_take_material(cau_layer_def *def, const cau_command *command)
{
	bool fat = def->kind == CAU_LAYER_FAT, links = def->kind == CAU_LAYER_LINKS;
	int given = command->as.material.kind;
	if (fat != (given == CAU_LAYER_FAT) || links != (given == CAU_LAYER_LINKS))
		return false;
	if (fat)
		def->fat[find_material(def, fat, command->as.material.fat.region)] =
			command->as.material.fat;
	else if (links)
		def->link = command->as.material.link;
	else
		def->sheet[find_material(def, fat, command->as.material.sheet.region)] =
			command->as.material.sheet;
	return true;
}
