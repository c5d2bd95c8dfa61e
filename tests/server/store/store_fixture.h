// SPDX-License-Identifier: GPL-3.0-or-later
// A folder of its own for each test, and the calls that all store tests make.
#pragma once

// cmocka needs these headers before its own.
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

// Removes a folder and everything in it.
void remove_tree(const char *folder);

// Reads a file's bytes. The caller frees them with free().
unsigned char *read_file(const char *path, size_t *bytes);
void write_file(const char *path, const void *data, size_t bytes);

// Opens the store. Fails the test if it cannot.
cau_store *open_store(const cau_store_config *config);

// Submits a batch, waits for its answer, and returns the status. Copies the reason to `reason` (may
// be NULL).
cau_status write_batch(cau_store *store, cau_store_batch *batch, char reason[320]);

// Returns a batch that creates session `id`.
cau_store_batch *session_batch(const char *id);

// Returns a batch with one command without a client, whose payload is its tick.
cau_store_batch *command_batch(const char *session, int64_t branch, uint64_t tick);
void put_tick_command(cau_store_batch *batch, const char *session, int64_t branch, uint64_t tick);

// Reads the log that a branch sees into ticks[]. Checks each payload. Returns the number of
// commands.
int read_ticks(cau_store *store, const char *session, int64_t branch, uint64_t from,
               uint64_t before, uint64_t *ticks, int capacity);
