// SPDX-License-Identifier: GPL-3.0-or-later
#include "buffer/buffer.h"

#include <stdlib.h>

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
