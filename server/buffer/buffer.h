// SPDX-License-Identifier: GPL-3.0-or-later
// Bytes to send, shared by reference count. They have the headroom into which libwebsockets writes
// its frame header. Servers do not mask frames, so connections of one thread may share a buffer.
#pragma once

#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { CAU_BUFFER_HEADROOM = 16 }; // bytes before the data; at least LWS_PRE

typedef struct cau_buffer {
	atomic_int references;
	bool binary;
	size_t byte_count;
	// next in the one queue that owns the buffer; unused while the buffer is shared
	struct cau_buffer *next;
	_Alignas(16) unsigned char room[]; // CAU_BUFFER_HEADROOM bytes, then the data
} cau_buffer;

// Makes a buffer with one reference and undefined bytes. Returns NULL if memory ran out.
cau_buffer *cau_buffer_create(size_t capacity, bool binary);
cau_buffer *cau_buffer_share(cau_buffer *buffer);
void cau_buffer_release(cau_buffer *buffer); // `buffer` may be NULL

static inline unsigned char *cau_buffer_bytes(cau_buffer *buffer)
{
	return buffer->room + CAU_BUFFER_HEADROOM;
}
