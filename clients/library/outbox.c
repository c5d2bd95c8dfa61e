// SPDX-License-Identifier: Apache-2.0
#include "library/outbox.h"

#include <libwebsockets.h>
#include <stdlib.h>
#include <string.h>

unsigned char *cau_outbox_bytes(cau_outbox_message *message)
{
	return message->bytes + LWS_PRE;
}

cau_status cau_outbox_add(cau_outbox *outbox, bool binary, const void *head, size_t head_bytes,
                          const void *body, size_t body_bytes, cau_error *error)
{
	size_t bytes = head_bytes + body_bytes;
	if (bytes > CAU_OUTBOX_BYTES_MAX - outbox->byte_count)
		return cau_fail(error, CAU_LIMIT, NULL,
		                "the connection is too slow: %zu bytes wait to be sent",
		                outbox->byte_count);
	cau_outbox_message *message = malloc(sizeof *message + LWS_PRE + bytes);
	if (!message)
		return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for a message of %zu bytes", bytes);
	message->next = NULL;
	message->binary = binary;
	message->byte_count = bytes;
	if (head_bytes)
		memcpy(cau_outbox_bytes(message), head, head_bytes);
	if (body_bytes)
		memcpy(cau_outbox_bytes(message) + head_bytes, body, body_bytes);
	if (outbox->last)
		outbox->last->next = message;
	else
		outbox->first = message;
	outbox->last = message;
	outbox->byte_count += bytes;
	return CAU_OK;
}

cau_outbox_message *cau_outbox_take(cau_outbox *outbox)
{
	cau_outbox_message *message = outbox->first;
	if (!message)
		return NULL;
	outbox->first = message->next;
	if (!outbox->first)
		outbox->last = NULL;
	outbox->byte_count -= message->byte_count;
	return message;
}

void cau_outbox_clear(cau_outbox *outbox)
{
	for (cau_outbox_message *message; (message = cau_outbox_take(outbox));)
		free(message);
}
