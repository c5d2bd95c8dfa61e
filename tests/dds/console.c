// SPDX-License-Identifier: GPL-3.0-or-later
#include "console.h"

#include <math.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

double clock_s(clockid_t clock)
{
	struct timespec now;
	clock_gettime(clock, &now);
	return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

// Takes whole lines from standard input; false at its end.
static bool take_lines(console *c, void (*obey)(void *user, const char *line), void *user)
{
	ssize_t got = read(STDIN_FILENO, c->kept + c->kept_bytes, LINE_BYTES - 1 - c->kept_bytes);
	if (got <= 0)
		return false;
	c->kept_bytes += (size_t)got;
	c->kept[c->kept_bytes] = 0;
	for (char *end; (end = strchr(c->kept, '\n'));) {
		*end = 0;
		obey(user, c->kept);
		c->kept_bytes -= (size_t)(end + 1 - c->kept);
		memmove(c->kept, end + 1, c->kept_bytes + 1);
	}
	return c->kept_bytes < LINE_BYTES - 1;
}

bool console_listen(console *c, double seconds, void (*obey)(void *user, const char *line),
                    void *user)
{
	struct pollfd input = {.fd = STDIN_FILENO, .events = POLLIN};
	struct timespec patience = {0, (long)(1e9 * fmin(fmax(seconds, 0), 0.5))};
	return ppoll(&input, 1, &patience, NULL) <= 0 || take_lines(c, obey, user);
}

dds_entity_t checked(dds_entity_t entity)
{
	if (entity < 0) {
		fprintf(stderr, "%s\n", dds_strretcode(entity));
		exit(1);
	}
	return entity;
}

dds_entity_t native_reader(dds_entity_t subscriber, const dds_topic_descriptor_t *type,
                           const char *topic, dds_durability_kind_t durability, int kept)
{
	dds_qos_t *qos = dds_create_qos();
	dds_qset_reliability(qos, DDS_RELIABILITY_RELIABLE, DDS_MSECS(100));
	dds_qset_durability(qos, durability);
	dds_qset_history(qos, DDS_HISTORY_KEEP_LAST, kept);
	dds_entity_t participant = checked(dds_get_participant(subscriber));
	dds_entity_t made = checked(dds_create_topic(participant, type, topic, NULL, NULL));
	made = checked(dds_create_reader(subscriber, made, qos, NULL));
	dds_delete_qos(qos);
	return made;
}

dds_entity_t subscriber_of(dds_entity_t participant, const char *partition)
{
	dds_qos_t *qos = dds_create_qos();
	dds_qset_partition1(qos, partition);
	dds_entity_t made = checked(dds_create_subscriber(participant, qos, NULL));
	dds_delete_qos(qos);
	return made;
}

dds_entity_t publisher_of(dds_entity_t participant, const char *partition)
{
	dds_qos_t *qos = dds_create_qos();
	dds_qset_partition1(qos, partition);
	dds_entity_t made = checked(dds_create_publisher(participant, qos, NULL));
	dds_delete_qos(qos);
	return made;
}
