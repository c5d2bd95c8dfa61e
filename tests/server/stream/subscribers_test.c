// SPDX-License-Identifier: GPL-3.0-or-later
// Checks which frames subscribers get. The test puts the frames into the stream itself, at its own
// times.
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "stream/internal.h"

enum { VERTICES = 60, FACES = 64, BOUND = 4000, TOLERATED = 3, STEADY = 600 };

typedef struct scene {
	cau_streams streams;
	cau_stream *stream;
	double position[3 * VERTICES], now_s;
	uint32_t mask[(FACES + 31) / 32];
	uint64_t tick;
	cau_frame_decoder *decoder;
} scene;

// ---- a stream without a session -----------------------------------------------------------------
static void open_stream(scene *s)
{
	cau_stream *stream = s->stream = &s->streams.stream[0];
	cau_stream_def def = cau_default_stream_def();
	def.vertex_count = VERTICES;
	def.face_count = FACES;
	def.channels = CAU_CHANNEL_POSITIONS | CAU_CHANNEL_MASK;
	*stream = (cau_stream){.used = true, .epoch = 7, .rate_hz = 60, .def = def, .subscribers = 1};
	size_t bytes = cau_frame_encoder_bytes(&def);
	stream->scratch_bytes = cau_frame_bytes_max(&def);
	stream->storage = cau_shelf_take(s->streams.profile_shelf, bytes + stream->scratch_bytes);
	stream->scratch = (unsigned char *)stream->storage + bytes;
	stream->topology = cau_buffer_create(1, true);
	assert_int_equal(
		cau_frame_encoder_init(stream->storage, bytes, &def, 7, &stream->encoder, NULL), CAU_OK);
	bytes = cau_frame_decoder_bytes(&def);
	assert_int_equal(cau_frame_decoder_init(malloc(bytes), bytes, &def, &s->decoder, NULL), CAU_OK);
}

static void scene_init(scene *s)
{
	*s = (scene){.now_s = 100};
	s->streams = (cau_streams){.id = "d1-test", .in_flight_most = BOUND};
	cau_streams_init(&s->streams);
	open_stream(s);
}

static void scene_finish(scene *s)
{
	cau_streams_finish(&s->streams);
	free(s->decoder);
}

static void put(cau_ring_frame *slot, uint64_t sequence, cau_buffer *buffer)
{
	cau_buffer_release(slot->buffer);
	*slot = (cau_ring_frame){sequence, buffer};
}

// Makes the next frame as publish.c does, and a key frame if one is requested.
static void publish(scene *s)
{
	cau_stream *stream = s->stream;
	size_t bytes;
	for (int i = 0; i < 3 * VERTICES; i++)
		s->position[i] = 0.001 * (double)((s->tick * 7 + (uint64_t)i * 13) % 101);
	cau_stream_sample sample = {
		.tick = ++s->tick, .position = s->position, .face_mask = s->mask, .time_s = 0};
	assert_int_equal(cau_frame_encode(stream->encoder, &sample, stream->scratch,
	                                  stream->scratch_bytes, &bytes, NULL),
	                 CAU_OK);
	uint64_t sequence = cau_frame_encoder_sequence(stream->encoder);
	cau_buffer *buffer = cau_ring_take(stream, bytes);
	put(sequence == 1 ? &stream->key : &stream->ring[sequence % RING_FRAMES], sequence, buffer);
	stream->newest = sequence;
	stream->newest_s = s->now_s;
	cau_half_publish(&s->streams, stream);
	if (!stream->key_wanted)
		return;
	stream->key_wanted = false;
	assert_int_equal(
		cau_frame_encode_key(stream->encoder, stream->scratch, stream->scratch_bytes, &bytes, NULL),
		CAU_OK);
	put(&stream->key, sequence, cau_ring_take(stream, bytes));
}

// Takes the frame that the subscriber gets now. Returns its header; sequence 0 if there is none.
static cau_frame_header take(scene *s, cau_subscriber *sub)
{
	cau_frame_header header = {0};
	cau_error error = {0};
	bool wake, wanted = s->stream->key_wanted;
	cau_buffer *frame = cau_streams_next_frame(&s->streams, sub, s->now_s, &wake);
	if (!wanted)
		assert_int_equal(wake, s->stream->key_wanted);
	if (!frame)
		return header;
	if (frame != s->stream->topology) {
		assert_int_equal(
			cau_frame_header_read(cau_buffer_bytes(frame), frame->byte_count, &header, NULL),
			CAU_OK);
		if (cau_frame_decode(s->decoder, cau_buffer_bytes(frame), frame->byte_count, &error))
			fail_msg("sequence %llu: %s", (unsigned long long)header.sequence, error.reason);
	}
	cau_buffer_release(frame);
	return header;
}

// Checks that the decoder, which took every frame, has the newest state.
static void assert_newest(const scene *s)
{
	const cau_stream_state *state = cau_frame_decoder_state(s->decoder);
	double held[3 * VERTICES];
	cau_frame_decoder_position(s->decoder, held);
	assert_int_equal(state->tick, s->tick);
	for (int i = 0; i < 3 * VERTICES; i++)
		assert_true(held[i] > s->position[i] - 2.6e-5 && held[i] < s->position[i] + 2.6e-5);
}

static cau_subscriber join(scene *s)
{
	cau_subscriber sub = {.key_asked_s = -1};
	publish(s);
	take(s, &sub); // takes the topology
	assert_int_equal(take(s, &sub).kind, CAU_FRAME_KEY);
	return sub;
}

// The subscriber takes nothing until its next delta has left the ring, then continues with a key
// frame.
static void fall(scene *s, cau_subscriber *sub)
{
	for (int i = 0; i < 3 * RING_FRAMES; i++)
		publish(s);
	assert_int_equal(take(s, sub).sequence, 0);
	assert_true(sub->wants_key);
	s->now_s += 2; // key frames come at most once a second
	take(s, sub);
	publish(s);
	assert_int_equal(take(s, sub).kind, CAU_FRAME_KEY);
}

static cau_subscriber slowed(scene *s)
{
	cau_subscriber sub = join(s);
	for (int i = 0; i <= TOLERATED; i++) {
		assert_false(sub.half);
		fall(s, &sub);
	}
	assert_true(sub.half);
	return sub;
}

// ---- tests --------------------------------------------------------------------------------------
static void test_every_frame_in_order(void **unused)
{
	(void)unused;
	scene s;
	scene_init(&s);
	cau_subscriber sub = join(&s);
	for (uint64_t i = 2; i < 50; i++) {
		publish(&s);
		cau_frame_header header = take(&s, &sub);
		assert_true(header.sequence == i && header.base_sequence == i - 1);
		assert_int_equal(take(&s, &sub).sequence, 0);
	}
	assert_newest(&s);
	scene_finish(&s);
}

static void test_beyond_the_bound_nothing_is_sent_until_it_acknowledges(void **unused)
{
	(void)unused;
	scene s;
	scene_init(&s);
	cau_subscriber sub = join(&s);
	cau_streams_acknowledge(&sub, 7, 1);
	uint64_t last = 1;
	for (int i = 0; i < 4 * RING_FRAMES; i++) {
		publish(&s);
		uint64_t sequence = take(&s, &sub).sequence;
		last = sequence ? sequence : last;
	}
	assert_true(last < s.stream->newest && sub.in_flight > BOUND);
	assert_true(sub.in_flight < BOUND + s.stream->scratch_bytes);
	cau_streams_acknowledge(&sub, 7, last);
	take(&s, &sub);
	publish(&s);
	assert_int_equal(take(&s, &sub).kind, CAU_FRAME_KEY);
	assert_newest(&s);
	scene_finish(&s);
}

// A client with a new decoder acknowledges frame 0. The bytes of frames that were already
// acknowledged must not be in flight again.
static void test_an_acknowledgement_of_less_takes_nothing_back(void **unused)
{
	(void)unused;
	scene s;
	scene_init(&s);
	cau_subscriber sub = join(&s);
	uint64_t last = 1;
	for (int i = 0; i < 4 * RING_FRAMES; i++) {
		publish(&s);
		last = take(&s, &sub).sequence;
		cau_streams_acknowledge(&sub, 7, last);
	}
	assert_int_equal(sub.in_flight, 0);
	cau_streams_acknowledge(&sub, 7, 0);
	assert_int_equal(sub.in_flight, 0);
	publish(&s);
	assert_int_equal(take(&s, &sub).sequence, last + 1);
	scene_finish(&s);
}

// More than SENT_FRAMES frames are in flight. The bytes of all these frames stay counted.
static void test_an_old_acknowledgement_frees_nothing(void **unused)
{
	(void)unused;
	scene s;
	scene_init(&s);
	s.streams.in_flight_most = SIZE_MAX;
	cau_subscriber sub = join(&s);
	size_t bytes = 0;
	for (int i = 0; i < 3 * SENT_FRAMES; i++) {
		publish(&s);
		size_t before = sub.in_flight;
		take(&s, &sub);
		bytes = sub.in_flight - before;
	}
	size_t all = sub.in_flight;
	cau_streams_acknowledge(&sub, 7, 2);
	assert_int_equal(sub.in_flight, all);
	cau_streams_acknowledge(&sub, 7, sub.sequence - 1);
	assert_int_equal(sub.in_flight, bytes);
	scene_finish(&s);
}

static void test_one_that_keeps_falling_goes_to_half_rate(void **unused)
{
	(void)unused;
	scene s;
	scene_init(&s);
	cau_subscriber sub = slowed(&s);
	int32_t twice = 0, once = 0;
	for (int i = 0; i < 40; i++) {
		publish(&s);
		cau_frame_header header = take(&s, &sub);
		twice += header.sequence && header.sequence == header.base_sequence + 2;
		once += header.sequence && header.sequence == header.base_sequence + 1;
	}
	assert_true(twice >= 18 && once <= 3); // single frames come only until the first thinned frame
	if (s.stream->newest % 2) {
		publish(&s);
		take(&s, &sub);
	}
	assert_newest(&s);
	scene_finish(&s);
}

static void test_others_keep_the_full_rate(void **unused)
{
	(void)unused;
	scene s;
	scene_init(&s);
	cau_subscriber slow = slowed(&s);
	cau_frame_decoder *of_slow = s.decoder;
	size_t bytes = cau_frame_decoder_bytes(&s.stream->def);
	assert_int_equal(cau_frame_decoder_init(malloc(bytes), bytes, &s.stream->def, &s.decoder, NULL),
	                 CAU_OK);
	cau_subscriber quick = {.key_asked_s = -1};
	take(&s, &quick);
	if (!take(&s, &quick).sequence) {
		publish(&s);
		take(&s, &quick);
	}
	for (int i = 0; i < 20; i++) {
		publish(&s);
		assert_int_equal(take(&s, &quick).base_sequence, s.stream->newest - 1);
	}
	assert_newest(&s);
	free(of_slow);
	cau_stream_counts counts;
	cau_streams_count(&s.streams, &counts);
	assert_int_equal(counts.half_rate, 1);
	cau_streams_leave(&s.streams, &slow);
	cau_streams_count(&s.streams, &counts);
	assert_int_equal(counts.half_rate, 0);
	scene_finish(&s);
}

static void test_a_last_single_frame_is_not_kept_back(void **unused)
{
	(void)unused;
	scene s;
	scene_init(&s);
	cau_subscriber sub = slowed(&s);
	do {
		publish(&s);
		take(&s, &sub);
	} while (s.stream->newest % 2 || s.stream->newest != sub.sequence);
	publish(&s); // the last frame, for example before a pause
	assert_int_equal(take(&s, &sub).sequence, 0);
	s.now_s += 0.3;
	assert_int_equal(take(&s, &sub).sequence, s.stream->newest);
	assert_newest(&s);
	scene_finish(&s);
}

static void test_one_that_keeps_up_comes_back_on_trial(void **unused)
{
	(void)unused;
	scene s;
	scene_init(&s);
	cau_subscriber sub = slowed(&s);
	for (int i = 0; i < 2 * STEADY + 4; i++) {
		publish(&s);
		take(&s, &sub);
	}
	assert_false(sub.half);
	publish(&s);
	while (take(&s, &sub).sequence)
		;
	assert_newest(&s);
	// After the earlier falls, one more fall is enough for half the rate.
	fall(&s, &sub);
	assert_true(sub.half);
	scene_finish(&s);
}

static void test_falls_are_forgotten_in_time(void **unused)
{
	(void)unused;
	scene s;
	scene_init(&s);
	cau_subscriber sub = join(&s);
	for (int i = 0; i < 3 * TOLERATED; i++) {
		fall(&s, &sub);
		for (int k = 0; k < STEADY; k++) {
			publish(&s);
			take(&s, &sub);
		}
	}
	assert_false(sub.half);
	scene_finish(&s);
}

// If the key frame cannot be encoded, none is made, and no subscriber is woken.
static void test_a_key_frame_that_fails_wakes_nobody(void **state)
{
	(void)state;
	scene s;
	cau_error error = {0};
	bool made = true;
	scene_init(&s);
	publish(&s);
	s.stream->key_wanted = true;
	// The time is set so that no delta is due.
	s.stream->next_s = s.now_s + 1;
	s.stream->scratch_bytes = 0;
	cau_stream_moment moment = {.now_s = s.now_s};
	assert_int_not_equal(cau_streams_publish(&s.streams, &moment, &made, &error), CAU_OK);
	assert_false(made);
	assert_false(s.stream->key_wanted);
	scene_finish(&s);
}

// ---- work of the builder before a join ----------------------------------------------------------
static cau_buffer *joined_topology(cau_streams *streams, const cau_stream_shape *shape)
{
	cau_stream_wish wish = {.rate_hz = 60, .step_m = 1e-5, .channels = CAU_CHANNEL_POSITIONS};
	const cau_stream *stream;
	bool woken;
	cau_streams_restart(streams);
	assert_int_equal(cau_streams_join(streams, &wish, shape, &stream, &woken, NULL), CAU_OK);
	return stream->topology;
}

// A new session has no epoch yet. The topology that the builder encodes is equal to the one that
// the first join would encode.
static void test_a_topology_is_encoded_before_anybody_joins(void **state)
{
	(void)state;
	int32_t face[3 * FACES], layer[FACES] = {0};
	double rest[3 * VERTICES];
	cau_error error = {0};
	for (int i = 0; i < 3 * FACES; i++)
		face[i] = (i * 7 + i / 3) % VERTICES;
	for (int i = 0; i < 3 * VERTICES; i++)
		rest[i] = 0.001 * (i * 13 % 101);
	cau_stream_shape shape = {VERTICES, FACES, face, layer, NULL, rest};
	cau_streams stocked = {.id = "d1-test", .subscribers_most = 1}, bare = stocked;
	cau_streams_init(&stocked);
	cau_streams_init(&bare);
	if (cau_streams_stock(&stocked, &shape, &error))
		fail_msg("%s", error.reason);
	assert_non_null(stocked.topology);
	cau_buffer *one = joined_topology(&stocked, &shape), *two = joined_topology(&bare, &shape);
	assert_int_equal(one->byte_count, two->byte_count);
	assert_memory_equal((char *)cau_buffer_bytes(one) + CAU_FRAME_HEADER_BYTES,
	                    (char *)cau_buffer_bytes(two) + CAU_FRAME_HEADER_BYTES,
	                    one->byte_count - CAU_FRAME_HEADER_BYTES);
	cau_streams_finish(&stocked);
	cau_streams_finish(&bare);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_every_frame_in_order),
		cmocka_unit_test(test_beyond_the_bound_nothing_is_sent_until_it_acknowledges),
		cmocka_unit_test(test_an_acknowledgement_of_less_takes_nothing_back),
		cmocka_unit_test(test_an_old_acknowledgement_frees_nothing),
		cmocka_unit_test(test_one_that_keeps_falling_goes_to_half_rate),
		cmocka_unit_test(test_others_keep_the_full_rate),
		cmocka_unit_test(test_a_last_single_frame_is_not_kept_back),
		cmocka_unit_test(test_one_that_keeps_up_comes_back_on_trial),
		cmocka_unit_test(test_falls_are_forgotten_in_time),
		cmocka_unit_test(test_a_key_frame_that_fails_wakes_nobody),
		cmocka_unit_test(test_a_topology_is_encoded_before_anybody_joins),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
