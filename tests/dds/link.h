// SPDX-License-Identifier: GPL-3.0-or-later
// DDS functions of the test programs, with plain Cyclone DDS entities.
#pragma once

#include <dds/dds.h>

enum { NAME_BYTES = 49 };

// Ends the program with the reason on standard error. Exit handlers do not run, because OpenSSL's
// handler frees memory that Cyclone's threads still use.
__attribute__((noreturn)) void give_up(const char *reason);
// Returns the entity. Ends the program if the entity is an error code.
dds_entity_t checked(dds_entity_t entity);
// Creates a subscriber or publisher for one partition.
dds_entity_t subscriber_of(dds_entity_t participant, const char *partition);
dds_entity_t publisher_of(dds_entity_t participant, const char *partition);
// Returns reliable QoS that keeps the newest `kept` samples of an instance. The caller deletes it.
dds_qos_t *reliable_qos(int kept);
// Creates a reader or writer of a native topic.
dds_entity_t native_reader(dds_entity_t subscriber, const dds_topic_descriptor_t *type,
                           const char *topic, dds_durability_kind_t durability, int kept);
dds_entity_t native_writer(dds_entity_t publisher, const dds_topic_descriptor_t *type,
                           const char *topic, const dds_qos_t *qos);
// Takes the waiting samples in batches and passes each valid sample to `take`.
void take_each(dds_entity_t reader, void (*take)(void *user, const void *sample), void *user);
