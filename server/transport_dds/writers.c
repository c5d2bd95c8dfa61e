// SPDX-License-Identifier: GPL-3.0-or-later
// Keeps one record for each writer that matches a reader of ours, as long as it matches. A record
// is not a client: it takes less memory than Cyclone's own record of the writer. Clients are
// limited by places.c.
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "config/config.h"
#include "transport_dds/internal.h"

enum { ONLOOKERS_TOLD_MOST = 16 }; // largest number of log lines a second

// Bounds on the deadline that a writer's QoS declares, s.
static const double deadline_least_s = 0.02, deadline_most_s = 1;

static double deadline_of(const cau_config *config, const dds_qos_t *qos)
{
	dds_duration_t deadline = DDS_INFINITY;
	if (!dds_qget_deadline(qos, &deadline) || deadline == DDS_INFINITY)
		return config->dds_deadline_s;
	return fmax(deadline_least_s, fmin(deadline_most_s, 1e-9 * (double)deadline));
}

static bool is_reliable(const dds_qos_t *qos)
{
	dds_reliability_kind_t kind = DDS_RELIABILITY_BEST_EFFORT;
	return dds_qget_reliability(qos, &kind, NULL) && kind == DDS_RELIABILITY_RELIABLE;
}

static void write_guid(char text[33], const dds_guid_t *guid)
{
	for (size_t i = 0; i < sizeof guid->v; i++)
		snprintf(text + 2 * i, 3, "%02x", guid->v[i]);
}

static cau_dds_writer **bucket_of(cau_dds_writers *writers, dds_entity_t reader,
                                  dds_instance_handle_t handle)
{
	uint64_t mixed = (handle ^ (uint64_t)(uint32_t)reader * 2654435761u) * 0x9e3779b97f4a7c15u;
	return &writers->buckets[mixed % WRITER_BUCKETS];
}

static cau_dds_writer *find_writer(cau_dds_writers *writers, dds_entity_t reader,
                                   dds_instance_handle_t handle)
{
	cau_dds_writer *writer = *bucket_of(writers, reader, handle);
	while (writer && (writer->reader != reader || writer->handle != handle))
		writer = writer->next;
	return writer;
}

// Fills the writer's asker, with the role of the name that its participant has proved.
static void describe_asker(const cau_dds *dds, cau_dds_writer *writer,
                           const dds_builtintopic_endpoint_t *endpoint)
{
	char guid[33];
	cau_asker *asker = &writer->asker;
	bool proved = cau_dds_identity_find(endpoint->participant_key.v, writer->subject);
	if (!proved)
		*writer->subject = 0;
	asker->role = cau_dds_roles_find(&dds->roles, proved ? writer->subject : NULL);
	asker->deadline_s = deadline_of(dds->config, endpoint->qos);
	write_guid(guid, writer->native ? &endpoint->key : &endpoint->participant_key);
	snprintf(asker->name, sizeof asker->name, "%s %.32s", writer->native ? "dds" : "ros", guid);
	snprintf(asker->client_id, sizeof asker->client_id, "dds-%s", guid);
}

// Logs a writer that may not drive. It never becomes a client, so no other log line names it.
static void tell_onlooker(cau_dds_writers *writers, const cau_dds_writer *writer)
{
	double now_s = cau_monotonic_s();
	if (now_s - writers->onlookers_told_s >= 1) {
		writers->onlookers_told_s = now_s;
		writers->onlookers_told = 0;
	}
	if (writers->onlookers_told++ < ONLOOKERS_TOLD_MOST)
		cau_log(CAU_LOG_INFO, NULL, "dds_client", "client=0 name=\"%s\" role=%s subject=\"%s\"",
		        writer->asker.name, cau_role_word(writer->asker.role), writer->subject);
}

static cau_dds_writer *add_writer(cau_dds *dds, const cau_door *door, dds_instance_handle_t handle)
{
	dds_builtintopic_endpoint_t *endpoint = dds_get_matched_publication_data(door->reader, handle);
	cau_dds_writer *made = endpoint ? calloc(1, sizeof *made) : NULL;
	if (made) {
		cau_dds_writer **bucket = bucket_of(&dds->writers, door->reader, handle);
		made->next = *bucket;
		made->reader = door->reader;
		made->handle = handle;
		made->native = door->kind == DOOR_NATIVE || door->kind == DOOR_SETTING ||
		               door->kind == DOOR_INSTRUMENT || door->kind == DOOR_REQUEST;
		made->reliable = is_reliable(endpoint->qos);
		made->participant = endpoint->participant_instance_handle;
		made->identity = made->native ? handle : made->participant;
		made->guid = endpoint->key;
		describe_asker(dds, made, endpoint);
		*bucket = made;
		if (made->asker.role < CAU_ROLE_OPERATE)
			tell_onlooker(&dds->writers, made);
	}
	if (endpoint)
		dds_builtintopic_free_endpoint(endpoint);
	return made;
}

cau_dds_writer *cau_dds_writer_of(cau_dds *dds, const cau_door *door, dds_instance_handle_t handle)
{
	cau_dds_writer *writer = find_writer(&dds->writers, door->reader, handle);
	if (!writer)
		writer = add_writer(dds, door, handle);
	if (writer && !writer->client)
		cau_dds_join_place(&dds->places, writer);
	return writer;
}

// ---- matched writers

// Returns the writers that the reader has matched, in order. The caller frees the array; NULL if
// there are none.
static dds_instance_handle_t *matched_of(dds_entity_t reader, size_t *count)
{
	dds_instance_handle_t *handles = NULL;
	dds_return_t there = dds_get_matched_publications(reader, NULL, 0);
	*count = 0;
	// The loop repeats if more writers have matched meanwhile.
	for (size_t room = 0; there > 0 && room < (size_t)there;) {
		room = (size_t)there;
		free(handles);
		handles = malloc(room * sizeof *handles);
		there = handles ? dds_get_matched_publications(reader, handles, room) : 0;
		*count = there > 0 && (size_t)there < room ? (size_t)there : there > 0 ? room : 0;
	}
	return handles;
}

static int by_handle(const void *a, const void *b)
{
	dds_instance_handle_t x = *(const dds_instance_handle_t *)a,
						  y = *(const dds_instance_handle_t *)b;
	return (x > y) - (x < y);
}

static bool is_meant(const dds_builtintopic_endpoint_t *writer, uint64_t participant,
                     const uint8_t guid[16])
{
	static const uint8_t nobody[16];
	bool any = memcmp(guid, nobody, sizeof nobody) == 0;
	return writer->participant_instance_handle == participant &&
	       (any || memcmp(writer->key.v, guid, sizeof writer->key.v) == 0);
}

cau_dds_writer *cau_dds_find_writer(cau_dds *dds, const cau_door *door, uint64_t participant,
                                    const uint8_t guid[16])
{
	size_t count;
	dds_instance_handle_t found = 0, *handles = matched_of(door->reader, &count);
	for (size_t i = 0; i < count && !found; i++) {
		dds_builtintopic_endpoint_t *writer =
			dds_get_matched_publication_data(door->reader, handles[i]);
		if (writer && is_meant(writer, participant, guid))
			found = handles[i];
		if (writer)
			dds_builtintopic_free_endpoint(writer);
	}
	free(handles);
	return found ? cau_dds_writer_of(dds, door, found) : NULL;
}

// ---- forgetting writers
static void drop_writer(cau_dds *dds, cau_dds_writer *writer)
{
	if (writer->reader == dds->control.door.reader)
		cau_dds_forget_replies(&dds->control, &writer->guid);
	cau_dds_leave_place(dds, writer);
	free(writer);
}

void cau_dds_prune(cau_dds *dds, dds_entity_t reader, bool all)
{
	size_t count = 0;
	dds_instance_handle_t *matched = all ? NULL : matched_of(reader, &count);
	if (count)
		qsort(matched, count, sizeof *matched, by_handle);
	for (int i = 0; i < WRITER_BUCKETS; i++)
		for (cau_dds_writer **link = &dds->writers.buckets[i]; *link;) {
			cau_dds_writer *writer = *link;
			bool stays =
				!all &&
				(writer->reader != reader ||
			     (count && bsearch(&writer->handle, matched, count, sizeof *matched, by_handle)));
			if (stays) {
				link = &writer->next;
			} else {
				*link = writer->next;
				drop_writer(dds, writer);
			}
		}
	free(matched);
}

// ---- liveliness
// Notes each writer that stops being alive, because the status reports only the last of several.
// Called on Cyclone's threads.
static void on_liveliness(dds_entity_t reader, const dds_liveliness_changed_status_t status,
                          void *user)
{
	cau_dds *dds = user;
	if (status.not_alive_count_change <= 0)
		return;
	cau_dds_silenced *noted = malloc(sizeof *noted);
	if (!noted)
		// The watchdog still turns the writer's energy off, at the driver's deadline.
		return;
	*noted = (cau_dds_silenced){.reader = reader, .handle = status.last_publication_handle};
	pthread_mutex_lock(&dds->mailbox.mutex);
	noted->next = dds->mailbox.silenced;
	dds->mailbox.silenced = noted;
	pthread_mutex_unlock(&dds->mailbox.mutex);
	cau_dds_wake(&dds->wakeup, &dds->wakeup.fell_silent);
}

dds_listener_t *cau_dds_listen_to_liveliness(cau_dds *dds)
{
	dds_listener_t *made = dds_create_listener(dds);
	dds_lset_liveliness_changed(made, on_liveliness);
	return made;
}

void cau_dds_end_silenced(cau_dds *dds)
{
	pthread_mutex_lock(&dds->mailbox.mutex);
	cau_dds_silenced *next, *first = dds->mailbox.silenced;
	dds->mailbox.silenced = NULL;
	pthread_mutex_unlock(&dds->mailbox.mutex);
	for (; first; first = next) {
		next = first->next;
		const cau_dds_writer *writer = find_writer(&dds->writers, first->reader, first->handle);
		if (writer && writer->client)
			cau_dds_give_up(writer->client);
		free(first);
	}
}
