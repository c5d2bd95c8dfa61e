// SPDX-License-Identifier: GPL-3.0-or-later
// Materials in a snapshot, those in commands that wait among them, and what has torn of them.
#include <stddef.h>

#include "session/snapshot_archive.h"
#include "session/snapshot_header.h"

// What a material bears came with version 6, as its last member, and has a place of its own below:
// the materials themselves are passed as they have always been.
enum { BEARING_BYTES = sizeof(cau_heat_material) - offsetof(cau_heat_material, tear_energy_j_m2) };
_Static_assert(BEARING_BYTES == sizeof(double), "what a material bears is its last member");
_Static_assert(offsetof(cau_layer_def, link) + sizeof(cau_link_material) == sizeof(cau_layer_def),
               "nothing is behind a layer's last material");
_Static_assert(sizeof((cau_command *)0)->as == sizeof((cau_command *)0)->as.material,
               "a command with materials is the longest");

void cau_snapshot_pass_materials(snapshot_archive *archive, cau_sheet_material *sheet,
                                 cau_fat_material *fat, cau_link_material *link, int count)
{
	for (int i = 0; i < count; i++)
		snapshot_pass(archive, &sheet[i], sizeof *sheet - BEARING_BYTES);
	for (int i = 0; i < count; i++)
		snapshot_pass(archive, &fat[i], sizeof *fat - BEARING_BYTES);
	snapshot_pass(archive, link, sizeof *link - BEARING_BYTES);
}

// Its definition grew by what jaws press with, at the cost of the room behind it.
enum { TOOL_BYTES_SINCE_8 = sizeof(double) };

static bool is_of_tool(const cau_command *command)
{
	return command->kind == CAU_COMMAND_TOOL_ADD || command->kind == CAU_COMMAND_TOOL_CONFIGURE;
}

void cau_snapshot_pass_command(snapshot_archive *archive, cau_command *command)
{
	const size_t before = offsetof(cau_command, as), all = sizeof *command - 3 * BEARING_BYTES;
	snapshot_pass(archive, command, before);
	if (archive->bytes && is_of_tool(command)) {
		const size_t definition = sizeof command->as.definition - TOOL_BYTES_SINCE_8;
		cau_snapshot_pass_tool_def(archive, &command->as.definition);
		snapshot_pass(archive, (char *)&command->as + sizeof command->as.definition,
		              all - before - definition -
		                  (archive->version >= CAU_SNAPSHOT_JAWS ? TOOL_BYTES_SINCE_8 : 0));
		return;
	}
	if (!archive->bytes || command->kind != CAU_COMMAND_SET_MATERIAL) {
		snapshot_pass(archive, &command->as, all - before);
		return;
	}
	const size_t sheet = offsetof(cau_command, as.material.sheet);
	snapshot_pass(archive, &command->as, sheet - before);
	cau_snapshot_pass_materials(archive, &command->as.material.sheet, &command->as.material.fat,
	                            &command->as.material.link, 1);
}

static void pass_bearings(snapshot_archive *archive, cau_sheet_material *sheet,
                          cau_fat_material *fat, cau_link_material *link, int count)
{
	for (int i = 0; i < count; i++)
		snapshot_pass(archive, &sheet[i].heat.tear_energy_j_m2, BEARING_BYTES);
	for (int i = 0; i < count; i++)
		snapshot_pass(archive, &fat[i].heat.tear_energy_j_m2, BEARING_BYTES);
	snapshot_pass(archive, &link->heat.tear_energy_j_m2, BEARING_BYTES);
}

// Since version 6: what materials bear, and which elements are over it.
void cau_snapshot_pass_tears(snapshot_archive *archive, cau_session *session)
{
	cau_tears *tears = &session->dissection.tears;
	for (int32_t i = 0; i < session->tissue.layer_count; i++) {
		cau_layer_def *def = &session->tissue.layer[i].def;
		pass_bearings(archive, def->sheet, def->fat, &def->link, CAU_MAX_MATERIALS);
	}
	for (int32_t i = 0; i < session->command_count; i++) {
		cau_command none, *command = &session->command[i];
		memset(&none, 0, sizeof none); // others have the same room, empty
		if (command->kind != CAU_COMMAND_SET_MATERIAL)
			command = &none;
		pass_bearings(archive, &command->as.material.sheet, &command->as.material.fat,
		              &command->as.material.link, 1);
	}
	snapshot_pass(archive, tears->over, (size_t)tears->over_count * sizeof *tears->over);
}
