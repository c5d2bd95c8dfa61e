// SPDX-License-Identifier: GPL-3.0-or-later
// Metrics: histograms of durations, and the text formats that scrapers read.
#pragma once

#include <stdatomic.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

// ---- histograms ---------------------------------------------------------------------------------
// Counts durations in buckets, from any thread and without a lock:
//
//     static cau_histogram steps;
//     cau_histogram_note(&steps, 0.0013);
//     cau_metrics_histogram(out, format, &family, NULL, 0, &(cau_buckets){...});

// Upper ends of the buckets, s. They are close together around a tick of 60 Hz (16.7 ms) and around
// the intended duration of a step. A last bucket counts longer durations.
#define CAU_HISTOGRAM_BOUNDS_S                                                                     \
	{                                                                                              \
		0.0001, 0.00025, 0.0005, 0.001, 0.002, 0.004, 0.008, 0.012, 0.0166, 0.025, 0.05, 0.1,      \
			0.25, 0.5, 1, 5                                                                        \
	}
enum { CAU_HISTOGRAM_BOUNDS = 16 };
extern const double cau_histogram_bounds_s[CAU_HISTOGRAM_BOUNDS];

// A histogram; zeroed when nothing has been counted.
typedef struct cau_histogram {
	_Atomic uint64_t counts[CAU_HISTOGRAM_BOUNDS + 1]; // of each bucket alone, not cumulative
	_Atomic uint64_t sum_ns;
} cau_histogram;

// Counts a duration. A negative duration and NaN count as 0.
void cau_histogram_note(cau_histogram *histogram, double seconds);
// Reads the counts of each bucket alone, and the sum in seconds. A duration that is being counted
// may be in the sum and not yet in the counts, or the reverse.
void cau_histogram_read(const cau_histogram *histogram, uint64_t counts[CAU_HISTOGRAM_BOUNDS + 1],
                        double *sum_s);

// ---- text ---------------------------------------------------------------------------------------
// Writes metrics as text, in the two formats that scrapers read: Prometheus' own (0.0.4) and
// OpenMetrics 1.0.0. A family is described once, followed by all its samples, then the next family:
//
//     cau_metric_family steps = {"session_steps", CAU_METRIC_COUNTER, "", "Steps computed"};
//     cau_metrics_begin(out, format, &steps);
//     for each session: cau_metrics_sample(out, format, &steps, "session", id, value);
//     ... other families ...
//     cau_metrics_end(out, format);

typedef enum cau_metrics_format {
	CAU_METRICS_TEXT, // text/plain; version=0.0.4
	CAU_METRICS_OPEN, // application/openmetrics-text; version=1.0.0
} cau_metrics_format;

typedef enum cau_metric_type {
	CAU_METRIC_GAUGE,
	CAU_METRIC_COUNTER,   // samples are named NAME_total; no other family may have this name
	CAU_METRIC_HISTOGRAM, // samples are named NAME_bucket, NAME_sum and NAME_count
} cau_metric_type;

typedef struct cau_metric_family {
	const char *name; // [a-z0-9_]+, without the leading "cautery_" and without a counter's "_total"
	cau_metric_type type;
	const char *unit; // "seconds", "bytes": the name ends with _UNIT; "": no unit
	const char *help; // any text
} cau_metric_family;

// Chooses the format by a request's Accept header. NULL or an unreadable header gives
// CAU_METRICS_TEXT. OpenMetrics must be named, as itself or as application/*, and its weight must
// be at least that of text.
cau_metrics_format cau_metrics_choose(const char *accept);
const char *cau_metrics_content_type(cau_metrics_format format);

void cau_metrics_begin(FILE *out, cau_metrics_format format, const cau_metric_family *family);
// Writes a sample with one label, or with none if `label` is NULL. `text` is the label's value in
// UTF-8; quotes, backslashes and line ends are escaped.
void cau_metrics_sample(FILE *out, cau_metrics_format format, const cau_metric_family *family,
                        const char *label, const char *text, double value);

typedef struct cau_metric_label {
	const char *name, *text; // `text` in UTF-8
} cau_metric_label;

// Writes a sample with `count` labels, which must have different names.
void cau_metrics_sample_labelled(FILE *out, cau_metrics_format format,
                                 const cau_metric_family *family, const cau_metric_label *labels,
                                 size_t count, double value);

// The counts of a histogram.
typedef struct cau_buckets {
	const double *bounds; // upper ends of the buckets, ascending, (bound_count)
	size_t bound_count;
	// counts of each bucket alone, (bound_count + 1); the last one counts values above all bounds
	const uint64_t *counts;
	double sum;
} cau_buckets;

// Writes all samples of a histogram with `count` labels, at most CAU_METRIC_LABELS_MOST; no label
// may be named `le`.
enum { CAU_METRIC_LABELS_MOST = 4 };
void cau_metrics_histogram(FILE *out, cau_metrics_format format, const cau_metric_family *family,
                           const cau_metric_label *labels, size_t count,
                           const cau_buckets *buckets);
// Ends the text after the last family.
void cau_metrics_end(FILE *out, cau_metrics_format format);
