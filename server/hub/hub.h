// SPDX-License-Identifier: GPL-3.0-or-later
// The hub: the daemon's sessions and clients, for every transport alike. A transport
//   - attaches a client for each connection (WebSocket) or publication handle (DDS) that may drive,
//   - hands its commands as orders to sessions, with that client as the asker,
//   - feeds sign of life, and detaches the client when it is gone,
//   - gives a sink to hear answers, notifications and new frames.
// Drivers, watchdogs, order and log are then the same for all. Any thread may call; nothing here
// waits for a step or a disk, but for what says so.
#pragma once

#include "cautery/messages.h"
#include "config/config.h"
#include "hosted_session/hosted.h"
#include "scenes/scenes.h"

typedef struct cau_hub cau_hub;

typedef struct cau_hub_def {
	const cau_config *config; // borrowed, like all here
	cau_store *store;
	cau_store *memory; // of ephemeral sessions; NULL: there are none
	cau_worker_pool *pool;
	cau_builder *builder;
	cau_builder *mover; // for sessions that move, at the workers' priority; NULL: the builder
	cau_scenes *scenes;
	void (*armed)(void *user); // energy came on: cau_hub_watch is to be called again
	void *user;
} cau_hub_def;

cau_status cau_hub_create(cau_hub **hub, const cau_hub_def *def, cau_error *error);
// Ends every session: what waits for them is refused, what they stored is on the disk. After
// cau_builder_stop. Transports may hold sessions still and let them go; nothing is answered then.
// Takes NULL.
void cau_hub_stop(cau_hub *hub);
// After cau_hub_stop, once nobody holds a session any more: they give back what the hub counts.
// Takes NULL.
void cau_hub_destroy(cau_hub *hub);

// Before sessions exist. At most four; the sink must outlive the hub's sessions.
void cau_hub_add_sink(cau_hub *hub, const cau_sink *sink);
// Resumes the store's sessions, *resumed of them; reads the store. Then makes the demo if the
// settings want one.
cau_status cau_hub_resume(cau_hub *hub, int32_t *resumed, cau_error *error);
cau_scenes *cau_hub_scenes(const cau_hub *hub);

// ---- clients
enum { CAU_RESUME_BYTES = 33, CAU_OWNER_BYTES = 80 };

typedef struct cau_client {
	cau_asker asker;  // number, name, role, deadline; its client_id is that of the stored answers
	char said_id[65]; // the client_id of its hello, or one made for it
	char owner[CAU_OWNER_BYTES]; // of its token; "": nobody, where no token is asked for
	char resume[CAU_RESUME_BYTES];
	uint64_t connection; // the transport's own
	bool lost;
	double lost_s;
} cau_client;

// Makes of a client_id one that no other owner can have: stored answers are found by it. With the
// owner "" it stays as it is. False, and "": no memory.
bool cau_hub_bind_client_id(char client_id[65], const char *owner);
// Registers a client: fills its number, its token for resuming, said_id if it is "", and
// asker.client_id if that is "". `resume` (may be NULL) is the token of an earlier client. If that
// is still kept, its number and tools become this client's, and *replaced is its connection (0: it
// was lost already). Its asker.client_id becomes this client's too, whoever owns the token, unless
// this client says another client_id than the earlier one did.
// False: too many clients, no memory, or the system has no random bytes.
bool cau_hub_attach(cau_hub *hub, cau_client *client, const char *resume, uint64_t *replaced);
// Whether that token would resume a client.
bool cau_hub_keeps(cau_hub *hub, const char *resume);
// The connection is gone: energy off at once; tools are kept for `resume_s`.
void cau_hub_detach(cau_hub *hub, uint32_t number, uint64_t connection);
// A sign of life at `alive_s`, monotonic, for all tools that the client drives; not visible: energy
// off at once.
void cau_hub_heartbeat(cau_hub *hub, uint32_t number, bool visible, double alive_s);
// A copy of a client's asker, for handing tools over. False: no such client.
bool cau_hub_find_client(cau_hub *hub, uint32_t number, cau_asker *asker);

// ---- sessions

// Shared for the caller, or NULL.
cau_hosted *cau_hub_find(cau_hub *hub, const char *id);
cau_hosted *cau_hub_find_number(cau_hub *hub, uint32_t number);
// Visits every session; the visitor must not call the hub.
void cau_hub_each(cau_hub *hub, void (*visit)(void *user, cau_hosted *hosted), void *user);
int32_t cau_hub_count(cau_hub *hub);
// Memory of all sessions, bytes, about: what max_sessions_bytes bounds.
int64_t cau_hub_memory(cau_hub *hub);
// The share of its speed that the running session furthest behind reaches, 0 to 1; 1 where none is.
double cau_hub_pace_share_min(cau_hub *hub);

// Whether a session that is not here has moved to another daemon, and where to.
bool cau_hub_moved(cau_hub *hub, const char *id, cau_moved_to *to);

// A session to be made. Answered through `reply`, on failure too.
typedef struct cau_creation {
	struct cau_creation *next;
	enum {
		CAU_CREATION_SESSION,
		CAU_CREATION_MISSING, // see cau_hub_submit_missing; `name` is the session's id
	} kind;
	char name[CAU_NAME_BYTES]; // "": made up
	cau_scene_def *scene;      // malloc'ed, taken
	void *meshes;              // malloc'ed, taken
	size_t mesh_bytes;
	bool paused, ephemeral;
	cau_hosted_origin origin;
	cau_asker asker;
	int64_t client_sequence;
	cau_reply reply;
} cau_creation;

// Frees a creation that was not submitted, and what it owns.
void cau_creation_free(cau_creation *creation);
// Takes the creation, which is malloc'ed.
void cau_hub_submit_creation(cau_hub *hub, cau_creation *creation);
// A request that changes session `id`, which is not here: it may be a resend whose answer is in the
// store (0: has no sequence), or be to destroy a session that is in the store only, because it
// could not be brought up. Answered through `reply` if true; false: there is nothing to look for.
bool cau_hub_submit_missing(cau_hub *hub, const char *id, const cau_asker *asker,
                            int64_t client_sequence, const cau_reply *reply);

// ---- for the daemon

// Cuts silent drivers' energy; the time to look again, INFINITY if nothing is energized.
double cau_hub_watch(cau_hub *hub, double now_s);
// Processor time of the longest slice on a worker so far, s, without the steps in it.
double cau_hub_longest_slice_s(cau_hub *hub);
// What was measured of all sessions; lives as long as the hub.
const cau_hosted_times *cau_hub_times(const cau_hub *hub);
// Forgets lost clients and ended sessions. Waits for a worker's slice: not from one.
void cau_hub_reap(cau_hub *hub);
// Of the sessions that the daemon begins with, the store's and the demo, how many are not there
// yet; whatever clients make.
int32_t cau_hub_resuming(cau_hub *hub);
// A store says that it accepts writes again (takes), or why it refuses them. ephemeral: which of
// the two stores. Call from the store's thread.
void cau_hub_store_takes(cau_hub *hub, bool ephemeral, bool takes, const char *reason);
// The daemon ends: energy goes off in all sessions, and no tick begins any more. Waits for nothing.
void cau_hub_stop_time(cau_hub *hub);
// Checkpoints all sessions; returns when they are on the disk or the time is over.
void cau_hub_drain(cau_hub *hub, double seconds);
