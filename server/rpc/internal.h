// SPDX-License-Identifier: GPL-3.0-or-later
// Shared declarations of rpc.
#pragma once

#include <pthread.h>
#include <stdatomic.h>

#include "backup/backup.h"
#include "cautery/chunk_codec.h"
#include "clock/clock.h"
#include "hub/hub.h"
#include "log/log.h"
#include "metrics/exposition.h"
#include "quota/quota.h"
#include "rpc/service.h"
#include "rpc/uploads.h"

enum {
	STREAMS_OF_PEER = 8,
	FILES_OF_PEER = 4,
#define X(...) +1
	// number of counts of a method: one for results, and one for each error
	CAU_ANSWER_COLUMNS = 1 CAU_RPC_ERROR_TABLE(X),
#undef X
	MALFORMED_MOST = 16, // number of malformed messages after which the connection is closed
};

// A stream that this connection has joined.
typedef struct cau_subscription {
	cau_hosted *hosted; // shared reference; NULL: this slot is free
	cau_subscriber subscriber;
} cau_subscription;

// A file that is sent in chunks.
typedef struct cau_outgoing {
	cau_buffer *file; // shared reference; NULL: this slot is free
	uint32_t transfer;
	size_t sent;
} cau_outgoing;

// The service's state of a connection.
typedef struct cau_peer {
	cau_service *service;
	cau_connection *connection;
	bool greeted;   // hello was answered
	uint64_t grant; // the grant of the token in hello
	cau_auth_bounds bounds;
	cau_client client;
	cau_sign_of_life sign;
	char session[CAU_NAME_BYTES]; // session in the URL
	int malformed;
	bool refusal_logged; // a refused notification of this connection has been logged
	int64_t motions;
	cau_subscription streams[STREAMS_OF_PEER];
	int next_stream; // stream that is served next, because streams are served in turn
	cau_uploads uploads;
	cau_outgoing files[FILES_OF_PEER];
	int files_asked; // files that were requested and are not announced yet
	cau_allowance allowance;
} cau_peer;

// A message from another thread to the network thread.
typedef struct cau_post {
	struct cau_post *next;
	enum { POST_ANSWER, POST_NOTICE } kind;
	uint64_t connection;   // for POST_ANSWER
	cau_rpc_id id;         // for POST_ANSWER
	cau_method method;     // for POST_ANSWER
	cau_audience audience; // for POST_NOTICE
	cau_buffer *text;
	cau_buffer *file; // for POST_ANSWER, may be NULL
	uint32_t transfer;
	cau_hosted *joined; // for POST_ANSWER, may be NULL
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
	uint64_t requests, errors, tokens_refused; // tokens_refused: in hello
	double refusal_told_s;                     // time of the last log line about a refused token
	uint64_t calls[CAU_METHOD_COUNT];
	// the last entry counts answers to messages without a method
	_Atomic uint64_t answers[CAU_METHOD_COUNT + 1][CAU_ANSWER_COLUMNS];
	// used by the network thread only
	cau_upload_total uploads;
	// the answers to scene.get; scene_methods.c
	cau_scene_answer *scene_answers;
	int32_t scene_count;
	uint64_t scene_edition; // edition of the scenes that the answers are from
	void (*write_more_metrics)(void *user, FILE *out, cau_metrics_format format); // may be NULL
	void *more_metrics_user;
};

// One request, as it passes through the handlers.
typedef struct cau_call {
	cau_peer *peer;
	const cau_rpc_message *message;
	const cau_method_info *method;
	cau_rpc_envelope envelope;
} cau_call;

// ---- reply.c
void cau_call_fail(const cau_call *call, const cau_error *error, int32_t code);
void cau_call_result(const cau_call *call, const void *result);
// Returns the text of an answer, or NULL and the error.
cau_buffer *cau_result_text(const cau_rpc_id *id, cau_method method, const void *result,
                            cau_error *error);
// Answers with a text and takes it. If `text` is NULL, memory ran out, and nothing is sent.
void cau_call_answer(const cau_call *call, cau_buffer *text);
cau_reply cau_call_reply(const cau_call *call); // for an answer that comes later
// Answers a message with a fault and counts the answer. If the message is a notification, the fault
// goes to the log instead. method: CAU_METHOD_COUNT if the message names no known method.
void cau_peer_refuse(cau_peer *peer, const cau_rpc_message *message, cau_method method,
                     const cau_rpc_fault *fault);
void cau_peer_fault(cau_peer *peer, const cau_rpc_id *id, const cau_rpc_fault *fault);
// Counts a malformed message. After MALFORMED_MOST of them the connection is closed.
void cau_peer_malformed(cau_peer *peer);

// ---- reply.c: signs of life
// Returns the monotonic time of the peer's newest sign of life. If the peer never sent its clock,
// this is the present time, unless the network thread was stopped.
double cau_peer_alive_s(const cau_peer *peer);
// Notes a heartbeat, with the peer's clock when the heartbeat was sent.
void cau_peer_hear_clock(cau_peer *peer, int64_t client_time_us);

// ---- scene_methods.c
// Makes the answers to scene.get, once: their text is the longest that the network thread sends by
// itself. Returns false if memory ran out.
bool cau_scene_answers_make(cau_service *service);
void cau_scene_answers_free(cau_service *service);

// ---- mailbox.c
// Returns a copy of an answer with another id in it, or NULL. Stored answers and answers of
// sessions are made with a placeholder, which the requester's id replaces.
cau_buffer *cau_answer_with_id(const char *text, size_t bytes, const cau_rpc_id *id);
void cau_service_answer(void *user, const cau_reply *reply, const cau_outcome *outcome);
void cau_service_notify(void *user, cau_audience audience, cau_buffer *text);
void cau_service_frames(void *user);

// ---- delivery.c
void cau_service_read_posts(cau_service *service);

// ---- the handlers that methods.def names, in the files of their families
// Each handler answers the call, now or later.
typedef void cau_call_handler(cau_call *call);
#define REQUEST(code, name, params, result, role, effect, cost, handler, meaning)                  \
	cau_call_handler cau_call_##handler;
#define EITHER_WAY(...) REQUEST(__VA_ARGS__)
#define NOTICE(code, name, params, role, handler, meaning) cau_call_handler cau_call_##handler;
#define COMMAND(...)
#define PUSH(...)
#include "cautery/methods.def"
cau_call_handler cau_call_command; // the handler of every tissue command

// True if the connection's token is for this session. If not, answers the call.
bool cau_call_may_use(const cau_call *call, const char *id);
// True if the connection's token is for a session created under `name` ("": the server makes up a
// name). If not, answers the call.
bool cau_call_may_make(const cau_call *call, const char *name);
// Returns a shared reference to the call's session. On failure answers the call and returns NULL.
cau_hosted *cau_call_session(const cau_call *call);
// Returns a zeroed order of the call's client. On failure answers the call and returns NULL.
cau_order *cau_call_order(const cau_call *call, cau_order_kind kind);
// Like cau_call_order, with `bytes` zeroed bytes behind the order in the same memory.
cau_order *cau_call_order_of(const cau_call *call, cau_order_kind kind, size_t bytes);
// Like cau_call_order, and reads the call's params into `params`, which must be zeroed and of the
// method's type.
cau_order *cau_call_order_with(const cau_call *call, cau_order_kind kind, void *params);
// Submits the order to the call's session and takes it. A refusal is answered.
void cau_call_submit(const cau_call *call, cau_order *order);

// ---- streams
cau_buffer *cau_peer_next_frame(cau_peer *peer);
bool cau_peer_has_frames(const cau_peer *peer);
// True if the peer may join this session: it has a stream of the session, which the new stream
// replaces, or it has fewer streams than its limit.
bool cau_peer_has_room(cau_peer *peer, const cau_hosted *hosted);
void cau_peer_join(cau_peer *peer, cau_hosted *hosted, int32_t stream); // takes the reference
void cau_peer_watch_slowness(cau_peer *peer, double now_s);

// ---- files
// True if the connection may have one more file on its way.
bool cau_peer_has_room_for_file(const cau_peer *peer);
void cau_peer_chunk(cau_peer *peer, const void *bytes, size_t byte_count);
cau_buffer *cau_peer_next_chunk(cau_peer *peer);
// Gives each mesh of the scene that has source bytes the bytes of this connection's upload.
cau_status cau_peer_fill_meshes(cau_peer *peer, cau_scene_def *scene, cau_error *error);

// ---- pages.c
void cau_service_page(void *user, cau_page *page);

// ---- metrics_daemon.c: counts of answers
// Counts an answer. `method`: CAU_METHOD_COUNT if the message had none. `code`: 0 for a result.
void cau_answers_count(cau_service *service, cau_method method, int32_t code);
const char *cau_answers_method_name(cau_method method); // "none" for CAU_METHOD_COUNT

// ---- metrics_daemon.c: the part of /metrics about the whole daemon
void cau_service_daemon_metrics(cau_service *service, cau_metrics_format format, FILE *out);

// ---- metrics.c: writes the whole of /metrics; returns the HTTP status
unsigned cau_service_metrics(cau_service *service, cau_metrics_format format, FILE *out);

static inline cau_peer *cau_peer_of(cau_connection *connection)
{
	return connection->peer;
}
