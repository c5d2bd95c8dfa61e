// SPDX-License-Identifier: GPL-3.0-or-later
#include <inttypes.h>
#include <string.h>

#include "config/config.h"
#include "config/setting.h"

static void print_text(const char *text, FILE *stream)
{
	fputc('"', stream);
	for (; *text; text++) {
		if (*text == '"' || *text == '\\')
			fprintf(stream, "\\%c", *text);
		else if ((unsigned char)*text < 0x20)
			fprintf(stream, "\\u%04x", (unsigned)*text);
		else
			fputc(*text, stream);
	}
	fputc('"', stream);
}

void cau_config_print(const cau_config *config, FILE *stream)
{
	for (size_t i = 0; i < cau_setting_count; i++) {
		const setting *s = &cau_settings[i];
		const char *member = (const char *)config + s->offset;
		fprintf(stream, "%s\"%s\": ", i ? ",\n  " : "{\n  ", s->name);
		switch (s->kind) {
		case SETTING_TEXT:
			print_text(member, stream);
			break;
		case SETTING_INTEGER:
			fprintf(stream, "%" PRId64, *(const int64_t *)(const void *)member);
			break;
		case SETTING_REAL:
			fprintf(stream, "%.17g", *(const double *)(const void *)member);
			break;
		case SETTING_SWITCH:
			fputs(*(const bool *)(const void *)member ? "true" : "false", stream);
			break;
		}
	}
	fputs("\n}\n", stream);
}

// Writes a setting's type, bounds and default as members of a JSON Schema.
static void print_type(const setting *s, FILE *stream)
{
	static const char *const types[] = {[SETTING_TEXT] = "string",
	                                    [SETTING_INTEGER] = "integer",
	                                    [SETTING_REAL] = "number",
	                                    [SETTING_SWITCH] = "boolean"};
	fprintf(stream, "\"type\": \"%s\", ", types[s->kind]);
	if (s->kind == SETTING_TEXT)
		fprintf(stream, "\"maxLength\": %d, ", CAU_CONFIG_TEXT_BYTES - 1);
	if (s->kind == SETTING_INTEGER || s->kind == SETTING_REAL)
		fprintf(stream, "\"minimum\": %.15g, \"maximum\": %.15g, ", s->least, s->most);
	fputs("\"default\": ", stream);
	if (s->kind == SETTING_TEXT)
		print_text(s->default_text, stream);
	else
		fputs(s->default_text, stream);
}

void cau_config_schema(FILE *stream)
{
	fputs("{\n  \"$schema\": \"https://json-schema.org/draft/2020-12/schema\",\n"
	      "  \"title\": \"Settings of cauteryd\",\n  \"type\": \"object\",\n"
	      "  \"additionalProperties\": false,\n  \"properties\": {",
	      stream);
	for (size_t i = 0; i < cau_setting_count; i++) {
		const setting *s = &cau_settings[i];
		fprintf(stream, "%s\n    \"%s\": {", i ? "," : "", s->name);
		print_type(s, stream);
		fputs(", \"description\": ", stream);
		print_text(s->meaning, stream);
		fputc('}', stream);
	}
	fputs("\n  }\n}\n", stream);
}

void cau_config_help(FILE *stream)
{
	fputs("cauteryd [--config FILE] [--SETTING VALUE]...\n"
	      "Serves simulated soft tissue, to be dissected with energized instruments, to browsers,\n"
	      "robots and programs.\n\n"
	      "  --config FILE                  a JSON object of the settings below\n"
	      "  --print-config                 print the settings in force and end\n"
	      "  --settings-schema              print a JSON Schema of the settings and end\n"
	      "  --backup FILE                  copy the store, even of a running daemon, and end\n"
	      "  --json                         print one line of JSON with the address once ready\n"
	      "  --version                      version of this program\n"
	      "  --help                         this text\n\n"
	      "Settings (flag over CAUTERY_SETTING in the environment over file over default):\n\n",
	      stream);
	for (size_t i = 0; i < cau_setting_count; i++) {
		const setting *s = &cau_settings[i];
		char flag[64];
		snprintf(flag, sizeof flag, "%s", s->name);
		for (char *c = flag; *c; c++)
			*c = *c == '_' ? '-' : *c;
		fprintf(stream, "  --%-28s %s [%s]\n", flag, s->meaning, s->default_text);
	}
	fputs("\nExit code: 0 ended by a signal; 1 the daemon could not start or lost its label; the "
	      "last "
	      "line of "
	      "the log says why;\n2 the settings are wrong.\n",
	      stream);
}
