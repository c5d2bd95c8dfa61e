// SPDX-License-Identifier: GPL-3.0-or-later
// Shared declarations of transport_dds. Each part of the transport states its thread or its lock.
#pragma once

#include <dds/dds.h>
#include <pthread.h>
#include <stdatomic.h>
#include <string.h>

#include "cautery.h"
#include "cautery/messages.h"
#include "clock/clock.h"
#include "hosted_session/hosted.h"
#include "hub/hub.h"
#include "log/log.h"
#include "transport_dds/checks.h"
#include "transport_dds/dds_transport.h"
#include "transport_dds/roles.h"

enum {
	WRITER_BUCKETS = 1024,
	REQUESTS_MOST = 256,       // largest number of requests that wait for an answer
	REQUESTS_OF_ONE_MOST = 64, // largest number of such requests of one participant
	TOPIC_BYTES = 2 * CAU_NAME_BYTES + 32,
};

// Native topics, opened once for the participant; doors.c has their names. cautery/tool_command,
// cautery/tool_setting and cautery/tool_instrument are opened once for each session, because a
// topic has one filter.
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
	DOOR_NATIVE,   // for cautery/tool_command
	DOOR_SERVO_CP, // for rt/SESSION/TOOL/..., like the next three
	DOOR_SERVO_JP,
	DOOR_ENERGIZE,
	DOOR_STATE_COMMAND,
	DOOR_SETTING,    // for cautery/tool_setting
	DOOR_INSTRUMENT, // for cautery/tool_instrument
	DOOR_REQUEST,    // for cautery/session_request; belongs to no session
} cau_door_kind;

struct cau_dds_session;

// A reader. `tool` is empty for DOOR_NATIVE, because native samples name their tool.
typedef struct cau_door {
	cau_door_kind kind;
	// a second reader of the topic beside the reliable one; it ignores reliable writers
	bool best_effort;
	dds_entity_t topic, reader; // 0 if closed
	dds_entity_t samples;       // DDS read condition: there are samples to take
	struct cau_dds_session *session;
	char tool[CAU_NAME_BYTES];
} cau_door;

typedef enum cau_dds_operating_state {
	OPERATING_NOTHING, // the initial value: no state has been published yet
	OPERATING_DISABLED,
	OPERATING_ENABLED,
	OPERATING_PAUSED,
	OPERATING_FAULT,
} cau_dds_operating_state;

// A writer of this daemon that counts its readers; outlets.c.
typedef struct cau_dds_outlet {
	struct cau_dds_wakeup *wakeup;
	uint32_t session; // the session's number
	dds_entity_t writer;
	atomic_uint readers;   // number of matched readers now
	atomic_bool newcomers; // readers came since the last check and need the present state
} cau_dds_outlet;

// A set of sessions: bit N is for all sessions whose number modulo BITS_MOST is N. Sessions that
// share a bit are in the set together.
enum { BITS_WORDS = 32, BITS_MOST = 64 * BITS_WORDS };
typedef struct cau_dds_bits {
	atomic_ullong words[BITS_WORDS];
} cau_dds_bits;

// A tool's operating state as CRTK defines it; operating.c.
typedef struct cau_dds_operating {
	cau_dds_operating_state state;
	bool unhomed;
} cau_dds_operating;

typedef struct cau_dds_tool {
	bool used, seen;
	char name[CAU_NAME_BYTES];
	// closed if another tool or session has the ROS 2 name
	cau_door servo_cp, servo_jp, energize, state_command;
	cau_door loose_cp, loose_jp; // best-effort readers; open once a best-effort writer exists
	dds_entity_t pose_topic, asked_topic, force_topic, raw_force_topic, jaw_topic, asked_jaw_topic;
	cau_dds_outlet pose, asked, force;              // for measured_cp, setpoint_cp, measured_cf
	cau_dds_outlet raw_force;                       // for raw/measured_cf
	cau_dds_outlet jaw, asked_jaw;                  // for jaw/measured_js, jaw/setpoint_js
	dds_entity_t operating_topic, operating_writer; // for operating_state
	cau_dds_operating operating, operating_told;
	struct cau_dds_hand *hands;
	int hand_count;
} cau_dds_tool;

// The stream of a session's frames; frames.c. Joined while the frames have readers.
typedef struct cau_dds_stream {
	cau_dds_outlet topology, key, delta;
	uint64_t ticket; // ticket of a join on its way; 0: no join
	double retry_s;  // after a refused join: time of the next attempt
	bool joined;
	cau_wire_stream_description description;
	cau_subscriber chain; // every delta, and the key frames that repair the chain of deltas
	cau_subscriber keys;  // key frames outside the chain
	bool key_wanted;      // a new reader or a request needs a key frame
	bool key_forced;      // a key frame is needed even if the newest state already had one
	double key_due_s;
	uint64_t key_epoch, key_sequence; // epoch and sequence of the last key frame written
} cau_dds_stream;

// The last published status of a session; status.c.
typedef struct cau_dds_status {
	cau_wire_session_summary summary;
	cau_hosted_counts counts;
	double written_s; // 0: never written
} cau_dds_status;

typedef struct cau_dds_session {
	struct cau_dds_session *next;
	cau_hosted *hosted; // a shared reference
	bool seen;
	char ros_name[CAU_NAME_BYTES];
	bool has_ros_name;
	dds_entity_t subscriber, publisher; // with the session's partition
	cau_door native, setting, instrument;
	cau_dds_keys keys; // instances that the three readers above accept
	dds_entity_t status_writer;
	cau_dds_outlet state, grasp, power, force;
	cau_hosted_tool states[CAU_MAX_TOOLS]; // each tool's last published state
	uint64_t states_tick;
	double states_s; // when states without readers were last written
	// the tool's state has changed, by more than the tick, since it was written
	bool states_owed[CAU_MAX_TOOLS];
	// time of the next check, whether the session had a slice or not
	double look_s;
	cau_dds_stream stream;
	cau_dds_status status;
	cau_dds_tool tools[CAU_MAX_TOOLS];
	// Refusals, logged once a second:
	int64_t refused;
	// dropped samples are not logged yet, and maybe no other event will cause a log line
	bool drops_untold;
	double refused_told_s;
} cau_dds_session;

// A DDS client of the hub. Each native writer is a client; all ROS 2 writers of a participant are
// one client. places.c.
typedef struct cau_dds_client {
	struct cau_dds_client *next;
	uint64_t identity; // identity of the publication (native) or of the participant (ROS 2)
	bool native;
	uint64_t participant;
	// subject name that the participant has proved; "": no name
	char subject[CAU_DDS_SUBJECT_BYTES];
	int32_t writers;     // number of its matched writers
	bool accepted;       // a motion of this client was accepted
	uint64_t connection; // connection number for the hub
	double alive_s;      // monotonic time of the newest sign of life; 0: none yet
	cau_asker asker;
	struct cau_dds_hand *hands;
} cau_dds_client;

// A writer that matches one of our readers; writers.c.
typedef struct cau_dds_writer {
	struct cau_dds_writer *next; // next in the same bucket
	dds_entity_t reader;
	dds_instance_handle_t handle;
	bool native, reliable;
	uint64_t identity, participant; // as in its cau_dds_client
	dds_guid_t guid;
	char subject[CAU_DDS_SUBJECT_BYTES];
	cau_asker asker;        // without a client number; the client's asker has it
	cau_dds_client *client; // NULL if it is not a client
	cau_sign_of_life sign;  // sign of life by the source timestamps of its samples
	double retry_s;         // the writer may not become a client before this time, after a denial
	double requests_s;      // start of the second to which `requests` belongs
	int64_t requests;
} cau_dds_writer;

// A writer that has stopped being alive.
typedef struct cau_dds_silenced {
	struct cau_dds_silenced *next;
	dds_entity_t reader;
	dds_instance_handle_t handle;
} cau_dds_silenced;

// A reader or writer of another program, whose topic may be one of ours; peers.c.
typedef struct cau_dds_peer {
	struct cau_dds_peer *next;
	dds_instance_handle_t handle;
	bool writes;
	bool told; // its incompatibility has been logged
	dds_guid_t participant;
	char *topic, *type; // malloc'ed
	dds_qos_t *qos;     // its own QoS
} cau_dds_peer;

// A client's relation to one tool that it has asked to drive.
typedef struct cau_dds_hand {
	struct cau_dds_hand *next;     // next hand on this tool
	struct cau_dds_hand *next_own; // next hand of this client
	cau_dds_client *client;
	cau_dds_session *session;
	cau_dds_tool *tool;
	cau_motion_past past;
	double jaw;
	// until this time its claim may be waiting in the session's queue
	double claim_until_s;
	// energy_ready: the level was 0; energy_asked: energy was requested
	bool energy_ready, energy_asked;
	bool grasp_asked;
} cau_dds_hand;

// A motion that a writer requests.
typedef struct cau_dds_motion {
	cau_pose pose;
	double jaw;
	uint64_t sequence;
	int64_t source_time_ns; // 0 if unknown
} cau_dds_motion;

// An answer on its way from a worker or the store thread; mailbox.c.
typedef struct cau_dds_post {
	struct cau_dds_post *next;
	uint64_t ticket; // identifies the request or join
	cau_method method;
	bool failed;
	int32_t code; // CAU_RPC_* of the failure; 0: the code of the status
	cau_error error;
	size_t text_bytes;
	cau_hosted *joined; // shared reference to the joined session; may be NULL
	int32_t stream;
	char text[]; // the whole JSON-RPC answer
} cau_dds_post;

// A request that waits for its answer; replies.c.
typedef struct cau_dds_request {
	bool used;
	uint64_t ticket; // ticket of the answer; 0: the request is answered at once
	dds_guid_t writer;
	uint64_t participant; // the participant's handle
	uint64_t number;
	cautery_SessionOperation operation;
	char session[CAU_NAME_BYTES];
} cau_dds_request;

// The writer of an ended session, and its publisher; outlets.c.
typedef struct cau_dds_farewell {
	struct cau_dds_farewell *next;
	dds_entity_t publisher, writer;
	double until_s;
} cau_dds_farewell;

// Cyclone's entities. They are opened with the transport and never change afterwards. Any thread
// may use them.
typedef struct cau_dds_entities {
	// subscriber and publisher are of the default partition
	dds_entity_t domain, participant, subscriber, publisher;
	dds_entity_t topics[TOPIC_COUNT];
	dds_entity_t waitset;
} cau_dds_entities;

// The reasons for the DDS thread to look again, and the sessions to look at. Atomic; any thread may
// set them. mailbox.c.
typedef struct cau_dds_wakeup {
	dds_entity_t guard; // DDS guard condition that wakes the thread; opened with the transport
	atomic_bool ending, roles_changed, sessions_changed, sliced, answered, fell_silent,
		peers_changed;
	cau_dds_bits marked, read; // marked: sessions to look at; read: sessions that have readers
} cau_dds_wakeup;

// Deliveries from other threads to the DDS thread, guarded by `mutex`; mailbox.c.
typedef struct cau_dds_mailbox {
	pthread_mutex_t mutex;
	cau_dds_post *first, *last;
	cau_dds_silenced *silenced;
	cau_dds_roles *roles; // new roles for the DDS thread; NULL: no new roles
} cau_dds_mailbox;

// Counts for the metrics. The DDS thread writes them, any thread reads them.
typedef struct cau_dds_counts {
	atomic_ullong clients, denied, evicted, incompatible;
} cau_dds_counts;

// Requests for sessions and their replies; only the DDS thread uses this. control.c, replies.c.
typedef struct cau_dds_control {
	dds_entity_t subscriber, publisher, reply_writer;
	cau_door door;
	cau_dds_request requests[REQUESTS_MOST];
} cau_dds_control;

// Readers and writers of other programs in the domain; only the DDS thread uses this. peers.c.
typedef struct cau_dds_peers {
	// readers of DDS's built-in topics, which list all writers and readers
	dds_entity_t writers, readers;
	cau_dds_peer *first;
	bool ends_changed; // we have new readers or writers, so check all peers again
	double told_s;     // start of the second in which `told` log lines were written
	int told;
} cau_dds_peers;

// Clients and their limits; places.c. Only the DDS thread uses this.
typedef struct cau_dds_places {
	cau_dds_client *clients; // newest first
	uint64_t last_connection;
	uint64_t denials; // denials since the last log line
	double denials_told_s;
} cau_dds_places;

// Matched writers, by reader and handle; only the DDS thread uses this. writers.c.
typedef struct cau_dds_writers {
	cau_dds_writer *buckets[WRITER_BUCKETS];
	// start of the second to which `onlookers_told` belongs: the number of log lines about writers
	// whose role may not drive
	double onlookers_told_s;
	int onlookers_told;
} cau_dds_writers;

struct cau_dds {
	const cau_config *config;
	cau_hub *hub;
	cau_dds_entities entities;
	pthread_t thread; // the daemon's main thread starts and joins it
	bool started;

	// used by any thread
	cau_dds_wakeup wakeup;
	cau_dds_mailbox mailbox;
	cau_dds_counts counts;

	// used by the DDS thread only
	cau_dds_roles roles;
	uint64_t last_ticket;
	cau_dds_session *sessions;
	cau_dds_farewell *farewells;
	cau_dds_control control;
	cau_dds_peers peers;
	cau_dds_places places;
	cau_dds_writers writers;
};

// Returns the session's tool of this name; NULL if there is none.
static inline cau_dds_tool *cau_dds_find_tool(const cau_dds_session *session, const char *name)
{
	for (int i = 0; i < CAU_MAX_TOOLS; i++)
		if (session->tools[i].used && strcmp(session->tools[i].name, name) == 0)
			return (cau_dds_tool *)&session->tools[i];
	return NULL;
}

// ---- mailbox.c: wakes the DDS thread
void cau_dds_wake(cau_dds_wakeup *wakeup, atomic_bool *why);

// Makes the DDS thread look at this session. Any thread may call it.
void cau_dds_mark(cau_dds_wakeup *wakeup, uint32_t session);

void cau_dds_set_bit(cau_dds_bits *bits, uint32_t session);
bool cau_dds_has_bit(const cau_dds_bits *bits, uint32_t session);
// Moves all bits into `taken` and clears `bits`.
void cau_dds_take_bits(cau_dds_bits *bits, cau_dds_bits *taken);

// ---- domain.c
// Opens the domain and the daemon's participant.
cau_status cau_dds_open_domain(cau_dds_entities *entities, const cau_config *config,
                               cau_error *error);
// Closes everything in the domain. Cyclone wakes its receiving thread with a packet to itself and
// waits for that thread. If the network interface is gone, the packet is lost, and Cyclone would
// wait for ever. So this function waits only for a while. The domain then stays open until the
// process ends, and a log line reports this.
void cau_dds_leave(dds_entity_t domain);

// ---- security.c
// Adds the identity in the folder config->dds_security to the participant's QoS. Adds nothing if
// the setting is empty. Returns CAU_NOT_FOUND if one of its files cannot be read.
cau_status cau_dds_secure(dds_qos_t *qos, const cau_config *config, cau_error *error);

// ---- outlets.c: writers that count their readers
// Opens a writer. The outlet must not move in memory until the writer is deleted. Returns false on
// failure.
bool cau_dds_open_outlet(cau_dds_wakeup *wakeup, cau_dds_outlet *outlet, uint32_t session,
                         dds_entity_t publisher, dds_entity_t topic, const dds_qos_t *qos);
void cau_dds_close_outlet(cau_dds_outlet *outlet);
bool cau_dds_is_read(const cau_dds_outlet *outlet);
// True if the outlet has a new reader since the last call.
bool cau_dds_take_newcomers(cau_dds_outlet *outlet);

// ---- sessions.c: follows the hub
// Opens what new sessions need, and closes what ended sessions had.
void cau_dds_list_sessions(cau_dds *dds);
// Serves the sessions that had a slice, everything that is due by time, and the mailbox. Returns
// the time of the next check.
double cau_dds_serve(cau_dds *dds);
void cau_dds_close_sessions(cau_dds *dds);

// ---- mailbox.c: answers from other threads
// Returns a reply whose answer arrives as a post, with a ticket of its own.
cau_reply cau_dds_reply(cau_dds *dds, cau_method method);
// Returns the next post, NULL if there is none. The caller frees it with cau_dds_post_free.
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
// Opens or closes the topics jaw/..., which exist while the tool has jaws.
void cau_dds_follow_jaws(cau_dds *dds, cau_dds_session *session, cau_dds_tool *tool, bool has_jaws);
bool cau_dds_has_jaws(const cau_tool_state *state);
void cau_dds_close_tool(cau_dds *dds, cau_dds_tool *tool);

// Opens a best-effort reader beside the door `reliable` of this tool.
void cau_dds_open_loose(cau_dds *dds, cau_door *loose, const cau_door *reliable);

// ---- peers.c: readers and writers of other programs
// Returns DDS's name of the first policy of which the writer offers less than the reader requests;
// NULL if there is no such policy. Reliability is checked last. A policy that a QoS does not set
// has DDS's default.
const char *cau_dds_mismatch(const dds_qos_t *offered, const dds_qos_t *requested);
cau_status cau_dds_watch_peers(cau_dds *dds, cau_error *error);
// Checks new peers, or all peers if we have new readers or writers. Opens best-effort readers. Logs
// each peer that cannot be matched, once.
void cau_dds_look_at_peers(cau_dds *dds);
void cau_dds_forget_peers(cau_dds_peers *peers);

// ---- outlets.c: last samples of ended sessions
// Takes over `publisher`. Deletes it when all readers of its `writer` have the last sample.
void cau_dds_bid_farewell(cau_dds_farewell **farewells, dds_entity_t publisher,
                          dds_entity_t writer);
// Deletes the writers that are done. Returns the time of the next check.
double cau_dds_end_farewells(cau_dds_farewell **farewells, double now_s);
// Waits until all farewells are done, at most two seconds.
void cau_dds_await_farewells(cau_dds_farewell **farewells);

// ---- writers.c: writers that our readers have matched
// Returns the writer of a sample; NULL if it is gone or memory ran out.
cau_dds_writer *cau_dds_writer_of(cau_dds *dds, const cau_door *door, dds_instance_handle_t handle);
// Finds the participant's writer with this GUID (all 0: any), among those that the door has
// matched.
cau_dds_writer *cau_dds_find_writer(cau_dds *dds, const cau_door *door, uint64_t participant,
                                    const uint8_t guid[16]);
// Forgets writers that no longer match the reader, and clients without writers.
void cau_dds_prune(cau_dds *dds, dds_entity_t reader, bool all);
// Returns a listener for a reader that notes each writer that stops being alive. The caller deletes
// it.
dds_listener_t *cau_dds_listen_to_liveliness(cau_dds *dds);
// Ends the noted writers, which did not assert their liveliness within the lease that they offer.
// Turns their energy off; their clients give up their tools. They may claim tools again with their
// next samples.
void cau_dds_end_silenced(cau_dds *dds);

// ---- places.c: limits on clients and drivers
cau_status cau_dds_check_role(const cau_dds_writer *writer, cau_error *error);
uint64_t cau_dds_places_most(const cau_config *config); // largest number of clients
// Returns the asker of the writer's client, or of the writer if it is not a client.
const cau_asker *cau_dds_asker_of(const cau_dds_writer *writer);
// Adds the writer to the client that it belongs to, if that client exists.
void cau_dds_join_place(const cau_dds_places *places, cau_dds_writer *writer);
// Notes that the writer is gone. If it was its client's last writer, the client ends too.
void cau_dds_leave_place(cau_dds *dds, cau_dds_writer *writer);
// Returns the writer's client, or makes one within the limits. A writer that `drives_now` always
// becomes a client, if necessary in place of one that drives nothing. Returns NULL with CAU_LIMIT
// if the limits forbid it; this is counted and logged.
cau_dds_client *cau_dds_admit(cau_dds *dds, cau_dds_writer *writer, bool drives_now,
                              cau_error *error);
void cau_dds_give_up(cau_dds_client *client);
// Returns the client's hand on the tool; NULL if it has none.
cau_dds_hand *cau_dds_find_hand(const cau_dds_client *client, const cau_dds_tool *tool);
// Returns the writer's hand on the tool, or makes one. Errors: those of cau_dds_admit.
cau_dds_hand *cau_dds_take_hand(cau_dds *dds, cau_dds_writer *writer, cau_dds_session *session,
                                cau_dds_tool *tool, bool drives_now, cau_error *error);
// Frees all hands on a tool that is gone.
void cau_dds_drop_hands(cau_dds_tool *tool);

// Ends the client, with energy off. Its writers may become clients again.
void cau_dds_end_place(cau_dds *dds, cau_dds_client *client);

// ---- places.c: new roles
void cau_dds_take_roles(cau_dds *dds);

// ---- orders.c: orders of a hand
// Makes an order of the hand's client. Returns NULL if memory ran out.
cau_order *cau_dds_make_order(const cau_dds_hand *hand, cau_order_kind kind, cau_method method);
// Submits and frees the order. Returns false if the session refused it; this is logged.
bool cau_dds_submit(const cau_dds_hand *hand, cau_order *order);
bool cau_dds_order_command(const cau_dds_hand *hand, int kind, cau_method method, bool on);
// Turns energy on for `ticks` ticks (0 or less: no limit).
bool cau_dds_order_energy(const cau_dds_hand *hand, int32_t ticks);
// Submits a motion. Returns false if the session refused it; the session has counted this.
bool cau_dds_order_move(const cau_dds_hand *hand, const cau_pose *pose, double jaw,
                        uint64_t sequence);
// Gives up the hand's tool, through the queue. `to` becomes the driver; NULL: the tool is free.
bool cau_dds_hand_over(cau_dds_hand *hand, const cau_asker *to);
// Turns energy off by order of `by`. If a DDS client drives the tool, the tool stays where it is.
// Energy then needs a level that falls and rises again.
void cau_dds_stop_tool(cau_dds_session *session, cau_dds_tool *tool, const cau_asker *by);
// Allows the tool to be moved again. The time in which it could not move does not count as its
// driver's silence.
void cau_dds_restart_tool(cau_dds_tool *tool);

// ---- refusals.c
void cau_dds_refuse(cau_dds_session *session, const char *tool, const cau_dds_writer *writer,
                    uint64_t sequence, const cau_error *error);
// Counts the samples that the native reader did not accept.
void cau_dds_count_dropped(cau_dds_session *session);

// ---- drive.c: samples to orders
// Checks and submits a motion. Notifies the watchdog if the motion is accepted. Returns NULL if it
// was refused, which is counted.
cau_dds_hand *cau_dds_move(cau_dds *dds, const cau_door *door, cau_dds_tool *tool,
                           cau_dds_writer *writer, cau_dds_motion motion);
void cau_dds_energy(cau_dds_hand *hand, const cau_dds_writer *writer, bool level, int32_t ticks);
void cau_dds_grasp(cau_dds_hand *hand, bool level);

// ---- native.c, ros2.c: take samples
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
// Counts the writer's request. Returns true if there are more in this second than a WebSocket
// connection may send.
bool cau_dds_is_too_fast(const cau_config *config, cau_dds_writer *writer);
void cau_dds_take_request(cau_dds *dds, cau_door *door, cau_dds_writer *writer, const void *sample);

// ---- replies.c: all but the first two answer the request and forget it
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
// Disposes the replies that are kept for a requester that is gone.
void cau_dds_forget_replies(const cau_dds_control *control, const dds_guid_t *writer);

// ---- operating.c
void cau_dds_take_state_command(cau_dds *dds, cau_door *door, cau_dds_writer *writer,
                                const void *sample);
// Returns CAU_OK if CRTK's operating state allows the tool to be moved and energized.
cau_status cau_dds_check_ready(const cau_dds_session *session, const char *tool, cau_error *error);
void cau_dds_publish_operating(cau_dds_session *session);

// ---- states.c
// Writes the changed states of tools, and those that new readers have not got. If there are no
// readers, a state is kept for late joiners, at most a second old.
void cau_dds_publish(cau_dds_session *session, const cau_hosted_tool *tools, int32_t count,
                     uint64_t tick, double time_s, double now_s);
// Returns when the states must be checked again.
double cau_dds_states_due(const cau_dds_session *session);
// Disposes the state of a tool that is removed.
void cau_dds_unpublish(const cau_dds_session *session, const char *tool);

// ---- status.c
// Writes the status if it changed. Returns when it must be checked again.
double cau_dds_publish_status(cau_dds_session *session, double now_s);
void cau_dds_fill_status(cautery_SessionStatus *status, const cau_wire_session_summary *summary,
                         uint32_t number, const cau_hosted_counts *counts);

// ---- frames.c
// Joins or leaves the stream and writes new frames. Returns when to check again.
double cau_dds_serve_frames(cau_dds *dds, cau_dds_session *session, double now_s);
// Takes a post that has the ticket of the session's join, and the joined session in it.
void cau_dds_joined(cau_dds_session *session, cau_dds_post *post);
void cau_dds_leave_frames(cau_dds_session *session);
