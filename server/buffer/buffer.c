// SPDX-License-Identifier: GPL-3.0-or-later
#include "buffer/buffer.h"

#include <pthread.h>
#include <stdbool.h>
#include <stdlib.h>
#include <sys/mman.h>

#include "cautery/assert.h"

// ---- buffers ------------------------------------------------------------------------------------

cau_buffer *cau_buffer_create(size_t capacity, bool binary)
{
	cau_buffer *buffer = malloc(sizeof *buffer + CAU_BUFFER_HEADROOM + capacity);
	if (!buffer)
		return NULL;
	atomic_init(&buffer->references, 1);
	buffer->binary = binary;
	buffer->byte_count = capacity;
	buffer->next = NULL;
	return buffer;
}

cau_buffer *cau_buffer_share(cau_buffer *buffer)
{
	atomic_fetch_add_explicit(&buffer->references, 1, memory_order_relaxed);
	return buffer;
}

void cau_buffer_release(cau_buffer *buffer)
{
	if (buffer && atomic_fetch_sub_explicit(&buffer->references, 1, memory_order_acq_rel) == 1)
		free(buffer);
}

// ---- shelves ------------------------------------------------------------------------------------

enum {
	// A new piece is larger than requested by the fraction 1 / GROWS_BY, because cuts and contacts
	// make states grow.
	GROWS_BY = 4,
	TOUCHED_BYTES = 4096, // distance of the bytes that touch() writes; no page is smaller
};

typedef struct piece {
	cau_shelf *shelf;
	struct piece *next; // next piece on the shelf
	size_t bytes;       // bytes of `memory`
	max_align_t memory[];
} piece;

struct cau_shelf {
	pthread_mutex_t mutex;
	piece *first;
	int lying, kept; // lying: pieces on the shelf; kept: the largest number of them
	int taken;
	// the owner has released the shelf; the shelf is freed when the last piece is given back
	bool released;
};

// ---- pieces
// Maps a piece directly from the kernel, without the allocator. So the piece's memory belongs only
// to the shelf, and its pages move with it when it grows. Returns NULL if memory ran out.
static piece *make(cau_shelf *shelf, size_t bytes)
{
	size_t all = sizeof(piece) + bytes + bytes / GROWS_BY;
	piece *made = mmap(NULL, all, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
	if (made == MAP_FAILED)
		return NULL;
	*made = (piece){.shelf = shelf, .bytes = all - sizeof *made};
	return made;
}

// Writes to each page, so that memory is present. MAP_POPULATE is not enough: it makes the kernel
// find the pages, but the host of a virtual machine finds its own only at the first write.
static void touch(piece *made)
{
	volatile unsigned char *memory = (void *)made->memory;
	for (size_t i = 0; i < made->bytes; i += TOUCHED_BYTES)
		memory[i] = 0;
}

// Enlarges a piece. Returns NULL if memory ran out; the piece then stays as it was.
static piece *grow(piece *old, size_t bytes)
{
	size_t all = sizeof *old + bytes + bytes / GROWS_BY;
	piece *grown = mremap(old, sizeof *old + old->bytes, all, MREMAP_MAYMOVE);
	if (grown == MAP_FAILED)
		return NULL;
	grown->bytes = all - sizeof *grown;
	return grown;
}

static void unmake(piece *old)
{
	munmap(old, sizeof *old + old->bytes);
}

// ---- the shelf
cau_shelf *cau_shelf_create(void)
{
	cau_shelf *shelf = calloc(1, sizeof *shelf);
	if (shelf)
		pthread_mutex_init(&shelf->mutex, NULL);
	return shelf;
}

static void destroy(cau_shelf *shelf)
{
	CAU_ASSERT(!shelf->taken && !shelf->first, "a shelf goes with %d pieces taken", shelf->taken);
	pthread_mutex_destroy(&shelf->mutex);
	free(shelf);
}

void cau_shelf_release(cau_shelf *shelf)
{
	if (!shelf)
		return;
	pthread_mutex_lock(&shelf->mutex);
	piece *lying = shelf->first;
	shelf->first = NULL;
	shelf->lying = shelf->kept = 0;
	shelf->released = true;
	bool last = !shelf->taken;
	pthread_mutex_unlock(&shelf->mutex);
	for (piece *next; lying; lying = next) {
		next = lying->next;
		unmake(lying);
	}
	if (last)
		destroy(shelf);
}

void cau_shelf_stock(cau_shelf *shelf, size_t bytes, int count)
{
	CAU_ASSERT(!shelf->lying && !shelf->taken, "%d pieces lie on a shelf that is to be stocked",
	           shelf->lying);
	pthread_mutex_lock(&shelf->mutex);
	shelf->kept = count;
	pthread_mutex_unlock(&shelf->mutex);
	for (int i = 0; i < count; i++) {
		piece *made = make(shelf, bytes);
		if (!made)
			return;
		touch(made);
		pthread_mutex_lock(&shelf->mutex);
		made->next = shelf->first;
		shelf->first = made;
		shelf->lying++;
		pthread_mutex_unlock(&shelf->mutex);
	}
}

// Takes a piece from the shelf. Returns NULL if the shelf has no piece. In both cases a piece
// counts as taken, so that the shelf stays until that piece is given back.
static piece *take_lying(cau_shelf *shelf)
{
	pthread_mutex_lock(&shelf->mutex);
	piece *found = shelf->first;
	if (found) {
		shelf->first = found->next;
		shelf->lying--;
	}
	shelf->taken++;
	pthread_mutex_unlock(&shelf->mutex);
	return found;
}

void *cau_shelf_take(cau_shelf *shelf, size_t bytes)
{
	if (!shelf)
		return NULL;
	piece *found = take_lying(shelf);
	if (found && found->bytes >= bytes)
		return found->memory;
	piece *enough = found ? grow(found, bytes) : make(shelf, bytes);
	if (enough)
		return enough->memory;
	pthread_mutex_lock(&shelf->mutex);
	shelf->taken--;
	pthread_mutex_unlock(&shelf->mutex);
	if (found)
		unmake(found);
	return NULL;
}

void cau_shelf_give_back(void *memory)
{
	if (!memory)
		return;
	piece *back = (piece *)(void *)((unsigned char *)memory - offsetof(piece, memory));
	cau_shelf *shelf = back->shelf;
	pthread_mutex_lock(&shelf->mutex);
	CAU_ASSERT(shelf->taken > 0, "%p is given back twice", memory);
	shelf->taken--;
	bool stays = shelf->lying < shelf->kept;
	if (stays) {
		back->next = shelf->first;
		shelf->first = back;
		shelf->lying++;
	}
	bool last = shelf->released && !shelf->taken;
	pthread_mutex_unlock(&shelf->mutex);
	if (!stays)
		unmake(back);
	if (last)
		destroy(shelf);
}
