// SPDX-License-Identifier: GPL-3.0-or-later
#include "store_fixture.h"

#include <ftw.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

int fixture_setup(void **state)
{
	struct fixture *fixture = calloc(1, sizeof *fixture);
	snprintf(fixture->folder, sizeof fixture->folder, "/tmp/cautery-store-XXXXXX");
	if (!mkdtemp(fixture->folder))
		return -1;
	snprintf(fixture->path, sizeof fixture->path, "%s/store.db", fixture->folder);
	fixture->config = cau_store_default_config();
	fixture->config.path = fixture->path;
	*state = fixture;
	return 0;
}

static int remove_entry(const char *path, const struct stat *status, int kind, struct FTW *place)
{
	(void)status, (void)kind, (void)place;
	return remove(path);
}

void remove_tree(const char *folder)
{
	nftw(folder, remove_entry, 8, FTW_DEPTH | FTW_PHYS);
}

int fixture_teardown(void **state)
{
	struct fixture *fixture = *state;
	remove_tree(fixture->folder);
	free(fixture);
	return 0;
}

unsigned char *read_file(const char *path, size_t *bytes)
{
	FILE *file = fopen(path, "rb");
	assert_non_null(file);
	fseek(file, 0, SEEK_END);
	*bytes = (size_t)ftell(file);
	rewind(file);
	unsigned char *data = malloc(*bytes + 1);
	assert_int_equal(fread(data, 1, *bytes, file), *bytes);
	fclose(file);
	return data;
}

void write_file(const char *path, const void *data, size_t bytes)
{
	FILE *file = fopen(path, "wb");
	assert_non_null(file);
	assert_int_equal(fwrite(data, 1, bytes, file), bytes);
	assert_int_equal(fclose(file), 0);
}

cau_store *open_store(const cau_store_config *config)
{
	cau_store *store = NULL;
	cau_error error = {0};
	if (cau_store_open(config, &store, &error))
		fail_msg("%s: %s", cau_status_name(error.status), error.reason);
	return store;
}

struct answer {
	cau_status status;
	char reason[320];
};

static void keep_answer(void *user, cau_status status, const char *reason)
{
	struct answer *answer = user;
	answer->status = status;
	snprintf(answer->reason, sizeof answer->reason, "%s", reason);
}

cau_status write_batch(cau_store *store, cau_store_batch *batch, char reason[320])
{
	struct answer answer = {CAU_STATUS_COUNT, ""};
	cau_error error = {0};
	cau_status status = cau_store_submit(store, batch, keep_answer, &answer, &error);
	if (status) {
		cau_store_batch_destroy(batch);
		answer.status = status;
		snprintf(answer.reason, sizeof answer.reason, "%s", error.reason);
	} else {
		cau_store_flush(store);
	}
	if (reason)
		memcpy(reason, answer.reason, sizeof answer.reason);
	return answer.status;
}

cau_store_batch *session_batch(const char *id)
{
	cau_store_batch *batch = cau_store_batch_create();
	cau_store_session session = {
		.id = id,
		.name = "a knee",
		.state = "running",
		.definition = {"{\"scene\":1}", 11},
		.mesh = {"mesh\0bytes", 10},
		.created_ms = 1234,
	};
	assert_int_equal(cau_store_put_session(batch, &session, NULL), CAU_OK);
	return batch;
}

void put_tick_command(cau_store_batch *batch, const char *session, int64_t branch, uint64_t tick)
{
	cau_store_command command = {
		.session = session,
		.branch = branch,
		.tick = tick,
		.kind = 3,
		.payload = {&tick, sizeof tick},
	};
	assert_int_equal(cau_store_put_command(batch, &command, NULL), CAU_OK);
}

cau_store_batch *command_batch(const char *session, int64_t branch, uint64_t tick)
{
	cau_store_batch *batch = cau_store_batch_create();
	put_tick_command(batch, session, branch, tick);
	return batch;
}

struct tick_list {
	uint64_t *tick;
	int count, capacity;
};

static cau_status keep_tick(void *user, const cau_store_command *command)
{
	struct tick_list *list = user;
	assert_int_equal(command->kind, 3);
	assert_int_equal(command->payload.bytes, sizeof command->tick);
	assert_memory_equal(command->payload.data, &command->tick, sizeof command->tick);
	assert_true(list->count < list->capacity);
	list->tick[list->count++] = command->tick;
	return CAU_OK;
}

int read_ticks(cau_store *store, const char *session, int64_t branch, uint64_t from,
               uint64_t before, uint64_t *ticks, int capacity)
{
	struct tick_list list = {ticks, 0, capacity};
	cau_error error = {0};
	if (cau_store_read_log(store, session, branch, from, before, keep_tick, &list, &error))
		fail_msg("%s: %s", cau_status_name(error.status), error.reason);
	return list.count;
}
