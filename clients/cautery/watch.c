// SPDX-License-Identifier: GPL-3.0-or-later
// The command `watch`: prints the state of a session as text, live or from a recording.
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "cautery/cli.h"
#include "cautery/progress.h"
#include "cautery/recording.h"

// The data that one line of text shows.
typedef struct view {
	const cau_stream_state *state;
	const cli_faces *faces;
} view;

static double length(const double vector[3])
{
	return sqrt(vector[0] * vector[0] + vector[1] * vector[1] + vector[2] * vector[2]);
}

static void write_tool_line(FILE *out, const cau_stream_tool *tool)
{
	fprintf(out, "  %s %s%s %.0f degC %.2f N", tool->name, tool->energized ? "on" : "off",
	        tool->frozen ? " (watchdog)" : "", tool->tip_temperature_c, length(tool->force_n));
	if (tool->delivered_w > 0)
		fprintf(out, "  %.1f W", tool->delivered_w);
	if (tool->load_ohm > 0)
		fprintf(out, "  %.0f ohm", tool->load_ohm);
	if (tool->grasping && !tool->grasped_vertices)
		fprintf(out, "  jaws empty");
	else if (tool->grasping)
		fprintf(out, "  holds %d points%s, jaws %.0f %% open, %.1f N", tool->grasped_vertices,
		        tool->slipping ? ", slipping" : "", 100 * tool->jaw, tool->jaw_force_n);
}

// Writes the newest state as one line, without a line end.
static void write_line(FILE *out, const view *v)
{
	const cau_stream_state *s = v->state;
	fprintf(out,
	        "tick %llu  %.2f s  rate %.3f  moved %d vertices  gone %lld faces  parted %u edges  "
	        "removed %u elements  drawn %lld faces",
	        (unsigned long long)s->tick, s->time_s, (double)s->statistics.realtime_factor,
	        s->moved_count, (long long)v->faces->gone, s->statistics.edges_parted,
	        s->statistics.elements_removed, (long long)v->faces->drawn);
	if (s->statistics.elements_torn)
		fprintf(out, "  torn %u elements", s->statistics.elements_torn);
	for (int32_t i = 0; i < s->tool_count; i++)
		write_tool_line(out, &s->tools[i]);
	fprintf(out, "%s%s", s->flags & CAU_FRAME_PAUSED ? "  paused" : "",
	        s->flags & CAU_FRAME_FAULTED ? "  FAULTED" : "");
}

static void print_text(const cli *c, const view *v, bool terminal)
{
	char *line = NULL;
	size_t bytes = 0;
	FILE *out = open_memstream(&line, &bytes);
	if (!out)
		return;
	write_line(out, v);
	if (fclose(out) == 0) {
		if (terminal)
			cli_refresh_line(c->out, line);
		else
			fprintf(c->out, "%s\n", line);
		fflush(c->out);
	}
	free(line);
}

static void write_tool(cau_json_writer *writer, const cau_stream_tool *tool)
{
	cau_json_open(writer, NULL, '{');
	cau_json_string(writer, "tool", tool->name);
	cau_json_bool(writer, "energized", tool->energized);
	cau_json_string(writer, "energy_off", cli_energy_off_word(tool->energy_off));
	cau_json_bool(writer, "grasping", tool->grasping);
	cau_json_bool(writer, "slipping", tool->slipping);
	cau_json_unsigned(writer, "points_held", tool->grasped_vertices);
	cau_json_number(writer, "jaw", tool->jaw);
	cau_json_number(writer, "asked_jaw", tool->asked_jaw);
	cau_json_number(writer, "jaw_force_n", tool->jaw_force_n);
	cau_json_unsigned(writer, "driver", tool->driver);
	cau_json_unsigned(writer, "sequence", tool->sequence);
	cau_json_numbers(writer, "position_m", tool->pose.position_m, 3);
	cau_json_numbers(writer, "asked_m", tool->asked_pose.position_m, 3);
	cau_json_numbers(writer, "force_n", tool->force_n, 3);
	if (tool->has_raw_force) {
		cau_json_numbers(writer, "raw_force_n", tool->raw_force_n, 3);
		cau_json_number(writer, "force_filter_s", tool->force_filter_s);
	}
	cau_json_number(writer, "tip_temperature_c", tool->tip_temperature_c);
	cau_json_number(writer, "delivered_w", tool->delivered_w);
	cau_json_number(writer, "load_ohm", tool->load_ohm);
	cau_json_close(writer);
}

static void print_json(const cli *c, const view *v)
{
	char text[8192];
	cau_json_writer w;
	const cau_stream_state *s = v->state;
	cau_json_begin(&w, text, sizeof text, 0);
	cau_json_open(&w, NULL, '{');
	cau_json_unsigned(&w, "tick", s->tick);
	cau_json_number(&w, "time_s", s->time_s);
	cau_json_number(&w, "realtime_factor", (double)s->statistics.realtime_factor);
	cau_json_integer(&w, "vertices_moved", s->moved_count);
	cau_json_integer(&w, "faces_drawn", v->faces->drawn);
	cau_json_integer(&w, "faces_gone", v->faces->gone);
	cau_json_integer(&w, "faces_bared", v->faces->bared);
	cau_json_unsigned(&w, "edges_parted", s->statistics.edges_parted);
	cau_json_unsigned(&w, "elements_removed", s->statistics.elements_removed);
	cau_json_unsigned(&w, "elements_torn", s->statistics.elements_torn);
	cau_json_unsigned(&w, "touching_cut_short", s->statistics.touching_cut_short);
	cau_json_bool(&w, "paused", s->flags & CAU_FRAME_PAUSED);
	cau_json_bool(&w, "faulted", s->flags & CAU_FRAME_FAULTED);
	cau_json_open(&w, "tools", '[');
	for (int32_t i = 0; i < s->tool_count; i++)
		write_tool(&w, &s->tools[i]);
	cau_json_close(&w);
	cau_json_close(&w);
	if (!cau_json_end(&w, NULL, NULL))
		fprintf(c->out, "%s\n", text);
	fflush(c->out);
}

static void print(const cli *c, const cau_stream_state *state, cli_faces *faces, int32_t face_count,
                  bool terminal)
{
	view v = {state, faces};
	cli_faces_count(faces, state, face_count);
	if (c->json)
		print_json(c, &v);
	else
		print_text(c, &v, terminal);
}

// ---- live --------------------------------------------------------------------------------------
static cli_exit show_stream(cli *c, const cau_client_stream *stream, double seconds, double rate_hz)
{
	bool terminal = !c->json && isatty(fileno(c->out)), lost = false;
	cli_faces faces = {0};
	double start_s = cau_client_now(), due_s = start_s, now_s;
	while (!cli_interrupted() && (now_s = cau_client_now()) < start_s + seconds && !stream->ended) {
		cau_client_condition condition = cau_client_get_condition(c->client);
		if (condition == CAU_CLIENT_CLOSED)
			break;
		if ((condition == CAU_CLIENT_LOST) != lost) {
			lost = !lost;
			cli_complain(c, lost ? "the connection is lost; trying again" : "connected again");
		}
		if (now_s >= due_s && stream->state->synced) {
			print(c, stream->state, &faces, stream->def.face_count, terminal);
			due_s = fmax(due_s + 1.0 / rate_hz, now_s);
		}
		double wait_s = fmin(start_s + seconds, due_s) - now_s;
		cau_loop_wait(c->loop, fmin(fmax(wait_s, 0.001), 0.25));
	}
	if (stream->state->synced)
		print(c, stream->state, &faces, stream->def.face_count, terminal);
	cli_faces_finish(&faces);
	if (terminal)
		fputc('\n', c->out);
	if (cau_client_get_condition(c->client) == CAU_CLIENT_CLOSED) {
		c->error = *cau_client_trouble(c->client);
		return cli_fail(c);
	}
	if (stream->ended)
		cli_complain(c, "session %s no longer exists", c->session);
	return stream->ended ? CLI_REFUSED : CLI_DONE;
}

static cli_exit watch_live(cli *c, double seconds, double rate_hz)
{
	cau_client_stream *stream = NULL;
	cau_wire_session_join join = {
		.has_rate_hz = true,
		.rate_hz = rate_hz,
		.has_channels = true,
		.channels =
			CAU_CHANNEL_POSITIONS | CAU_CHANNEL_MASK | CAU_CHANNEL_TOOLS | CAU_CHANNEL_STATISTICS,
	};
	c->def.reconnect = true;
	cli_watch_signals();
	cli_exit code = cli_connect(c);
	CLI_SESSION_PARAMS(c, &join);
	if (!code)
		code = cau_client_join(c->client, &join, &stream, &c->error) ? cli_fail(c) : CLI_DONE;
	return code ? code : show_stream(c, stream, seconds, rate_hz);
}

// ---- from a recording --------------------------------------------------------------------------
typedef struct replay {
	void *storage;
	cau_frame_decoder *decoder;
	int32_t face_count;
	cli_faces faces;
	uint64_t frames, refused;
	double shown_s; // simulated time of the last printed line
} replay;

static cau_status start_replay(replay *r, const cau_wire_stream_description *d, cau_error *error)
{
	cau_stream_def def = cau_default_stream_def();
	def.session = (uint32_t)d->session_number;
	def.profile = (uint16_t)d->profile;
	def.channels = d->channels;
	def.vertex_count = (int32_t)d->vertex_count;
	def.face_count = (int32_t)d->face_count;
	memcpy(def.origin_m, d->origin_m, sizeof def.origin_m);
	def.step_m = d->step_m;
	def.stress_step_pa = d->stress_step_pa;
	free(r->storage);
	r->decoder = NULL;
	r->face_count = def.face_count;
	r->storage = malloc(cau_frame_decoder_bytes(&def));
	if (!r->storage)
		return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for the stream");
	return cau_frame_decoder_init(r->storage, cau_frame_decoder_bytes(&def), &def, &r->decoder,
	                              error);
}

static void replay_frame(cli *c, replay *r, const void *bytes, uint32_t byte_count, double step_s)
{
	cau_frame_header header;
	if (!r->decoder || cau_frame_header_read(bytes, byte_count, &header, NULL)) {
		r->refused++;
		return;
	}
	if (header.kind == CAU_FRAME_TOPOLOGY)
		return;
	if (cau_frame_decode(r->decoder, bytes, byte_count, NULL)) {
		r->refused++;
		return;
	}
	const cau_stream_state *state = cau_frame_decoder_state(r->decoder);
	r->frames++;
	if (r->frames > 1 && fabs(state->time_s - r->shown_s) < step_s)
		return;
	r->shown_s = state->time_s;
	print(c, state, &r->faces, r->face_count, false);
}

static cli_exit watch_recording(cli *c, const char *file, double rate_hz)
{
	replay r = {0};
	cli_recording recording;
	uint32_t kind = 1, bytes = 0;
	cau_wire_stream_description d = {0};
	cau_status status = cli_recording_open(&recording, file, &c->error);
	while (!status && kind) {
		status = cli_recording_next(&recording, &kind, &bytes, &c->error);
		if (!status && kind == CLI_RECORD_FRAME)
			replay_frame(c, &r, recording.buffer, bytes, 1.0 / rate_hz);
		if (!status && kind == CLI_RECORD_DESCRIPTION)
			status = cli_recording_read_description(&recording, bytes, &d, &c->error);
		if (!status && kind == CLI_RECORD_DESCRIPTION)
			status = start_replay(&r, &d, &c->error);
	}
	if (!status && r.decoder && r.frames)
		print(c, cau_frame_decoder_state(r.decoder), &r.faces, r.face_count, false);
	if (!status && r.refused)
		status = cau_fail(&c->error, CAU_CORRUPT, NULL, "%llu frames could not be decoded",
		                  (unsigned long long)r.refused);
	cli_recording_close(&recording, NULL);
	cli_faces_finish(&r.faces);
	free(r.storage);
	return status ? cli_fail_file(c) : CLI_DONE;
}

static cli_exit run(cli *c)
{
	bool bad = false;
	const char *recording = cli_value(c, "recording");
	bool terminal = isatty(fileno(c->out)) && !c->json;
	double seconds = cli_number(c, "seconds", 0.01, 1e9, 1e9, &bad);
	double rate_hz = cli_number(c, "rate", 0.1, 60, terminal ? 10 : 1, &bad);
	if (bad)
		return CLI_USAGE;
	return recording ? watch_recording(c, recording, rate_hz) : watch_live(c, seconds, rate_hz);
}

const cli_command cli_watch = {
	.name = "watch",
	.arguments = "[SESSION]",
	.summary =
		"shows the tick, rate, moved vertices, removed faces and parted edges of a live session",
	.help = "On a terminal it updates one line; elsewhere it prints lines. Ctrl-C ends it.\n"
			"moved: vertices in the newest frame; gone: faces that were drawn at the start and are "
			"not now;\n"
			"parted, removed: since creation.\n",
	.session_optional = true,
	.options = {{"seconds", "T", "time to watch, s (default: until Ctrl-C)"},
                {"rate", "HZ", "lines in a second (default: 10 on a terminal, else 1)"},
                {"recording", "FILE", "show a file of `cautery record` instead of a live session"}},
	.run = run};
