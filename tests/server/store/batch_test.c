// SPDX-License-Identifier: GPL-3.0-or-later
// Tests that batches copy their arguments, refuse what cannot be stored, and then stay unchanged.
#include "store_fixture.h"

#include <string.h>

#include "store/batch.h"

static void puts_copy_what_they_are_given(void **state)
{
	(void)state;
	char session[] = "knee", client[] = "browser", payload[] = "move";
	cau_store_batch *batch = cau_store_batch_create();
	cau_store_command command = {
		.session = session,
		.tick = 7,
		.order = 2,
		.payload = {payload, 4},
		.client = client,
		.sequence = 9,
		.result = {"ok", 2},
	};
	assert_int_equal(cau_store_put_command(batch, &command, NULL), CAU_OK);
	memset(session, 'x', 4);
	memset(client, 'x', 7);
	memset(payload, 'x', 4);
	const cau_store_command *copy = &batch->first->as.command;
	assert_string_equal(copy->session, "knee");
	assert_string_equal(copy->client, "browser");
	assert_memory_equal(copy->payload.data, "move", 4);
	assert_memory_equal(copy->result.data, "ok", 2);
	assert_true(cau_store_batch_bytes(batch) > 20);
	cau_store_batch_destroy(batch);
}

static void an_empty_client_is_no_client(void **state)
{
	(void)state;
	const char *client;
	uint64_t sequence;
	cau_store_batch *batch = cau_store_batch_create();
	cau_store_command command = {.session = "knee", .client = ""};
	assert_int_equal(cau_store_put_command(batch, &command, NULL), CAU_OK);
	assert_false(cau_store_record_request(batch->first, &client, &sequence));
	cau_store_batch_destroy(batch);
}

static void bad_values_leave_the_batch_as_it_was(void **state)
{
	(void)state;
	char long_name[CAU_STORE_ID_BYTES + 1];
	memset(long_name, 'a', CAU_STORE_ID_BYTES);
	long_name[CAU_STORE_ID_BYTES] = 0;
	cau_error error;
	cau_store_batch *batch = cau_store_batch_create();
	const cau_store_session sessions[] = {
		{.id = NULL, .name = "n", .state = "s"},
		{.id = "", .name = "n", .state = "s"},
		{.id = long_name, .name = "n", .state = "s"},
		{.id = "a", .name = "n", .state = "s", .branch = 1},
		{.id = "a", .name = "n", .state = "s", .mesh = {NULL, 3}},
	};
	for (size_t i = 0; i < sizeof sessions / sizeof *sessions; i++)
		assert_int_equal(cau_store_put_session(batch, &sessions[i], &error), CAU_BAD_VALUE);
	const cau_store_command commands[] = {
		{.session = "a", .branch = -1},
		{.session = "a", .tick = (uint64_t)INT64_MAX + 1},
		{.session = "a", .client = "c", .sequence = UINT64_MAX},
		{.session = "a", .result = {"r", 1}},
	};
	for (size_t i = 0; i < sizeof commands / sizeof *commands; i++)
		assert_int_equal(cau_store_put_command(batch, &commands[i], &error), CAU_BAD_VALUE);
	cau_store_checkpoint huge = {.session = "a", .snapshot = {"", CAU_STORE_BLOB_BYTES + 1}};
	assert_int_equal(cau_store_put_checkpoint(batch, &huge, &error), CAU_LIMIT);
	assert_string_equal(error.path, "snapshot");
	cau_store_branch root = {.session = "a", .branch = 0};
	assert_int_equal(cau_store_put_branch(batch, &root, &error), CAU_BAD_VALUE);
	cau_store_event mute = {.kind = "k"};
	assert_int_equal(cau_store_put_event(batch, &mute, &error), CAU_BAD_VALUE);
	cau_store_answer nobody = {.sequence = 1};
	assert_int_equal(cau_store_put_answer(batch, &nobody, &error), CAU_BAD_VALUE);
	assert_int_equal(cau_store_batch_bytes(batch), 0);
	assert_null(batch->first);
	cau_store_batch_destroy(batch);
}

static int given_back;

static void count_return(void *snapshot)
{
	assert_string_equal(snapshot, "the state at 7");
	given_back++;
}

static void a_lent_snapshot_comes_back_with_the_batch(void **state)
{
	(void)state;
	static char snapshot[] = "the state at 7";
	cau_error error;
	cau_store_checkpoint row = {
		.session = "knee", .tick = 7, .snapshot = {snapshot, sizeof snapshot}};
	cau_store_checkpoint nobodys = {.snapshot = {snapshot, sizeof snapshot}};
	cau_store_batch *batch = cau_store_batch_create();
	given_back = 0;
	assert_int_equal(cau_store_lend_checkpoint(batch, &nobodys, count_return, &error),
	                 CAU_BAD_VALUE);
	assert_int_equal(cau_store_lend_checkpoint(batch, &row, count_return, &error), CAU_OK);
	assert_ptr_equal(batch->first->as.checkpoint.snapshot.data, snapshot);
	assert_true(cau_store_batch_bytes(batch) > sizeof snapshot);
	assert_int_equal(given_back, 0); // after a failure the snapshot still belongs to the caller
	cau_store_batch_destroy(batch);
	assert_int_equal(given_back, 1);
}

static cau_status has_it(void *user, const cau_store_checkpoint *checkpoint)
{
	assert_string_equal(checkpoint->snapshot.data, "the state at 7");
	*(bool *)user = true;
	return CAU_OK;
}

static void a_lent_snapshot_is_stored_and_then_comes_back(void **state)
{
	const struct fixture *fixture = *state;
	cau_store *store = open_store(&fixture->config);
	bool found = false;
	char snapshot[] = "the state at 7";
	cau_store_checkpoint row = {
		.session = "knee", .tick = 7, .snapshot = {snapshot, sizeof snapshot}};
	cau_store_batch *batch = session_batch("knee");
	given_back = 0;
	assert_int_equal(cau_store_lend_checkpoint(batch, &row, count_return, NULL), CAU_OK);
	assert_int_equal(write_batch(store, batch, NULL), CAU_OK);
	assert_int_equal(cau_store_read_checkpoint(store, "knee", 0, 7, has_it, &found, NULL), CAU_OK);
	assert_true(found);
	cau_store_close(store);
	assert_int_equal(given_back, 1);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(puts_copy_what_they_are_given),
		cmocka_unit_test(an_empty_client_is_no_client),
		cmocka_unit_test(bad_values_leave_the_batch_as_it_was),
		cmocka_unit_test(a_lent_snapshot_comes_back_with_the_batch),
		cmocka_unit_test_setup_teardown(a_lent_snapshot_is_stored_and_then_comes_back,
	                                    fixture_setup, fixture_teardown),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
