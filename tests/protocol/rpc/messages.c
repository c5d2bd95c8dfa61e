// SPDX-License-Identifier: GPL-3.0-or-later
#include "protocol/rpc/messages.h"

#include <stdlib.h>
#include <string.h>

enum { LIST_ITEMS = 2 };

static void fill_list(const cau_wire_field *field, cau_wire_list *list, fill how,
                      cau_scene_def *scene)
{
	size_t bytes = cau_wire_shapes[field->object].bytes;
	*list = (cau_wire_list){calloc(LIST_ITEMS, bytes), LIST_ITEMS, LIST_ITEMS};
	for (int i = 0; i < LIST_ITEMS; i++)
		fill_message(field->object, (char *)list->items + (size_t)i * bytes, how, scene);
}

static void fill_numbers(const cau_wire_field *field, cau_wire_list *list, double number)
{
	*list = (cau_wire_list){calloc(LIST_ITEMS, 8), LIST_ITEMS, LIST_ITEMS};
	for (int i = 0; i < LIST_ITEMS; i++)
		if (field->type == CAU_WIRE_TYPE_INTEGERS)
			((int64_t *)list->items)[i] = (int64_t)number;
		else
			((double *)list->items)[i] = number;
}

static void fill_text(char *to, int32_t bytes_max, fill how)
{
	if (how == FILL_MOST) // letters of two bytes, and characters that must be escaped
		for (int32_t i = 0; i + 2 < bytes_max; i += 3)
			memcpy(to + i, i % 2 ? "\xc3\xa4\"" : "\xc3\xb6\n", 3);
}

static void fill_field(const cau_wire_field *field, void *at, fill how, cau_scene_def *scene)
{
	double number = how == FILL_MOST ? field->most : field->least;
	switch (field->type) {
	case CAU_WIRE_TYPE_FLAG:
		*(bool *)at = how == FILL_MOST;
		break;
	case CAU_WIRE_TYPE_INTEGER:
		*(int64_t *)at = (int64_t)number;
		break;
	case CAU_WIRE_TYPE_NUMBER:
		*(double *)at = number;
		break;
	case CAU_WIRE_TYPE_VECTOR:
		for (int32_t i = 0; i < field->count; i++)
			((double *)at)[i] = number;
		break;
	case CAU_WIRE_TYPE_TEXT:
		fill_text(at, field->count, how);
		break;
	case CAU_WIRE_TYPE_NAME:
		strcpy(at, how == FILL_MOST ? "a23456789012345678901234567890123456789012345678" : "a");
		break;
	case CAU_WIRE_TYPE_HEX64:
		*(uint64_t *)at = how == FILL_MOST ? UINT64_MAX : 0;
		break;
	case CAU_WIRE_TYPE_CHOICE:
		*(int32_t *)at = how == FILL_MOST ? field->choices->count - 1 : 0;
		break;
	case CAU_WIRE_TYPE_CHOICES:
		*(uint32_t *)at = how == FILL_MOST ? (1u << field->choices->count) - 1 : 0;
		break;
	case CAU_WIRE_TYPE_PART:
		fill_message(field->object, at, how, scene);
		break;
	case CAU_WIRE_TYPE_LIST:
		fill_list(field, at, how, scene);
		break;
	case CAU_WIRE_TYPE_NUMBERS:
	case CAU_WIRE_TYPE_INTEGERS:
		fill_numbers(field, at, number);
		break;
	case CAU_WIRE_TYPE_SCENE:
		*(cau_scene_def **)at = scene;
		break;
	}
}

void fill_message(cau_wire_object object, void *to, fill how, cau_scene_def *scene)
{
	const cau_wire_shape *shape = &cau_wire_shapes[object];
	for (int32_t i = 0; i < shape->field_count; i++) {
		const cau_wire_field *field = &shape->fields[i];
		if (!field->required && how == FILL_LEAST)
			continue;
		if (!field->required)
			*(bool *)((char *)to + field->has_offset) = true;
		fill_field(field, (char *)to + field->offset, how, scene);
	}
}

static void *item_of(const cau_wire_field *field, void *list, int k)
{
	return (char *)((cau_wire_list *)list)->items +
	       (size_t)k * cau_wire_shapes[field->object].bytes;
}

static bool is_numbers(const cau_wire_field *field)
{
	return field->type == CAU_WIRE_TYPE_NUMBERS || field->type == CAU_WIRE_TYPE_INTEGERS;
}

void prepare_message(cau_wire_object object, void *to, cau_scene_def *scene)
{
	const cau_wire_shape *shape = &cau_wire_shapes[object];
	for (int32_t i = 0; i < shape->field_count; i++) {
		const cau_wire_field *field = &shape->fields[i];
		void *at = (char *)to + field->offset;
		if (field->type == CAU_WIRE_TYPE_PART)
			prepare_message(field->object, at, scene);
		if (field->type == CAU_WIRE_TYPE_SCENE)
			*(cau_scene_def **)at = scene;
		if (field->type == CAU_WIRE_TYPE_LIST)
			*(cau_wire_list *)at = (cau_wire_list){
				calloc(LIST_ITEMS, cau_wire_shapes[field->object].bytes), 0, LIST_ITEMS};
		for (int k = 0; field->type == CAU_WIRE_TYPE_LIST && k < LIST_ITEMS; k++)
			prepare_message(field->object, item_of(field, at, k), scene);
		if (is_numbers(field))
			*(cau_wire_list *)at = (cau_wire_list){calloc(LIST_ITEMS, 8), 0, LIST_ITEMS};
	}
}

void release_message(cau_wire_object object, void *of)
{
	const cau_wire_shape *shape = &cau_wire_shapes[object];
	for (int32_t i = 0; i < shape->field_count; i++) {
		const cau_wire_field *field = &shape->fields[i];
		void *at = (char *)of + field->offset;
		if (field->type == CAU_WIRE_TYPE_PART)
			release_message(field->object, at);
		for (int k = 0; field->type == CAU_WIRE_TYPE_LIST && k < LIST_ITEMS; k++)
			if (((cau_wire_list *)at)->items)
				release_message(field->object, item_of(field, at, k));
		if (field->type == CAU_WIRE_TYPE_LIST || is_numbers(field))
			free(((cau_wire_list *)at)->items);
	}
}

static bool same_list(const cau_wire_field *field, const cau_wire_list *a, const cau_wire_list *b)
{
	size_t bytes = cau_wire_shapes[field->object].bytes;
	bool same = a->count == b->count;
	for (int32_t i = 0; i < a->count && same; i++)
		same = same_message(field->object, (char *)a->items + (size_t)i * bytes,
		                    (char *)b->items + (size_t)i * bytes);
	return same;
}

static bool same_field(const cau_wire_field *field, const void *a, const void *b)
{
	switch (field->type) {
	case CAU_WIRE_TYPE_FLAG:
		return *(const bool *)a == *(const bool *)b;
	case CAU_WIRE_TYPE_INTEGER:
	case CAU_WIRE_TYPE_HEX64:
	case CAU_WIRE_TYPE_NUMBER:
		return memcmp(a, b, 8) == 0;
	case CAU_WIRE_TYPE_VECTOR:
		return memcmp(a, b, 8 * (size_t)field->count) == 0;
	case CAU_WIRE_TYPE_TEXT:
	case CAU_WIRE_TYPE_NAME:
		return strcmp(a, b) == 0;
	case CAU_WIRE_TYPE_CHOICE:
	case CAU_WIRE_TYPE_CHOICES:
		return memcmp(a, b, 4) == 0;
	case CAU_WIRE_TYPE_PART:
		return same_message(field->object, a, b);
	case CAU_WIRE_TYPE_LIST:
		return same_list(field, a, b);
	case CAU_WIRE_TYPE_NUMBERS:
	case CAU_WIRE_TYPE_INTEGERS: {
		const cau_wire_list *one = a, *other = b;
		return one->count == other->count &&
		       memcmp(one->items, other->items, 8 * (size_t)one->count) == 0;
	}
	case CAU_WIRE_TYPE_SCENE:
		return true;
	}
	return false;
}

bool same_message(cau_wire_object object, const void *a, const void *b)
{
	const cau_wire_shape *shape = &cau_wire_shapes[object];
	for (int32_t i = 0; i < shape->field_count; i++) {
		const cau_wire_field *field = &shape->fields[i];
		if (!field->required) {
			bool has = *(const bool *)((const char *)a + field->has_offset);
			if (has != *(const bool *)((const char *)b + field->has_offset))
				return false;
			if (!has)
				continue;
		}
		if (!same_field(field, (const char *)a + field->offset, (const char *)b + field->offset))
			return false;
	}
	return true;
}
