// SPDX-License-Identifier: GPL-3.0-or-later
// The command `events`: prints the session's past events and then the new ones.
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cautery/cli.h"

enum { EVENTS_MAX = 4096 }; // largest number of events in one answer

static void print_event_json(const cli *c, const cau_wire_timeline_event *e)
{
	char text[1024];
	cau_json_writer w;
	cau_json_begin(&w, text, sizeof text, 0);
	cau_json_open(&w, NULL, '{');
	cau_json_integer(&w, "tick", e->tick);
	cau_json_number(&w, "time_s", e->time_s);
	cau_json_string(&w, "kind", cli_event_word(e->kind));
	if (e->has_tool)
		cau_json_string(&w, "tool", e->tool);
	if (e->has_client)
		cau_json_string(&w, "client", e->client);
	if (e->has_count)
		cau_json_integer(&w, "count", e->count);
	if (e->has_detail)
		cau_json_string(&w, "detail", e->detail);
	cau_json_close(&w);
	if (!cau_json_end(&w, NULL, NULL))
		fprintf(c->out, "%s\n", text);
}

static void print_event(const cli *c, const cau_wire_timeline_event *e)
{
	fprintf(c->out, "%9lld %8.2f s  %-12s", (long long)e->tick, e->time_s, cli_event_word(e->kind));
	if (e->has_tool)
		fprintf(c->out, " %s", e->tool);
	if (e->has_client)
		fprintf(c->out, " by %s", e->client);
	if (e->has_count)
		fprintf(c->out, " %lld", (long long)e->count);
	if (e->has_detail)
		fprintf(c->out, " %s", e->detail);
	fputc('\n', c->out);
}

static void print_timeline(const cli *c, const cau_wire_timeline *timeline)
{
	const cau_wire_timeline_event *events = timeline->events.items;
	if (c->json) {
		cli_print_result(c, CAU_METHOD_SESSION_TIMELINE, timeline);
		return;
	}
	for (int32_t i = 0; i < timeline->events.count; i++)
		print_event(c, &events[i]);
	fprintf(c->out, "now at tick %lld of branch %lld; rewind reaches back to tick %lld\n",
	        (long long)timeline->tick, (long long)timeline->branch,
	        (long long)timeline->oldest_tick);
}

// ---- the command --------------------------------------------------------------------------------
typedef struct follower {
	cli *c;
	cau_wire_timeline timeline;
	bool answered; // the answer with the earlier events has come
	bool asks; // missed events were requested; the answer also has the events that happen meanwhile
	cau_error failure;
	int64_t last_tick; // tick of the last printed event
	int32_t at_last;   // number of printed events that have the tick `last_tick`
} follower;

static void note(follower *f, int64_t tick)
{
	f->at_last = tick == f->last_tick ? f->at_last + 1 : 1;
	f->last_tick = tick;
}

static void tell_event(follower *f, const cau_wire_timeline_event *event)
{
	if (f->c->json)
		print_event_json(f->c, event);
	else
		print_event(f->c, event);
	note(f, event->tick);
}

// Prints the events that happened while there was no connection.
static void tell_missed(follower *f, const cau_wire_timeline *timeline)
{
	const cau_wire_timeline_event *events = timeline->events.items;
	int64_t last = f->last_tick;
	int32_t told = f->at_last;
	for (int32_t i = 0; i < timeline->events.count; i++)
		if (events[i].tick > last || (events[i].tick == last && told-- <= 0))
			tell_event(f, &events[i]);
}

static void take_timeline(void *user, const cau_rpc_message *answer, const cau_error *error)
{
	follower *f = user;
	const cau_wire_timeline_event *events = f->timeline.events.items;
	f->answered = true;
	if (!answer) {
		f->failure = *error;
	} else if (!cau_rpc_result(answer, CAU_METHOD_SESSION_TIMELINE, &f->timeline, &f->failure)) {
		print_timeline(f->c, &f->timeline);
		for (int32_t i = 0; i < f->timeline.events.count; i++)
			note(f, events[i].tick);
	}
	fflush(f->c->out);
}

static void take_missed(void *user, const cau_rpc_message *answer, const cau_error *error)
{
	follower *f = user;
	(void)error; // The connection was lost again. The next connection repeats the request.
	f->asks = false;
	if (answer && !cau_rpc_result(answer, CAU_METHOD_SESSION_TIMELINE, &f->timeline, &f->failure))
		tell_missed(f, &f->timeline);
	fflush(f->c->out);
}

// Asks for missed events after a lost connection or after the session moved.
static void take_condition(void *user, cau_client *client, cau_client_condition condition)
{
	follower *f = user;
	cau_wire_session_timeline params = {
		.has_from_tick = true, .from_tick = f->last_tick, .has_count = true, .count = EVENTS_MAX};
	if (!f->answered || condition != CAU_CLIENT_READY)
		return;
	CLI_SESSION_PARAMS(f->c, &params);
	f->asks =
		!cau_client_send(client, CAU_METHOD_SESSION_TIMELINE, &params, take_missed, f, &f->failure);
}

static void take_notification(void *user, cau_client *client, const cau_rpc_message *message)
{
	follower *f = user;
	cau_wire_event_notice notice = {0};
	if (!f->answered || f->asks || message->method != CAU_METHOD_EVENT ||
	    cau_rpc_params(message, &notice, NULL) ||
	    strcmp(notice.session, cau_client_called(client, f->c->session)) != 0)
		return;
	tell_event(f, &notice.event);
	fflush(f->c->out);
}

// Joins the session, because only joined clients receive events. Asks for the lowest frame rate,
// because frames are not needed.
static cli_exit join(cli *c, cau_client_stream **stream)
{
	cau_wire_session_join join = {.has_rate_hz = true,
	                              .rate_hz = 0.1,
	                              .has_channels = true,
	                              .channels = CAU_CHANNEL_STATISTICS};
	CLI_SESSION_PARAMS(c, &join);
	return cau_client_join(c->client, &join, stream, &c->error) ? cli_fail(c) : CLI_DONE;
}

static cli_exit wait_for_end(follower *f, const cau_client_stream *stream, double until_s)
{
	cli *c = f->c;
	for (double now_s; !cli_interrupted() && (now_s = cau_client_now()) < until_s;) {
		if (cau_client_get_condition(c->client) == CAU_CLIENT_CLOSED) {
			c->error = *cau_client_trouble(c->client);
			return cli_fail(c);
		}
		if (stream && stream->ended) {
			cli_complain(c, "session %s no longer exists", c->session);
			return CLI_REFUSED;
		}
		if (f->answered && (f->failure.status || !stream))
			break;
		cau_loop_wait(c->loop, fmin(until_s - now_s, 0.25));
	}
	c->error = f->failure;
	if (!f->answered && !cli_interrupted())
		cau_fail(&c->error, CAU_IO, NULL, "no answer in %g s", c->timeout_s);
	return c->error.status ? cli_fail(c) : CLI_DONE;
}

static cli_exit tell(follower *f, cau_wire_session_timeline *params, double seconds)
{
	cli *c = f->c;
	cau_client_stream *stream = NULL;
	bool follow = cli_value(c, "follow");
	c->def.user = f;
	c->def.on_notification = take_notification;
	c->def.on_condition = take_condition;
	c->def.reconnect = follow;
	cli_watch_signals();
	cli_exit code = cli_connect(c);
	if (!code && follow)
		code = join(c, &stream);
	if (code)
		return code;
	CLI_SESSION_PARAMS(c, params);
	if (cau_client_send(c->client, CAU_METHOD_SESSION_TIMELINE, params, take_timeline, f,
	                    &c->error))
		return cli_fail(c);
	return wait_for_end(f, stream, cau_client_now() + (follow ? seconds : c->timeout_s));
}

static cli_exit run(cli *c)
{
	bool bad = false;
	follower f = {.c = c};
	cau_wire_session_timeline params = {.has_from_tick = true, .has_count = true};
	params.from_tick = (int64_t)cli_number(c, "from", 0, cli_tick_max, 0, &bad);
	params.count = (int64_t)cli_number(c, "count", 1, EVENTS_MAX, 1024, &bad);
	double seconds = cli_number(c, "seconds", 0.01, 1e9, 1e9, &bad);
	if (bad)
		return CLI_USAGE;
	f.timeline.events =
		(cau_wire_list){calloc(EVENTS_MAX, sizeof(cau_wire_timeline_event)), 0, EVENTS_MAX};
	cli_exit code = f.timeline.events.items ? tell(&f, &params, seconds) : cli_fail_memory(c);
	// Closes the connection first, because a later answer would be written into the freed list.
	if (c->client)
		cau_client_close(c->client);
	free(f.timeline.events.items);
	return code;
}

const cli_command cli_events = {
	.name = "events",
	.also = "timeline",
	.arguments = "[SESSION]",
	.summary = "lists cuts and other events of a session",
	.help = "With --json and --follow, the first line is the whole timeline. Each later line is "
			"one event.\n",
	.session_optional = true,
	.options = {{"from", "TICK", "first tick (default 0)"},
                {"count", "N", "largest number of events, newest first (default 1024)"},
                {"follow", NULL, "print new events until Ctrl-C"},
                {"seconds", "T", "how long to follow (default: until Ctrl-C)"}},
	.run = run};
