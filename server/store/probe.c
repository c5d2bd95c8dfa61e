// SPDX-License-Identifier: GPL-3.0-or-later
#include "file.h"

#include <errno.h>
#include <fcntl.h>
#include <stdbool.h>
#include <stdint.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "batch.h"

enum {
	HEADER_BYTES = 100,
	// offsets of two big-endian 32-bit words in the file's header,
	// https://www.sqlite.org/fileformat.html
	USER_VERSION_AT = 60,
	APPLICATION_ID_AT = 68,
};

// Returns the bytes of the file `path` with `suffix`; -1 if there is none.
static int64_t beside_bytes(const char *path, const char *suffix)
{
	char name[4096];
	struct stat found;
	snprintf(name, sizeof name, "%s%s", path, suffix);
	return stat(name, &found) == 0 ? (int64_t)found.st_size : -1;
}

static uint32_t word_at(const unsigned char *header, int at)
{
	return (uint32_t)header[at] << 24 | (uint32_t)header[at + 1] << 16 |
	       (uint32_t)header[at + 2] << 8 | (uint32_t)header[at + 3];
}

static cau_status check_version(int64_t version, cau_error *error)
{
	if (version > CAU_STORE_SCHEMA_VERSION)
		return cau_fail(error, CAU_UNSUPPORTED, NULL,
		                "written by a newer Cautery: schema %lld, this build reads %d: run the "
		                "newer Cautery, or restore a copy from before the upgrade",
		                (long long)version, CAU_STORE_SCHEMA_VERSION);
	if (version < 0)
		return cau_fail(error, CAU_CORRUPT, NULL, "the schema number %lld is not possible",
		                (long long)version);
	return CAU_OK;
}

static cau_status check_header(const char *path, cau_error *error)
{
	unsigned char header[HEADER_BYTES];
	struct stat info;
	if (stat(path, &info) == 0 && !S_ISREG(info.st_mode)) // opening a FIFO would wait for a writer
		return cau_fail(error, CAU_IO, NULL, "the store is not a regular file");
	int descriptor = open(path, O_RDONLY | O_NONBLOCK | O_CLOEXEC);
	if (descriptor < 0)
		return cau_fail(error, CAU_IO, NULL, "cannot read the store: %s", strerrordesc_np(errno));
	ssize_t count = pread(descriptor, header, sizeof header, 0);
	int reason = errno;
	close(descriptor);
	if (count < 0)
		return cau_fail(error, CAU_IO, NULL, "cannot read the store: %s", strerrordesc_np(reason));
	if (count == 0)
		return cau_fail(error, CAU_CORRUPT, NULL,
		                "the file is empty (remove it to start a new store)");
	if (count < HEADER_BYTES || memcmp(header, "SQLite format 3", 16) != 0)
		return cau_fail(error, CAU_CORRUPT, NULL, "not a database");
	if (word_at(header, APPLICATION_ID_AT) != CAU_STORE_APPLICATION_ID)
		return cau_fail(error, CAU_UNSUPPORTED, NULL,
		                "the file is a database of another program (application id %#x)",
		                word_at(header, APPLICATION_ID_AT));
	return check_version((int32_t)word_at(header, USER_VERSION_AT), error);
}

// Checks every page of the file.
static cau_status check_pages(sqlite3 *database, cau_error *error)
{
	sqlite3_stmt *statement = NULL;
	cau_status status = CAU_OK;
	int code = sqlite3_prepare_v2(database, "PRAGMA quick_check(1)", -1, &statement, NULL);
	if (!code)
		code = sqlite3_step(statement);
	const char *finding =
		code == SQLITE_ROW ? (const char *)sqlite3_column_text(statement, 0) : NULL;
	if (code != SQLITE_ROW)
		status = cau_store_fault(database, code, "checking the store", error);
	else if (!finding || strcmp(finding, "ok") != 0)
		status = cau_fail(error, CAU_CORRUPT, NULL, "damaged: %s", finding ? finding : "unknown");
	sqlite3_finalize(statement);
	return status;
}

static cau_status check_label(sqlite3 *database, const char *label, cau_error *error)
{
	sqlite3_stmt *statement = NULL;
	cau_status status = CAU_OK;
	int code = sqlite3_prepare_v2(database, "SELECT value FROM meta WHERE name = 'label'", -1,
	                              &statement, NULL);
	if (!code)
		code = sqlite3_step(statement);
	if (code == SQLITE_ROW) {
		const char *stored = (const char *)sqlite3_column_text(statement, 0);
		if (stored && strcmp(stored, label) != 0)
			status =
				cau_fail(error, CAU_BAD_STATE, NULL,
			             "the store belongs to the daemon labelled '%s', not '%s'", stored, label);
	} else if (code != SQLITE_DONE) {
		status = cau_store_fault(database, code, "reading the label", error);
	}
	sqlite3_finalize(statement);
	return status;
}

static bool is_same_file(const char *path, const char *suffix, const char *other)
{
	char name[4096], other_name[4096];
	struct stat file, other_file;
	snprintf(name, sizeof name, "%s%s", path, suffix);
	snprintf(other_name, sizeof other_name, "%s%s", other, suffix);
	return stat(name, &file) == 0 && stat(other_name, &other_file) == 0 &&
	       file.st_dev == other_file.st_dev && file.st_ino == other_file.st_ino;
}

// Checks that the file is opened by the name stored in it. After a crash, the last commits are in a
// write-ahead log beside that name. Under another name (a hard link) they would be missing. That
// log would then damage the file when it is next opened by its first name.
static cau_status check_path(sqlite3 *database, const char *path, cau_error *error)
{
	sqlite3_stmt *statement = NULL;
	cau_status status = CAU_OK;
	int code = sqlite3_prepare_v2(database, "SELECT value FROM meta WHERE name = 'path'", -1,
	                              &statement, NULL);
	if (!code)
		code = sqlite3_step(statement);
	const char *noted = code == SQLITE_ROW ? (const char *)sqlite3_column_text(statement, 0) : NULL;
	if (code != SQLITE_ROW && code != SQLITE_DONE)
		status = cau_store_fault(database, code, "reading the path of the store", error);
	else if (noted && is_same_file(path, "", noted) && beside_bytes(noted, "-wal") > 0 &&
	         !is_same_file(path, "-wal", noted))
		status = cau_fail(
			error, CAU_BAD_STATE, NULL,
			"the store's write-ahead log is beside another name of this file: open the store as %s",
			noted);
	sqlite3_finalize(statement);
	return status;
}

static cau_status check_content(sqlite3 *database, const char *path, const char *label,
                                cau_error *error)
{
	int64_t version;
	cau_status status = cau_store_integer(database, "PRAGMA user_version", &version, error);
	if (!status)
		status = check_version(version, error);
	if (!status)
		status = check_pages(database, error);
	if (!status && version > 0 && label)
		status = check_label(database, label, error);
	if (!status && version > 0)
		status = check_path(database, path, error);
	if (!status && version == CAU_STORE_SCHEMA_VERSION) {
		struct cau_store_writer writer;
		status = cau_store_writer_init(&writer, database, error);
		if (!status)
			cau_store_writer_finish(&writer);
	}
	return status;
}

// Opens the database for reading and checks it. Without a write-ahead log, the file alone is
// complete and is opened as immutable. With a log (after a crash), the file may be mid-fold and is
// valid only together with the log. Then SQLite builds its index of the log in "-shm", which is
// removed again if it did not exist before.
static cau_status check_database(const char *path, const char *label, cau_error *error)
{
	char name[3 * 4096 + 64], *at = name;
	bool with_log = beside_bytes(path, "-wal") > 0;
	bool had_index = beside_bytes(path, "-shm") >= 0;
	at += sprintf(at, "file:");
	for (const char *from = path; *from; from++)
		at += sprintf(at, strchr("%?#", *from) ? "%%%02x" : "%c", (unsigned char)*from);
	sprintf(at, with_log ? "?mode=ro" : "?mode=ro&immutable=1");

	sqlite3 *database = NULL;
	int code = sqlite3_open_v2(name, &database,
	                           SQLITE_OPEN_READONLY | SQLITE_OPEN_URI | SQLITE_OPEN_NOMUTEX, NULL);
	cau_status status = code ? cau_store_fault(database, code, "opening it", error)
	                         : check_content(database, path, label, error);
	sqlite3_close(database);
	if (with_log && !had_index) {
		snprintf(name, sizeof name, "%s-shm", path);
		unlink(name);
	}
	return status;
}

cau_status cau_store_probe(const char *path, const char *label, enum cau_store_found *found,
                           cau_error *error)
{
	struct stat file;
	if (strlen(path) > 4000)
		return cau_fail(error, CAU_BAD_VALUE, NULL, "the path is longer than 4000 bytes");
	if (stat(path, &file)) {
		if (errno != ENOENT)
			return cau_fail(error, CAU_IO, NULL, "cannot examine the file: %s",
			                strerrordesc_np(errno));
		if (beside_bytes(path, "-wal") > 0)
			return cau_fail(error, CAU_CORRUPT, NULL,
			                "the database is missing, but its write-ahead log %s-wal is there",
			                path);
		*found = CAU_STORE_ABSENT;
		return CAU_OK;
	}
	if (!S_ISREG(file.st_mode))
		return cau_fail(error, CAU_UNSUPPORTED, NULL, "the store is not a regular file");
	cau_status status = check_header(path, error);
	if (!status && beside_bytes(path, "-journal") > 0)
		status = cau_fail(error, CAU_CORRUPT, NULL,
		                  "an unfinished rollback journal %s-journal is beside it", path);
	if (!status)
		status = check_database(path, label, error);
	if (!status)
		*found = CAU_STORE_OURS;
	return status;
}
