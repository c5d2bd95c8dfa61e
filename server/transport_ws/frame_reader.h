// SPDX-License-Identifier: GPL-3.0-or-later
// Turns the bytes that a client sends into messages and control frames, strictly checked against
// RFC 6455, section 5. Pure: it uses no socket.
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
	CAU_CONTROL_FRAME_BYTES = 125,   // largest payload of a control frame
	CAU_FRAGMENT_LEAST_BYTES = 1024, // shorter fragments count as messages, see frame_reader.c
	CAU_FRAME_HEAD_BYTES = 14,       // longest head: 2, length 8, mask 4
};

typedef enum cau_frame_event {
	CAU_FRAME_MORE,     // all bytes are taken; nothing is complete
	CAU_FRAME_TEXT,     // message, message_bytes: a complete UTF-8 message, followed by a zero
	CAU_FRAME_BINARY,   // message, message_bytes: a complete binary message
	CAU_FRAME_FRAGMENT, // a short fragment ended, and its message continues
	CAU_FRAME_PING,     // control, control_bytes: the ping's payload
	CAU_FRAME_PONG,
	CAU_FRAME_CLOSE,  // close_code: the peer's code; 0: the peer gave no code
	CAU_FRAME_BROKEN, // close_code, reason: close the connection with these; nothing more is read
} cau_frame_event;

typedef struct cau_frame_reader {
	size_t message_most;
	// The received part of the present frame's head:
	unsigned char head[CAU_FRAME_HEAD_BYTES];
	size_t head_bytes;
	// The present frame, once its head is complete:
	bool in_payload;
	unsigned opcode;
	bool final;
	uint64_t payload_bytes, taken; // bytes of the payload: all, and received
	// The message to which the frame belongs:
	bool in_message, binary;
	unsigned char *message; // malloc'ed
	size_t message_bytes, message_capacity;
	size_t valid_bytes; // for a text: bytes that end with a complete character
	// The control frame:
	unsigned char control[CAU_CONTROL_FRAME_BYTES];
	size_t control_bytes;
	// The error, once a rule is broken:
	bool broken;
	int close_code;
	const char *reason;
} cau_frame_reader;

void cau_frame_reader_init(cau_frame_reader *reader, size_t message_most);
void cau_frame_reader_finish(cau_frame_reader *reader);

// Takes bytes from *at on until an event occurs or all are taken. The data of an event is valid
// until the next call.
cau_frame_event cau_frame_reader_next(cau_frame_reader *reader, const unsigned char **at,
                                      const unsigned char *end);
