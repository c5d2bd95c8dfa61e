// SPDX-License-Identifier: GPL-3.0-or-later
// Memory for large pieces: buffers of bytes to send, and a stock that is allocated before a slice
// needs it.
#pragma once

#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

// ---- buffers ------------------------------------------------------------------------------------
// Bytes to send, shared by reference count. They have the headroom into which libwebsockets writes
// its frame header. Servers do not mask frames, so connections of one thread may share a buffer.

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

// ---- shelves ------------------------------------------------------------------------------------
// A stock of memory that a slice of a session needs at once and in megabytes: for a checkpoint, for
// a file, for a client that joins.
//
// The kernel finds a page at the first write to it. This takes at least 1 us, and 11 us on a
// virtual machine whose host must find the page too. For the 8 MB of a checkpoint of 40,000
// vertices this is 22 ms, while copying them takes 2 ms. So the builder, which may take longer,
// allocates the memory and writes to it. A slice then takes it from the shelf, and gives it back
// later.
//
// A piece that was taken may outlive the session: the store keeps a checkpoint until it is
// committed.

typedef struct cau_shelf cau_shelf;

cau_shelf *cau_shelf_create(void); // NULL if memory ran out
// Frees the pieces on the shelf; pieces that are taken are freed when they are given back. `shelf`
// may be NULL.
void cau_shelf_release(cau_shelf *shelf);

// Puts `count` touched pieces of `bytes` each on an empty shelf. The shelf then keeps at most this
// number of pieces. If memory runs out, the shelf gets fewer; missing pieces are made when they are
// taken.
void cau_shelf_stock(cau_shelf *shelf, size_t bytes, int count);

// Takes a piece of at least `bytes`, from the shelf if it has one. A piece that is too small is
// enlarged and keeps its pages. Returns NULL if memory ran out or `shelf` is NULL. Any thread may
// call it.
void *cau_shelf_take(cau_shelf *shelf, size_t bytes);
// Puts a piece back on its shelf. `memory` may be NULL. Any thread may call it.
void cau_shelf_give_back(void *memory);
