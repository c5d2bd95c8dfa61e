// SPDX-License-Identifier: GPL-3.0-or-later
// Fuzzes the frame reader: however the bytes are cut, the events are the same and stay within their
// bounds.
#include "transport_ws/frame_reader.h"

#include <stdlib.h>
#include <string.h>

#include "fuzz/fuzz_target.h"

enum { MESSAGE_MOST = 4096 };

// Returns a sum over all events and their data.
static uint64_t read_in_pieces(const uint8_t *data, size_t size, size_t piece)
{
	cau_frame_reader r;
	uint64_t sum = 14695981039346656037u;
	cau_frame_reader_init(&r, MESSAGE_MOST);
	for (size_t i = 0; i < size && !r.broken; i += piece) {
		const unsigned char *at = data + i, *end = data + (size - i < piece ? size : i + piece);
		while (at < end && !r.broken) {
			cau_frame_event event = cau_frame_reader_next(&r, &at, end);
			bool message = event == CAU_FRAME_TEXT || event == CAU_FRAME_BINARY;
			if (event == CAU_FRAME_MORE)
				continue;
			if (r.message_bytes > MESSAGE_MOST || (message && r.message[r.message_bytes] != 0))
				abort();
			sum = (sum ^ (uint64_t)event ^ (uint64_t)r.close_code << 8) * 1099511628211u;
			for (size_t b = 0; message && b < r.message_bytes; b++)
				sum = (sum ^ r.message[b]) * 1099511628211u;
		}
	}
	cau_frame_reader_finish(&r);
	return sum;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	uint64_t whole = read_in_pieces(data, size, size ? size : 1);
	if (read_in_pieces(data, size, 1) != whole || read_in_pieces(data, size, 5) != whole)
		abort();
	return 0;
}
