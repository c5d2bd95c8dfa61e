// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/run.h"

#include <inttypes.h>

#include "cautery/json_writer.h"

enum { LINE_BYTES = 4096 };

static double steps_per_s(const sim_result *result)
{
	return result->wall_s > 0.0 ? (double)result->ticks / result->wall_s : 0.0;
}

void sim_report_text(FILE *out, const cau_scene_def *scene, const sim_options *options,
                     const sim_result *result)
{
	fprintf(out, "scene %s, %" PRIu64 " ticks, %.3f s, %d threads, %s\n", scene->name,
	        result->ticks, result->time_s, options->threads, result->instruction_set);
	fprintf(out, "edges parted %d, elements removed %d, inverted %d, refusals %d\n",
	        result->statistics.edges_parted, result->statistics.elements_removed,
	        result->statistics.inverted, result->refusals);
	if (result->first_part_s >= 0.0)
		fprintf(out, "first edge parted at %.3f s, %.3f s after energy came on\n",
		        result->first_part_s, result->first_part_s - result->energized_s);
	if (result->snapshot_bytes > 0)
		fprintf(out, "snapshot of %zu bytes, restored %s\n", result->snapshot_bytes,
		        result->snapshot_exact ? "bit for bit" : "not bit-exactly");
	fprintf(out, "%.1f steps/s\n", steps_per_s(result));
	fprintf(out, "hash %016" PRIx64 "\n", result->hash);
}

static void write_time(cau_json_writer *writer, const char *key, double time_s)
{
	if (time_s >= 0.0)
		cau_json_number(writer, key, time_s);
	else
		cau_json_null(writer, key);
}

static void write_result(cau_json_writer *writer, const sim_result *result)
{
	char hash[17];
	snprintf(hash, sizeof hash, "%016" PRIx64, result->hash);
	cau_json_string(writer, "hash", hash);
	cau_json_unsigned(writer, "ticks", result->ticks);
	cau_json_number(writer, "time_s", result->time_s);
	cau_json_number(writer, "steps_per_s", steps_per_s(result));
	cau_json_integer(writer, "commands", result->commands);
	cau_json_integer(writer, "refusals", result->refusals);
	cau_json_integer(writer, "edges_parted", result->statistics.edges_parted);
	cau_json_integer(writer, "elements_removed", result->statistics.elements_removed);
	cau_json_integer(writer, "inverted", result->statistics.inverted);
	cau_json_integer(writer, "frozen_vertices", result->statistics.frozen_vertices);
	cau_json_integer(writer, "refactorisations", result->statistics.refactorisations);
	cau_json_number(writer, "deferred_max_s", result->statistics.deferred_max_s);
	cau_json_number(writer, "kinetic_j", result->kinetic_j);
	write_time(writer, "energized_s", result->energized_s);
	write_time(writer, "first_part_s", result->first_part_s);
	cau_json_unsigned(writer, "snapshot_bytes", result->snapshot_bytes);
	cau_json_bool(writer, "resting", result->statistics.resting);
	cau_json_bool(writer, "snapshot_exact", result->snapshot_exact);
}

static void write_error(cau_json_writer *writer, const cau_error *error)
{
	cau_json_open(writer, "error", '{');
	cau_json_string(writer, "status", cau_status_name(error->status));
	cau_json_string(writer, "file", error->file);
	cau_json_string(writer, "path", error->path);
	cau_json_string(writer, "reason", error->reason);
	cau_json_close(writer);
}

// Ends the line. If it cannot be written (a file name is not UTF-8), writes a line with that error
// instead.
static void end_line(cau_json_writer *writer, FILE *out)
{
	cau_error trouble;
	if (cau_json_end(writer, NULL, &trouble))
		fprintf(out, "{\"error\":{\"status\":\"%s\"}}\n", cau_status_name(trouble.status));
	else
		fprintf(out, "%s\n", writer->buffer);
}

void sim_report_json(FILE *out, const cau_scene_def *scene, const sim_options *options,
                     const sim_result *result, const cau_error *error)
{
	char line[LINE_BYTES];
	cau_json_writer writer;
	cau_json_begin(&writer, line, sizeof line, 0);
	cau_json_open(&writer, NULL, '{');
	cau_json_string(&writer, "scene", scene->name);
	cau_json_integer(&writer, "threads", options->threads);
	cau_json_string(&writer, "instruction_set", result->instruction_set);
	write_result(&writer, result);
	if (error)
		write_error(&writer, error);
	cau_json_close(&writer);
	end_line(&writer, out);
}

void sim_report_json_error(FILE *out, const cau_error *error)
{
	char line[LINE_BYTES];
	cau_json_writer writer;
	cau_json_begin(&writer, line, sizeof line, 0);
	cau_json_open(&writer, NULL, '{');
	write_error(&writer, error);
	cau_json_close(&writer);
	end_line(&writer, out);
}

void sim_report_error(FILE *out, const cau_error *error)
{
	fprintf(out, "cautery-sim: %s%s%s%s%s\n", error->file, error->file[0] ? ": " : "", error->path,
	        error->path[0] ? ": " : "", error->reason);
}
