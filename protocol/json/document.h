// SPDX-License-Identifier: Apache-2.0
// Scenes, commands and instruments: the tables of their members, and the functions that read and
// write them as members of larger documents, such as requests.
#pragma once

#include "cautery/command.h"
#include "cautery/instrument.h"
#include "cautery/json_writer.h"
#include "cautery/scene.h"
#include "json/record.h"

// ---- macros for the tables of fields
// STRUCT must be defined as the struct whose fields follow. All macros except SCALAR are used
// inside braces, where more members (.required, .kinds) may follow.

#define CHOICE_NAME(code, json_name) json_name,
#define CHOICES(variable, TABLE)                                                                   \
	static const char *const variable##_names[] = {TABLE(CHOICE_NAME)};                            \
	static const cau_choices variable = {variable##_names,                                         \
	                                     (int)(sizeof variable##_names / sizeof(char *))};

// Defines choices from a table X(code, word, ...) whose words are identifiers, not strings.
#define CHOICE_WORD(code, word, ...) #word,
#define CHOICES_OF_WORDS(variable, TABLE)                                                          \
	static const char *const variable##_names[] = {TABLE(CHOICE_WORD)};                            \
	static const cau_choices variable = {variable##_names,                                         \
	                                     (int)(sizeof variable##_names / sizeof(char *))};

#define PLACE(member) .name = #member, .offset = offsetof(STRUCT, member)
#define MEANS(unit_, meaning_) .unit = unit_, .meaning = meaning_
#define RANGE(least_, most_) .least = least_, .most = most_

#define SCALAR_OF(member, least_, most_, unit_, meaning_)                                          \
	PLACE(member), .type = CAU_FIELD_NUMBER, RANGE(least_, most_), MEANS(unit_, meaning_)
// A field from an entry of a table X(field, default, least, most, unit, meaning) of scene.h.
#define SCALAR(member, default_, least_, most_, unit_, meaning_)                                   \
	{SCALAR_OF(member, least_, most_, unit_, meaning_)},
#define VECTOR(member, count_, least_, most_, unit_, meaning_)                                     \
	SCALAR_OF(member, least_, most_, unit_, meaning_), .count = count_
#define INTEGER(member, least_, most_, meaning_)                                                   \
	PLACE(member), .type = CAU_FIELD_INTEGER, RANGE(least_, most_), MEANS("1", meaning_)
#define CHOICE(member, choices_, meaning_)                                                         \
	PLACE(member), .type = CAU_FIELD_CHOICE, .choices = &choices_, MEANS("", meaning_)
#define OTHER(member, TYPE, meaning_) PLACE(member), .type = CAU_FIELD_##TYPE, MEANS("", meaning_)

#define RECORD(variable, title_, fields_, kinds_)                                                  \
	const cau_record variable = {title_, fields_, (int)(sizeof fields_ / sizeof *fields_), kinds_};

// ---- tables
// Which members each JSON object may have. If members depend on a kind, the record's first field is
// that kind. The comment at each table names the C type, or the member, that the table reads and
// writes.

extern const cau_record cau_scene_record; // cau_scene_def, without its arrays
// cau_mesh_def; its members depend on the source
extern const cau_record cau_mesh_record;
// cau_layer_def without materials; its members depend on the kind
extern const cau_record cau_layer_record;
extern const cau_record cau_region_record;       // int32_t, the region of a material
extern const cau_record cau_sheet_record;        // cau_sheet_material
extern const cau_record cau_fat_record;          // cau_fat_material
extern const cau_record cau_link_record;         // cau_link_material
extern const cau_record cau_heat_record;         // cau_heat_material
extern const cau_record cau_selection_record;    // cau_selection; its members depend on the kind
extern const cau_record cau_tool_name_record;    // the name of cau_tool_def
extern const cau_record cau_tool_record;         // cau_tool_def without name and pose
extern const cau_record cau_pose_record;         // cau_pose
extern const cau_record cau_vessel_record;       // cau_vessel_def without its points
extern const cau_record cau_vessel_point_record; // double[3], one point of a vessel
extern const cau_record cau_pull_record;         // cau_pull_def without its selection
extern const cau_record cau_cut_record;          // cau_cut_def
// cau_command without `as`; its members depend on the kind
extern const cau_record cau_command_record;
extern const cau_record cau_move_record;            // cau_command.as.move
extern const cau_record cau_energize_record;        // cau_command.as.energized
extern const cau_record cau_energize_limit_record;  // cau_command.as.ticks
extern const cau_record cau_material_record;        // cau_command.as.material without its materials
extern const cau_record cau_material_region_record; // int32_t, the region; 0 if absent
extern const cau_record cau_gravity_record;         // cau_command.as.gravity_m_s2
extern const cau_record cau_force_record;           // cau_command.as.force without its selection

// Lists the parts of a material for a layer of kind `layer_kind`, and returns their number. Only
// the pointer that belongs to this kind must be given.
int cau_material_parts(int layer_kind, cau_sheet_material *sheet, cau_fat_material *fat,
                       cau_link_material *link, cau_part parts[2]);

// Lists all parts of a command and returns their number: its head, then the parts of its kind. For
// SET_MATERIAL, the material's kind must already be set.
int cau_command_parts(cau_command *command, cau_part parts[CAU_MAX_PARTS]);
// Lists the parts of a command to write. For an enable without a limit, the part with the limit is
// left out, because older builds do not know this part.
int cau_command_parts_to_write(cau_command *command, cau_part parts[CAU_MAX_PARTS]);
// Returns the selection of a command, or NULL if it has none.
cau_selection *cau_command_selection(cau_command *command);

// ---- instruments
// The members `instrument` and `mode` of the object that describes a tool.

typedef struct cau_choice_names {
	char instrument[CAU_NAME_BYTES], mode[CAU_NAME_BYTES];
} cau_choice_names;

typedef struct cau_tool_choice {
	cau_choice_names names; // the names in the object
	bool chosen;
	cau_instrument_mode mode; // the mode that the object names; only if `chosen`
} cau_tool_choice;

extern const cau_record cau_instrument_record; // cau_choice_names

// Call it before the members of a tool are read. It gives the tool the members of the instrument
// that `object` names.
void cau_begin_tool(cau_reader *reader, const cJSON *object, cau_tool_def *tool,
                    cau_tool_choice *choice);
// Call it after the members of a tool are read. It fails if the tool's power is outside the mode's
// range.
void cau_end_tool(cau_reader *reader, const cau_tool_def *tool, const cau_tool_choice *choice);

// A profile in the build. The profiles are sorted by name.
typedef struct cau_instrument_file {
	const char *name; // file name without its ending
	const char *text;
	size_t bytes;
} cau_instrument_file;

extern const cau_instrument_file cau_instrument_files[];
extern const int32_t cau_instrument_file_count;

// ---- readers and writers
// Each function reads the object `value`, which is at the reader's path.
void cau_read_scene(cau_reader *reader, const cJSON *value, cau_scene_def *scene);
void cau_read_command(cau_reader *reader, const cJSON *value, cau_command *command);
void cau_read_selection(cau_reader *reader, const cJSON *value, cau_selection *selection);

// Each function writes an object. See cau_json_open for `key`.
void cau_write_scene(cau_json_writer *writer, const char *key, const cau_scene_def *scene);
void cau_write_selection(cau_json_writer *writer, const char *key, const cau_selection *selection);
void cau_write_command(cau_json_writer *writer, const char *key, const cau_command *command);
