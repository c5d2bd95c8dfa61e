// SPDX-License-Identifier: GPL-3.0-or-later
#include "cautery/assert.h"
#include "file.h"

#include <stdint.h>
#include <string.h>

static cau_status status_of(int code)
{
	switch (code & 0xff) {
	case SQLITE_CORRUPT:
	case SQLITE_NOTADB:
	case SQLITE_ERROR: // an expected table or column is missing
	case SQLITE_SCHEMA:
		return CAU_CORRUPT;
	case SQLITE_NOMEM:
		return CAU_NO_MEMORY;
	case SQLITE_CONSTRAINT:
		return CAU_ALREADY_EXISTS;
	case SQLITE_TOOBIG:
		return CAU_LIMIT;
	default: // FULL, IOERR, CANTOPEN, READONLY, PERM, BUSY, LOCKED
		return CAU_IO;
	}
}

cau_status cau_store_fault(sqlite3 *database, int code, const char *what, cau_error *error)
{
	// `database` may be NULL if opening it failed.
	const char *message = database ? sqlite3_errmsg(database) : sqlite3_errstr(code);
	cau_status status = status_of(code);
	CAU_ASSERT(status != CAU_OK && what, "code %d is no failure", code);
	int system = database && status == CAU_IO ? sqlite3_system_errno(database) : 0;
	if (system)
		return cau_fail(error, status, NULL, "%s: %s (%s)", what, message, strerrordesc_np(system));
	return cau_fail(error, status, NULL, "%s: %s", what, message);
}

cau_status cau_store_execute(sqlite3 *database, const char *sql, const char *what, cau_error *error)
{
	CAU_ASSERT(database && sql, "nothing to do for %s", what);
	int code = sqlite3_exec(database, sql, NULL, NULL, NULL);
	return code ? cau_store_fault(database, code, what, error) : CAU_OK;
}

cau_status cau_store_integer(sqlite3 *database, const char *sql, int64_t *value, cau_error *error)
{
	sqlite3_stmt *statement = NULL;
	cau_status status = CAU_OK;
	int code = sqlite3_prepare_v2(database, sql, -1, &statement, NULL);
	if (!code)
		code = sqlite3_step(statement);
	if (code == SQLITE_ROW)
		*value = sqlite3_column_int64(statement, 0);
	else if (code == SQLITE_DONE)
		status = cau_fail(error, CAU_NOT_FOUND, NULL, "%s: no result", sql);
	else
		status = cau_store_fault(database, code, sql, error);
	sqlite3_finalize(statement);
	return status;
}
