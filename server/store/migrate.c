// SPDX-License-Identifier: GPL-3.0-or-later
#include "migrate.h"

#include <stdint.h>

#include "fault.h"
#include "schema.h"
#include "write.h"

static cau_status run_steps(sqlite3 *database, int64_t version, cau_error *error)
{
	char sql[96];
	for (int64_t step = version; step < CAU_STORE_SCHEMA_VERSION; step++) {
		cau_status status = cau_store_execute(database, cau_store_schema_steps[step],
		                                      "migrating the schema", error);
		if (status)
			return status;
	}
	snprintf(sql, sizeof sql, "PRAGMA application_id = %d; PRAGMA user_version = %d",
	         CAU_STORE_APPLICATION_ID, CAU_STORE_SCHEMA_VERSION);
	cau_status status = cau_store_execute(database, sql, "stating the schema version", error);
	if (status)
		return status;
	// Compile the statements before the commit, so that an unexpected file stays unchanged.
	struct cau_store_writer writer;
	status = cau_store_writer_init(&writer, database, error);
	if (!status)
		cau_store_writer_finish(&writer);
	return status;
}

cau_status cau_store_migrate(sqlite3 *database, cau_error *error)
{
	int64_t version;
	cau_status status = cau_store_integer(database, "PRAGMA user_version", &version, error);
	if (status || version == CAU_STORE_SCHEMA_VERSION)
		return status;
	status = cau_store_execute(database, "BEGIN IMMEDIATE", "migrating the schema", error);
	if (status)
		return status;
	status = run_steps(database, version, error);
	if (!status)
		status = cau_store_execute(database, "COMMIT", "migrating the schema", error);
	if (status && !sqlite3_get_autocommit(database))
		sqlite3_exec(database, "ROLLBACK", NULL, NULL, NULL);
	return status;
}
