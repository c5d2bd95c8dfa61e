// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the frame reader by RFC 6455. Complete messages are read, however the bytes are cut. A
// broken rule ends the connection with the code that the rule's section names.
#include "transport_ws/frame_reader.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { MESSAGE_MOST = 200000, BYTES_MOST = 400000, FINAL = 0x80, MASKED = 0x80 };

static const unsigned char mask[4] = {0x37, 0xfa, 0x21, 0x3d};

typedef struct stream {
	unsigned char bytes[BYTES_MOST];
	size_t count;
} stream;

static stream sent;

static void put(unsigned byte)
{
	assert_true(sent.count < BYTES_MOST);
	sent.bytes[sent.count++] = (unsigned char)byte;
}

static void put_frame(unsigned first, const void *payload, size_t bytes)
{
	put(first);
	if (bytes < 126) {
		put(MASKED | (unsigned)bytes);
	} else if (bytes < 65536) {
		put(MASKED | 126);
		put((unsigned)bytes >> 8);
		put((unsigned)bytes & 255);
	} else {
		put(MASKED | 127);
		for (int i = 7; i >= 0; i--)
			put((unsigned)(bytes >> (8 * i)) & 255);
	}
	for (int i = 0; i < 4; i++)
		put(mask[i]);
	for (size_t i = 0; i < bytes; i++)
		put(((const unsigned char *)payload)[i] ^ mask[i % 4]);
}

// ---- the events as text: "T:abc B:.. F P:x O: C:1000 X:1002"
static char heard[BYTES_MOST];

static void note(const char *what, const void *bytes, size_t count)
{
	size_t at = strlen(heard);
	at += (size_t)sprintf(heard + at, "%s", what);
	memcpy(heard + at, bytes, count);
	strcpy(heard + at + count, " ");
}

static void note_event(cau_frame_event event, const cau_frame_reader *r)
{
	char code[16];
	sprintf(code, "%d", r->close_code);
	switch (event) {
	case CAU_FRAME_TEXT:
	case CAU_FRAME_BINARY:
		assert_int_equal(r->message[r->message_bytes], 0);
		note(event == CAU_FRAME_TEXT ? "T:" : "B:", r->message, r->message_bytes);
		break;
	case CAU_FRAME_FRAGMENT:
		note("F", "", 0);
		break;
	case CAU_FRAME_PING:
		note("P:", r->control, r->control_bytes);
		break;
	case CAU_FRAME_PONG:
		note("O:", r->control, r->control_bytes);
		break;
	case CAU_FRAME_CLOSE:
		note("C:", code, strlen(code));
		break;
	case CAU_FRAME_BROKEN:
		note("X:", code, strlen(code));
		break;
	case CAU_FRAME_MORE:
		break;
	}
}

static const char *read_in_pieces(size_t piece)
{
	cau_frame_reader r;
	bool broken = false;
	heard[0] = 0;
	cau_frame_reader_init(&r, MESSAGE_MOST);
	for (size_t i = 0; i < sent.count && !broken; i += piece) {
		// A copy of the exact size, so that a sanitizer detects a read beyond it.
		size_t bytes = sent.count - i < piece ? sent.count - i : piece;
		unsigned char *part = malloc(bytes);
		memcpy(part, sent.bytes + i, bytes);
		const unsigned char *at = part;
		while (at < part + bytes && !broken) {
			cau_frame_event event = cau_frame_reader_next(&r, &at, part + bytes);
			note_event(event, &r);
			broken = event == CAU_FRAME_BROKEN;
		}
		free(part);
	}
	cau_frame_reader_finish(&r);
	return heard;
}

// Checks that the events are the same, however the network cuts the bytes.
static void assert_heard(const char *expected)
{
	static const size_t pieces[] = {1, 2, 3, 7, 1000, BYTES_MOST};
	for (size_t i = 0; i < sizeof pieces / sizeof *pieces; i++)
		assert_string_equal(read_in_pieces(pieces[i]), expected);
	sent.count = 0;
}

static void messages_come_out(void **state)
{
	(void)state;
	put_frame(FINAL | 1, "hello", 5);
	put_frame(FINAL | 2, "bin", 3);
	put_frame(FINAL | 1, "", 0);
	assert_heard("T:hello B:bin T: ");
}

static void fragments_make_one_message_and_control_frames_may_stand_between(void **state)
{
	(void)state;
	put_frame(1, "he", 2);
	put_frame(FINAL | 9, "pi", 2);
	put_frame(0, "", 0);
	put_frame(0, "l\xc3", 2); // the end of the fragment cuts a character
	put_frame(FINAL | 10, "", 0);
	put_frame(FINAL | 0, "\xa9", 1);
	put_frame(FINAL | 1, "next", 4);
	assert_heard("F P:pi F F O: T:hel\xc3\xa9 T:next ");
}

static void large_fragments_do_not_count(void **state)
{
	(void)state;
	static char half[CAU_FRAGMENT_LEAST_BYTES], expected[4 * CAU_FRAGMENT_LEAST_BYTES];
	memset(half, 'x', sizeof half);
	put_frame(2, half, sizeof half);
	put_frame(0, half, sizeof half - 1);
	put_frame(FINAL | 0, half, 1);
	strcpy(expected, "F B:");
	memset(expected + 4, 'x', 2 * sizeof half);
	strcpy(expected + 4 + 2 * sizeof half, " ");
	assert_heard(expected);
}

static void lengths_of_every_form_are_read(void **state)
{
	(void)state;
	static const size_t lengths[] = {125, 126, 65535, 65536, MESSAGE_MOST};
	static char payload[MESSAGE_MOST], expected[MESSAGE_MOST + 16];
	memset(payload, 'y', sizeof payload);
	for (size_t i = 0; i < sizeof lengths / sizeof *lengths; i++) {
		put_frame(FINAL | 2, payload, lengths[i]);
		sprintf(expected, "B:%.*s ", (int)lengths[i], payload);
		assert_heard(expected);
	}
}

static void close_frames_are_checked(void **state)
{
	(void)state;
	static const int good[] = {1000, 1001, 1003, 1007, 1011, 1014, 3000, 4999};
	static const int bad[] = {0, 999, 1004, 1005, 1006, 1015, 1016, 2999, 5000, 65535};
	for (size_t i = 0; i < sizeof good / sizeof *good; i++) {
		char expected[16], payload[] = {(char)(good[i] >> 8), (char)good[i], 'w', 'h', 'y'};
		put_frame(FINAL | 8, payload, sizeof payload);
		sprintf(expected, "C:%d ", good[i]);
		assert_heard(expected);
	}
	for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
		char payload[] = {(char)(bad[i] >> 8), (char)bad[i]};
		put_frame(FINAL | 8, payload, sizeof payload);
		assert_heard("X:1002 ");
	}
	put_frame(FINAL | 8, "", 0);
	assert_heard("C:0 ");
	put_frame(FINAL | 8, "\x03", 1);
	assert_heard("X:1002 ");
	put_frame(FINAL | 8, "\x03\xe8\xff", 3);
	assert_heard("X:1007 ");
}

// Each case ends with the byte that breaks the rule: the error must come without further bytes.
static void broken_rules_are_told_at_once(void **state)
{
	(void)state;
	static const struct {
		unsigned char bytes[14];
		size_t count;
		const char *heard;
	} cases[] = {
		{{0xC1}, 1, "X:1002 "},               // reserved bits
		{{0xA1}, 1, "X:1002 "},               // reserved bits
		{{0x91}, 1, "X:1002 "},               // reserved bits
		{{0x83}, 1, "X:1002 "},               // an undefined opcode
		{{0x87}, 1, "X:1002 "},               // an undefined opcode
		{{0x8B}, 1, "X:1002 "},               // an undefined opcode
		{{0x8F}, 1, "X:1002 "},               // an undefined opcode
		{{0x09}, 1, "X:1002 "},               // a ping in fragments
		{{0x08}, 1, "X:1002 "},               // a close frame in fragments
		{{0x80}, 1, "X:1002 "},               // a continuation without a message
		{{0x00}, 1, "X:1002 "},               // a continuation without a message
		{{0x81, 0x05}, 2, "X:1002 "},         // an unmasked text
		{{0x89, 0x00}, 2, "X:1002 "},         // an unmasked ping
		{{0x89, 0xFE}, 2, "X:1002 "},         // a ping of 126 bytes or more
		{{0x8A, 0xFF}, 2, "X:1002 "},         // a pong of 126 bytes or more
		{{0x82, 0xFE, 0, 125}, 4, "X:1002 "}, // a too long form of length
		{{0x82, 0xFF, 0, 0, 0, 0, 0, 0, 0xFF, 0xFF}, 10, "X:1002 "}, // a too long form of length
		{{0x82, 0xFF, 0x80, 0, 0, 0, 0, 0, 0, 0}, 10, "X:1002 "},    // a length above 2^63
		{{0x82, 0xFF, 0, 0, 0, 0, 0, 0x10, 0, 0}, 10, "X:1009 "},    // a length beyond the limit
	};
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		for (size_t b = 0; b < cases[i].count; b++)
			put(cases[i].bytes[b]);
		assert_heard(cases[i].heard);
	}
}

static void a_message_within_another_is_refused(void **state)
{
	(void)state;
	put_frame(1, "a", 1);
	put_frame(FINAL | 1, "b", 1);
	assert_heard("F X:1002 ");
	put_frame(2, "a", 1);
	put_frame(FINAL | 2, "b", 1);
	assert_heard("F X:1002 ");
}

static void an_unmasked_frame_is_refused_wherever_it_stands(void **state)
{
	(void)state;
	put_frame(FINAL | 1, "masked", 6);
	put(FINAL | 1);
	put(3);
	assert_heard("T:masked X:1002 ");
}

static void fragments_beyond_the_limit_are_refused(void **state)
{
	(void)state;
	static char payload[MESSAGE_MOST];
	put_frame(2, payload, MESSAGE_MOST - 1);
	put_frame(0, "x", 1);
	put_frame(0, "x", 1);
	assert_heard("F X:1009 ");
}

static void text_that_is_no_utf_8_is_refused(void **state)
{
	(void)state;
	static const char *const wrong[] = {"\xff",  "a\xc0\xaf",           "\xed\xa0\x80",
	                                    "\x80",  "\xf4\x90\x80\x80",    "ok\xe2\x82",
	                                    "\xc3(", "\xf8\x88\x80\x80\x80"};
	for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
		put_frame(FINAL | 1, wrong[i], strlen(wrong[i]));
		assert_heard("X:1007 ");
	}
	put_frame(1, "\xe2\x82", 2); // the second fragment completes the character
	put_frame(FINAL | 0, "\xac", 1);
	put_frame(1, "\xe2\x82", 2); // the rest of the character never comes
	put_frame(FINAL | 0, "", 0);
	assert_heard("F T:\xe2\x82\xac F X:1007 ");
	put_frame(1, "\xe2(", 2); // the error is reported before the message is complete
	assert_heard("X:1007 ");
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(messages_come_out),
		cmocka_unit_test(fragments_make_one_message_and_control_frames_may_stand_between),
		cmocka_unit_test(large_fragments_do_not_count),
		cmocka_unit_test(lengths_of_every_form_are_read),
		cmocka_unit_test(close_frames_are_checked),
		cmocka_unit_test(broken_rules_are_told_at_once),
		cmocka_unit_test(a_message_within_another_is_refused),
		cmocka_unit_test(an_unmasked_frame_is_refused_wherever_it_stands),
		cmocka_unit_test(fragments_beyond_the_limit_are_refused),
		cmocka_unit_test(text_that_is_no_utf_8_is_refused),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
