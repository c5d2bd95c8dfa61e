// SPDX-License-Identifier: GPL-3.0-or-later
// Passes messages to their handlers. Role, state and form are checked here, once for all.
#include "rpc/service.h"

#include <stdlib.h>
#include <string.h>

#include "rpc/internal.h"

#define REQUEST(code, name, params, result, role, effect, cost, handler, meaning)                  \
	[CAU_METHOD_##code] = cau_call_##handler,
#define EITHER_WAY(...) REQUEST(__VA_ARGS__)
#define NOTICE(code, name, params, role, handler, meaning) [CAU_METHOD_##code] = cau_call_##handler,
#define COMMAND(code, ...) [CAU_METHOD_##code] = cau_call_command,
#define PUSH(...)
static cau_call_handler *const handlers[CAU_METHOD_COUNT] = {
#include "cautery/methods.def"
};

enum { TICKS_TO_CHECK = 10 }; // ticks between two checks of tokens: about a second

// ---- messages
static void refuse(const cau_call *call, cau_status status, int32_t code, const char *reason)
{
	cau_error error = {0};
	cau_fail(&error, status, "", "%s", reason);
	cau_call_fail(call, &error, code);
}

// True if the request starts the client's own session again (reset, restore, rewind, fork). A
// client that trains in its own sessions, or in lock-step, does this again and again and waits for
// each answer, so it is not limited.
static bool begins_own_again(const cau_call *call)
{
	cau_method method = call->message->method;
	if (method != CAU_METHOD_SESSION_RESET && method != CAU_METHOD_SESSION_RESTORE &&
	    method != CAU_METHOD_SESSION_REWIND && method != CAU_METHOD_SESSION_FORK)
		return false;
	cau_hosted *hosted =
		cau_hub_find(call->peer->service->hub,
	                 call->envelope.has_session ? call->envelope.session : call->peer->session);
	uint32_t client = call->peer->client.asker.client;
	bool own = hosted && (cau_hosted_is_own_ephemeral(hosted, client) ||
	                      cau_hosted_is_advanced_by(hosted, client));
	cau_hosted_release(hosted);
	return own;
}

// True if the peer's allowances pay for the call. Expensive requests reduce them.
static bool afford(const cau_call *call)
{
	cau_peer *peer = call->peer;
	cau_error error = {0};
	if (call->method->cost == CAU_COST_CHEAP || begins_own_again(call))
		return true;
	if (call->method->cost == CAU_COST_FILE && !cau_peer_has_room_for_file(peer)) {
		cau_fail(&error, CAU_LIMIT, "",
		         "%d files are being sent on this connection, which is the limit: try again when "
		         "one has arrived",
		         FILES_OF_PEER);
		cau_call_fail(call, &error, 0);
		return false;
	}
	const cau_quota_token token = {peer->grant, peer->bounds.quota};
	if (!cau_quota_take(peer->service->quota, &peer->allowance, &token, peer->connection->address,
	                    peer->client.asker.role, cau_monotonic_s(), &error))
		return true;
	cau_call_fail(call, &error, CAU_RPC_RATE);
	return false;
}

// True if the call is allowed now. If not, answers it.
static bool admit(cau_call *call)
{
	const cau_peer *peer = call->peer;
	cau_error error = {0};
	bool hello = call->message->method == CAU_METHOD_HELLO;
	if (!peer->greeted && !hello)
		refuse(call, CAU_BAD_STATE, CAU_RPC_HELLO_REQUIRED, "the first message must be hello");
	else if (peer->service->draining && call->method->changes)
		refuse(call, CAU_BAD_STATE, CAU_RPC_DRAINING, "the server is shutting down");
	else if (!hello && peer->client.asker.role < call->method->role)
		refuse(call, CAU_BAD_STATE, CAU_RPC_FORBIDDEN,
		       "the connection's role does not allow this method: use a token with a higher role");
	else if (!handlers[call->message->method])
		refuse(call, CAU_BAD_VALUE, CAU_RPC_METHOD_NOT_FOUND, "only the server sends this method");
	else if (cau_rpc_params_known(call->message, &error) ||
	         (!hello && cau_rpc_envelope_read(call->message, &call->envelope, &error)))
		cau_call_fail(call, &error, 0);
	else
		return hello || afford(call);
	return false;
}

// Before hello no version is agreed on, so no answer says which methods exist.
static const cau_rpc_fault hello_comes_first = {.code = CAU_RPC_HELLO_REQUIRED,
                                                .status = "hello_required",
                                                .reason = "the first message must be hello"};

static void refuse_message(cau_peer *peer, const cau_rpc_message *message,
                           const cau_rpc_fault *fault)
{
	if (!peer->greeted && fault->code == CAU_RPC_METHOD_NOT_FOUND)
		fault = &hello_comes_first;
	cau_peer_refuse(peer, message, CAU_METHOD_COUNT, fault);
	if (fault->code == CAU_RPC_PARSE || fault->code == CAU_RPC_INVALID_REQUEST)
		cau_peer_malformed(peer);
}

static void on_text(void *user, cau_connection *connection, const char *text, size_t bytes)
{
	cau_service *service = user;
	cau_peer *peer = cau_peer_of(connection);
	cau_rpc_message message = {0};
	cau_rpc_fault fault = {0};
	service->requests++;
	if (cau_rpc_read(text, bytes, (size_t)service->config->max_message_bytes, &message, &fault)) {
		refuse_message(peer, &message, &fault);
		return;
	}
	cau_call call = {.peer = peer, .message = &message};
	if (message.kind == CAU_RPC_REQUEST || message.kind == CAU_RPC_NOTIFICATION) {
		call.method = cau_method_describe(message.method);
		service->calls[message.method]++;
		if (admit(&call))
			handlers[message.method](&call);
	}
	cau_rpc_finish(&message);
}

static void on_binary(void *user, cau_connection *connection, const void *bytes, size_t byte_count)
{
	(void)user;
	cau_peer_chunk(cau_peer_of(connection), bytes, byte_count);
}

// ---- connections
static bool on_opened(void *user, cau_connection *connection, const char *session)
{
	cau_peer *peer = calloc(1, sizeof *peer);
	if (!peer)
		return false;
	peer->service = user;
	peer->connection = connection;
	snprintf(peer->session, sizeof peer->session, "%.48s", session);
	connection->peer = peer;
	return true;
}

static void on_closed(void *user, cau_connection *connection)
{
	cau_service *service = user;
	cau_peer *peer = cau_peer_of(connection);
	if (!peer)
		return;
	for (int i = 0; i < STREAMS_OF_PEER; i++)
		if (peer->streams[i].hosted) {
			cau_hosted_leave(peer->streams[i].hosted, &peer->streams[i].subscriber);
			cau_hosted_release(peer->streams[i].hosted);
		}
	cau_uploads_drop_all(&peer->uploads, &service->uploads);
	for (int i = 0; i < FILES_OF_PEER; i++)
		cau_buffer_release(peer->files[i].file);
	if (peer->greeted)
		cau_hub_detach(service->hub, peer->client.asker.client, connection->id);
	free(peer);
	connection->peer = NULL;
}

static cau_buffer *on_next_frame(void *user, cau_connection *connection)
{
	(void)user;
	return cau_peer_next_frame(cau_peer_of(connection));
}

static void want_frames(cau_service *service)
{
	for (cau_connection *c = cau_network_first(service->network); c; c = c->next)
		if (cau_peer_has_frames(cau_peer_of(c)))
			cau_connection_want_frame(c);
}

// Closes a connection whose token was revoked. Energy goes off at once, not only when the peer has
// read the close frame. Its tools are kept as after any lost connection: a client with a new token
// may resume them.
static void revoke(cau_service *service, cau_peer *peer, const char *reason)
{
	cau_hub_detach(service->hub, peer->client.asker.client, peer->connection->id);
	peer->greeted = false;
	cau_log(CAU_LOG_NOTICE, NULL, "token_revoked", "connection=%llu client=%u reason=\"%s\"",
	        (unsigned long long)peer->connection->id, peer->client.asker.client, reason);
	cau_connection_close(peer->connection, CAU_CLOSE_UNAUTHORIZED, reason);
}

static void check_tokens(cau_service *service)
{
	for (cau_connection *c = cau_network_first(service->network); c; c = c->next) {
		cau_peer *peer = cau_peer_of(c);
		cau_role role;
		cau_auth_bounds bounds;
		if (!peer->greeted)
			continue;
		if (!cau_auth_grant_role(service->auth, peer->grant, &role) ||
		    !cau_auth_grant_bounds(service->auth, peer->grant, &bounds))
			revoke(service, peer, "the token was revoked or has expired");
		else if (role < peer->client.asker.role)
			revoke(service, peer, "the token's role was lowered: connect again");
		else if (strcmp(bounds.sessions, peer->bounds.sessions) != 0)
			revoke(service, peer, "the token's sessions were changed: connect again");
		else
			peer->bounds = bounds;
	}
}

void cau_service_check_tokens(cau_service *service)
{
	service->tokens_changed = true;
	if (service->network)
		cau_network_wake(service->network);
}

static void on_woken(void *user)
{
	cau_service *service = user;
	if (atomic_exchange(&service->tokens_changed, false))
		check_tokens(service);
	cau_service_read_posts(service);
	if (atomic_exchange(&service->frames_waiting, false))
		want_frames(service);
}

static void on_tick(void *user)
{
	cau_service *service = user;
	double now_s = cau_monotonic_s();
	if (service->ticks++ % TICKS_TO_CHECK == 0)
		check_tokens(service); // some tokens may have expired
	for (cau_connection *c = cau_network_first(service->network); c; c = c->next)
		cau_peer_watch_slowness(cau_peer_of(c), now_s);
	want_frames(service);
}

// ---- creating and destroying
cau_status cau_service_create(cau_service **made, const cau_service_def *def, cau_error *error)
{
	cau_service *service = calloc(1, sizeof *service);
	*made = service;
	if (!service)
		return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for the service");
	service->config = def->config;
	service->auth = def->auth;
	service->hub = def->hub;
	service->moves = def->moves;
	service->store = def->store;
	service->builder = def->builder;
	service->quota = cau_quota_create(def->config);
	service->backups =
		(cau_backups){.config = def->config, .store = def->store, .builder = def->builder};
	pthread_mutex_init(&service->mutex, NULL);
	if (!service->quota)
		return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for quotas");
	if (!cau_scene_answers_make(service))
		return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for the scenes");
	cau_hub_add_sink(def->hub, &(cau_sink){service, cau_service_notify, cau_service_frames, NULL});
	return CAU_OK;
}

void cau_service_destroy(cau_service *service)
{
	if (!service)
		return;
	for (cau_post *next; service->first; service->first = next) {
		next = service->first->next;
		cau_buffer_release(service->first->text);
		cau_buffer_release(service->first->file);
		cau_hosted_release(service->first->joined);
		free(service->first);
	}
	pthread_mutex_destroy(&service->mutex);
	cau_scene_answers_free(service);
	cau_quota_destroy(service->quota);
	free(service);
}

cau_network_handler cau_service_handler(cau_service *service)
{
	return (cau_network_handler){.user = service,
	                             .opened = on_opened,
	                             .text = on_text,
	                             .binary = on_binary,
	                             .closed = on_closed,
	                             .next_frame = on_next_frame,
	                             .woken = on_woken,
	                             .tick = on_tick,
	                             .page = cau_service_page};
}

void cau_service_set_network(cau_service *service, cau_network *network)
{
	service->network = network;
}

unsigned long cau_service_ticks(cau_service *service)
{
	return service->ticks;
}

void cau_service_add_metrics(cau_service *service,
                             void (*write)(void *user, FILE *out, cau_metrics_format format),
                             void *user)
{
	service->write_more_metrics = write;
	service->more_metrics_user = user;
}

void cau_service_drain(cau_service *service)
{
	service->draining = true;
}
