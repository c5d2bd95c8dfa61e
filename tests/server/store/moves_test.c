// SPDX-License-Identifier: GPL-3.0-or-later
// Tests a session that moves from one store to another in pieces. All records arrive, each once,
// whatever is added between the two readings. The records of moves stay valid.
#include "store_fixture.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "store/rows.h"

#define TEST(name) cmocka_unit_test_setup_teardown(name, fixture_setup, fixture_teardown)

enum { PATIENCE_MS = 30000 };
// limit of a piece's bytes; so small that a session takes several pieces
enum { PIECE_BYTES = 300 };

static void put_request(cau_store_batch *batch, uint64_t tick, uint64_t sequence)
{
	cau_store_command command = {.session = "d1-knee",
	                             .branch = 0,
	                             .tick = tick,
	                             .kind = 3,
	                             .payload = {"{}", 2},
	                             .client = "anna",
	                             .sequence = sequence,
	                             .result = {"ok", 2}};
	assert_int_equal(cau_store_put_command(batch, &command, NULL), CAU_OK);
}

static void put_checkpoint(cau_store_batch *batch, int64_t branch, uint64_t tick, uint64_t hash)
{
	cau_store_checkpoint checkpoint = {.session = "d1-knee",
	                                   .branch = branch,
	                                   .tick = tick,
	                                   .hash = hash,
	                                   .snapshot = {"state", 5}};
	assert_int_equal(cau_store_put_checkpoint(batch, &checkpoint, NULL), CAU_OK);
}

static void put_event(cau_store_batch *batch, int64_t branch, uint64_t tick)
{
	cau_store_event event = {
		.session = "d1-knee", .branch = branch, .tick = tick, .kind = "cut", .text = "{}"};
	assert_int_equal(cau_store_put_event(batch, &event, NULL), CAU_OK);
}

static void fill_first(cau_store *store)
{
	cau_store_batch *batch = cau_store_batch_create();
	cau_store_session row = {.id = "d1-knee",
	                         .name = "knee",
	                         .state = "running",
	                         .definition = {"{\"a\":1}", 7},
	                         .mesh = {"mesh", 4}};
	assert_int_equal(cau_store_put_session(batch, &row, NULL), CAU_OK);
	put_checkpoint(batch, 0, 0, UINT64_MAX - 6);
	assert_int_equal(cau_store_put_mark(batch, "d1-knee", 0, 0, NULL), CAU_OK);
	put_request(batch, 5, 11);
	put_tick_command(batch, "d1-knee", 0, 6);
	put_event(batch, 0, 5);
	cau_store_gap gap = {.session = "d1-knee", .branch = 0, .from_tick = 7, .before_tick = 8};
	assert_int_equal(cau_store_put_gap(batch, &gap, NULL), CAU_OK);
	assert_int_equal(write_batch(store, batch, NULL), CAU_OK);
}

static void fill_rest(cau_store *store)
{
	cau_store_batch *batch = cau_store_batch_create();
	put_request(batch, 9, 12);
	put_checkpoint(batch, 0, 0, 77); // replaces a checkpoint that has already been sent
	put_checkpoint(batch, 0, 10, 3);
	cau_store_branch branch = {.session = "d1-knee", .branch = 1, .parent = 0, .fork_tick = 6};
	assert_int_equal(cau_store_put_branch(batch, &branch, NULL), CAU_OK);
	put_tick_command(batch, "d1-knee", 1, 6);
	put_event(batch, 1, 6);
	assert_int_equal(cau_store_put_session_state(batch, "d1-knee", "paused", NULL), CAU_OK);
	assert_int_equal(write_batch(store, batch, NULL), CAU_OK);
}

static cau_status take_piece(cau_store *to, const cau_rows_writer *piece)
{
	cau_store_batch *batch = cau_store_batch_create();
	assert_int_equal(cau_rows_check(piece->bytes, piece->byte_count, NULL), CAU_OK);
	assert_int_equal(
		cau_store_lend_rows(batch, "d2-knee", piece->bytes, piece->byte_count, free, NULL), CAU_OK);
	return write_batch(to, batch, NULL);
}

// Carries all pieces. Returns how many there were.
static int carry(cau_store_dump *dump, cau_store *to)
{
	bool over = false;
	int count = 0;
	while (!over) {
		cau_rows_writer piece;
		cau_rows_begin(&piece, (uint32_t)count++);
		assert_int_equal(cau_store_dump_write(dump, &piece, PIECE_BYTES, &over, NULL), CAU_OK);
		assert_int_equal(take_piece(to, &piece), CAU_OK);
	}
	return count;
}

static cau_status see_session(void *user, const cau_store_session *session)
{
	*(bool *)user = true;
	assert_string_equal(session->state, "paused");
	assert_int_equal(session->branch, 1);
	assert_int_equal(session->definition.bytes, 7);
	assert_int_equal(session->mesh.bytes, 4);
	return CAU_OK;
}

static cau_status see_checkpoint(void *user, const cau_store_checkpoint *checkpoint)
{
	*(uint64_t *)user = checkpoint->hash;
	return CAU_OK;
}

static cau_status see_event(void *user, const cau_store_event *event)
{
	assert_string_equal(event->kind, "cut");
	++*(int *)user;
	return CAU_OK;
}

static cau_status see_answer(void *user, const cau_store_answer *answer)
{
	assert_memory_equal(answer->result.data, "ok", 2);
	assert_string_equal(answer->session, "d2-knee");
	++*(int *)user;
	return CAU_OK;
}

static void check_all(cau_store *to)
{
	bool seen = false;
	uint64_t ticks[8], hash = 0;
	int events = 0, answers = 0;
	assert_int_equal(cau_store_read_session(to, "d2-knee", see_session, &seen, NULL), CAU_OK);
	assert_true(seen);
	assert_int_equal(cau_store_read_checkpoint(to, "d2-knee", 0, 5, see_checkpoint, &hash, NULL),
	                 CAU_OK);
	assert_true(hash == 77);
	assert_int_equal(cau_store_read_checkpoint(to, "d2-knee", 0, 99, see_checkpoint, &hash, NULL),
	                 CAU_OK);
	assert_true(hash == 3);
	assert_int_equal(cau_store_read_events(to, "d2-knee", NULL, 9, see_event, &events, NULL),
	                 CAU_OK);
	assert_int_equal(events, 2);
	for (uint64_t sequence = 11; sequence <= 12; sequence++)
		assert_int_equal(cau_store_read_answer(to, "anna", sequence, see_answer, &answers, NULL),
		                 CAU_OK);
	assert_int_equal(answers, 2);
	// tick 8 is in the gap
	assert_int_equal(cau_store_check_reach(to, "d2-knee", 0, 8, NULL), CAU_BAD_VALUE);
	assert_int_equal(read_ticks(to, "d2-knee", 1, 6, 99, ticks, 8), 1);
}

static void a_session_arrives_whole_and_each_row_once(void **state)
{
	struct fixture *fixture = *state;
	cau_store_config there = fixture->config;
	char path[200];
	snprintf(path, sizeof path, "%s/other.db", fixture->folder);
	there.path = path;
	cau_store *from = open_store(&fixture->config), *to = open_store(&there);
	cau_store_dump *dump = NULL;
	fill_first(from);
	assert_int_equal(cau_store_dump_open(from, "d1-knee", &dump, NULL), CAU_OK);
	assert_true(carry(dump, to) > 1);
	fill_rest(from);
	assert_int_equal(cau_store_dump_rest(dump, NULL), CAU_OK);
	carry(dump, to);
	cau_store_dump_close(dump);
	check_all(to);
	cau_store_close(from);
	cau_store_close(to);
}

static cau_store_moved moved_row(void)
{
	return (cau_store_moved){.id = "d1-knee",
	                         .move = "m1",
	                         .target = "d2-knee",
	                         .label = "d2",
	                         .url = "ws://other",
	                         .proof = "secret"};
}

static cau_status count_moved(void *user, const cau_store_moved *moved)
{
	assert_string_equal(moved->target, "d2-knee");
	assert_string_equal(moved->proof, "secret");
	++*(int *)user;
	return CAU_OK;
}

static cau_status count_session(void *user, const cau_store_session *session)
{
	(void)session;
	++*(int *)user;
	return CAU_OK;
}

static int count_all(cau_store *store, int *sessions)
{
	int moved = 0;
	*sessions = 0;
	assert_int_equal(cau_store_read_moved(store, count_moved, &moved, NULL), CAU_OK);
	assert_int_equal(cau_store_read_sessions(store, count_session, sessions, NULL), CAU_OK);
	return moved;
}

static void a_session_goes_in_the_transaction_that_says_where(void **state)
{
	struct fixture *fixture = *state;
	int sessions;
	cau_store *store = open_store(&fixture->config);
	const cau_store_moved row = moved_row();
	cau_store_batch *batch = cau_store_batch_create();
	assert_int_equal(cau_store_put_moved(batch, &row, NULL), CAU_OK);
	// there is no such session any more
	assert_int_equal(write_batch(store, batch, NULL), CAU_NOT_FOUND);
	assert_int_equal(count_all(store, &sessions), 0);
	fill_first(store);
	batch = cau_store_batch_create();
	assert_int_equal(cau_store_put_moved(batch, &row, NULL), CAU_OK);
	assert_int_equal(write_batch(store, batch, NULL), CAU_OK);
	assert_int_equal(count_all(store, &sessions), 1);
	assert_int_equal(sessions, 0);
	cau_store_close(store);
	store = open_store(&fixture->config); // the same holds after the store is opened again
	assert_int_equal(count_all(store, &sessions), 1);
	assert_int_equal(sessions, 0);
	cau_store_close(store);
}

static cau_status see_arrival(void *user, const cau_store_arrival *arrival)
{
	assert_string_equal(arrival->move, "m2");
	*(int *)user = (int)arrival->state;
	return CAU_OK;
}

static cau_status put_arrival(cau_store *store, cau_store_arrival_state wanted)
{
	cau_store_arrival row = {.id = "d1-knee",
	                         .move = "m2",
	                         .lock = "hash",
	                         .source = "d2-knee",
	                         .label = "d2",
	                         .state = wanted};
	cau_store_batch *batch = cau_store_batch_create();
	assert_int_equal(cau_store_put_arrival(batch, &row, NULL), CAU_OK);
	return write_batch(store, batch, NULL);
}

// ---- answers
static cau_status ignore_answer(void *user, const cau_store_answer *answer)
{
	(void)user, (void)answer;
	return CAU_OK;
}

static cau_status look_for_answer(cau_store *store, const char *client)
{
	return cau_store_read_answer(store, client, 11, ignore_answer, NULL, NULL);
}

// Moves the session away. Its client's request 11 has an answer, and so has a request without a
// session. Nothing is removed yet.
static cau_store *move_away(struct fixture *fixture)
{
	fixture->config.retention_interval_ms = INT32_MAX;
	cau_store *store = open_store(&fixture->config);
	const cau_store_moved row = moved_row();
	cau_store_answer other = {.client = "other", .sequence = 11, .result = {"ok", 2}};
	fill_first(store);
	cau_store_batch *batch = cau_store_batch_create();
	assert_int_equal(cau_store_put_answer(batch, &other, NULL), CAU_OK);
	assert_int_equal(cau_store_put_moved(batch, &row, NULL), CAU_OK);
	assert_int_equal(write_batch(store, batch, NULL), CAU_OK);
	return store;
}

// Opens the store again, and waits until retention has removed something. Answers are removed
// first.
static cau_store *retire_some(struct fixture *fixture, cau_store *store)
{
	cau_store_metrics metrics = {0};
	cau_store_close(store);
	fixture->config.retention_interval_ms = 10;
	store = open_store(&fixture->config);
	for (int waited = 0; !metrics.retired_rows && waited < PATIENCE_MS; waited++) {
		usleep(1000);
		cau_store_get_metrics(store, &metrics);
	}
	assert_true(metrics.retired_rows > 0);
	return store;
}

static void answers_leave_with_their_session(void **state)
{
	struct fixture *fixture = *state;
	cau_store *store = move_away(fixture);
	assert_int_equal(look_for_answer(store, "anna"), CAU_OK);
	store = retire_some(fixture, store);
	assert_int_equal(look_for_answer(store, "anna"), CAU_NOT_FOUND);
	assert_int_equal(look_for_answer(store, "other"), CAU_OK);
	cau_store_close(store);
}

// A session that returns before its old records are removed still has its answers.
static void answers_of_a_session_that_comes_back_stay(void **state)
{
	struct fixture *fixture = *state;
	cau_store *store = move_away(fixture);
	assert_int_equal(put_arrival(store, CAU_STORE_WHOLE), CAU_OK);
	store = retire_some(fixture, store);
	assert_int_equal(look_for_answer(store, "anna"), CAU_OK);
	cau_store_close(store);
}

// If a session returns, the record that it moved away is valid until the session is accepted here.
static void an_old_row_goes_when_the_session_is_accepted_here_again(void **state)
{
	struct fixture *fixture = *state;
	int sessions, seen = -1;
	cau_store *store = open_store(&fixture->config);
	const cau_store_moved row = moved_row();
	fill_first(store);
	cau_store_batch *batch = cau_store_batch_create();
	assert_int_equal(cau_store_put_moved(batch, &row, NULL), CAU_OK);
	assert_int_equal(write_batch(store, batch, NULL), CAU_OK);
	assert_int_equal(put_arrival(store, CAU_STORE_WHOLE), CAU_OK);
	assert_int_equal(count_all(store, &sessions), 1);
	assert_int_equal(put_arrival(store, CAU_STORE_ACCEPTED), CAU_OK);
	assert_int_equal(count_all(store, &sessions), 0);
	assert_int_equal(cau_store_read_arrivals(store, see_arrival, &seen, NULL), CAU_OK);
	assert_int_equal(seen, CAU_STORE_ACCEPTED);
	batch = cau_store_batch_create();
	assert_int_equal(cau_store_forget_arrival(batch, "d1-knee", NULL), CAU_OK);
	assert_int_equal(write_batch(store, batch, NULL), CAU_OK);
	seen = -1;
	assert_int_equal(cau_store_read_arrivals(store, see_arrival, &seen, NULL), CAU_OK);
	assert_int_equal(seen, -1);
	cau_store_close(store);
}

// If some rows of a piece are in the store already, only the batch of that piece fails. The store
// stays sound.
static void rows_that_come_twice_fail_their_batch_alone(void **state)
{
	struct fixture *fixture = *state;
	cau_store *store = open_store(&fixture->config);
	cau_store_health health;
	for (int i = 0; i < 2; i++) {
		cau_rows_writer piece;
		cau_rows_begin(&piece, 0);
		if (i == 0) {
			cau_row row = {.table = CAU_ROWS_SESSION, .column_count = 3};
			row.column[0] = (cau_column){CAU_COLUMN_TEXT, 0, "paused", 6};
			row.column[1] = (cau_column){CAU_COLUMN_INTEGER, 1, NULL, 0};
			row.column[2] = (cau_column){CAU_COLUMN_BLOB, 0, "{}", 2};
			cau_rows_put(&piece, &row);
		}
		cau_row row = {.table = CAU_ROWS_COMMANDS, .column_count = 7};
		for (int c = 0; c < 6; c++)
			row.column[c].type = c < 4 ? CAU_COLUMN_INTEGER : CAU_COLUMN_NULL;
		row.column[6] = (cau_column){CAU_COLUMN_BLOB, 0, "", 0};
		cau_rows_put(&piece, &row);
		assert_int_equal(take_piece(store, &piece), i == 0 ? CAU_OK : CAU_BAD_VALUE);
	}
	cau_store_get_health(store, &health);
	assert_int_equal(health.state, CAU_STORE_READY);
	cau_store_close(store);
}

// The batch must fail by itself: otherwise the batch would be answered as if it were on the disk.
static void a_piece_of_no_session_fails_its_batch(void **state)
{
	struct fixture *fixture = *state;
	cau_rows_writer piece;
	cau_store *store = open_store(&fixture->config);
	cau_rows_begin(&piece, 3);
	assert_int_equal(take_piece(store, &piece), CAU_NOT_FOUND);
	cau_store_close(store);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		TEST(a_session_arrives_whole_and_each_row_once),
		TEST(a_session_goes_in_the_transaction_that_says_where),
		TEST(answers_leave_with_their_session),
		TEST(answers_of_a_session_that_comes_back_stay),
		TEST(an_old_row_goes_when_the_session_is_accepted_here_again),
		TEST(rows_that_come_twice_fail_their_batch_alone),
		TEST(a_piece_of_no_session_fails_its_batch),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
