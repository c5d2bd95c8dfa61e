// SPDX-License-Identifier: GPL-3.0-or-later
// A client's life: connecting, losing the connection, coming back.
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cautery/name.h"
#include "library/internal.h"

enum { FIRST_RETRY_US = 100000, LAST_RETRY_US = 2000000 };

cau_client_def cau_default_client_def(void)
{
	return (cau_client_def){
		.url = CAU_CLIENT_DEFAULT_URL, .name = "cautery client", .role = -1, .timeout_s = 30};
}

static cau_status copy_text(char *to, size_t capacity, const char *from, const char *path,
                            cau_error *error)
{
	if (from && strlen(from) >= capacity)
		return cau_fail(error, CAU_BAD_VALUE, path, "longer than %zu bytes", capacity - 1);
	snprintf(to, capacity, "%s", from ? from : "");
	return CAU_OK;
}

cau_status cau_client_create(cau_loop *loop, const cau_client_def *def, cau_client **client,
                             cau_error *error)
{
	cau_client *made = calloc(1, sizeof *made);
	*client = NULL;
	if (!made)
		return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for a client");
	made->loop = loop;
	made->def = *def;
	cau_status status =
		cau_url_read(def->url ? def->url : CAU_CLIENT_DEFAULT_URL, &made->url, error);
	if (!status)
		status = copy_text(made->session, sizeof made->session, def->session, "session", error);
	if (!status)
		status = copy_text(made->token, sizeof made->token, def->token, "token", error);
	if (!status)
		status = copy_text(made->name, sizeof made->name, def->name, "name", error);
	if (!status)
		status =
			copy_text(made->client_id, sizeof made->client_id, def->client_id, "client_id", error);
	if (!status && *made->session && !cau_name_is_valid(made->session)) // it goes into the URL
		status = cau_fail(error, CAU_BAD_VALUE, "session", "is no name: " CAU_NAME_RULE);
	if (status) {
		free(made);
		return status;
	}
	*client = made;
	return CAU_OK;
}

static void forget_timers(cau_client *client)
{
	lws_sul_cancel(&client->tick);
	lws_sul_cancel(&client->retry);
	lws_sul_cancel(&client->deadline);
}

void cau_client_destroy(cau_client *client)
{
	if (!client)
		return;
	forget_timers(client);
	if (client->wsi) {
		lws_set_wsi_user(client->wsi, NULL);
		lws_set_timeout(client->wsi, PENDING_TIMEOUT_USER_REASON_BASE, LWS_TO_KILL_ASYNC);
	}
	client->def.on_condition = NULL;
	cau_calls_lost(client, true);
	for (int i = 0; i < CAU_CLIENT_STREAMS_MAX; i++)
		cau_slot_free(client->slots[i]);
	cau_outbox_clear(&client->outbox);
	free(client->message);
	free(client);
}

static void set_condition(cau_client *client, cau_client_condition condition)
{
	client->condition = condition;
	if (client->def.on_condition)
		client->def.on_condition(client->def.user, client, condition);
}

static void too_late(lws_sorted_usec_list_t *timer)
{
	cau_client *client = lws_container_of(timer, cau_client, deadline);
	snprintf(client->close_reason, sizeof client->close_reason, "no answer to hello within %g s",
	         client->def.timeout_s);
	cau_socket_cut(client);
}

static void connect_now(cau_client *client)
{
	client->attempts++;
	lws_sul_schedule(client->loop->context, 0, &client->deadline, too_late,
	                 (lws_usec_t)(client->def.timeout_s * 1e6));
	set_condition(client, CAU_CLIENT_CONNECTING);
	cau_socket_open(client);
}

static void retry(lws_sorted_usec_list_t *timer)
{
	connect_now(lws_container_of(timer, cau_client, retry));
}

// Five heartbeats go into the silence after which the server cuts energy: on a busy machine some
// come late, and the server takes some late.
static lws_usec_t tick_us(const cau_client *client)
{
	const double share = 5, least_us = 10000;
	double wanted_us = 1e6 * client->server.limits.heartbeat_s / share;
	return (lws_usec_t)fmin(CAU_CLIENT_TICK_US, fmax(least_us, wanted_us));
}

static void tick(lws_sorted_usec_list_t *timer)
{
	cau_client *client = lws_container_of(timer, cau_client, tick);
	lws_sul_schedule(client->loop->context, 0, &client->tick, tick, tick_us(client));
	if (client->keep_alive)
		cau_client_notify(client, CAU_METHOD_HEARTBEAT, &(cau_wire_heartbeat){.visible = true},
		                  NULL);
	cau_streams_tick(client);
}

void cau_client_opened(cau_client *client)
{
	cau_error error = {0};
	if (cau_hello_send(client, &error))
		cau_client_refused(client, &error);
}

void cau_client_greeted(cau_client *client)
{
	client->attempts = 0;
	client->connections++;
	lws_sul_cancel(&client->deadline);
	lws_sul_schedule(client->loop->context, 0, &client->tick, tick, tick_us(client));
	client->condition = CAU_CLIENT_READY;
	cau_streams_rejoin(client);
	cau_calls_resend(client);
	set_condition(client, CAU_CLIENT_READY);
}

void cau_client_refused(cau_client *client, const cau_error *error)
{
	client->trouble = *error;
	client->closing = true;
	lws_callback_on_writable(client->wsi);
}

// Close codes after which coming back would meet the same again.
static bool is_final(int code)
{
	switch (code) {
	case CAU_CLOSE_DONE:
	case CAU_CLOSE_PROTOCOL:
	case CAU_CLOSE_UNSUPPORTED:
	case CAU_CLOSE_NOT_UTF8:
	case CAU_CLOSE_TOO_BIG:
	case CAU_CLOSE_UNAUTHORIZED:
	case CAU_CLOSE_VERSION:
	case CAU_CLOSE_RATE:
	case CAU_CLOSE_RESUMED:
	case CAU_CLOSE_GARBAGE:
		return true;
	default:
		return false;
	}
}

void cau_client_lost(cau_client *client, const char *reason)
{
	bool again = client->def.reconnect && client->connections > 0 && !client->closing &&
	             !is_final(client->close_code);
	forget_timers(client);
	cau_outbox_clear(&client->outbox);
	if (!client->closing || !client->trouble.status)
		cau_fail(&client->trouble, CAU_IO, NULL, "%s", reason);
	cau_streams_lost(client);
	if (again) {
		double wait_us = fmin(LAST_RETRY_US, FIRST_RETRY_US * exp2(client->attempts));
		lws_sul_schedule(client->loop->context, 0, &client->retry, retry, (lws_usec_t)wait_us);
	}
	client->closing = false;
	client->condition = again ? CAU_CLIENT_LOST : CAU_CLIENT_CLOSED;
	cau_calls_lost(client, !again);
	set_condition(client, client->condition);
}

bool cau_client_wait_for(cau_client *client, const bool *done, double until_s)
{
	for (double now_s; !*done && (now_s = cau_client_now()) < until_s;)
		cau_loop_wait(client->loop, until_s - now_s);
	return *done;
}

void cau_client_start(cau_client *client)
{
	if (client->condition != CAU_CLIENT_IDLE && client->condition != CAU_CLIENT_CLOSED)
		return;
	client->trouble = (cau_error){0};
	client->attempts = 0;
	connect_now(client);
}

cau_status cau_client_connect(cau_client *client, cau_error *error)
{
	cau_client_start(client);
	double until_s = cau_client_now() + client->def.timeout_s + 1;
	for (double now_s;
	     client->condition == CAU_CLIENT_CONNECTING && (now_s = cau_client_now()) < until_s;)
		cau_loop_wait(client->loop, until_s - now_s);
	if (client->condition == CAU_CLIENT_READY)
		return CAU_OK;
	if (error)
		*error = client->trouble;
	return client->trouble.status ? client->trouble.status : CAU_IO;
}

void cau_client_close(cau_client *client)
{
	lws_sul_cancel(&client->retry);
	client->def.reconnect = false;
	if (client->condition == CAU_CLIENT_LOST)
		cau_client_lost(client, "closed");
	if (!client->wsi)
		return;
	client->closing = true;
	cau_client_read(client, true);
	lws_callback_on_writable(client->wsi);
	double until_s = cau_client_now() + 1e-6 * CAU_CLIENT_CLOSE_WAIT_US;
	for (double now_s; client->wsi && (now_s = cau_client_now()) < until_s;)
		cau_loop_wait(client->loop, until_s - now_s);
	cau_calls_lost(client, true); // whatever the server is up to, nobody waits any more
}

void cau_client_drop(cau_client *client)
{
	cau_socket_cut(client);
}

cau_client_condition cau_client_get_condition(const cau_client *client)
{
	return client->condition;
}

const cau_error *cau_client_trouble(const cau_client *client)
{
	return &client->trouble;
}

const cau_wire_hello_result *cau_client_server(const cau_client *client)
{
	return &client->server;
}

uint64_t cau_client_connections(const cau_client *client)
{
	return client->connections;
}

void cau_client_keep_alive(cau_client *client, bool on)
{
	client->keep_alive = on;
}

void cau_client_read(cau_client *client, bool on)
{
	if (client->wsi)
		lws_rx_flow_control(client->wsi, on);
}
