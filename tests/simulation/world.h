// SPDX-License-Identifier: GPL-3.0-or-later
// What the parts of the simulation share: clients, their requests, sessions, daemons.
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "simulation/disk.h"
#include "simulation/network.h"
#include "simulation/scheduler.h"

enum {
	CLIENTS = 4,
	COURIERS = 2, // connections of the courier, clients behind the others
	SESSIONS = 3,
	TOOLS = 2, // of the scene
	REQUESTS_MOST = 1 << 14,
	GRAVITIES_MOST = 4096,
	NAME_MOST = 49,
	EVERY_CLIENT = -1,
};

extern const char *const sim_tools[TOOLS];

// ---- how a run is: all from the seed
typedef struct sim_profile {
	int64_t length_ns; // of the workload
	int workers;
	int64_t step_least_ns, step_most_ns; // what a step of the core takes
	int64_t latency_most_ns;             // of a message
	int64_t queue_commands, subscriber_bytes, store_bytes;
	double checkpoint_s;
	bool tokens; // clients have tokens: not all of them may do all
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
	ASK_MOVING, // of a move
	ASK_OTHER,
} ask;

typedef struct sim_request {
	ask what;
	int client, session, tool; // session, tool: -1: none
	int life;                  // of the session's name
	int64_t sequence;          // client_sequence; 0: none
	int gravity;               // GRAVITY: which
	int ticks;                 // ADVANCE: asked for
	uint64_t first;            // number of the request that this one is sent again for; 0: none
	int connection, machine;   // connection: of its client, counted
	int64_t sent_ns, arriving_ns, answered_ns;
	bool later; // it waits for a tick, so its answer may wait as long as its session is paused
	bool met;   // its session was there when it arrived
	bool arrived, answered, ok, unstored;
	char *method, *params; // to send it again
	char *result;          // text of it
} sim_request;

typedef struct sim_client {
	int index;
	char client_id[16], resume[65];
	sim_link *link; // NULL: not connected
	int machine;
	int connection; // counts
	bool greeted, beats, visible;
	uint32_t number; // as the daemon knows it
	int64_t sequence, beat_ns;
	bool clocked;           // its heartbeats say when they were sent
	bool clock_counts;      // and the daemon knows the clock
	int64_t clock_ahead_ns; // of the daemons'
	int64_t late_until_ns;  // its messages wait on their way until then
	int64_t heard_ns;       // its newest sign of life: sent by then, for all that a daemon can know
	bool reads;             // takes what comes
	int64_t reads_ns;       // since when
	uint64_t newest;        // request that changes something, to be sent again; 0: none
	struct stream *streams[SESSIONS];
} sim_client;

extern sim_client sim_clients[CLIENTS + COURIERS];
extern sim_request sim_requests[REQUESTS_MOST];
extern int sim_request_count;

void clients_begin(uint64_t seed, const sim_profile *profile);
void clients_connect(int client, int machine);
void clients_cut(int client);
// Whether its token allows that, in this session (-1: none).
bool clients_may(int client, ask what, int session);
int clients_quota(int client); // expensive requests a minute that its token allows; 0: no bound
void clients_beat(void);       // sends what heartbeats are due
int64_t clients_beat_due(void);
void clients_show(int client, bool visible);
void clients_late(int client, int64_t ns); // its messages wait on their way
void clients_read(int client, bool reads, int frames);
// The number of the request; 0: the client has no connection. `params` is without session and
// client_sequence, and may be "".
uint64_t clients_ask(int client, ask what, const char *method, int session, int tool, bool changes,
                     const char *params);
void clients_notify(int client, const char *method, const char *params);
void clients_send_again(int client);
// Text between `"name":"` and the next quote, or what follows `"name":`; the first in the text.
bool clients_member(const char *text, const char *name, char *out, size_t capacity);
sim_request *clients_request(uint64_t number);

// ---- sessions, by their place
typedef struct sim_session {
	int life;       // how often a session of this name was created
	int machine;    // where it should be
	bool made;      // its creation was answered
	bool wanted;    // it was asked for and not destroyed
	bool moving;    // a courier is at it
	bool ephemeral; // it is not on the disk, and goes with its maker
} sim_session;

extern sim_session sim_sessions[SESSIONS];
void sim_session_name(int session, char name[NAME_MOST]);
void sim_session_id(int session, int machine, char id[NAME_MOST]);
int sim_session_of(const char *id); // of the present lives; -1: none

// ---- daemons
void daemons_begin(const sim_profile *profile);
void daemons_start(int machine);            // soon
void daemons_end(int machine);              // drains; soon
void daemons_kill(int machine, bool power); // at once
bool daemons_up(int machine);
bool daemons_down(int machine);
const char *daemons_trouble(int machine); // why its last start failed
int daemons_boots(int machine);
const char *daemons_label(int machine);

// ---- streams
void streams_begin(const sim_profile *profile);
void streams_acknowledge(void); // what is due
void streams_ack_arriving(int client, const char *text);
void streams_joined(int client, int session, const char *result);
void streams_frame(int client, const unsigned char *bytes, size_t count);
void streams_key_asked(int client, int session); // the daemon is about to read it
void streams_forget(int client);
