// SPDX-License-Identifier: Apache-2.0
// Reads and writes structs by their tables.
#include "json/record.h"

#include <string.h>

#include "cautery/assert.h"

// ---- reading
enum { MAX_KEYS = 96 };

bool cau_field_applies(const cau_field *field, int kind)
{
	CAU_ASSERT(kind < 32, "kind %d of \"%s\" has no bit", kind, field->name);
	return field->kinds == 0 || (kind >= 0 && (field->kinds >> kind & 1u));
}

static void read_element(cau_reader *reader, const cJSON *value, const cau_field *field,
                         int32_t index, void *at)
{
	CAU_ASSERT(field->type == CAU_FIELD_NUMBER || field->type == CAU_FIELD_INTEGER,
	           "an element of \"%s\", of type %d", field->name, (int)field->type);
	if (field->type == CAU_FIELD_NUMBER)
		((double *)at)[index] =
			cau_read_number(reader, value, field->least, field->most, field->unit);
	else
		((int32_t *)at)[index] =
			(int32_t)cau_read_integer(reader, value, (int64_t)field->least, (int64_t)field->most);
}

static void read_array(cau_reader *reader, const cJSON *value, const cau_field *field, void *at)
{
	CAU_ASSERT(field->count > 0, "\"%s\" has %d elements", field->name, field->count);
	if (!cau_read_array(reader, value, field->least_count ? field->least_count : field->count,
	                    field->count))
		return;
	CAU_ASSERT(value, "\"%s\" is an array, and nothing", field->name);
	int32_t index = 0;
	for (const cJSON *element = value->child; element; element = element->next, index++) {
		size_t mark = cau_reader_enter(reader, NULL, index);
		CAU_ASSERT_INDEX(index, field->count);
		read_element(reader, element, field, index, at);
		cau_reader_leave(reader, mark);
	}
}

static void read_value(cau_reader *reader, const cJSON *value, const cau_field *field, void *at)
{
	int choice;
	switch (field->type) {
	case CAU_FIELD_NUMBER:
	case CAU_FIELD_INTEGER:
		if (field->count)
			read_array(reader, value, field, at);
		else
			read_element(reader, value, field, 0, at);
		break;
	case CAU_FIELD_COUNT:
		*(uint64_t *)at = (uint64_t)cau_read_integer(reader, value, 0, (INT64_C(1) << 53) - 1);
		break;
	case CAU_FIELD_CHOICE:
		choice = cau_read_choice(reader, value, field->choices->names, field->choices->count);
		*(int *)at = choice < 0 ? 0 : choice;
		break;
	case CAU_FIELD_FLAG:
		*(int32_t *)at = cau_read_bool(reader, value);
		break;
	case CAU_FIELD_NAME:
		cau_read_name(reader, value, at);
		break;
	case CAU_FIELD_TEXT:
		cau_read_text(reader, value, at, CAU_TEXT_BYTES);
		break;
	case CAU_FIELD_ROTATION:
		cau_read_rotation(reader, value, at);
		break;
	}
}

void cau_read_field(cau_reader *reader, const cJSON *object, const cau_field *field, void *base)
{
	const cJSON *value = cau_value_member(object, field->name);
	bool needed = field->required && !(field->unless && cau_value_member(object, field->unless));
	if (reader->status || (!value && !needed))
		return;
	size_t mark = cau_reader_enter(reader, field->name, 0);
	read_value(reader, value, field, (char *)base + field->offset);
	cau_reader_leave(reader, mark);
}

// Reports a member that only other kinds of the record have, with a better message than "unknown".
static void refuse_other_kinds(cau_reader *reader, const cJSON *object, const cau_part *part)
{
	CAU_ASSERT_INDEX(part->kind, part->record->kinds->count);
	for (int i = 0; i < part->record->field_count; i++) {
		const cau_field *field = &part->record->fields[i];
		if (!cau_field_applies(field, part->kind) && cau_value_member(object, field->name))
			cau_reader_fail(reader, CAU_BAD_VALUE, field->name,
			                "%s of kind \"%s\" has no such member", part->record->title,
			                part->record->kinds->names[part->kind]);
	}
}

void cau_read_parts(cau_reader *reader, const cJSON *object, const cau_part *parts, int part_count,
                    const char *const *others, int other_count)
{
	CAU_ASSERT(part_count > 0 && part_count <= CAU_MAX_PARTS, "%d parts", part_count);
	const char *keys[MAX_KEYS] = {NULL};
	int key_count = 0;
	for (int p = 0; p < part_count; p++) {
		const cau_record *record = parts[p].record;
		for (int i = 0; i < record->field_count && key_count < MAX_KEYS; i++)
			if (cau_field_applies(&record->fields[i], parts[p].kind))
				keys[key_count++] = record->fields[i].name;
		if (record->kinds)
			refuse_other_kinds(reader, object, &parts[p]);
	}
	for (int i = 0; i < other_count && key_count < MAX_KEYS; i++)
		keys[key_count++] = others[i];
	CAU_ASSERT(key_count < MAX_KEYS, "%d names, at most %d", key_count, MAX_KEYS);
	cau_read_no_others(reader, object, keys, key_count);
	for (int p = 0; p < part_count; p++)
		for (int i = 0; i < parts[p].record->field_count; i++)
			if (cau_field_applies(&parts[p].record->fields[i], parts[p].kind))
				cau_read_field(reader, object, &parts[p].record->fields[i], parts[p].base);
}

// ---- writing
static void write_choice(cau_json_writer *writer, const cau_field *field, int choice)
{
	CAU_ASSERT(field->choices && field->choices->count > 0, "\"%s\" has no choices", field->name);
	if (choice < 0 || choice >= field->choices->count)
		cau_json_fail(writer, CAU_BAD_VALUE, "%s is %d, not one of the choices 0 to %d",
		              field->name, choice, field->choices->count - 1);
	else
		cau_json_string(writer, field->name, field->choices->names[choice]);
}

static void write_text(cau_json_writer *writer, const char *key, const char *text, size_t bytes)
{
	if (memchr(text, 0, bytes))
		cau_json_string(writer, key, text);
	else
		cau_json_fail(writer, CAU_BAD_VALUE, "the text of %s has no zero byte within %zu bytes",
		              key, bytes);
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
