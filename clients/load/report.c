// SPDX-License-Identifier: GPL-3.0-or-later
// Lists of measured values with their percentiles, and the report of a run.
#include "load/load.h"

#include <math.h>
#include <stdlib.h>

#include "cautery/json_writer.h"

// ---- measured values ---------------------------------------------------------------------------
void load_samples_add(load_samples *samples, double value)
{
	if (samples->count == samples->capacity) {
		size_t capacity = samples->capacity ? 2 * samples->capacity : 4096;
		float *grown =
			capacity <= LOAD_SAMPLES_MAX ? realloc(samples->value, capacity * sizeof *grown) : NULL;
		if (!grown) {
			samples->lost++;
			return;
		}
		samples->value = grown;
		samples->capacity = capacity;
	}
	samples->value[samples->count++] = (float)value;
}

static int ascending(const void *a, const void *b)
{
	float x = *(const float *)a, y = *(const float *)b;
	return (x > y) - (x < y);
}

double load_samples_percentile(load_samples *samples, double share)
{
	if (!samples->count)
		return NAN;
	qsort(samples->value, samples->count, sizeof *samples->value, ascending);
	size_t rank = (size_t)ceil(share * (double)samples->count);
	return (double)samples->value[rank ? rank - 1 : 0];
}

void load_samples_finish(load_samples *samples)
{
	free(samples->value);
	*samples = (load_samples){0};
}

// ---- report ------------------------------------------------------------------------------------
// Longest silence of a session's frames, s, that the realtime factor leaves out. A longer silence
// counts as wall time.
static const double silence_s = 0.25;

double load_realtime_factor(const load_session *session, double end_s)
{
	if (!session->has_first)
		return 0;
	double until_s = session->last.published_s;
	if (end_s - until_s > silence_s)
		until_s = end_s;
	double wall_s = until_s - session->first.published_s;
	return wall_s > 0 ? (session->last.time_s - session->first.time_s) / wall_s : 0;
}

static int32_t slow_count(const load_options *options)
{
	int32_t others = options->sessions * (options->viewers - 1);
	return (int32_t)ceil(options->slow_pct / 100.0 * others);
}

static double per_vertex(const load_fleet *fleet, double bytes)
{
	return fleet->moved > 0 ? bytes / fleet->moved : NAN;
}

void load_report_text(FILE *out, load_fleet *fleet, const load_result *r)
{
	const load_options *o = fleet->options;
	fprintf(out, "%d sessions of %s, %d viewers each (%d slow), %.1f s\n", o->sessions, o->scene,
	        o->viewers, slow_count(o), r->window_s);
	fprintf(
		out,
		"realtime factor, worst session  %.4f (steal %.2f %%, this program %.0f %% of a core)\n",
		r->realtime_factor_min, r->steal_pct, r->load_cpu_pct);
	fprintf(out, "time from frame to client, ms   p50 %.2f  p99 %.2f  max %.2f (clock +-%.3f)\n",
	        load_samples_percentile(&fleet->frame_ms, 0.5),
	        load_samples_percentile(&fleet->frame_ms, 0.99),
	        load_samples_percentile(&fleet->frame_ms, 1), 1e3 * fleet->clock.error_s);
	fprintf(out, "time from command to frame, ms  p50 %.2f  p99 %.2f  max %.2f\n",
	        load_samples_percentile(&fleet->command_ms, 0.5),
	        load_samples_percentile(&fleet->command_ms, 0.99),
	        load_samples_percentile(&fleet->command_ms, 1));
	fprintf(out, "bytes per moved vertex          %.3f (whole frames %.3f)\n",
	        per_vertex(fleet, fleet->position_bytes), per_vertex(fleet, fleet->delta_bytes));
	fprintf(out, "frames                          %.0f a second, %.3f MB a second\n",
	        (double)fleet->frames / r->window_s, 1e-6 * (double)fleet->bytes / r->window_s);
	fprintf(out, "decode errors %llu, gaps %llu, unrecovered %llu, refused %llu\n",
	        (unsigned long long)fleet->decode_errors, (unsigned long long)fleet->gaps,
	        (unsigned long long)fleet->gaps_unrecovered, (unsigned long long)fleet->refused);
	fprintf(out, "acknowledged requests lost      %lld of %lld\n", (long long)r->lost_acknowledged,
	        (long long)r->acknowledged);
	fprintf(out, "daemon memory for each viewer   %.0f KiB\n", r->rss_per_viewer / 1024);
}

// Writes null for an unknown value, because JSON has no NAN.
static void write_number(cau_json_writer *w, const char *key, double value)
{
	if (isfinite(value))
		cau_json_number(w, key, value);
	else
		cau_json_null(w, key);
}

static void write_samples(cau_json_writer *w, const char *key, load_samples *samples)
{
	cau_json_open(w, key, '{');
	write_number(w, "p50", load_samples_percentile(samples, 0.5));
	write_number(w, "p99", load_samples_percentile(samples, 0.99));
	write_number(w, "max", load_samples_percentile(samples, 1));
	cau_json_unsigned(w, "count", samples->count);
	cau_json_close(w);
}

static void write_counts(cau_json_writer *w, const load_fleet *fleet, const load_result *r)
{
	cau_json_unsigned(w, "decode_errors", fleet->decode_errors);
	cau_json_unsigned(w, "gaps", fleet->gaps);
	cau_json_unsigned(w, "gaps_unrecovered", fleet->gaps_unrecovered);
	write_number(w, "lost_acknowledged",
	             r->lost_acknowledged < 0 ? NAN : (double)r->lost_acknowledged);
	cau_json_integer(w, "acknowledged", r->acknowledged);
	cau_json_unsigned(w, "commands", fleet->commands);
	cau_json_unsigned(w, "refused", fleet->refused);
	cau_json_unsigned(w, "frames", fleet->frames);
	cau_json_unsigned(w, "bytes", fleet->bytes);
}

void load_report_json(FILE *out, load_fleet *fleet, const load_result *r)
{
	char text[4096];
	cau_json_writer w;
	const load_options *o = fleet->options;
	cau_json_begin(&w, text, sizeof text, 0);
	cau_json_open(&w, NULL, '{');
	cau_json_string(&w, "scene", o->scene);
	cau_json_integer(&w, "sessions", o->sessions);
	cau_json_integer(&w, "viewers", o->viewers);
	cau_json_integer(&w, "slow", slow_count(o));
	write_number(&w, "seconds", r->window_s);
	write_number(&w, "realtime_factor_min", r->realtime_factor_min);
	write_number(&w, "steal_pct", r->steal_pct);
	write_samples(&w, "frame_ms", &fleet->frame_ms);
	write_samples(&w, "command_ms", &fleet->command_ms);
	write_number(&w, "bytes_per_vertex", per_vertex(fleet, fleet->position_bytes));
	write_number(&w, "frame_bytes_per_vertex", per_vertex(fleet, fleet->delta_bytes));
	write_counts(&w, fleet, r);
	write_number(&w, "rss_per_viewer", r->rss_per_viewer);
	write_number(&w, "rss_before", r->rss_before);
	write_number(&w, "rss_after", r->rss_after);
	write_number(&w, "clock_error_ms", 1e3 * fleet->clock.error_s);
	write_number(&w, "load_cpu_pct", r->load_cpu_pct);
	cau_json_close(&w);
	if (!cau_json_end(&w, NULL, NULL))
		fprintf(out, "%s\n", text);
}
