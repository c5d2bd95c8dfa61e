// SPDX-License-Identifier: GPL-3.0-or-later
// Shared by all parts of the simulation: clients, their requests, sessions and daemons.
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "simulation/disk.h"
#include "simulation/network.h"
#include "simulation/scheduler.h"

enum {
	CLIENTS = 4,
	COURIERS = 2, // connections of the courier; they follow the CLIENTS in the list of clients
	SESSIONS = 3,
	TOOLS = 2, // tools of the scene
	REQUESTS_MOST = 1 << 14,
	GRAVITIES_MOST = 4096,
	NAME_MOST = 49,
	EVERY_CLIENT = -1,
};

extern const char *const sim_tools[TOOLS];

// ---- profile of a run, made from the seed
typedef struct sim_profile {
	int64_t length_ns; // duration of the workload
	int workers;
	int64_t step_least_ns, step_most_ns; // duration of a step of the core
	int64_t latency_most_ns;             // longest delay of a message
	int64_t queue_commands, subscriber_bytes, store_bytes;
	double checkpoint_s;
	bool tokens; // clients have tokens with different rights
	sim_roughness roughness;
} sim_profile;

sim_profile sim_profile_of(uint64_t seed);

// ---- requests
typedef enum ask {
	ASK_HELLO,
	ASK_CREATE,
	ASK_DESTROY,
	ASK_TAKE,
	ASK_ON,
	ASK_OFF,
	ASK_HAND_OVER,
	ASK_REMOVE,
	ASK_GRAVITY,
	ASK_PAUSE,
	ASK_RESUME,
	ASK_STEP,
	ASK_ADVANCE,
	ASK_REWIND,
	ASK_RESET,
	ASK_SNAPSHOT,
	ASK_JOIN,
	ASK_KEY_FRAME,
	ASK_LIST,
	ASK_MOVING, // requests that move a session
	ASK_OTHER,
} ask;

typedef struct sim_request {
	ask what;
	int client, session, tool; // -1 if the request concerns none
	int life;                  // number of the session among all sessions of its name
	int64_t sequence;          // client_sequence; 0: the request has none
	int gravity;               // only for ASK_GRAVITY: number of the gravity
	int ticks;                 // only for ASK_ADVANCE: number of ticks
	uint64_t first;            // number of the original of a resent request; 0: not resent
	int connection, machine;   // connection: number of the client's connection, in order
	int64_t sent_ns, arriving_ns, answered_ns;
	bool later; // the request waits for a tick, so its answer may wait while the session is paused
	bool met;   // the request's session existed when the request arrived
	bool arrived, answered, ok, unstored;
	char *method, *params; // copies for resending
	char *result;          // text of the result
} sim_request;

typedef struct sim_client {
	int index;
	char client_id[16], resume[65];
	sim_link *link; // NULL if not connected
	int machine;
	int connection; // number of the present connection, in order
	bool greeted, beats, visible;
	uint32_t number; // the daemon's number of the client
	int64_t sequence, beat_ns;
	bool clocked;           // the client's heartbeats have the time of sending
	bool clock_counts;      // the daemon knows the client's clock
	int64_t clock_ahead_ns; // difference to the daemons' clock, ns
	int64_t late_until_ns;  // the client's messages are held back until this time
	// latest time at which the client was alive, as far as a daemon can know
	int64_t heard_ns;
	bool reads;       // the client reads its messages
	int64_t reads_ns; // time when the client began to read
	uint64_t newest;  // newest request that changes something, for resending; 0: no such request
	struct stream *streams[SESSIONS];
} sim_client;

extern sim_client sim_clients[CLIENTS + COURIERS];
extern sim_request sim_requests[REQUESTS_MOST];
extern int sim_request_count;

void clients_begin(uint64_t seed, const sim_profile *profile);
void clients_connect(int client, int machine);
void clients_cut(int client);
// True if the client's token allows this request in this session (-1: in no session).
bool clients_may(int client, ask what, int session);
// expensive requests a minute that the client's token allows; 0: no limit
int clients_quota(int client);
void clients_beat(void); // sends the heartbeats that are due
int64_t clients_beat_due(void);
void clients_show(int client, bool visible);
void clients_late(int client, int64_t ns); // holds the client's messages back for `ns`
void clients_read(int client, bool reads, int frames);
// Sends a request and returns its number, or 0 if the client has no connection. `params` has no
// session and no client_sequence, and may be "".
uint64_t clients_ask(int client, ask what, const char *method, int session, int tool, bool changes,
                     const char *params);
void clients_notify(int client, const char *method, const char *params);
void clients_send_again(int client);
// Copies the text between `"name":"` and the next quote, or the value after `"name":`, from its
// first occurrence in the text.
bool clients_member(const char *text, const char *name, char *out, size_t capacity);
sim_request *clients_request(uint64_t number);

// ---- sessions, by index
typedef struct sim_session {
	int life;       // number of times that a session of this name was created
	int machine;    // machine that should have the session
	bool made;      // the session's creation was answered
	bool wanted;    // the session was created and not destroyed
	bool moving;    // a courier moves the session
	bool ephemeral; // the session is not on the disk, and ends with its creator
} sim_session;

extern sim_session sim_sessions[SESSIONS];
void sim_session_name(int session, char name[NAME_MOST]);
void sim_session_id(int session, int machine, char id[NAME_MOST]);
int sim_session_of(const char *id); // returns the index of a present session, or -1

// ---- daemons
void daemons_begin(const sim_profile *profile);
void daemons_start(int machine);            // starts soon
void daemons_end(int machine);              // drains soon
void daemons_kill(int machine, bool power); // kills at once
bool daemons_up(int machine);
bool daemons_down(int machine);
const char *daemons_trouble(int machine); // reason of the last failed start
int daemons_boots(int machine);
const char *daemons_label(int machine);

// ---- streams
void streams_begin(const sim_profile *profile);
void streams_acknowledge(void); // sends the due acknowledgements
void streams_ack_arriving(int client, const char *text);
void streams_joined(int client, int session, const char *result);
void streams_frame(int client, const unsigned char *bytes, size_t count);
void streams_key_asked(int client, int session); // the daemon is about to read the request
void streams_forget(int client);
