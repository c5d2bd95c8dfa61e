// SPDX-License-Identifier: GPL-3.0-or-later
#include "store/store.h"

#include <errno.h>
#include <fcntl.h>
#include <sqlite3.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "file.h"

enum { NAME_BYTES = 4096, WAIT_MS = 100, WAITS_MOST = 300 };

static cau_status fail_file(cau_error *error, const char *doing)
{
	return cau_fail(error, CAU_IO, NULL, "%s: %s", doing, strerror(errno));
}

// Copies all pages in one step and one read transaction. Writers are not held up: in WAL mode their
// pages go to the log. SQLITE_BUSY occurs only while the folder thread folds the log.
static cau_status copy_pages(sqlite3 *from, sqlite3 *to, cau_error *error)
{
	sqlite3_backup *backup = sqlite3_backup_init(to, "main", from, "main");
	if (!backup)
		return cau_store_fault(to, sqlite3_errcode(to), "beginning the copy", error);
	int code = SQLITE_BUSY;
	for (int i = 0; i < WAITS_MOST && (code == SQLITE_BUSY || code == SQLITE_LOCKED); i++) {
		if (i)
			sqlite3_sleep(WAIT_MS);
		code = sqlite3_backup_step(backup, -1);
	}
	sqlite3_backup_finish(backup);
	return code == SQLITE_DONE ? CAU_OK : cau_store_fault(to, code, "copying the store", error);
}

// Makes an empty file that only this user can read.
static cau_status make_file(const char *made, cau_error *error)
{
	int descriptor = open(made, O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
	if (descriptor < 0)
		return fail_file(error, "making the copy");
	close(descriptor);
	return CAU_OK;
}

// Deletes the copy's generation. A copy is never the newest store of its label, because later
// commits of the original are not in the copy.
static cau_status forget_generation(sqlite3 *to, cau_error *error)
{
	int code = sqlite3_exec(to, "DELETE FROM meta WHERE name = 'generation'", NULL, NULL, NULL);
	return code ? cau_store_fault(to, code, "the copy's generation", error) : CAU_OK;
}

static cau_status copy(const char *path, const char *made, cau_error *error)
{
	sqlite3 *from = NULL, *to = NULL;
	cau_status status = make_file(made, error);
	if (!status)
		status = cau_store_file_open_reader(path, &from, error);
	if (!status && sqlite3_open_v2(made, &to, SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE, NULL))
		status = cau_store_fault(to, sqlite3_errcode(to), "making the copy", error);
	if (!status)
		status = copy_pages(from, to, error);
	if (!status)
		status = forget_generation(to, error);
	sqlite3_close(to);
	sqlite3_close(from);
	return status;
}

static cau_status sync_file(const char *made, cau_error *error)
{
	int descriptor = open(made, O_RDONLY | O_CLOEXEC);
	bool synced = descriptor >= 0 && fsync(descriptor) == 0;
	cau_status status = synced ? CAU_OK : fail_file(error, "syncing the copy");
	if (descriptor >= 0)
		close(descriptor);
	return status;
}

// Links the finished copy to its name, so that the name never shows a partial copy. link() replaces
// no existing file.
static cau_status put_in_place(const char *made, const char *file, cau_error *error)
{
	if (link(made, file) == 0)
		return CAU_OK;
	return errno == EEXIST
	           ? cau_fail(error, CAU_ALREADY_EXISTS, NULL, "a file of this name exists already")
	           : fail_file(error, "renaming the copy");
}

cau_status cau_store_backup(const char *path, const char *file, cau_error *error)
{
	char made[NAME_BYTES];
	enum cau_store_found found = CAU_STORE_ABSENT;
	if ((size_t)snprintf(made, sizeof made, "%s.%d.new", file, (int)getpid()) >= sizeof made)
		return cau_fail(
			error, CAU_BAD_VALUE, NULL,
			"the path of the copy, with the suffix of an unfinished copy, is longer than "
			"%d bytes",
			NAME_BYTES - 1);
	if (access(path, F_OK) != 0)
		return cau_fail(error, CAU_NOT_FOUND, NULL, "there is no store %.200s", path);
	if (access(file, F_OK) == 0)
		return cau_fail(error, CAU_ALREADY_EXISTS, NULL, "a file of this name exists already");
	cau_status status = copy(path, made, error);
	if (!status)
		status = cau_store_probe(made, NULL, &found, error);
	if (!status)
		status = sync_file(made, error);
	if (!status)
		status = put_in_place(made, file, error);
	unlink(made);
	return status;
}
