// SPDX-License-Identifier: Apache-2.0
// A client of cauteryd. It connects, sends requests, decodes streams to the newest state, transfers
// files, and reconnects after a lost connection. protocol/README.md describes the messages.
//
//     #include "cautery/client.h"
//
//     // Shows a session until it ends.
//     static cau_status watch(const char *url, const char *session, cau_error *error)
//     {
//         cau_loop *loop = NULL;
//         cau_client *client = NULL;
//         cau_client_stream *stream = NULL;
//         cau_client_def def = cau_default_client_def();
//         cau_wire_session_join join = {.has_session = true};
//         def.url = url;
//         snprintf(join.session, sizeof join.session, "%s", session);
//         cau_status status = cau_loop_create(&loop, error);
//         if (!status)
//             status = cau_client_create(loop, &def, &client, error);
//         if (!status)
//             status = cau_client_connect(client, error);
//         if (!status)
//             status = cau_client_join(client, &join, &stream, error);
//         while (!status && !stream->ended) {
//             cau_loop_wait(loop, 0.1); // everything happens in here
//             if (stream->state->synced)
//                 printf("tick %llu\n", (unsigned long long)stream->state->tick);
//         }
//         cau_client_destroy(client);
//         cau_loop_destroy(loop);
//         return status;
//     }
//
// A loop and its clients belong to one thread. Callbacks run inside cau_loop_wait and inside the
// functions that wait: connect, close, call, command, join, leave, upload, discard_upload,
// download, find_fleet and measure_clock. A callback may send, but must not call a function that
// waits, and must not destroy a client or loop.
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "cautery/fleet_json.h"
#include "cautery/messages.h"
#include "cautery/rpc.h"
#include "cautery/stream.h"
#include "cautery/topology_codec.h"

#ifdef __cplusplus
extern "C" {
#endif

#define CAU_CLIENT_DEFAULT_URL "ws://127.0.0.1:8740"

typedef struct cau_loop cau_loop;     // the event loop of one thread; opaque
typedef struct cau_client cau_client; // one connection; opaque
typedef struct cau_client_stream cau_client_stream;

// ---- loop --------------------------------------------------------------------------------------
// Creates an event loop. Errors: CAU_NO_MEMORY.
cau_status cau_loop_create(cau_loop **loop, cau_error *error);
void cau_loop_destroy(cau_loop *loop); // call it after its clients are destroyed; takes NULL

// Waits for events for `seconds` at most, and handles them. With 0 it handles only the events that
// have already happened.
void cau_loop_wait(cau_loop *loop, double seconds);

double cau_client_now(void); // seconds of CLOCK_MONOTONIC

// ---- client ------------------------------------------------------------------------------------
// Conditions of a connection.
typedef enum cau_client_condition {
	CAU_CLIENT_IDLE,       // not connected yet
	CAU_CLIENT_CONNECTING, // connecting, or waiting for the answer to hello
	CAU_CLIENT_READY,      // hello is answered, so requests can be sent
	CAU_CLIENT_LOST,       // waits before it reconnects
	CAU_CLIENT_CLOSED,     // does not reconnect; cau_client_trouble has the reason
} cau_client_condition;

// A received frame, after decoding.
typedef struct cau_client_frame {
	cau_frame_header header; // header of the frame
	const void *bytes;       // borrowed for the duration of the call
	size_t byte_count;       // size of `bytes`
	cau_status status; // result of decoding: CAU_BAD_STATE means skipped, CAU_CORRUPT means damaged
	double received_s; // cau_client_now() when the last byte arrived
	double decoded_s;  // cau_client_now() after decoding
} cau_client_frame;

// The definition of a client. cau_client_create copies the strings. A string that is not wanted is
// NULL.
typedef struct cau_client_def {
	const char *url;       // ws://, wss://, http:// or https://, with host and port
	const char *session;   // session of messages that name no session; a proxy also reads it
	const char *label;     // label of the daemon behind a proxy, if `session` does not have it
	const char *token;     // access token
	const char *name;      // name of the program, for logs and other users
	const char *client_id; // lasting identity; by default the server gives one
	int role;              // largest wanted role, CAU_ROLE_*; -1 means the role of the token
	bool reconnect;   // true: the client reconnects after a loss, resumes, joins again and resends
	bool follow;      // follow a session that moves to another daemon; true by default
	double timeout_s; // timeout for connecting and for each waiting call. An expensive call
	                  // (cau_method_cost) and a join, which waits until its session is built, wait
	                  // longer while the server answers heartbeats
	void *user;       // passed to the callbacks, each of which may be NULL
	// Called when the condition has changed.
	void (*on_condition)(void *user, cau_client *client, cau_client_condition condition);
	// Called when the server has sent a notification. `message` is borrowed for the call.
	void (*on_notification)(void *user, cau_client *client, const cau_rpc_message *message);
	// Called when a frame of a stream was received and decoded. `frame` is borrowed for the call.
	void (*on_frame)(void *user, cau_client *client, cau_client_stream *stream,
	                 const cau_client_frame *frame);
} cau_client_def;

// Returns a definition with the URL CAU_CLIENT_DEFAULT_URL and every other member at its default.
cau_client_def cau_default_client_def(void);

enum { CAU_CLIENT_TOKEN_BYTES = 512 }; // longer than any token

// Reads the token from the first line of a file. Errors: CAU_IO, CAU_BAD_VALUE (no token);
// error->file names the file.
cau_status cau_client_read_token(const char *file, char token[CAU_CLIENT_TOKEN_BYTES],
                                 cau_error *error);

// Creates a client that is not connected yet. Errors: CAU_BAD_VALUE (the URL), CAU_NO_MEMORY.
cau_status cau_client_create(cau_loop *loop, const cau_client_def *def, cau_client **client,
                             cau_error *error);
// Destroys the client; takes NULL. Drops an open connection without a close frame, so call
// cau_client_close before.
void cau_client_destroy(cau_client *client);

// Connects, says hello and waits for the answer. Errors: CAU_IO if there is no server, no answer or
// a refusal (see error->reason), or the status of the server's error.
cau_status cau_client_connect(cau_client *client, cau_error *error);

// Starts to connect without waiting. on_condition reports the progress.
void cau_client_start(cau_client *client);

// Sends the queued messages and closes the connection. Waits a second at most. The client may
// connect again.
void cau_client_close(cau_client *client);

// Drops the connection without a close frame, like a pulled cable. With `reconnect` the client
// reconnects.
void cau_client_drop(cau_client *client);

// Returns the present condition.
cau_client_condition cau_client_get_condition(const cau_client *client);
const cau_error *cau_client_trouble(const cau_client *client); // why the connection was last lost
// Returns the server's answer to the last hello; borrowed.
const cau_wire_hello_result *cau_client_server(const cau_client *client);
uint64_t cau_client_connections(const cau_client *client); // number of answers to hello so far

// True while the client follows a session that moved to another daemon. The client joins the
// session's streams there again. From then on the old id means the new id. A client follows only if
// its `session`, or all its streams, are of that session alone. Other clients get the error
// `moved`. The condition is LOST or CONNECTING while the client follows.
bool cau_client_follows(const cau_client *client);
// Returns the present id of a session that the program knows as `session`. The id changes when the
// session moves.
const char *cau_client_called(const cau_client *client, const char *session);

// While on, the client sends heartbeats: one at once, then five in each deadline of a driver. The
// driver of an energized tool needs them. Heartbeats carry this machine's monotonic clock. After
// the first heartbeat the server counts no other message of this connection as a heartbeat.
void cau_client_keep_alive(cau_client *client, bool on);

// Stops or resumes reading from the socket. This simulates a slow reader.
void cau_client_read(cau_client *client, bool on);

// ---- fleets ------------------------------------------------------------------------------------
// Asks the proxy at an address for the labels of its daemons. *fleet has no labels if a single
// daemon answers. A connection serves one label (cau_client_def). To list all sessions, connect to
// each label. Waits `timeout_s` at most. Errors: CAU_BAD_VALUE (the URL), CAU_IO (no answer),
// CAU_NO_MEMORY; those of cau_fleet_from_json.
cau_status cau_client_find_fleet(cau_loop *loop, const char *url, double timeout_s,
                                 cau_fleet *fleet, cau_error *error);

// ---- requests ----------------------------------------------------------------------------------
// Called once for each request, with the answer, or with NULL and an error.
typedef void cau_client_answer(void *user, const cau_rpc_message *answer, const cau_error *error);

// Returns the next client_sequence. After a lost connection the client resends requests that have a
// client_sequence, and the server performs each once. Requests without it that change something
// then fail.
int64_t cau_client_next_sequence(cau_client *client);

// Sends a request without waiting. Errors: CAU_BAD_VALUE (params), CAU_LIMIT (too much is queued),
// CAU_IO (not connected and not reconnecting).
cau_status cau_client_send(cau_client *client, cau_method method, const void *params,
                           cau_client_answer *answer, void *user, cau_error *error);
// Sends a command with a client_sequence, without waiting. `session` may be NULL if the URL names
// it.
cau_status cau_client_send_command(cau_client *client, const char *session,
                                   const cau_command *command, cau_client_answer *answer,
                                   void *user, cau_error *error);
// Sends a notification: heartbeat or stream.ack.
cau_status cau_client_notify(cau_client *client, cau_method method, const void *params,
                             cau_error *error);
// Sends tool.move as a notification. Only the newest move counts, and the server sends no answer.
cau_status cau_client_move(cau_client *client, const char *session, const cau_command *command,
                           cau_error *error);

// Sends a request and waits for the answer. `result` is the method's C type (lists and scenes as
// for cau_rpc_result) or NULL. Errors: those of sending; CAU_IO (connection lost, timeout); the
// status that the server's error names, else CAU_BAD_STATE. cau_client_fault has the whole error of
// the server.
cau_status cau_client_call(cau_client *client, cau_method method, const void *params, void *result,
                           cau_error *error);
// Sends a command and waits for the result. `session` may be NULL if the URL names it. `result` may
// be NULL.
cau_status cau_client_command(cau_client *client, const char *session, const cau_command *command,
                              cau_wire_command_result *result, cau_error *error);

// Returns the last error that the server answered. Its code is 0 before any error, and if the last
// failure was not an error from the server.
const cau_rpc_fault *cau_client_fault(const cau_client *client);

// ---- streams -----------------------------------------------------------------------------------
enum { CAU_CLIENT_STREAMS_MAX = 16 }; // streams of one client

// A joined stream. It belongs to the client and is valid until the client is destroyed. Read only.
struct cau_client_stream {
	cau_wire_stream_description description; // description from the last join
	cau_stream_def def;                      // definition of the decoder
	const cau_stream_state *state;           // newest state; it is valid if state->synced
	cau_topology_arrays topology;            // faces and rest shape
	bool has_topology;                       // a topology frame was received
	bool ended;                              // the client left, or the session ended
	uint64_t frames, key_frames, bytes;      // numbers of received frames, key frames and bytes
	uint64_t gaps;                           // number of breaks in the chain of deltas
	uint64_t skipped;                        // frames that do not follow the present state
	uint64_t damaged;                        // frames that could not be decoded
	double received_s;                       // cau_client_now() when the newest frame arrived
};

// Asks for frames and waits for the first key frame. The client owns *stream. After a lost
// connection the client joins again by itself. Joining a session again changes the profile of the
// same stream. Errors: those of cau_client_call; CAU_LIMIT (CAU_CLIENT_STREAMS_MAX).
cau_status cau_client_join(cau_client *client, const cau_wire_session_join *params,
                           cau_client_stream **stream, cau_error *error);
// Joins without waiting. The stream's state is synced when the first key frame has arrived.
// `answer` may be NULL.
cau_status cau_client_send_join(cau_client *client, const cau_wire_session_join *params,
                                cau_client_stream **stream, cau_client_answer *answer, void *user,
                                cau_error *error);
// Leaves the stream and waits for the answer. `ended` is true from then on. Errors: those of
// cau_client_call.
cau_status cau_client_leave(cau_client *client, cau_client_stream *stream, cau_error *error);

// Returns the number of drawn faces: the faces whose bit in the mask is clear.
int64_t cau_client_faces_drawn(const cau_client_stream *stream);

// ---- files -------------------------------------------------------------------------------------
typedef void cau_client_progress(void *user, uint64_t done, uint64_t total); // counts in bytes

// Uploads a mesh file. A scene's mesh of source `bytes` refers to it by result->file. It replaces
// an earlier upload of this name. `progress` may be NULL. Errors: those of cau_client_call.
cau_status cau_client_upload(cau_client *client, const char *name, const char *file_name,
                             const void *bytes, size_t byte_count, cau_client_progress *progress,
                             void *user, cau_wire_upload_result *result, cau_error *error);

// Discards an upload on the server. Sessions that were made from it remain.
cau_status cau_client_discard_upload(cau_client *client, const char *name, cau_error *error);

// Downloads a file by session.export or session.log and checks its hash. The caller frees *bytes.
// Errors: those of cau_client_call; CAU_CORRUPT (wrong hash, or missing bytes), CAU_LIMIT,
// CAU_NO_MEMORY.
cau_status cau_client_download(cau_client *client, cau_method method, const void *params,
                               cau_client_progress *progress, void *user,
                               cau_wire_transfer *transfer, unsigned char **bytes,
                               cau_error *error);

// ---- clock -------------------------------------------------------------------------------------
typedef struct cau_client_clock {
	double offset_s; // server's clock minus cau_client_now()
	double error_s;  // largest error of the offset: half the shortest round trip
} cau_client_clock;

// Measures the offset of the server's clock with `count` heartbeats, from the shortest round trip.
cau_status cau_client_measure_clock(cau_client *client, int32_t count, cau_client_clock *clock,
                                    cau_error *error);

#ifdef __cplusplus
}
#endif
