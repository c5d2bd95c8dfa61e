// SPDX-License-Identifier: GPL-3.0-or-later
#include "link.h"

#include <stdio.h>
#include <unistd.h>

enum { TAKEN_MOST = 32 };

void give_up(const char *reason)
{
	fprintf(stderr, "%s\n", reason);
	fflush(NULL);
	_exit(1);
}

dds_entity_t checked(dds_entity_t entity)
{
	if (entity < 0)
		give_up(dds_strretcode(entity));
	return entity;
}

static dds_entity_t of_partition(dds_entity_t participant, const char *partition,
                                 dds_entity_t (*create)(dds_entity_t, const dds_qos_t *,
                                                        const dds_listener_t *))
{
	dds_qos_t *qos = dds_create_qos();
	dds_qset_partition1(qos, partition);
	dds_entity_t made = checked(create(participant, qos, NULL));
	dds_delete_qos(qos);
	return made;
}

dds_entity_t subscriber_of(dds_entity_t participant, const char *partition)
{
	return of_partition(participant, partition, dds_create_subscriber);
}

dds_entity_t publisher_of(dds_entity_t participant, const char *partition)
{
	return of_partition(participant, partition, dds_create_publisher);
}

dds_qos_t *reliable_qos(int kept)
{
	dds_qos_t *qos = dds_create_qos();
	dds_qset_reliability(qos, DDS_RELIABILITY_RELIABLE, DDS_MSECS(100));
	dds_qset_history(qos, DDS_HISTORY_KEEP_LAST, kept);
	return qos;
}

static dds_entity_t native_topic(dds_entity_t end, const dds_topic_descriptor_t *type,
                                 const char *topic)
{
	dds_entity_t participant = checked(dds_get_participant(end));
	return checked(dds_create_topic(participant, type, topic, NULL, NULL));
}

dds_entity_t native_reader(dds_entity_t subscriber, const dds_topic_descriptor_t *type,
                           const char *topic, dds_durability_kind_t durability, int kept)
{
	dds_qos_t *qos = reliable_qos(kept);
	dds_qset_durability(qos, durability);
	dds_entity_t made =
		checked(dds_create_reader(subscriber, native_topic(subscriber, type, topic), qos, NULL));
	dds_delete_qos(qos);
	return made;
}

dds_entity_t native_writer(dds_entity_t publisher, const dds_topic_descriptor_t *type,
                           const char *topic, const dds_qos_t *qos)
{
	return checked(dds_create_writer(publisher, native_topic(publisher, type, topic), qos, NULL));
}

void take_each(dds_entity_t reader, void (*take)(void *user, const void *sample), void *user)
{
	void *samples[TAKEN_MOST] = {NULL};
	dds_sample_info_t infos[TAKEN_MOST];
	int count = dds_take(reader, samples, infos, TAKEN_MOST, TAKEN_MOST);
	for (int i = 0; i < count; i++)
		if (infos[i].valid_data)
			take(user, samples[i]);
	if (count > 0)
		dds_return_loan(reader, samples, count);
}
