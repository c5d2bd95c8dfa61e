// SPDX-License-Identifier: Apache-2.0
// All JSON types of the protocol in one form: objects of messages.def, commands and scenes. The
// pages, the code for other languages and AsyncAPI are all generated from this model.
#pragma once

#include <stdio.h>

#include "rpc/message.h"

typedef enum property_kind {
	PROPERTY_FLAG,
	PROPERTY_INTEGER,
	PROPERTY_NUMBER,
	PROPERTY_NUMBERS,  // array of least_count to count numbers
	PROPERTY_INTEGERS, // array of least_count to count integers
	PROPERTY_ROTATION,
	PROPERTY_TEXT,
	PROPERTY_NAME,
	PROPERTY_HEX64,
	PROPERTY_CHOICE,
	PROPERTY_CHOICES, // a set of words
	PROPERTY_OBJECT,  // an object of type `type`
	PROPERTY_OBJECTS, // array of at most `count`
} property_kind;

typedef struct property {
	const char *name;
	property_kind kind;
	bool required;
	const char *unless; // name of another member, without which this property is required; or NULL
	double least, most;
	int32_t count, least_count;
	const cau_choices *choices;
	int32_t fixed; // CHOICE: the only allowed word, or -1
	const char *type;
	const char *unit, *meaning;
	const double *default_value; // default of a NUMBER in a scene or command, or NULL
} property;

enum { NAME_BYTES = 48, PROPERTIES_MAX = 48, TYPES_MAX = 128, VARIANTS_MAX = 4 };

typedef struct type {
	char name[NAME_BYTES]; // PascalCase
	const char *meaning;
	bool strict; // unknown members are refused
	int property_count;
	property properties[PROPERTIES_MAX];
	int variant_count; // number of types in a union, which has no properties
	char variants[VARIANTS_MAX][NAME_BYTES];
} type;

typedef struct model {
	int type_count;
	type types[TYPES_MAX];
	char params[CAU_METHOD_COUNT][NAME_BYTES]; // type of each method's params
	// type of each method's result; empty if there is none
	char results[CAU_METHOD_COUNT][NAME_BYTES];
} model;

// Fills *made, which is large, so make it static. Aborts if one of the bounds above is too small.
void model_make(model *made);
const type *model_find(const model *of, const char *name);

// ---- the files that are made from the model
// Only write_examples uses the codecs.

void write_typescript(FILE *out, const model *from);
void write_python(FILE *out, const model *from);
void write_asyncapi(FILE *out, const model *from);
void write_markdown(FILE *out, const model *from);
void write_examples(FILE *out);
