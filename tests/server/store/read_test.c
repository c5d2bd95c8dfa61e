// SPDX-License-Identifier: GPL-3.0-or-later
// Tests that reads return the written records: sessions, answers to resends, branches with their
// shared past, events.
#include "store_fixture.h"

#include <string.h>

#define TEST(name) cmocka_unit_test_setup_teardown(name, fixture_setup, fixture_teardown)

static cau_store *open_with_knee(void **state)
{
	struct fixture *fixture = *state;
	cau_store *store = open_store(&fixture->config);
	assert_int_equal(write_batch(store, session_batch("knee"), NULL), CAU_OK);
	return store;
}

// ---- sessions -------------------------------------------------------------------------
struct seen_sessions {
	int count;
	char id[4][16], state[4][16];
	size_t mesh_bytes;
	int64_t branch;
};

static cau_status see_session(void *user, const cau_store_session *session)
{
	struct seen_sessions *seen = user;
	assert_string_equal(session->name, "a knee");
	assert_int_equal(session->definition.bytes, 11);
	assert_memory_equal(session->definition.data, "{\"scene\":1}", 11);
	assert_int_equal(session->created_ms, 1234);
	if (session->mesh.bytes)
		assert_memory_equal(session->mesh.data, "mesh\0bytes", 10);
	snprintf(seen->id[seen->count], 16, "%s", session->id);
	snprintf(seen->state[seen->count], 16, "%s", session->state);
	seen->mesh_bytes = session->mesh.bytes;
	seen->branch = session->branch;
	seen->count++;
	return CAU_OK;
}

static void sessions_come_back_after_a_restart(void **state)
{
	struct fixture *fixture = *state;
	struct seen_sessions seen = {0};
	cau_store *store = open_with_knee(state);
	assert_int_equal(write_batch(store, session_batch("elbow"), NULL), CAU_OK);
	cau_store_batch *batch = cau_store_batch_create();
	assert_int_equal(cau_store_put_session_state(batch, "elbow", "paused", NULL), CAU_OK);
	assert_int_equal(write_batch(store, batch, NULL), CAU_OK);
	cau_store_close(store);

	store = open_store(&fixture->config);
	assert_int_equal(cau_store_read_sessions(store, see_session, &seen, NULL), CAU_OK);
	assert_int_equal(seen.count, 2);
	assert_string_equal(seen.id[0], "knee");
	assert_string_equal(seen.state[0], "running");
	assert_string_equal(seen.id[1], "elbow");
	assert_string_equal(seen.state[1], "paused");
	assert_int_equal(seen.mesh_bytes, 0); // the list omits meshes
	assert_int_equal(cau_store_read_session(store, "knee", see_session, &seen, NULL), CAU_OK);
	assert_int_equal(seen.mesh_bytes, 10);
	cau_store_close(store);
}

static void an_id_is_taken_until_its_session_is_deleted(void **state)
{
	char reason[320];
	struct seen_sessions seen = {0};
	cau_store *store = open_with_knee(state);
	assert_int_equal(write_batch(store, session_batch("knee"), reason), CAU_ALREADY_EXISTS);
	assert_non_null(strstr(reason, "knee"));
	assert_int_equal(write_batch(store, command_batch("knee", 0, 5), NULL), CAU_OK);
	cau_store_batch *batch = cau_store_batch_create();
	assert_int_equal(cau_store_delete_session(batch, "knee", NULL), CAU_OK);
	assert_int_equal(write_batch(store, batch, NULL), CAU_OK);
	assert_int_equal(cau_store_read_sessions(store, see_session, &seen, NULL), CAU_OK);
	assert_int_equal(seen.count, 0);
	assert_int_equal(cau_store_read_session(store, "knee", see_session, &seen, NULL),
	                 CAU_NOT_FOUND);
	assert_int_equal(write_batch(store, command_batch("knee", 0, 6), NULL), CAU_NOT_FOUND);
	// A new session with the same id has no records of the old one.
	uint64_t ticks[4];
	assert_int_equal(write_batch(store, session_batch("knee"), NULL), CAU_OK);
	assert_int_equal(read_ticks(store, "knee", 0, 0, 100, ticks, 4), 0);
	cau_store_close(store);
}

// ---- resends --------------------------------------------------------------------------
struct seen_answer {
	char result[64], session[32];
};

static cau_status see_answer(void *user, const cau_store_answer *answer)
{
	struct seen_answer *seen = user;
	snprintf(seen->result, sizeof seen->result, "%.*s", (int)answer->result.bytes,
	         (const char *)answer->result.data);
	snprintf(seen->session, sizeof seen->session, "%s", answer->session ? answer->session : "-");
	return CAU_OK;
}

static cau_store_batch *request_batch(uint64_t tick, uint64_t sequence, const char *result)
{
	cau_store_batch *batch = cau_store_batch_create();
	cau_store_command command = {
		.session = "knee",
		.tick = tick,
		.client = "browser-1",
		.sequence = sequence,
		.payload = {"pin", 3},
		.result = {result, strlen(result)},
	};
	assert_int_equal(cau_store_put_command(batch, &command, NULL), CAU_OK);
	return batch;
}

static cau_status see_client(void *user, const char *client, uint64_t sequence)
{
	assert_string_equal(client, "browser-1");
	*(uint64_t *)user = sequence;
	return CAU_OK;
}

static void a_resent_request_finds_its_first_answer(void **state)
{
	struct fixture *fixture = *state;
	struct seen_answer seen;
	char reason[320];
	uint64_t newest = 0;
	cau_store *store = open_with_knee(state);
	assert_int_equal(cau_store_read_answer(store, "browser-1", 41, see_answer, &seen, NULL),
	                 CAU_NOT_FOUND);
	assert_int_equal(write_batch(store, request_batch(10, 41, "{\"pinned\":3}"), NULL), CAU_OK);
	assert_int_equal(write_batch(store, request_batch(11, 40, "late"), NULL), CAU_OK);
	// A second command with the same request is refused, with its whole batch.
	assert_int_equal(write_batch(store, request_batch(12, 41, "again"), reason),
	                 CAU_ALREADY_EXISTS);
	assert_non_null(strstr(reason, "41"));
	cau_store_close(store);

	store = open_store(&fixture->config);
	assert_int_equal(cau_store_read_answer(store, "browser-1", 41, see_answer, &seen, NULL),
	                 CAU_OK);
	assert_string_equal(seen.result, "{\"pinned\":3}");
	assert_string_equal(seen.session, "knee");
	assert_int_equal(cau_store_read_answer(store, "browser-2", 41, see_answer, &seen, NULL),
	                 CAU_NOT_FOUND);
	assert_int_equal(cau_store_read_clients(store, "knee", see_client, &newest, NULL), CAU_OK);
	assert_int_equal(newest, 41);
	cau_store_close(store);
}

static void an_answer_outlives_its_session(void **state)
{
	struct seen_answer seen;
	cau_store *store = open_with_knee(state);
	cau_store_batch *batch = cau_store_batch_create();
	cau_store_answer answer = {"browser-1", 7, NULL, {"destroyed", 9}};
	assert_int_equal(cau_store_delete_session(batch, "knee", NULL), CAU_OK);
	assert_int_equal(cau_store_put_answer(batch, &answer, NULL), CAU_OK);
	assert_int_equal(write_batch(store, batch, NULL), CAU_OK);
	assert_int_equal(cau_store_read_answer(store, "browser-1", 7, see_answer, &seen, NULL), CAU_OK);
	assert_string_equal(seen.result, "destroyed");
	assert_string_equal(seen.session, "-");
	cau_store_close(store);
}

struct pending {
	cau_store *store;
	cau_status inside;
};

// Reads on the store thread while the next batch is taken and not yet answered.
static void look_from_callback(void *user, cau_status status, const char *reason)
{
	struct pending *pending = user;
	(void)status, (void)reason;
	struct seen_answer seen;
	pending->inside =
		cau_store_read_answer(pending->store, "browser-1", 2, see_answer, &seen, NULL);
}

static void submit_two(void *user, cau_status status, const char *reason)
{
	struct pending *pending = user;
	(void)status, (void)reason;
	// Both batches wait until this returns, so they share a commit.
	assert_int_equal(cau_store_submit(pending->store, request_batch(1, 1, "one"),
	                                  look_from_callback, pending, NULL),
	                 CAU_OK);
	assert_int_equal(cau_store_submit(pending->store, request_batch(2, 2, "two"), NULL, NULL, NULL),
	                 CAU_OK);
}

static void a_request_on_its_way_to_the_disk_is_known(void **state)
{
	struct fixture *fixture = *state;
	struct seen_answer seen;
	cau_store *store = open_store(&fixture->config);
	struct pending pending = {store, CAU_STATUS_COUNT};
	assert_int_equal(cau_store_submit(store, session_batch("knee"), submit_two, &pending, NULL),
	                 CAU_OK);
	cau_store_flush(store); // commits the session
	cau_store_flush(store); // commits the two batches that the session's callback submitted
	assert_int_equal(pending.inside, CAU_BAD_STATE);
	assert_int_equal(cau_store_read_answer(store, "browser-1", 2, see_answer, &seen, NULL), CAU_OK);
	assert_string_equal(seen.result, "two");
	cau_store_close(store);
}

// ---- branches -------------------------------------------------------------------------
static void open_branch(cau_store *store, int64_t branch, int64_t parent, uint64_t fork_tick,
                        cau_status expected)
{
	cau_store_batch *batch = cau_store_batch_create();
	cau_store_branch opened = {
		.session = "knee", .branch = branch, .parent = parent, .fork_tick = fork_tick};
	assert_int_equal(cau_store_put_branch(batch, &opened, NULL), CAU_OK);
	assert_int_equal(write_batch(store, batch, NULL), expected);
}

static void log_ticks(cau_store *store, int64_t branch, uint64_t from, uint64_t before)
{
	cau_store_batch *batch = cau_store_batch_create();
	for (uint64_t tick = from; tick < before; tick++)
		put_tick_command(batch, "knee", branch, tick);
	assert_int_equal(write_batch(store, batch, NULL), CAU_OK);
}

static void put_checkpoint(cau_store *store, int64_t branch, uint64_t tick, const char *snapshot)
{
	cau_store_batch *batch = cau_store_batch_create();
	cau_store_checkpoint checkpoint = {
		.session = "knee",
		.branch = branch,
		.tick = tick,
		.hash = 0xfedcba9876543210u + tick,
		.snapshot = {snapshot, strlen(snapshot)},
	};
	assert_int_equal(cau_store_put_checkpoint(batch, &checkpoint, NULL), CAU_OK);
	assert_int_equal(write_batch(store, batch, NULL), CAU_OK);
}

static cau_status see_checkpoint(void *user, const cau_store_checkpoint *checkpoint)
{
	assert_true(checkpoint->hash == 0xfedcba9876543210u + checkpoint->tick);
	snprintf(user, 64, "%.*s", (int)checkpoint->snapshot.bytes,
	         (const char *)checkpoint->snapshot.data);
	return CAU_OK;
}

static void expect_checkpoint(cau_store *store, int64_t branch, uint64_t tick, const char *expected)
{
	char seen[64] = "";
	cau_status status =
		cau_store_read_checkpoint(store, "knee", branch, tick, see_checkpoint, seen, NULL);
	assert_int_equal(status, expected ? CAU_OK : CAU_NOT_FOUND);
	assert_string_equal(seen, expected ? expected : "");
}

// Checks that the branch sees a command at each tick from `from` on, `count` in all.
static void expect_log(cau_store *store, int64_t branch, uint64_t from, uint64_t before, int count)
{
	static uint64_t ticks[2000];
	assert_int_equal(read_ticks(store, "knee", branch, from, before, ticks, 2000), count);
	for (int i = 0; i < count; i++)
		assert_int_equal(ticks[i], from + (uint64_t)i);
}

static void a_branch_sees_its_past_and_not_its_siblings(void **state)
{
	cau_store *store = open_with_knee(state);
	log_ticks(store, 0, 0, 200);
	put_checkpoint(store, 0, 50, "root 50");
	put_checkpoint(store, 0, 100, "root 100");
	put_checkpoint(store, 0, 150, "root 150");
	open_branch(store, 1, 0, 100, CAU_OK); // a rewind to tick 100
	log_ticks(store, 1, 100, 130);
	put_checkpoint(store, 1, 120, "one 120");

	expect_log(store, 0, 0, 1000, 200);
	expect_log(store, 1, 0, 1000, 130);
	expect_log(store, 1, 90, 110, 20); // ticks on both sides of the fork
	expect_log(store, 1, 100, 130, 30);
	expect_checkpoint(store, 1, 1000, "one 120");
	// the checkpoint at the fork tick itself is shared
	expect_checkpoint(store, 1, 119, "root 100");
	expect_checkpoint(store, 1, 99, "root 50");
	expect_checkpoint(store, 1, 49, NULL);
	expect_checkpoint(store, 0, 1000, "root 150");
	// this checkpoint replaces the earlier checkpoint of tick 150
	put_checkpoint(store, 0, 150, "root 150 again");
	expect_checkpoint(store, 0, 160, "root 150 again");
	cau_store_close(store);
}

struct seen_branches {
	int count;
	cau_store_branch branch[8];
};

static cau_status see_branch(void *user, const cau_store_branch *branch)
{
	struct seen_branches *seen = user;
	seen->branch[seen->count++] = *branch;
	return CAU_OK;
}

static void a_fork_before_the_parents_start_finds_the_owner(void **state)
{
	cau_store *store = open_with_knee(state);
	struct seen_branches seen = {0};
	struct seen_sessions sessions = {0};
	log_ticks(store, 0, 0, 200);
	open_branch(store, 1, 0, 100, CAU_OK);
	log_ticks(store, 1, 100, 150);
	open_branch(store, 2, 1, 40, CAU_OK);
	log_ticks(store, 2, 40, 60);
	open_branch(store, 2, 1, 40, CAU_ALREADY_EXISTS);
	open_branch(store, 3, 9, 40, CAU_NOT_FOUND);
	expect_log(store, 2, 0, 1000, 60);
	assert_int_equal(cau_store_read_branches(store, "knee", see_branch, &seen, NULL), CAU_OK);
	assert_int_equal(seen.count, 3);
	assert_int_equal(seen.branch[0].parent, -1);
	// the parent is not branch 1, which starts at tick 100
	assert_int_equal(seen.branch[2].parent, 0);
	assert_int_equal(seen.branch[2].fork_tick, 40);
	assert_true(seen.branch[0].left_ms > 0 && seen.branch[1].left_ms > 0);
	assert_int_equal(seen.branch[2].left_ms, 0);
	assert_int_equal(cau_store_read_session(store, "knee", see_session, &sessions, NULL), CAU_OK);
	assert_int_equal(sessions.branch, 2);
	cau_store_close(store);
}

static void a_long_log_is_read_in_pieces_and_whole(void **state)
{
	cau_store *store = open_with_knee(state);
	log_ticks(store, 0, 0, 1537); // the log has six pieces and one entry more
	expect_log(store, 0, 0, 1000000, 1537);
	expect_log(store, 0, 256, 768, 512); // these ticks are exactly two pieces
	assert_int_equal(cau_store_read_log(store, "knee", 5, 0, 10, NULL, NULL, NULL), CAU_NOT_FOUND);
	assert_int_equal(cau_store_read_log(store, "hip", 0, 0, 10, NULL, NULL, NULL), CAU_NOT_FOUND);
	cau_store_close(store);
}

static cau_status count_order(void *user, const cau_store_command *command)
{
	uint32_t *next = user;
	assert_int_equal(command->order, *next);
	++*next;
	return *next == 7 ? CAU_LIMIT : CAU_OK;
}

static void a_visitor_can_stop_and_order_within_a_tick_holds(void **state)
{
	cau_store *store = open_with_knee(state);
	uint32_t next = 0;
	cau_store_batch *batch = cau_store_batch_create();
	for (uint32_t order = 0; order < 10; order++) {
		cau_store_command command = {.session = "knee", .tick = 3, .order = 9 - order};
		assert_int_equal(cau_store_put_command(batch, &command, NULL), CAU_OK);
	}
	assert_int_equal(write_batch(store, batch, NULL), CAU_OK);
	assert_int_equal(cau_store_read_log(store, "knee", 0, 0, 10, count_order, &next, NULL),
	                 CAU_LIMIT);
	assert_int_equal(next, 7);
	cau_store_close(store);
}

static cau_status see_kind(void *user, const cau_store_command *command)
{
	char *text = user;
	sprintf(text + strlen(text), "%llu:%d ", (unsigned long long)command->tick, command->kind);
	return CAU_OK;
}

static void how_far_a_session_came_is_one_entry(void **state)
{
	char text[128] = "";
	const struct {
		uint64_t tick;
		int32_t kind;
	} entries[] = {{1, CAU_STORE_REACHED},
	               {2, CAU_STORE_REACHED},
	               {2, 5},
	               {3, CAU_STORE_REACHED},
	               {4, CAU_STORE_REACHED}};
	cau_store *store = open_with_knee(state);
	for (uint32_t i = 0; i < sizeof entries / sizeof *entries; i++) {
		cau_store_batch *batch = cau_store_batch_create();
		cau_store_command command = {
			.session = "knee", .tick = entries[i].tick, .order = i, .kind = entries[i].kind};
		assert_int_equal(cau_store_put_command(batch, &command, NULL), CAU_OK);
		assert_int_equal(write_batch(store, batch, NULL), CAU_OK);
	}
	assert_int_equal(cau_store_read_log(store, "knee", 0, 0, 10, see_kind, text, NULL), CAU_OK);
	assert_string_equal(text, "2:-1 2:5 4:-1 ");
	cau_store_close(store);
}

// ---- events ---------------------------------------------------------------------------
static cau_status see_event(void *user, const cau_store_event *event)
{
	char *text = user;
	sprintf(text + strlen(text), "%llu:%d:%s:%s ", (unsigned long long)event->tick, event->level,
	        event->kind, event->text);
	return CAU_OK;
}

static void events_come_newest_first(void **state)
{
	char text[256] = "";
	cau_store *store = open_with_knee(state);
	cau_store_batch *batch = cau_store_batch_create();
	const cau_store_event events[] = {
		{.session = "knee", .tick = 1, .level = 2, .kind = "cut", .text = "{\"tool\":1}"},
		{.session = "knee", .tick = 2, .level = 1, .kind = "pin", .text = "b"},
		{.session = NULL, .level = 3, .kind = "start", .text = "c"},
		{.session = "knee", .tick = 3, .level = 1, .kind = "pin", .text = "d"},
	};
	for (size_t i = 0; i < sizeof events / sizeof *events; i++)
		assert_int_equal(cau_store_put_event(batch, &events[i], NULL), CAU_OK);
	assert_int_equal(write_batch(store, batch, NULL), CAU_OK);
	assert_int_equal(cau_store_read_events(store, "knee", NULL, 2, see_event, text, NULL), CAU_OK);
	assert_string_equal(text, "3:1:pin:d 2:1:pin:b ");
	text[0] = 0;
	assert_int_equal(cau_store_read_events(store, "knee", "cut", 9, see_event, text, NULL), CAU_OK);
	assert_string_equal(text, "1:2:cut:{\"tool\":1} ");
	text[0] = 0;
	assert_int_equal(cau_store_read_events(store, NULL, NULL, 10, see_event, text, NULL), CAU_OK);
	assert_string_equal(text, "0:3:start:c ");
	cau_store_close(store);
}

static void put_branch(cau_store *store, int64_t branch, int64_t parent, uint64_t fork_tick)
{
	cau_store_batch *batch = cau_store_batch_create();
	cau_store_branch row = {
		.session = "knee", .branch = branch, .parent = parent, .fork_tick = fork_tick};
	assert_int_equal(cau_store_put_branch(batch, &row, NULL), CAU_OK);
	assert_int_equal(write_batch(store, batch, NULL), CAU_OK);
}

static void put_events(cau_store *store, int64_t branch, uint64_t first, uint64_t last)
{
	cau_store_batch *batch = cau_store_batch_create();
	for (uint64_t tick = first; tick <= last; tick++) {
		cau_store_event event = {.session = "knee",
		                         .branch = branch,
		                         .tick = tick,
		                         .kind = "cut",
		                         .text = (const char *[]){"a", "b", "c"}[branch]};
		assert_int_equal(cau_store_put_event(batch, &event, NULL), CAU_OK);
	}
	assert_int_equal(write_batch(store, batch, NULL), CAU_OK);
}

static void expect_timeline(cau_store *store, int64_t branch, uint64_t from_tick, uint64_t to_tick,
                            int32_t count, const char *expected)
{
	char text[256] = "";
	assert_int_equal(cau_store_read_timeline(store, "knee", branch, from_tick, to_tick, count,
	                                         see_event, text, NULL),
	                 CAU_OK);
	assert_string_equal(text, expected);
}

static void a_branch_sees_the_events_of_its_line(void **state)
{
	cau_store *store = open_with_knee(state);
	put_events(store, 0, 1, 5);
	put_branch(store, 1, 0, 3);
	put_events(store, 1, 3, 4);
	put_branch(store, 2, 1, 2); // the parent becomes branch 0, which owns that tick
	put_events(store, 2, 7, 7);
	const char *whole = "5:0:cut:a 4:0:cut:a 3:0:cut:a 2:0:cut:a 1:0:cut:a ";
	expect_timeline(store, 0, 0, UINT64_MAX, 99, whole);
	expect_timeline(store, 1, 0, UINT64_MAX, 99,
	                "4:0:cut:b 3:0:cut:b 3:0:cut:a 2:0:cut:a 1:0:cut:a ");
	expect_timeline(store, 2, 0, UINT64_MAX, 99, "7:0:cut:c 2:0:cut:a 1:0:cut:a ");
	expect_timeline(store, 1, 2, 3, 99, "3:0:cut:b 3:0:cut:a 2:0:cut:a ");
	expect_timeline(store, 1, 0, UINT64_MAX, 3, "4:0:cut:b 3:0:cut:b 3:0:cut:a ");
	cau_store_batch *batch = cau_store_batch_create();
	assert_int_equal(cau_store_forget_events(batch, "knee", 0, 4, NULL), CAU_OK);
	assert_int_equal(write_batch(store, batch, NULL), CAU_OK);
	expect_timeline(store, 0, 0, UINT64_MAX, 99, whole + strlen("5:0:cut:a "));
	expect_timeline(store, 2, 7, UINT64_MAX, 99, "7:0:cut:c ");
	assert_int_equal(cau_store_read_timeline(store, "knee", 9, 0, 9, 9, see_event, NULL, NULL),
	                 CAU_NOT_FOUND);
	cau_store_close(store);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		TEST(sessions_come_back_after_a_restart),
		TEST(an_id_is_taken_until_its_session_is_deleted),
		TEST(a_resent_request_finds_its_first_answer),
		TEST(an_answer_outlives_its_session),
		TEST(a_request_on_its_way_to_the_disk_is_known),
		TEST(a_branch_sees_its_past_and_not_its_siblings),
		TEST(a_fork_before_the_parents_start_finds_the_owner),
		TEST(a_long_log_is_read_in_pieces_and_whole),
		TEST(a_visitor_can_stop_and_order_within_a_tick_holds),
		TEST(how_far_a_session_came_is_one_entry),
		TEST(events_come_newest_first),
		TEST(a_branch_sees_the_events_of_its_line),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
