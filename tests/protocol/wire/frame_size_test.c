// SPDX-License-Identifier: GPL-3.0-or-later
// Measures the size and cost of a stream with the default channels, for a grid of 3,136 vertices
// like the fascia.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include <cmocka.h>

#include "cautery/frame_codec.h"
#include "protocol/wire/tissue.h"

enum { SIDE = 56, FRAMES = 300 };

// Largest number of bytes for each vertex that moved by a step (0.05 mm) or more. Whole frames are
// counted: header, mask, scalars, tools and all.
static const double bytes_per_vertex_most = 1.6;
// Largest number of bytes for each moved vertex in fast motion, where the noise of each vertex
// alone is several steps a frame.
static const double fast_bytes_per_vertex_most = 2.0;
// Largest number of bytes for each vertex in a key frame, which has whole positions. In single
// precision a position would need 12 bytes.
static const double key_bytes_per_vertex_most = 4.0;

static double now_us(void)
{
	struct timespec time;
	clock_gettime(CLOCK_MONOTONIC, &time);
	return 1e6 * (double)time.tv_sec + 1e-3 * (double)time.tv_nsec;
}

typedef struct figures {
	double bytes_per_vertex, key_bytes_per_vertex;
	double encode_us, decode_us; // mean time of a frame
} figures;

// Counts vertices that moved by a step or more. Frames also carry a few vertices between the moved
// vertices.
static int32_t count_moved(const cau_frame_decoder *decoder, const int32_t *before, int32_t count)
{
	const int32_t *now = cau_frame_decoder_state(decoder)->quantised;
	int32_t moved = 0;
	for (int32_t vertex = 0; vertex < count; vertex++)
		moved += memcmp(now + 3 * vertex, before + 3 * vertex, 12) != 0;
	return moved;
}

static figures measure(double speed_m_s)
{
	tissue moved;
	tissue_init(&moved, SIDE, SIDE);
	cau_stream_def def = cau_default_stream_def();
	def.vertex_count = moved.vertex_count;
	def.face_count = moved.face_count;
	size_t encoder_bytes = cau_frame_encoder_bytes(&def), capacity = cau_frame_bytes_max(&def);
	size_t decoder_bytes = cau_frame_decoder_bytes(&def), count;
	cau_frame_encoder *encoder;
	cau_frame_decoder *decoder;
	uint8_t *frame = malloc(capacity);
	assert_int_equal(
		cau_frame_encoder_init(malloc(encoder_bytes), encoder_bytes, &def, 1, &encoder, NULL),
		CAU_OK);
	assert_int_equal(
		cau_frame_decoder_init(malloc(decoder_bytes), decoder_bytes, &def, &decoder, NULL), CAU_OK);
	size_t bytes_held = 12 * (size_t)moved.vertex_count;
	int32_t *before = malloc(bytes_held);
	figures sum = {0};
	double bytes = 0, vertices = 0;
	for (int32_t tick = 0; tick <= FRAMES; tick++) {
		tissue_move(&moved, tick, speed_m_s);
		cau_stream_sample sample = tissue_sample(&moved);
		double start = now_us();
		assert_int_equal(cau_frame_encode(encoder, &sample, frame, capacity, &count, NULL), CAU_OK);
		double encoded = now_us();
		memcpy(before, cau_frame_decoder_state(decoder)->quantised, bytes_held);
		double decoding = now_us();
		assert_int_equal(cau_frame_decode(decoder, frame, count, NULL), CAU_OK);
		if (tick == 0)
			continue;
		sum.encode_us += (encoded - start) / FRAMES;
		sum.decode_us += (now_us() - decoding) / FRAMES;
		bytes += (double)count;
		vertices += count_moved(decoder, before, moved.vertex_count);
	}
	assert_int_equal(cau_frame_encode_key(encoder, frame, capacity, &count, NULL), CAU_OK);
	sum.key_bytes_per_vertex = (double)count / moved.vertex_count;
	sum.bytes_per_vertex = bytes / vertices;
	free(encoder);
	free(decoder);
	free(frame);
	free(before);
	tissue_finish(&moved);
	return sum;
}

static void test_frames_are_small(void **unused)
{
	(void)unused;
	const struct {
		double speed_m_s, most;
	} cases[] = {{0.002, bytes_per_vertex_most},
	             {0.01, bytes_per_vertex_most},
	             {0.05, bytes_per_vertex_most},
	             {0.2, fast_bytes_per_vertex_most}};
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		figures is = measure(cases[i].speed_m_s);
		printf("%5.3f m/s: %.2f B a vertex, key frame %.2f B, encode %.0f us, decode %.0f us\n",
		       cases[i].speed_m_s, is.bytes_per_vertex, is.key_bytes_per_vertex, is.encode_us,
		       is.decode_us);
		assert_true(is.bytes_per_vertex <= cases[i].most);
		assert_true(is.key_bytes_per_vertex <= key_bytes_per_vertex_most);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {cmocka_unit_test(test_frames_are_small)};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
