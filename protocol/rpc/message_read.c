// SPDX-License-Identifier: Apache-2.0
#include <string.h>

#include "cautery/assert.h"
#include "rpc/message.h"
#include "json/document.h"

static void read_vector(cau_reader *reader, const cJSON *value, const cau_wire_field *field,
                        double *to)
{
	CAU_ASSERT(field->count > 0, "\"%s\" has %d numbers", field->name, field->count);
	if (!cau_read_array(reader, value, field->count, field->count) || !value)
		return;
	const cJSON *element = value->child;
	for (int32_t i = 0; i < field->count; i++, element = element->next) {
		size_t mark = cau_reader_enter(reader, NULL, i);
		to[i] = cau_read_number(reader, element, field->least, field->most, field->unit);
		cau_reader_leave(reader, mark);
	}
}

static int hex_digit(char digit)
{
	if (digit >= '0' && digit <= '9')
		return digit - '0';
	return digit >= 'a' && digit <= 'f' ? digit - 'a' + 10 : -1;
}

static uint64_t read_hex64(cau_reader *reader, const cJSON *value)
{
	char text[17];
	uint64_t result = 0;
	cau_read_text(reader, value, text, sizeof text);
	bool good = strlen(text) == 16;
	for (int i = 0; i < 16 && good; i++) {
		int digit = hex_digit(text[i]);
		good = digit >= 0;
		result = result << 4 | (unsigned)digit;
	}
	if (!good)
		cau_reader_fail(reader, CAU_BAD_VALUE, NULL, "must be 16 lower-case hex digits");
	return result;
}

static uint32_t read_choices(cau_reader *reader, const cJSON *value, const cau_choices *choices)
{
	CAU_ASSERT(choices->count <= 32, "a set of %d words", choices->count);
	uint32_t set = 0;
	if (!cau_read_array(reader, value, 0, choices->count) || !value)
		return 0;
	int32_t index = 0;
	for (const cJSON *element = value->child; element; element = element->next) {
		size_t mark = cau_reader_enter(reader, NULL, index++);
		int choice = cau_read_choice(reader, element, choices->names, choices->count);
		if (choice >= 0 && set & 1u << choice)
			cau_reader_fail(reader, CAU_BAD_VALUE, NULL, "\"%s\" is in the list twice",
			                choices->names[choice]);
		set |= choice >= 0 ? 1u << choice : 0;
		cau_reader_leave(reader, mark);
	}
	return set;
}

static bool is_list(const cau_wire_field *field)
{
	return field->type == CAU_WIRE_TYPE_LIST || field->type == CAU_WIRE_TYPE_NUMBERS ||
	       field->type == CAU_WIRE_TYPE_INTEGERS;
}

// Zeroes an item, except the `items` and `capacity` of its own lists, which the caller provides.
static void clear_item(cau_wire_object object, char *item)
{
	const cau_wire_shape *shape = &cau_wire_shapes[object];
	cau_wire_list kept[CAU_WIRE_FIELDS_MAX];
	for (int32_t i = 0; i < shape->field_count; i++)
		if (is_list(&shape->fields[i]))
			memcpy(&kept[i], item + shape->fields[i].offset, sizeof *kept);
	memset(item, 0, shape->bytes);
	for (int32_t i = 0; i < shape->field_count; i++)
		if (is_list(&shape->fields[i]))
			memcpy(item + shape->fields[i].offset, &kept[i], sizeof *kept);
}

// Enters the list's next item. Fails if the list is full.
static bool enter_item(cau_reader *reader, const cau_wire_list *list, size_t *mark)
{
	if (list->count >= list->capacity) {
		cau_reader_fail(reader, CAU_LIMIT, NULL, "more than the capacity of %d", list->capacity);
		return false;
	}
	*mark = cau_reader_enter(reader, NULL, list->count);
	return true;
}

static void read_list(cau_reader *reader, const cJSON *value, const cau_wire_field *field,
                      cau_wire_list *list, bool strict)
{
	CAU_ASSERT_INDEX(field->object, CAU_WIRE_OBJECT_COUNT);
	CAU_ASSERT(list->items || !list->capacity, "capacity for %d objects at no address",
	           list->capacity);
	list->count = 0;
	if (!cau_read_array(reader, value, 0, field->count) || !value)
		return;
	size_t bytes = cau_wire_shapes[field->object].bytes;
	for (const cJSON *element = value->child; element; element = element->next) {
		size_t mark;
		if (!enter_item(reader, list, &mark))
			return;
		void *item = (char *)list->items + (size_t)list->count++ * bytes;
		clear_item(field->object, item);
		cau_read_message(reader, element, field->object, item, strict);
		cau_reader_leave(reader, mark);
	}
}

// Reads an array of doubles or integers.
static void read_numbers(cau_reader *reader, const cJSON *value, const cau_wire_field *field,
                         cau_wire_list *list)
{
	CAU_ASSERT(list->items || !list->capacity, "capacity for %d numbers at no address",
	           list->capacity);
	list->count = 0;
	if (!cau_read_array(reader, value, 0, field->count) || !value)
		return;
	for (const cJSON *element = value->child; element; element = element->next) {
		size_t mark;
		if (!enter_item(reader, list, &mark))
			return;
		if (field->type == CAU_WIRE_TYPE_INTEGERS)
			((int64_t *)list->items)[list->count] =
				cau_read_integer(reader, element, (int64_t)field->least, (int64_t)field->most);
		else
			((double *)list->items)[list->count] =
				cau_read_number(reader, element, field->least, field->most, field->unit);
		list->count++;
		cau_reader_leave(reader, mark);
	}
}

static void read_scene(cau_reader *reader, const cJSON *value, cau_scene_def *scene)
{
	if (scene)
		cau_read_scene(reader, value, scene);
	else
		cau_read_object(reader, value);
}

static void read_field(cau_reader *reader, const cJSON *value, const cau_wire_field *field,
                       void *at, bool strict)
{
	switch (field->type) {
	case CAU_WIRE_TYPE_FLAG:
		*(bool *)at = cau_read_bool(reader, value);
		break;
	case CAU_WIRE_TYPE_INTEGER:
		*(int64_t *)at =
			cau_read_integer(reader, value, (int64_t)field->least, (int64_t)field->most);
		break;
	case CAU_WIRE_TYPE_NUMBER:
		*(double *)at = cau_read_number(reader, value, field->least, field->most, field->unit);
		break;
	case CAU_WIRE_TYPE_VECTOR:
		read_vector(reader, value, field, at);
		break;
	case CAU_WIRE_TYPE_TEXT:
		cau_read_text(reader, value, at, (size_t)field->count + 1);
		break;
	case CAU_WIRE_TYPE_NAME:
		cau_read_name(reader, value, at);
		break;
	case CAU_WIRE_TYPE_HEX64:
		*(uint64_t *)at = read_hex64(reader, value);
		break;
	case CAU_WIRE_TYPE_CHOICE:
		*(int32_t *)at =
			cau_read_choice(reader, value, field->choices->names, field->choices->count);
		break;
	case CAU_WIRE_TYPE_CHOICES:
		*(uint32_t *)at = read_choices(reader, value, field->choices);
		break;
	case CAU_WIRE_TYPE_PART:
		cau_read_message(reader, value, field->object, at, strict);
		break;
	case CAU_WIRE_TYPE_LIST:
		read_list(reader, value, field, at, strict);
		break;
	case CAU_WIRE_TYPE_NUMBERS:
	case CAU_WIRE_TYPE_INTEGERS:
		read_numbers(reader, value, field, at);
		break;
	case CAU_WIRE_TYPE_SCENE:
		read_scene(reader, value, *(cau_scene_def **)at);
		break;
	}
}

void cau_refuse_unknown(cau_reader *reader, const cJSON *value, cau_wire_object object)
{
	CAU_ASSERT_INDEX(object, CAU_WIRE_OBJECT_COUNT);
	const cau_wire_shape *shape = &cau_wire_shapes[object];
	CAU_ASSERT(shape->field_count <= CAU_WIRE_FIELDS_MAX, "%s has %d members", shape->name,
	           shape->field_count);
	const char *names[CAU_WIRE_FIELDS_MAX];
	for (int32_t i = 0; i < shape->field_count; i++)
		names[i] = shape->fields[i].name;
	cau_read_no_others(reader, value, names, shape->field_count);
}

void cau_read_message(cau_reader *reader, const cJSON *value, cau_wire_object object, void *to,
                      bool strict)
{
	CAU_ASSERT_INDEX(object, CAU_WIRE_OBJECT_COUNT);
	const cau_wire_shape *shape = &cau_wire_shapes[object];
	if (!cau_read_object(reader, value))
		return;
	if (strict)
		cau_refuse_unknown(reader, value, object);
	for (int32_t i = 0; i < shape->field_count; i++) {
		const cau_wire_field *field = &shape->fields[i];
		const cJSON *member = cau_value_member(value, field->name);
		if (!field->required)
			*(bool *)((char *)to + field->has_offset) = member != NULL;
		if (!member && !field->required)
			continue;
		size_t mark = cau_reader_enter(reader, field->name, 0);
		read_field(reader, member, field, (char *)to + field->offset, strict);
		cau_reader_leave(reader, mark);
	}
}
