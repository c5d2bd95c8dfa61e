// SPDX-License-Identifier: GPL-3.0-or-later
// Who writes: publication handles become clients of the hub, and clients have hands on tools.
#include <math.h>
#include <string.h>

#include "config/role.h"
#include "transport_dds/internal.h"

// Bounds on a declared deadline, s.
static const double deadline_least_s = 0.02, deadline_most_s = 1;

static double deadline_of(const cau_dds *dds, const dds_qos_t *qos)
{
	dds_duration_t deadline = DDS_INFINITY;
	if (!dds_qget_deadline(qos, &deadline) || deadline == DDS_INFINITY)
		return dds->config->dds_deadline_s;
	return fmax(deadline_least_s, fmin(deadline_most_s, 1e-9 * (double)deadline));
}

static cau_dds_client *find_client(cau_dds *dds, uint64_t identity, bool native)
{
	for (int i = 0; i < CLIENTS_MOST; i++)
		if (dds->clients[i].identity == identity && dds->clients[i].native == native)
			return &dds->clients[i];
	return NULL;
}

static void write_guid(char text[33], const dds_guid_t *guid)
{
	for (size_t i = 0; i < sizeof guid->v; i++)
		snprintf(text + 2 * i, 3, "%02x", guid->v[i]);
}

// The role of a writer's participant, by the name that it has proved.
static cau_role role_of(const cau_dds *dds, const dds_builtintopic_endpoint_t *writer,
                        char subject[CAU_DDS_SUBJECT_BYTES])
{
	bool proved = cau_dds_identity_find(writer->participant_key.v, subject);
	if (!proved)
		*subject = 0;
	return cau_dds_roles_find(&dds->roles, proved ? subject : NULL);
}

static cau_dds_client *add_client(cau_dds *dds, uint64_t identity, bool native,
                                  const dds_builtintopic_endpoint_t *writer)
{
	cau_dds_client *client = find_client(dds, 0, false);
	char subject[CAU_DDS_SUBJECT_BYTES];
	cau_client made = {.asker = {.role = role_of(dds, writer, subject),
	                             .deadline_s = deadline_of(dds, writer->qos)},
	                   .connection = ++dds->last_connection};
	char guid[33];
	uint64_t replaced;
	write_guid(guid, native ? &writer->key : &writer->participant_key);
	snprintf(made.asker.name, sizeof made.asker.name, "%s %.32s", native ? "dds" : "ros", guid);
	snprintf(made.asker.client_id, sizeof made.asker.client_id, "dds-%s", guid);
	if (!client || !cau_hub_attach(dds->hub, &made, NULL, &replaced))
		return NULL;
	*client = (cau_dds_client){.identity = identity,
	                           .native = native,
	                           .participant = writer->participant_instance_handle,
	                           .guid = writer->key,
	                           .connection = made.connection,
	                           .asker = made.asker};
	cau_log(CAU_LOG_INFO, NULL, "dds_client",
	        "client=%u name=\"%s\" deadline_s=%.3f role=%s subject=\"%s\"", made.asker.client,
	        made.asker.name, made.asker.deadline_s, cau_role_word(made.asker.role), subject);
	return client;
}

static cau_dds_writer *find_writer(cau_dds *dds, dds_entity_t reader, dds_instance_handle_t handle)
{
	for (int i = 0; i < WRITERS_MOST; i++)
		if (dds->writers[i].client && dds->writers[i].reader == reader &&
		    dds->writers[i].handle == handle)
			return &dds->writers[i];
	return NULL;
}

static cau_dds_writer *free_writer(cau_dds *dds)
{
	for (int i = 0; i < WRITERS_MOST; i++)
		if (!dds->writers[i].client)
			return &dds->writers[i];
	return NULL;
}

cau_dds_client *cau_dds_client_of(cau_dds *dds, const cau_door *door, dds_instance_handle_t handle)
{
	cau_dds_writer *writer = find_writer(dds, door->reader, handle);
	if (writer)
		return writer->client;
	dds_builtintopic_endpoint_t *endpoint = dds_get_matched_publication_data(door->reader, handle);
	writer = free_writer(dds);
	if (!endpoint || !writer) {
		if (endpoint)
			dds_builtintopic_free_endpoint(endpoint);
		return NULL;
	}
	bool native = door->kind == DOOR_NATIVE || door->kind == DOOR_REQUEST;
	uint64_t identity = native ? handle : endpoint->participant_instance_handle;
	cau_dds_client *client = find_client(dds, identity, native);
	if (!client)
		client = add_client(dds, identity, native, endpoint);
	dds_builtintopic_free_endpoint(endpoint);
	if (client) {
		*writer = (cau_dds_writer){door->reader, handle, client};
		client->writers++;
	}
	return client;
}

// ---- who is meant
static bool is_meant(const dds_builtintopic_endpoint_t *writer, uint64_t participant,
                     const uint8_t guid[16])
{
	static const uint8_t nobody[16];
	bool any = memcmp(guid, nobody, sizeof nobody) == 0;
	return writer->participant_instance_handle == participant &&
	       (any || memcmp(writer->key.v, guid, sizeof writer->key.v) == 0);
}

static cau_dds_client *find_behind(cau_dds *dds, const cau_door *door, uint64_t participant,
                                   const uint8_t guid[16])
{
	dds_instance_handle_t handles[WRITERS_MOST];
	dds_return_t count =
		door->reader > 0 ? dds_get_matched_publications(door->reader, handles, WRITERS_MOST) : 0;
	for (dds_return_t i = 0; i < count && i < WRITERS_MOST; i++) {
		dds_builtintopic_endpoint_t *writer =
			dds_get_matched_publication_data(door->reader, handles[i]);
		bool meant = writer && is_meant(writer, participant, guid);
		if (writer)
			dds_builtintopic_free_endpoint(writer);
		if (meant)
			return cau_dds_client_of(dds, door, handles[i]);
	}
	return NULL;
}

cau_dds_client *cau_dds_find_driver(cau_dds *dds, const cau_dds_client *requester, const char *id,
                                    const char *tool_name, const uint8_t guid[16])
{
	static const uint8_t nobody[16];
	cau_dds_session *session = dds->sessions;
	while (session && strcmp(cau_hosted_id(session->hosted), id) != 0)
		session = session->next;
	if (!session)
		return NULL;
	if (memcmp(guid, nobody, sizeof nobody) != 0)
		return find_behind(dds, &session->native, requester->participant, guid);
	const cau_dds_tool *tool = cau_dds_find_tool(session, tool_name);
	return tool ? find_behind(dds, &tool->servo_cp, requester->participant, guid) : NULL;
}

// ---- going
static void drop_hand(cau_dds_hand *hand)
{
	cau_hosted_tool tool;
	bool drives = cau_hosted_find_tool(hand->session->hosted, hand->tool, &tool) &&
	              tool.driver.client == hand->client->asker.client;
	if (drives || hand->claim_until_s > 0)
		cau_dds_hand_over(hand, NULL);
	*hand = (cau_dds_hand){0};
}

void cau_dds_give_up(cau_dds *dds, dds_entity_t reader, dds_instance_handle_t handle)
{
	const cau_dds_writer *writer = find_writer(dds, reader, handle);
	if (!writer)
		return;
	for (int i = 0; i < HANDS_MOST; i++) {
		cau_dds_hand *hand = &dds->hands[i];
		if (hand->client != writer->client)
			continue;
		cau_hosted_cut(hand->session->hosted, hand->client->asker.client,
		               "its writer is not alive");
		drop_hand(hand);
	}
}

static void drop_client(cau_dds *dds, cau_dds_client *client)
{
	cau_log(CAU_LOG_INFO, NULL, "dds_client_gone", "client=%u name=\"%s\"", client->asker.client,
	        client->asker.name);
	cau_hub_detach(dds->hub, client->asker.client, client->connection);
	for (int i = 0; i < HANDS_MOST; i++)
		if (dds->hands[i].client == client)
			drop_hand(&dds->hands[i]);
	cau_dds_forget_replies(dds, client);
	*client = (cau_dds_client){0};
}

static bool still_matches(const cau_dds_writer *writer)
{
	dds_builtintopic_endpoint_t *endpoint =
		dds_get_matched_publication_data(writer->reader, writer->handle);
	if (endpoint)
		dds_builtintopic_free_endpoint(endpoint);
	return endpoint != NULL;
}

void cau_dds_prune(cau_dds *dds, dds_entity_t reader, bool all)
{
	for (int i = 0; i < WRITERS_MOST; i++) {
		cau_dds_writer *writer = &dds->writers[i];
		if (!writer->client || (!all && writer->reader != reader) ||
		    (!all && still_matches(writer)))
			continue;
		cau_dds_client *client = writer->client;
		writer->client = NULL;
		if (--client->writers == 0)
			drop_client(dds, client);
	}
}

// ---- hands
cau_dds_hand *cau_dds_hand_of(cau_dds *dds, cau_dds_client *client, cau_dds_session *session,
                              const char *tool)
{
	cau_dds_hand *free_hand = NULL;
	for (int i = 0; i < HANDS_MOST; i++) {
		cau_dds_hand *hand = &dds->hands[i];
		if (!hand->client)
			free_hand = free_hand ? free_hand : hand;
		else if (hand->client == client && hand->session == session &&
		         strcmp(hand->tool, tool) == 0)
			return hand;
	}
	if (free_hand) {
		*free_hand = (cau_dds_hand){.client = client, .session = session, .jaw = 1};
		snprintf(free_hand->tool, sizeof free_hand->tool, "%s", tool);
	}
	return free_hand;
}

void cau_dds_drop_hands(cau_dds *dds, const cau_dds_session *session, const char *tool)
{
	for (int i = 0; i < HANDS_MOST; i++) {
		cau_dds_hand *hand = &dds->hands[i];
		if (hand->client && hand->session == session && (!tool || strcmp(hand->tool, tool) == 0))
			*hand = (cau_dds_hand){0};
	}
}
