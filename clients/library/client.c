// SPDX-License-Identifier: Apache-2.0
// Creates, closes and destroys clients, and reads the token for one.
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cautery/client.h"
#include "cautery/name.h"
#include "library/internal.h"

cau_client_def cau_default_client_def(void)
{
	return (cau_client_def){.url = CAU_CLIENT_DEFAULT_URL,
	                        .name = "cautery client",
	                        .role = -1,
	                        .follow = true,
	                        .timeout_s = 30};
}

// Checks the session and the label, which are written into the URL without escaping.
static cau_status check_names(const cau_client *client, cau_error *error)
{
	if (*client->session && !cau_name_is_valid(client->session))
		return cau_fail(error, CAU_BAD_VALUE, "session", "is not a valid name: " CAU_NAME_RULE);
	if (*client->label && !cau_name_is_valid(client->label))
		return cau_fail(error, CAU_BAD_VALUE, "label", "is not a valid name: " CAU_NAME_RULE);
	return CAU_OK;
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
		status = copy_text(made->label, sizeof made->label, def->label, "label", error);
	if (!status)
		status = copy_text(made->token, sizeof made->token, def->token, "token", error);
	if (!status)
		status = copy_text(made->name, sizeof made->name, def->name, "name", error);
	if (!status)
		status =
			copy_text(made->client_id, sizeof made->client_id, def->client_id, "client_id", error);
	if (!status)
		status = check_names(made, error);
	if (status) {
		free(made);
		return status;
	}
	*client = made;
	return CAU_OK;
}

void cau_client_destroy(cau_client *client)
{
	if (!client)
		return;
	cau_client_forget_timers(client);
	if (client->wsi) {
		lws_set_wsi_user(client->wsi, NULL);
		lws_set_timeout(client->wsi, PENDING_TIMEOUT_USER_REASON_BASE, LWS_TO_KILL_ASYNC);
	}
	client->def.on_condition = NULL;
	cau_calls_lost(client, true);
	for (int i = 0; i < CAU_CLIENT_STREAMS_MAX; i++)
		cau_slot_free(client->slots[i]);
	cau_outbox_clear(&client->outbox);
	free(client->message.bytes);
	free(client);
}

void cau_client_start(cau_client *client)
{
	if (client->condition != CAU_CLIENT_IDLE && client->condition != CAU_CLIENT_CLOSED)
		return;
	client->trouble = (cau_error){0};
	client->attempts = 0;
	cau_client_begin(client);
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
	cau_calls_lost(client, true); // No caller waits for answers any more.
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
	if (on && client->condition == CAU_CLIENT_READY)
		cau_client_beat(client);
}

void cau_client_read(cau_client *client, bool on)
{
	if (client->wsi)
		lws_rx_flow_control(client->wsi, on);
}

// ---- token -------------------------------------------------------------------------------------
// Tokens are read from files, because every user of the machine could read a token on a command
// line.
cau_status cau_client_read_token(const char *file, char token[CAU_CLIENT_TOKEN_BYTES],
                                 cau_error *error)
{
	*token = 0;
	snprintf(error->file, sizeof error->file, "%.255s", file);
	FILE *stream = fopen(file, "re");
	if (!stream)
		return cau_fail(error, CAU_IO, NULL, "%s", strerror(errno));
	if (!fgets(token, CAU_CLIENT_TOKEN_BYTES, stream))
		*token = 0;
	fclose(stream);
	token[strcspn(token, "\r\n")] = 0;
	if (!*token)
		return cau_fail(error, CAU_BAD_VALUE, NULL, "the first line of the file has no token");
	*error->file = 0;
	return CAU_OK;
}
