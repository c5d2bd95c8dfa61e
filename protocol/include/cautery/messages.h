// SPDX-License-Identifier: Apache-2.0
// The messages as C types, generated from messages.def: object `hello` becomes cau_wire_hello. An
// optional member f has a bool has_f before it. Text is UTF-8 with a closing zero.
//
//     #include "cautery/messages.h"
//
//     // Returns the lowest role that may call a method, or CAU_ROLE_ADMIN for an unknown method.
//     static cau_role needed_role(const char *method)
//     {
//         int32_t found = cau_method_find(method);
//         return found < 0 ? CAU_ROLE_ADMIN : cau_method_describe((cau_method)found)->role;
//     }
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "cautery/message_choices.h"
#include "cautery/scene.h"

#ifdef __cplusplus
extern "C" {
#endif

// A list of objects of one kind, of doubles (NUMBERS) or of int64_t (INTEGERS). Writers write
// `count` items. For a reader, the caller provides `items` with `capacity`; the reader fills them
// and sets `count`. More items than `capacity` are the error CAU_LIMIT. The reader zeroes an item
// before filling it, except the `items` and `capacity` of the item's own lists.
typedef struct cau_wire_list {
	void *items;      // array of the type cau_wire_* that messages.def names
	int32_t count;    // number of items
	int32_t capacity; // capacity of `items`; only for readers
} cau_wire_list;

#define CAU_NEED_R(field)
#define CAU_NEED_O(field) bool has_##field;

#define OBJECT(o, meaning) typedef struct cau_wire_##o {
#define OBJECT_END(o)                                                                              \
	char end_; /* keeps objects without members standard C */                                      \
	}                                                                                              \
	cau_wire_##o;
#define FLAG(o, field, need, meaning) CAU_NEED_##need(field) bool field;
#define INTEGER(o, field, need, least, most, unit, meaning) CAU_NEED_##need(field) int64_t field;
#define NUMBER(o, field, need, least, most, unit, meaning) CAU_NEED_##need(field) double field;
#define VECTOR(o, field, need, count, least, most, unit, meaning)                                  \
	CAU_NEED_##need(field) double field[count];
#define TEXT(o, field, need, bytes_max, meaning) CAU_NEED_##need(field) char field[(bytes_max) + 1];
#define NAME(o, field, need, meaning) CAU_NEED_##need(field) char field[CAU_NAME_BYTES];
#define HEX64(o, field, need, meaning) CAU_NEED_##need(field) uint64_t field;
#define CHOICE(o, field, need, choice, meaning) CAU_NEED_##need(field) int32_t field;
#define CHOICES(o, field, need, choice, meaning)                                                   \
	CAU_NEED_##need(field) uint32_t field; // one bit per word
#define PART(o, field, need, object, meaning) CAU_NEED_##need(field) cau_wire_##object field;
#define LIST(o, field, need, object, count_max, meaning) CAU_NEED_##need(field) cau_wire_list field;
#define NUMBERS(o, field, need, count_max, least, most, unit, meaning)                             \
	CAU_NEED_##need(field) cau_wire_list field;
#define INTEGERS(o, field, need, count_max, least, most, unit, meaning)                            \
	CAU_NEED_##need(field) cau_wire_list field;
// The scene is borrowed. Readers fill it, or skip the member if the pointer is NULL.
#define SCENE(o, field, need, meaning) CAU_NEED_##need(field) cau_scene_def *field;
#include "cautery/messages.def"
#undef CAU_NEED_R
#undef CAU_NEED_O

// The objects of messages.def.
typedef enum cau_wire_object {
#define OBJECT(o, meaning) CAU_WIRE_##o,
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
#include "cautery/messages.def"
	CAU_WIRE_OBJECT_COUNT
} cau_wire_object;

// The methods of methods.def.
typedef enum cau_method {
#define REQUEST(code, ...) CAU_METHOD_##code,
#define EITHER_WAY(code, ...) CAU_METHOD_##code,
#define NOTICE(code, ...) CAU_METHOD_##code,
#define COMMAND(code, ...) CAU_METHOD_##code,
#define PUSH(code, ...) CAU_METHOD_##code,
#include "cautery/methods.def"
	CAU_METHOD_COUNT
} cau_method;

// Who sends a method, and whether it is answered.
typedef enum cau_method_form {
	CAU_FORM_REQUEST,    // sent by the client with an id, always answered
	CAU_FORM_EITHER_WAY, // sent by the client, answered if it has an id
	CAU_FORM_NOTICE,     // sent by the client, never answered
	CAU_FORM_PUSH,       // sent by the server, never answered
} cau_method_form;

// Whether a request counts against the quotas of expensive requests.
typedef enum cau_method_cost {
	CAU_COST_CHEAP,  // not counted by quotas
	CAU_COST_COSTLY, // counted
	CAU_COST_FILE,   // counted, and a file follows the answer
} cau_method_cost;

// The description of a method in methods.def.
typedef struct cau_method_info {
	const char *name;       // name in messages, such as "session.step"
	cau_method_form form;   // who sends it, and whether it is answered
	cau_wire_object params; // CAU_WIRE_nothing for commands: see cautery/command_json.h
	cau_wire_object result; // CAU_WIRE_nothing if there is no result; command_result for commands
	cau_role role;          // lowest role that may call it
	bool changes;           // its effect is stored, and client_sequence applies
	cau_method_cost cost;   // whether quotas count it
	int32_t command;        // CAU_COMMAND_* for cau_rpc_command, or -1
	const char *meaning;    // description for people
} cau_method_info;

const cau_method_info *cau_method_describe(cau_method method); // NULL for an unknown method
// CAU_METHOD_*, or -1 if there is no such method
int32_t cau_method_find(const char *name);

#ifdef __cplusplus
}
#endif
