// SPDX-License-Identifier: GPL-3.0-or-later
// A folder of its own for each test, and the few calls that every store test makes.
#pragma once

// cmocka wants these first.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "store/store.h"

struct fixture {
	char folder[128];        // removed at the end
	char path[160];          // folder/store.db, not made yet
	cau_store_config config; // defaults, with this path
};

int fixture_setup(void **state);
int fixture_teardown(void **state);

// Removes a folder and all in it.
void remove_tree(const char *folder);

// A file's bytes, free()d by the caller.
unsigned char *read_file(const char *path, size_t *bytes);
void write_file(const char *path, const void *data, size_t bytes);

// Opens or fails the test.
cau_store *open_store(const cau_store_config *config);

// Submits, waits for the answer, and returns it. The reason goes to `reason` (may be NULL).
cau_status write_batch(cau_store *store, cau_store_batch *batch, char reason[320]);

// A batch that makes session `id`.
cau_store_batch *session_batch(const char *id);

// A batch with one command of no client, whose payload is its tick.
cau_store_batch *command_batch(const char *session, int64_t branch, uint64_t tick);
void put_tick_command(cau_store_batch *batch, const char *session, int64_t branch, uint64_t tick);

// Reads the log that a branch sees into ticks[]; returns how many there are. Checks each payload.
int read_ticks(cau_store *store, const char *session, int64_t branch, uint64_t from,
               uint64_t before, uint64_t *ticks, int capacity);
