// SPDX-License-Identifier: GPL-3.0-or-later
#include "cautery/frame_codec.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "protocol/wire/chain.h"

enum { ROUND_FRAMES = 120 };

static void test_deltas_follow_the_tissue(void **unused)
{
	(void)unused;
	// Speeds in m/s, at which the numbers in frames have 1, 1, 2 and 4 bytes.
	const double speeds[] = {0.002, 0.2, 30.0, 4000.0};
	for (size_t s = 0; s < sizeof speeds / sizeof *speeds; s++) {
		chain of;
		chain_init(&of, 23, 17);
		for (int32_t tick = 0; tick < ROUND_FRAMES; tick++) {
			tissue_move(&of.tissue, tick, speeds[s]);
			chain_pass(&of);
			assert_int_equal(of.bytes[5], tick == 0 ? CAU_FRAME_KEY : CAU_FRAME_DELTA);
			chain_assert_holds(of.decoder, &of.tissue);
		}
		chain_finish(&of);
	}
}

static void test_hidden_vertices_wait_until_they_are_seen(void **unused)
{
	(void)unused;
	chain of;
	chain_init(&of, 12, 9);
	srand(5);
	int32_t hidden_carried = 0;
	for (int32_t tick = 0; tick < ROUND_FRAMES; tick++) {
		tissue_move(&of.tissue, tick, 0.05);
		for (int32_t v = 0; v < of.tissue.vertex_count; v++)
			of.tissue.visible[v] = tick == 0 || rand() % 4 > 0;
		int32_t before[3];
		memcpy(before, cau_frame_decoder_state(of.decoder)->quantised, sizeof before);
		chain_pass(&of);
		chain_assert_holds(of.decoder, &of.tissue);
		if (!of.tissue.visible[0]) {
			assert_memory_equal(before, cau_frame_decoder_state(of.decoder)->quantised,
			                    sizeof before);
			hidden_carried++;
		}
	}
	assert_true(hidden_carried > 0);
	chain_finish(&of);
}

// A face becomes visible when the faces above it are cut away. Its vertices may have moved while
// hidden. Their positions must come with the frame that draws the face: at full rate, at half rate,
// and for a late joiner.
static void test_a_face_that_is_laid_open_comes_with_its_vertices(void **unused)
{
	(void)unused;
	// Number of the frame that shows the face. It is even, because half rate has only even frames.
	enum { LAID_OPEN = 20 };
	chain of;
	chain_init(&of, 12, 9);
	size_t bytes = cau_frame_thinner_bytes(&of.def);
	cau_frame_thinner *thinner;
	assert_int_equal(cau_frame_thinner_init(malloc(bytes), bytes, of.encoder, &thinner, NULL),
	                 CAU_OK);
	cau_frame_decoder *half = chain_new_decoder(&of.def), *late = chain_new_decoder(&of.def);
	uint8_t *other = malloc(of.capacity);
	for (int32_t tick = 1; tick <= LAID_OPEN; tick++) {
		tissue_move(&of.tissue, tick, 0.3);
		memset(of.tissue.visible, tick == LAID_OPEN, 20);
		of.tissue.mask[0] = tick == LAID_OPEN ? 0 : 0xff;
		chain_pass(&of);
		assert_int_equal(cau_frame_thin(thinner, other, of.capacity, &bytes, NULL), CAU_OK);
		if (tick == 4) // `half` joins at an even sequence, while the vertices are hidden
			assert_int_equal(cau_frame_encode_key(of.encoder, other, of.capacity, &bytes, NULL),
			                 CAU_OK);
		if (tick >= 4 && bytes)
			assert_int_equal(cau_frame_decode(half, other, bytes, NULL), CAU_OK);
	}
	chain_assert_holds(of.decoder, &of.tissue);
	chain_assert_holds(half, &of.tissue);
	assert_int_equal(cau_frame_encode_key(of.encoder, other, of.capacity, &bytes, NULL), CAU_OK);
	assert_int_equal(cau_frame_decode(late, other, bytes, NULL), CAU_OK);
	chain_assert_holds(late, &of.tissue);
	free(thinner);
	free(half);
	free(late);
	free(other);
	chain_finish(&of);
}

// A decoder without the mask cannot know the hidden vertices, so it gets every vertex.
static void test_without_the_mask_nothing_is_stale(void **unused)
{
	(void)unused;
	chain of;
	chain_init(&of, 12, 9);
	of.def.channels = CAU_CHANNEL_POSITIONS | CAU_CHANNEL_EXPOSURE;
	assert_int_equal(cau_frame_encoder_init(of.encoder, cau_frame_encoder_bytes(&of.def), &of.def,
	                                        CHAIN_EPOCH, &of.encoder, NULL),
	                 CAU_OK);
	cau_frame_decoder *decoder = chain_new_decoder(&of.def);
	double position[3 * 12 * 9];
	memset(of.tissue.visible, 0, 12 * 9);
	for (int32_t tick = 0; tick < 10; tick++) {
		tissue_move(&of.tissue, tick, 0.3);
		chain_encode(&of);
		assert_int_equal(cau_frame_decode(decoder, of.bytes, of.byte_count, NULL), CAU_OK);
		cau_frame_decoder_position(decoder, position);
		for (int32_t i = 0; i < 3 * 12 * 9; i++)
			assert_true(fabs(position[i] - of.tissue.position[i]) <= 0.5001 * of.def.step_m);
	}
	free(decoder);
	chain_finish(&of);
}

static void test_key_frame_equals_the_chain(void **unused)
{
	(void)unused;
	chain of;
	chain_init(&of, 14, 11);
	uint8_t *key = malloc(of.capacity);
	for (int32_t tick = 0; tick < 40; tick++) {
		tissue_move(&of.tissue, tick, 0.1);
		of.tissue.visible[(tick * 7) % of.tissue.vertex_count] = 0;
		chain_pass(&of);
		size_t key_bytes;
		assert_int_equal(cau_frame_encode_key(of.encoder, key, of.capacity, &key_bytes, NULL),
		                 CAU_OK);
		cau_frame_decoder *late = chain_new_decoder(&of.def);
		assert_int_equal(cau_frame_decode(late, key, key_bytes, NULL), CAU_OK);
		chain_assert_same(of.decoder, late);
		// both decoders continue with the same states
		for (int32_t later = 1; later <= 3; later++) {
			tissue_move(&of.tissue, ++tick, 0.1);
			chain_pass(&of);
			assert_int_equal(cau_frame_decode(late, of.bytes, of.byte_count, NULL), CAU_OK);
			chain_assert_same(of.decoder, late);
		}
		free(late);
	}
	free(key);
	chain_finish(&of);
}

static void test_a_still_tissue_costs_next_to_nothing(void **unused)
{
	(void)unused;
	chain of;
	chain_init(&of, 30, 30);
	chain_pass(&of);
	chain_pass(&of);
	// Size of five sections: one tool, the tool's raw force, the statistics, no vessel and no
	// contact.
	size_t records = 5 * 8 + 84 + 28 + 112 + 4 + 4;
	assert_int_equal(of.byte_count, CAU_FRAME_HEADER_BYTES + records);
	assert_int_equal(cau_frame_decoder_state(of.decoder)->moved_count, 0);
	chain_finish(&of);
}

static void test_errors_never_add_up(void **unused)
{
	(void)unused;
	chain of;
	chain_init(&of, 8, 8);
	// 50 s of slow motion, under a tenth of a step a frame
	for (int32_t tick = 0; tick < 3000; tick++) {
		tissue_move(&of.tissue, tick, 0.0002);
		chain_pass(&of);
	}
	chain_assert_holds(of.decoder, &of.tissue);
	chain_finish(&of);
}

static void test_a_new_epoch_starts_with_a_key_frame(void **unused)
{
	(void)unused;
	chain of;
	chain_init(&of, 6, 6);
	tissue_move(&of.tissue, 30, 0.05);
	chain_pass(&of);
	tissue_move(&of.tissue, 31, 0.05);
	chain_encode(&of); // this frame is still on its way when the session is rewound
	uint8_t *late = malloc(of.byte_count);
	size_t late_bytes = of.byte_count;
	memcpy(late, of.bytes, late_bytes);
	cau_frame_encoder_restart(of.encoder, CHAIN_EPOCH + 1);
	tissue_move(&of.tissue, 2, 0.05);
	chain_pass(&of);
	assert_int_equal(of.bytes[5], CAU_FRAME_KEY);
	assert_true(cau_frame_decoder_state(of.decoder)->epoch == CHAIN_EPOCH + 1);
	assert_int_equal(cau_frame_decode(of.decoder, late, late_bytes, NULL), CAU_BAD_STATE);
	chain_assert_holds(of.decoder, &of.tissue);
	free(late);
	chain_finish(&of);
}

static void test_scalars_saturate(void **unused)
{
	(void)unused;
	chain of;
	chain_init(&of, 6, 6);
	of.tissue.exposure[0] = 3.0f;
	of.tissue.exposure[1] = -1.0f;
	of.tissue.exposure[2] = NAN;
	of.tissue.stress[0] = 1e30f;
	of.tissue.temperature[0] = -20.2f;
	of.tissue.temperature[1] = -19.7f;
	of.tissue.temperature[2] = 37.0f;
	of.tissue.temperature[3] = 170.1f;
	of.tissue.temperature[4] = 1e6f;
	of.tissue.temperature[5] = NAN;
	chain_encode(&of);
	assert_int_equal(cau_frame_decode(of.decoder, of.bytes, of.byte_count, NULL), CAU_OK);
	const cau_stream_state *state = cau_frame_decoder_state(of.decoder);
	assert_int_equal(state->exposure[0], 255);
	assert_int_equal(state->exposure[1], 0);
	assert_int_equal(state->exposure[2], 0);
	assert_int_equal(state->stress[0], 65535);
	const uint32_t temperature[] = {0, 1, 228, 760, 65535, 0}; // quarters of a degree from -20
	assert_memory_equal(state->temperature, temperature, sizeof temperature);
	chain_finish(&of);
}

static void test_a_stream_carries_its_channels_alone(void **unused)
{
	(void)unused;
	for (uint32_t channels = 0; channels <= CAU_CHANNEL_ALL; channels++) {
		tissue still;
		tissue_init(&still, 5, 5);
		cau_stream_def def = tissue_stream_def(&still);
		def.channels = channels;
		size_t bytes = cau_frame_encoder_bytes(&def), capacity = cau_frame_bytes_max(&def), count;
		cau_frame_encoder *encoder;
		assert_int_equal(
			cau_frame_encoder_init(malloc(bytes), bytes, &def, CHAIN_EPOCH, &encoder, NULL),
			CAU_OK);
		cau_frame_decoder *decoder = chain_new_decoder(&def);
		uint8_t *frame = malloc(capacity);
		cau_stream_sample sample = {.time_s = 0.5,
		                            .position =
		                                channels & CAU_CHANNEL_POSITIONS ? still.position : NULL,
		                            .face_mask = channels & CAU_CHANNEL_MASK ? still.mask : NULL,
		                            .tool_count = 1,
		                            .tools = still.tools,
		                            .statistics = &still.statistics};
		for (int scalar = 0; scalar < CAU_SCALAR_COUNT; scalar++)
			if (channels & cau_scalar_channel((cau_scalar)scalar))
				sample.scalar[scalar] = still.scalar[scalar];
		for (int frames = 0; frames < 3; frames++) {
			assert_int_equal(cau_frame_encode(encoder, &sample, frame, capacity, &count, NULL),
			                 CAU_OK);
			assert_int_equal(cau_frame_decode(decoder, frame, count, NULL), CAU_OK);
		}
		assert_int_equal(cau_frame_decoder_state(decoder)->tool_count,
		                 channels & CAU_CHANNEL_TOOLS ? 1 : 0);
		free(encoder);
		free(decoder);
		free(frame);
		tissue_finish(&still);
	}
}

// True if positions or mask, the first sections, use the codec (byte 2 of their elements).
static bool any_coded(const uint8_t *frame, size_t byte_count)
{
	bool coded = false;
	const uint8_t *at = frame + CAU_FRAME_HEADER_BYTES;
	while (at < frame + byte_count && at[0] <= CAU_SECTION_MASK) {
		uint32_t payload_bytes;
		memcpy(&payload_bytes, at + 4, sizeof payload_bytes);
		at += CAU_FRAME_SECTION_BYTES;
		coded |= at[2] != 0;
		at += payload_bytes;
	}
	return coded;
}

// Encodes the same chain without the codec.
static void test_a_plain_stream_has_no_codec(void **unused)
{
	(void)unused;
	chain coded, plain;
	chain_init(&coded, 30, 30);
	chain_init(&plain, 30, 30);
	plain.def.plain = true;
	size_t bytes = cau_frame_encoder_bytes(&plain.def);
	assert_int_equal(
		cau_frame_encoder_init(plain.encoder, bytes, &plain.def, CHAIN_EPOCH, &plain.encoder, NULL),
		CAU_OK);
	for (int32_t tick = 0; tick < ROUND_FRAMES; tick++) {
		tissue_move(&coded.tissue, tick, 0.2);
		tissue_move(&plain.tissue, tick, 0.2);
		chain_pass(&coded);
		chain_pass(&plain);
		assert_true(any_coded(coded.bytes, coded.byte_count));
		assert_false(any_coded(plain.bytes, plain.byte_count));
		assert_true(plain.byte_count > coded.byte_count);
		chain_assert_same(coded.decoder, plain.decoder);
	}
	chain_finish(&coded);
	chain_finish(&plain);
}

// Checks rules for the table in cautery/channels.h that the preprocessor cannot check.
static void test_rows_fit_together(void **unused)
{
	(void)unused;
#define X(code, number, name) number,
	static const int others[] = {CAU_OTHER_SECTION_TABLE(X)};
#undef X
	for (int i = 0; i < CAU_CHANNEL_COUNT; i++) {
		const cau_channel_info *info = cau_channel_describe((cau_channel_index)i);
		if (i > 0)
			assert_true(info->section > cau_channel_describe((cau_channel_index)(i - 1))->section);
		for (size_t k = 0; k < sizeof others / sizeof *others; k++)
			assert_int_not_equal(info->section, others[k]);
		if (info->scalar < 0)
			continue;
		assert_true(info->most == 255 || info->most == 65535);
		assert_true(info->step > 0 || i == CAU_CHANNEL_INDEX_STRESS);
		assert_int_equal(cau_scalar_channel((cau_scalar)info->scalar), 1u << i);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_a_plain_stream_has_no_codec),
		cmocka_unit_test(test_rows_fit_together),
		cmocka_unit_test(test_deltas_follow_the_tissue),
		cmocka_unit_test(test_hidden_vertices_wait_until_they_are_seen),
		cmocka_unit_test(test_a_face_that_is_laid_open_comes_with_its_vertices),
		cmocka_unit_test(test_without_the_mask_nothing_is_stale),
		cmocka_unit_test(test_key_frame_equals_the_chain),
		cmocka_unit_test(test_a_still_tissue_costs_next_to_nothing),
		cmocka_unit_test(test_errors_never_add_up),
		cmocka_unit_test(test_a_new_epoch_starts_with_a_key_frame),
		cmocka_unit_test(test_scalars_saturate),
		cmocka_unit_test(test_a_stream_carries_its_channels_alone),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
