// SPDX-License-Identifier: GPL-3.0-or-later
// What the files of this room share. Each part of the transport names its thread or its lock.
#pragma once

#include <dds/dds.h>
#include <pthread.h>
#include <stdatomic.h>
#include <string.h>

#include "cautery.h"
#include "cautery/messages.h"
#include "clock/clock.h"
#include "hosted_session/tools.h"
#include "hub/sign_of_life.h"
#include "log/log.h"
#include "transport_dds/checks.h"
#include "transport_dds/dds_transport.h"
#include "transport_dds/keys.h"
#include "transport_dds/roles.h"

enum {
	WRITER_BUCKETS = 1024,
	REQUESTS_MOST = 256,       // that wait for their answer
	REQUESTS_OF_ONE_MOST = 64, // of one participant
	TOPIC_BYTES = 2 * CAU_NAME_BYTES + 32,
};

// Native topics, opened once for the participant; doors.c has their names. cautery/tool_command is
// opened once for each session, since a topic has one filter; so are cautery/tool_setting
// and cautery/tool_instrument.
typedef enum cau_topic {
	TOPIC_STATE,
	TOPIC_GRASP,
	TOPIC_POWER,
	TOPIC_FORCE,
	TOPIC_STATUS,
	TOPIC_TOPOLOGY,
	TOPIC_KEY_FRAME,
	TOPIC_DELTA,
	TOPIC_REQUEST,
	TOPIC_REPLY,
	TOPIC_COUNT
} cau_topic;

typedef enum cau_door_kind {
	DOOR_NATIVE,   // cautery/tool_command
	DOOR_SERVO_CP, // rt/SESSION/TOOL/...
	DOOR_SERVO_JP,
	DOOR_ENERGIZE,
	DOOR_STATE_COMMAND,
	DOOR_SETTING,    // cautery/tool_setting
	DOOR_INSTRUMENT, // cautery/tool_instrument
	DOOR_REQUEST,    // cautery/session_request; of no session
} cau_door_kind;

struct cau_dds_session;

// A reader. `tool` is empty for DOOR_NATIVE, whose samples name theirs.
typedef struct cau_door {
	cau_door_kind kind;
	bool best_effort; // beside a reliable one of the same topic, whose writers it leaves to that
	dds_entity_t topic, reader; // 0: closed
	dds_entity_t samples;       // the condition that some are there to take
	struct cau_dds_session *session;
	char tool[CAU_NAME_BYTES];
} cau_door;

typedef enum cau_dds_operating_state {
	OPERATING_NOTHING, // told: nothing yet
	OPERATING_DISABLED,
	OPERATING_ENABLED,
	OPERATING_PAUSED,
	OPERATING_FAULT,
} cau_dds_operating_state;

// A writer of ours of which it is known who reads it; outlets.c.
typedef struct cau_dds_outlet {
	struct cau_dds_wakeup *wakeup;
	uint32_t session; // its number
	dds_entity_t writer;
	atomic_uint readers;   // matched now
	atomic_bool newcomers; // some came, and have not got what stands
} cau_dds_outlet;

// A set of sessions, by their numbers modulo its size: with two of one bit both are meant.
enum { BITS_WORDS = 32, BITS_MOST = 64 * BITS_WORDS };
typedef struct cau_dds_bits {
	atomic_ullong words[BITS_WORDS];
} cau_dds_bits;

// As CRTK has it; operating.c.
typedef struct cau_dds_operating {
	cau_dds_operating_state state;
	bool unhomed;
} cau_dds_operating;

typedef struct cau_dds_tool {
	bool used, seen;
	char name[CAU_NAME_BYTES];
	// closed where the ROS 2 name is taken
	cau_door servo_cp, servo_jp, energize, state_command;
	cau_door loose_cp, loose_jp; // of best effort; open once such a writer is there
	dds_entity_t pose_topic, asked_topic, force_topic, raw_force_topic, jaw_topic, asked_jaw_topic;
	cau_dds_outlet pose, asked, force;              // measured_cp, setpoint_cp, measured_cf
	cau_dds_outlet raw_force;                       // raw/measured_cf
	cau_dds_outlet jaw, asked_jaw;                  // jaw/measured_js, jaw/setpoint_js
	dds_entity_t operating_topic, operating_writer; // operating_state
	cau_dds_operating operating, operating_told;
	struct cau_dds_hand *hands;
	int hand_count;
} cau_dds_tool;

// A session's frames; frames.c. Joined while somebody reads them.
typedef struct cau_dds_stream {
	cau_dds_outlet topology, key, delta;
	uint64_t ticket; // of a join on its way; 0: none
	double retry_s;  // not before this, after a join that was refused
	bool joined;
	cau_wire_stream_description description;
	cau_subscriber chain; // every delta, and key frames that mend the chain
	cau_subscriber keys;  // key frames beside it
	bool key_wanted;      // by a new reader or on request
	bool key_forced;      // even if the newest is out already
	double key_due_s;
	uint64_t key_epoch, key_sequence; // of the last key frame written
} cau_dds_stream;

// What was last said of a session; status.c.
typedef struct cau_dds_status {
	cau_wire_session_summary summary;
	cau_hosted_counts counts;
	double written_s; // 0: never
} cau_dds_status;

typedef struct cau_dds_session {
	struct cau_dds_session *next;
	cau_hosted *hosted; // shared
	bool seen;
	char ros_name[CAU_NAME_BYTES];
	bool has_ros_name;
	dds_entity_t subscriber, publisher; // of its partition
	cau_door native, setting, instrument;
	cau_dds_keys keys; // what these doors let in
	dds_entity_t status_writer;
	cau_dds_outlet state, grasp, power, force;
	cau_hosted_tool states[CAU_MAX_TOOLS]; // as they were last seen
	uint64_t states_tick;
	double states_s;                 // when unread states were last written
	bool states_owed[CAU_MAX_TOOLS]; // more than the tick has changed since
	double look_s;                   // when to look at it again, whether it had a slice or not
	cau_dds_stream stream;
	cau_dds_status status;
	cau_dds_tool tools[CAU_MAX_TOOLS];
	// refusals, logged once a second
	int64_t refused;
	bool drops_untold; // some of them were dropped, and nothing else may come to tell it
	double refused_told_s;
} cau_dds_session;

// Who has a place: a client of the hub. Native writers are one each, those of ROS 2 one for their
// participant. places.c.
typedef struct cau_dds_client {
	struct cau_dds_client *next;
	uint64_t identity; // of the publication (native) or participant (ROS 2)
	bool native;
	uint64_t participant;
	char subject[CAU_DDS_SUBJECT_BYTES]; // that it has proved; "": none
	int32_t writers;                     // matched ones that are its own
	bool accepted;                       // a motion of it was
	uint64_t connection;                 // for the hub
	double alive_s;                      // its newest sign of life, monotonic; 0: none was heard
	cau_asker asker;
	struct cau_dds_hand *hands;
} cau_dds_client;

// One writer of one reader; writers.c.
typedef struct cau_dds_writer {
	struct cau_dds_writer *next; // in its bucket
	dds_entity_t reader;
	dds_instance_handle_t handle;
	bool native, reliable;
	uint64_t identity, participant; // as in its client
	dds_guid_t guid;
	char subject[CAU_DDS_SUBJECT_BYTES];
	cau_asker asker;        // without a number; that is its client's
	cau_dds_client *client; // NULL: it has no place
	cau_sign_of_life sign;  // by the source timestamps of its samples
	double retry_s;         // it was denied one, until this
	double requests_s;      // the second in which so many requests came
	int64_t requests;
} cau_dds_writer;

// A writer that stopped being alive.
typedef struct cau_dds_silenced {
	struct cau_dds_silenced *next;
	dds_entity_t reader;
	dds_instance_handle_t handle;
} cau_dds_silenced;

// A reader or writer of somebody else's, of a topic that may be one of ours; peers.c.
typedef struct cau_dds_peer {
	struct cau_dds_peer *next;
	dds_instance_handle_t handle;
	bool writes;
	bool told; // that it is incompatible
	dds_guid_t participant;
	char *topic, *type; // malloc'ed
	dds_qos_t *qos;     // its own
} cau_dds_peer;

// A client's hold on one tool.
typedef struct cau_dds_hand {
	struct cau_dds_hand *next;     // on this tool
	struct cau_dds_hand *next_own; // of this client
	cau_dds_client *client;
	cau_dds_session *session;
	cau_dds_tool *tool;
	cau_motion_past past;
	double jaw;
	double claim_until_s;            // its claim waits in the session's queue
	bool energy_ready, energy_asked; // the level was 0; energy was asked for
	bool grasp_asked;
} cau_dds_hand;

// A motion that a writer asks for.
typedef struct cau_dds_motion {
	cau_pose pose;
	double jaw;
	uint64_t sequence;
	int64_t source_time_ns; // 0: unknown
} cau_dds_motion;

// An answer on its way from a worker or the store's thread; mailbox.c.
typedef struct cau_dds_post {
	struct cau_dds_post *next;
	uint64_t ticket; // whose answer
	cau_method method;
	bool failed;
	int32_t code; // of the failure: CAU_RPC_*; 0: the status's own
	cau_error error;
	size_t text_bytes;
	cau_hosted *joined; // shared, may be NULL
	int32_t stream;
	char text[]; // the whole JSON-RPC answer
} cau_dds_post;

// A request that waits for its answer; replies.c.
typedef struct cau_dds_request {
	bool used;
	uint64_t ticket; // of the answer; 0: answered at once
	dds_guid_t writer;
	uint64_t participant; // its handle
	uint64_t number;
	cautery_SessionOperation operation;
	char session[CAU_NAME_BYTES];
} cau_dds_request;

// The writer of a session that has ended, and its publisher; farewells.c.
typedef struct cau_dds_farewell {
	struct cau_dds_farewell *next;
	dds_entity_t publisher, writer;
	double until_s;
} cau_dds_farewell;

// Entities of Cyclone: opened with the transport, then never changed. Any thread may use them.
typedef struct cau_dds_entities {
	dds_entity_t domain, participant, subscriber, publisher; // of the default partition
	dds_entity_t topics[TOPIC_COUNT];
	dds_entity_t waitset;
} cau_dds_entities;

// Why the DDS thread is to look again, and at which sessions; atomic, any thread. mailbox.c.
typedef struct cau_dds_wakeup {
	dds_entity_t guard; // wakes the thread; opened with the transport
	atomic_bool ending, roles_changed, sessions_changed, sliced, answered, fell_silent,
		peers_changed;
	cau_dds_bits marked, read; // sessions to be followed; sessions that have readers
} cau_dds_wakeup;

// Deliveries of other threads to the DDS thread, under the lock `mutex`; mailbox.c.
typedef struct cau_dds_mailbox {
	pthread_mutex_t mutex;
	cau_dds_post *first, *last;
	cau_dds_silenced *silenced;
	cau_dds_roles *roles; // to be taken over; NULL: none
} cau_dds_mailbox;

// Numbers for the metrics: written by the DDS thread, read by any; atomic.
typedef struct cau_dds_counts {
	atomic_ullong clients, denied, evicted, incompatible;
} cau_dds_counts;

// Requests for sessions and their replies; the DDS thread's. control.c, replies.c.
typedef struct cau_dds_control {
	dds_entity_t subscriber, publisher, reply_writer;
	cau_door door;
	cau_dds_request requests[REQUESTS_MOST];
} cau_dds_control;

// Readers and writers of other programs in the domain; the DDS thread's. peers.c.
typedef struct cau_dds_peers {
	dds_entity_t writers, readers; // of DDS's built-in topics, which list them
	cau_dds_peer *first;
	bool ends_changed; // there are new readers and writers of ours
	double told_s;     // the second in which so many were logged
	int told;
} cau_dds_peers;

// Clients that hold a place; the DDS thread's. places.c.
typedef struct cau_dds_places {
	cau_dds_client *clients; // the newest first
	uint64_t last_connection;
	uint64_t denials; // since they were last logged
	double denials_told_s;
} cau_dds_places;

// Matched writers, by reader and handle; the DDS thread's. writers.c.
typedef struct cau_dds_writers {
	cau_dds_writer *buckets[WRITER_BUCKETS];
	double onlookers_told_s; // the second in which so many without a role to drive were logged
	int onlookers_told;
} cau_dds_writers;

struct cau_dds {
	const cau_config *config;
	cau_hub *hub;
	cau_dds_entities entities;
	pthread_t thread; // started and joined by the daemon's main thread
	bool started;

	// of any thread
	cau_dds_wakeup wakeup;
	cau_dds_mailbox mailbox;
	cau_dds_counts counts;

	// of the DDS thread
	cau_dds_roles roles;
	uint64_t last_ticket;
	cau_dds_session *sessions;
	cau_dds_farewell *farewells;
	cau_dds_control control;
	cau_dds_peers peers;
	cau_dds_places places;
	cau_dds_writers writers;
};

// NULL: it has none of this name.
static inline cau_dds_tool *cau_dds_find_tool(const cau_dds_session *session, const char *name)
{
	for (int i = 0; i < CAU_MAX_TOOLS; i++)
		if (session->tools[i].used && strcmp(session->tools[i].name, name) == 0)
			return (cau_dds_tool *)&session->tools[i];
	return NULL;
}

// ---- mailbox.c: makes the thread look again, for the reason `why`; any thread
void cau_dds_wake(cau_dds_wakeup *wakeup, atomic_bool *why);

// Makes it look at this session; any thread
void cau_dds_mark(cau_dds_wakeup *wakeup, uint32_t session);

void cau_dds_set_bit(cau_dds_bits *bits, uint32_t session);
bool cau_dds_has_bit(const cau_dds_bits *bits, uint32_t session);
// Empties `bits` into `taken`.
void cau_dds_take_bits(cau_dds_bits *bits, cau_dds_bits *taken);

// ---- outlets.c: who reads
// Opens a writer; the outlet stays where it is until that is deleted. False: it could not.
bool cau_dds_open_outlet(cau_dds_wakeup *wakeup, cau_dds_outlet *outlet, uint32_t session,
                         dds_entity_t publisher, dds_entity_t topic, const dds_qos_t *qos);
void cau_dds_close_outlet(cau_dds_outlet *outlet);
bool cau_dds_is_read(const cau_dds_outlet *outlet);
// Whether somebody new reads it, since this was last asked.
bool cau_dds_take_newcomers(cau_dds_outlet *outlet);

// ---- sessions.c: follows the hub
// Takes up sessions that are new, and lets go those that are gone.
void cau_dds_list_sessions(cau_dds *dds);
// Sessions that had a slice, what is due by the clock, and what the mailbox brought. Returns when
// to look again.
double cau_dds_serve(cau_dds *dds);
void cau_dds_close_sessions(cau_dds *dds);

// ---- mailbox.c: answers from other threads
// A reply that comes back as a post with a ticket of its own.
cau_reply cau_dds_reply(cau_dds *dds, cau_method method);
// The next post, for the caller to free with cau_dds_post_free; NULL: none.
cau_dds_post *cau_dds_next_post(cau_dds_mailbox *mailbox);
void cau_dds_post_free(cau_dds_post *post);
// Fills the C type of the method's result from a post that did not fail.
cau_status cau_dds_post_result(const cau_dds_post *post, void *result, cau_error *error);

// ---- doors.c: readers and writers
cau_status cau_dds_open_topics(cau_dds *dds, cau_error *error);
cau_status cau_dds_open_control(cau_dds *dds, cau_error *error);
cau_status cau_dds_open_session(cau_dds *dds, cau_dds_session *session);
void cau_dds_close_session(cau_dds *dds, cau_dds_session *session);
void cau_dds_open_tool(cau_dds *dds, cau_dds_session *session, cau_dds_tool *tool);
// The topics jaw/..., which exist while the tool has jaws.
void cau_dds_follow_jaws(cau_dds *dds, cau_dds_session *session, cau_dds_tool *tool, bool has_jaws);
bool cau_dds_has_jaws(const cau_tool_state *state);
void cau_dds_close_tool(cau_dds *dds, cau_dds_tool *tool);

// A reader of best effort beside the door `reliable` of this tool.
void cau_dds_open_loose(cau_dds *dds, cau_door *loose, const cau_door *reliable);

// ---- peers.c: who is in the domain
cau_status cau_dds_watch_peers(cau_dds *dds, cau_error *error);
// Looks at who came, and at all when there are new ends of ours: opens doors of best effort, tells
// once of each that cannot be matched.
void cau_dds_look_at_peers(cau_dds *dds);
void cau_dds_forget_peers(cau_dds_peers *peers);

// ---- farewells.c: last samples on their way
// Takes `publisher`, which goes once the readers of its `writer` have what that wrote last.
void cau_dds_bid_farewell(cau_dds_farewell **farewells, dds_entity_t publisher,
                          dds_entity_t writer);
// Deletes those that are done. Returns when to look again.
double cau_dds_end_farewells(cau_dds_farewell **farewells, double now_s);
// Waits for all of them: two seconds at most.
void cau_dds_await_farewells(cau_dds_farewell **farewells);

// ---- writers.c: who writes
// The writer behind a sample, or NULL: it is gone, or memory ran out.
cau_dds_writer *cau_dds_writer_of(cau_dds *dds, const cau_door *door, dds_instance_handle_t handle);
// The writer with this GUID (all 0: any) of a participant, among those that the door has matched.
cau_dds_writer *cau_dds_find_writer(cau_dds *dds, const cau_door *door, uint64_t participant,
                                    const uint8_t guid[16]);
// Forgets writers that no longer match the reader, and clients without writers.
void cau_dds_prune(cau_dds *dds, dds_entity_t reader, bool all);
// For a reader: notes each writer that stops being alive. The caller deletes the listener.
dds_listener_t *cau_dds_listen_to_liveliness(cau_dds *dds);
// Those that were noted did not assert their liveliness within the lease that they offer: energy
// off, and their clients give up what they drive. They may claim tools again when they write again.
void cau_dds_end_silenced(cau_dds *dds);

// ---- places.c: who may drive
cau_status cau_dds_check_role(const cau_dds_writer *writer, cau_error *error);
uint64_t cau_dds_places_most(const cau_config *config); // of clients
// The writer's client, or itself while it has no place.
const cau_asker *cau_dds_asker_of(const cau_dds_writer *writer);
// Makes the writer one of the client whose it is, if that has a place.
void cau_dds_join_place(const cau_dds_places *places, cau_dds_writer *writer);
// The writer is gone; so is its client if it was the last.
void cau_dds_leave_place(cau_dds *dds, cau_dds_writer *writer);
// The writer's client; makes one by the quotas. Who `drives_now` gets a place in any case, if need
// be that of somebody who drives nothing. CAU_LIMIT (NULL): it got none, which is counted and
// logged.
cau_dds_client *cau_dds_admit(cau_dds *dds, cau_dds_writer *writer, bool drives_now,
                              cau_error *error);
void cau_dds_give_up(cau_dds_client *client);
// NULL: it has none.
cau_dds_hand *cau_dds_find_hand(const cau_dds_client *client, const cau_dds_tool *tool);
// The same, made if it has none; as cau_dds_admit.
cau_dds_hand *cau_dds_take_hand(cau_dds *dds, cau_dds_writer *writer, cau_dds_session *session,
                                cau_dds_tool *tool, bool drives_now, cau_error *error);
// The tool is gone.
void cau_dds_drop_hands(cau_dds_tool *tool);

// The client loses its place, energy off; its writers may ask for another.
void cau_dds_end_place(cau_dds *dds, cau_dds_client *client);

// ---- reload.c: takes over roles that were read anew
void cau_dds_take_roles(cau_dds *dds);

// ---- orders.c: orders of a hand
// Of its client; NULL: memory ran out.
cau_order *cau_dds_make_order(const cau_dds_hand *hand, cau_order_kind kind, cau_method method);
// Takes the order; false: the session refused it, which is logged.
bool cau_dds_submit(const cau_dds_hand *hand, cau_order *order);
bool cau_dds_order_command(const cau_dds_hand *hand, int kind, cau_method method, bool on);
// Energy on, for as many ticks (0 or less: no limit).
bool cau_dds_order_energy(const cau_dds_hand *hand, int32_t ticks);
// False: the session refused it, and has counted it.
bool cau_dds_order_move(const cau_dds_hand *hand, const cau_pose *pose, double jaw,
                        uint64_t sequence);
// Gives up the tool of a hand, through the queue: to nobody, or to `to`.
bool cau_dds_hand_over(cau_dds_hand *hand, const cau_asker *to);
// Energy off by order of `by`; if somebody drives the tool over DDS it stays where it is, and wants
// a level that falls and rises before energy comes on.
void cau_dds_stop_tool(cau_dds_session *session, cau_dds_tool *tool, const cau_asker *by);
// The tool may be moved again: its driver is not called silent for the time when it could not.
void cau_dds_restart_tool(cau_dds_tool *tool);

// ---- refusals.c
void cau_dds_refuse(cau_dds_session *session, const char *tool, const cau_dds_writer *writer,
                    uint64_t sequence, const cau_error *error);
// Counts what the native door did not let in.
void cau_dds_count_dropped(cau_dds_session *session);

// ---- drive.c: from samples to orders
// Checks and submits a motion; feeds the watchdog if all is well. NULL: refused, and counted.
cau_dds_hand *cau_dds_move(cau_dds *dds, const cau_door *door, cau_dds_tool *tool,
                           cau_dds_writer *writer, cau_dds_motion motion);
void cau_dds_energy(cau_dds_hand *hand, const cau_dds_writer *writer, bool level, int32_t ticks);
void cau_dds_grasp(cau_dds_hand *hand, bool level);

// ---- native.c, settings.c, ros2.c: samples
void cau_dds_take_command(cau_dds *dds, cau_door *door, cau_dds_writer *writer, const void *sample);
void cau_dds_take_setting(cau_dds *dds, cau_door *door, cau_dds_writer *writer, const void *sample);
void cau_dds_take_instrument(cau_dds *dds, cau_door *door, cau_dds_writer *writer,
                             const void *sample);
void cau_dds_take_servo_cp(cau_dds *dds, cau_door *door, cau_dds_writer *writer,
                           const void *sample);
void cau_dds_take_servo_jp(cau_dds *dds, cau_door *door, cau_dds_writer *writer,
                           const void *sample);
void cau_dds_take_energize(cau_dds *dds, cau_door *door, cau_dds_writer *writer,
                           const void *sample);

// ---- control.c
// Counts what the writer asks for. Whether it is more than a WebSocket connection may in a second.
bool cau_dds_is_too_fast(const cau_config *config, cau_dds_writer *writer);
void cau_dds_take_request(cau_dds *dds, cau_door *door, cau_dds_writer *writer, const void *sample);

// ---- replies.c: each but the first two answers the request and forgets it
cau_dds_request cau_dds_describe_request(const cau_dds_writer *writer,
                                         const cautery_SessionRequest *sample);
cau_dds_request *cau_dds_keep_request(cau_dds_control *control, const cau_dds_writer *writer,
                                      const cautery_SessionRequest *sample); // NULL: too many
void cau_dds_reply_fail(const cau_dds_control *control, cau_dds_request *request,
                        const cau_error *error, int32_t code);
void cau_dds_reply_join(const cau_dds_control *control, cau_dds_request *request,
                        const cau_wire_session_summary *summary);
void cau_dds_reply_list(cau_dds *dds, cau_dds_request *request);
void cau_dds_reply_post(cau_dds *dds, const cau_dds_post *post);
// The requester is gone: its replies are kept for nobody.
void cau_dds_forget_replies(const cau_dds_control *control, const dds_guid_t *writer);

// ---- operating.c
void cau_dds_take_state_command(cau_dds *dds, cau_door *door, cau_dds_writer *writer,
                                const void *sample);
// Whether CRTK's state lets the tool be moved and energized.
cau_status cau_dds_check_ready(const cau_dds_session *session, const char *tool, cau_error *error);
void cau_dds_publish_operating(cau_dds_session *session);

// ---- states.c
// Writes the states of tools that have changed, and those that newcomers have not got. What nobody
// reads is kept for late joiners, a second old at most.
void cau_dds_publish(cau_dds_session *session, const cau_hosted_tool *tools, int32_t count,
                     uint64_t tick, double time_s, double now_s);
// When they are to be looked at again.
double cau_dds_states_due(const cau_dds_session *session);
// Disposes the state of a tool that is removed.
void cau_dds_unpublish(const cau_dds_session *session, const char *tool);

// ---- status.c
// Writes the status if it changed. Returns when to look again.
double cau_dds_publish_status(cau_dds_session *session, double now_s);
void cau_dds_fill_status(cautery_SessionStatus *status, const cau_wire_session_summary *summary,
                         uint32_t number, const cau_hosted_counts *counts);

// ---- frames.c
// Joins, leaves, writes what is new. Returns when to look again.
double cau_dds_serve_frames(cau_dds *dds, cau_dds_session *session, double now_s);
// A post with the ticket of the session's join; takes what it joined.
void cau_dds_joined(cau_dds_session *session, cau_dds_post *post);
void cau_dds_leave_frames(cau_dds_session *session);
