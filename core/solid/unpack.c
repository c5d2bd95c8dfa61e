// SPDX-License-Identifier: GPL-3.0-or-later
#include <stdlib.h>
#include <zlib.h>

#include "cautery/assert.h"
#include "solid/volume.h"

// Enlarges the output buffer, to at most `most` bytes.
static bool grow(unsigned char **out, size_t *room, size_t most)
{
	size_t wanted = *room ? 2 * *room : 1 << 16;
	unsigned char *more = realloc(*out, wanted < most ? wanted : most);
	if (more) {
		*out = more;
		*room = wanted < most ? wanted : most;
	}
	return more != NULL;
}

cau_status cau_unpack(const unsigned char *bytes, size_t byte_count, size_t most,
                      unsigned char **out, size_t *out_count, cau_error *error)
{
	z_stream stream = {0};
	size_t taken = 0, room = 0;
	int state = inflateInit2(&stream, 15 + 32); // header of gzip or zlib
	*out = NULL;
	*out_count = 0;
	CAU_ASSERT(most > 0, "unpacking to %zu bytes", most);
	while (state == Z_OK && *out_count < most && (taken < byte_count || stream.avail_in)) {
		size_t give = byte_count - taken;
		if (*out_count == room && !grow(out, &room, most)) {
			state = Z_MEM_ERROR;
			break;
		}
		if (!stream.avail_in) {
			stream.next_in = (unsigned char *)bytes + taken;
			stream.avail_in = (uInt)(give < 1 << 30 ? give : 1 << 30);
			taken += stream.avail_in;
		}
		size_t left = room - *out_count < 1 << 30 ? room - *out_count : 1 << 30;
		stream.next_out = *out + *out_count;
		stream.avail_out = (uInt)left;
		state = inflate(&stream, Z_NO_FLUSH);
		*out_count += left - stream.avail_out;
	}
	inflateEnd(&stream);
	if (state == Z_OK || state == Z_STREAM_END)
		return CAU_OK;
	if (state == Z_MEM_ERROR)
		return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for %zu bytes of voxels", room);
	return cau_fail(error, CAU_BAD_SYNTAX, NULL, "the packed data are damaged after %zu bytes",
	                *out_count);
}
