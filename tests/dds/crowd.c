// SPDX-License-Identifier: GPL-3.0-or-later
// Many writers of cautery/tool_command in one participant, for the tests.
//
//     crowd DOMAIN SESSION COUNT LEASE_MS TOOL...
//
// Writer i is for tool i modulo the number of tools. Lines on standard input:
//     write good|bad|off   each writer writes 20 times a second: commands in order, or with NaN
// It writes events as JSON objects, one a line, to standard output: matched (all writers), written
// (each writer has written once more).
#include <dds/dds.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cautery.h"
#include "console.h"
#include "link.h"

#define PERIOD_S 0.05
#define HEIGHT_M 0.03

enum { WRITERS_MOST = 1024 };

typedef struct crowd {
	const char *session;
	char **tools;
	int count, tool_count;
	dds_entity_t writers[WRITERS_MOST];
	uint64_t sequence;
	bool writing, bad, matched;
} crowd;

static void open_writers(crowd *c, dds_entity_t participant, int lease_ms)
{
	dds_entity_t publisher = publisher_of(participant, c->session);
	dds_qos_t *qos = reliable_qos(1);
	dds_qset_liveliness(qos, DDS_LIVELINESS_MANUAL_BY_TOPIC, DDS_MSECS(lease_ms));
	dds_qset_deadline(qos, DDS_MSECS(lease_ms));
	for (int i = 0; i < c->count; i++)
		c->writers[i] =
			native_writer(publisher, &cautery_ToolCommand_desc, "cautery/tool_command", qos);
	dds_delete_qos(qos);
}

static void write_round(crowd *c)
{
	c->sequence++;
	for (int i = 0; i < c->count; i++) {
		cautery_ToolCommand sample = {.sequence_number = c->sequence,
		                              .source_time_ns = (int64_t)(1e9 * clock_s(CLOCK_REALTIME)),
		                              .position_m = {0, 0, c->bad ? NAN : HEIGHT_M},
		                              .rotation = {1},
		                              .jaw = 1};
		snprintf(sample.session, sizeof sample.session, "%s", c->session);
		snprintf(sample.tool, sizeof sample.tool, "%s", c->tools[i % c->tool_count]);
		dds_return_t code = dds_write(c->writers[i], &sample);
		if (code != DDS_RETCODE_TIMEOUT) // a timeout means that the daemon is busy
			checked(code);
	}
	printf("{\"event\":\"written\"}\n");
}

static void look_for_daemon(crowd *c)
{
	for (int i = 0; i < c->count; i++) {
		dds_publication_matched_status_t status = {0};
		checked(dds_get_publication_matched_status(c->writers[i], &status));
		if (status.current_count == 0)
			return;
	}
	c->matched = true;
	printf("{\"event\":\"matched\"}\n");
}

static void obey(void *user, const char *line)
{
	crowd *c = user;
	if (strncmp(line, "write ", 6) != 0)
		return;
	c->writing = strcmp(line, "write off") != 0;
	c->bad = strcmp(line, "write bad") == 0;
}

int main(int argument_count, char **arguments)
{
	console input = {.kept_bytes = 0};
	if (argument_count < 6 || atoi(arguments[3]) > WRITERS_MOST) {
		fprintf(stderr, "usage: crowd DOMAIN SESSION COUNT LEASE_MS TOOL...\n");
		return 2;
	}
	crowd c = {.session = arguments[2],
	           .count = atoi(arguments[3]),
	           .tools = arguments + 5,
	           .tool_count = argument_count - 5};
	setvbuf(stdout, NULL, _IOLBF, 0);
	dds_entity_t participant =
		checked(dds_create_participant((uint32_t)atoi(arguments[1]), NULL, NULL));
	open_writers(&c, participant, atoi(arguments[4]));
	double next_s = clock_s(CLOCK_MONOTONIC);
	while (console_listen(&input, next_s - clock_s(CLOCK_MONOTONIC), obey, &c)) {
		if (clock_s(CLOCK_MONOTONIC) < next_s)
			continue;
		next_s += PERIOD_S;
		if (!c.matched)
			look_for_daemon(&c);
		else if (c.writing)
			write_round(&c);
	}
	dds_delete(participant);
	return 0;
}
