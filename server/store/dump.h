// SPDX-License-Identifier: GPL-3.0-or-later
// Reads all that the store has of a session, for another store: first what is there while the
// session goes on, then, once it stands still and all of it is on the disk, what has come about
// since. A connection of its own, so that nobody else's reading waits; each of the two is one
// reading transaction.
#pragma once

#include "store/rows.h"
#include "store/store.h"

typedef struct cau_store_dump cau_store_dump;

// CAU_NOT_FOUND, CAU_IO, CAU_NO_MEMORY. One thread at a time may have it.
cau_status cau_store_dump_open(cau_store *store, const char *session, cau_store_dump **dump,
                               cau_error *error);
// Adds rows to the writer until it holds `bytes` or more. *over: all that was there has been
// written.
cau_status cau_store_dump_write(cau_store_dump *dump, cau_rows_writer *writer, size_t bytes,
                                bool *over, cau_error *error);
// Goes on with what has come about since; after one that was over.
cau_status cau_store_dump_rest(cau_store_dump *dump, cau_error *error);
void cau_store_dump_close(cau_store_dump *dump); // takes NULL
