// SPDX-License-Identifier: GPL-3.0-or-later
// Which of the two formats an Accept header asks for, by the rules of RFC 9110, 12.5.1: of the
// ranges that cover a type the most specific one counts, and its q says how much the type is
// wanted.
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "metrics/exposition.h"

// How closely a range names a type; the higher counts.
enum { NOT_NAMED, ANY_TYPE, ANY_SUBTYPE, NAMED };

// A type that we have, and how much it is wanted so far.
typedef struct offer {
	const char *type, *any_subtype, *version;
	int closeness;
	double q;
} offer;

typedef struct range {
	char type[64];
	char version[16]; // "": none given
	double q;
} range;

static const char blanks[] = " \t";

// Copies the bytes before `end` without blanks around them and, if so, without quotes. What does
// not fit is cut: it is no name that we know.
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

// A q is 0 to 1 with at most three digits after the point; anything else wants nothing.
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

// One range, `type/subtype;parameter=value;...`, up to its comma. Returns what is behind it.
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

// The closest range counts; of equally close ones the one that wants the type most.
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
	// Wanted alike, the one that is named more closely: `*/*` alone is text, as ever.
	bool wanted = open.closeness > ANY_TYPE && open.q > 0;
	bool more = open.q > text.q || (open.q == text.q && open.closeness >= text.closeness);
	return wanted && more ? CAU_METRICS_OPEN : CAU_METRICS_TEXT;
}
