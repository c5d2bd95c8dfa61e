// SPDX-License-Identifier: Apache-2.0
#include "rpc/message.h"

#include <string.h>

#include "cautery/assert.h"
#include "cautery/command.h"

// clang-format off: tables

// ---- words to choose from -----------------------------------------------------------------------
#define X(code, name) name,
#define CHOICE_TABLE(choice, table)                                                                \
	static const char *const choice##_names[] = {table(X)};                                        \
	static const cau_choices choice##_choices = {choice##_names,                                   \
	                                             (int)(sizeof choice##_names / sizeof(char *))};
CAU_CHOICE_LIST(CHOICE_TABLE)
#undef CHOICE_TABLE
#undef X

// ---- members ------------------------------------------------------------------------------------
#define HAS_R(o, field) 0
#define HAS_O(o, field) offsetof(cau_wire_##o, has_##field)
#define REQUIRED_R true
#define REQUIRED_O false
#define PLACE(o, field, need, TYPE, meaning_)                                                      \
	.name = #field, .type = CAU_WIRE_TYPE_##TYPE, .required = REQUIRED_##need,                     \
	.offset = offsetof(cau_wire_##o, field), .has_offset = HAS_##need(o, field),                   \
	.meaning = meaning_
#define LIMITS(least_, most_, unit_) .least = least_, .most = most_, .unit = unit_

#define OBJECT(o, meaning) static const cau_wire_field o##_fields[] = {
#define OBJECT_END(o)                                                                              \
	{                                                                                              \
		.name = NULL                                                                               \
	}                                                                                              \
	}                                                                                              \
	;
#define FLAG(o, field, need, meaning) {PLACE(o, field, need, FLAG, meaning)},
#define INTEGER(o, field, need, least, most, unit, meaning)                                        \
	{PLACE(o, field, need, INTEGER, meaning), LIMITS(least, most, unit)},
#define NUMBER(o, field, need, least, most, unit, meaning)                                         \
	{PLACE(o, field, need, NUMBER, meaning), LIMITS(least, most, unit)},
#define VECTOR(o, field, need, count_, least, most, unit, meaning)                                 \
	{PLACE(o, field, need, VECTOR, meaning), LIMITS(least, most, unit), .count = count_},
#define TEXT(o, field, need, bytes_max, meaning)                                                   \
	{PLACE(o, field, need, TEXT, meaning), .count = bytes_max},
#define NAME(o, field, need, meaning) {PLACE(o, field, need, NAME, meaning)},
#define HEX64(o, field, need, meaning) {PLACE(o, field, need, HEX64, meaning)},
#define CHOICE(o, field, need, choice, meaning)                                                    \
	{PLACE(o, field, need, CHOICE, meaning), .choices = &choice##_choices},
#define CHOICES(o, field, need, choice, meaning)                                                   \
	{PLACE(o, field, need, CHOICES, meaning), .choices = &choice##_choices},
#define PART(o, field, need, object_, meaning)                                                     \
	{PLACE(o, field, need, PART, meaning), .object = CAU_WIRE_##object_},
#define LIST(o, field, need, object_, count_max, meaning)                                          \
	{PLACE(o, field, need, LIST, meaning), .object = CAU_WIRE_##object_, .count = count_max},
#define NUMBERS(o, field, need, count_max, least, most, unit, meaning)                             \
	{PLACE(o, field, need, NUMBERS, meaning), LIMITS(least, most, unit), .count = count_max},
#define INTEGERS(o, field, need, count_max, least, most, unit, meaning)                            \
	{PLACE(o, field, need, INTEGERS, meaning), LIMITS(least, most, unit), .count = count_max},
#define SCENE(o, field, need, meaning) {PLACE(o, field, need, SCENE, meaning)},
#include "cautery/messages.def"

// ---- objects ------------------------------------------------------------------------------------
#define OBJECT(o, meaning)                                                                         \
	[CAU_WIRE_##o] = {#o, meaning, sizeof(cau_wire_##o), o##_fields,                               \
	                  (int32_t)(sizeof o##_fields / sizeof *o##_fields) - 1},
#define OBJECT_END(o)
#define FLAG(o, field, need, meaning)
#define INTEGER(o, field, need, least, most, unit, meaning)
#define NUMBER(o, field, need, least, most, unit, meaning)
#define VECTOR(o, field, need, count, least, most, unit, meaning)
#define TEXT(o, field, need, bytes_max, meaning)
#define NAME(o, field, need, meaning)
#define HEX64(o, field, need, meaning)
#define CHOICE(o, field, need, choice, meaning)
#define CHOICES(o, field, need, choice, meaning)
#define PART(o, field, need, object, meaning)
#define LIST(o, field, need, object, count_max, meaning)
#define NUMBERS(o, field, need, count_max, least, most, unit, meaning)
#define INTEGERS(o, field, need, count_max, least, most, unit, meaning)
#define SCENE(o, field, need, meaning)
const cau_wire_shape cau_wire_shapes[CAU_WIRE_OBJECT_COUNT] = {
#include "cautery/messages.def"
};

// ---- methods ------------------------------------------------------------------------------------
#define CHANGES true
#define READS false
#define CALL(form_, name_, params_, result_, role_, changes_, cost_, command_, meaning_)           \
	{.name = (name_),                                                                              \
	 .form = CAU_FORM_##form_,                                                                     \
	 .params = CAU_WIRE_##params_,                                                                 \
	 .result = CAU_WIRE_##result_,                                                                 \
	 .role = CAU_ROLE_##role_,                                                                     \
	 .changes = (changes_),                                                                        \
	 .cost = CAU_COST_##cost_,                                                                     \
	 .command = (command_),                                                                        \
	 .meaning = (meaning_)},
#define REQUEST(code, name, params, result, role, effect, cost, handler, meaning)                  \
	CALL(REQUEST, name, params, result, role, effect, cost, -1, meaning)
#define EITHER_WAY(code, name, params, result, role, effect, cost, handler, meaning)               \
	CALL(EITHER_WAY, name, params, result, role, effect, cost, -1, meaning)
#define NOTICE(code, name, params, role, handler, meaning)                                         \
	CALL(NOTICE, name, params, nothing, role, false, CHEAP, -1, meaning)
#define COMMAND(code, name, form, meaning)                                                         \
	CALL(form, name, nothing, command_result, OPERATE, true, CHEAP, CAU_COMMAND_##code, meaning)
#define PUSH(code, name, params, meaning)                                                          \
	CALL(PUSH, name, params, nothing, VIEW, false, CHEAP, -1, meaning)
static const cau_method_info methods[CAU_METHOD_COUNT] = {
#include "cautery/methods.def"
};
// clang-format on

const cau_method_info *cau_method_describe(cau_method method)
{
	CAU_ASSERT((unsigned)method >= CAU_METHOD_COUNT || methods[method].name,
	           "method %d is not in the table", (int)method);
	return (unsigned)method < CAU_METHOD_COUNT ? &methods[method] : NULL;
}

int32_t cau_method_find(const char *name)
{
	for (int32_t method = 0; method < CAU_METHOD_COUNT; method++)
		if (strcmp(methods[method].name, name) == 0)
			return method;
	return -1;
}
