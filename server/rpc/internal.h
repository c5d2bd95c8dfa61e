// SPDX-License-Identifier: GPL-3.0-or-later
// What the files of this room share.
#pragma once

#include <pthread.h>
#include <stdatomic.h>

#include "backup/backup.h"
#include "cautery/chunk_codec.h"
#include "clock/clock.h"
#include "hub/sign_of_life.h"
#include "log/log.h"
#include "metrics/exposition.h"
#include "quota/quota.h"
#include "rpc/service.h"
#include "rpc/uploads.h"

enum {
	STREAMS_OF_PEER = 8,
	FILES_OF_PEER = 4,
#define X(...) +1
	CAU_ANSWER_COLUMNS = 1 CAU_RPC_ERROR_TABLE(X), // the result, and each error
#undef X
	MALFORMED_MOST = 16, // messages that are no JSON-RPC, before the connection is closed
};

// A stream of this connection.
typedef struct cau_subscription {
	cau_hosted *hosted; // shared; NULL: free
	cau_subscriber subscriber;
} cau_subscription;

// A file that goes out, in chunks.
typedef struct cau_outgoing {
	cau_buffer *file; // shared; NULL: free
	uint32_t transfer;
	size_t sent;
} cau_outgoing;

// What the service knows of a connection.
typedef struct cau_peer {
	cau_service *service;
	cau_connection *connection;
	bool greeted;   // hello was answered
	uint64_t grant; // of the token that it came with
	cau_auth_bounds bounds;
	cau_client client;
	cau_sign_of_life sign;
	char session[CAU_NAME_BYTES]; // of the URL
	int malformed;
	bool refusal_logged; // of a notification
	int64_t motions;
	cau_subscription streams[STREAMS_OF_PEER];
	int next_stream; // round robin
	cau_uploads uploads;
	cau_outgoing files[FILES_OF_PEER];
	int files_asked; // and not announced yet
	cau_allowance allowance;
} cau_peer;

// From other threads to the network thread.
typedef struct cau_post {
	struct cau_post *next;
	enum { POST_ANSWER, POST_NOTICE } kind;
	uint64_t connection;   // ANSWER
	cau_rpc_id id;         // ANSWER
	cau_method method;     // ANSWER
	cau_audience audience; // NOTICE
	cau_buffer *text;
	cau_buffer *file; // ANSWER, may be NULL
	uint32_t transfer;
	cau_hosted *joined; // ANSWER, may be NULL
	int32_t stream;
} cau_post;

typedef struct cau_scene_answer cau_scene_answer;

struct cau_service {
	const cau_config *config;
	const cau_auth *auth;
	cau_hub *hub;
	cau_moves *moves;
	cau_store *store;
	cau_builder *builder;
	cau_quota *quota;
	cau_backups backups;
	cau_network *network;
	atomic_bool draining, frames_waiting, tokens_changed;
	atomic_ulong ticks;
	pthread_mutex_t mutex; // guards the posts
	cau_post *first, *last;
	uint64_t requests, errors, tokens_refused; // the last of hellos
	double refusal_told_s;                     // when the log told of one
	uint64_t calls[CAU_METHOD_COUNT];
	_Atomic uint64_t answers[CAU_METHOD_COUNT + 1][CAU_ANSWER_COLUMNS]; // the last: of no method
	cau_upload_total uploads;                                           // the network thread's
	cau_scene_answer *scene_answers;                                    // scene_methods.c
	int32_t scene_count;
	uint64_t scene_edition; // of which these are
	void (*write_more_metrics)(void *user, FILE *out, cau_metrics_format format); // may be NULL
	void *more_metrics_user;
};

// One request on its way through the handlers.
typedef struct cau_call {
	cau_peer *peer;
	const cau_rpc_message *message;
	const cau_method_info *method;
	cau_rpc_envelope envelope;
} cau_call;

// ---- reply.c
void cau_call_fail(const cau_call *call, const cau_error *error, int32_t code);
void cau_call_result(const cau_call *call, const void *result);
// The text of an answer, or NULL and the error.
cau_buffer *cau_result_text(const cau_rpc_id *id, cau_method method, const void *result,
                            cau_error *error);
// Answers with a text that is made; takes it. NULL: memory ran out, and nothing is sent.
void cau_call_answer(const cau_call *call, cau_buffer *text);
cau_reply cau_call_reply(const cau_call *call); // for answers that come later
// Answers a message with a fault, and counts that. A notification goes to the log instead.
// method: CAU_METHOD_COUNT where the message has none that is known.
void cau_peer_refuse(cau_peer *peer, const cau_rpc_message *message, cau_method method,
                     const cau_rpc_fault *fault);
void cau_peer_fault(cau_peer *peer, const cau_rpc_id *id, const cau_rpc_fault *fault);
// Counts a message that was none; MALFORMED_MOST of them close the connection.
void cau_peer_malformed(cau_peer *peer);

// ---- life.c
// When the peer gave its newest sign of life, monotonic: now, if it has never sent its clock and
// the network thread was not stopped.
double cau_peer_alive_s(const cau_peer *peer);
// A heartbeat came, with what the peer's clock showed when it was sent.
void cau_peer_hear_clock(cau_peer *peer, int64_t client_time_us);

// ---- scene_methods.c
// The answers to scene.get, made once: their text is the longest that the network thread sends
// itself. False: no memory.
bool cau_scene_answers_make(cau_service *service);
void cau_scene_answers_free(cau_service *service);

// ---- mailbox.c
// A copy of an answer with another id in it, or NULL. Answers that are kept, and those of sessions,
// are made with an id that stands for the asker's.
cau_buffer *cau_answer_with_id(const char *text, size_t bytes, const cau_rpc_id *id);
void cau_service_answer(void *user, const cau_reply *reply, const cau_outcome *outcome);
void cau_service_notify(void *user, cau_audience audience, cau_buffer *text);
void cau_service_frames(void *user);

// ---- delivery.c
void cau_service_read_posts(cau_service *service);

// ---- the handlers that methods.def names, in the files of their families. Each answers the call,
// now or later.
typedef void cau_call_handler(cau_call *call);
#define REQUEST(code, name, params, result, role, effect, cost, handler, meaning)                  \
	cau_call_handler cau_call_##handler;
#define EITHER_WAY(...) REQUEST(__VA_ARGS__)
#define NOTICE(code, name, params, role, handler, meaning) cau_call_handler cau_call_##handler;
#define COMMAND(...)
#define PUSH(...)
#include "cautery/methods.def"
cau_call_handler cau_call_command; // of every tissue command

// Whether the connection's token is for this session; answers the call if not.
bool cau_call_may_use(const cau_call *call, const char *id);
// Whether it is for the session that is to be made under `name` ("": a name made up); likewise.
bool cau_call_may_make(const cau_call *call, const char *name);
// The session of a call, shared, or NULL after a failure that is answered.
cau_hosted *cau_call_session(const cau_call *call);
// A zeroed order of the call's client, or NULL after a failure that is answered.
cau_order *cau_call_order(const cau_call *call, cau_order_kind kind);
// The same with so many zeroed bytes behind it, in the same memory.
cau_order *cau_call_order_of(const cau_call *call, cau_order_kind kind, size_t bytes);
// The same, with the call's params read into `params`, which is zeroed and of the method's type.
cau_order *cau_call_order_with(const cau_call *call, cau_order_kind kind, void *params);
// Submits to the call's session; takes the order. A refusal is answered.
void cau_call_submit(const cau_call *call, cau_order *order);

// ---- streams
cau_buffer *cau_peer_next_frame(cau_peer *peer);
bool cau_peer_has_frames(const cau_peer *peer);
// Whether it may join this session: it has a stream of it, which goes, or fewer than it may.
bool cau_peer_has_room(cau_peer *peer, const cau_hosted *hosted);
void cau_peer_join(cau_peer *peer, cau_hosted *hosted, int32_t stream); // takes the reference
void cau_peer_watch_slowness(cau_peer *peer, double now_s);

// ---- files
// Whether the connection may have one more file under way.
bool cau_peer_has_room_for_file(const cau_peer *peer);
void cau_peer_chunk(cau_peer *peer, const void *bytes, size_t byte_count);
cau_buffer *cau_peer_next_chunk(cau_peer *peer);
// Points the scene's meshes of source bytes at this connection's uploads.
cau_status cau_peer_fill_meshes(cau_peer *peer, cau_scene_def *scene, cau_error *error);

// ---- pages.c
void cau_service_page(void *user, cau_page *page);

// ---- answers.c
// `method` CAU_METHOD_COUNT: of none. `code` 0: a result.
void cau_answers_count(cau_service *service, cau_method method, int32_t code);
const char *cau_answers_method_name(cau_method method); // "none" for CAU_METHOD_COUNT
void cau_answers_write(cau_service *service, cau_metrics_format format, FILE *out);
void cau_calls_write(cau_service *service, cau_metrics_format format, FILE *out);

// ---- metrics_daemon.c: what /metrics tells of the daemon as a whole
void cau_service_daemon_metrics(cau_service *service, cau_metrics_format format, FILE *out);

// ---- metrics.c: writes the whole of /metrics; returns the HTTP status
unsigned cau_service_metrics(cau_service *service, cau_metrics_format format, FILE *out);

static inline cau_peer *cau_peer_of(cau_connection *connection)
{
	return connection->peer;
}
