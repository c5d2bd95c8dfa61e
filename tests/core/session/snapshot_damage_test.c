// SPDX-License-Identifier: GPL-3.0-or-later
// Snapshots that are damaged, forged or of another tissue are refused and change nothing; older
// headers are read.
#include "base/hash.h"
#include "core/session/unbroken_run.h"
#include "session/snapshot_header.h"

typedef struct victim {
	cau_session *session;
	uint64_t hash;
} victim;

static void expect_refusal(const victim *v, const void *bytes, size_t count, const char *what,
                           size_t where)
{
	void *copy = malloc(count ? count : 1); // so that a sanitizer sees a read past the end
	assert_non_null(copy);
	memcpy(copy, bytes, count);
	cau_error error = {0};
	bool exact;
	cau_status status = cau_session_restore(v->session, copy, count, &exact, &error);
	free(copy);
	if (status != CAU_CORRUPT || !error.reason[0])
		fail_msg("%s at byte %zu gave %s", what, where, cau_status_name(status));
	if (cau_session_hash(v->session) != v->hash)
		fail_msg("%s at byte %zu changed the session", what, where);
}

static void damage_is_refused(void **state)
{
	(void)state;
	cau_scene_def *scene = busy_scene();
	victim v = {.session = stage_open(scene, 1)};
	busy_run(v.session, 30);
	v.hash = cau_session_hash(v.session);
	const stage_bytes *shot = &run->shot[50];
	unsigned char *bytes = malloc(shot->count + 8);
	assert_non_null(bytes);
	memcpy(bytes, shot->bytes, shot->count);
	const size_t dense = 512; // every byte of the header, then a sample
	for (size_t at = 0; at < shot->count; at += at < dense ? 1 : shot->count / 150) {
		unsigned char flip = (unsigned char)(1u << at % 8);
		bytes[at] ^= flip;
		expect_refusal(&v, bytes, shot->count, "a flipped bit", at);
		bytes[at] ^= flip;
	}
	for (size_t count = 0; count < shot->count; count += count < dense ? 7 : shot->count / 40)
		expect_refusal(&v, bytes, count, "an end", count);
	memset(bytes + shot->count, 0, 8);
	expect_refusal(&v, bytes, shot->count + 8, "more bytes", shot->count);
	expect_refusal(&v, "", 0, "nothing", 0);
	// and the session goes on as if nothing had been tried
	expect_the_same(v.session, 30, 40);
	free(bytes);
	cau_session_destroy(v.session);
	free(scene);
}

// A header whose counts are not those of its bytes, with a hash that is right: nothing but the
// counts themselves can tell.
static void forge(unsigned char *bytes, size_t count, size_t at, int32_t by)
{
	enum { HASH_AT = 48, PAYLOAD_BYTES_AT = 56 }; // as snapshot_header has them
	int32_t value;
	uint64_t payload_bytes, hash = 0;
	memcpy(&value, bytes + at, sizeof value);
	value += by;
	memcpy(bytes + at, &value, sizeof value);
	memcpy(&payload_bytes, bytes + PAYLOAD_BYTES_AT, sizeof payload_bytes);
	memcpy(bytes + HASH_AT, &hash, sizeof hash);
	size_t header_bytes = count - payload_bytes;
	hash = cau_hash_bytes(cau_hash_bytes(CAU_HASH_START, bytes, header_bytes), bytes + header_bytes,
	                      payload_bytes);
	memcpy(bytes + HASH_AT, &hash, sizeof hash);
}

static void forged_counts_are_refused_and_change_nothing(void **state)
{
	(void)state;
	static const struct {
		size_t at;
		const char *name;
	} members[] = {{104, "row_count"},
	               {108, "tool_count"},
	               {112, "command_count"},
	               {116, "active_count"},
	               {120, "column_count"},
	               {124, "waiting_count"},
	               {128, "operation_count"},
	               {164, "grid_nodes of the first"},
	               {168, "grid_nodes of the second"}};
	cau_scene_def *scene = busy_scene();
	victim v = {.session = stage_open(scene, 1)};
	busy_run(v.session, 30);
	v.hash = cau_session_hash(v.session);
	const stage_bytes *shot = &run->shot[50];
	unsigned char *bytes = malloc(shot->count);
	assert_non_null(bytes);
	for (size_t i = 0; i < sizeof members / sizeof *members; i++)
		for (int32_t by = -1; by <= 1; by += 2) {
			memcpy(bytes, shot->bytes, shot->count);
			forge(bytes, shot->count, members[i].at, by);
			expect_refusal(&v, bytes, shot->count, members[i].name, members[i].at);
		}
	// Only the counts were to blame.
	memcpy(bytes, shot->bytes, shot->count);
	forge(bytes, shot->count, 104, 0);
	expect_the_same(v.session, 30, 40);
	restore(v.session, &(stage_bytes){bytes, shot->count});
	expect_the_same(v.session, 50, 55);
	free(bytes);
	cau_session_destroy(v.session);
	free(scene);
}

// Copies one piece, and leaves another out.
static void copy_piece(unsigned char **to, const unsigned char **from, size_t kept, size_t left_out)
{
	memcpy(*to, *from, kept);
	*to += kept;
	*from += kept + left_out;
}

// The payload as versions before 6 had it: without what each tool's jaws press with, what its pose
// hangs on and the heat fields around its innermost one, and without tears and holds on faces,
// which it ends with. Returns its length.
static size_t payload_of_version_5(const stage_bytes *shot, const cau_session *session,
                                   unsigned char *payload)
{
	const size_t grasp = 2 * sizeof(int32_t) + 6 * sizeof(double);
	const size_t on_face = 4 * sizeof(int32_t) + 3 * sizeof(double);
	const size_t since_6 =
		(size_t)session->scene->layer_count * (2 * CAU_MAX_MATERIALS + 1) * sizeof(double) +
		(size_t)session->tool_count * CAU_MAX_GRASPED * on_face;
	const size_t state = offsetof(cau_tool_state, asked_pose),
				 force = offsetof(cau_tool_state, definition.close_force_n);
	snapshot_header header;
	memcpy(&header, shot->bytes, sizeof header);
	const unsigned char *from = shot->bytes + sizeof header, *end = shot->bytes + shot->count;
	unsigned char *to = payload;
	copy_piece(&to, &from, (size_t)header.vertex_count + (size_t)header.row_count * sizeof(int32_t),
	           0);
	for (int32_t i = 0; i < header.tool_count; i++) {
		const cau_tool *tool = &session->tool[i];
		size_t n = (size_t)header.grid_nodes[i], field = n * n * n * sizeof(float);
		copy_piece(&to, &from, force, sizeof(double));
		copy_piece(&to, &from,
		           state - force - sizeof(double) + sizeof tool->target + sizeof tool->jaw_target +
		               sizeof tool->pose_before,
		           sizeof tool->state - state + sizeof tool->anchor + sizeof tool->pace +
		               sizeof tool->least_open_rad);
		copy_piece(&to, &from,
		           sizeof tool->grasp_count + CAU_MAX_GRASPED * grasp +
		               sizeof tool->grid.field[0].origin + field,
		           (CAU_HEAT_FIELDS - 1) * field);
	}
	copy_piece(&to, &from, (size_t)(end - from) - since_6, since_6);
	return (size_t)(to - payload);
}

// Version 4 as its first builds wrote it and as its last did, and version 5: the header ended
// before what steps have taught, before the sides of faces, and before what forces have taught.
static void shorter_headers_are_read(void **state)
{
	(void)state;
	const uint32_t versions[] = {4, 4, 5};
	const size_t ends[] = {offsetof(snapshot_header, shallow_steps),
	                       offsetof(snapshot_header, memory_count),
	                       offsetof(snapshot_header, force_left)};
	const stage_bytes *shot = &run->shot[0];
	cau_scene_def *scene = busy_scene();
	for (size_t i = 0; i < sizeof ends / sizeof *ends; i++) {
		cau_session *session = stage_open(scene, 1);
		unsigned char *bytes = malloc(shot->count);
		assert_non_null(bytes);
		size_t payload = payload_of_version_5(shot, session, bytes + ends[i]);
		size_t count = ends[i] + payload;
		snapshot_header header;
		memcpy(&header, shot->bytes, sizeof header);
		assert_int_equal(header.memory_count + header.over_count + header.command_count, 0);
		header.version = versions[i];
		header.payload_bytes = payload;
		memcpy(bytes, &header, ends[i]);
		forge(bytes, count, offsetof(snapshot_header, row_count), 0); // its hash
		cau_error error = {0};
		bool exact = true;
		busy_run(session, 3);
		if (cau_session_restore(session, bytes, count, &exact, &error))
			fail_msg("a header of %zu bytes: %s", ends[i], error.reason);
		assert_false(exact);
		expect_the_same(session, 0, 3);
		bytes[ends[i] - 1] ^= 1;
		assert_int_equal(cau_session_restore(session, bytes, count, &exact, &error), CAU_CORRUPT);
		cau_session_destroy(session);
		free(bytes);
	}
	free(scene);
}

// The same mesh in another scene is another tissue.
static void another_definition_is_refused(void **state)
{
	(void)state;
	for (int what = 0; what < 6; what++) {
		cau_scene_def *scene = busy_scene();
		switch (what) {
		case 0:
			scene->step_s /= 2;
			break;
		case 1:
			scene->iterations++;
			break;
		case 2:
			scene->seed++;
			break;
		case 3:
			scene->parting = CAU_PARTING_ELEMENTS;
			break;
		case 4:
			scene->layers[1].fat[0].density_kg_m3 *= 2;
			break;
		default:
			scene->layers[0].fibre[1] = 1;
			scene->meshes[0].texture_turn_rad = 0.3;
			break;
		}
		victim v = {.session = stage_open(scene, 1)};
		v.hash = cau_session_hash(v.session);
		expect_refusal(&v, run->shot[50].bytes, run->shot[50].count, "another scene", (size_t)what);
		cau_session_destroy(v.session);
		free(scene);
	}
}

static void a_small_buffer_is_refused(void **state)
{
	(void)state;
	cau_scene_def *scene = busy_scene();
	cau_session *session = stage_open(scene, 1);
	size_t needed = cau_session_snapshot_bytes(session), count = 0;
	unsigned char *bytes = malloc(needed - 1);
	assert_non_null(bytes);
	cau_error error = {0};
	assert_int_equal(cau_session_snapshot(session, bytes, needed - 1, &count, &error), CAU_LIMIT);
	assert_true(error.reason[0]);
	free(bytes);
	cau_session_destroy(session);
	free(scene);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(damage_is_refused),
		cmocka_unit_test(forged_counts_are_refused_and_change_nothing),
		cmocka_unit_test(shorter_headers_are_read),
		cmocka_unit_test(another_definition_is_refused),
		cmocka_unit_test(a_small_buffer_is_refused),
	};
	return cmocka_run_group_tests(tests, make_run, drop_run);
}
