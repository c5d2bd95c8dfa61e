// SPDX-License-Identifier: GPL-3.0-or-later
// Tests events during the building of a session: it is destroyed once or twice, its creator
// disconnects, it is too large, or the daemon ends. Orders that wait for a session that ends are
// answered.
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#include "cautery/command_json.h"
#include "hosted_session/life.h"
#include "server/double/fake_session.h"
#include "server/hosted_session/hosted_fixture.h"

// ---- tests --------------------------------------------------------------------------------------

static void destroyed_at_each_border_it_ends_there(void **state)
{
	(void)state;
	static const char *const stages[] = {"meshing", "ordering", "factoring", "settling"};
	for (int border = 0; border < CAU_BUILD_STAGE_COUNT; border++) {
		char before[32];
		memset(t.answers, 0, sizeof t.answers);
		hosted_begin(border, 0);
		hosted_destroy(1, 0);
		hosted_destroy(2, 0);
		hosted_go_on();
		const hosted_answer *creation = hosted_await(0);
		assert_int_equal(creation->status, CAU_BAD_STATE);
		snprintf(before, sizeof before, "before %s", stages[border]);
		assert_non_null(strstr(creation->reason, before));
		assert_int_equal(hosted_await(1)->status, CAU_OK);
		assert_int_equal(hosted_await(2)->code, CAU_RPC_NOT_HERE);
		assert_true(cau_hosted_ended(t.h));
		assert_int_equal(hosted_stored_sessions(), 0);
		hosted_let_go();
		for (int i = 0; i < 3; i++)
			assert_int_equal(t.answers[i].count, 1);
	}
}

static void destroyed_after_the_last_border_it_is_made_first(void **state)
{
	(void)state;
	hosted_begin(CAU_BUILD_STAGE_COUNT, 0);
	hosted_destroy(1, 0);
	hosted_go_on();
	assert_int_equal(hosted_await(0)->status, CAU_OK);
	assert_int_equal(hosted_await(1)->status, CAU_OK);
	assert_int_equal(hosted_stored_sessions(), 0);
}

// The client sends session.destroy twice because no answer came. Both orders get the answer, which
// is stored once.
static void a_resend_of_its_destruction_gets_the_same_answer(void **state)
{
	(void)state;
	hosted_begin(CAU_BUILD_FACTOR, 0);
	hosted_destroy(1, 5);
	hosted_destroy(2, 5);
	hosted_destroy(3, 6);
	hosted_go_on();
	assert_int_equal(hosted_await(1)->status, CAU_OK);
	assert_int_equal(hosted_await(2)->status, CAU_OK);
	assert_int_equal(hosted_await(3)->code, CAU_RPC_NOT_HERE);
	cau_store_flush(t.around.store);
	assert_int_equal(hosted_stored_answers(5), 1);
	assert_int_equal(hosted_stored_answers(6), 0);
}

// The session.destroy has destroyed an earlier session of this name. If it is sent again, it must
// not destroy the present session.
static void a_resend_does_not_destroy_the_next_of_its_name(void **state)
{
	(void)state;
	hosted_begin(CAU_BUILD_ORDER, 0);
	hosted_destroy(1, 5);
	hosted_go_on();
	assert_int_equal(hosted_await(1)->status, CAU_OK);
	hosted_let_go();
	hosted_begin(CAU_BUILD_ORDER, 2);
	hosted_destroy(3, 5);
	hosted_go_on();
	assert_int_equal(hosted_await(3)->status, CAU_OK);
	assert_int_equal(hosted_await(2)->status, CAU_OK);
	assert_false(cau_hosted_ended(t.h));
	assert_int_equal(hosted_stored_sessions(), 1);
}

// The first session.destroy is on its way to the disk. Meanwhile other orders destroy the session
// of the same name that is being built now.
static void a_resend_is_looked_for_once_its_first_is_on_the_disk(void **state)
{
	(void)state;
	hosted_begin(CAU_BUILD_ORDER, 0);
	t.hold_commit = true;
	hosted_destroy(1, 5);
	hosted_go_on();
	pthread_barrier_wait(&t.committing);
	cau_hosted_stop(t.h);
	cau_hosted_release(t.h);
	hosted_begin(CAU_BUILD_ORDER, 2);
	hosted_destroy(3, 5);
	hosted_destroy(4, 0);
	hosted_go_on();
	assert_int_equal(hosted_await(2)->status, CAU_BAD_STATE);
	pthread_barrier_wait(&t.commit);
	assert_int_equal(hosted_await(1)->status, CAU_OK);
	assert_int_equal(hosted_await(3)->status, CAU_OK);
	assert_int_equal(hosted_await(4)->status, CAU_OK);
}

// ---- waiting orders are answered when the session ends, not when its last reference is released
static void assert_refused_as_gone(int asked)
{
	assert_int_equal(hosted_await(asked)->code, CAU_RPC_NOT_HERE);
}

static void what_waits_is_refused_where_it_does_not_come_to_be(void **state)
{
	(void)state;
	hosted_begin(CAU_BUILD_FACTOR, 0);
	hosted_turn_off_at_tick_1000(1);
	hosted_submit(hosted_new_order(2, CAU_ORDER_DESCRIBE, CAU_METHOD_SESSION_DESCRIBE));
	cau_hosted_abandon(t.h, CREATOR);
	hosted_go_on();
	assert_refused_as_gone(1);
	assert_refused_as_gone(2);
}

static void what_waits_is_refused_where_it_is_destroyed(void **state)
{
	(void)state;
	hosted_begin(NOWHERE, 0);
	assert_int_equal(hosted_await(0)->status, CAU_OK);
	hosted_turn_off_at_tick_1000(1);
	hosted_destroy(2, 0);
	assert_refused_as_gone(1);
	assert_int_equal(hosted_await(2)->status, CAU_OK);
}

// The store already has a session of this name, and refuses a second one.
static void what_waits_is_refused_where_it_cannot_be_stored(void **state)
{
	(void)state;
	hosted_begin(NOWHERE, 0);
	assert_int_equal(hosted_await(0)->status, CAU_OK);
	hosted_let_go();
	hosted_begin(CAU_BUILD_STAGE_COUNT, 1);
	hosted_turn_off_at_tick_1000(2);
	hosted_go_on();
	assert_int_not_equal(hosted_await(1)->status, CAU_OK);
	assert_refused_as_gone(2);
	assert_true(cau_hosted_ended(t.h));
}

// The store refuses the rows of a fork while the log of its source is replayed.
static void a_fork_that_cannot_be_stored_is_answered(void **state)
{
	(void)state;
	hosted_begin(NOWHERE, 0);
	assert_int_equal(hosted_await(0)->status, CAU_OK);
	hosted_let_go();
	cau_hosted_def def = {.id = "d1-building",
	                      .number = 2,
	                      .scene = hosted_make_scene(),
	                      .origin = {.kind = CAU_ORIGIN_FORK, .session = "d1-building"},
	                      .creator = {.client = CREATOR},
	                      .reply = hosted_reply_to(1, CAU_METHOD_SESSION_FORK)};
	assert_int_equal(cau_hosted_create(&t.h, &t.around, &def, NULL), CAU_OK);
	assert_int_not_equal(hosted_await(1)->status, CAU_OK);
	while (!cau_hosted_ended(t.h))
		usleep(1000);
	assert_int_equal(t.answers[1].count, 1);
}

// ---- after a restart
static void see_stored(void *user, cau_status status, const char *reason)
{
	(void)reason;
	*(cau_status *)user = status;
}

static void log_gravity(uint32_t order)
{
	char json[CAU_COMMAND_JSON_MAX_BYTES];
	size_t bytes = 0;
	cau_command command;
	cau_status stored = CAU_BAD_STATE;
	cau_default_command(&command, CAU_COMMAND_SET_GRAVITY);
	assert_int_equal(cau_command_to_json(&command, json, sizeof json, &bytes, NULL), CAU_OK);
	cau_store_command row = {
		.session = "d1-building", .order = order, .kind = command.kind, .payload = {json, bytes}};
	cau_store_batch *batch = cau_store_batch_create();
	assert_int_equal(cau_store_put_command(batch, &row, NULL), CAU_OK);
	assert_int_equal(cau_store_submit(t.around.store, batch, see_stored, &stored, NULL), CAU_OK);
	cau_store_flush(t.around.store);
	assert_int_equal(stored, CAU_OK);
}

static cau_status take_order(void *user, const cau_store_command *row)
{
	*(uint32_t *)user = row->order;
	return CAU_OK;
}

// Commands that the store did not accept leave a gap in the numbers of a tick.
static void after_a_restart_it_logs_behind_the_last(void **state)
{
	(void)state;
	uint32_t last = 0;
	hosted_begin(NOWHERE, 0);
	assert_int_equal(hosted_await(0)->status, CAU_OK);
	hosted_let_go();
	log_gravity(0);
	log_gravity(5);
	cau_hosted_def def = {.id = "d1-building",
	                      .number = 2,
	                      .scene = hosted_make_scene(),
	                      .paused = true,
	                      .origin = {.kind = CAU_ORIGIN_STORE}};
	assert_int_equal(cau_hosted_create(&t.h, &t.around, &def, NULL), CAU_OK);
	cau_order *order = hosted_new_order(1, CAU_ORDER_COMMAND, CAU_METHOD_SET_GRAVITY);
	cau_default_command(&order->as.command, CAU_COMMAND_SET_GRAVITY);
	hosted_submit(order);
	assert_int_equal(hosted_await(1)->status, CAU_OK);
	assert_int_equal(
		cau_store_read_log(t.around.store, "d1-building", 0, 0, INT64_MAX, take_order, &last, NULL),
		CAU_OK);
	assert_int_equal(last, 6);
}

static void whose_creator_is_gone_for_good_it_ends(void **state)
{
	(void)state;
	hosted_begin(CAU_BUILD_FACTOR, 0);
	cau_hosted_abandon(t.h, CREATOR + 1); // a client that did not create the session
	cau_hosted_abandon(t.h, CREATOR);
	hosted_go_on();
	assert_non_null(
		strstr(hosted_await(0)->reason, "the client that created the session disconnected"));
	assert_int_equal(hosted_stored_sessions(), 0);
}

static void as_the_daemon_ends_it_ends(void **state)
{
	(void)state;
	hosted_begin(CAU_BUILD_ORDER, 0);
	cau_hosted_drain(t.h);
	assert_false(cau_hosted_drained(t.h));
	hosted_go_on();
	assert_non_null(strstr(hosted_await(0)->reason, "the daemon is ending"));
	assert_true(cau_hosted_drained(t.h));
	assert_int_equal(hosted_stored_sessions(), 0);
}

static void as_the_daemon_ends_nothing_waits_to_be_read(void **state)
{
	(void)state;
	cau_error error = {0};
	hosted_begin(NOWHERE, 0);
	assert_int_equal(hosted_await(0)->status, CAU_OK);
	hosted_submit(hosted_new_order(1, CAU_ORDER_DESCRIBE, CAU_METHOD_SESSION_DESCRIBE));
	cau_hosted_drain(t.h);
	assert_int_equal(hosted_await(1)->status, CAU_OK);
	cau_order *late = hosted_new_order(2, CAU_ORDER_DESCRIBE, CAU_METHOD_SESSION_DESCRIBE);
	assert_int_equal(cau_hosted_submit(t.h, late, &error), CAU_BAD_STATE);
	assert_string_equal(error.reason, "the daemon is ending");
	free(late);
}

// The builder stops before it runs the job. The job is dropped, and everything is cleaned up.
static void begun_after_the_builder_stopped_it_is_refused(void **state)
{
	(void)state;
	cau_builder_stop(t.around.builder);
	hosted_begin(NOWHERE, 0);
	assert_non_null(strstr(hosted_await(0)->reason, "the daemon is ending"));
	assert_true(cau_hosted_ended(t.h));
}

static void refuse_by(int64_t *setting, int64_t most, const char *name)
{
	int64_t usual = *setting;
	*setting = most;
	memset(t.answers, 0, sizeof t.answers);
	hosted_begin(NOWHERE, 0);
	assert_int_equal(hosted_await(0)->status, CAU_LIMIT);
	assert_non_null(strstr(hosted_await(0)->reason, name));
	*setting = usual;
	hosted_let_go();
	assert_int_equal(t.memory_held, 0);
}

static void beyond_a_limit_it_is_refused_by_the_settings_name(void **state)
{
	(void)state;
	refuse_by(&t.config.max_session_vertices, 288, "max_session_vertices");
	refuse_by(&t.config.max_session_elements, 511, "max_session_elements");
	refuse_by(&t.config.max_session_bytes, 1000, "max_session_bytes");
	refuse_by(&t.config.max_sessions_bytes, 1000, "max_sessions_bytes");
}

// ---- the expected time
static void write_mesh_file(off_t bytes)
{
	char path[60];
	snprintf(path, sizeof path, "%s/mesh.obj", t.folder);
	FILE *file = fopen(path, "w");
	assert_non_null(file);
	assert_int_equal(fclose(file), 0);
	assert_int_equal(truncate(path, bytes), 0);
}

static double expected_of(int source, const char *directory, const char *file)
{
	cau_scene_def *scene = hosted_make_scene();
	scene->mesh_count = 1;
	cau_mesh_def *mesh = &scene->meshes[0];
	*mesh = (cau_mesh_def){.source = source, .cells = {300, 300, 0}};
	snprintf(scene->directory, sizeof scene->directory, "%s", directory);
	snprintf(mesh->file, sizeof mesh->file, "%s", file);
	double expected_s = cau_building_expects_s(scene);
	free(scene);
	return expected_s;
}

// A long job must not run before short jobs.
static void a_large_mesh_is_a_long_job_whatever_it_comes_from(void **state)
{
	(void)state;
	char path[60];
	snprintf(path, sizeof path, "%s/mesh.obj", t.folder);
	write_mesh_file(20000000);
	assert_true(expected_of(CAU_MESH_FILE, t.folder, "mesh.obj") > CAU_BUILDER_SHORT_S);
	assert_true(expected_of(CAU_MESH_FILE, "/elsewhere", path) > CAU_BUILDER_SHORT_S);
	assert_true(expected_of(CAU_MESH_FILE, "", path) > CAU_BUILDER_SHORT_S);
	write_mesh_file(20000);
	assert_true(expected_of(CAU_MESH_FILE, t.folder, "mesh.obj") < CAU_BUILDER_SHORT_S);
	assert_true(expected_of(CAU_MESH_FILE, t.folder, "none.obj") < CAU_BUILDER_SHORT_S);
	assert_true(expected_of(CAU_MESH_SHEET, "", "") > CAU_BUILDER_SHORT_S);
	assert_true(expected_of(CAU_MESH_PATTERN, "", "") > CAU_BUILDER_SHORT_S);
	unlink(path);
}

// ---- another session of a scene that had to settle
static int made;

static void count_made(cau_build_stage next)
{
	made += next == CAU_BUILD_STAGE_COUNT;
}

// Returns how many cores were built to create one session.
static int cores_of_another(void)
{
	made = 0;
	if (t.h)
		hosted_let_go();
	memset(t.answers, 0, sizeof t.answers);
	hosted_begin(NOWHERE, 0);
	assert_int_equal(hosted_await(0)->status, CAU_OK);
	hosted_destroy(1, 0);
	assert_int_equal(hosted_await(1)->status, CAU_OK);
	return made;
}

static void what_is_known_serves_unless_the_tissue_is_another(void **state)
{
	(void)state;
	cau_fake_hooks_set.build = count_made;
	cau_fake_hooks_set.tension = true;
	cau_fake_hooks_set.tissue_hash = 1;
	assert_int_equal(cores_of_another(), 1);
	assert_int_equal(cores_of_another(), 1);
	cau_fake_hooks_set.tissue_hash = 2; // the scene's mesh has changed
	assert_int_equal(cores_of_another(), 2);
	assert_int_equal(cores_of_another(), 1); // the new rest state is in the cache
	atomic_store(&t.fail_restore, true);
	assert_int_equal(cores_of_another(), 2);
	assert_int_equal(cores_of_another(), 1);
}

int main(void)
{
#define TEST(function)                                                                             \
	cmocka_unit_test_setup_teardown(function, hosted_open_surroundings, hosted_close_surroundings)
	const struct CMUnitTest tests[] = {
		TEST(destroyed_at_each_border_it_ends_there),
		TEST(destroyed_after_the_last_border_it_is_made_first),
		TEST(a_resend_of_its_destruction_gets_the_same_answer),
		TEST(a_resend_does_not_destroy_the_next_of_its_name),
		TEST(a_resend_is_looked_for_once_its_first_is_on_the_disk),
		TEST(what_waits_is_refused_where_it_does_not_come_to_be),
		TEST(what_waits_is_refused_where_it_is_destroyed),
		TEST(what_waits_is_refused_where_it_cannot_be_stored),
		TEST(a_fork_that_cannot_be_stored_is_answered),
		TEST(after_a_restart_it_logs_behind_the_last),
		TEST(whose_creator_is_gone_for_good_it_ends),
		TEST(as_the_daemon_ends_it_ends),
		TEST(as_the_daemon_ends_nothing_waits_to_be_read),
		TEST(begun_after_the_builder_stopped_it_is_refused),
		TEST(beyond_a_limit_it_is_refused_by_the_settings_name),
		TEST(a_large_mesh_is_a_long_job_whatever_it_comes_from),
		TEST(what_is_known_serves_unless_the_tissue_is_another),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
