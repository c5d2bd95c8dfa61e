// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the errors of encoder and decoder, and their states after an error.
#include "cautery/frame_codec.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "cautery/assert.h"
#include "protocol/wire/chain.h"
#include "wire/frame.h"

static void test_refused_frames_leave_the_state(void **unused)
{
	(void)unused;
	chain of;
	chain_init(&of, 10, 10);
	chain_pass(&of);
	tissue_move(&of.tissue, 1, 0.05);
	chain_encode(&of);
	const struct {
		size_t offset;
		uint8_t flip;
		cau_status status;
		const char *path;
	} cases[] = {
		{0, 1, CAU_CORRUPT, "magic"},
		{4, 2, CAU_UNSUPPORTED, "version"},
		{5, 4, CAU_CORRUPT, "kind"},
		{5, 1, CAU_BAD_STATE, "kind"},
		{8, 1, CAU_CORRUPT, "byte_count"},
		{12, 1, CAU_BAD_STATE, "session"},
		{16, 1, CAU_BAD_STATE, "epoch"},
		{32, 2, CAU_BAD_STATE, "base_sequence"},
		{64, 2, CAU_BAD_STATE, "profile"},
		{24, 3, CAU_CORRUPT, "sequence"},
		{55, 0x7f ^ 0x3f, CAU_CORRUPT, "header"},
	};
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		if (cases[i].offset == 55)
			of.bytes[54] |= 0xf0; // a time that is not finite
		of.bytes[cases[i].offset] ^= cases[i].flip;
		if (cases[i].offset == 55)
			of.bytes[55] = 0x7f;
		cau_error error = {0};
		assert_int_equal(cau_frame_decode(of.decoder, of.bytes, of.byte_count, &error),
		                 cases[i].status);
		assert_string_equal(error.path, cases[i].path);
		assert_true(cau_frame_decoder_state(of.decoder)->synced);
		assert_true(cau_frame_decoder_state(of.decoder)->sequence == 1);
		of.bytes[cases[i].offset] ^= cases[i].flip;
	}
	chain_finish(&of);
}

static void test_old_and_repeated_frames_are_refused(void **unused)
{
	(void)unused;
	chain of;
	chain_init(&of, 6, 6);
	uint8_t *key = malloc(of.capacity);
	size_t key_bytes;
	chain_pass(&of);
	assert_int_equal(cau_frame_encode_key(of.encoder, key, of.capacity, &key_bytes, NULL), CAU_OK);
	tissue_move(&of.tissue, 1, 0.05);
	chain_pass(&of);
	assert_int_equal(cau_frame_decode(of.decoder, of.bytes, of.byte_count, NULL), CAU_BAD_STATE);
	assert_int_equal(cau_frame_decode(of.decoder, key, key_bytes, NULL), CAU_BAD_STATE);
	chain_assert_holds(of.decoder, &of.tissue);
	free(key);
	chain_finish(&of);
}

static void test_every_truncation_is_refused(void **unused)
{
	(void)unused;
	chain of;
	chain_init(&of, 7, 5);
	chain_encode(&of);
	for (size_t bytes = 0; bytes < of.byte_count; bytes++) {
		uint8_t *cut = malloc(bytes ? bytes : 1);
		memcpy(cut, of.bytes, bytes);
		assert_int_equal(cau_frame_decode(of.decoder, cut, bytes, NULL), CAU_CORRUPT);
		// With the right length in the header, the sections are still cut off.
		if (bytes >= CAU_FRAME_HEADER_BYTES) {
			memcpy(cut + 8, &(uint32_t){(uint32_t)bytes}, 4);
			assert_int_equal(cau_frame_decode(of.decoder, cut, bytes, NULL), CAU_CORRUPT);
			assert_false(cau_frame_decoder_state(of.decoder)->synced);
		}
		free(cut);
	}
	assert_int_equal(cau_frame_decode(of.decoder, of.bytes, of.byte_count, NULL), CAU_OK);
	chain_finish(&of);
}

static void test_a_damaged_frame_asks_for_a_key_frame(void **unused)
{
	(void)unused;
	chain of;
	chain_init(&of, 7, 5);
	chain_pass(&of);
	tissue_move(&of.tissue, 1, 0.05);
	chain_encode(&of);
	of.bytes[CAU_FRAME_HEADER_BYTES + 8] = 3; // numbers of 3 bytes, which do not exist
	assert_int_equal(cau_frame_decode(of.decoder, of.bytes, of.byte_count, NULL), CAU_CORRUPT);
	assert_false(cau_frame_decoder_state(of.decoder)->synced);
	tissue_move(&of.tissue, 2, 0.05);
	chain_encode(&of);
	assert_int_equal(cau_frame_decode(of.decoder, of.bytes, of.byte_count, NULL), CAU_BAD_STATE);
	assert_int_equal(cau_frame_encode_key(of.encoder, of.bytes, of.capacity, &of.byte_count, NULL),
	                 CAU_OK);
	assert_int_equal(cau_frame_decode(of.decoder, of.bytes, of.byte_count, NULL), CAU_OK);
	chain_assert_holds(of.decoder, &of.tissue);
	chain_finish(&of);
}

static void test_flipped_bits_never_do_harm(void **unused)
{
	(void)unused;
	chain of;
	chain_init(&of, 9, 7);
	srand(11);
	int refused = 0;
	for (int32_t round = 0; round < 4000; round++) {
		tissue_move(&of.tissue, round % 50, 0.1);
		chain_encode(&of);
		for (int flips = 1 + rand() % 3; flips > 0; flips--)
			of.bytes[CAU_FRAME_HEADER_BYTES +
			         (size_t)rand() % (of.byte_count - CAU_FRAME_HEADER_BYTES)] ^=
				(uint8_t)(1 << rand() % 8);
		refused += cau_frame_decode(of.decoder, of.bytes, of.byte_count, NULL) != CAU_OK;
		const cau_stream_state *state = cau_frame_decoder_state(of.decoder);
		if (!state->synced) {
			assert_int_equal(
				cau_frame_encode_key(of.encoder, of.bytes, of.capacity, &of.byte_count, NULL),
				CAU_OK);
			assert_int_equal(cau_frame_decode(of.decoder, of.bytes, of.byte_count, NULL), CAU_OK);
			chain_assert_holds(of.decoder, &of.tissue);
		}
	}
	assert_true(refused > 0);
	chain_finish(&of);
}

static void test_a_bad_sample_leaves_the_chain(void **unused)
{
	(void)unused;
	chain of;
	chain_init(&of, 6, 6);
	chain_pass(&of);
	tissue_move(&of.tissue, 1, 0.05);
	cau_stream_sample sample = tissue_sample(&of.tissue);
	size_t bytes;
	cau_error error = {0};
	const double beyond[] = {NAN, INFINITY, -1e6, 1e300};
	for (size_t i = 0; i < sizeof beyond / sizeof *beyond; i++) {
		double kept = of.tissue.position[40];
		of.tissue.position[40] = beyond[i];
		assert_int_equal(
			cau_frame_encode(of.encoder, &sample, of.bytes, of.capacity, &bytes, &error),
			CAU_NUMERICAL);
		assert_string_equal(error.path, "position");
		of.tissue.position[40] = kept;
	}
	sample.exposure = NULL;
	assert_int_equal(cau_frame_encode(of.encoder, &sample, of.bytes, of.capacity, &bytes, &error),
	                 CAU_BAD_VALUE);
	sample = tissue_sample(&of.tissue);
	of.tissue.tools[0].force_n[1] = NAN;
	assert_int_equal(cau_frame_encode(of.encoder, &sample, of.bytes, of.capacity, &bytes, &error),
	                 CAU_BAD_VALUE);
	of.tissue.tools[0].force_n[1] = 0.0;
	assert_int_equal(
		cau_frame_encode(of.encoder, &sample, of.bytes, of.capacity - 1, &bytes, &error),
		CAU_LIMIT);
	assert_true(cau_frame_encoder_sequence(of.encoder) == 1);
	chain_pass(&of);
	chain_assert_holds(of.decoder, &of.tissue);
	chain_finish(&of);
}

static void test_definitions_are_checked(void **unused)
{
	(void)unused;
	cau_stream_def good = cau_default_stream_def();
	good.vertex_count = 4;
	good.face_count = 2;
	assert_int_equal(cau_stream_def_check(&good, NULL), CAU_OK);
	cau_stream_def bad[] = {good, good, good, good, good, good, good, good};
	bad[0].vertex_count = 0;
	bad[1].vertex_count = CAU_STREAM_ELEMENTS_MAX + 1;
	bad[2].face_count = -1;
	bad[3].step_m = 0.0;
	bad[4].step_m = NAN;
	bad[5].origin_m[2] = INFINITY;
	bad[6].profile = CAU_STREAM_PROFILES_MAX;
	bad[7].channels = 1u << CAU_CHANNEL_COUNT;
	for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
		cau_frame_decoder *decoder;
		uint8_t storage[64];
		assert_int_equal(cau_frame_decoder_init(storage, sizeof storage, &bad[i], &decoder, NULL),
		                 CAU_BAD_VALUE);
	}
	cau_frame_decoder *decoder;
	uint8_t storage[64];
	assert_int_equal(cau_frame_decoder_init(storage, sizeof storage, &good, &decoder, NULL),
	                 CAU_LIMIT);
}

// A chain with damaged memory makes no frame and does not end the program, in any build.
static void test_a_spoilt_chain_makes_no_frame(void **unused)
{
	(void)unused;
	for (int i = 0; i < 3; i++) {
		chain of;
		chain_init(&of, 6, 6);
		chain_pass(&of);
		tissue_move(&of.tissue, 1, 0.05);
		cau_stream_sample sample = tissue_sample(&of.tissue);
		cau_error error = {0};
		size_t bytes;
		cau_frame_encoder spared = *of.encoder;
		if (i == 0)
			of.encoder->header.epoch = 0;
		else if (i == 1)
			of.encoder->tools.count = CAU_MAX_TOOLS + 1;
		else
			of.encoder->tools.tools[0].shape = -1;
		cau_status status =
			i == 0 ? cau_frame_encode(of.encoder, &sample, of.bytes, of.capacity, &bytes, &error)
				   : cau_frame_encode_key(of.encoder, of.bytes, of.capacity, &bytes, &error);
		assert_int_equal(status, CAU_FAULTED);
		assert_non_null(strstr(error.reason, "does not hold"));
		*of.encoder = spared;
		chain_finish(&of);
	}
}

// A failed rule returns to the innermost guard. After that the outer guard is in force again.
static void test_guards_lie_in_one_another(void **unused)
{
	(void)unused;
	cau_rule_guard outer, inner;
	volatile int order = 0;
	cau_rule_enter(&outer);
	if (setjmp(outer.place) == 0) {
		cau_rule_enter(&inner);
		if (setjmp(inner.place) == 0)
			CAU_RULE(order < 0, "order %d", order);
		else
			order = order * 10 + 1;
		cau_rule_leave(&inner);
		CAU_RULE_INDEX(order, 1);
	} else {
		order = order * 10 + 2;
	}
	cau_rule_leave(&outer);
	assert_int_equal(order, 12);
	assert_non_null(strstr(inner.reason, "order < 0 does not hold: order 0"));
	assert_non_null(strstr(outer.reason, "number 1 of 1"));
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_refused_frames_leave_the_state),
		cmocka_unit_test(test_old_and_repeated_frames_are_refused),
		cmocka_unit_test(test_every_truncation_is_refused),
		cmocka_unit_test(test_a_damaged_frame_asks_for_a_key_frame),
		cmocka_unit_test(test_flipped_bits_never_do_harm),
		cmocka_unit_test(test_a_bad_sample_leaves_the_chain),
		cmocka_unit_test(test_a_spoilt_chain_makes_no_frame),
		cmocka_unit_test(test_guards_lie_in_one_another),
		cmocka_unit_test(test_definitions_are_checked),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
