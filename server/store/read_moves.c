// SPDX-License-Identifier: GPL-3.0-or-later
// Reads which sessions have moved away, have arrived, or are arriving.
#include <stdio.h>

#include "fault.h"
#include "read.h"

cau_status cau_store_read_moved(cau_store *store, cau_store_visit_moved visit, void *user,
                                cau_error *error)
{
	struct cau_store_reader *reader = &store->reading;
	sqlite3_stmt *statement = NULL;
	cau_status visited = CAU_OK;
	pthread_mutex_lock(&reader->mutex);
	cau_status status = cau_store_prepare(
		reader, "SELECT id, move, target, label, url, proof, time_ms FROM moved ORDER BY id",
		&statement, error);
	while (!status && !visited && !(status = cau_store_next_row(reader, statement, error))) {
		cau_store_moved moved = {.id = cau_store_column_text(statement, 0),
		                         .move = cau_store_column_text(statement, 1),
		                         .target = cau_store_column_text(statement, 2),
		                         .label = cau_store_column_text(statement, 3),
		                         .url = cau_store_column_text(statement, 4),
		                         .proof = cau_store_column_text(statement, 5),
		                         .time_ms = sqlite3_column_int64(statement, 6)};
		visited = visit(user, &moved);
	}
	sqlite3_finalize(statement);
	pthread_mutex_unlock(&reader->mutex);
	return visited ? visited : cau_store_end_is_fine(status);
}

cau_status cau_store_read_arrivals(cau_store *store, cau_store_visit_arrival visit, void *user,
                                   cau_error *error)
{
	struct cau_store_reader *reader = &store->reading;
	sqlite3_stmt *statement = NULL;
	cau_status visited = CAU_OK;
	pthread_mutex_lock(&reader->mutex);
	cau_status status = cau_store_prepare(
		reader,
		"SELECT id, move, lock, source, label, pieces, state, time_ms, unlock, seal FROM arrivals"
		" ORDER BY id",
		&statement, error);
	while (!status && !visited && !(status = cau_store_next_row(reader, statement, error))) {
		cau_store_arrival arrival = {.id = cau_store_column_text(statement, 0),
		                             .move = cau_store_column_text(statement, 1),
		                             .lock = cau_store_column_text(statement, 2),
		                             .source = cau_store_column_text(statement, 3),
		                             .label = cau_store_column_text(statement, 4),
		                             .pieces = sqlite3_column_int64(statement, 5),
		                             .state =
		                                 (cau_store_arrival_state)sqlite3_column_int(statement, 6),
		                             .time_ms = sqlite3_column_int64(statement, 7),
		                             .unlock = cau_store_column_text(statement, 8),
		                             .seal = cau_store_column_text(statement, 9)};
		visited = visit(user, &arrival);
	}
	sqlite3_finalize(statement);
	pthread_mutex_unlock(&reader->mutex);
	return visited ? visited : cau_store_end_is_fine(status);
}

cau_status cau_store_move_secret(cau_store *store, char secret[65], cau_error *error)
{
	struct cau_store_reader *reader = &store->reading;
	sqlite3_stmt *statement = NULL;
	pthread_mutex_lock(&reader->mutex);
	cau_status status = cau_store_prepare(reader, "SELECT value FROM secrets WHERE name = 'move'",
	                                      &statement, error);
	if (!status)
		status = cau_store_next_row(reader, statement, error);
	if (!status)
		snprintf(secret, 65, "%s", cau_store_column_text(statement, 0));
	sqlite3_finalize(statement);
	pthread_mutex_unlock(&reader->mutex);
	return status;
}
