// SPDX-License-Identifier: GPL-3.0-or-later
// Tests joining streams, gaps in streams, damaged frames, and joining again.
#include "clients/library/fixture.h"

typedef struct streaming {
	atomic_int key_frames_asked, acknowledged;
} streaming;

static cau_client_stream *join(fixture *f)
{
	cau_client_stream *stream;
	cau_wire_session_join params = {.has_session = true, .session = "t1-square"};
	if (cau_client_join(f->client, &params, &stream, &f->error))
		fail_msg("join: %s", f->error.reason);
	return stream;
}

static void joining_brings_topology_and_state(void **state)
{
	(void)state;
	fixture f;
	fixture_begin(&f, NULL);
	assert_int_equal(fixture_connect(&f), CAU_OK);
	cau_client_stream *stream = join(&f);
	assert_true(stream->has_topology);
	assert_int_equal(stream->topology.face[4], 2);
	assert_int_equal(stream->topology.rest[3], 20000); // 1 m in steps of 0.05 mm
	assert_int_equal(stream->state->quantised[0], 20); // 1 mm, from the first frame
	assert_int_equal(stream->key_frames, 1);
	assert_int_equal(cau_client_faces_drawn(stream), SCRIPTED_FACES);
	fixture_end(&f);
}

static bool refuse_join(scripted_peer *peer, const cau_rpc_message *message, const char *text)
{
	(void)text;
	if (message->method != CAU_METHOD_SESSION_JOIN)
		return false;
	scripted_refuse(peer, message, CAU_RPC_NOT_HERE, "not_here", "params.session", "elsewhere");
	return true;
}

static void a_refused_join_says_why(void **state)
{
	(void)state;
	fixture f;
	cau_client_stream *stream;
	fixture_begin(&f, &(scripted_script){.text = refuse_join});
	assert_int_equal(fixture_connect(&f), CAU_OK);
	assert_int_not_equal(cau_client_join(f.client, &(cau_wire_session_join){0}, &stream, &f.error),
	                     CAU_OK);
	assert_int_equal(cau_client_fault(f.client)->code, CAU_RPC_NOT_HERE);
	assert_true(stream->ended);
	assert_false(stream->state->synced);
	fixture_end(&f);
}

// A server that takes so long to build the session that two heartbeats arrive.
typedef struct building {
	cau_rpc_message join;
	int heartbeats;
} building;

static bool build_first(scripted_peer *peer, const cau_rpc_message *message, const char *text)
{
	building *b = scripted_user(peer);
	(void)text;
	if (message->method == CAU_METHOD_SESSION_JOIN)
		b->join = (cau_rpc_message){.id = message->id, .method = message->method};
	if (message->method == CAU_METHOD_HEARTBEAT && ++b->heartbeats == 2) {
		scripted_answer_join(peer, &b->join);
		scripted_send_topology(peer);
		scripted_advance(peer, true);
	}
	return message->method == CAU_METHOD_SESSION_JOIN;
}

static void a_join_waits_for_a_session_that_is_built(void **state)
{
	(void)state;
	fixture f;
	building b = {0};
	fixture_begin(&f, &(scripted_script){.text = build_first, .user = &b});
	f.def.timeout_s = 0.5; // timeout of the join, of hello and of each heartbeat
	assert_int_equal(fixture_connect(&f), CAU_OK);
	assert_true(join(&f)->state->synced);
	fixture_end(&f);
	assert_int_equal(b.heartbeats, 2); // the server's thread has ended, so the count is final
}

// Loses frame 3 of a chain of 5. Sends a key frame only on request.
static bool lose_a_frame(scripted_peer *peer, const cau_rpc_message *message, const char *text)
{
	streaming *s = scripted_user(peer);
	(void)text;
	switch (message->method) {
	case CAU_METHOD_SESSION_JOIN:
		scripted_answer_join(peer, message);
		scripted_send_topology(peer);
		for (int i = 1; i <= 5; i++)
			scripted_advance(peer, i != 3);
		return true;
	case CAU_METHOD_STREAM_KEY_FRAME:
		atomic_fetch_add(&s->key_frames_asked, 1);
		scripted_result(peer, message, CAU_METHOD_STREAM_KEY_FRAME, &(cau_wire_nothing){0});
		scripted_send_key(peer);
		return true;
	case CAU_METHOD_STREAM_ACK:
		atomic_fetch_add(&s->acknowledged, 1);
		return true;
	default:
		return false;
	}
}

static void a_gap_is_closed_by_a_key_frame(void **state)
{
	(void)state;
	fixture f;
	streaming s = {0};
	fixture_begin(&f, &(scripted_script){.text = lose_a_frame, .user = &s});
	assert_int_equal(fixture_connect(&f), CAU_OK);
	cau_client_stream *stream = join(&f);
	FIXTURE_AWAIT(&f, stream->state->sequence == 5);
	assert_int_equal(stream->state->quantised[0], 100); // 5 mm
	assert_int_equal(stream->gaps, 1);
	assert_int_equal(stream->skipped, 2);
	assert_int_equal(stream->damaged, 0);
	FIXTURE_AWAIT(&f, atomic_load(&s.acknowledged) > 0);
	fixture_end(&f);
	assert_true(s.key_frames_asked >= 1); // the client may have repeated the request after a second
}

// Sends a delta with overwritten sections.
static bool damage_a_frame(scripted_peer *peer, const cau_rpc_message *message, const char *text)
{
	if (message->method != CAU_METHOD_SESSION_JOIN)
		return lose_a_frame(peer, message, text);
	scripted_answer_join(peer, message);
	scripted_send_topology(peer);
	scripted_advance(peer, true);
	unsigned char damaged[CAU_FRAME_HEADER_BYTES + 16] = {0};
	cau_frame_header header;
	// A delta on the present state: its header is valid, its sections are not.
	static const unsigned char start[] = {'C', 'A', 'U', 'F', 1, CAU_FRAME_DELTA};
	memcpy(damaged, start, sizeof start);
	damaged[8] = sizeof damaged;
	damaged[12] = 5;  // session
	damaged[16] = 78; // epoch of the first connection
	damaged[24] = 2;  // sequence
	damaged[32] = 1;  // base sequence
	damaged[66] = 1;  // one section
	memset(damaged + CAU_FRAME_HEADER_BYTES, 0xff, 16);
	assert_int_equal(cau_frame_header_read(damaged, sizeof damaged, &header, NULL), CAU_OK);
	scripted_send(peer, true, damaged, sizeof damaged);
	return true;
}

static void damage_is_counted_and_repaired(void **state)
{
	(void)state;
	fixture f;
	streaming s = {0};
	fixture_begin(&f, &(scripted_script){.text = damage_a_frame, .user = &s});
	assert_int_equal(fixture_connect(&f), CAU_OK);
	cau_client_stream *stream = join(&f);
	FIXTURE_AWAIT(&f, stream->damaged == 1);
	FIXTURE_AWAIT(&f, stream->state->synced && stream->key_frames == 2);
	fixture_end(&f);
	assert_true(s.key_frames_asked >= 1); // the client may have repeated the request after a second
}

static void a_stream_is_joined_again_after_a_loss(void **state)
{
	(void)state;
	fixture f;
	fixture_begin(&f, NULL);
	f.def.reconnect = true;
	assert_int_equal(fixture_connect(&f), CAU_OK);
	cau_client_stream *stream = join(&f);
	uint64_t epoch = stream->state->epoch;
	cau_client_drop(f.client);
	FIXTURE_AWAIT(&f, cau_client_connections(f.client) == 2);
	FIXTURE_AWAIT(&f, stream->state->synced && stream->state->epoch != epoch);
	assert_false(stream->ended);
	assert_int_equal(stream->gaps, 0);
	fixture_end(&f);
}

static bool destroy_after_join(scripted_peer *peer, const cau_rpc_message *message,
                               const char *text)
{
	(void)text;
	if (message->method != CAU_METHOD_STREAM_ACK)
		return false;
	cau_wire_session_changed changed = {
		.change = CAU_CHANGE_DESTROYED,
		.summary = {.session = "t1-square", .scene = "square", .step_s = 0.01, .epoch = 1}};
	scripted_notify(peer, CAU_METHOD_SESSION_CHANGED, &changed);
	return true;
}

static void a_destroyed_session_ends_its_stream(void **state)
{
	(void)state;
	fixture f;
	fixture_begin(&f, &(scripted_script){.text = destroy_after_join});
	assert_int_equal(fixture_connect(&f), CAU_OK);
	cau_client_stream *stream = join(&f);
	FIXTURE_AWAIT(&f, stream->ended);
	fixture_end(&f);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(joining_brings_topology_and_state),
		cmocka_unit_test(a_refused_join_says_why),
		cmocka_unit_test(a_join_waits_for_a_session_that_is_built),
		cmocka_unit_test(a_gap_is_closed_by_a_key_frame),
		cmocka_unit_test(damage_is_counted_and_repaired),
		cmocka_unit_test(a_stream_is_joined_again_after_a_loss),
		cmocka_unit_test(a_destroyed_session_ends_its_stream),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
