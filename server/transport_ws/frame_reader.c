// SPDX-License-Identifier: GPL-3.0-or-later
// Every rule is checked as soon as the byte that breaks it has arrived. So a peer that then sends
// nothing more is answered too.
//
// A message may have any number of fragments, so a flood is counted in frames, not in messages.
// Fragments of 1,024 bytes and more are not counted, because their bytes limit their number. The
// reader reports each shorter fragment, and the caller counts these.
#include "transport_ws/frame_reader.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "cautery/utf8.h"

enum {
	FINAL = 0x80,
	RESERVED = 0x70,
	OPCODE = 0x0f,
	MASKED = 0x80,
	LENGTH = 0x7f,
	LENGTH_16 = 126, // the length follows in two bytes
	LENGTH_64 = 127, // the length follows in eight bytes
	MASK_BYTES = 4,
	FIRST_CAPACITY = 4096,
	KEPT_CAPACITY = 65536, // a larger buffer is freed after its message
};

enum { CONTINUATION = 0, TEXT = 1, BINARY = 2, CONTROL = 8, CLOSE = 8, PING = 9, PONG = 10 };

void cau_frame_reader_init(cau_frame_reader *r, size_t message_most)
{
	*r = (cau_frame_reader){.message_most = message_most};
}

void cau_frame_reader_finish(cau_frame_reader *r)
{
	free(r->message);
	r->message = NULL;
	r->message_capacity = 0;
}

static bool fail(cau_frame_reader *r, cau_close_code code, const char *reason)
{
	r->broken = true;
	r->close_code = (int)code;
	r->reason = reason;
	return false;
}

// ---- the head
static bool check_first_byte(cau_frame_reader *r)
{
	r->opcode = r->head[0] & OPCODE;
	r->final = r->head[0] & FINAL;
	if (r->head[0] & RESERVED)
		return fail(r, CAU_CLOSE_PROTOCOL, "a reserved bit is set: extensions are not used");
	if ((r->opcode > BINARY && r->opcode < CONTROL) || r->opcode > PONG)
		return fail(r, CAU_CLOSE_PROTOCOL, "an undefined opcode");
	if (r->opcode >= CONTROL && !r->final)
		return fail(r, CAU_CLOSE_PROTOCOL, "a control frame in fragments");
	if (r->opcode == CONTINUATION && !r->in_message)
		return fail(r, CAU_CLOSE_PROTOCOL, "a continuation of no message");
	if ((r->opcode == TEXT || r->opcode == BINARY) && r->in_message)
		return fail(r, CAU_CLOSE_PROTOCOL, "a message within the fragments of another");
	return true;
}

static bool check_second_byte(cau_frame_reader *r)
{
	if (!(r->head[1] & MASKED))
		return fail(r, CAU_CLOSE_PROTOCOL, "client frames must be masked");
	if (r->opcode >= CONTROL && (r->head[1] & LENGTH) > CAU_CONTROL_FRAME_BYTES)
		return fail(r, CAU_CLOSE_PROTOCOL, "a control frame of more than 125 bytes");
	return true;
}

static size_t length_bytes(const cau_frame_reader *r)
{
	unsigned length = r->head[1] & LENGTH;
	return length == LENGTH_64 ? 8 : length == LENGTH_16 ? 2 : 0;
}

static bool check_length(cau_frame_reader *r)
{
	size_t bytes = length_bytes(r);
	uint64_t length = bytes ? 0 : r->head[1] & LENGTH;
	for (size_t i = 0; i < bytes; i++)
		length = length << 8 | r->head[2 + i];
	if (length >> 63)
		return fail(r, CAU_CLOSE_PROTOCOL, "the highest bit of a frame's 64-bit length is set");
	if ((bytes == 2 && length < LENGTH_16) || (bytes == 8 && length <= UINT16_MAX))
		return fail(r, CAU_CLOSE_PROTOCOL, "a length is coded in more bytes than needed");
	if (r->opcode < CONTROL && length > r->message_most - r->message_bytes)
		return fail(r, CAU_CLOSE_TOO_BIG, "the message is larger than max_message_bytes");
	r->payload_bytes = length;
	return true;
}

static void begin_payload(cau_frame_reader *r)
{
	r->in_payload = true;
	r->taken = 0;
	r->control_bytes = 0;
	if (r->opcode != TEXT && r->opcode != BINARY)
		return;
	r->in_message = true;
	r->binary = r->opcode == BINARY;
	r->message_bytes = r->valid_bytes = 0;
}

// Takes bytes of a frame's head. Returns false if they break a rule.
static bool take_head(cau_frame_reader *r, const unsigned char **at, const unsigned char *end)
{
	while (*at < end && !r->in_payload) {
		r->head[r->head_bytes++] = *(*at)++;
		if (r->head_bytes == 1 && !check_first_byte(r))
			return false;
		if (r->head_bytes == 1)
			continue;
		if (r->head_bytes == 2 && !check_second_byte(r))
			return false;
		size_t before_mask = 2 + length_bytes(r);
		if (r->head_bytes == before_mask && !check_length(r))
			return false;
		if (r->head_bytes == before_mask + MASK_BYTES)
			begin_payload(r);
	}
	return true;
}

// ---- the payload
static bool grow(cau_frame_reader *r, size_t bytes)
{
	// The 1 is for a zero at the end.
	size_t wanted = r->message_bytes + bytes + 1;
	size_t capacity = r->message_capacity ? r->message_capacity : FIRST_CAPACITY;
	while (capacity < wanted)
		capacity *= 2;
	if (capacity == r->message_capacity)
		return true;
	unsigned char *grown = realloc(r->message, capacity);
	if (!grown)
		return fail(r, CAU_CLOSE_INTERNAL, "memory ran out");
	r->message = grown;
	r->message_capacity = capacity;
	return true;
}

// Applies the mask, whose four bytes repeat over the whole payload. The mask is the last part of
// the head.
static void unmask(const cau_frame_reader *r, const unsigned char *from, size_t bytes,
                   unsigned char *to)
{
	const unsigned char *mask = r->head + r->head_bytes - MASK_BYTES;
	unsigned char turned[MASK_BYTES];
	for (size_t i = 0; i < MASK_BYTES; i++)
		turned[i] = mask[(r->taken + i) % MASK_BYTES];
	for (size_t i = 0; i < bytes; i++)
		to[i] = from[i] ^ turned[i % MASK_BYTES];
}

// Checks a text as it arrives. A character may be cut at the end of the present bytes, but not at
// the end of the message.
static bool check_text(cau_frame_reader *r, bool whole)
{
	const char *text = (const char *)r->message;
	for (;;) {
		r->valid_bytes += cau_utf8_ascii(text + r->valid_bytes, r->message_bytes - r->valid_bytes);
		if (r->valid_bytes == r->message_bytes)
			return true;
		size_t left = r->message_bytes - r->valid_bytes;
		size_t length = cau_utf8_length(text + r->valid_bytes, left);
		if (!length && !whole && cau_utf8_is_start(text + r->valid_bytes, left))
			return true;
		if (!length)
			return fail(r, CAU_CLOSE_NOT_UTF8, NULL);
		r->valid_bytes += length;
	}
}

// Takes bytes of the payload. Returns false if they break a rule.
static bool take_payload(cau_frame_reader *r, const unsigned char **at, const unsigned char *end)
{
	uint64_t left = r->payload_bytes - r->taken;
	size_t bytes = (size_t)(end - *at) < left ? (size_t)(end - *at) : (size_t)left;
	unsigned char *to = r->control + r->control_bytes;
	if (r->opcode < CONTROL) {
		if (!grow(r, bytes))
			return false;
		to = r->message + r->message_bytes;
	}
	unmask(r, *at, bytes, to);
	*at += bytes;
	r->taken += bytes;
	if (r->opcode >= CONTROL) {
		r->control_bytes += bytes;
		return true;
	}
	r->message_bytes += bytes;
	r->message[r->message_bytes] = 0;
	return r->binary || check_text(r, r->final && r->taken == r->payload_bytes);
}

// ---- the end of a frame
// True if the code may be in a close frame: the codes of RFC 6455, section 7.4, and those
// registered since.
static bool is_close_code(int code)
{
	return (code >= 1000 && code <= 1003) || (code >= 1007 && code <= 1014) ||
	       (code >= 3000 && code <= 4999);
}

static bool check_close(cau_frame_reader *r)
{
	r->close_code = 0;
	if (r->control_bytes == 0)
		return true;
	if (r->control_bytes == 1)
		return fail(r, CAU_CLOSE_PROTOCOL, "a close frame has only one byte of its code");
	int code = r->control[0] << 8 | r->control[1];
	if (!is_close_code(code))
		return fail(r, CAU_CLOSE_PROTOCOL, "a close code that may not be sent");
	for (size_t i = 2, length; i < r->control_bytes; i += length) {
		length = cau_utf8_length((const char *)r->control + i, r->control_bytes - i);
		if (!length)
			return fail(r, CAU_CLOSE_NOT_UTF8, "a close reason that is not UTF-8");
	}
	r->close_code = code;
	return true;
}

static cau_frame_event end_frame(cau_frame_reader *r)
{
	r->in_payload = false;
	r->head_bytes = 0;
	if (r->opcode == PING)
		return CAU_FRAME_PING;
	if (r->opcode == PONG)
		return CAU_FRAME_PONG;
	if (r->opcode == CLOSE)
		return check_close(r) ? CAU_FRAME_CLOSE : CAU_FRAME_BROKEN;
	if (!r->final)
		return r->payload_bytes < CAU_FRAGMENT_LEAST_BYTES ? CAU_FRAME_FRAGMENT : CAU_FRAME_MORE;
	r->in_message = false;
	return r->binary ? CAU_FRAME_BINARY : CAU_FRAME_TEXT;
}

// Drops the message that was returned last. Frees a large buffer.
static void shrink(cau_frame_reader *r)
{
	if (r->in_message)
		return;
	r->message_bytes = 0;
	if (r->message_capacity > KEPT_CAPACITY)
		cau_frame_reader_finish(r);
}

cau_frame_event cau_frame_reader_next(cau_frame_reader *r, const unsigned char **at,
                                      const unsigned char *end)
{
	assert(*at <= end);
	cau_frame_event event = CAU_FRAME_MORE;
	shrink(r);
	while (!r->broken && event == CAU_FRAME_MORE && *at < end) {
		if (!take_head(r, at, end))
			break;
		if (!r->in_payload || !take_payload(r, at, end))
			continue;
		if (r->taken == r->payload_bytes)
			event = end_frame(r);
	}
	return r->broken ? CAU_FRAME_BROKEN : event;
}
