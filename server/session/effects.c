// SPDX-License-Identifier: GPL-3.0-or-later
#include "cautery/assert.h"
#include "session/internal.h"

cau_effect *cau_effect_add(cau_effects *effects, cau_effect_kind kind, uint64_t ticket)
{
	// see CAU_EFFECTS_MOST for why this capacity suffices
	CAU_RULE_INDEX(effects->count, CAU_EFFECTS_MOST);
	cau_effect *made = &effects->list[effects->count++];
	made->kind = kind;
	made->ticket = ticket;
	made->code = 0;
	return made;
}

// Reports a tool at most once for each event. A later report of the same tool replaces the earlier
// one.
void cau_effect_tell(cau_effects *effects, const cau_drive *drive)
{
	CAU_RULE(drive->tool[0] != 0, "a tool without a name, among %d effects", effects->count);
	for (int32_t i = 0; i < effects->count; i++) {
		cau_effect *told = &effects->list[i];
		if (told->kind == CAU_EFFECT_TELL && strcmp(told->drive.tool, drive->tool) == 0) {
			told->drive = *drive;
			return;
		}
	}
	cau_effect_add(effects, CAU_EFFECT_TELL, 0)->drive = *drive;
}

static void add_once(cau_effects *effects, cau_effect_kind kind)
{
	CAU_RULE(kind == CAU_EFFECT_WAKE || kind == CAU_EFFECT_ARMED, "effect %d once", (int)kind);
	for (int32_t i = 0; i < effects->count; i++)
		if (effects->list[i].kind == kind)
			return;
	cau_effect_add(effects, kind, 0);
}

void cau_effect_wake(cau_effects *effects)
{
	add_once(effects, CAU_EFFECT_WAKE);
}

void cau_effect_armed(cau_effects *effects)
{
	add_once(effects, CAU_EFFECT_ARMED);
}
