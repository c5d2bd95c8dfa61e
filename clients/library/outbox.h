// SPDX-License-Identifier: Apache-2.0
// A queue of messages that wait to be written to the socket.
#pragma once

#include <stdbool.h>
#include <stddef.h>

#include "cautery/status.h"

// Largest size of all queued messages. A message that would exceed this size is refused with
// CAU_LIMIT.
enum { CAU_OUTBOX_BYTES_MAX = 8 << 20 };

typedef struct cau_outbox_message {
	struct cau_outbox_message *next;
	bool binary;
	size_t byte_count;
	unsigned char bytes[]; // headroom for the WebSocket header, then the message
} cau_outbox_message;

typedef struct cau_outbox {
	cau_outbox_message *first, *last;
	size_t byte_count;
} cau_outbox;

// Appends a message, a copy of head followed by body. Errors: CAU_LIMIT, CAU_NO_MEMORY.
cau_status cau_outbox_add(cau_outbox *outbox, bool binary, const void *head, size_t head_bytes,
                          const void *body, size_t body_bytes, cau_error *error);
unsigned char *cau_outbox_bytes(cau_outbox_message *message); // the message after its headroom
cau_outbox_message *cau_outbox_take(cau_outbox *outbox);      // NULL if empty; the caller frees it
void cau_outbox_clear(cau_outbox *outbox);
