// SPDX-License-Identifier: GPL-3.0-or-later
// The hub has the daemon's sessions and clients. It is the same for every transport. A transport
//   - attaches a client for each connection (WebSocket) or publication handle (DDS) that may drive,
//   - hands the client's commands to sessions as orders, with this client as the asker,
//   - passes on signs of life, and detaches a client that is gone,
//   - gives a sink that receives answers, notifications and new frames.
// So drivers, deadlines, the order of commands and the log are the same for all transports. Any
// thread may call these functions. None of them waits for a step or a disk, unless its comment says
// so.
#pragma once

#include <stdbool.h>

#include "cautery/messages.h"
#include "config/config.h"
#include "hosted_session/hosted.h"
#include "scenes/scenes.h"

typedef struct cau_hub cau_hub;

typedef struct cau_hub_def {
	const cau_config *config; // borrowed, as are the other members
	cau_store *store;
	cau_store *memory; // store of ephemeral sessions; NULL: there are none
	cau_worker_pool *pool;
	cau_builder *builder;
	// builder for sessions that move, at the workers' priority; NULL: `builder` builds these too
	cau_builder *mover;
	cau_scenes *scenes;
	void (*armed)(void *user); // energy came on: cau_hub_watch must be called again
	void *user;
} cau_hub_def;

cau_status cau_hub_create(cau_hub **hub, const cau_hub_def *def, cau_error *error);
// Ends every session. Refuses their waiting orders, and waits until their batches are on the disk.
// Call this after cau_builder_stop. Transports may still hold sessions and release them, but no
// request is answered any more. `hub` may be NULL.
void cau_hub_stop(cau_hub *hub);
// Call this after cau_hub_stop, once all references to sessions are released, because their release
// changes counts of the hub. `hub` may be NULL.
void cau_hub_destroy(cau_hub *hub);

// Adds a sink, before sessions exist. At most four sinks can be added. The sink must outlive the
// hub's sessions.
void cau_hub_add_sink(cau_hub *hub, const cau_sink *sink);
// Resumes the sessions of the store, and reads the store for this. *resumed is their number. Then
// creates the demo if the settings ask for it.
cau_status cau_hub_resume(cau_hub *hub, int32_t *resumed, cau_error *error);
cau_scenes *cau_hub_scenes(const cau_hub *hub);

// ---- clients
enum { CAU_RESUME_BYTES = 33, CAU_OWNER_BYTES = 80 };

typedef struct cau_client {
	cau_asker asker;  // number, name, role, deadline; its client_id is that of the stored answers
	char said_id[65]; // client_id of the client's hello, or an id made for it
	char owner[CAU_OWNER_BYTES]; // owner of the client's token; "": no token is required
	char resume[CAU_RESUME_BYTES];
	uint64_t connection; // the transport's own number
	bool lost;
	double lost_s;
} cau_client;

// Makes a client_id that no other owner can have, because stored answers are found by it. If the
// owner is "", the client_id does not change. If memory runs out, returns false and sets the
// client_id to "".
bool cau_hub_bind_client_id(char client_id[65], const char *owner);
// Registers a client. Fills its number, its token for resuming, said_id if that is "", and
// asker.client_id if that is "".
// `resume` (may be NULL) is the token of an earlier client. If the hub still keeps the earlier
// client, the new client gets the earlier client's number and tools, and *replaced is the earlier
// client's connection (0: already lost). The new client also gets the earlier asker.client_id, even
// if the owners differ, unless the two clients said different client_ids.
// Returns false if there are too many clients, if memory runs out, or if the system has no random
// bytes.
bool cau_hub_attach(cau_hub *hub, cau_client *client, const char *resume, uint64_t *replaced);
// True if this token would resume a client.
bool cau_hub_keeps(cau_hub *hub, const char *resume);
// Notes that the connection is lost: energy goes off at once, and the client keeps its tools for
// `resume_s`.
void cau_hub_detach(cau_hub *hub, uint32_t number, uint64_t connection);
// Notes a sign of life at `alive_s` (monotonic) for all tools that the client drives. If the
// client's page is not visible, energy goes off at once.
void cau_hub_heartbeat(cau_hub *hub, uint32_t number, bool visible, double alive_s);
// Copies a client's asker, for handing tools over. Returns false if there is no such client.
bool cau_hub_find_client(cau_hub *hub, uint32_t number, cau_asker *asker);

// ---- sessions

// Returns a session with a reference for the caller, or NULL.
cau_hosted *cau_hub_find(cau_hub *hub, const char *id);
cau_hosted *cau_hub_find_number(cau_hub *hub, uint32_t number);
// Calls `visit` for every session. The visitor must not call the hub.
void cau_hub_each(cau_hub *hub, void (*visit)(void *user, cau_hosted *hosted), void *user);
int32_t cau_hub_count(cau_hub *hub);
// Returns the estimated memory of all sessions, bytes. max_sessions_bytes limits it.
int64_t cau_hub_memory(cau_hub *hub);
// Returns the least ratio of actual to set speed over all running sessions, 0 to 1; 1 if none is
// running.
double cau_hub_pace_share_min(cau_hub *hub);

// True if a session that is not here has moved to another daemon; *to is then its target.
bool cau_hub_moved(cau_hub *hub, const char *id, cau_moved_to *to);

// A session to be created. It is answered through `reply`, even on failure.
typedef struct cau_creation {
	struct cau_creation *next;
	enum {
		CAU_CREATION_SESSION,
		CAU_CREATION_MISSING, // see cau_hub_submit_missing; `name` is the session's id
	} kind;
	char name[CAU_NAME_BYTES]; // "": a name is made up
	cau_scene_def *scene;      // malloc'ed; ownership is taken
	void *meshes;              // malloc'ed; ownership is taken
	size_t mesh_bytes;
	bool paused, ephemeral;
	cau_hosted_origin origin;
	cau_asker asker;
	int64_t client_sequence;
	cau_reply reply;
} cau_creation;

// Frees a creation that was not submitted, and everything it owns.
void cau_creation_free(cau_creation *creation);
// Takes ownership of the creation, which is malloc'ed.
void cau_hub_submit_creation(cau_hub *hub, cau_creation *creation);
// Handles a request that changes session `id`, which is not here. It may be a resend whose answer
// is in the store (never if `client_sequence` is 0). Or it may destroy a session that is only in
// the store, because it could not be resumed. Returns true if the request is answered through
// `reply`, and false if there is nothing to look for.
bool cau_hub_submit_missing(cau_hub *hub, const char *id, const cau_asker *asker,
                            int64_t client_sequence, const cau_reply *reply);

// ---- for the daemon

// Cuts off the energy of silent drivers. Returns the time of the next check, INFINITY if no energy
// is on.
double cau_hub_watch(cau_hub *hub, double now_s);
// Returns the processor time of the longest slice on a worker so far, s, without the steps in it.
double cau_hub_longest_slice_s(cau_hub *hub);
// Returns the measured times over all sessions. They are valid as long as the hub.
const cau_hosted_times *cau_hub_times(const cau_hub *hub);
// Forgets lost clients and ended sessions. Waits for a worker's slice, so a worker must not call
// it.
void cau_hub_reap(cau_hub *hub);
// Returns how many of the sessions that the daemon starts with (of the store, and the demo) are not
// there yet. Sessions of clients do not count.
int32_t cau_hub_resuming(cau_hub *hub);
// Notes that a store accepts writes again (`takes`), or why it refuses them. `ephemeral`: which of
// the two stores it is. Call this from the store's thread.
void cau_hub_store_takes(cau_hub *hub, bool ephemeral, bool takes, const char *reason);
// Ends time for all sessions, because the daemon ends: energy goes off, and no tick begins any
// more. Does not wait.
void cau_hub_stop_time(cau_hub *hub);
// Makes a checkpoint of all sessions. Returns when they are on the disk or when the time is over.
void cau_hub_drain(cau_hub *hub, double seconds);

// ---- sessions that move (server/move) -----------------------------------------------------------

// ---- functions that the hub calls
// Answers about sessions that are not the hub's. Any thread may call them, without a lock of the
// hub.
typedef struct cau_elsewhere {
	void *user;
	// True if session `id` has moved to another daemon; *to is then its target.
	bool (*moved)(void *user, const char *id, cau_moved_to *to);
	// True if session `id` is arriving and is not this daemon's yet.
	bool (*arrives)(void *user, const char *id);
} cau_elsewhere;

// Call this before sessions exist. Without it no session is elsewhere.
void cau_hub_set_elsewhere(cau_hub *hub, const cau_elsewhere *elsewhere);

// ---- sessions of the store

// Reads session `id` of the store as a creation; free it with cau_creation_free.
cau_status cau_hub_read_session(cau_hub *hub, const char *id, cau_creation **creation,
                                cau_error *error);
// Starts session `id` of the store. Answers `reply` with its description; the reply may have no
// receiver.
cau_status cau_hub_resume_one(cau_hub *hub, const char *id, const cau_reply *reply,
                              cau_error *error);
// Builds session `id` in advance. The session then waits, and belongs to the caller, not to the
// hub. `reply` is answered with move_held. Takes the scene and meshes of the creation if the result
// is CAU_OK. Takes no lock of the hub.
cau_status cau_hub_make_incoming(cau_hub *hub, cau_creation *creation, const char *id,
                                 const cau_reply *reply, cau_hosted **hosted, cau_error *error);
// Adds a session that was built in advance to the hub's sessions. Takes the caller's reference.
// Returns false, and takes nothing, if no slot is free.
bool cau_hub_place(cau_hub *hub, cau_hosted *hosted);

// ---- drivers of a session that moves

// Copies the token with which client `number` gets its tools back. Returns false if there is none.
bool cau_hub_resume_token(cau_hub *hub, uint32_t number, char token[CAU_RESUME_BYTES]);
// Registers a lost client that another daemon has reported. The client may return with its token.
// Returns its number; 0: there are too many clients.
uint32_t cau_hub_expect(cau_hub *hub, const cau_client *client);

// ---- signs of life ------------------------------------------------------------------------------
// Computes when a client gave its newest sign of life, by the server's clock. A message may wait on
// its way, or in a socket while the server is stopped. So it proves that its sender was alive when
// it was sent, not when it was read. The sender's clock gives the time of sending.
//
// The difference between a message's arrival and its sender's clock is the offset of the clocks
// plus the delay. The least difference belongs to the shortest delay. So a message was sent at its
// sender's time plus the least difference, or earlier. The least difference must not be kept for
// ever: clocks drift, and a clock may be set back. So it is replaced by the least difference of the
// last CAU_SIGN_WINDOW_S once messages have arrived for that long without a gap. Messages that
// arrive all at once, as after a stop of the server, take none of that time.
//
// A clock that is set forward looks like a shorter delay. If the change exceeds the deadline, it is
// not trusted at once: for one deadline, messages only measure the clock and are no signs of life.

#define CAU_SIGN_WINDOW_S 5.0
// Longest pause between two arrivals of one window, s. A longer pause begins a new window.
#define CAU_SIGN_GAP_S 1.0

typedef struct cau_sign_of_life {
	bool clocked;          // a message had a clock; from then on only messages with a clock count
	double least_s;        // the least difference that is used
	double window_from_s;  // arrival that began the window
	double window_least_s; // the least difference in the window
	double arrival_s;      // arrival of the newest message with a clock
	double client_s;       // clock of the sender in that message
	double measured_s;     // messages that arrive before this time are no signs of life
	double alive_s;        // the newest sign of life, monotonic
} cau_sign_of_life;

// Notes a message with a clock. `arrival_s` is monotonic and never decreases. `client_s` is the
// sender's clock, from any origin. `deadline_s` is the silence after which energy is cut off.
// Returns the time of the sender's newest sign of life: at most `arrival_s`, and never less than
// the last result.
double cau_sign_of_life_hear(cau_sign_of_life *sign, double arrival_s, double client_s,
                             double deadline_s);
