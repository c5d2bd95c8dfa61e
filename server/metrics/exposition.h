// SPDX-License-Identifier: GPL-3.0-or-later
// Metrics as text, in the two formats that scrapers read: Prometheus' own (0.0.4) and OpenMetrics
// 1.0.0. A family is told once, then all its samples, then the next family:
//
//     cau_metric_family steps = {"session_steps", CAU_METRIC_COUNTER, "", "Steps computed"};
//     cau_metrics_begin(out, format, &steps);
//     for each session: cau_metrics_sample(out, format, &steps, "session", id, value);
//     ... other families ...
//     cau_metrics_end(out, format);
#pragma once

#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

typedef enum cau_metrics_format {
	CAU_METRICS_TEXT, // text/plain; version=0.0.4
	CAU_METRICS_OPEN, // application/openmetrics-text; version=1.0.0
} cau_metrics_format;

typedef enum cau_metric_type {
	CAU_METRIC_GAUGE,
	CAU_METRIC_COUNTER,   // samples are called NAME_total, which is no other family's name
	CAU_METRIC_HISTOGRAM, // samples are NAME_bucket, NAME_sum and NAME_count
} cau_metric_type;

typedef struct cau_metric_family {
	const char *name; // [a-z0-9_]+, without the leading "cautery_" and a counter's "_total"
	cau_metric_type type;
	const char *unit; // "seconds", "bytes": the name ends with _UNIT; "": it has none
	const char *help; // any text
} cau_metric_family;

// The format that a request's Accept header asks for; NULL or what cannot be read: text.
// OpenMetrics has to be named, by itself or as application/*, and not to be wanted less than text
// is.
cau_metrics_format cau_metrics_choose(const char *accept);
const char *cau_metrics_content_type(cau_metrics_format format);

void cau_metrics_begin(FILE *out, cau_metrics_format format, const cau_metric_family *family);
// `label` NULL: no label. `text` is the label's value in UTF-8; quotes, backslashes and line ends
// in it are escaped.
void cau_metrics_sample(FILE *out, cau_metrics_format format, const cau_metric_family *family,
                        const char *label, const char *text, double value);

typedef struct cau_metric_label {
	const char *name, *text; // `text` in UTF-8
} cau_metric_label;

// A sample with `count` labels, of different names.
void cau_metrics_sample_labelled(FILE *out, cau_metrics_format format,
                                 const cau_metric_family *family, const cau_metric_label *labels,
                                 size_t count, double value);

// What a histogram has counted.
typedef struct cau_buckets {
	const double *bounds; // upper ends, ascending, (bound_count)
	size_t bound_count;
	const uint64_t *counts; // of each bucket alone, (bound_count + 1): the last is what is beyond
	double sum;
} cau_buckets;

// All samples of a histogram with `count` labels, at most CAU_METRIC_LABELS_MOST, none named `le`.
enum { CAU_METRIC_LABELS_MOST = 4 };
void cau_metrics_histogram(FILE *out, cau_metrics_format format, const cau_metric_family *family,
                           const cau_metric_label *labels, size_t count,
                           const cau_buckets *buckets);
// After the last family.
void cau_metrics_end(FILE *out, cau_metrics_format format);
