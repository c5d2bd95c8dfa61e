// SPDX-License-Identifier: GPL-3.0-or-later
// Bytes to send, shared by reference count, with the headroom that libwebsockets writes its frame
// header into. Servers do not mask, so connections of one thread may share a buffer.
#pragma once

#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { CAU_BUFFER_HEADROOM = 16 }; // at least LWS_PRE

typedef struct cau_buffer {
	atomic_int references;
	bool binary;
	size_t byte_count;
	struct cau_buffer *next;           // of the one queue that owns it alone; unused while shared
	_Alignas(16) unsigned char room[]; // CAU_BUFFER_HEADROOM, then the bytes
} cau_buffer;

// One reference, its bytes unset. NULL if memory ran out.
cau_buffer *cau_buffer_create(size_t capacity, bool binary);
cau_buffer *cau_buffer_share(cau_buffer *buffer);
void cau_buffer_release(cau_buffer *buffer); // takes NULL

static inline unsigned char *cau_buffer_bytes(cau_buffer *buffer)
{
	return buffer->room + CAU_BUFFER_HEADROOM;
}
