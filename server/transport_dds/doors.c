// SPDX-License-Identifier: GPL-3.0-or-later
// Readers and writers of sessions and tools, with their QoS.
#include <string.h>

#include "ros2.h"
#include "transport_dds/internal.h"

enum {
	NATIVE_KEPT = 256,
	ROS2_KEPT = 10,
	DELTAS_KEPT = 16,
	REQUESTS_KEPT = 256,
	REPLIES_KEPT = 256
};

cau_status cau_dds_open_topics(cau_dds *dds, cau_error *error)
{
	static const struct {
		const char *name;
		const dds_topic_descriptor_t *type;
	} topics[TOPIC_COUNT] = {
		[TOPIC_STATE] = {"cautery/tool_state", &cautery_ToolState_desc},
		[TOPIC_GRASP] = {"cautery/tool_grasp", &cautery_ToolGrasp_desc},
		[TOPIC_POWER] = {"cautery/tool_power", &cautery_ToolPower_desc},
		[TOPIC_FORCE] = {"cautery/tool_force", &cautery_ToolForce_desc},
		[TOPIC_STATUS] = {"cautery/session_status", &cautery_SessionStatus_desc},
		[TOPIC_TOPOLOGY] = {"cautery/topology", &cautery_Frame_desc},
		[TOPIC_KEY_FRAME] = {"cautery/key_frame", &cautery_Frame_desc},
		[TOPIC_DELTA] = {"cautery/delta", &cautery_Frame_desc},
		[TOPIC_REQUEST] = {"cautery/session_request", &cautery_SessionRequest_desc},
		[TOPIC_REPLY] = {"cautery/session_reply", &cautery_SessionReply_desc},
	};
	for (int i = 0; i < TOPIC_COUNT; i++) {
		dds->entities.topics[i] =
			dds_create_topic(dds->entities.participant, topics[i].type, topics[i].name, NULL, NULL);
		if (dds->entities.topics[i] < 0)
			return cau_fail(error, CAU_IO, "dds",
			                "Cyclone DDS cannot create topic %s in domain %lld: %s", topics[i].name,
			                (long long)dds->config->dds_domain,
			                dds_strretcode(dds->entities.topics[i]));
	}
	return CAU_OK;
}

// Returns a reliable QoS. Our writers never wait for a reader (max_blocking_time 0). With
// KEEP_LAST, a slow reader loses the oldest samples. That is harmless, because the newest state or
// the next key frame replaces them.
static dds_qos_t *reliable_qos(int32_t kept)
{
	dds_qos_t *qos = dds_create_qos();
	dds_qset_reliability(qos, DDS_RELIABILITY_RELIABLE, 0);
	dds_qset_durability(qos, DDS_DURABILITY_VOLATILE);
	dds_qset_ownership(qos, DDS_OWNERSHIP_SHARED);
	dds_qset_history(qos, DDS_HISTORY_KEEP_LAST, kept);
	return qos;
}

static bool open_door(cau_dds *dds, cau_door *door, dds_entity_t subscriber, const dds_qos_t *qos)
{
	dds_listener_t *listener = cau_dds_listen_to_liveliness(dds);
	door->reader = dds_create_reader(subscriber, door->topic, qos, listener);
	dds_delete_listener(listener);
	if (door->reader < 0) {
		char topic[TOPIC_BYTES] = "";
		dds_get_name(door->topic, topic, sizeof topic);
		cau_log(
			CAU_LOG_ERROR, door->session ? cau_hosted_id(door->session->hosted) : NULL,
			"dds_no_reader",
			"topic=%s tool=%s reason=\"no DDS reader (%s): samples of this topic are not taken\"",
			topic, door->tool, dds_strretcode(door->topic < 0 ? door->topic : door->reader));
		door->reader = 0;
		return false;
	}
	dds_set_status_mask(door->reader,
	                    DDS_SUBSCRIPTION_MATCHED_STATUS | DDS_LIVELINESS_CHANGED_STATUS);
	dds_waitset_attach(dds->entities.waitset, door->reader, (dds_attach_t)door);
	door->samples = dds_create_readcondition(door->reader, DDS_ANY_STATE);
	dds_waitset_attach(dds->entities.waitset, door->samples, (dds_attach_t)door);
	return true;
}

void cau_dds_open_loose(cau_dds *dds, cau_door *loose, const cau_door *reliable)
{
	dds_qos_t *qos = reliable_qos(ROS2_KEPT);
	dds_qset_reliability(qos, DDS_RELIABILITY_BEST_EFFORT, 0);
	*loose = (cau_door){.kind = reliable->kind,
	                    .best_effort = true,
	                    .topic = reliable->topic,
	                    .session = reliable->session};
	memcpy(loose->tool, reliable->tool, sizeof loose->tool);
	open_door(dds, loose, dds->entities.subscriber, qos);
	dds_delete_qos(qos);
}

static void close_door(cau_dds *dds, cau_door *door)
{
	dds_entity_t reader = door->reader;
	if (reader > 0) {
		dds_waitset_detach(dds->entities.waitset, door->samples);
		dds_waitset_detach(dds->entities.waitset, reader);
		dds_delete(reader);
		cau_dds_prune(dds, reader, false);
	}
	// a topic of a best-effort door belongs to the reliable door
	if (door->topic > 0 && !door->best_effort)
		dds_delete(door->topic);
	*door = (cau_door){0};
}

// Opens the request reader and the reply writer. Replies are kept, because a requester's reader may
// be discovered after its request.
cau_status cau_dds_open_control(cau_dds *dds, cau_error *error)
{
	dds_qos_t *partition = dds_create_qos(), *taken = reliable_qos(REQUESTS_KEPT),
			  *kept = reliable_qos(REPLIES_KEPT);
	dds_qset_partition1(partition, "cautery");
	dds_qset_durability(kept, DDS_DURABILITY_TRANSIENT_LOCAL);
	dds_qset_durability_service(kept, 0, DDS_HISTORY_KEEP_LAST, REPLIES_KEPT, DDS_LENGTH_UNLIMITED,
	                            DDS_LENGTH_UNLIMITED, DDS_LENGTH_UNLIMITED);
	dds->control.subscriber = dds_create_subscriber(dds->entities.participant, partition, NULL);
	dds->control.publisher = dds_create_publisher(dds->entities.participant, partition, NULL);
	dds->control.reply_writer =
		dds_create_writer(dds->control.publisher, dds->entities.topics[TOPIC_REPLY], kept, NULL);
	dds->control.door =
		(cau_door){.kind = DOOR_REQUEST, .topic = dds->entities.topics[TOPIC_REQUEST]};
	bool done = open_door(dds, &dds->control.door, dds->control.subscriber, taken);
	dds_delete_qos(partition);
	dds_delete_qos(taken);
	dds_delete_qos(kept);
	if (!done)
		return cau_fail(error, CAU_IO, "dds",
		                "Cyclone DDS cannot create the reader of cautery/session_request: see "
		                "event=dds_no_reader above");
	return dds->control.reply_writer > 0
	           ? CAU_OK
	           : cau_fail(error, CAU_IO, "dds",
	                      "Cyclone DDS cannot create the writer of cautery/session_reply: %s",
	                      dds_strretcode(dds->control.reply_writer));
}

static void open_writers(cau_dds *dds, cau_dds_session *session)
{
	cau_dds_stream *stream = &session->stream;
	dds_qos_t *kept = reliable_qos(1), *last = reliable_qos(1), *chain = reliable_qos(DELTAS_KEPT);
	dds_qset_durability(kept, DDS_DURABILITY_TRANSIENT_LOCAL);
	dds_qset_durability(last, DDS_DURABILITY_TRANSIENT_LOCAL);
	// The writer must not dispose the instance at its end. It may outlive its session, and by then
	// another session may have the same name.
	dds_qset_writer_data_lifecycle(last, false);
	const struct {
		cau_dds_outlet *outlet;
		cau_topic topic;
		const dds_qos_t *qos;
	} outlets[] = {
		{&session->state, TOPIC_STATE, kept},      {&session->grasp, TOPIC_GRASP, kept},
		{&session->power, TOPIC_POWER, kept},      {&session->force, TOPIC_FORCE, kept},
		{&stream->topology, TOPIC_TOPOLOGY, kept}, {&stream->key, TOPIC_KEY_FRAME, kept},
		{&stream->delta, TOPIC_DELTA, chain},
	};
	uint32_t number = cau_hosted_number(session->hosted);
	for (size_t i = 0; i < sizeof outlets / sizeof outlets[0]; i++)
		cau_dds_open_outlet(&dds->wakeup, outlets[i].outlet, number, session->publisher,
		                    dds->entities.topics[outlets[i].topic], outlets[i].qos);
	session->status_writer =
		dds_create_writer(session->publisher, dds->entities.topics[TOPIC_STATUS], last, NULL);
	dds_delete_qos(kept);
	dds_delete_qos(last);
	dds_delete_qos(chain);
}

static bool admit_command(const void *sample, void *keys)
{
	const cautery_ToolCommand *command = sample;
	return cau_dds_keys_admit(keys, command->session, command->tool);
}

static bool admit_setting(const void *sample, void *keys)
{
	const cautery_ToolSetting *setting = sample;
	return cau_dds_keys_admit(keys, setting->session, setting->tool);
}

static bool admit_instrument(const void *sample, void *keys)
{
	const cautery_ToolInstrument *instrument = sample;
	return cau_dds_keys_admit(keys, instrument->session, instrument->tool);
}

// Opens a native topic that controllers write.
static bool open_native(cau_dds *dds, cau_dds_session *session, cau_door *door, cau_door_kind kind)
{
	static const struct {
		const char *name;
		const dds_topic_descriptor_t *type;
		bool (*admit)(const void *sample, void *keys);
	} natives[] = {
		[DOOR_NATIVE] = {"cautery/tool_command", &cautery_ToolCommand_desc, admit_command},
		[DOOR_SETTING] = {"cautery/tool_setting", &cautery_ToolSetting_desc, admit_setting},
		[DOOR_INSTRUMENT] = {"cautery/tool_instrument", &cautery_ToolInstrument_desc,
	                         admit_instrument},
	};
	dds_qos_t *taken = reliable_qos(NATIVE_KEPT);
	const struct dds_topic_filter filter = {
		DDS_TOPIC_FILTER_SAMPLE_ARG, {.sample_arg = natives[kind].admit}, &session->keys};
	dds_entity_t topic = dds_create_topic(dds->entities.participant, natives[kind].type,
	                                      natives[kind].name, NULL, NULL);
	*door = (cau_door){.kind = kind, .topic = topic, .session = session};
	bool done = topic > 0 && !dds_set_topic_filter_extended(topic, &filter) &&
	            open_door(dds, door, session->subscriber, taken);
	dds_delete_qos(taken);
	return done;
}

cau_status cau_dds_open_session(cau_dds *dds, cau_dds_session *session)
{
	const char *id = cau_hosted_id(session->hosted);
	dds_qos_t *partition = dds_create_qos();
	dds_qset_partition1(partition, id);
	session->subscriber = dds_create_subscriber(dds->entities.participant, partition, NULL);
	session->publisher = dds_create_publisher(dds->entities.participant, partition, NULL);
	bool done = open_native(dds, session, &session->native, DOOR_NATIVE) &&
	            open_native(dds, session, &session->setting, DOOR_SETTING) &&
	            open_native(dds, session, &session->instrument, DOOR_INSTRUMENT);
	dds->peers.ends_changed = true;
	open_writers(dds, session);
	dds_delete_qos(partition);
	if (!session->has_ros_name)
		cau_log(
			CAU_LOG_WARNING, id, "dds_name_taken",
			"name=%s reason=\"another session has this name, so this session has no ROS 2 topics\"",
			session->ros_name);
	cau_log(CAU_LOG_INFO, id, "dds_session", "partition=%s ros_name=%s", id, session->ros_name);
	return done ? CAU_OK : CAU_IO;
}

static void close_writers(cau_dds_farewell **farewells, cau_dds_session *session)
{
	// Readers of other vendors do not treat the end of a writer as the end of its instance, so
	// dispose the instance.
	cautery_SessionStatus gone = {0};
	snprintf(gone.session, sizeof gone.session, "%s", cau_hosted_id(session->hosted));
	if (session->status_writer > 0)
		dds_dispose(session->status_writer, &gone);
	cau_dds_outlet *at_once[] = {
		&session->state,           &session->grasp,      &session->power,       &session->force,
		&session->stream.topology, &session->stream.key, &session->stream.delta};
	for (size_t i = 0; i < sizeof at_once / sizeof at_once[0]; i++)
		cau_dds_close_outlet(at_once[i]);
	cau_dds_bid_farewell(farewells, session->publisher, session->status_writer);
}

void cau_dds_close_session(cau_dds *dds, cau_dds_session *session)
{
	for (int i = 0; i < CAU_MAX_TOOLS; i++)
		if (session->tools[i].used)
			cau_dds_close_tool(dds, &session->tools[i]);
	close_door(dds, &session->native);
	close_door(dds, &session->setting);
	close_door(dds, &session->instrument);
	cau_dds_leave_frames(session);
	if (session->subscriber > 0)
		dds_delete(session->subscriber);
	if (session->publisher > 0)
		close_writers(&dds->farewells, session);
}

// ---- ROS 2
static bool ros_tool_name(const cau_dds_session *session, const cau_dds_tool *tool,
                          char name[CAU_NAME_BYTES])
{
	char other[CAU_NAME_BYTES];
	for (int pass = 0; pass <= CAU_MAX_TOOLS; pass++) {
		const cau_dds_tool *t = pass ? &session->tools[pass - 1] : tool;
		if ((pass && t == tool) || !t->used)
			continue;
		char *to = pass ? other : name;
		snprintf(to, CAU_NAME_BYTES, "%s", t->name);
		for (char *c = to; *c; c++)
			if (*c == '-')
				*c = '_';
		if (pass && t->servo_cp.reader && strcmp(other, name) == 0)
			return false;
	}
	return true;
}

static dds_entity_t ros_topic(const cau_dds_entities *entities, const char *prefix,
                              const char *name, const dds_topic_descriptor_t *type)
{
	char topic[TOPIC_BYTES];
	snprintf(topic, sizeof topic, "rt/%s/%s", prefix, name);
	return dds_create_topic(entities->participant, type, topic, NULL, NULL);
}

typedef struct ros_outlet {
	dds_entity_t *topic;
	cau_dds_outlet *outlet;
	const char *name;
	const dds_topic_descriptor_t *type;
} ros_outlet;

typedef struct ros_door {
	cau_door *door;
	cau_door_kind kind;
	const char *name;
	const dds_topic_descriptor_t *type;
} ros_door;

// Writes the first part of the names of the tool's topics. Returns false if another tool or session
// has that name.
static bool ros_prefix(const cau_dds_session *session, const cau_dds_tool *tool,
                       char prefix[2 * CAU_NAME_BYTES])
{
	char name[CAU_NAME_BYTES];
	if (!session->has_ros_name || !ros_tool_name(session, tool, name))
		return false;
	snprintf(prefix, 2 * (size_t)CAU_NAME_BYTES, "%.48s/%.48s", session->ros_name, name);
	return true;
}

static void open_ros_outlets(cau_dds *dds, const cau_dds_session *session, const char *prefix,
                             const ros_outlet *outlets, size_t count)
{
	dds_qos_t *qos = reliable_qos(ROS2_KEPT);
	for (size_t i = 0; i < count; i++) {
		*outlets[i].topic = ros_topic(&dds->entities, prefix, outlets[i].name, outlets[i].type);
		cau_dds_open_outlet(&dds->wakeup, outlets[i].outlet, cau_hosted_number(session->hosted),
		                    dds->entities.publisher, *outlets[i].topic, qos);
	}
	dds_delete_qos(qos);
}

static void open_ros_doors(cau_dds *dds, cau_dds_session *session, const cau_dds_tool *tool,
                           const char *prefix, const ros_door *doors, size_t count)
{
	dds_qos_t *qos = reliable_qos(ROS2_KEPT);
	for (size_t i = 0; i < count; i++) {
		*doors[i].door = (cau_door){.kind = doors[i].kind, .session = session};
		memcpy(doors[i].door->tool, tool->name, sizeof tool->name);
		doors[i].door->topic = ros_topic(&dds->entities, prefix, doors[i].name, doors[i].type);
		open_door(dds, doors[i].door, dds->entities.subscriber, qos);
	}
	dds_delete_qos(qos);
}

static void open_operating(const cau_dds_entities *entities, cau_dds_tool *tool, const char *prefix)
{
	// The last state is kept for late joiners; CRTK's clients request this QoS.
	dds_qos_t *latched = reliable_qos(1);
	dds_qset_durability(latched, DDS_DURABILITY_TRANSIENT_LOCAL);
	tool->operating_topic =
		ros_topic(entities, prefix, "operating_state", &crtk_msgs_msg_dds__OperatingState__desc);
	tool->operating_writer =
		dds_create_writer(entities->publisher, tool->operating_topic, latched, NULL);
	dds_delete_qos(latched);
}

void cau_dds_open_tool(cau_dds *dds, cau_dds_session *session, cau_dds_tool *tool)
{
	char prefix[2 * CAU_NAME_BYTES];
	if (!session->has_ros_name)
		return;
	if (!ros_prefix(session, tool, prefix)) {
		cau_log(
			CAU_LOG_WARNING, cau_hosted_id(session->hosted), "dds_name_taken",
			"tool=%s reason=\"another tool has this ROS 2 name, so this tool has no ROS 2 topics\"",
			tool->name);
		return;
	}
	const ros_door doors[] = {
		{&tool->servo_cp, DOOR_SERVO_CP, "servo_cp", &geometry_msgs_msg_dds__PoseStamped__desc},
		{&tool->energize, DOOR_ENERGIZE, "energize", &sensor_msgs_msg_dds__Joy__desc},
		{&tool->state_command, DOOR_STATE_COMMAND, "state_command",
	     &crtk_msgs_msg_dds__StringStamped__desc},
	};
	const ros_outlet outlets[] = {
		{&tool->pose_topic, &tool->pose, "measured_cp", &geometry_msgs_msg_dds__PoseStamped__desc},
		{&tool->asked_topic, &tool->asked, "setpoint_cp",
	     &geometry_msgs_msg_dds__PoseStamped__desc},
		{&tool->force_topic, &tool->force, "measured_cf",
	     &geometry_msgs_msg_dds__WrenchStamped__desc},
		{&tool->raw_force_topic, &tool->raw_force, "raw/measured_cf",
	     &geometry_msgs_msg_dds__WrenchStamped__desc},
	};
	dds->peers.ends_changed = true;
	open_ros_doors(dds, session, tool, prefix, doors, sizeof doors / sizeof doors[0]);
	open_ros_outlets(dds, session, prefix, outlets, sizeof outlets / sizeof outlets[0]);
	open_operating(&dds->entities, tool, prefix);
}

static void delete_topics(dds_entity_t *const *topics, size_t count)
{
	for (size_t i = 0; i < count; i++) {
		if (*topics[i] > 0)
			dds_delete(*topics[i]);
		*topics[i] = 0;
	}
}

static void close_jaws(cau_dds *dds, cau_dds_tool *tool)
{
	dds_entity_t *const topics[] = {&tool->jaw_topic, &tool->asked_jaw_topic};
	close_door(dds, &tool->loose_jp);
	close_door(dds, &tool->servo_jp);
	cau_dds_close_outlet(&tool->jaw);
	cau_dds_close_outlet(&tool->asked_jaw);
	delete_topics(topics, sizeof topics / sizeof topics[0]);
}

void cau_dds_follow_jaws(cau_dds *dds, cau_dds_session *session, cau_dds_tool *tool, bool has_jaws)
{
	char prefix[2 * CAU_NAME_BYTES];
	const ros_door doors[] = {
		{&tool->servo_jp, DOOR_SERVO_JP, "jaw/servo_jp", &sensor_msgs_msg_dds__JointState__desc}};
	const ros_outlet outlets[] = {
		{&tool->jaw_topic, &tool->jaw, "jaw/measured_js", &sensor_msgs_msg_dds__JointState__desc},
		{&tool->asked_jaw_topic, &tool->asked_jaw, "jaw/setpoint_js",
	     &sensor_msgs_msg_dds__JointState__desc},
	};
	if (has_jaws == (tool->servo_jp.reader > 0) || tool->servo_cp.reader <= 0)
		return;
	dds->peers.ends_changed = true;
	if (!has_jaws) {
		close_jaws(dds, tool);
	} else if (ros_prefix(session, tool, prefix)) {
		open_ros_doors(dds, session, tool, prefix, doors, sizeof doors / sizeof doors[0]);
		open_ros_outlets(dds, session, prefix, outlets, sizeof outlets / sizeof outlets[0]);
	}
}

void cau_dds_close_tool(cau_dds *dds, cau_dds_tool *tool)
{
	close_jaws(dds, tool);
	close_door(dds, &tool->loose_cp);
	close_door(dds, &tool->servo_cp);
	close_door(dds, &tool->energize);
	close_door(dds, &tool->state_command);
	cau_dds_close_outlet(&tool->pose);
	cau_dds_close_outlet(&tool->asked);
	cau_dds_close_outlet(&tool->force);
	cau_dds_close_outlet(&tool->raw_force);
	dds_entity_t *const made[] = {&tool->operating_writer, &tool->pose_topic,
	                              &tool->asked_topic,      &tool->force_topic,
	                              &tool->raw_force_topic,  &tool->operating_topic};
	delete_topics(made, sizeof made / sizeof made[0]);
	*tool = (cau_dds_tool){0};
}
