// SPDX-License-Identifier: GPL-3.0-or-later
// Reads all records of a session for another store, in two readings. The first reads what exists
// while the session runs. The second reads the new records, when the session is suspended and
// everything is on the disk. The dump has a connection of its own, so that other reads do not wait.
// Each of the two readings is one read transaction.
#pragma once

#include "store/rows.h"
#include "store/store.h"

typedef struct cau_store_dump cau_store_dump;

// Opens a dump of `session`. Errors: CAU_NOT_FOUND, CAU_IO, CAU_NO_MEMORY. Only one thread at a
// time may use a dump.
cau_status cau_store_dump_open(cau_store *store, const char *session, cau_store_dump **dump,
                               cau_error *error);
// Adds records to the writer until it holds `bytes` or more. *over: this reading is complete.
cau_status cau_store_dump_write(cau_store_dump *dump, cau_rows_writer *writer, size_t bytes,
                                bool *over, cau_error *error);
// Begins the second reading, of the new records. Call it after the end of the first reading.
cau_status cau_store_dump_rest(cau_store_dump *dump, cau_error *error);
void cau_store_dump_close(cau_store_dump *dump); // closes the dump; `dump` may be NULL
