// SPDX-License-Identifier: GPL-3.0-or-later
#include <ctype.h>
#include <stdlib.h>
#include <string.h>

#include "trace/fields.h"

static cau_status no_meaning(cau_error *error, const char *at)
{
	return cau_fail(error, CAU_BAD_SYNTAX, "", "'%.60s' is not valid here", at);
}

// ---- one value: each function moves *at behind the value; it returns false if there is none

static void store_whole(const field *f, void *at, uint64_t value)
{
	if (f->bytes == sizeof(uint32_t))
		memcpy(at, &(uint32_t){(uint32_t)value}, sizeof(uint32_t));
	else
		memcpy(at, &value, sizeof value);
}

static bool read_whole(const field *f, const char **at, void *to)
{
	char *end;
	uint64_t value = **at == '-' ? (uint64_t)strtoll(*at, &end, 10) : strtoull(*at, &end, 10);
	bool any = end != *at;
	store_whole(f, to, value);
	*at = end;
	return any;
}

static bool read_real(const char **at, void *to)
{
	char *end;
	double value = strtod(*at, &end);
	bool any = end != *at;
	memcpy(to, &value, sizeof value);
	*at = end;
	return any;
}

static bool read_choice(const field *f, const char **at, void *to)
{
	size_t length = strcspn(*at, " ");
	for (int32_t i = 0; i < f->word_count; i++) {
		if (strlen(f->words[i]) != length || strncmp(f->words[i], *at, length) != 0)
			continue;
		memcpy(to, &(int){i}, sizeof(int));
		*at += length;
		return true;
	}
	return false;
}

static int nibble(char c)
{
	return isdigit((unsigned char)c) ? c - '0' : c >= 'a' && c <= 'f' ? c - 'a' + 10 : -1;
}

// Reads the rest of an escape after its backslash. Returns the character, or -1.
static int read_escaped(const char **at)
{
	char c = *(*at)++;
	if (c == '"' || c == '\\')
		return c;
	if (c != 'x' || nibble((*at)[0]) < 0 || nibble((*at)[1]) < 0)
		return -1;
	int value = 16 * nibble((*at)[0]) + nibble((*at)[1]);
	*at += 2;
	return value;
}

static bool read_text(const field *f, const char **at, char *to)
{
	if (*(*at)++ != '"')
		return false;
	for (size_t used = 0; used < f->bytes; used++) {
		if (**at == '"') {
			to[used] = 0;
			(*at)++;
			return true;
		}
		int c = (unsigned char)*(*at)++;
		if (c == '\\')
			c = read_escaped(at);
		if (c <= 0)
			return false;
		to[used] = (char)c;
	}
	return false;
}

static bool read_value(const field *f, const char **at, void *to)
{
	switch (f->kind) {
	case FIELD_UNSIGNED:
	case FIELD_SIGNED:
		return read_whole(f, at, to);
	case FIELD_REAL:
		return read_real(at, to);
	case FIELD_TRUTH:
		memcpy(to, &(bool){true}, sizeof(bool));
		return *(*at)++ == '1';
	case FIELD_CHOICE:
		return read_choice(f, at, to);
	case FIELD_TEXT:
		return read_text(f, at, to);
	}
	return false;
}

// ---- a line -------------------------------------------------------------------------------------

static const field *find(const char *name, size_t length)
{
	for (int32_t i = 0; i < cau_trace_call_fields.count; i++) {
		const field *f = &cau_trace_call_fields.fields[i];
		if (strlen(f->name) == length && strncmp(f->name, name, length) == 0)
			return f;
	}
	return NULL;
}

cau_status cau_trace_read(const char *line, cau_trace_call *call, cau_error *error)
{
	size_t length = strcspn(line, " ");
	const char *at = line + length;
	*call = (cau_trace_call){.what = CAU_TRACE_WHAT_COUNT};
	for (int i = 0; i < CAU_TRACE_WHAT_COUNT; i++)
		if (strlen(cau_trace_what_words[i]) == length &&
		    strncmp(cau_trace_what_words[i], line, length) == 0)
			call->what = (cau_trace_what)i;
	if (call->what == CAU_TRACE_WHAT_COUNT)
		return no_meaning(error, line);
	while (*at == ' ') {
		const char *name = ++at;
		at += strcspn(at, "= ");
		const field *f = find(name, (size_t)(at - name));
		if (!f || *at++ != '=' || !read_value(f, &at, (char *)call + f->offset))
			return no_meaning(error, name);
	}
	if (*at || call->tool_count < 0 || call->tool_count > CAU_MAX_TOOLS || call->capacity < 0)
		return no_meaning(error, *at ? at : line);
	return CAU_OK;
}
