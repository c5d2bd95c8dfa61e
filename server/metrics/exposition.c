// SPDX-License-Identifier: GPL-3.0-or-later
#include "metrics/exposition.h"

#include <math.h>

const char *cau_metrics_content_type(cau_metrics_format format)
{
	return format == CAU_METRICS_OPEN ? "application/openmetrics-text; version=1.0.0; charset=utf-8"
	                                  : "text/plain; version=0.0.4; charset=utf-8";
}

// The older format leaves quotes in help as they are, and knows no escape for them there.
static void write_escaped(FILE *out, const char *text, int quotes)
{
	for (; *text; text++)
		if (*text == '\n')
			fputs("\\n", out);
		else if (*text == '\\' || (*text == '"' && quotes))
			fprintf(out, "\\%c", *text);
		else
			fputc(*text, out);
}

// What stands in a family's own lines: OpenMetrics names a counter without its samples' ending.
static const char *family_ending(cau_metrics_format format, const cau_metric_family *family)
{
	return format == CAU_METRICS_TEXT && family->type == CAU_METRIC_COUNTER ? "_total" : "";
}

void cau_metrics_begin(FILE *out, cau_metrics_format format, const cau_metric_family *family)
{
	const char *ending = family_ending(format, family);
	const char *type = family->type == CAU_METRIC_COUNTER ? "counter" : "gauge";
	fprintf(out, "# TYPE cautery_%s%s %s\n", family->name, ending, type);
	if (format == CAU_METRICS_OPEN && *family->unit)
		fprintf(out, "# UNIT cautery_%s %s\n", family->name, family->unit);
	fprintf(out, "# HELP cautery_%s%s ", family->name, ending);
	write_escaped(out, family->help, format == CAU_METRICS_OPEN);
	fputc('\n', out);
}

// Both formats write infinities with a sign, and what is no number in this one way.
static void write_value(FILE *out, double value)
{
	if (isnan(value))
		fputs("NaN", out);
	else if (isinf(value))
		fputs(value > 0 ? "+Inf" : "-Inf", out);
	else
		fprintf(out, "%.17g", value);
}

void cau_metrics_sample(FILE *out, cau_metrics_format format, const cau_metric_family *family,
                        const char *label, const char *text, double value)
{
	(void)format; // samples are the same in both
	fprintf(out, "cautery_%s%s", family->name, family->type == CAU_METRIC_COUNTER ? "_total" : "");
	if (label) {
		fprintf(out, "{%s=\"", label);
		write_escaped(out, text, 1);
		fputs("\"}", out);
	}
	fputc(' ', out);
	write_value(out, value);
	fputc('\n', out);
}

void cau_metrics_end(FILE *out, cau_metrics_format format)
{
	if (format == CAU_METRICS_OPEN)
		fputs("# EOF\n", out);
}
