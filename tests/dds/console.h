// SPDX-License-Identifier: GPL-3.0-or-later
// What the test's programs have in common: they are told by lines on standard input and tell, one
// JSON object a line, on standard output.
#pragma once

#include <dds/dds.h>
#include <stdbool.h>
#include <stddef.h>
#include <time.h>

enum { LINE_BYTES = 512, NAME_BYTES = 49 };

typedef struct console {
	char kept[LINE_BYTES];
	size_t kept_bytes;
} console;

// Waits for standard input for at most `seconds`, then hands each whole line to `obey`. False at
// the input's end.
bool console_listen(console *c, double seconds, void (*obey)(void *user, const char *line),
                    void *user);

double clock_s(clockid_t clock);
// The entity, or the program's end with the reason on standard error.
dds_entity_t checked(dds_entity_t entity);
// A reader or writer of a native topic: reliable, the newest `kept` of an instance.
dds_entity_t native_reader(dds_entity_t subscriber, const dds_topic_descriptor_t *type,
                           const char *topic, dds_durability_kind_t durability, int kept);
// A subscriber or publisher of one partition.
dds_entity_t subscriber_of(dds_entity_t participant, const char *partition);
dds_entity_t publisher_of(dds_entity_t participant, const char *partition);
