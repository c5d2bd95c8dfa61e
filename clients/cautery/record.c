// SPDX-License-Identifier: GPL-3.0-or-later
// record: a stream into a file.
#include <stdlib.h>
#include <string.h>

#include "cautery/commands.h"
#include "cautery/progress.h"
#include "cautery/recording.h"

typedef struct recorder {
	cli *c;
	cli_recording recording;
	uint64_t described; // connections whose stream is described in the file
	cau_status status;
} recorder;

static void take_frame(void *user, cau_client *client, cau_client_stream *stream,
                       const cau_client_frame *frame)
{
	recorder *r = user;
	// A topology starts a stream, after joining and after joining again.
	if (!r->status && frame->header.kind == CAU_FRAME_TOPOLOGY &&
	    r->described != cau_client_connections(client)) {
		r->described = cau_client_connections(client);
		r->status = cli_recording_describe(&r->recording, &stream->description, &r->c->error);
	}
	if (!r->status)
		r->status = cli_recording_frame(&r->recording, frame->received_s, frame->bytes,
		                                frame->byte_count, &r->c->error);
}

// Until the time is over, somebody says stop, or there is nothing left to record.
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
		cau_loop_wait(c->loop, left_s < 0.25 ? left_s : 0.25);
		snprintf(note, sizeof note, "%llu frames, %llu bytes",
		         (unsigned long long)r->recording.frames, (unsigned long long)r->recording.bytes);
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
		cli_complain(c, "the session is gone");
	return stream->ended ? CLI_REFUSED : CLI_DONE;
}

static void print_end(const recorder *r, const cau_client_stream *stream, const char *file)
{
	const cli *c = r->c;
	if (c->json)
		fprintf(c->out,
		        "{\"frames\": %llu, \"bytes\": %llu, \"last_tick\": %llu, \"gaps\": %llu}\n",
		        (unsigned long long)r->recording.frames, (unsigned long long)r->recording.bytes,
		        (unsigned long long)stream->state->tick, (unsigned long long)stream->gaps);
	else
		fprintf(c->out, "%s: %llu frames to tick %llu, %llu bytes\n", file,
		        (unsigned long long)r->recording.frames, (unsigned long long)stream->state->tick,
		        (unsigned long long)r->recording.bytes);
}

static cli_exit run(cli *c)
{
	recorder r = {.c = c};
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
	c->def.on_frame = take_frame;
	c->def.user = &r;
	cli_watch_signals();
	cli_exit code = cli_connect(c);
	if (code)
		return code;
	if (cli_recording_create(&r.recording, file, &c->error))
		return cli_fail_file(c);
	c->error.file[0] = 0;
	CLI_SESSION_PARAMS(c, &join);
	code = cau_client_join(c->client, &join, &stream, &c->error) ? cli_fail(c) : CLI_DONE;
	if (!code)
		code = record_for(&r, stream, seconds);
	if (cli_recording_close(&r.recording, &c->error) && !code)
		code = cli_fail_file(c);
	if (!code)
		print_end(&r, stream, file);
	return code;
}

const cli_command cli_record = {
	.name = "record",
	.arguments = "[SESSION] FILE",
	.summary = "writes the stream of frames to a file",
	.help = "`cautery watch --recording FILE` decodes it again. Ctrl-C ends it early.\n",
	.least = 1,
	.most = 1,
	.session_optional = true,
	.options = {{"seconds", "T", "how long (default 10)"},
                {"rate", "HZ", "frames a second (default 60)"}},
	.run = run};
