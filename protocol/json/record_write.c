// SPDX-License-Identifier: Apache-2.0
#include <string.h>

#include "cautery/assert.h"
#include "json/record.h"

static void write_choice(cau_json_writer *writer, const cau_field *field, int choice)
{
	CAU_ASSERT(field->choices && field->choices->count > 0, "\"%s\" has no choices", field->name);
	if (choice < 0 || choice >= field->choices->count)
		cau_json_fail(writer, CAU_BAD_VALUE, "the value is not one of the choices");
	else
		cau_json_string(writer, field->name, field->choices->names[choice]);
}

static void write_text(cau_json_writer *writer, const char *key, const char *text, size_t bytes)
{
	if (memchr(text, 0, bytes))
		cau_json_string(writer, key, text);
	else
		cau_json_fail(writer, CAU_BAD_VALUE, "the text does not end with a zero byte");
}

static void write_integers(cau_json_writer *writer, const cau_field *field, const int32_t *value)
{
	CAU_ASSERT(field->count >= 0, "\"%s\" has %d elements", field->name, field->count);
	if (field->count == 0) {
		cau_json_integer(writer, field->name, *value);
		return;
	}
	cau_json_open(writer, field->name, '(');
	for (int32_t i = 0; i < field->count; i++)
		cau_json_integer(writer, NULL, value[i]);
	cau_json_close(writer);
}

// Writes a name. An empty optional name is left out, because readers refuse an empty name.
static void write_name(cau_json_writer *writer, const cau_field *field, const char *name)
{
	if (field->required || name[0])
		write_text(writer, field->name, name, CAU_NAME_BYTES);
}

static void write_field(cau_json_writer *writer, const cau_field *field, const void *base)
{
	const void *at = (const char *)base + field->offset;
	switch (field->type) {
	case CAU_FIELD_NUMBER:
		if (field->count)
			cau_json_numbers(writer, field->name, at, field->count);
		else
			cau_json_number(writer, field->name, *(const double *)at);
		break;
	case CAU_FIELD_INTEGER:
		write_integers(writer, field, at);
		break;
	case CAU_FIELD_COUNT:
		cau_json_unsigned(writer, field->name, *(const uint64_t *)at);
		break;
	case CAU_FIELD_CHOICE:
		write_choice(writer, field, *(const int *)at);
		break;
	case CAU_FIELD_FLAG:
		cau_json_bool(writer, field->name, *(const int32_t *)at != 0);
		break;
	case CAU_FIELD_NAME:
		write_name(writer, field, at);
		break;
	case CAU_FIELD_TEXT:
		write_text(writer, field->name, at, CAU_TEXT_BYTES);
		break;
	case CAU_FIELD_ROTATION:
		cau_json_numbers(writer, field->name, at, 4);
		break;
	}
}

void cau_write_parts(cau_json_writer *writer, const cau_part *parts, int part_count)
{
	CAU_ASSERT(part_count > 0 && part_count <= CAU_MAX_PARTS, "%d parts", part_count);
	for (int p = 0; p < part_count; p++)
		for (int i = 0; i < parts[p].record->field_count; i++)
			if (cau_field_applies(&parts[p].record->fields[i], parts[p].kind))
				write_field(writer, &parts[p].record->fields[i], parts[p].base);
}
