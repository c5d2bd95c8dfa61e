// SPDX-License-Identifier: Apache-2.0
// Writes the protocol in Python: types, and a class with a function for each request.
#include <string.h>

#include "cautery/frame_codec.h"
#include "cautery/rpc.h"
#include "cautery/rpc_errors.h"
#include "generate/model.h"

static void write_words(FILE *out, const cau_choices *choices, int fixed)
{
	fputs("Literal[", out);
	for (int i = 0; i < choices->count; i++)
		if (fixed < 0 || fixed == i)
			fprintf(out, "%s\"%s\"", i && fixed < 0 ? ", " : "", choices->names[i]);
	fputc(']', out);
}

static void write_value_type(FILE *out, const property *of)
{
	switch (of->kind) {
	case PROPERTY_FLAG:
		fputs("bool", out);
		break;
	case PROPERTY_INTEGER:
		fputs("int", out);
		break;
	case PROPERTY_NUMBER:
		fputs("float", out);
		break;
	case PROPERTY_NUMBERS:
	case PROPERTY_ROTATION:
		fputs("Sequence[float]", out);
		break;
	case PROPERTY_INTEGERS:
		fputs("Sequence[int]", out);
		break;
	case PROPERTY_TEXT:
	case PROPERTY_NAME:
	case PROPERTY_HEX64:
		fputs("str", out);
		break;
	case PROPERTY_CHOICE:
		write_words(out, of->choices, of->fixed);
		break;
	case PROPERTY_CHOICES:
		fputs("Sequence[", out);
		write_words(out, of->choices, -1);
		fputc(']', out);
		break;
	case PROPERTY_OBJECT:
		fputs(of->type, out);
		break;
	case PROPERTY_OBJECTS:
		fprintf(out, "Sequence[%s]", of->type);
		break;
	}
}

// True for a Python keyword that is also the name of a member.
static bool is_keyword(const char *name)
{
	static const char *const keywords[] = {"as", "class", "from", "global", "in", "is", "lambda"};
	for (size_t i = 0; i < sizeof keywords / sizeof *keywords; i++)
		if (strcmp(name, keywords[i]) == 0)
			return true;
	return false;
}

static bool has_keyword(const type *of)
{
	for (int i = 0; i < of->property_count; i++)
		if (is_keyword(of->properties[i].name))
			return true;
	return false;
}

static void write_range(FILE *out, const property *of)
{
	bool ranged = of->kind == PROPERTY_NUMBER || of->kind == PROPERTY_INTEGER ||
	              of->kind == PROPERTY_NUMBERS || of->kind == PROPERTY_INTEGERS;
	bool has_unit = of->unit[0] && strcmp(of->unit, "1") != 0;
	if (ranged)
		fprintf(out, " (%.16g to %.16g%s%s)", of->least, of->most, has_unit ? " " : "",
		        has_unit ? of->unit : "");
}

// Writes a member in a class, or in a dictionary, where any word may be a key.
static void write_member(FILE *out, const property *of, bool in_class)
{
	fprintf(out, "\n    # %s", of->meaning);
	write_range(out, of);
	fprintf(out, in_class ? "\n    %s: %s" : "\n    \"%s\": %s", of->name,
	        of->required ? "" : "NotRequired[");
	write_value_type(out, of);
	fputs(of->required ? "" : "]", out);
	fputs(in_class ? "\n" : ",\n", out);
}

static void write_type(FILE *out, const type *of)
{
	if (of->variant_count > 0) {
		fprintf(out, "\n\n# %s\n%s: TypeAlias = Union[", of->meaning, of->name);
		for (int i = 0; i < of->variant_count; i++)
			fprintf(out, "%s\"%s\"", i ? ", " : "", of->variants[i]);
		fputs("]\n", out);
		return;
	}
	bool is_class = !has_keyword(of);
	if (is_class)
		fprintf(out, "\n\nclass %s(TypedDict):\n    \"\"\"%s\"\"\"\n", of->name, of->meaning);
	else
		fprintf(out, "\n\n# %s\n%s = TypedDict(\"%s\", {", of->meaning, of->name, of->name);
	for (int i = 0; i < of->property_count; i++)
		write_member(out, &of->properties[i], is_class);
	fputs(is_class ? "" : "})\n", out);
}

static void write_parameters(FILE *out, const type *of)
{
	for (int i = 0; i < of->property_count; i++) {
		const property *member = &of->properties[i];
		fprintf(out, "%s        %s%s: ", i ? ",\n" : ",\n        *,\n", member->name,
		        is_keyword(member->name) ? "_" : "");
		write_value_type(out, member);
		if (!member->required)
			fputs(" | None = None", out);
	}
}

static void write_call(FILE *out, const model *from, int method)
{
	const cau_method_info *info = cau_method_describe((cau_method)method);
	const type *params = model_find(from, from->params[method]);
	char name[NAME_BYTES];
	snprintf(name, sizeof name, "%s", info->name);
	for (char *c = name; *c; c++)
		*c = *c == '.' ? '_' : *c;
	bool is_union = params->variant_count > 0;
	fprintf(out, "\n    def %s(\n        self", name);
	if (is_union)
		fputs(",\n        **params: Any", out);
	else
		write_parameters(out, params);
	fprintf(out, ",\n    ) -> %s:\n        \"\"\"`%s`: %s\n", from->results[method], info->name,
	        info->meaning);
	for (int i = 0; i < params->property_count; i++) {
		const property *member = &params->properties[i];
		fprintf(out, "\n        %s%s: %s", member->name, is_keyword(member->name) ? "_" : "",
		        member->meaning);
		write_range(out, &params->properties[i]);
	}
	fprintf(out, "%s        \"\"\"\n        return self.call(\"%s\", ",
	        params->property_count ? "\n" : "", info->name);
	if (is_union)
		fputs("params)\n", out);
	else if (params->property_count == 0)
		fputs("{})\n", out);
	else {
		fputs("{\n", out);
		for (int i = 0; i < params->property_count; i++)
			fprintf(out, "            \"%s\": %s%s,\n", params->properties[i].name,
			        params->properties[i].name, is_keyword(params->properties[i].name) ? "_" : "");
		fputs("        })\n", out);
	}
}

static void write_calls(FILE *out, const model *from)
{
	fputs("\n\nclass Calls:\n    \"\"\"A function for each request. What is None is left out."
	      "\"\"\"\n\n"
	      "    def call(self, method: str, params: Mapping[str, Any]) -> Any:\n"
	      "        \"\"\"Sends a request and waits for its result.\"\"\"\n"
	      "        raise NotImplementedError\n",
	      out);
	for (int i = 0; i < CAU_METHOD_COUNT; i++) {
		const cau_method_info *info = cau_method_describe((cau_method)i);
		if (info->form == CAU_FORM_REQUEST || info->form == CAU_FORM_EITHER_WAY)
			write_call(out, from, i);
	}
}

static void write_scalars(FILE *out)
{
	fputs("\n\nclass Scalar(NamedTuple):\n"
	      "    \"\"\"A scalar of the vertices: n in a frame is least + step n in the unit, n is at "
	      "most `most`.\n\n    Step 0: the stream describes it, as `stress_step_pa`.\"\"\"\n\n"
	      "    section: int\n    least: float\n    step: float\n    most: int\n    unit: str\n\n\n"
	      "SCALARS = {\n",
	      out);
	for (int i = 0; i < CAU_CHANNEL_COUNT; i++) {
		const cau_channel_info *info = cau_channel_describe((cau_channel_index)i);
		if (info->scalar >= 0)
			fprintf(out, "    # %s\n    \"%s\": Scalar(%d, %.16g, %.16g, %u, \"%s\"),\n",
			        info->meaning, info->name, info->section, info->least, info->step, info->most,
			        info->unit);
	}
	fputs("}\n", out);
}

static void write_tables(FILE *out)
{
	fputs("\n# What a word of error.data.status is as error.code.\nERROR_CODES = {\n", out);
#define X(number, code, word, sentence) fprintf(out, "    \"%s\": %d,\n", word, number);
	CAU_RPC_ERROR_TABLE(X)
#undef X
	fputs("}\n\n# Codes with which a connection closes.\nCLOSE_REASONS = {\n", out);
#define X(number, code, reason) fprintf(out, "    %d: \"%s\",\n", number, reason);
	CAU_CLOSE_TABLE(X)
#undef X
	fputs("}\n\nFRAME_KIND = {", out);
	const char *comma = "";
#define X(code, number, name) fprintf(out, "%s\"%s\": %d", comma, name, number), comma = ", ";
	CAU_FRAME_KIND_TABLE(X)
#undef X
	fputs("}\n\n# Numbers of a frame's sections.\nSECTION = {\n", out);
	for (int i = 0; i < CAU_CHANNEL_COUNT; i++) {
		const cau_channel_info *info = cau_channel_describe((cau_channel_index)i);
		fprintf(out, "    \"%s\": %d,\n", info->name, info->section);
	}
#define X(code, number, name) fprintf(out, "    \"%s\": %d,\n", name, number);
	CAU_OTHER_SECTION_TABLE(X)
#undef X
	fputs("}\n\n# Words that frames have as numbers.\nTOOL_SHAPES = (\n", out);
#define X(code, word, ...) fputs("    \"" #word "\",\n", out);
	CAU_TOOL_SHAPE_TABLE(X)
#undef X
	fputs(")\nENERGY_OFF_REASONS = (\n", out);
#define X(code, name) fprintf(out, "    \"%s\",\n", name);
	CAU_ENERGY_OFF_TABLE(X)
#undef X
	fputs(")\n", out);
}

static void write_changing(FILE *out)
{
	fputs("\n# Requests that take client_sequence: sent again they act once.\n"
	      "CHANGING_METHODS = frozenset({\n",
	      out);
	for (int i = 0; i < CAU_METHOD_COUNT; i++)
		if (cau_method_describe((cau_method)i)->changes)
			fprintf(out, "    \"%s\",\n", cau_method_describe((cau_method)i)->name);
	fputs("})\n", out);
}

static void write_expensive(FILE *out)
{
	fputs("\n# Requests that the quotas of expensive requests count: they may take long.\n"
	      "EXPENSIVE_METHODS = frozenset({\n",
	      out);
	for (int i = 0; i < CAU_METHOD_COUNT; i++)
		if (cau_method_describe((cau_method)i)->cost != CAU_COST_CHEAP)
			fprintf(out, "    \"%s\",\n", cau_method_describe((cau_method)i)->name);
	fputs("})\n", out);
}

void write_python(FILE *out, const model *from)
{
	fprintf(out,
	        "# SPDX-License-Identifier: Apache-2.0\n"
	        "\"\"\"The messages of the wire.\n\n"
	        "Generated from protocol/include/cautery/*.def and the codec's tables; do not edit. "
	        "After a change there,\nbuild the target `messages`.\n\"\"\"\n\n"
	        "# pylint: disable=too-many-lines,line-too-long\n"
	        "from __future__ import annotations\n\n"
	        "from typing import Any, Literal, Mapping, NamedTuple, NotRequired, Sequence, "
	        "TypeAlias, TypedDict, Union\n\n"
	        "WIRE_VERSION = %d\nSUBPROTOCOL = \"%s\"\n",
	        CAU_FRAME_VERSION, CAU_SUBPROTOCOL);
	write_tables(out);
	write_changing(out);
	write_expensive(out);
	write_scalars(out);
	for (int i = 0; i < from->type_count; i++)
		write_type(out, &from->types[i]);
	write_calls(out, from);
}
