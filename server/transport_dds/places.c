// SPDX-License-Identifier: GPL-3.0-or-later
// Limits how many DDS writers become clients of the hub and get a hand (cau_dds_hand) on a tool. A
// writer becomes a client with a valid sample, if its role may drive. The limits always allow a
// driver for every tool that the sessions may have. Clients that drive nothing are limited to a
// few, and make way for a writer that would drive. When the roles change, clients follow.
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "config/config.h"
#include "transport_dds/internal.h"

enum {
	// Largest number of clients of one participant, or of one identity, that drive nothing.
	IDLE_OF_ONE_MOST = 64,
	// Number of clients beyond one for each tool. These are ready to take over a tool.
	CLIENTS_BESIDE_DRIVERS = 1024,
	HANDS_OF_TOOL_MOST = 32,
};

#define DENIED_S 0.5       // time, s, after a denial in which a writer is not considered again
#define DENIALS_TOLD_S 10. // least time between log lines about denials, s

// ---- clients that drive
static bool drives(const cau_dds_hand *hand)
{
	cau_hosted_tool tool;
	return cau_monotonic_s() < hand->claim_until_s ||
	       (cau_hosted_find_tool(hand->session->hosted, hand->tool->name, &tool) &&
	        tool.driver.client == hand->client->asker.client);
}

static bool is_idle(const cau_dds_client *client)
{
	for (const cau_dds_hand *hand = client->hands; hand; hand = hand->next_own)
		if (drives(hand))
			return false;
	return true;
}

cau_status cau_dds_check_role(const cau_dds_writer *writer, cau_error *error)
{
	return writer->asker.role >= CAU_ROLE_OPERATE
	           ? CAU_OK
	           : cau_fail(error, CAU_BAD_STATE, "",
	                      "the role does not allow this (setting dds_role or dds_roles)");
}

// ---- clients
const cau_asker *cau_dds_asker_of(const cau_dds_writer *writer)
{
	return writer->client ? &writer->client->asker : &writer->asker;
}

static cau_dds_client *find_client(const cau_dds_places *places, const cau_dds_writer *writer)
{
	cau_dds_client *client = places->clients;
	while (client && (client->identity != writer->identity || client->native != writer->native))
		client = client->next;
	return client;
}

void cau_dds_join_place(const cau_dds_places *places, cau_dds_writer *writer)
{
	writer->client = find_client(places, writer);
	if (writer->client)
		writer->client->writers++;
}

static cau_dds_client *add_client(cau_dds *dds, cau_dds_writer *writer, cau_error *error)
{
	cau_dds_client *client = calloc(1, sizeof *client);
	cau_client made = {.asker = writer->asker, .connection = ++dds->places.last_connection};
	uint64_t replaced;
	if (!client || !cau_hub_attach(dds->hub, &made, NULL, &replaced)) {
		free(client);
		cau_fail(error, CAU_NO_MEMORY, "", "no memory for a client");
		return NULL;
	}
	*client = (cau_dds_client){.next = dds->places.clients,
	                           .identity = writer->identity,
	                           .native = writer->native,
	                           .participant = writer->participant,
	                           .connection = made.connection,
	                           .asker = made.asker};
	memcpy(client->subject, writer->subject, sizeof client->subject);
	dds->places.clients = client;
	dds->counts.clients++;
	cau_dds_join_place(&dds->places, writer);
	cau_log(CAU_LOG_INFO, NULL, "dds_client",
	        "client=%u name=\"%s\" deadline_s=%.3f role=%s subject=\"%s\"", made.asker.client,
	        made.asker.name, made.asker.deadline_s, cau_role_word(made.asker.role),
	        writer->subject);
	return client;
}

// `client` is the hand's client.
static void unlink_hand(cau_dds_client *client, cau_dds_hand *hand)
{
	cau_dds_hand **own = &client->hands, **link = &hand->tool->hands;
	while (*own != hand)
		own = &(*own)->next_own;
	*own = hand->next_own;
	while (*link != hand)
		link = &(*link)->next;
	*link = hand->next;
	hand->tool->hand_count--;
	free(hand);
}

static void drop_first_hand(cau_dds_client *client)
{
	cau_dds_hand *hand = client->hands;
	if (hand->claim_until_s > 0 || drives(hand))
		cau_dds_hand_over(hand, NULL);
	unlink_hand(client, hand);
}

static void drop_client(cau_dds *dds, cau_dds_client *client)
{
	cau_log(CAU_LOG_INFO, NULL, "dds_client_gone", "client=%u name=\"%s\"", client->asker.client,
	        client->asker.name);
	cau_hub_detach(dds->hub, client->asker.client, client->connection);
	while (client->hands)
		drop_first_hand(client);
	cau_dds_client **link = &dds->places.clients;
	while (*link != client)
		link = &(*link)->next;
	*link = client->next;
	dds->counts.clients--;
	free(client);
}

void cau_dds_leave_place(cau_dds *dds, cau_dds_writer *writer)
{
	cau_dds_client *client = writer->client;
	writer->client = NULL;
	if (client && --client->writers == 0)
		drop_client(dds, client);
}

void cau_dds_give_up(cau_dds_client *client)
{
	while (client->hands) {
		cau_hosted_cut(client->hands->session->hosted, client->asker.client,
		               "the DDS writer is not alive");
		drop_first_hand(client);
	}
}

// ---- limits
static bool is_same(const cau_dds_client *client, const cau_dds_writer *writer)
{
	return client->participant == writer->participant ||
	       (*writer->subject && strcmp(client->subject, writer->subject) == 0);
}

uint64_t cau_dds_places_most(const cau_config *config)
{
	return (uint64_t)config->max_sessions * CAU_MAX_TOOLS + CLIENTS_BESIDE_DRIVERS;
}

static cau_status check_quota(cau_dds *dds, const cau_dds_writer *writer, cau_error *error)
{
	int idle = 0;
	for (const cau_dds_client *client = dds->places.clients; client; client = client->next)
		if (is_same(client, writer) && is_idle(client) && ++idle == IDLE_OF_ONE_MOST)
			return cau_fail(
				error, CAU_LIMIT, "",
				"the participant or identity has %d clients without a tool, which is the limit",
				idle);
	if (dds->counts.clients >= cau_dds_places_most(dds->config))
		return cau_fail(
			error, CAU_LIMIT, "",
			"the daemon has %llu DDS clients, which is the limit (%d for each of max_sessions, "
			"and %d)",
			(unsigned long long)dds->counts.clients, CAU_MAX_TOOLS, CLIENTS_BESIDE_DRIVERS);
	return CAU_OK;
}

// Finds the client to end, among those that drive nothing: the oldest without an accepted motion,
// else the oldest. `of`: only clients of this writer's participant or identity; NULL: all clients.
static cau_dds_client *find_idle(const cau_dds_places *places, const cau_dds_writer *of)
{
	cau_dds_client *found = NULL; // the list has the newest client first
	for (cau_dds_client *client = places->clients; client; client = client->next)
		if ((!of || is_same(client, of)) && (!found || found->accepted || !client->accepted) &&
		    is_idle(client))
			found = client;
	return found;
}

// Removes the client from its writers.
static void forget_client(const cau_dds_writers *writers, const cau_dds_client *client)
{
	for (int i = 0; i < WRITER_BUCKETS; i++)
		for (cau_dds_writer *writer = writers->buckets[i]; writer; writer = writer->next)
			if (writer->client == client)
				writer->client = NULL;
}

void cau_dds_end_place(cau_dds *dds, cau_dds_client *client)
{
	forget_client(&dds->writers, client);
	drop_client(dds, client);
}

static void evict(cau_dds *dds, cau_dds_client *client)
{
	dds->counts.evicted++;
	cau_dds_end_place(dds, client);
}

static cau_status deny(cau_dds *dds, cau_dds_writer *writer, cau_error *error)
{
	double now_s = cau_monotonic_s();
	writer->retry_s = now_s + DENIED_S;
	dds->counts.denied++;
	dds->places.denials++;
	if (now_s - dds->places.denials_told_s < DENIALS_TOLD_S)
		return CAU_LIMIT;
	cau_log(CAU_LOG_WARNING, NULL, "dds_no_place",
	        "count=%llu client=\"%s\" subject=\"%s\" reason=\"%s\"",
	        (unsigned long long)dds->places.denials, writer->asker.name, writer->subject,
	        error->reason);
	dds->places.denials = 0;
	dds->places.denials_told_s = now_s;
	return CAU_LIMIT;
}

cau_dds_client *cau_dds_admit(cau_dds *dds, cau_dds_writer *writer, bool drives_now,
                              cau_error *error)
{
	if (writer->client)
		return writer->client;
	if (!drives_now && cau_monotonic_s() < writer->retry_s) {
		cau_fail(error, CAU_LIMIT, "",
		         "this writer was refused as a client less than %g s ago, see event=dds_no_place",
		         DENIED_S);
		return NULL;
	}
	if (check_quota(dds, writer, error)) {
		cau_dds_client *idle = drives_now ? find_idle(&dds->places, writer) : NULL;
		if (drives_now && !idle)
			idle = find_idle(&dds->places, NULL);
		if (!idle) {
			deny(dds, writer, error);
			return NULL;
		}
		evict(dds, idle);
	}
	return add_client(dds, writer, error);
}

// ---- hands
cau_dds_hand *cau_dds_find_hand(const cau_dds_client *client, const cau_dds_tool *tool)
{
	cau_dds_hand *hand = client ? tool->hands : NULL;
	while (hand && hand->client != client)
		hand = hand->next;
	return hand;
}

static bool evict_hand(cau_dds_tool *tool)
{
	cau_dds_hand *found = NULL;
	for (cau_dds_hand *hand = tool->hands; hand; hand = hand->next)
		if ((!found || found->past.has_pose || !hand->past.has_pose) && !drives(hand))
			found = hand;
	if (found)
		unlink_hand(found->client, found);
	return found != NULL;
}

cau_dds_hand *cau_dds_take_hand(cau_dds *dds, cau_dds_writer *writer, cau_dds_session *session,
                                cau_dds_tool *tool, bool drives_now, cau_error *error)
{
	cau_dds_client *client = cau_dds_admit(dds, writer, drives_now, error);
	cau_dds_hand *hand = cau_dds_find_hand(client, tool);
	if (!client || hand)
		return hand;
	bool room = tool->hand_count < HANDS_OF_TOOL_MOST || (drives_now && evict_hand(tool));
	hand = room ? calloc(1, sizeof *hand) : NULL;
	if (!hand) {
		cau_fail(error, CAU_LIMIT, "tool", "%d DDS writers wait for the tool, which is the limit",
		         HANDS_OF_TOOL_MOST);
		deny(dds, writer, error);
		return NULL;
	}
	*hand = (cau_dds_hand){.next = tool->hands,
	                       .next_own = client->hands,
	                       .client = client,
	                       .session = session,
	                       .tool = tool,
	                       .jaw = 1};
	tool->hands = client->hands = hand;
	tool->hand_count++;
	return hand;
}

void cau_dds_drop_hands(cau_dds_tool *tool)
{
	for (cau_dds_hand *hand = tool->hands, *next; hand; hand = next) {
		next = hand->next;
		unlink_hand(hand->client, hand);
	}
}

// ---- changing roles while the daemon runs
// The thread that calls cau_dds_reload reads the file; the DDS thread, which alone uses the roles,
// takes them over.

cau_status cau_dds_reload(cau_dds *dds, cau_error *error)
{
	cau_dds_roles *read = malloc(sizeof *read);
	if (!read)
		return cau_fail(error, CAU_NO_MEMORY, "dds_roles", "no memory for roles");
	cau_status status = cau_dds_roles_read(read, dds->config, error);
	if (status) {
		if (error)
			snprintf(error->file, sizeof error->file, "%.255s", dds->config->dds_roles);
		free(read);
		return status;
	}
	pthread_mutex_lock(&dds->mailbox.mutex);
	free(dds->mailbox.roles); // roles of an earlier reload that were not taken yet
	dds->mailbox.roles = read;
	pthread_mutex_unlock(&dds->mailbox.mutex);
	cau_dds_wake(&dds->wakeup, &dds->wakeup.roles_changed);
	return CAU_OK;
}

static cau_role role_of(const cau_dds_roles *roles, const char *subject)
{
	return cau_dds_roles_find(roles, *subject ? subject : NULL);
}

// Applies a changed role to a client. If the role is smaller, the client ends with energy off; its
// writers become clients with the new role by their next samples. If the role is larger, the client
// continues.
static void follow_role(cau_dds *dds, cau_dds_client *client)
{
	cau_role role = role_of(&dds->roles, client->subject), before = client->asker.role;
	if (role == before)
		return;
	cau_log(CAU_LOG_NOTICE, NULL, "dds_role_changed", "client=%u subject=\"%s\" before=%s role=%s",
	        client->asker.client, client->subject, cau_role_word(before), cau_role_word(role));
	client->asker.role = role;
	if (role < before)
		cau_dds_end_place(dds, client);
}

void cau_dds_take_roles(cau_dds *dds)
{
	pthread_mutex_lock(&dds->mailbox.mutex);
	cau_dds_roles *read = dds->mailbox.roles;
	dds->mailbox.roles = NULL;
	pthread_mutex_unlock(&dds->mailbox.mutex);
	if (!read)
		return;
	dds->roles = *read;
	free(read);
	for (int i = 0; i < WRITER_BUCKETS; i++)
		for (cau_dds_writer *writer = dds->writers.buckets[i]; writer; writer = writer->next)
			writer->asker.role = role_of(&dds->roles, writer->subject);
	for (cau_dds_client *client = dds->places.clients, *next; client; client = next) {
		next = client->next;
		follow_role(dds, client);
	}
}
