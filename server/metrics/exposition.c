// SPDX-License-Identifier: GPL-3.0-or-later
#include "metrics/exposition.h"

#include <inttypes.h>
#include <math.h>

#include "cautery/assert.h"

// ---- histograms ---------------------------------------------------------------------------------

const double cau_histogram_bounds_s[CAU_HISTOGRAM_BOUNDS] = CAU_HISTOGRAM_BOUNDS_S;

void cau_histogram_note(cau_histogram *histogram, double seconds)
{
	double known_s = seconds > 0 ? seconds : 0;
	int bucket = 0;
	while (bucket < CAU_HISTOGRAM_BOUNDS && known_s > cau_histogram_bounds_s[bucket])
		bucket++;
	atomic_fetch_add_explicit(&histogram->sum_ns, (uint64_t)(known_s * 1e9), memory_order_relaxed);
	atomic_fetch_add_explicit(&histogram->counts[bucket], 1, memory_order_relaxed);
}

void cau_histogram_read(const cau_histogram *histogram, uint64_t counts[CAU_HISTOGRAM_BOUNDS + 1],
                        double *sum_s)
{
	for (int i = 0; i <= CAU_HISTOGRAM_BOUNDS; i++)
		counts[i] = atomic_load_explicit(&histogram->counts[i], memory_order_relaxed);
	*sum_s = 1e-9 * (double)atomic_load_explicit(&histogram->sum_ns, memory_order_relaxed);
}

// ---- text ---------------------------------------------------------------------------------------

const char *cau_metrics_content_type(cau_metrics_format format)
{
	return format == CAU_METRICS_OPEN ? "application/openmetrics-text; version=1.0.0; charset=utf-8"
	                                  : "text/plain; version=0.0.4; charset=utf-8";
}

// Writes a text with escapes. The older format has no escape for quotes in help, and leaves them as
// they are.
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

// Returns the ending of the name in a family's own lines. OpenMetrics names a counter there without
// "_total", the ending of its samples.
static const char *family_ending(cau_metrics_format format, const cau_metric_family *family)
{
	return format == CAU_METRICS_TEXT && family->type == CAU_METRIC_COUNTER ? "_total" : "";
}

void cau_metrics_begin(FILE *out, cau_metrics_format format, const cau_metric_family *family)
{
	const char *ending = family_ending(format, family);
	static const char *const types[] = {[CAU_METRIC_GAUGE] = "gauge",
	                                    [CAU_METRIC_COUNTER] = "counter",
	                                    [CAU_METRIC_HISTOGRAM] = "histogram"};
	const char *type = types[family->type];
	fprintf(out, "# TYPE cautery_%s%s %s\n", family->name, ending, type);
	if (format == CAU_METRICS_OPEN && *family->unit)
		fprintf(out, "# UNIT cautery_%s %s\n", family->name, family->unit);
	fprintf(out, "# HELP cautery_%s%s ", family->name, ending);
	write_escaped(out, family->help, format == CAU_METRICS_OPEN);
	fputc('\n', out);
}

// Writes a value. Both formats write infinities with a sign, and NaN in this form only.
static void write_value(FILE *out, double value)
{
	if (isnan(value))
		fputs("NaN", out);
	else if (isinf(value))
		fputs(value > 0 ? "+Inf" : "-Inf", out);
	else
		fprintf(out, "%.17g", value);
}

static void write_name(FILE *out, const cau_metric_family *family, const char *ending,
                       const cau_metric_label *labels, size_t count)
{
	fprintf(out, "cautery_%s%s", family->name, ending);
	for (size_t i = 0; i < count; i++) {
		fprintf(out, "%s%s=\"", i ? "," : "{", labels[i].name);
		write_escaped(out, labels[i].text, 1);
		fputc('"', out);
	}
	fputs(count ? "} " : " ", out);
}

void cau_metrics_sample_labelled(FILE *out, cau_metrics_format format,
                                 const cau_metric_family *family, const cau_metric_label *labels,
                                 size_t count, double value)
{
	(void)format; // samples are the same in both formats
	write_name(out, family, family->type == CAU_METRIC_COUNTER ? "_total" : "", labels, count);
	write_value(out, value);
	fputc('\n', out);
}

void cau_metrics_sample(FILE *out, cau_metrics_format format, const cau_metric_family *family,
                        const char *label, const char *text, double value)
{
	cau_metrics_sample_labelled(out, format, family, &(cau_metric_label){label, text},
	                            label != NULL, value);
}

void cau_metrics_histogram(FILE *out, cau_metrics_format format, const cau_metric_family *family,
                           const cau_metric_label *labels, size_t count, const cau_buckets *buckets)
{
	char bound[32] = "+Inf";
	uint64_t below = 0;
	cau_metric_label all[CAU_METRIC_LABELS_MOST + 1];
	CAU_ASSERT(count <= CAU_METRIC_LABELS_MOST, "%zu labels of %s", count, family->name);
	(void)format; // samples are the same in both formats
	for (size_t i = 0; i < count; i++)
		all[i] = labels[i];
	all[count] = (cau_metric_label){"le", bound};
	for (size_t i = 0; i <= buckets->bound_count; i++) {
		below += buckets->counts[i];
		if (i < buckets->bound_count)
			snprintf(bound, sizeof bound, "%g", buckets->bounds[i]);
		else
			snprintf(bound, sizeof bound, "+Inf");
		write_name(out, family, "_bucket", all, count + 1);
		fprintf(out, "%" PRIu64 "\n", below);
	}
	write_name(out, family, "_sum", labels, count);
	write_value(out, buckets->sum);
	fputc('\n', out);
	write_name(out, family, "_count", labels, count);
	fprintf(out, "%" PRIu64 "\n", below);
}

void cau_metrics_end(FILE *out, cau_metrics_format format)
{
	if (format == CAU_METRICS_OPEN)
		fputs("# EOF\n", out);
}
