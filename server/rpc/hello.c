// SPDX-License-Identifier: GPL-3.0-or-later
// The methods hello and heartbeat.
#include <string.h>

#include "rpc/internal.h"

#ifndef CAUTERY_VERSION
#define CAUTERY_VERSION "0"
#endif

enum { WIRE_VERSION = 1 };

// Least time between two log lines about refused tokens, s. So a client that tries many tokens does
// not fill the log.
#define REFUSALS_TOLD_S 1.

static void answer_refusal(const cau_call *call, int32_t code, const char *reason)
{
	cau_error error = {0};
	cau_fail(&error, CAU_BAD_VALUE, "", "%s", reason);
	cau_call_fail(call, &error, code);
}

static void fill_limits(const cau_config *config, cau_wire_limits *limits)
{
	*limits = (cau_wire_limits){.message_bytes_max = config->max_message_bytes,
	                            .upload_bytes_max = config->max_upload_bytes,
	                            .has_uploads_bytes_max = true,
	                            .uploads_bytes_max = config->max_connection_upload_bytes,
	                            .chunk_bytes_max = CAU_CHUNK_BYTES_MAX,
	                            .sessions_max = config->max_sessions,
	                            .subscribers_max = config->max_connections,
	                            .profiles_max = CAU_STREAM_PROFILES_MAX,
	                            .has_streams_max = true,
	                            .streams_max = STREAMS_OF_PEER,
	                            .tools_max = CAU_MAX_TOOLS,
	                            .requests_per_s_max = config->max_requests_per_s,
	                            .motions_per_s_max = config->max_requests_per_s,
	                            .bytes_in_flight_max = config->subscriber_bytes,
	                            .heartbeat_s = config->browser_deadline_s};
}

static void answer(const cau_call *call)
{
	const cau_service *service = call->peer->service;
	const cau_asker *asker = &call->peer->client.asker;
	cau_wire_hello_result result = {
		.version = WIRE_VERSION,
		.role = (int32_t)asker->role,
		.client = asker->client,
		.capabilities = 1u << CAU_CAPABILITY_UPLOAD | 1u << CAU_CAPABILITY_EXPORT |
	                    1u << CAU_CAPABILITY_STORE |
	                    (service->config->dds ? 1u << CAU_CAPABILITY_DDS : 0),
		.server_time_us = (int64_t)(cau_monotonic_s() * 1e6),
		.wall_time_s = (double)cau_wall_us() * 1e-6,
	};
	snprintf(result.server, sizeof result.server, "cauteryd %s", CAUTERY_VERSION);
	snprintf(result.daemon, sizeof result.daemon, "%.48s", service->config->label);
	memcpy(result.client_id, call->peer->client.said_id, sizeof result.client_id);
	snprintf(result.resume, sizeof result.resume, "%s", call->peer->client.resume);
	fill_limits(service->config, &result.limits);
	cau_call_result(call, &result);
}

static void replace(cau_service *service, uint64_t connection)
{
	cau_connection *old = connection ? cau_network_find(service->network, connection) : NULL;
	if (old)
		cau_connection_close(old, CAU_CLOSE_RESUMED, NULL);
}

// Refuses a token. A wrong token (`is_guess`) is answered a second later, to slow down guessing. A
// missing token is answered at once.
static void refuse_token(const cau_call *call, bool is_guess)
{
	cau_service *service = call->peer->service;
	double now_s = cau_monotonic_s();
	service->tokens_refused++;
	if (now_s - service->refusal_told_s >= REFUSALS_TOLD_S) {
		service->refusal_told_s = now_s;
		cau_log(CAU_LOG_WARNING, NULL, "token_refused", "address=%s total=%llu",
		        call->peer->connection->address, (unsigned long long)service->tokens_refused);
	}
	answer_refusal(
		call, CAU_RPC_UNAUTHORIZED,
		"the token is unknown or has expired: ask the daemon's administrator for a new one");
	if (is_guess)
		cau_connection_close_late(call->peer->connection, CAU_CLOSE_UNAUTHORIZED);
	else
		cau_connection_close(call->peer->connection, CAU_CLOSE_UNAUTHORIZED, NULL);
}

void cau_call_hello(cau_call *call)
{
	cau_peer *peer = call->peer;
	cau_service *service = peer->service;
	cau_error error = {0};
	cau_role role;
	uint64_t replaced = 0;
	cau_wire_hello params = {0};
	if (cau_rpc_params(call->message, &params, &error)) {
		cau_call_fail(call, &error, 0);
		return;
	}
	if (peer->greeted) {
		cau_fail(&error, CAU_BAD_STATE, "", "hello must be sent only once on a connection");
		cau_call_fail(call, &error, 0);
		return;
	}
	if (!cau_auth_role(service->auth, params.token, strlen(params.token), &role)) {
		refuse_token(call, *params.token);
		return;
	}
	peer->grant = cau_auth_grant(service->auth, params.token, strlen(params.token));
	if (!cau_auth_grant_bounds(service->auth, peer->grant, &peer->bounds)) {
		refuse_token(call, true); // the token was revoked at this very moment
		return;
	}
	bool resumes = params.has_resume && cau_hub_keeps(service->hub, params.resume);
	if (!cau_connection_has_place(peer->connection, resumes)) {
		// the close frame has the reason, so there is no answer
		cau_connection_close(peer->connection, CAU_CLOSE_FULL, CAU_NO_PLACE);
		return;
	}
	cau_asker *asker = &peer->client.asker;
	asker->role = params.has_role && params.role < (int32_t)role ? (cau_role)params.role : role;
	asker->deadline_s = service->config->browser_deadline_s;
	memcpy(asker->name, params.client, sizeof asker->name);
	memcpy(peer->client.said_id, params.client_id, sizeof peer->client.said_id);
	cau_auth_grant_owner(service->auth, peer->grant, peer->client.owner);
	peer->client.connection = peer->connection->id;
	if (!cau_hub_attach(service->hub, &peer->client, params.has_resume ? params.resume : NULL,
	                    &replaced)) {
		answer_refusal(
			call, CAU_RPC_LIMIT,
			"the daemon cannot keep another client: its memory, its random numbers or its "
			"limit of clients is used up; try again later");
		cau_connection_close(peer->connection, CAU_CLOSE_FULL, NULL);
		return;
	}
	replace(service, replaced);
	peer->greeted = true;
	cau_connection_serve(peer->connection, asker->role);
	cau_hub_heartbeat(service->hub, asker->client, true, cau_peer_alive_s(peer));
	char whose[CAU_AUTH_NAME_BYTES];
	cau_auth_grant_name(service->auth, peer->grant, whose);
	cau_log(CAU_LOG_INFO, NULL, "hello",
	        "connection=%llu client=%u name=\"%s\" resumed=%d token=\"%s\"",
	        (unsigned long long)peer->connection->id, asker->client, asker->name, params.has_resume,
	        whose);
	answer(call);
}

void cau_call_heartbeat(cau_call *call)
{
	cau_peer *peer = call->peer;
	cau_error error = {0};
	cau_wire_heartbeat params = {0};
	if (cau_rpc_params(call->message, &params, &error)) {
		cau_call_fail(call, &error, 0);
		return;
	}
	if (params.has_client_time_us)
		cau_peer_hear_clock(peer, params.client_time_us);
	cau_hub_heartbeat(peer->service->hub, peer->client.asker.client, params.visible,
	                  cau_peer_alive_s(peer));
	cau_wire_heartbeat_result result = {.server_time_us = (int64_t)(cau_monotonic_s() * 1e6),
	                                    .has_client_time_us = params.has_client_time_us,
	                                    .client_time_us = params.client_time_us};
	cau_call_result(call, &result);
}
