// SPDX-License-Identifier: GPL-3.0-or-later
// What clients send: the bytes of a connection become messages and control
// frames, checked by the letter of RFC 6455, section 5. Pure: knows no socket.
//
//     cau_frame_reader_init(&reader, most);
//     while (at < end)
//         switch (cau_frame_reader_next(&reader, &at, end)) ...
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "cautery/rpc_errors.h"

enum {
	CAU_CONTROL_FRAME_BYTES = 125,   // most that a control frame carries
	CAU_FRAGMENT_LEAST_BYTES = 1024, // shorter fragments count as messages, see frame_reader.c
	CAU_FRAME_HEAD_BYTES = 14,       // of the longest head: 2, length 8, mask 4
};

typedef enum cau_frame_event {
	CAU_FRAME_MORE,     // all bytes are taken; nothing is whole
	CAU_FRAME_TEXT,     // message, message_bytes: a whole message in UTF-8, a zero
	                    // behind it
	CAU_FRAME_BINARY,   // likewise, any bytes
	CAU_FRAME_FRAGMENT, // a short fragment of a message has ended, which goes on
	CAU_FRAME_PING,     // control, control_bytes: its payload
	CAU_FRAME_PONG,
	CAU_FRAME_CLOSE,  // close_code: the peer's, 0 if it gave none
	CAU_FRAME_BROKEN, // close_code, reason: what to close with. Nothing is read
	                  // any more
} cau_frame_event;

typedef struct cau_frame_reader {
	size_t message_most;
	// the head of the present frame, as far as it has come
	unsigned char head[CAU_FRAME_HEAD_BYTES];
	size_t head_bytes;
	// the present frame, once its head is whole
	bool in_payload;
	unsigned opcode;
	bool final;
	uint64_t payload_bytes, taken; // all of it; so many have come
	// the message that its frames make
	bool in_message, binary;
	unsigned char *message; // malloc'ed
	size_t message_bytes, message_capacity;
	size_t valid_bytes; // of a text: so many are whole characters
	// the control frame
	unsigned char control[CAU_CONTROL_FRAME_BYTES];
	size_t control_bytes;
	// how it ended
	bool broken;
	int close_code;
	const char *reason;
} cau_frame_reader;

void cau_frame_reader_init(cau_frame_reader *reader, size_t message_most);
void cau_frame_reader_finish(cau_frame_reader *reader);

// Takes bytes from *at on until something is whole or all are taken. What an
// event points to lasts until the next call.
cau_frame_event cau_frame_reader_next(cau_frame_reader *reader, const unsigned char **at,
                                      const unsigned char *end);
