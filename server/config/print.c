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

void cau_config_help(FILE *stream)
{
	fputs("cauteryd: a simulation server for energized soft-tissue dissection\n\n"
	      "usage: cauteryd [--config FILE] [--SETTING VALUE]... [--print-config] [--json]\n\n"
	      "  --config FILE         a JSON object of the settings below\n"
	      "  --print-config        print the settings in force and end\n"
	      "  --json                print one line of JSON with the address once ready\n"
	      "  --version, --help\n\n"
	      "Settings (flag over CAUTERY_SETTING in the environment over file over default):\n",
	      stream);
	for (size_t i = 0; i < cau_setting_count; i++) {
		const setting *s = &cau_settings[i];
		char flag[64];
		snprintf(flag, sizeof flag, "%s", s->name);
		for (char *c = flag; *c; c++)
			*c = *c == '_' ? '-' : *c;
		fprintf(stream, "  --%-20s %s [%s]\n", flag, s->meaning, s->default_text);
	}
}
