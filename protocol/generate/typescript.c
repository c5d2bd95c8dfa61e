// SPDX-License-Identifier: Apache-2.0
#include <string.h>

#include "cautery/frame_codec.h"
#include "cautery/rpc.h"
#include "cautery/rpc_errors.h"
#include "generate/model.h"

static void write_words(FILE *out, const cau_choices *choices)
{
	for (int i = 0; i < choices->count; i++)
		fprintf(out, "%s'%s'", i ? " | " : "", choices->names[i]);
}

static void write_numbers(FILE *out, const property *of)
{
	if (of->count != of->least_count || of->count > 8) {
		fputs("number[]", out);
		return;
	}
	fputc('[', out);
	for (int32_t i = 0; i < of->count; i++)
		fputs(i ? ", number" : "number", out);
	fputc(']', out);
}

static void write_value_type(FILE *out, const property *of)
{
	switch (of->kind) {
	case PROPERTY_FLAG:
		fputs("boolean", out);
		break;
	case PROPERTY_INTEGER:
	case PROPERTY_NUMBER:
		fputs("number", out);
		break;
	case PROPERTY_NUMBERS:
	case PROPERTY_INTEGERS:
		write_numbers(out, of);
		break;
	case PROPERTY_ROTATION:
		fputs("[number, number, number, number]", out);
		break;
	case PROPERTY_TEXT:
	case PROPERTY_NAME:
	case PROPERTY_HEX64:
		fputs("string", out);
		break;
	case PROPERTY_CHOICE:
		if (of->fixed >= 0)
			fprintf(out, "'%s'", of->choices->names[of->fixed]);
		else
			write_words(out, of->choices);
		break;
	case PROPERTY_CHOICES:
		fputc('(', out);
		write_words(out, of->choices);
		fputs(")[]", out);
		break;
	case PROPERTY_OBJECT:
		fputs(of->type, out);
		break;
	case PROPERTY_OBJECTS:
		fprintf(out, "%s[]", of->type);
		break;
	}
}

static void write_unit(FILE *out, const property *of)
{
	bool has_unit = of->unit[0] && strcmp(of->unit, "1") != 0;
	bool ranged = of->kind == PROPERTY_NUMBER || of->kind == PROPERTY_INTEGER ||
	              of->kind == PROPERTY_NUMBERS || of->kind == PROPERTY_INTEGERS;
	if (ranged)
		fprintf(out, " (%.16g to %.16g%s%s)", of->least, of->most, has_unit ? " " : "",
		        has_unit ? of->unit : "");
}

static void write_type(FILE *out, const type *of)
{
	fprintf(out, "\n/** %s */\n", of->meaning);
	if (of->variant_count > 0) {
		fprintf(out, "export type %s =", of->name);
		for (int i = 0; i < of->variant_count; i++)
			fprintf(out, "%s %s", i ? " |" : "", of->variants[i]);
		fputs(";\n", out);
		return;
	}
	if (of->property_count == 0) {
		fprintf(out, "export type %s = Record<string, never>;\n", of->name);
		return;
	}
	fprintf(out, "export interface %s {\n", of->name);
	for (int i = 0; i < of->property_count; i++) {
		const property *member = &of->properties[i];
		fprintf(out, "  /** %s", member->meaning);
		write_unit(out, member);
		fprintf(out, " */\n  %s%s: ", member->name, member->required ? "" : "?");
		write_value_type(out, member);
		fputs(";\n", out);
	}
	fputs("}\n", out);
}

static bool is_call(const cau_method_info *info, bool answered)
{
	if (answered)
		return info->form == CAU_FORM_REQUEST || info->form == CAU_FORM_EITHER_WAY;
	return info->form == CAU_FORM_NOTICE || info->form == CAU_FORM_EITHER_WAY;
}

static void write_methods(FILE *out, const model *from)
{
	fputs("\n/** Requests: params and result of each method. */\nexport interface Requests {\n",
	      out);
	for (int i = 0; i < CAU_METHOD_COUNT; i++) {
		const cau_method_info *info = cau_method_describe((cau_method)i);
		if (is_call(info, true))
			fprintf(out, "  /** %s */\n  '%s': { params: %s; result: %s };\n", info->meaning,
			        info->name, from->params[i], from->results[i]);
	}
	fputs("}\n\n/** Notifications from the client. */\nexport interface Notices {\n", out);
	for (int i = 0; i < CAU_METHOD_COUNT; i++) {
		const cau_method_info *info = cau_method_describe((cau_method)i);
		if (is_call(info, false))
			fprintf(out, "  /** %s */\n  '%s': %s;\n", info->meaning, info->name, from->params[i]);
	}
	fputs("}\n\n/** Notifications from the server. */\nexport interface Pushes {\n", out);
	for (int i = 0; i < CAU_METHOD_COUNT; i++) {
		const cau_method_info *info = cau_method_describe((cau_method)i);
		if (info->form == CAU_FORM_PUSH)
			fprintf(out, "  /** %s */\n  '%s': %s;\n", info->meaning, info->name, from->params[i]);
	}
	fputs("}\n\n/** Requests that take client_sequence: sent again they act once. */\n"
	      "export const CHANGING_METHODS: ReadonlySet<string> = new Set<string>([\n",
	      out);
	for (int i = 0; i < CAU_METHOD_COUNT; i++)
		if (cau_method_describe((cau_method)i)->changes)
			fprintf(out, "  '%s',\n", cau_method_describe((cau_method)i)->name);
	fputs("]);\n", out);
}

static void write_scalars(FILE *out)
{
	fputs("\n/** Scalars of the vertices: n in a frame stands for least + step n in the unit, n is "
	      "at "
	      "most `most`.\n * Step 0: the stream states it, as stress_step_pa. */\n"
	      "export const SCALARS = {\n",
	      out);
	for (int i = 0; i < CAU_CHANNEL_COUNT; i++) {
		const cau_channel_info *info = cau_channel_describe((cau_channel_index)i);
		if (info->scalar >= 0)
			fprintf(out,
			        "  /** %s */\n  %s: { section: %d, byDefault: %s, least: %.16g, step: %.16g, "
			        "most: %u, unit: '%s' },\n",
			        info->meaning, info->name, info->section, info->by_default ? "true" : "false",
			        info->least, info->step, info->most, info->unit);
	}
	fputs("} as const;\nexport type ScalarName = keyof typeof SCALARS;\n", out);
}

static void write_lists(FILE *out)
{
	fputs("\n/** error.code by error.data.status. */\nexport const ERROR_CODES = {\n", out);
#define X(number, code, word, sentence) fprintf(out, "  %s: %d,\n", word, number);
	CAU_RPC_ERROR_TABLE(X)
#undef X
	fputs("} as const;\nexport type ErrorStatus = keyof typeof ERROR_CODES;\n", out);
	fputs("\n/** Close codes of the connection and what they mean. */\n"
	      "export const CLOSE_REASONS: Readonly<Record<number, string>> = {\n",
	      out);
#define X(number, code, reason) fprintf(out, "  %d: '%s',\n", number, reason);
	CAU_CLOSE_TABLE(X)
#undef X
	fputs("};\n\nexport const FRAME_KIND = {", out);
#define X(code, number, name) fprintf(out, " %s: %d,", name, number);
	CAU_FRAME_KIND_TABLE(X)
#undef X
	fputs(" } as const;\nexport const SECTION = {\n", out);
	for (int i = 0; i < CAU_CHANNEL_COUNT; i++) {
		const cau_channel_info *info = cau_channel_describe((cau_channel_index)i);
		fprintf(out, "  %s: %d,\n", info->name, info->section);
	}
#define X(code, number, name) fprintf(out, "  %s: %d,\n", name, number);
	CAU_OTHER_SECTION_TABLE(X)
#undef X
	fputs("} as const;\n", out);
	write_scalars(out);
	fputs("\n/** Words that frames tell by their number. */\nexport const TOOL_SHAPES = [", out);
#define X(code, word, ...) fputs("'" #word "', ", out);
	CAU_TOOL_SHAPE_TABLE(X)
#undef X
	fputs("] as const;\nexport const ENERGY_OFF_REASONS = [", out);
#define X(code, name) fprintf(out, "'%s', ", name);
	CAU_ENERGY_OFF_TABLE(X)
#undef X
	fputs("] as const;\n", out);
}

// Writes the traits of tool shapes, and the choices for materials.
static void write_descriptors(FILE *out)
{
	fputs("\n/** What a tool of a shape has. */\n"
	      "export const SHAPE_TRAITS: Readonly<Record<(typeof TOOL_SHAPES)[number], "
	      "{ hot: boolean; jaws: boolean; meaning: string }>> = {\n",
	      out);
#define X(code, word, hot, jaws, meaning)                                                          \
	fputs("  " #word ": { hot: " #hot ", jaws: " #jaws ", meaning: '" meaning "' },\n", out);
	CAU_TOOL_SHAPE_TABLE(X)
#undef X
	fputs("};\n\n/** Choices of a material, in words. */\nexport const MODELS = [", out);
#define X(code, word, ...) fputs("'" #word "', ", out);
	CAU_MODEL_TABLE(X)
#undef X
	fputs("] as const;\nexport const LIMITS = [", out);
#define X(code, name) fprintf(out, "'%s', ", name);
	CAU_LIMIT_TABLE(X)
	fputs("] as const;\nexport const PROJECTIONS = [", out);
	CAU_PROJECTION_TABLE(X)
#undef X
	fputs("] as const;\n", out);
}

// Writes numbers with range, unit and default, for panels that edit them.
static void write_parameters(FILE *out, const model *from, const char *key, const char *name)
{
	const type *of = model_find(from, name);
	fprintf(out, "  %s: [\n", key);
	for (int i = 0; i < of->property_count; i++) {
		const property *member = &of->properties[i];
		if (member->default_value)
			fprintf(out,
			        "    { name: '%s', unit: '%s', least: %.16g, most: %.16g, default: %.16g,\n"
			        "      meaning: \"%s\" },\n",
			        member->name, member->unit, member->least, member->most, *member->default_value,
			        member->meaning);
	}
	fputs("  ],\n", out);
}

void write_typescript(FILE *out, const model *from)
{
	fputs("// SPDX-License-Identifier: Apache-2.0\n"
	      "// Generated from protocol/include/cautery/*.def and the codec's tables; do not edit.\n"
	      "// After a change there, build the target `messages`.\n\n",
	      out);
	fprintf(out, "export const WIRE_VERSION = %d;\nexport const SUBPROTOCOL = '%s';\n",
	        CAU_FRAME_VERSION, CAU_SUBPROTOCOL);
	for (int i = 0; i < from->type_count; i++)
		write_type(out, &from->types[i]);
	write_methods(out, from);
	write_lists(out);
	write_descriptors(out);
	fputs("\nexport interface Parameter {\n  name: string;\n  unit: string;\n  least: number;\n"
	      "  most: number;\n  default: number;\n  meaning: string;\n}\n\n"
	      "/** Numbers that panels edit. */\nexport const PARAMETERS = {\n",
	      out);
	write_parameters(out, from, "scene", "Scene");
	write_parameters(out, from, "tool", "Tool");
	write_parameters(out, from, "fascia", "MaterialSetFascia");
	write_parameters(out, from, "membrane", "MaterialSetMembrane");
	write_parameters(out, from, "fat", "MaterialSetFat");
	write_parameters(out, from, "links", "MaterialSetLinks");
	fputs("} satisfies Record<string, Parameter[]>;\n", out);
}
