// SPDX-License-Identifier: Apache-2.0
// The members that a command may have.
#include "cautery/assert.h"
#include "json/document.h"
#include "json/record.h"

CHOICES(command_choices, CAU_COMMAND_TABLE)
CHOICES(material_kind_choices, CAU_LAYER_TABLE)

#define KIND(code) (1u << CAU_COMMAND_##code)
#define NEEDS_TOOL                                                                                 \
	(KIND(TOOL_REMOVE) | KIND(TOOL_CONFIGURE) | KIND(TOOL_MOVE) | KIND(TOOL_ENERGIZE) |            \
	 KIND(TOOL_GRASP) | KIND(TOOL_RELEASE) | KIND(TOOL_HOLD))

// clang-format off: tables
static const cau_field command_fields[] = {
	{.name = "command",
     .type = CAU_FIELD_CHOICE,
     .offset = offsetof(cau_command, kind),
     .choices = &command_choices,
     .required = true,
     MEANS("", "which command")},
#define STRUCT cau_command
	{OTHER(tick, COUNT,
           "the command takes effect at the first tick border at or after this tick; 0: the next")},
	{OTHER(sequence, COUNT, "number that the driver gives the command")},
	{OTHER(tool, NAME, "name of the tool"), .required = true, .kinds = NEEDS_TOOL},
};
#undef STRUCT
#undef KIND
RECORD(cau_command_record, "a command", command_fields, &command_choices)

// Declares a member inside the union, with its offset from the struct that contains it.
#define INSIDE(member, group)                                                                      \
	.name = #member,                                                                               \
	.offset = offsetof(cau_command, as.group.member) - offsetof(cau_command, as.group)

static const cau_field move_fields[] = {
	{.name = "position_m",
     .type = CAU_FIELD_NUMBER,
     .count = 3,
     RANGE(-CAU_PLACE_MOST_M, CAU_PLACE_MOST_M),
     .offset = offsetof(cau_command, as.move.pose.position_m) - offsetof(cau_command, as.move),
     .required = true,
     MEANS("m", "position of the tip")},
	{.name = "rotation",
     .type = CAU_FIELD_ROTATION,
     .offset = offsetof(cau_command, as.move.pose.rotation) - offsetof(cau_command, as.move),
     .required = true,
     MEANS("", "unit quaternion w, x, y, z")},
	{INSIDE(jaw, move), .type = CAU_FIELD_NUMBER, RANGE(0.0, 1.0),
     MEANS("1", "opening of the jaws: 0 closed to 1 open")},
};
RECORD(cau_move_record, "a move", move_fields, NULL)

static const cau_field energize_fields[] = {
	{.name = "energized",
     .type = CAU_FIELD_FLAG,
     .required = true,
     MEANS("", "whether energy is turned on or off")},
};
RECORD(cau_energize_record, "energy", energize_fields, NULL)

static const cau_field energize_limit_fields[] = {
	{.name = "ticks",
     .type = CAU_FIELD_INTEGER,
     RANGE(0.0, INT32_MAX),
     MEANS("1", "energy goes off this many ticks after an enable; 0: no limit")},
};
RECORD(cau_energize_limit_record, "a limit", energize_limit_fields, NULL)

static const cau_field material_fields[] = {
	{INSIDE(kind, material), .type = CAU_FIELD_CHOICE, .choices = &material_kind_choices,
     .required = true, MEANS("", "kind of the layer")},
	{INSIDE(layer, material), .type = CAU_FIELD_NAME, .required = true,
     MEANS("", "name of the layer")},
};
RECORD(cau_material_record, "a material", material_fields, NULL)

static const cau_field material_region_fields[] = {
	{.name = "region",
     .type = CAU_FIELD_INTEGER,
     RANGE(0.0, INT32_MAX),
     MEANS("1", "number of a region in the mesh file; 0: the layer's own material")},
};
RECORD(cau_material_region_record, "a region", material_region_fields, NULL)

static const cau_field gravity_fields[] = {
	{.name = "gravity_m_s2",
     .type = CAU_FIELD_NUMBER,
     .count = 3,
     .required = true,
     RANGE(-CAU_GRAVITY_MOST_M_S2, CAU_GRAVITY_MOST_M_S2),
     MEANS("m/s^2", "gravity")},
};
RECORD(cau_gravity_record, "gravity", gravity_fields, NULL)

static const cau_field force_fields[] = {
	{INSIDE(force_n, force), .type = CAU_FIELD_NUMBER, .count = 3, .required = true,
     RANGE(-CAU_FORCE_MOST_N, CAU_FORCE_MOST_N), MEANS("N", "force on each chosen vertex")},
};
RECORD(cau_force_record, "a force", force_fields, NULL)
// clang-format on

static int add_material(cau_command *command, cau_part *parts)
{
	CAU_ASSERT(command->kind == CAU_COMMAND_SET_MATERIAL, "the material of command %d",
	           command->kind);
	int kind = command->as.material.kind;
	cau_sheet_material *sheet = &command->as.material.sheet;
	cau_fat_material *fat = &command->as.material.fat;
	int count = 0;
	parts[count++] = (cau_part){&cau_material_record, &command->as.material, 0};
	if (kind != CAU_LAYER_LINKS) {
		int32_t *region = kind == CAU_LAYER_FAT ? &fat->region : &sheet->region;
		parts[count++] = (cau_part){&cau_material_region_record, region, 0};
	}
	return count + cau_material_parts(kind, sheet, fat, &command->as.material.link, parts + count);
}

static int add_tool(cau_command *command, cau_part *parts)
{
	CAU_ASSERT(command->kind == CAU_COMMAND_TOOL_ADD || command->kind == CAU_COMMAND_TOOL_CONFIGURE,
	           "the tool of command %d", command->kind);
	cau_tool_def *tool = &command->as.definition;
	int count = 0;
	parts[count++] = (cau_part){&cau_tool_record, tool, 0};
	if (command->kind == CAU_COMMAND_TOOL_ADD) {
		parts[count++] = (cau_part){&cau_tool_name_record, tool, 0};
		parts[count++] = (cau_part){&cau_pose_record, &tool->pose, 0};
	}
	return count;
}

int cau_command_parts(cau_command *command, cau_part parts[CAU_MAX_PARTS])
{
	CAU_ASSERT_INDEX(command->kind, CAU_COMMAND_COUNT);
	parts[0] = (cau_part){&cau_command_record, command, command->kind};
	switch (command->kind) {
	case CAU_COMMAND_TOOL_ADD:
	case CAU_COMMAND_TOOL_CONFIGURE:
		return 1 + add_tool(command, parts + 1);
	case CAU_COMMAND_SET_MATERIAL:
		return 1 + add_material(command, parts + 1);
	case CAU_COMMAND_TOOL_MOVE:
		parts[1] = (cau_part){&cau_move_record, &command->as.move, 0};
		return 2;
	case CAU_COMMAND_TOOL_ENERGIZE:
		parts[1] = (cau_part){&cau_energize_record, &command->as.energized, 0};
		parts[2] = (cau_part){&cau_energize_limit_record, &command->as.ticks, 0};
		return 3;
	case CAU_COMMAND_SET_GRAVITY:
		parts[1] = (cau_part){&cau_gravity_record, command->as.gravity_m_s2, 0};
		return 2;
	case CAU_COMMAND_SET_FORCE:
		parts[1] = (cau_part){&cau_force_record, &command->as.force, 0};
		return 2;
	default:
		return 1;
	}
}

int cau_command_parts_to_write(cau_command *command, cau_part parts[CAU_MAX_PARTS])
{
	int count = cau_command_parts(command, parts);
	CAU_ASSERT(count > 0, "command %d has no parts", command->kind);
	bool unlimited = command->kind == CAU_COMMAND_TOOL_ENERGIZE && !command->as.ticks;
	return unlimited ? count - 1 : count;
}

cau_selection *cau_command_selection(cau_command *command)
{
	if (command->kind == CAU_COMMAND_PIN || command->kind == CAU_COMMAND_UNPIN)
		return &command->as.selection;
	if (command->kind == CAU_COMMAND_SET_FORCE)
		return &command->as.force.selection;
	return NULL;
}
