// SPDX-License-Identifier: GPL-3.0-or-later
// Requests sessions over DDS, for the tests.
//
//     requester DOMAIN DAEMONS    prints matched when it has found this number of daemons
//
// Lines on standard input:
//     request NUMBER OPERATION [MEMBER=VALUE...]   OPERATION as in the IDL; members of text, tick,
//                                                  paused; driver=writer: the writer below
//     writer SESSION  opens a writer of cautery/tool_command there
//     move TOOL X Y Z writes one command with it
// It writes events as JSON objects, one a line, to standard output: matched, reply (only to its own
// requests).
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cautery.h"
#include "console.h"
#include "link.h"

#define PERIOD_S 0.01

enum { KEPT = 256 };
// longest wait for the daemons, s: enough for a sanitized daemon on a busy machine
enum { MATCH_PATIENCE_S = 60 };

typedef struct requester {
	dds_entity_t participant, writer, reader, command;
	dds_guid_t guid;
	char session[NAME_BYTES]; // session of the command writer
	uint64_t sequence;
	uint32_t daemons;
	bool matched;
} requester;

static const char *const operations[] = {"LIST",   "CREATE", "JOIN",   "DESTROY",  "PAUSE",
                                         "RESUME", "FORK",   "REWIND", "TAKE_OVER"};

static void set_member(const requester *r, cautery_SessionRequest *sample, const char *word)
{
	dds_guid_t guid;
	const struct {
		const char *name;
		char *text;
		size_t bytes;
	} texts[] = {{"session=", sample->session, sizeof sample->session},
	             {"name=", sample->name, sizeof sample->name},
	             {"scene=", sample->scene, sizeof sample->scene},
	             {"tool=", sample->tool, sizeof sample->tool},
	             {"client_id=", sample->client_id, sizeof sample->client_id}};
	for (size_t i = 0; i < sizeof texts / sizeof texts[0]; i++)
		if (strncmp(word, texts[i].name, strlen(texts[i].name)) == 0)
			snprintf(texts[i].text, texts[i].bytes, "%s", word + strlen(texts[i].name));
	if (sscanf(word, "tick=%lu", &sample->tick) == 1)
		sample->has_tick = true;
	if (strcmp(word, "paused=1") == 0)
		sample->paused = true;
	if (strcmp(word, "driver=writer") == 0 && !dds_get_guid(r->command, &guid))
		memcpy(sample->driver, guid.v, sizeof sample->driver);
}

static void request(requester *r, char *words)
{
	cautery_SessionRequest sample = {0};
	char *rest = NULL, *word = strtok_r(words, " ", &rest);
	sample.number = word ? strtoull(word, NULL, 10) : 0;
	word = strtok_r(NULL, " ", &rest);
	for (size_t i = 0; word && i < sizeof operations / sizeof operations[0]; i++)
		if (strcmp(word, operations[i]) == 0)
			sample.operation = (cautery_SessionOperation)i;
	while ((word = strtok_r(NULL, " ", &rest)))
		set_member(r, &sample, word);
	checked(dds_write(r->writer, &sample));
}

static void open_writer(requester *r, const char *session)
{
	dds_qos_t *qos = reliable_qos(1);
	snprintf(r->session, sizeof r->session, "%.48s", session);
	r->command = native_writer(publisher_of(r->participant, session), &cautery_ToolCommand_desc,
	                           "cautery/tool_command", qos);
	dds_delete_qos(qos);
	dds_publication_matched_status_t matched = {0};
	dds_entity_t match = checked(dds_create_waitset(r->participant));
	checked(dds_set_status_mask(r->command, DDS_PUBLICATION_MATCHED_STATUS));
	checked(dds_waitset_attach(match, r->command, 0));
	while (matched.current_count == 0) {
		if (checked(dds_waitset_wait(match, NULL, 0, DDS_SECS(MATCH_PATIENCE_S))) == 0)
			give_up("nobody matches the writer of commands");
		checked(dds_get_publication_matched_status(r->command, &matched));
	}
	dds_delete(match);
	printf("{\"event\":\"opened\"}\n");
}

static void move(requester *r, const char *line)
{
	cautery_ToolCommand sample = {.sequence_number = ++r->sequence,
	                              .source_time_ns = (int64_t)(1e9 * clock_s(CLOCK_REALTIME)),
	                              .rotation = {1},
	                              .jaw = 1};
	memcpy(sample.session, r->session, sizeof sample.session);
	if (sscanf(line, "%48s %lf %lf %lf", sample.tool, &sample.position_m[0], &sample.position_m[1],
	           &sample.position_m[2]) == 4)
		checked(dds_write(r->command, &sample));
}

static void obey(void *user, const char *line)
{
	char words[LINE_BYTES];
	snprintf(words, sizeof words, "%s", line);
	if (strncmp(words, "request ", 8) == 0)
		request(user, words + 8);
	else if (strncmp(words, "writer ", 7) == 0)
		open_writer(user, words + 7);
	else if (strncmp(words, "move ", 5) == 0)
		move(user, words + 5);
}

// Returns the text with quotes and backslashes replaced, for a JSON string of a test.
static const char *quoted(const char *text, char room[LINE_BYTES])
{
	snprintf(room, LINE_BYTES, "%s", text);
	for (char *at = room; *at; at++)
		if (*at == '"' || *at == '\\')
			*at = '\'';
	return room;
}

static void tell_reply(const cautery_SessionReply *reply)
{
	char reason[LINE_BYTES];
	printf("{\"event\":\"reply\",\"number\":%llu,\"operation\":\"%s\",\"code\":%d,"
	       "\"status\":\"%s\",\"path\":\"%s\",\"reason\":\"%s\",\"session\":\"%s\",\"tick\":%llu,"
	       "\"epoch\":\"%016llx\",\"driver\":%u,\"sessions\":[",
	       (unsigned long long)reply->number, operations[reply->operation], reply->code,
	       reply->status, reply->path, quoted(reply->reason, reason), reply->session,
	       (unsigned long long)reply->tick, (unsigned long long)reply->epoch, reply->driver);
	for (uint32_t i = 0; i < reply->sessions._length; i++) {
		const cautery_SessionStatus *s = &reply->sessions._buffer[i];
		printf("%s{\"session\":\"%s\",\"number\":%u,\"scene\":\"%s\",\"state\":%d,\"vertex_count\":"
		       "%u}",
		       i ? "," : "", s->session, s->session_number, s->scene, (int)s->state,
		       s->vertex_count);
	}
	printf("]}\n");
}

static void take_reply(void *user, const void *sample)
{
	const requester *r = user;
	const cautery_SessionReply *reply = sample;
	if (memcmp(reply->writer, r->guid.v, sizeof reply->writer) == 0)
		tell_reply(reply);
}

static void tell_matched(requester *r)
{
	dds_publication_matched_status_t out = {0};
	dds_subscription_matched_status_t in = {0};
	checked(dds_get_publication_matched_status(r->writer, &out));
	checked(dds_get_subscription_matched_status(r->reader, &in));
	r->matched = out.current_count >= r->daemons && in.current_count >= r->daemons;
	if (r->matched)
		printf("{\"event\":\"matched\"}\n");
}

int main(int argument_count, char **arguments)
{
	requester r = {0};
	console c = {.kept_bytes = 0};
	if (argument_count != 3) {
		fprintf(stderr, "usage: requester DOMAIN DAEMONS\n");
		return 2;
	}
	r.daemons = (uint32_t)atoi(arguments[2]);
	setvbuf(stdout, NULL, _IOLBF, 0);
	r.participant = checked(dds_create_participant((uint32_t)atoi(arguments[1]), NULL, NULL));
	r.reader = native_reader(subscriber_of(r.participant, "cautery"), &cautery_SessionReply_desc,
	                         "cautery/session_reply", DDS_DURABILITY_TRANSIENT_LOCAL, KEPT);
	dds_qos_t *qos = reliable_qos(KEPT);
	r.writer = native_writer(publisher_of(r.participant, "cautery"), &cautery_SessionRequest_desc,
	                         "cautery/session_request", qos);
	dds_delete_qos(qos);
	checked(dds_get_guid(r.writer, &r.guid));
	while (console_listen(&c, PERIOD_S, obey, &r)) {
		if (!r.matched)
			tell_matched(&r);
		take_each(r.reader, take_reply, &r);
	}
	dds_delete(r.participant);
	return 0;
}
