// SPDX-License-Identifier: Apache-2.0
#include <string.h>

#include "cautery/rpc_errors.h"
#include "cautery/stream.h"
#include "generate/model.h"

static const char *const role_names[] = {
#define X(code, name) name,
	CAU_ROLE_TABLE(X)
#undef X
};

// Writes a link to the type's heading. GitHub and others make the anchor lower-case.
static void write_link(FILE *out, const char *type_name)
{
	fprintf(out, "[%s](#", type_name);
	for (const char *c = type_name; *c; c++)
		fputc(*c >= 'A' && *c <= 'Z' ? *c - 'A' + 'a' : *c, out);
	fputc(')', out);
}

static void write_words(FILE *out, const property *of)
{
	for (int i = 0; i < of->choices->count; i++)
		if (of->fixed < 0 || of->fixed == i)
			fprintf(out, "%s`%s`", i && of->fixed < 0 ? ", " : "", of->choices->names[i]);
}

static void write_range(FILE *out, const property *of)
{
	bool has_unit = of->unit[0] && strcmp(of->unit, "1") != 0;
	fprintf(out, ", %.16g to %.16g%s%s", of->least, of->most, has_unit ? " " : "",
	        has_unit ? of->unit : "");
}

static void write_value(FILE *out, const property *of)
{
	switch (of->kind) {
	case PROPERTY_FLAG:
		fputs("true or false", out);
		break;
	case PROPERTY_INTEGER:
		fputs("integer", out);
		write_range(out, of);
		break;
	case PROPERTY_NUMBER:
		fputs("number", out);
		write_range(out, of);
		break;
	case PROPERTY_NUMBERS:
	case PROPERTY_INTEGERS:
		fprintf(out, "%s%d %s", of->least_count ? "" : "at most ", of->count,
		        of->kind == PROPERTY_NUMBERS ? "numbers" : "integers");
		write_range(out, of);
		break;
	case PROPERTY_ROTATION:
		fputs("quaternion w, x, y, z", out);
		break;
	case PROPERTY_TEXT:
		fprintf(out, "text, at most %d bytes", of->count);
		break;
	case PROPERTY_NAME:
		fputs("name", out);
		break;
	case PROPERTY_HEX64:
		fputs("16 hex digits", out);
		break;
	case PROPERTY_CHOICE:
		write_words(out, of);
		break;
	case PROPERTY_CHOICES:
		fputs("set of ", out);
		write_words(out, of);
		break;
	case PROPERTY_OBJECT:
		write_link(out, of->type);
		break;
	case PROPERTY_OBJECTS:
		fprintf(out, "at most %d ", of->count);
		write_link(out, of->type);
		break;
	}
}

// Writes text into a table cell. A | would end the cell, so it is escaped.
static void write_meaning(FILE *out, const char *text)
{
	for (; *text; text++)
		fprintf(out, "%s%c", *text == '|' ? "\\" : "", *text);
}

static void write_type(FILE *out, const type *of)
{
	fprintf(out, "\n### %s\n\n", of->name);
	write_meaning(out, of->meaning);
	fputs(".\n", out);
	if (of->variant_count > 0) {
		fputs("\nOne of:", out);
		for (int i = 0; i < of->variant_count; i++) {
			fputs(i ? ", " : " ", out);
			write_link(out, of->variants[i]);
		}
		fputs(".\n", out);
		return;
	}
	if (of->property_count == 0)
		return;
	fputs("\n| member | | value | meaning |\n|---|---|---|---|\n", out);
	for (int i = 0; i < of->property_count; i++) {
		const property *member = &of->properties[i];
		fprintf(out, "| `%s` | %s", member->name, member->required ? "required" : "");
		if (member->unless)
			fprintf(out, "required without `%s`", member->unless);
		fputs(" | ", out);
		write_value(out, member);
		fputs(" | ", out);
		write_meaning(out, member->meaning);
		fputs(" |\n", out);
	}
}

static const char *form_name(cau_method_form form)
{
	static const char *const names[] = {"request", "request or notification", "notification",
	                                    "from the server"};
	return names[form];
}

static void write_methods(FILE *out, const model *from)
{
	fputs("\n## Methods\n\nRole: the least that may call it. A star: it takes `client_sequence`. A "
	      "dagger: "
	      "the quotas of expensive requests count it.\n\n"
	      "| method | | params | result | role | meaning |\n|---|---|---|---|---|---|\n",
	      out);
	for (int i = 0; i < CAU_METHOD_COUNT; i++) {
		const cau_method_info *info = cau_method_describe((cau_method)i);
		fprintf(out, "| `%s`%s%s | %s | ", info->name, info->changes ? " \\*" : "",
		        info->cost == CAU_COST_CHEAP ? "" : " †", form_name(info->form));
		write_link(out, from->params[i]);
		fputs(" | ", out);
		if (from->results[i][0])
			write_link(out, from->results[i]);
		fprintf(out, " | %s | ", info->form == CAU_FORM_PUSH ? "" : role_names[info->role]);
		write_meaning(out, info->meaning);
		fputs(" |\n", out);
	}
}

static void write_codes(FILE *out)
{
	fputs("\n## Errors\n\n| code | status | message |\n|---:|---|---|\n", out);
#define X(number, code, word, sentence)                                                            \
	fprintf(out, "| %d | `%s` | %s |\n", number, word, sentence);
	CAU_RPC_ERROR_TABLE(X)
#undef X
	fputs("\n## Close codes\n\n| code | reason |\n|---:|---|\n", out);
#define X(number, code, reason) fprintf(out, "| %d | %s |\n", number, reason);
	CAU_CLOSE_TABLE(X)
#undef X
}

static void write_quantiser(FILE *out, const cau_channel_info *info)
{
	bool plain = strcmp(info->unit, "1") == 0;
	if (info->scalar < 0)
		fputs("see the section", out);
	else if (plain && info->step * info->most == 1.0)
		fprintf(out, "n / %u", info->most);
	else if (info->step > 0)
		fprintf(out, "%.16g + %.16g n%s%s, n at most %u", info->least, info->step, plain ? "" : " ",
		        plain ? "" : info->unit, info->most);
	else
		fprintf(out, "%.16g + `stress_step_pa` n %s, n at most %u", info->least, info->unit,
		        info->most);
}

static void write_channels(FILE *out)
{
	fputs(
		"\n## Channels\n\nBit: in a DDS frame's `channels`. Section: in frames. Those marked with "
		"a star are in a stream that says nothing of channels. A scalar is one number n a vertex, "
		"in an element section of 1 component; the fourth column explains its value.\n\n"
		"| channel | bit | section | value of n | meaning |\n|---|---:|---:|---|---|\n",
		out);
	for (int i = 0; i < CAU_CHANNEL_COUNT; i++) {
		const cau_channel_info *info = cau_channel_describe((cau_channel_index)i);
		fprintf(out, "| `%s`%s | %u | %d | ", info->name, info->by_default ? " \\*" : "", 1u << i,
		        info->section);
		write_quantiser(out, info);
		fputs(" | ", out);
		write_meaning(out, info->meaning);
		fputs(" |\n", out);
	}
}

// Writes the tables of scene.h that clients choose from, with their numbers in frames.
static void write_descriptors(FILE *out)
{
	int number = 0;
	fputs("\n## Tool shapes\n\nThe number stands in a frame's tool_names.\n\n"
	      "| number | shape | hot part | jaws | |\n|---:|---|---|---|---|\n",
	      out);
#define X(code, word, hot, jaws, meaning)                                                          \
	fprintf(out, "| %d | `" #word "` | %s | %s | " meaning " |\n", number++, hot ? "yes" : "no",   \
	        jaws ? "yes" : "no");
	CAU_TOOL_SHAPE_TABLE(X)
#undef X
	fputs("\n## Laws of fat\n\n| model | Poisson's ratio up to | |\n|---|---:|---|\n", out);
#define X(code, word, poisson_most, has_energy, keeps_rotation, lambda_mu, mu_mu, meaning)         \
	fprintf(out, "| `" #word "` | %.3g | " meaning " |\n", poisson_most);
	CAU_MODEL_TABLE(X)
#undef X
}

void write_markdown(FILE *out, const model *from)
{
	fputs("# Messages\n\nGenerated from the message tables in `include/cautery/`; "
	      "build the target `messages` after a change there. The rules are in "
	      "[README.md](README.md).\n",
	      out);
	write_methods(out, from);
	write_codes(out);
	write_channels(out);
	write_descriptors(out);
	fputs("\n## Objects\n", out);
	for (int i = 0; i < from->type_count; i++)
		write_type(out, &from->types[i]);
}
