// SPDX-License-Identifier: GPL-3.0-or-later
// Prints a table of all members of a scene, from the tables that read scenes. It also checks or
// updates the copy in the scenes' README:
//
//     parameter_table             prints the table
//     parameter_table --check F   fails unless file F has the table between its two marks
//     parameter_table --write F   writes the table between the marks of file F
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "cautery/defaults.h"
#include "json/document.h"

static const char begin_mark[] = "<!-- parameters: begin (written by parameter_table) -->\n";
static const char end_mark[] = "<!-- parameters: end -->\n";

enum { FILE_BYTES = 1 << 18, TABLE_BYTES = 1 << 17 };

static const char *const type_names[] = {
	[CAU_FIELD_NUMBER] = "number",      [CAU_FIELD_INTEGER] = "integer",
	[CAU_FIELD_COUNT] = "integer",      [CAU_FIELD_CHOICE] = "choice",
	[CAU_FIELD_FLAG] = "true or false", [CAU_FIELD_NAME] = "name",
	[CAU_FIELD_TEXT] = "text",          [CAU_FIELD_ROTATION] = "4 numbers",
};

static void print_numbers(FILE *out, const double *value, int count)
{
	fputs(count > 1 ? "[" : "", out);
	for (int i = 0; i < count; i++)
		fprintf(out, "%s%.6g", i ? ", " : "", value[i]);
	fputs(count > 1 ? "]" : "", out);
}

static void print_default(FILE *out, const cau_field *field, const void *base)
{
	const void *at = (const char *)base + field->offset;
	int count = field->count ? field->count : 1;
	if (field->required && field->unless)
		fprintf(out, "required without `%s`", field->unless);
	else if (field->required)
		fputs("required", out);
	else if (field->type == CAU_FIELD_NUMBER)
		print_numbers(out, at, count);
	else if (field->type == CAU_FIELD_ROTATION)
		print_numbers(out, at, 4);
	else if (field->type == CAU_FIELD_CHOICE)
		fputs(field->choices->names[*(const int *)at], out);
	else if (field->type == CAU_FIELD_COUNT)
		fputs("0", out);
	else if (field->type == CAU_FIELD_INTEGER)
		for (int i = 0; i < count; i++)
			fprintf(out, "%s%d%s",
			        i           ? ", "
			        : count > 1 ? "["
			                    : "",
			        ((const int32_t *)at)[i], i == count - 1 && count > 1 ? "]" : "");
	else
		fputs("empty", out);
}

static void print_names(FILE *out, const cau_choices *choices, unsigned bits)
{
	const char *comma = "";
	for (int i = 0; i < choices->count; i++)
		if (bits >> i & 1u) {
			fprintf(out, "%s`%s`", comma, choices->names[i]);
			comma = ", ";
		}
}

static void print_range(FILE *out, const cau_field *field)
{
	bool bare = !*field->unit || strcmp(field->unit, "1") == 0;
	if (field->type == CAU_FIELD_CHOICE)
		print_names(out, field->choices, ~0u);
	else if (field->type == CAU_FIELD_NUMBER || field->type == CAU_FIELD_INTEGER)
		fprintf(out, "%.6g to %.6g%s%s", field->least, field->most, bare ? "" : " ",
		        bare ? "" : field->unit);
	else if (field->type == CAU_FIELD_COUNT)
		fputs("below 2^53", out);
}

static void print_row(FILE *out, const cau_field *field, const cau_record *record, const void *base)
{
	fprintf(out, "| `%s` | ", field->name);
	if (field->count && field->least_count)
		fprintf(out, "%d to %d %ss", field->least_count, field->count, type_names[field->type]);
	else if (field->count)
		fprintf(out, "%d %ss", field->count, type_names[field->type]);
	else
		fputs(type_names[field->type], out);
	fputs(" | ", out);
	print_default(out, field, base);
	fputs(" | ", out);
	print_range(out, field);
	fputs(" | ", out);
	for (const char *c = field->meaning; *c; c++)
		fprintf(out, "%s%c", *c == '|' ? "\\" : "", *c);
	if (field->kinds && record->kinds) {
		fputs(" (", out);
		print_names(out, record->kinds, field->kinds);
		fputs(")", out);
	}
	fputs(" |\n", out);
}

static void print_rows(FILE *out, const cau_record *record, const void *base)
{
	for (int i = 0; i < record->field_count; i++)
		print_row(out, &record->fields[i], record, base);
}

static void print_title(FILE *out, const char *title, const char *text)
{
	fprintf(out,
	        "\n### %s\n\n%s\n\n| member | type | default | range | meaning |\n"
	        "|---|---|---|---|---|\n",
	        title, text);
}

static void print_layers(FILE *out)
{
	static cau_layer_def layer;
	static const char *const titles[] = {"A sheet's material", "A membrane's material",
	                                     "Fat's material", "The links' material"};
	static const char *const texts[] = {
		"Members of a layer of kind `fascia`.",
		"Members of a layer of kind `membrane`. Only the default of `ignition_c` differs.",
		"Members of a layer of kind `fat`. Axes: the first along `fibre`.",
		"Members of a layer of kind `links`, which has no `regions`.",
	};
	cau_default_layer_def(&layer, CAU_LAYER_FASCIA);
	print_title(
		out, "A layer",
		"Elements of `layers`. Each also has the members of the material of its kind. The array "
		"`regions` holds other materials for regions of the mesh file: each element has the "
		"member `region`, and the members of the material that differ.");
	print_rows(out, &cau_layer_record, &layer);
	for (int kind = 0; kind < CAU_LAYER_COUNT; kind++) {
		cau_part parts[2];
		cau_default_layer_def(&layer, kind);
		int count = cau_material_parts(kind, layer.sheet, layer.fat, &layer.link, parts);
		print_title(out, titles[kind], texts[kind]);
		for (int p = kind == CAU_LAYER_MEMBRANE ? 1 : 0; p < count; p++)
			print_rows(out, parts[p].record, parts[p].base);
	}
}

static void print_table(FILE *out)
{
	static cau_scene_def scene;
	static cau_mesh_def mesh;
	cau_selection selection;
	cau_tool_def tool;
	cau_default_scene_def(&scene);
	cau_default_mesh_def(&mesh);
	cau_default_selection(&selection, CAU_SELECT_RIM);
	cau_default_tool_def(&tool, CAU_TOOL_HOOK);
	print_title(
		out, "The scene",
		"Members of a scene. Further members are the arrays `meshes`, `layers`, `pins`, `tools` "
		"and `vessels`, and the objects `pull` and `cut`.");
	print_rows(out, &cau_scene_record, &scene);
	print_title(out, "A mesh", "Elements of `meshes`.");
	print_rows(out, &cau_mesh_record, &mesh);
	print_layers(out);
	print_title(out, "A selection",
	            "Elements of `pins`, and the `selection` of a pull: a choice of vertices.");
	print_rows(out, &cau_selection_record, &selection);
	print_title(out, "A tool",
	            "Elements of `tools`. In the frame of a tool, the tip is at the origin and the "
	            "shaft points along +z.");
	cau_choice_names none = {0};
	print_rows(out, &cau_tool_name_record, &tool);
	print_rows(out, &cau_instrument_record, &none);
	print_rows(out, &cau_tool_record, &tool);
	print_rows(out, &cau_pose_record, &tool.pose);
	cau_vessel_def vessel;
	cau_default_vessel_def(&vessel);
	print_title(
		out, "A vessel",
		"Elements of `vessels`: blood vessels in a layer of fat, with energy `tissue` "
		"([core/vessel](../../core/vessel/README.md)). `points`, an array of 2 to 32, holds the "
		"points of the middle line.");
	print_rows(out, &cau_vessel_record, &vessel);
	print_title(out, "A point of a vessel", "Elements of a vessel's `points`.");
	print_rows(out, &cau_vessel_point_record, vessel.points_m[0]);
	print_title(out, "The pull", "`pull`, with its `selection`: a motion for measurements.");
	print_rows(out, &cau_pull_record, &scene.pull);
	print_title(out, "The cut",
	            "`cut`: the tool waits at its first position, then moves along a line.");
	print_rows(out, &cau_cut_record, &scene.cut);
	fputc('\n', out);
}

// Reads file `path` and finds the text between the marks.
static bool read_marked(const char *path, char *text, char **begin, char **end)
{
	FILE *file = fopen(path, "rb");
	if (!file)
		return false;
	size_t bytes = fread(text, 1, FILE_BYTES - 1, file);
	fclose(file);
	text[bytes] = 0;
	*begin = strstr(text, begin_mark);
	*end = strstr(text, end_mark);
	if (!*begin || !*end)
		return false;
	*begin += strlen(begin_mark);
	return *begin <= *end;
}

static bool write_marked(const char *path, const char *text, const char *begin, const char *end,
                         const char *table)
{
	FILE *file = fopen(path, "wb");
	if (!file)
		return false;
	fwrite(text, 1, (size_t)(begin - text), file);
	fputs(table, file);
	fputs(end, file);
	return fclose(file) == 0;
}

int main(int argument_count, char **arguments)
{
	static char text[FILE_BYTES], table[TABLE_BYTES];
	char *begin, *end;
	FILE *memory = fmemopen(table, sizeof table, "w");
	if (!memory)
		return 1;
	print_table(memory);
	fclose(memory);
	if (argument_count < 3) {
		fputs(table, stdout);
		return 0;
	}
	if (!read_marked(arguments[2], text, &begin, &end)) {
		fprintf(stderr, "%s: cannot be read, or lacks the marks\n", arguments[2]);
		return 1;
	}
	if (strcmp(arguments[1], "--write") == 0)
		return write_marked(arguments[2], text, begin, end, table) ? 0 : 1;
	if ((size_t)(end - begin) == strlen(table) && memcmp(begin, table, strlen(table)) == 0)
		return 0;
	fprintf(stderr, "%s: the table has drifted; run this program with --write\n", arguments[2]);
	return 1;
}
