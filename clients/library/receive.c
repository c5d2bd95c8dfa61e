// SPDX-License-Identifier: Apache-2.0
// Dispatches text messages from the server.
#include "library/internal.h"

static void greeted(cau_client *client, const cau_rpc_message *message)
{
	cau_error error = {0};
	if (cau_hello_answered(client, message, &error))
		cau_client_refused(client, &error);
	else
		cau_client_greeted(client);
}

static void answered(cau_client *client, const cau_rpc_message *message)
{
	if (message->id.kind != CAU_RPC_ID_NUMBER)
		return; // an answer to a message that the server could not read, or without an id
	if (message->id.number == 0 && client->condition == CAU_CLIENT_CONNECTING)
		greeted(client, message);
	else
		cau_calls_answered(client, message);
}

static void notified(cau_client *client, const cau_rpc_message *message)
{
	if (message->method == CAU_METHOD_SESSION_CHANGED)
		cau_streams_changed(client, message);
	if (client->def.on_notification)
		client->def.on_notification(client->def.user, client, message);
}

void cau_text_received(cau_client *client, const char *text, size_t bytes)
{
	cau_rpc_message message;
	cau_rpc_fault fault;
	if (cau_rpc_read(text, bytes, CAU_CLIENT_TEXT_MAX, &message, &fault))
		return; // perhaps a message of a later version; a caller that waits for it times out
	if (message.kind == CAU_RPC_RESULT || message.kind == CAU_RPC_ERROR)
		answered(client, &message);
	else
		notified(client, &message);
	cau_rpc_finish(&message);
}
