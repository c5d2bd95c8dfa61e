// SPDX-License-Identifier: GPL-3.0-or-later
#include "config/setting.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define TEXT(name, default_, meaning)                                                              \
	{#name, SETTING_TEXT, offsetof(cau_config, name), default_, 0, 0, meaning},
#define INTEGER(name, default_, least, most, meaning)                                              \
	{#name, SETTING_INTEGER, offsetof(cau_config, name), #default_, least, (double)(most), meaning},
#define REAL(name, default_, least, most, meaning)                                                 \
	{#name, SETTING_REAL, offsetof(cau_config, name), #default_, least, most, meaning},
#define SWITCH(name, default_, meaning)                                                            \
	{#name, SETTING_SWITCH, offsetof(cau_config, name), #default_, 0, 0, meaning},

const setting cau_settings[] = {CAU_CONFIG_TABLE(TEXT, INTEGER, REAL, SWITCH)};
const size_t cau_setting_count = sizeof cau_settings / sizeof cau_settings[0];

static bool same_name(const char *a, const char *b)
{
	for (; *a && *b; a++, b++)
		if ((*a == '-' ? '_' : *a) != *b)
			return false;
	return *a == *b;
}

const setting *cau_setting_find(const char *name)
{
	for (size_t i = 0; i < cau_setting_count; i++)
		if (same_name(name, cau_settings[i].name))
			return &cau_settings[i];
	return NULL;
}

static cau_status store_text(const setting *s, void *member, const char *text, cau_error *error)
{
	if (strlen(text) >= CAU_CONFIG_TEXT_BYTES)
		return cau_fail(error, CAU_BAD_VALUE, s->name, "longer than %d bytes",
		                CAU_CONFIG_TEXT_BYTES - 1);
	memcpy(member, text, strlen(text) + 1);
	return CAU_OK;
}

static cau_status store_integer(const setting *s, void *member, const char *text, cau_error *error)
{
	char *end;
	errno = 0;
	long long value = strtoll(text, &end, 10);
	if (end == text || *end || errno)
		return cau_fail(error, CAU_BAD_VALUE, s->name, "`%.60s` is not a whole number", text);
	if ((double)value < s->least || (double)value > s->most)
		return cau_fail(error, CAU_BAD_VALUE, s->name, "%lld is not within %.0f to %.0f", value,
		                s->least, s->most);
	*(int64_t *)member = value;
	return CAU_OK;
}

static cau_status store_real(const setting *s, void *member, const char *text, cau_error *error)
{
	char *end;
	double value = strtod(text, &end);
	if (end == text || *end || !isfinite(value))
		return cau_fail(error, CAU_BAD_VALUE, s->name, "`%.60s` is not a number", text);
	if (value < s->least || value > s->most)
		return cau_fail(error, CAU_BAD_VALUE, s->name, "%g is not within %g to %g", value, s->least,
		                s->most);
	*(double *)member = value;
	return CAU_OK;
}

static cau_status store_switch(const setting *s, void *member, const char *text, cau_error *error)
{
	if (strcmp(text, "true") != 0 && strcmp(text, "false") != 0)
		return cau_fail(error, CAU_BAD_VALUE, s->name, "`%.60s` is neither true nor false", text);
	*(bool *)member = text[0] == 't';
	return CAU_OK;
}

cau_status cau_setting_store(const setting *s, cau_config *config, const char *text,
                             cau_error *error)
{
	void *member = (char *)config + s->offset;
	switch (s->kind) {
	case SETTING_TEXT:
		return store_text(s, member, text, error);
	case SETTING_INTEGER:
		return store_integer(s, member, text, error);
	case SETTING_REAL:
		return store_real(s, member, text, error);
	case SETTING_SWITCH:
		return store_switch(s, member, text, error);
	}
	return CAU_BAD_VALUE;
}

bool cau_setting_same(const setting *s, const cau_config *a, const cau_config *b)
{
	const char *in_a = (const char *)a + s->offset, *in_b = (const char *)b + s->offset;
	switch (s->kind) {
	case SETTING_TEXT:
		return strcmp(in_a, in_b) == 0;
	case SETTING_INTEGER:
		return *(const int64_t *)(const void *)in_a == *(const int64_t *)(const void *)in_b;
	case SETTING_REAL:
		return *(const double *)(const void *)in_a == *(const double *)(const void *)in_b;
	case SETTING_SWITCH:
		return *(const bool *)in_a == *(const bool *)in_b;
	}
	return false;
}
