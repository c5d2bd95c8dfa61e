// SPDX-License-Identifier: GPL-3.0-or-later
// The command `record`: writes a stream to a file, unchanged or as MCAP.
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "cautery/cli.h"
#include "cautery/progress.h"
#include "cautery/recording.h"

static const double scene_s = 0.1; // interval between two messages of an MCAP file

typedef struct recorder {
	cli *c;
	cli_recording recording;
	uint64_t described; // number of the last connection whose stream description is in the file
	cau_status status;
	// only for MCAP
	bool scenes;
	cli_mcap mcap;
	uint64_t start_ns; // ns since 1970 at start_s
	double start_s;
	uint64_t due;  // number of the next message, in intervals of scene_s since the start
	uint64_t told; // stream->frames when the last message was written
	char *text;    // text of one message
	size_t text_bytes;
	FILE *text_stream; // writes to `text`
} recorder;

static void take_frame(void *user, cau_client *client, cau_client_stream *stream,
                       const cau_client_frame *frame)
{
	recorder *r = user;
	// A stream begins with a topology frame after each join.
	if (!r->status && frame->header.kind == CAU_FRAME_TOPOLOGY &&
	    r->described != cau_client_connections(client)) {
		r->described = cau_client_connections(client);
		r->status = cli_recording_describe(&r->recording, &stream->description, &r->c->error);
	}
	if (!r->status)
		r->status = cli_recording_frame(&r->recording, frame->received_s, frame->bytes,
		                                frame->byte_count, &r->c->error);
}

// ---- as MCAP -----------------------------------------------------------------------------------
static cau_status begin_scenes(recorder *r, const char *file, cau_error *error)
{
	struct timespec now;
	cau_status status = cli_mcap_create(&r->mcap, file, error);
	r->text_stream = status ? NULL : open_memstream(&r->text, &r->text_bytes);
	if (!status && !r->text_stream)
		status = cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for messages");
	clock_gettime(CLOCK_REALTIME, &now);
	r->start_ns = (uint64_t)now.tv_sec * 1000000000 + (uint64_t)now.tv_nsec;
	r->start_s = cau_client_now();
	return status;
}

static cau_status write_scene(recorder *r, const cau_client_stream *stream, uint64_t time_ns)
{
	rewind(r->text_stream);
	cau_status status = cli_scene_update_write(r->text_stream, stream, time_ns, &r->c->error);
	if (!status && fflush(r->text_stream))
		status = cau_fail(&r->c->error, CAU_NO_MEMORY, NULL, "no memory for a message");
	return status ? status
	              : cli_mcap_message(&r->mcap, time_ns, r->text, r->text_bytes, &r->c->error);
}

// Writes the newest state every tenth of a second if it has changed. A busy machine may miss some.
// Times are multiples of scene_s, so a time is wrong by at most scene_s.
static void take_scene(recorder *r, const cau_client_stream *stream)
{
	uint64_t now = (uint64_t)((cau_client_now() - r->start_s) / scene_s);
	if (r->status || now < r->due)
		return;
	r->due = now + 1;
	if (stream->frames == r->told || !stream->state->synced || !stream->has_topology)
		return;
	r->told = stream->frames;
	r->status = write_scene(r, stream, r->start_ns + (uint64_t)(1e9 * scene_s) * now);
}

static double until_scene_s(const recorder *r)
{
	double left_s = r->start_s + scene_s * (double)r->due - cau_client_now();
	return left_s > 0 ? left_s : 0;
}

static cau_status end_scenes(recorder *r, cau_error *error)
{
	if (r->text_stream)
		fclose(r->text_stream);
	free(r->text);
	return cli_mcap_close(&r->mcap, error);
}

static unsigned long long count_written(const recorder *r)
{
	return r->scenes ? r->mcap.messages : r->recording.frames;
}

static const char *written_word(const recorder *r)
{
	return r->scenes ? "messages" : "frames";
}

static uint64_t bytes_written(const recorder *r)
{
	return r->scenes ? r->mcap.bytes : r->recording.bytes;
}

// ---- the stream --------------------------------------------------------------------------------
// Records until the time is over, the user stops it, or the stream ends.
static cli_exit record_for(recorder *r, const cau_client_stream *stream, double seconds)
{
	cli *c = r->c;
	cli_progress progress;
	char note[96];
	double start_s = cau_client_now(), now_s;
	cli_progress_begin(&progress, c->complaints, "recording");
	while (!cli_interrupted() && !r->status && !stream->ended &&
	       (now_s = cau_client_now()) < start_s + seconds &&
	       cau_client_get_condition(c->client) != CAU_CLIENT_CLOSED) {
		double left_s = start_s + seconds - now_s;
		double wait_s = r->scenes ? until_scene_s(r) : 0.25;
		cau_loop_wait(c->loop, left_s < wait_s ? left_s : wait_s);
		if (r->scenes)
			take_scene(r, stream);
		snprintf(note, sizeof note, "%llu %s, %llu bytes", count_written(r), written_word(r),
		         (unsigned long long)bytes_written(r));
		cli_progress_show(&progress, (uint64_t)(1e3 * (cau_client_now() - start_s)),
		                  (uint64_t)(1e3 * seconds), note);
	}
	cli_progress_end(&progress);
	if (r->status)
		return cli_fail_file(c);
	if (cau_client_get_condition(c->client) == CAU_CLIENT_CLOSED) {
		c->error = *cau_client_trouble(c->client);
		return cli_fail(c);
	}
	if (stream->ended)
		cli_complain(c, "the session no longer exists");
	return stream->ended ? CLI_REFUSED : CLI_DONE;
}

static void print_end(const recorder *r, const cau_client_stream *stream, const char *file)
{
	const cli *c = r->c;
	unsigned long long bytes = bytes_written(r), tick = stream->state->tick;
	if (c->json)
		fprintf(c->out, "{\"%s\": %llu, \"bytes\": %llu, \"last_tick\": %llu, \"gaps\": %llu}\n",
		        written_word(r), count_written(r), bytes, tick, (unsigned long long)stream->gaps);
	else
		fprintf(c->out, "%s: %llu %s to tick %llu, %llu bytes\n", file, count_written(r),
		        written_word(r), tick, bytes);
}

static cau_status begin_file(recorder *r, const char *file)
{
	cau_error *error = &r->c->error;
	return r->scenes ? begin_scenes(r, file, error)
	                 : cli_recording_create(&r->recording, file, error);
}

static cau_status end_file(recorder *r)
{
	cau_error *error = &r->c->error;
	return r->scenes ? end_scenes(r, error) : cli_recording_close(&r->recording, error);
}

static cli_exit run(cli *c)
{
	recorder r = {.c = c, .scenes = cli_value(c, "mcap") != NULL};
	cau_client_stream *stream = NULL;
	bool bad = false;
	double seconds = cli_number(c, "seconds", 0.1, 86400, 10, &bad);
	double rate_hz = cli_number(c, "rate", 0.1, 1000, 60, &bad);
	cau_wire_session_join join = {.has_rate_hz = true, .rate_hz = rate_hz, .has_channels = true};
	join.channels = CAU_CHANNELS_BY_DEFAULT | CAU_CHANNEL_STATISTICS;
	if (bad)
		return CLI_USAGE;
	const char *file = c->arguments[c->argument_count - 1];
	c->def.reconnect = true;
	c->def.on_frame = r.scenes ? NULL : take_frame;
	c->def.user = &r;
	cli_watch_signals();
	cli_exit code = cli_connect(c);
	if (code)
		return code;
	if (begin_file(&r, file)) {
		end_file(&r);
		return cli_fail_file(c);
	}
	c->error.file[0] = 0;
	CLI_SESSION_PARAMS(c, &join);
	code = cau_client_join(c->client, &join, &stream, &c->error) ? cli_fail(c) : CLI_DONE;
	if (!code)
		code = record_for(&r, stream, seconds);
	if (end_file(&r) && !code)
		code = cli_fail_file(c);
	if (!code)
		print_end(&r, stream, file);
	return code;
}

const cli_command cli_record = {
	.name = "record",
	.arguments = "[SESSION] FILE",
	.summary = "writes the stream of frames to a file",
	.help = "`cautery watch --recording FILE` decodes it again. Ctrl-C ends it early.\n"
			"--mcap writes an MCAP file instead, for Foxglove and others: foxglove.SceneUpdate in\n"
			"JSON on the topic /scene, ten times a second where something new was seen.\n",
	.least = 1,
	.most = 1,
	.session_optional = true,
	.options = {{"seconds", "T", "time to record, s (default 10)"},
                {"rate", "HZ", "frames in a second (default 60)"},
                {"mcap", NULL, "write MCAP: the scene ten times a second"}},
	.run = run};
