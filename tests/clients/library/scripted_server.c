// SPDX-License-Identifier: GPL-3.0-or-later
#include "clients/library/scripted_server.h"

#include <libwebsockets.h>
#include <pthread.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "cautery/topology_codec.h"

enum { MESSAGE_BYTES_MAX = 1 << 20, EPOCH = 77, SESSION_NUMBER = 5 };

typedef struct outgoing {
	struct outgoing *next;
	bool binary;
	size_t byte_count;
	unsigned char bytes[];
} outgoing;

struct scripted_peer {
	scripted_server *server;
	struct lws *wsi;
	int number;
	outgoing *first, *last;
	int close_code; // -1 while the connection stays open
	unsigned char *message;
	size_t message_bytes;
	void *storage;
	cau_frame_encoder *encoder;
	uint64_t frame;
};

struct scripted_server {
	scripted_script script;
	struct lws_context *context;
	pthread_t thread;
	atomic_bool ending;
	int connections;
	char url[64];
};

const char *scripted_url(const scripted_server *server)
{
	return server->url;
}

void *scripted_user(const scripted_peer *peer)
{
	return peer->server->script.user;
}

int scripted_number(const scripted_peer *peer)
{
	return peer->number;
}

// ---- sending -----------------------------------------------------------------------------------
void scripted_send(scripted_peer *peer, bool binary, const void *bytes, size_t byte_count)
{
	outgoing *message = malloc(sizeof *message + LWS_PRE + byte_count);
	message->next = NULL;
	message->binary = binary;
	message->byte_count = byte_count;
	memcpy(message->bytes + LWS_PRE, bytes, byte_count);
	if (peer->last)
		peer->last->next = message;
	else
		peer->first = message;
	peer->last = message;
	lws_callback_on_writable(peer->wsi);
}

static void send_text(scripted_peer *peer, const cau_rpc_buffer *out)
{
	scripted_send(peer, false, out->buffer, out->bytes);
}

void scripted_result(scripted_peer *peer, const cau_rpc_message *request, cau_method method,
                     const void *result)
{
	char text[8192];
	cau_error error = {0};
	cau_rpc_buffer out = {text, sizeof text, 0};
	if (cau_rpc_write_result(&out, &request->id, method, result, &error))
		fail_msg("the script's result: %s %s", error.path, error.reason);
	send_text(peer, &out);
}

void scripted_refuse(scripted_peer *peer, const cau_rpc_message *request, int32_t code,
                     const char *status, const char *path, const char *reason)
{
	char text[2048];
	cau_rpc_buffer out = {text, sizeof text, 0};
	cau_rpc_fault fault = {.code = code};
	snprintf(fault.status, sizeof fault.status, "%s", status);
	snprintf(fault.path, sizeof fault.path, "%s", path);
	snprintf(fault.reason, sizeof fault.reason, "%s", reason);
	cau_rpc_write_error(&out, &request->id, &fault, NULL);
	send_text(peer, &out);
}

void scripted_notify(scripted_peer *peer, cau_method method, const void *params)
{
	char text[4096];
	cau_rpc_buffer out = {text, sizeof text, 0};
	cau_rpc_write_notification(&out, method, params, NULL);
	send_text(peer, &out);
}

void scripted_close(scripted_peer *peer, int code)
{
	peer->close_code = code;
	lws_callback_on_writable(peer->wsi);
}

static int write_next(scripted_peer *peer)
{
	outgoing *message = peer->first;
	if (!message) {
		if (peer->close_code > 0)
			lws_close_reason(peer->wsi, (enum lws_close_status)peer->close_code, NULL, 0);
		return peer->close_code >= 0 ? -1 : 0;
	}
	peer->first = message->next;
	if (!peer->first)
		peer->last = NULL;
	int written = lws_write(peer->wsi, message->bytes + LWS_PRE, message->byte_count,
	                        message->binary ? LWS_WRITE_BINARY : LWS_WRITE_TEXT);
	free(message);
	lws_callback_on_writable(peer->wsi);
	return written < 0 ? -1 : 0;
}

// ---- the standard stream -----------------------------------------------------------------------
static cau_stream_def stream_def(void)
{
	cau_stream_def def = cau_default_stream_def();
	def.session = SESSION_NUMBER;
	def.vertex_count = SCRIPTED_VERTICES;
	def.face_count = SCRIPTED_FACES;
	return def;
}

static void make_encoder(scripted_peer *peer)
{
	cau_stream_def def = stream_def();
	size_t bytes = cau_frame_encoder_bytes(&def);
	peer->storage = realloc(peer->storage, bytes);
	peer->frame = 0;
	uint64_t epoch = (uint64_t)EPOCH + (uint64_t)peer->number;
	cau_frame_encoder_init(peer->storage, bytes, &def, epoch, &peer->encoder, NULL);
}

void scripted_answer_join(scripted_peer *peer, const cau_rpc_message *request)
{
	cau_stream_def def = stream_def();
	cau_wire_stream_description d = {.session = "t1-square",
	                                 .session_number = SESSION_NUMBER,
	                                 .epoch = (uint64_t)EPOCH + (uint64_t)peer->number,
	                                 .rate_hz = 60,
	                                 .channels = def.channels,
	                                 .vertex_count = SCRIPTED_VERTICES,
	                                 .face_count = SCRIPTED_FACES,
	                                 .step_m = def.step_m,
	                                 .stress_step_pa = def.stress_step_pa};
	scripted_result(peer, request, CAU_METHOD_SESSION_JOIN, &d);
	make_encoder(peer);
}

void scripted_send_topology(scripted_peer *peer)
{
	static const int32_t face[3 * SCRIPTED_FACES] = {0, 1, 2, 0, 2, 3};
	static const uint8_t layer[SCRIPTED_FACES] = {0, 0};
	static const double rest[3 * SCRIPTED_VERTICES] = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
	cau_stream_def def = stream_def();
	cau_topology topology = {.face = face, .face_layer = layer, .rest_position = rest};
	unsigned char bytes[4096], scratch[8192];
	size_t count;
	assert_true(cau_topology_scratch_bytes(&def) <= sizeof scratch);
	cau_topology_encode(&def, EPOCH, &topology, scratch, bytes, sizeof bytes, &count, NULL);
	scripted_send(peer, true, bytes, count);
}

void scripted_advance(scripted_peer *peer, bool send)
{
	unsigned char bytes[16384];
	size_t count;
	double position[3 * SCRIPTED_VERTICES] = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
	uint32_t mask = 0;
	float zero[SCRIPTED_VERTICES] = {0};
	position[0] = 1e-3 * (double)++peer->frame;
	cau_stream_sample sample = {.tick = peer->frame,
	                            .time_s = (double)peer->frame / 60,
	                            .position = position,
	                            .face_mask = &mask,
	                            .exposure = zero,
	                            .charring = zero,
	                            .stress = zero};
	cau_error error = {0};
	if (cau_frame_encode(peer->encoder, &sample, bytes, sizeof bytes, &count, &error))
		fail_msg("the script's frame: %s", error.reason);
	if (send)
		scripted_send(peer, true, bytes, count);
}

void scripted_send_key(scripted_peer *peer)
{
	unsigned char bytes[16384];
	size_t count;
	cau_frame_encode_key(peer->encoder, bytes, sizeof bytes, &count, NULL);
	scripted_send(peer, true, bytes, count);
}

// ---- receiving ---------------------------------------------------------------------------------
static void answer_hello(scripted_peer *peer, const cau_rpc_message *message)
{
	cau_wire_hello_result result = {.server = "scripted 1",
	                                .version = 1,
	                                .daemon = "t1",
	                                .role = CAU_ROLE_ADMIN,
	                                .client = peer->number,
	                                .client_id = "made-up",
	                                .limits = {.message_bytes_max = MESSAGE_BYTES_MAX,
	                                           .upload_bytes_max = MESSAGE_BYTES_MAX,
	                                           .chunk_bytes_max = 1024,
	                                           .sessions_max = 1,
	                                           .subscribers_max = 1,
	                                           .profiles_max = 1,
	                                           .tools_max = 1,
	                                           .requests_per_s_max = 1000,
	                                           .motions_per_s_max = 1000,
	                                           .bytes_in_flight_max = MESSAGE_BYTES_MAX,
	                                           .heartbeat_s = 0.25}};
	snprintf(result.resume, sizeof result.resume, "resume-%d", peer->number);
	scripted_result(peer, message, CAU_METHOD_HELLO, &result);
}

static void do_plainly(scripted_peer *peer, const cau_rpc_message *message)
{
	if (message->kind != CAU_RPC_REQUEST)
		return;
	switch (message->method) {
	case CAU_METHOD_HELLO:
		answer_hello(peer, message);
		return;
	case CAU_METHOD_HEARTBEAT:
		scripted_result(peer, message, CAU_METHOD_HEARTBEAT,
		                &(cau_wire_heartbeat_result){.server_time_us = 1});
		return;
	case CAU_METHOD_SESSION_JOIN:
		scripted_answer_join(peer, message);
		scripted_send_topology(peer);
		scripted_advance(peer, true);
		return;
	default:
		scripted_refuse(peer, message, CAU_RPC_METHOD_NOT_FOUND, "method_not_found", "", "");
	}
}

static void take_text(scripted_peer *peer)
{
	cau_rpc_message message;
	cau_rpc_fault fault;
	const scripted_script *script = &peer->server->script;
	const char *text = (const char *)peer->message;
	if (cau_rpc_read(text, peer->message_bytes, MESSAGE_BYTES_MAX, &message, &fault))
		fail_msg("the client sent what cannot be read: %s", text);
	if (!script->text || !script->text(peer, &message, text))
		do_plainly(peer, &message);
	cau_rpc_finish(&message);
}

static void receive(scripted_peer *peer, const void *in, size_t bytes)
{
	peer->message = realloc(peer->message, peer->message_bytes + bytes + 1);
	memcpy(peer->message + peer->message_bytes, in, bytes);
	peer->message_bytes += bytes;
	peer->message[peer->message_bytes] = 0;
	if (!lws_is_final_fragment(peer->wsi) || lws_remaining_packet_payload(peer->wsi))
		return;
	if (!lws_frame_is_binary(peer->wsi))
		take_text(peer);
	else if (peer->server->script.binary)
		peer->server->script.binary(peer, peer->message, peer->message_bytes);
	peer->message_bytes = 0;
}

static void finish_peer(scripted_peer *peer)
{
	for (outgoing *message; (message = peer->first);) {
		peer->first = message->next;
		free(message);
	}
	free(peer->message);
	free(peer->storage);
}

static int on_event(struct lws *wsi, enum lws_callback_reasons reason, void *user, void *in,
                    size_t bytes)
{
	scripted_peer *peer = user;
	switch (reason) {
	case LWS_CALLBACK_ESTABLISHED:
		*peer = (scripted_peer){.server = lws_context_user(lws_get_context(wsi)), .wsi = wsi};
		peer->number = ++peer->server->connections;
		peer->close_code = -1;
		return 0;
	case LWS_CALLBACK_RECEIVE:
		receive(peer, in, bytes);
		return 0;
	case LWS_CALLBACK_SERVER_WRITEABLE:
		return write_next(peer);
	case LWS_CALLBACK_CLOSED:
		finish_peer(peer);
		return 0;
	default:
		return 0;
	}
}

static const struct lws_protocols protocols[] = {
	{.name = "cautery.v1", .callback = on_event, .per_session_data_size = sizeof(scripted_peer)},
	{0},
};

// ---- starting and stopping ---------------------------------------------------------------------
static void *serve(void *user)
{
	scripted_server *server = user;
	while (!atomic_load(&server->ending))
		lws_service(server->context, 0);
	return NULL;
}

scripted_server *scripted_start(const scripted_script *script)
{
	scripted_server *server = calloc(1, sizeof *server);
	if (script)
		server->script = *script;
	struct lws_context_creation_info info = {
		.port = 0,
		.iface = "127.0.0.1",
		.protocols = protocols,
		.options = LWS_SERVER_OPTION_EXPLICIT_VHOSTS,
		.user = server,
		.gid = -1,
		.uid = -1,
	};
	lws_set_log_level(0, NULL);
	server->context = lws_create_context(&info);
	assert_non_null(server->context);
	struct lws_vhost *vhost = lws_create_vhost(server->context, &info);
	assert_non_null(vhost);
	snprintf(server->url, sizeof server->url, "ws://127.0.0.1:%d",
	         lws_get_vhost_listen_port(vhost));
	assert_int_equal(pthread_create(&server->thread, NULL, serve, server), 0);
	return server;
}

void scripted_stop(scripted_server *server)
{
	atomic_store(&server->ending, true);
	lws_cancel_service(server->context);
	pthread_join(server->thread, NULL);
	lws_context_destroy(server->context);
	free(server);
}
