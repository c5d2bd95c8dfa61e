// SPDX-License-Identifier: GPL-3.0-or-later
// Watches the readers and writers of other programs that want our topics. DDS matches only
// compatible ones and does not report the rest. A user would see only a robot that does nothing. So
// each incompatible peer is logged and counted, once. A best-effort writer of motion, as for sensor
// data in ROS 2, gets a best-effort reader.
#include <fnmatch.h>
#include <stdlib.h>
#include <string.h>

#include "transport_dds/internal.h"

// ---- policies that do not match
typedef struct policies {
	dds_durability_kind_t durability;
	dds_duration_t deadline, latency, lease, blocking;
	dds_ownership_kind_t ownership;
	dds_liveliness_kind_t liveliness;
	dds_destination_order_kind_t order;
	dds_reliability_kind_t reliability;
} policies;

static policies read_policies(const dds_qos_t *qos, dds_reliability_kind_t reliability)
{
	policies p = {.deadline = DDS_INFINITY, .lease = DDS_INFINITY, .reliability = reliability};
	dds_qget_durability(qos, &p.durability);
	dds_qget_deadline(qos, &p.deadline);
	dds_qget_latency_budget(qos, &p.latency);
	dds_qget_ownership(qos, &p.ownership);
	dds_qget_liveliness(qos, &p.liveliness, &p.lease);
	dds_qget_destination_order(qos, &p.order);
	dds_qget_reliability(qos, &p.reliability, &p.blocking);
	return p;
}

const char *cau_dds_mismatch(const dds_qos_t *offered, const dds_qos_t *requested)
{
	policies o = read_policies(offered, DDS_RELIABILITY_RELIABLE);
	policies r = read_policies(requested, DDS_RELIABILITY_BEST_EFFORT);
	if (o.durability < r.durability)
		return "durability";
	if (o.deadline > r.deadline)
		return "deadline";
	if (o.latency > r.latency)
		return "latency_budget";
	if (o.ownership != r.ownership)
		return "ownership";
	if (o.liveliness < r.liveliness || o.lease > r.lease)
		return "liveliness";
	if (o.order < r.order)
		return "destination_order";
	if (o.reliability < r.reliability)
		return "reliability";
	return NULL;
}

// ---- peers
// PEERS_TOLD_MOST: largest number of log lines a second
enum { TAKEN_AT_ONCE = 32, TYPE_BYTES = 256, PEERS_TOLD_MOST = 16 };

// One of our readers or writers with which a peer could be matched.
typedef struct end {
	dds_entity_t entity; // 0 if there is none
	const cau_door *door;
	cau_door *loose; // best-effort door of the same topic; NULL if there can be none
	const char *session;
} end;

// ---- our end for a peer
static bool is_in_partition(const dds_qos_t *qos, const char *partition)
{
	uint32_t count = 0;
	char **names = NULL;
	bool in = false;
	if (!dds_qget_partition(qos, &count, &names) || count == 0)
		return !*partition;
	for (uint32_t i = 0; i < count; i++) {
		in = in || fnmatch(names[i], partition, 0) == 0;
		dds_free(names[i]);
	}
	dds_free(names);
	return in;
}

static end find_native(cau_dds *dds, const cau_dds_peer *peer)
{
	static const char prefix[] = "cautery/";
	const char *leaf = peer->topic + sizeof prefix - 1;
	if (strcmp(leaf, "session_request") == 0)
		return (end){.entity = peer->writes ? dds->control.door.reader : 0};
	if (strcmp(leaf, "session_reply") == 0)
		return (end){.entity = peer->writes ? 0 : dds->control.reply_writer};
	for (cau_dds_session *s = dds->sessions; s; s = s->next) {
		const char *id = cau_hosted_id(s->hosted);
		if (!is_in_partition(peer->qos, id))
			continue;
		if (peer->writes) {
			const cau_door *door = strcmp(leaf, "tool_setting") == 0      ? &s->setting
			                       : strcmp(leaf, "tool_instrument") == 0 ? &s->instrument
			                                                              : &s->native;
			bool is_read = door != &s->native || strcmp(leaf, "tool_command") == 0;
			return (end){.entity = is_read ? door->reader : 0, .door = door, .session = id};
		}
		const struct {
			const char *name;
			dds_entity_t writer;
		} writers[] = {
			{"tool_state", s->state.writer},      {"tool_grasp", s->grasp.writer},
			{"tool_power", s->power.writer},      {"tool_force", s->force.writer},
			{"session_status", s->status_writer}, {"topology", s->stream.topology.writer},
			{"key_frame", s->stream.key.writer},  {"delta", s->stream.delta.writer}};
		for (size_t i = 0; i < sizeof writers / sizeof writers[0]; i++)
			if (strcmp(leaf, writers[i].name) == 0)
				return (end){.entity = writers[i].writer, .session = id};
	}
	return (end){0};
}

static end find_in_tool(const cau_dds_session *session, cau_dds_tool *tool, const char *topic,
                        bool peer_writes)
{
	const struct {
		dds_entity_t topic, entity;
		bool reads;
		const cau_door *door;
		cau_door *loose;
	} ends[] = {
		{tool->servo_cp.topic, tool->servo_cp.reader, true, &tool->servo_cp, &tool->loose_cp},
		{tool->servo_jp.topic, tool->servo_jp.reader, true, &tool->servo_jp, &tool->loose_jp},
		{tool->energize.topic, tool->energize.reader, true, &tool->energize, NULL},
		{tool->state_command.topic, tool->state_command.reader, true, &tool->state_command, NULL},
		{tool->pose_topic, tool->pose.writer, false, NULL, NULL},
		{tool->asked_topic, tool->asked.writer, false, NULL, NULL},
		{tool->force_topic, tool->force.writer, false, NULL, NULL},
		{tool->raw_force_topic, tool->raw_force.writer, false, NULL, NULL},
		{tool->jaw_topic, tool->jaw.writer, false, NULL, NULL},
		{tool->asked_jaw_topic, tool->asked_jaw.writer, false, NULL, NULL},
		{tool->operating_topic, tool->operating_writer, false, NULL, NULL},
	};
	char name[TOPIC_BYTES];
	for (size_t i = 0; i < sizeof ends / sizeof ends[0]; i++)
		if (ends[i].reads == peer_writes && ends[i].entity > 0 && ends[i].topic > 0 &&
		    dds_get_name(ends[i].topic, name, sizeof name) > 0 && strcmp(name, topic) == 0)
			return (end){ends[i].entity, ends[i].door, ends[i].loose,
			             cau_hosted_id(session->hosted)};
	return (end){0};
}

static end find_end(cau_dds *dds, const cau_dds_peer *peer)
{
	end found = {0};
	if (peer->topic[0] == 'c')
		return find_native(dds, peer);
	if (!is_in_partition(peer->qos, ""))
		return found;
	const char *name = peer->topic + sizeof "rt/" - 1;
	for (cau_dds_session *s = dds->sessions; s && !found.entity; s = s->next) {
		size_t bytes = strlen(s->ros_name);
		if (!s->has_ros_name || strncmp(name, s->ros_name, bytes) != 0 || name[bytes] != '/')
			continue;
		for (int i = 0; i < CAU_MAX_TOOLS && !found.entity; i++)
			if (s->tools[i].used)
				found = find_in_tool(s, &s->tools[i], peer->topic, peer->writes);
	}
	return found;
}

// ---- why a peer does not match

// Returns what does not match; NULL if everything matches. DDS compares types only by name.
static const char *find_mismatch(const cau_dds_peer *peer, const end *ours)
{
	char type[TYPE_BYTES] = "";
	dds_entity_t topic = dds_get_topic(ours->entity);
	dds_qos_t *qos = dds_create_qos();
	const char *wrong = NULL;
	if (topic > 0 && dds_get_type_name(topic, type, sizeof type) > 0 &&
	    strcmp(type, peer->type) != 0)
		wrong = "type";
	else if (dds_get_qos(ours->entity, qos) == DDS_RETCODE_OK)
		wrong = peer->writes ? cau_dds_mismatch(peer->qos, qos) : cau_dds_mismatch(qos, peer->qos);
	dds_delete_qos(qos);
	return wrong;
}

static void tell(cau_dds *dds, cau_dds_peer *peer, const end *ours, const char *wrong)
{
	double now_s = cau_monotonic_s();
	char participant[2 * sizeof peer->participant.v + 1];
	peer->told = true;
	dds->counts.incompatible++;
	if (now_s - dds->peers.told_s >= 1) {
		dds->peers.told_s = now_s;
		dds->peers.told = 0;
	}
	if (dds->peers.told++ >= PEERS_TOLD_MOST)
		return;
	for (size_t i = 0; i < sizeof peer->participant.v; i++)
		snprintf(participant + 2 * i, 3, "%02x", peer->participant.v[i]);
	cau_log(CAU_LOG_WARNING, ours->session, "dds_incompatible",
	        "participant=%s topic=\"%.160s\" end=%s policy=%s type=\"%.100s\"", participant,
	        peer->topic, peer->writes ? "writer" : "reader", wrong, peer->type);
}

static void look_at(cau_dds *dds, cau_dds_peer *peer)
{
	end ours = peer->told ? (end){0} : find_end(dds, peer);
	const char *wrong = ours.entity > 0 ? find_mismatch(peer, &ours) : NULL;
	if (!wrong)
		return;
	if (ours.loose && strcmp(wrong, "reliability") == 0) {
		if (!ours.loose->reader)
			cau_dds_open_loose(dds, ours.loose, ours.door);
	} else {
		tell(dds, peer, &ours, wrong);
	}
}

// ---- the list of peers
static void free_peer(cau_dds_peer *peer)
{
	free(peer->topic);
	free(peer->type);
	dds_delete_qos(peer->qos);
	free(peer);
}

static void forget_peer(cau_dds_peers *peers, dds_instance_handle_t handle)
{
	for (cau_dds_peer **link = &peers->first; *link; link = &(*link)->next)
		if ((*link)->handle == handle) {
			cau_dds_peer *gone = *link;
			*link = gone->next;
			free_peer(gone);
			return;
		}
}

static bool concerns_us(dds_entity_t participant, const dds_builtintopic_endpoint_t *endpoint)
{
	dds_guid_t own;
	return endpoint->topic_name && endpoint->type_name &&
	       (strncmp(endpoint->topic_name, "cautery/", 8) == 0 ||
	        strncmp(endpoint->topic_name, "rt/", 3) == 0) &&
	       !dds_get_guid(participant, &own) &&
	       memcmp(own.v, endpoint->participant_key.v, sizeof own.v) != 0;
}

static void meet_peer(cau_dds *dds, const dds_builtintopic_endpoint_t *endpoint,
                      dds_instance_handle_t handle, bool writes)
{
	cau_dds_peer *peer =
		concerns_us(dds->entities.participant, endpoint) ? calloc(1, sizeof *peer) : NULL;
	if (!peer)
		return;
	*peer = (cau_dds_peer){.next = dds->peers.first,
	                       .handle = handle,
	                       .writes = writes,
	                       .participant = endpoint->participant_key,
	                       .topic = strdup(endpoint->topic_name),
	                       .type = strdup(endpoint->type_name),
	                       .qos = dds_create_qos()};
	if (!peer->topic || !peer->type || !peer->qos ||
	    dds_copy_qos(peer->qos, endpoint->qos) != DDS_RETCODE_OK) {
		free_peer(peer);
		return;
	}
	dds->peers.first = peer;
	look_at(dds, peer);
}

static void take_peers(cau_dds *dds, dds_entity_t reader, bool writes)
{
	void *samples[TAKEN_AT_ONCE];
	dds_sample_info_t infos[TAKEN_AT_ONCE];
	dds_return_t count;
	do {
		samples[0] = NULL;
		count = dds_take(reader, samples, infos, TAKEN_AT_ONCE, TAKEN_AT_ONCE);
		for (dds_return_t i = 0; i < count; i++) {
			forget_peer(&dds->peers, infos[i].instance_handle);
			if (infos[i].valid_data && infos[i].instance_state == DDS_ALIVE_INSTANCE_STATE)
				meet_peer(dds, samples[i], infos[i].instance_handle, writes);
		}
		if (count > 0)
			dds_return_loan(reader, samples, count);
	} while (count == TAKEN_AT_ONCE);
}

void cau_dds_look_at_peers(cau_dds *dds)
{
	if (atomic_exchange(&dds->wakeup.peers_changed, false)) {
		take_peers(dds, dds->peers.writers, true);
		take_peers(dds, dds->peers.readers, false);
	}
	if (!dds->peers.ends_changed)
		return;
	dds->peers.ends_changed = false;
	for (cau_dds_peer *peer = dds->peers.first; peer; peer = peer->next)
		look_at(dds, peer);
}

static void on_peers(dds_entity_t reader, void *user)
{
	cau_dds *dds = user;
	(void)reader;
	cau_dds_wake(&dds->wakeup, &dds->wakeup.peers_changed);
}

cau_status cau_dds_watch_peers(cau_dds *dds, cau_error *error)
{
	dds_listener_t *listener = dds_create_listener(dds);
	dds_lset_data_available(listener, on_peers);
	dds->peers.writers = dds_create_reader(dds->entities.participant,
	                                       DDS_BUILTIN_TOPIC_DCPSPUBLICATION, NULL, listener);
	dds->peers.readers = dds_create_reader(dds->entities.participant,
	                                       DDS_BUILTIN_TOPIC_DCPSSUBSCRIPTION, NULL, listener);
	dds_delete_listener(listener);
	dds_return_t code = dds->peers.writers < 0 ? dds->peers.writers : dds->peers.readers;
	return code > 0
	           ? CAU_OK
	           : cau_fail(error, CAU_IO, "dds",
	                      "cannot create the DDS readers that find writers and readers in domain "
	                      "%lld: %s",
	                      (long long)dds->config->dds_domain, dds_strretcode(code));
}

void cau_dds_forget_peers(cau_dds_peers *peers)
{
	for (cau_dds_peer *next; peers->first; peers->first = next) {
		next = peers->first->next;
		free_peer(peers->first);
	}
}
