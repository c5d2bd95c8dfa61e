// SPDX-License-Identifier: GPL-3.0-or-later
#include "file.h"

#include <errno.h>
#include <fcntl.h>
#include <stdint.h>
#include <string.h>
#include <unistd.h>

// longest wait, ms, for the write lock, which an operator's sqlite3 may hold
enum { BUSY_MS = 2000 };

static cau_status open_connection(const char *path, int flags, sqlite3 **database, cau_error *error)
{
	int code = sqlite3_open_v2(path, database, flags, NULL);
	if (code) {
		cau_status status = cau_store_fault(*database, code, "opening the store", error);
		sqlite3_close(*database);
		*database = NULL;
		return status;
	}
	sqlite3_extended_result_codes(*database, 1);
	sqlite3_busy_timeout(*database, BUSY_MS);
	return CAU_OK;
}

static cau_status set_wal(sqlite3 *database, cau_error *error)
{
	sqlite3_stmt *statement = NULL;
	cau_status status = CAU_OK;
	int code = sqlite3_prepare_v2(database, "PRAGMA journal_mode = WAL", -1, &statement, NULL);
	if (!code)
		code = sqlite3_step(statement);
	if (code != SQLITE_ROW)
		status = cau_store_fault(database, code, "setting the journal mode", error);
	else if (strcmp((const char *)sqlite3_column_text(statement, 0), "wal") != 0)
		status = cau_fail(error, CAU_IO, NULL, "the file system allows no write-ahead log");
	sqlite3_finalize(statement);
	return status;
}

static cau_status sync_folder(const char *path, cau_error *error)
{
	char folder[4096];
	snprintf(folder, sizeof folder, "%s", path);
	char *slash = strrchr(folder, '/');
	if (slash)
		slash[slash == folder] = 0;
	else
		strcpy(folder, ".");
	int descriptor = open(folder, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
	int code = descriptor < 0 ? -1 : fsync(descriptor);
	int reason = errno;
	if (descriptor >= 0)
		close(descriptor);
	if (code)
		return cau_fail(error, CAU_IO, NULL, "cannot sync the store's folder: %s",
		                strerrordesc_np(reason));
	return CAU_OK;
}

// Builds a complete store at `draft`, which is an empty file.
static cau_status build(const char *draft, cau_error *error)
{
	sqlite3 *database;
	cau_status status =
		open_connection(draft, SQLITE_OPEN_READWRITE | SQLITE_OPEN_NOMUTEX, &database, error);
	if (status)
		return status;
	status = cau_store_migrate(database, error);
	if (!status)
		// the file's header notes WAL; the close folds the log into the file
		status = set_wal(database, error);
	sqlite3_close(database);
	return status;
}

cau_status cau_store_file_create(const char *path, cau_error *error)
{
	char draft[4200];
	snprintf(draft, sizeof draft, "%s-new-%ld", path, (long)getpid());
	int descriptor = open(draft, O_RDWR | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
	if (descriptor < 0)
		return cau_fail(error, CAU_IO, NULL, "cannot create the store: %s", strerrordesc_np(errno));
	close(descriptor);
	cau_status status = build(draft, error);
	if (!status && link(draft, path))
		status =
			cau_fail(error, CAU_IO, NULL, "cannot create the store: %s", strerrordesc_np(errno));
	unlink(draft);
	return status ? status : sync_folder(path, error);
}

cau_status cau_store_file_open(const char *path, size_t wal_bytes, sqlite3 **database,
                               cau_error *error)
{
	char sql[320];
	cau_status status =
		open_connection(path, SQLITE_OPEN_READWRITE | SQLITE_OPEN_NOMUTEX, database, error);
	if (status)
		return status;
	status = set_wal(*database, error);
	// secure_delete is off: Debian's SQLite overwrites deleted content by default, which would
	// double the cost of retention.
	snprintf(sql, sizeof sql,
	         "PRAGMA synchronous = FULL; PRAGMA wal_autocheckpoint = 0; PRAGMA secure_delete = OFF;"
	         "PRAGMA temp_store = MEMORY; PRAGMA cache_size = -16000; PRAGMA trusted_schema = OFF;"
	         "PRAGMA journal_size_limit = %lld",
	         (long long)wal_bytes);
	if (!status)
		status = cau_store_execute(*database, sql, "setting up the connection", error);
	if (status) {
		sqlite3_close(*database);
		*database = NULL;
	}
	return status;
}

cau_status cau_store_memory_open(const char *name, int64_t bytes_most, sqlite3 **database,
                                 cau_error *error)
{
	sqlite3_int64 limit = bytes_most;
	cau_status status = open_connection(
		name, SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE | SQLITE_OPEN_URI | SQLITE_OPEN_NOMUTEX,
		database, error);
	if (status)
		return status;
	if (limit)
		sqlite3_file_control(*database, "main", SQLITE_FCNTL_SIZE_LIMIT, &limit);
	status = cau_store_execute(*database,
	                           "PRAGMA journal_mode = MEMORY; PRAGMA synchronous = OFF;"
	                           "PRAGMA secure_delete = OFF; PRAGMA temp_store = MEMORY;"
	                           "PRAGMA trusted_schema = OFF",
	                           "setting up the connection", error);
	if (status) {
		sqlite3_close(*database);
		*database = NULL;
	}
	return status;
}

cau_status cau_store_file_open_reader(const char *path, sqlite3 **database, cau_error *error)
{
	return open_connection(path, SQLITE_OPEN_READONLY | SQLITE_OPEN_NOMUTEX, database, error);
}
