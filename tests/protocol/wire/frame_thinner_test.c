// SPDX-License-Identifier: GPL-3.0-or-later
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "protocol/wire/chain.h"

enum { ROUND_FRAMES = 60 };

typedef struct thinned {
	chain chain;
	cau_frame_thinner *thinner;
	cau_frame_decoder *slow;
	uint8_t *bytes;
	size_t byte_count; // size of the last delta over two frames, or 0 if there was none
} thinned;

static void thinned_init(thinned *made)
{
	chain_init(&made->chain, 13, 10);
	size_t bytes = cau_frame_thinner_bytes(&made->chain.def);
	cau_frame_thinner *refused = NULL;
	void *storage = malloc(bytes);
	assert_int_equal(
		cau_frame_thinner_init(storage, bytes - 1, made->chain.encoder, &refused, NULL), CAU_LIMIT);
	assert_int_equal(
		cau_frame_thinner_init(storage, bytes, made->chain.encoder, &made->thinner, NULL), CAU_OK);
	made->slow = chain_new_decoder(&made->chain.def);
	made->bytes = malloc(made->chain.capacity);
	srand(11);
}

static void thinned_finish(thinned *made)
{
	chain_finish(&made->chain);
	free(made->thinner);
	free(made->slow);
	free(made->bytes);
}

static uint64_t sequence_of(const cau_frame_decoder *decoder)
{
	return cau_frame_decoder_state(decoder)->sequence;
}

// Advances the chain by a frame, with vertices that appear and disappear, and calls the thinner.
static void advance(thinned *of, int32_t tick)
{
	tissue *t = &of->chain.tissue;
	tissue_move(t, tick, 0.1);
	for (int32_t v = 0; v < t->vertex_count; v++)
		t->visible[v] = tick == 0 || rand() % 3 > 0;
	chain_pass(&of->chain);
	assert_int_equal(
		cau_frame_thin(of->thinner, of->bytes, of->chain.capacity, &of->byte_count, NULL), CAU_OK);
}

static void decode(cau_frame_decoder *decoder, const void *bytes, size_t byte_count)
{
	cau_error error = {0};
	if (cau_frame_decode(decoder, bytes, byte_count, &error))
		fail_msg("%s: %s", error.path, error.reason);
}

static void test_every_second_frame_makes_the_same_state(void **unused)
{
	(void)unused;
	thinned of;
	int32_t thin = 0;
	thinned_init(&of);
	for (int32_t tick = 0; tick < ROUND_FRAMES; tick++) {
		advance(&of, tick);
		uint64_t sequence = sequence_of(of.chain.decoder);
		assert_int_equal(of.byte_count > 0, sequence > 2 && sequence % 2 == 0);
		// Before the first thin frame, the slow decoder gets the frames of the chain.
		if (sequence <= 2) {
			decode(of.slow, of.chain.bytes, of.chain.byte_count);
		} else if (of.byte_count) {
			decode(of.slow, of.bytes, of.byte_count);
			thin++;
		}
		if (sequence % 2 == 0)
			chain_assert_same(of.slow, of.chain.decoder);
	}
	assert_int_equal(thin, ROUND_FRAMES / 2 - 1);
	thinned_finish(&of);
}

static void test_a_decoder_goes_over_and_back(void **unused)
{
	(void)unused;
	thinned of;
	thinned_init(&of);
	for (int32_t tick = 0; tick < ROUND_FRAMES; tick++) {
		advance(&of, tick);
		bool half = (tick / 10) % 2 == 1;
		if (!half)
			decode(of.slow, of.chain.bytes, of.chain.byte_count);
		else if (of.byte_count)
			decode(of.slow, of.bytes, of.byte_count);
		if (sequence_of(of.slow) == sequence_of(of.chain.decoder))
			chain_assert_same(of.slow, of.chain.decoder);
	}
	assert_int_equal(sequence_of(of.slow), ROUND_FRAMES);
	thinned_finish(&of);
}

// The thinner's kept state is not a valid base after a pause or in another epoch.
static void test_it_starts_anew_after_a_pause_and_in_an_epoch(void **unused)
{
	(void)unused;
	thinned of;
	thinned_init(&of);
	for (int32_t tick = 0; tick < 4; tick++)
		advance(&of, tick);
	assert_true(of.byte_count > 0);
	for (int32_t tick = 4; tick < 7; tick++) { // during these ticks no client wants half the rate
		tissue_move(&of.chain.tissue, tick, 0.1);
		chain_pass(&of.chain);
	}
	advance(&of, 7);
	assert_int_equal(of.byte_count, 0);
	for (int32_t tick = 8; tick < 10; tick++)
		advance(&of, tick);
	assert_true(of.byte_count > 0);
	cau_frame_encoder_restart(of.chain.encoder, CHAIN_EPOCH + 1);
	for (int32_t tick = 0; tick < 2; tick++)
		advance(&of, tick);
	assert_int_equal(of.byte_count, 0);
	thinned_finish(&of);
}

// The second tool appears with tick 8, in a frame that the half-rate decoder does not get.
static void test_a_new_tool_is_named(void **unused)
{
	(void)unused;
	thinned of;
	thinned_init(&of);
	for (int32_t tick = 0; tick < 10; tick++) {
		advance(&of, tick);
		if (tick < 8)
			decode(of.slow, of.chain.bytes, of.chain.byte_count);
	}
	assert_int_equal(cau_frame_decoder_state(of.slow)->tool_count, 1);
	decode(of.slow, of.bytes, of.byte_count);
	assert_int_equal(cau_frame_decoder_state(of.slow)->tool_count, 2);
	chain_assert_same(of.slow, of.chain.decoder);
	thinned_finish(&of);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_every_second_frame_makes_the_same_state),
		cmocka_unit_test(test_a_decoder_goes_over_and_back),
		cmocka_unit_test(test_it_starts_anew_after_a_pause_and_in_an_epoch),
		cmocka_unit_test(test_a_new_tool_is_named),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
