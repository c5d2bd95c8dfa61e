// SPDX-License-Identifier: GPL-3.0-or-later
// Tests that the core computes costly channels only while a subscriber receives them.
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "cautery/defaults.h"
#include "hosted_session/internal.h"

static void no_frames(void *user)
{
	(void)user;
}

static void open_stream(cau_hosted *h)
{
	cau_session_info info;
	cau_session_describe(h->core.session, &info);
	cau_stream_def def = cau_default_stream_def();
	def.vertex_count = info.vertex_count;
	def.face_count = info.face_count;
	def.channels = CAU_CHANNEL_POSITIONS | CAU_CHANNEL_TEMPERATURE;
	cau_stream *stream = &h->frames.streams.stream[0];
	*stream = (cau_stream){.used = true, .epoch = 7, .rate_hz = 60, .def = def};
	size_t bytes = cau_frame_encoder_bytes(&def);
	stream->scratch_bytes = cau_frame_bytes_max(&def);
	stream->storage =
		cau_shelf_take(h->frames.streams.profile_shelf, bytes + stream->scratch_bytes);
	stream->scratch = (unsigned char *)stream->storage + bytes;
	assert_int_equal(
		cau_frame_encoder_init(stream->storage, bytes, &def, 7, &stream->encoder, NULL), CAU_OK);
}

static bool makes_temperature(cau_hosted *h, int32_t subscribers)
{
	cau_frame frame;
	h->frames.streams.stream[0].subscribers = subscribers;
	cau_frames_publish(h, 100);
	cau_session_frame(h->core.session, &frame);
	return frame.temperature != NULL;
}

static void temperature_is_made_while_it_is_watched(void **state)
{
	(void)state;
	cau_scene_def *scene = malloc(sizeof *scene);
	cau_hosted *h = calloc(1, sizeof *h);
	cau_surroundings around = {.sink.frames = no_frames};
	cau_session_def def = cau_default_session_def();
	cau_default_scene_def(scene);
	scene->layer_count = 1;
	def.scene = scene;
	assert_int_equal(cau_session_create(&def, &h->core.session, NULL), CAU_OK);
	h->decisions.logic = malloc(cau_logic_bytes(8));
	cau_logic_init(h->decisions.logic, 8);
	pthread_mutex_init(&h->published.lock, NULL);
	cau_streams_init(&h->frames.streams);
	pthread_mutex_init(&h->decisions.lock, NULL);
	h->identity.around = &around;
	open_stream(h);
	assert_false(makes_temperature(h, 0));
	assert_true(makes_temperature(h, 1));
	assert_true(makes_temperature(h, 2));
	assert_false(makes_temperature(h, 0));
	cau_streams_finish(&h->frames.streams);
	cau_session_destroy(h->core.session);
	pthread_mutex_destroy(&h->published.lock);
	pthread_mutex_destroy(&h->decisions.lock);
	free(h->decisions.logic);
	free(h);
	free(scene);
}

int main(void)
{
	const struct CMUnitTest tests[] = {cmocka_unit_test(temperature_is_made_while_it_is_watched)};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
