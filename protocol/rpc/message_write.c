// SPDX-License-Identifier: Apache-2.0
#include <inttypes.h>
#include <locale.h>
#include <stdio.h>
#include <string.h>

#include "cautery/assert.h"
#include "cautery/name.h"
#include "rpc/message.h"
#include "json/document.h"

static void check_number(cau_reader *place, const cau_wire_field *field, double value)
{
	CAU_ASSERT(field->least <= field->most, "\"%s\" from %g to %g", field->name, field->least,
	           field->most);
	if (!(value >= field->least && value <= field->most))
		cau_reader_fail(place, CAU_BAD_VALUE, NULL, "%g is outside %g to %g", value, field->least,
		                field->most);
}

static void write_vector(cau_json_writer *writer, const cau_wire_field *field, const double *value,
                         cau_reader *place)
{
	CAU_ASSERT(field->count > 0, "\"%s\" has %d numbers", field->name, field->count);
	for (int32_t i = 0; i < field->count; i++)
		check_number(place, field, value[i]);
	cau_json_numbers(writer, field->name, value, field->count);
}

static void write_text(cau_json_writer *writer, const cau_wire_field *field, const char *text,
                       cau_reader *place)
{
	bool name = field->type == CAU_WIRE_TYPE_NAME;
	if (!memchr(text, 0, name ? CAU_NAME_BYTES : (size_t)field->count + 1))
		cau_reader_fail(place, CAU_BAD_VALUE, NULL, "the text does not end with a zero byte");
	else if (name && !cau_name_is_valid(text))
		cau_reader_fail(place, CAU_BAD_VALUE, NULL, "\"%s\" is not a name", text);
	else
		cau_json_string(writer, field->name, text);
}

static void write_choice(cau_json_writer *writer, const char *key, const cau_choices *choices,
                         int32_t choice, cau_reader *place)
{
	if (choice < 0 || choice >= choices->count)
		cau_reader_fail(place, CAU_BAD_VALUE, NULL, "no word has the number %d", choice);
	else
		cau_json_string(writer, key, choices->names[choice]);
}

static void write_choices(cau_json_writer *writer, const cau_wire_field *field, uint32_t set,
                          cau_reader *place)
{
	CAU_ASSERT(field->choices->count <= 32, "a set of %d words", field->choices->count);
	if (field->choices->count < 32 && set >> field->choices->count)
		cau_reader_fail(place, CAU_BAD_VALUE, NULL, "a bit of the set has no word");
	cau_json_open(writer, field->name, '(');
	for (int i = 0; i < field->choices->count; i++)
		if (set & 1u << i)
			cau_json_string(writer, NULL, field->choices->names[i]);
	cau_json_close(writer);
}

static void write_list(cau_json_writer *writer, const cau_wire_field *field,
                       const cau_wire_list *list, cau_reader *place)
{
	CAU_ASSERT_INDEX(field->object, CAU_WIRE_OBJECT_COUNT);
	if (list->count < 0 || list->count > field->count)
		cau_reader_fail(place, CAU_BAD_VALUE, NULL, "%d objects, at most %d are allowed",
		                list->count, field->count);
	cau_json_open(writer, field->name, '[');
	for (int32_t i = 0; i < list->count && !place->status; i++) {
		size_t mark = cau_reader_enter(place, NULL, i);
		const char *item =
			(const char *)list->items + (size_t)i * cau_wire_shapes[field->object].bytes;
		cau_write_message(writer, NULL, field->object, item, place);
		cau_reader_leave(place, mark);
	}
	cau_json_close(writer);
}

// Writes a number with 17 digits, which is enough for every double. It is for long arrays: finding
// fewer digits would take three times as long.
static void write_exact(cau_json_writer *writer, double value)
{
	char text[40];
	int bytes = snprintf(text, sizeof text, "%.17g", value);
	char *point = strchr(text, localeconv()->decimal_point[0]);
	if (point)
		*point = '.';
	cau_json_raw(writer, NULL, text, (size_t)bytes);
}

static void write_numbers(cau_json_writer *writer, const cau_wire_field *field,
                          const cau_wire_list *list, cau_reader *place)
{
	bool whole = field->type == CAU_WIRE_TYPE_INTEGERS;
	if (list->count < 0 || list->count > field->count)
		cau_reader_fail(place, CAU_BAD_VALUE, NULL, "%d numbers, at most %d are allowed",
		                list->count, field->count);
	cau_json_open(writer, field->name, '(');
	for (int32_t i = 0; i < list->count && !place->status; i++) {
		double value = whole ? (double)((int64_t *)list->items)[i] : ((double *)list->items)[i];
		check_number(place, field, value);
		if (whole)
			cau_json_integer(writer, NULL, ((int64_t *)list->items)[i]);
		else if (!place->status)
			write_exact(writer, value);
	}
	cau_json_close(writer);
}

static void write_scene(cau_json_writer *writer, const cau_wire_field *field,
                        const cau_scene_def *scene, cau_reader *place)
{
	if (scene)
		cau_write_scene(writer, field->name, scene);
	else
		cau_reader_fail(place, CAU_BAD_VALUE, NULL, "the scene is missing");
}

static void write_field(cau_json_writer *writer, const cau_wire_field *field, const void *at,
                        cau_reader *place)
{
	char hex[17];
	switch (field->type) {
	case CAU_WIRE_TYPE_FLAG:
		cau_json_bool(writer, field->name, *(const bool *)at);
		break;
	case CAU_WIRE_TYPE_INTEGER:
		check_number(place, field, (double)*(const int64_t *)at);
		cau_json_integer(writer, field->name, *(const int64_t *)at);
		break;
	case CAU_WIRE_TYPE_NUMBER:
		check_number(place, field, *(const double *)at);
		cau_json_number(writer, field->name, *(const double *)at);
		break;
	case CAU_WIRE_TYPE_VECTOR:
		write_vector(writer, field, at, place);
		break;
	case CAU_WIRE_TYPE_TEXT:
	case CAU_WIRE_TYPE_NAME:
		write_text(writer, field, at, place);
		break;
	case CAU_WIRE_TYPE_HEX64:
		snprintf(hex, sizeof hex, "%016" PRIx64, *(const uint64_t *)at);
		cau_json_string(writer, field->name, hex);
		break;
	case CAU_WIRE_TYPE_CHOICE:
		write_choice(writer, field->name, field->choices, *(const int32_t *)at, place);
		break;
	case CAU_WIRE_TYPE_CHOICES:
		write_choices(writer, field, *(const uint32_t *)at, place);
		break;
	case CAU_WIRE_TYPE_PART:
		cau_write_message(writer, field->name, field->object, at, place);
		break;
	case CAU_WIRE_TYPE_LIST:
		write_list(writer, field, at, place);
		break;
	case CAU_WIRE_TYPE_NUMBERS:
	case CAU_WIRE_TYPE_INTEGERS:
		write_numbers(writer, field, at, place);
		break;
	case CAU_WIRE_TYPE_SCENE:
		write_scene(writer, field, *(cau_scene_def *const *)at, place);
		break;
	}
}

void cau_write_message(cau_json_writer *writer, const char *key, cau_wire_object object,
                       const void *from, cau_reader *place)
{
	CAU_ASSERT_INDEX(object, CAU_WIRE_OBJECT_COUNT);
	const cau_wire_shape *shape = &cau_wire_shapes[object];
	cau_json_open(writer, key, '{');
	for (int32_t i = 0; i < shape->field_count; i++) {
		const cau_wire_field *field = &shape->fields[i];
		if (!field->required && !*(const bool *)((const char *)from + field->has_offset))
			continue;
		size_t mark = cau_reader_enter(place, field->name, 0);
		write_field(writer, field, (const char *)from + field->offset, place);
		cau_reader_leave(place, mark);
	}
	cau_json_close(writer);
}
