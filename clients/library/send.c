// SPDX-License-Identifier: Apache-2.0
// Queues messages for the socket and cuts the connection.
#include "library/internal.h"

void cau_socket_cut(cau_client *client)
{
	if (client->wsi)
		lws_set_timeout(client->wsi, PENDING_TIMEOUT_USER_REASON_BASE, LWS_TO_KILL_ASYNC);
}

cau_status cau_socket_send(cau_client *client, bool binary, const void *head, size_t head_bytes,
                           const void *body, size_t body_bytes, cau_error *error)
{
	if (!client->wsi)
		return cau_fail(error, CAU_IO, NULL, "not connected");
	cau_status status =
		cau_outbox_add(&client->outbox, binary, head, head_bytes, body, body_bytes, error);
	if (!status)
		lws_callback_on_writable(client->wsi);
	return status;
}
