// SPDX-License-Identifier: GPL-3.0-or-later
// A session that is being built, and what reaches it meanwhile: it is destroyed, destroyed again,
// forgotten, too large, or the daemon ends; and what waits for one that ends. The double's creation
// stands still at any border between two stages until the test has done what it wants to, and so
// does the store before it writes.
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#include "cautery/defaults.h"
#include "hosted_session/internal.h"
#include "server/double/fake_session.h"

enum { NOWHERE = -1, CREATOR = 7, ANSWERS = 8 };

typedef struct answer {
	int count;
	cau_status status;
	int32_t code;
	char reason[320];
} answer;

static struct {
	char folder[40], file[64];
	cau_config config;
	_Atomic int64_t memory_held;
	cau_surroundings around;
	cau_hosted *h;
	atomic_int held_at; // border
	pthread_barrier_t met, over;
	atomic_bool hold_commit;
	pthread_barrier_t committing, commit;
	pthread_mutex_t lock;
	pthread_cond_t answered;
	answer answers[ANSWERS]; // the creator's first
} t;

// ---- what is around it --------------------------------------------------------------------------

static void come_to_border(cau_build_stage next)
{
	int here = (int)next;
	if (!atomic_compare_exchange_strong(&t.held_at, &here, NOWHERE))
		return;
	pthread_barrier_wait(&t.met);
	pthread_barrier_wait(&t.over);
}

// The store asks for the time as it begins to write.
static int64_t see_commit(void)
{
	if (atomic_exchange(&t.hold_commit, false)) {
		pthread_barrier_wait(&t.committing);
		pthread_barrier_wait(&t.commit);
	}
	return cau_wall_us() / 1000;
}

static void see_answer(void *user, const cau_reply *reply, const cau_outcome *outcome)
{
	(void)reply;
	answer *a = user;
	pthread_mutex_lock(&t.lock);
	a->count++;
	a->status = outcome->error ? outcome->error->status : CAU_OK;
	a->code = outcome->code;
	if (outcome->error)
		snprintf(a->reason, sizeof a->reason, "%.319s", outcome->error->reason);
	pthread_cond_broadcast(&t.answered);
	pthread_mutex_unlock(&t.lock);
}

static void notify(void *user, cau_audience audience, cau_buffer *text)
{
	(void)user, (void)audience;
	cau_buffer_release(text);
}

static void see_frames(void *user)
{
	(void)user;
}

static void see_slice(void *user, uint32_t session)
{
	(void)user, (void)session;
}

static int open_surroundings(void **state)
{
	(void)state;
	memset(&t, 0, sizeof t);
	t.held_at = NOWHERE;
	pthread_mutex_init(&t.lock, NULL);
	pthread_cond_init(&t.answered, NULL);
	pthread_barrier_init(&t.met, NULL, 2);
	pthread_barrier_init(&t.over, NULL, 2);
	pthread_barrier_init(&t.committing, NULL, 2);
	pthread_barrier_init(&t.commit, NULL, 2);
	cau_log_set_level("error");
	cau_fake_hooks_set = (cau_fake_hooks){.build = come_to_border};
	cau_config_default(&t.config);
	snprintf(t.folder, sizeof t.folder, "/tmp/cautery-building-XXXXXX");
	assert_non_null(mkdtemp(t.folder));
	snprintf(t.file, sizeof t.file, "%s/store.db", t.folder);
	cau_store_config of_store = cau_store_default_config();
	of_store.path = t.file;
	of_store.commit_delay_ms = 0;
	of_store.wall_clock_ms = see_commit;
	t.around = (cau_surroundings){.config = &t.config,
	                              .memory_held = &t.memory_held,
	                              .sink = {NULL, notify, see_frames, see_slice}};
	assert_int_equal(cau_store_open(&of_store, &t.around.store, NULL), CAU_OK);
	assert_int_equal(cau_worker_pool_create(&t.around.pool, 2, 4, 0, NULL), CAU_OK);
	assert_int_equal(cau_builder_create(&t.around.builder, 0, NULL), CAU_OK);
	return 0;
}

// As cau_hub_stop and the daemon do it. Nothing that a session held is left.
static int close_surroundings(void **state)
{
	(void)state;
	cau_builder_stop(t.around.builder);
	if (t.h)
		cau_hosted_stop(t.h);
	cau_store_flush(t.around.store);
	cau_hosted_release(t.h);
	cau_builder_destroy(t.around.builder);
	cau_worker_pool_destroy(t.around.pool);
	cau_store_close(t.around.store);
	pthread_barrier_destroy(&t.met);
	pthread_barrier_destroy(&t.over);
	pthread_barrier_destroy(&t.committing);
	pthread_barrier_destroy(&t.commit);
	pthread_cond_destroy(&t.answered);
	pthread_mutex_destroy(&t.lock);
	unlink(t.file);
	rmdir(t.folder);
	return t.memory_held != 0;
}

static cau_scene_def *make_scene(void)
{
	cau_scene_def *scene = calloc(1, sizeof *scene);
	cau_default_scene_def(scene);
	snprintf(scene->name, sizeof scene->name, "building");
	scene->layer_count = 1;
	cau_default_layer_def(&scene->layers[0], CAU_LAYER_FASCIA);
	snprintf(scene->layers[0].name, sizeof scene->layers[0].name, "sheet");
	scene->tool_count = 1;
	cau_default_tool_def(&scene->tools[0], CAU_TOOL_HOOK);
	snprintf(scene->tools[0].name, sizeof scene->tools[0].name, "hook");
	return scene;
}

static cau_reply reply_to(int asked, cau_method method)
{
	return (cau_reply){.answer = see_answer, .user = &t.answers[asked], .method = method};
}

// Begins to build a session, paused, which stands still at the border.
static void begin(int held_at, int creation)
{
	t.held_at = held_at;
	cau_hosted_def def = {.id = "d1-building",
	                      .number = 1,
	                      .scene = make_scene(),
	                      .paused = true,
	                      .creator = {.client = CREATOR},
	                      .reply = reply_to(creation, CAU_METHOD_SESSION_CREATE)};
	assert_int_equal(cau_hosted_create(&t.h, &t.around, &def, NULL), CAU_OK);
	if (held_at != NOWHERE)
		pthread_barrier_wait(&t.met);
}

static void go_on(void)
{
	pthread_barrier_wait(&t.over);
}

static const answer *await(int asked)
{
	pthread_mutex_lock(&t.lock);
	while (!t.answers[asked].count)
		pthread_cond_wait(&t.answered, &t.lock);
	pthread_mutex_unlock(&t.lock);
	return &t.answers[asked];
}

static cau_order *new_order(int asked, cau_order_kind kind, cau_method method)
{
	cau_order *order = calloc(1, sizeof *order);
	order->kind = kind;
	order->asker = (cau_asker){.client = 1, .role = CAU_ROLE_OPERATE, .client_id = "a-client"};
	order->reply = reply_to(asked, method);
	return order;
}

static void submit(cau_order *order)
{
	cau_error error = {0};
	assert_int_equal(cau_hosted_submit(t.h, order, &error), CAU_OK);
}

static void destroy(int asked, int64_t client_sequence)
{
	cau_order *order = new_order(asked, CAU_ORDER_DESTROY, CAU_METHOD_SESSION_DESTROY);
	order->client_sequence = client_sequence;
	submit(order);
}

// One that waits in the queue for a tick that does not come.
static void turn_off_at_tick_1000(int asked)
{
	cau_order *order = new_order(asked, CAU_ORDER_COMMAND, CAU_METHOD_TOOL_ENERGIZE);
	cau_default_command(&order->as.command, CAU_COMMAND_TOOL_ENERGIZE);
	snprintf(order->as.command.tool, sizeof order->as.command.tool, "hook");
	order->as.command.tick = 1000;
	submit(order);
}

// The session is out of the hub's list, and its last holder lets it go.
static void let_go(void)
{
	cau_hosted_stop(t.h);
	cau_store_flush(t.around.store);
	cau_hosted_release(t.h);
	t.h = NULL;
}

static cau_status count_session(void *user, const cau_store_session *session)
{
	(void)session;
	++*(int *)user;
	return CAU_OK;
}

static int stored_sessions(void)
{
	int count = 0;
	cau_store_flush(t.around.store);
	assert_int_equal(cau_store_read_sessions(t.around.store, count_session, &count, NULL), CAU_OK);
	return count;
}

static cau_status count_answer(void *user, const cau_store_answer *row)
{
	(void)row;
	++*(int *)user;
	return CAU_OK;
}

static int stored_answers(uint64_t client_sequence)
{
	int count = 0;
	cau_error error = {0};
	cau_status status = cau_store_read_answer(t.around.store, "a-client", client_sequence,
	                                          count_answer, &count, &error);
	assert_true(status == CAU_OK || status == CAU_NOT_FOUND);
	return count;
}

// ---- tests --------------------------------------------------------------------------------------

static void destroyed_at_each_border_it_ends_there(void **state)
{
	(void)state;
	static const char *const stages[] = {"meshing", "ordering", "factoring", "settling"};
	for (int border = 0; border < CAU_BUILD_STAGE_COUNT; border++) {
		char before[32];
		memset(t.answers, 0, sizeof t.answers);
		begin(border, 0);
		destroy(1, 0);
		destroy(2, 0);
		go_on();
		const answer *creation = await(0);
		assert_int_equal(creation->status, CAU_BAD_STATE);
		snprintf(before, sizeof before, "before %s", stages[border]);
		assert_non_null(strstr(creation->reason, before));
		assert_int_equal(await(1)->status, CAU_OK);
		assert_int_equal(await(2)->code, CAU_RPC_NOT_HERE);
		assert_true(cau_hosted_ended(t.h));
		assert_int_equal(stored_sessions(), 0);
		let_go();
		for (int i = 0; i < 3; i++)
			assert_int_equal(t.answers[i].count, 1);
	}
}

static void destroyed_after_the_last_border_it_is_made_first(void **state)
{
	(void)state;
	begin(CAU_BUILD_STAGE_COUNT, 0);
	destroy(1, 0);
	go_on();
	assert_int_equal(await(0)->status, CAU_OK);
	assert_int_equal(await(1)->status, CAU_OK);
	assert_int_equal(stored_sessions(), 0);
}

// Sent twice because no answer came: both get it, and it is stored once.
static void a_resend_of_its_destruction_gets_the_same_answer(void **state)
{
	(void)state;
	begin(CAU_BUILD_FACTOR, 0);
	destroy(1, 5);
	destroy(2, 5);
	destroy(3, 6);
	go_on();
	assert_int_equal(await(1)->status, CAU_OK);
	assert_int_equal(await(2)->status, CAU_OK);
	assert_int_equal(await(3)->code, CAU_RPC_NOT_HERE);
	cau_store_flush(t.around.store);
	assert_int_equal(stored_answers(5), 1);
	assert_int_equal(stored_answers(6), 0);
}

// The order destroyed another session of this name; sent again it must not destroy this one.
static void a_resend_does_not_destroy_the_next_of_its_name(void **state)
{
	(void)state;
	begin(CAU_BUILD_ORDER, 0);
	destroy(1, 5);
	go_on();
	assert_int_equal(await(1)->status, CAU_OK);
	let_go();
	begin(CAU_BUILD_ORDER, 2);
	destroy(3, 5);
	go_on();
	assert_int_equal(await(3)->status, CAU_OK);
	assert_int_equal(await(2)->status, CAU_OK);
	assert_false(cau_hosted_ended(t.h));
	assert_int_equal(stored_sessions(), 1);
}

// Its first is on its way to the disk while the session of its name that is built now is destroyed
// by others.
static void a_resend_is_looked_for_once_its_first_is_on_the_disk(void **state)
{
	(void)state;
	begin(CAU_BUILD_ORDER, 0);
	t.hold_commit = true;
	destroy(1, 5);
	go_on();
	pthread_barrier_wait(&t.committing);
	cau_hosted_stop(t.h);
	cau_hosted_release(t.h);
	begin(CAU_BUILD_ORDER, 2);
	destroy(3, 5);
	destroy(4, 0);
	go_on();
	assert_int_equal(await(2)->status, CAU_BAD_STATE);
	pthread_barrier_wait(&t.commit);
	assert_int_equal(await(1)->status, CAU_OK);
	assert_int_equal(await(3)->status, CAU_OK);
	assert_int_equal(await(4)->status, CAU_OK);
}

// ---- what waits for one that ends: it is answered then, not when its last holder lets it go
static void assert_refused_as_gone(int asked)
{
	assert_int_equal(await(asked)->code, CAU_RPC_NOT_HERE);
}

static void what_waits_is_refused_where_it_does_not_come_to_be(void **state)
{
	(void)state;
	begin(CAU_BUILD_FACTOR, 0);
	turn_off_at_tick_1000(1);
	submit(new_order(2, CAU_ORDER_DESCRIBE, CAU_METHOD_SESSION_DESCRIBE));
	cau_hosted_abandon(t.h, CREATOR);
	go_on();
	assert_refused_as_gone(1);
	assert_refused_as_gone(2);
}

static void what_waits_is_refused_where_it_is_destroyed(void **state)
{
	(void)state;
	begin(NOWHERE, 0);
	assert_int_equal(await(0)->status, CAU_OK);
	turn_off_at_tick_1000(1);
	destroy(2, 0);
	assert_refused_as_gone(1);
	assert_int_equal(await(2)->status, CAU_OK);
}

// The store has another of its name, and takes no second one.
static void what_waits_is_refused_where_it_cannot_be_stored(void **state)
{
	(void)state;
	begin(NOWHERE, 0);
	assert_int_equal(await(0)->status, CAU_OK);
	let_go();
	begin(CAU_BUILD_STAGE_COUNT, 1);
	turn_off_at_tick_1000(2);
	go_on();
	assert_int_not_equal(await(1)->status, CAU_OK);
	assert_refused_as_gone(2);
	assert_true(cau_hosted_ended(t.h));
}

static void whose_creator_is_gone_for_good_it_ends(void **state)
{
	(void)state;
	begin(CAU_BUILD_FACTOR, 0);
	cau_hosted_abandon(t.h, CREATOR + 1); // somebody else
	cau_hosted_abandon(t.h, CREATOR);
	go_on();
	assert_non_null(strstr(await(0)->reason, "its creator is gone"));
	assert_int_equal(stored_sessions(), 0);
}

static void as_the_daemon_ends_it_ends(void **state)
{
	(void)state;
	begin(CAU_BUILD_ORDER, 0);
	cau_hosted_drain(t.h);
	assert_false(cau_hosted_drained(t.h));
	go_on();
	assert_non_null(strstr(await(0)->reason, "the daemon is ending"));
	assert_true(cau_hosted_drained(t.h));
	assert_int_equal(stored_sessions(), 0);
}

// The builder has stopped before it came to the job: nothing of it is left undone.
static void begun_after_the_builder_stopped_it_is_refused(void **state)
{
	(void)state;
	cau_builder_stop(t.around.builder);
	begin(NOWHERE, 0);
	assert_non_null(strstr(await(0)->reason, "the daemon is ending"));
	assert_true(cau_hosted_ended(t.h));
}

static void refuse_by(int64_t *setting, int64_t most, const char *name)
{
	int64_t usual = *setting;
	*setting = most;
	memset(t.answers, 0, sizeof t.answers);
	begin(NOWHERE, 0);
	assert_int_equal(await(0)->status, CAU_LIMIT);
	assert_non_null(strstr(await(0)->reason, name));
	*setting = usual;
	let_go();
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

// ---- what it is expected to take
static void write_mesh_file(off_t bytes)
{
	char path[60];
	snprintf(path, sizeof path, "%s/mesh.obj", t.folder);
	FILE *file = fopen(path, "w");
	assert_non_null(file);
	assert_int_equal(fclose(file), 0);
	assert_int_equal(truncate(path, bytes), 0);
}

static double expected_of(cau_mesh_source source, const char *directory, const char *file)
{
	cau_scene_def *scene = make_scene();
	scene->mesh_count = 1;
	cau_mesh_def *mesh = &scene->meshes[0];
	*mesh = (cau_mesh_def){.source = source, .cells = {300, 300, 0}};
	snprintf(scene->directory, sizeof scene->directory, "%s", directory);
	snprintf(mesh->file, sizeof mesh->file, "%s", file);
	double expected_s = cau_building_expects_s(scene);
	free(scene);
	return expected_s;
}

// What takes long does not stand before the short jobs.
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

int main(void)
{
#define TEST(function)                                                                             \
	cmocka_unit_test_setup_teardown(function, open_surroundings, close_surroundings)
	const struct CMUnitTest tests[] = {
		TEST(destroyed_at_each_border_it_ends_there),
		TEST(destroyed_after_the_last_border_it_is_made_first),
		TEST(a_resend_of_its_destruction_gets_the_same_answer),
		TEST(a_resend_does_not_destroy_the_next_of_its_name),
		TEST(a_resend_is_looked_for_once_its_first_is_on_the_disk),
		TEST(what_waits_is_refused_where_it_does_not_come_to_be),
		TEST(what_waits_is_refused_where_it_is_destroyed),
		TEST(what_waits_is_refused_where_it_cannot_be_stored),
		TEST(whose_creator_is_gone_for_good_it_ends),
		TEST(as_the_daemon_ends_it_ends),
		TEST(begun_after_the_builder_stopped_it_is_refused),
		TEST(beyond_a_limit_it_is_refused_by_the_settings_name),
		TEST(a_large_mesh_is_a_long_job_whatever_it_comes_from),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
