// SPDX-License-Identifier: Apache-2.0
// Macros for the tables of fields. STRUCT must be defined as the struct whose fields follow. All
// macros except SCALAR are used inside braces, where more members (.required, .kinds) may follow.
#pragma once

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
