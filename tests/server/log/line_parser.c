// SPDX-License-Identifier: GPL-3.0-or-later
#include "line_parser.h"

#include <string.h>

typedef struct cursor {
	const unsigned char *at, *end;
} cursor;

static bool take(cursor *c, unsigned char byte)
{
	if (c->at == c->end || *c->at != byte)
		return false;
	c->at++;
	return true;
}

static bool put(line_field *field, unsigned char byte)
{
	if (field->value_bytes == sizeof field->value)
		return false;
	field->value[field->value_bytes++] = (char)byte;
	return true;
}

static bool parse_key(cursor *c, line_field *field)
{
	size_t length = 0;
	while (c->at < c->end && ((*c->at >= 'a' && *c->at <= 'z') || *c->at == '_'))
		if (length + 1 < sizeof field->key)
			field->key[length++] = (char)*c->at++;
		else
			return false;
	return length > 0 && take(c, '=');
}

static bool parse_bare(cursor *c, line_field *field)
{
	for (; c->at < c->end && *c->at != ' '; c->at++)
		if (*c->at <= 0x20 || *c->at >= 0x7f || *c->at == '"' || *c->at == '=' || *c->at == '\\' ||
		    !put(field, *c->at))
			return false;
	return field->value_bytes > 0;
}

static int hex_digit(unsigned char digit)
{
	static const char digits[] = "0123456789abcdef";
	const char *found = digit ? strchr(digits, digit) : NULL;
	return found ? (int)(found - digits) : -1;
}

static bool parse_escape(cursor *c, line_field *field)
{
	if (c->at == c->end)
		return false;
	int high, low;
	unsigned char kind = *c->at++;
	switch (kind) {
	case '"':
	case '\\':
		return put(field, kind);
	case 'n':
		return put(field, '\n');
	case 'r':
		return put(field, '\r');
	case 't':
		return put(field, '\t');
	case 'x':
		if (c->end - c->at < 2)
			return false;
		high = hex_digit(c->at[0]);
		low = hex_digit(c->at[1]);
		if (high < 0 || low < 0)
			return false;
		c->at += 2;
		return put(field, (unsigned char)(high << 4 | low));
	default:
		return false;
	}
}

// Reads a character that is not escaped between quotes: well-formed UTF-8, and no control
// character.
static bool parse_character(cursor *c, line_field *field)
{
	static const struct {
		unsigned least, most; // range of the code point
		unsigned char mask, mark;
		int more;
	} forms[] = {{0x20, 0x7e, 0x80, 0x00, 0},
	             {0xa0, 0x7ff, 0xe0, 0xc0, 1},
	             {0x800, 0xffff, 0xf0, 0xe0, 2},
	             {0x10000, 0x10ffff, 0xf8, 0xf0, 3}};
	for (size_t f = 0; f < sizeof forms / sizeof *forms; f++) {
		if ((*c->at & forms[f].mask) != forms[f].mark)
			continue;
		unsigned code = *c->at & (unsigned char)~forms[f].mask;
		bool good = put(field, *c->at++);
		for (int i = 0; i < forms[f].more && good; i++, c->at++) {
			good = c->at < c->end && (*c->at & 0xc0) == 0x80 && put(field, *c->at);
			code = good ? code << 6 | (*c->at & 0x3fu) : 0;
		}
		bool hides = (code >= 0xd800 && code <= 0xdfff) || code == 0x2028 || code == 0x2029;
		return good && !hides && code >= forms[f].least && code <= forms[f].most;
	}
	return false;
}

static bool parse_quoted(cursor *c, line_field *field)
{
	while (c->at < c->end && *c->at != '"')
		if (!(take(c, '\\') ? parse_escape(c, field) : parse_character(c, field)))
			return false;
	return take(c, '"');
}

bool line_parse(const char *text, size_t bytes, line_fields *fields)
{
	cursor c = {(const unsigned char *)text, (const unsigned char *)text + bytes};
	fields->count = 0;
	do {
		if (fields->count == LINE_FIELDS_MOST)
			return false;
		line_field *field = &fields->fields[fields->count++];
		memset(field, 0, sizeof *field);
		if (!parse_key(&c, field) ||
		    !(take(&c, '"') ? parse_quoted(&c, field) : parse_bare(&c, field)))
			return false;
	} while (take(&c, ' '));
	return c.at == c.end;
}
