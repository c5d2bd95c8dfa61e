// SPDX-License-Identifier: GPL-3.0-or-later
// Chooses the format by an Accept header, by the rules of RFC 9110, 12.5.1. If several ranges cover
// a type, the most specific range is used; its q is the type's weight.
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "metrics/exposition.h"

// How specifically a range names a type; a larger number is more specific.
enum { NOT_NAMED, ANY_TYPE, ANY_SUBTYPE, NAMED };

// A format that we can write, and its weight so far.
typedef struct offer {
	const char *type, *any_subtype, *version;
	int closeness;
	double q;
} offer;

typedef struct range {
	char type[64];
	char version[16]; // "": no version given
	double q;
} range;

static const char blanks[] = " \t";

// Copies the bytes before `end` without blanks and quotes around them. A text that does not fit is
// cut: it cannot be one of our types.
static void copy_trimmed(char *to, size_t capacity, const char *from, const char *end)
{
	from += strspn(from, blanks);
	while (end > from && strchr(blanks, end[-1]))
		end--;
	if (end - from >= 2 && from[0] == '"' && end[-1] == '"') {
		from++;
		end--;
	}
	size_t bytes = end > from ? (size_t)(end - from) : 0;
	bytes = bytes < capacity ? bytes : capacity - 1;
	memcpy(to, from, bytes);
	to[bytes] = 0;
}

// Returns a q: 0 to 1 with at most three digits after the point. Any other text counts as 0.
static double read_q(const char *text)
{
	size_t length = strlen(text);
	bool fits = length >= 1 && length <= 5 && strspn(text, "0123456789.") == length;
	char *end;
	double q = fits ? strtod(text, &end) : 0;
	return fits && !*end && q <= 1 ? q : 0;
}

static void read_parameter(range *read, const char *from, const char *end)
{
	char name[16], value[16];
	const char *equals = memchr(from, '=', (size_t)(end - from));
	if (!equals)
		return;
	copy_trimmed(name, sizeof name, from, equals);
	copy_trimmed(value, sizeof value, equals + 1, end);
	if (strcasecmp(name, "q") == 0)
		read->q = read_q(value);
	else if (strcasecmp(name, "version") == 0)
		snprintf(read->version, sizeof read->version, "%s", value);
}

// Reads one range, `type/subtype;parameter=value;...`, up to its comma. Returns the position behind
// it.
static const char *read_range(range *read, const char *text)
{
	const char *end = text + strcspn(text, ",");
	const char *at = text + strcspn(text, ",;");
	*read = (range){.q = 1};
	copy_trimmed(read->type, sizeof read->type, text, at);
	while (at < end) {
		const char *from = at + 1;
		at = from + strcspn(from, ",;");
		read_parameter(read, from, at);
	}
	return *end ? end + 1 : end;
}

static int closeness(const offer *offered, const range *asked)
{
	if (strcasecmp(asked->type, offered->type) == 0)
		return !*asked->version || strcmp(asked->version, offered->version) == 0 ? NAMED
		                                                                         : NOT_NAMED;
	if (strcasecmp(asked->type, offered->any_subtype) == 0)
		return ANY_SUBTYPE;
	return strcmp(asked->type, "*/*") == 0 ? ANY_TYPE : NOT_NAMED;
}

// Weighs a format by a range. The most specific range counts; among equally specific ones, the
// largest q.
static void weigh(offer *offered, const range *asked)
{
	int close = closeness(offered, asked);
	if (close == NOT_NAMED || close < offered->closeness)
		return;
	if (close > offered->closeness || asked->q > offered->q)
		offered->q = asked->q;
	offered->closeness = close;
}

cau_metrics_format cau_metrics_choose(const char *accept)
{
	offer text = {.type = "text/plain", .any_subtype = "text/*", .version = "0.0.4"};
	offer open = {
		.type = "application/openmetrics-text", .any_subtype = "application/*", .version = "1.0.0"};
	range asked;
	while (accept && *accept) {
		accept = read_range(&asked, accept);
		weigh(&text, &asked);
		weigh(&open, &asked);
	}
	// If both weights are equal, the format that is named more specifically is chosen; `*/*` alone
	// gives text.
	bool wanted = open.closeness > ANY_TYPE && open.q > 0;
	bool more = open.q > text.q || (open.q == text.q && open.closeness >= text.closeness);
	return wanted && more ? CAU_METRICS_OPEN : CAU_METRICS_TEXT;
}
