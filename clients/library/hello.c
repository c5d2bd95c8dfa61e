// SPDX-License-Identifier: Apache-2.0
// Sends hello, the first message on a connection, and reads its answer.
#include <string.h>

#include "library/internal.h"

enum { WIRE_VERSION = 1, HELLO_ID = 0, HELLO_BYTES_MAX = 4096 };

cau_status cau_hello_send(cau_client *client, cau_error *error)
{
	char text[HELLO_BYTES_MAX];
	cau_rpc_buffer out = {text, sizeof text, 0};
	cau_wire_hello hello = {.version = WIRE_VERSION};
	bool again = client->connections > 0;
	snprintf(hello.client, sizeof hello.client, "%s", client->name);
	hello.has_token = *client->token;
	memcpy(hello.token, client->token, sizeof client->token);
	// A reconnecting client keeps its identity, because the stored answers belong to that identity.
	const char *id = again ? client->server.client_id : client->client_id;
	hello.has_client_id = *id;
	snprintf(hello.client_id, sizeof hello.client_id, "%s", id);
	hello.has_resume = again;
	const char *token = *client->kept_resume ? client->kept_resume : client->server.resume;
	snprintf(hello.resume, sizeof hello.resume, "%s", token);
	hello.has_role = client->def.role >= 0;
	hello.role = client->def.role;
	cau_status status = cau_rpc_write_request(&out, HELLO_ID, CAU_METHOD_HELLO, &hello, error);
	if (!status)
		status = cau_socket_send(client, false, text, out.bytes, NULL, 0, error);
	return status;
}

cau_status cau_hello_answered(cau_client *client, const cau_rpc_message *message, cau_error *error)
{
	if (message->kind == CAU_RPC_ERROR) {
		client->fault = message->fault;
		cau_error_of_fault(&message->fault, error);
		return error->status;
	}
	cau_wire_hello_result server = {0};
	cau_status status = cau_rpc_result(message, CAU_METHOD_HELLO, &server, error);
	if (!status)
		client->server = server;
	return status;
}
