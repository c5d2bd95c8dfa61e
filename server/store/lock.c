// SPDX-License-Identifier: GPL-3.0-or-later
#include "file.h"

#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <stdbool.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

// True if the locked file is still the one at `path`. A holder removes the file when it releases
// the lock, so the lock may be on a removed file.
static bool is_at_path(int descriptor, const char *path)
{
	struct stat held, named;
	return fstat(descriptor, &held) == 0 && stat(path, &named) == 0 &&
	       held.st_dev == named.st_dev && held.st_ino == named.st_ino;
}

static cau_status held_by_another(int descriptor, const char *path, cau_error *error)
{
	char holder[32] = "";
	ssize_t count = pread(descriptor, holder, sizeof holder - 1, 0);
	holder[count > 0 ? count : 0] = 0;
	holder[strspn(holder, "0123456789")] = 0;
	return cau_fail(error, CAU_BAD_STATE, NULL, "the store is in use by process %s (lock file %s)",
	                holder[0] ? holder : "unknown", path);
}

static void write_holder(int descriptor)
{
	// The process id only helps other processes to report the holder, so a write failure is
	// ignored.
	char holder[32];
	int length = snprintf(holder, sizeof holder, "%ld\n", (long)getpid());
	if (ftruncate(descriptor, 0) == 0 && pwrite(descriptor, holder, (size_t)length, 0) < 0)
		return;
}

cau_status cau_store_lock_take(struct cau_store_lock *lock, const char *path, cau_error *error)
{
	lock->descriptor = lock->database = -1;
	int length = snprintf(lock->path, sizeof lock->path, "%s-lock", path);
	if ((size_t)length >= sizeof lock->path)
		return cau_fail(error, CAU_BAD_VALUE, NULL, "the path is longer than %zu bytes",
		                sizeof lock->path - sizeof "-lock");
	for (;;) {
		int descriptor = open(lock->path, O_RDWR | O_CREAT | O_CLOEXEC, 0600);
		if (descriptor < 0)
			return cau_fail(error, CAU_IO, NULL, "cannot open %s: %s", lock->path,
			                strerrordesc_np(errno));
		if (flock(descriptor, LOCK_EX | LOCK_NB)) {
			cau_status status = errno == EWOULDBLOCK
			                        ? held_by_another(descriptor, lock->path, error)
			                        : cau_fail(error, CAU_IO, NULL, "cannot lock %s: %s",
			                                   lock->path, strerrordesc_np(errno));
			close(descriptor);
			return status;
		}
		if (is_at_path(descriptor, lock->path)) {
			write_holder(descriptor);
			lock->descriptor = descriptor;
			return CAU_OK;
		}
		close(descriptor);
	}
}

// ---- the database itself --------------------------------------------------------------
// Offset of the locked byte: far above the bytes that SQLite locks (at 1 GB) and above any
// database's size.
static const off_t lock_at = (off_t)1 << 62;

// The databases that this process holds. This process must never open one of them again, not even
// to try: closing that descriptor would drop SQLite's locks on the database.
static pthread_mutex_t held_mutex = PTHREAD_MUTEX_INITIALIZER;
static struct cau_store_lock *held;

// True if this process holds that file. The caller holds the mutex.
static bool is_held_here(const struct stat *file)
{
	for (const struct cau_store_lock *lock = held; lock; lock = lock->next)
		if (lock->device == file->st_dev && lock->inode == file->st_ino)
			return true;
	return false;
}

// Takes a lock of the open file description, not of the process as SQLite's locks are. So two
// openings exclude each other, and the kernel drops the lock when the holder ends, however it ends.
static cau_status lock_file(int descriptor, cau_error *error)
{
	struct flock whole = {.l_type = F_WRLCK, .l_whence = SEEK_SET, .l_start = lock_at, .l_len = 1};
	if (fcntl(descriptor, F_OFD_SETLK, &whole) == 0)
		return CAU_OK;
	if (errno == EAGAIN || errno == EACCES)
		return cau_fail(
			error, CAU_BAD_STATE, NULL,
			"the store is in use by another process under another name (a hard link, or a mount)");
	return cau_fail(error, CAU_IO, NULL, "cannot lock the store: %s", strerrordesc_np(errno));
}

// Locks the database at `path` if it exists. The caller holds the mutex.
static cau_status hold(struct cau_store_lock *lock, const char *path, cau_error *error)
{
	struct stat file;
	if (stat(path, &file) || !S_ISREG(file.st_mode))
		return CAU_OK; // there is no database yet, or the probe will refuse the file
	if (is_held_here(&file))
		return cau_fail(error, CAU_BAD_STATE, NULL,
		                "this process has the store open under another name");
	int descriptor = open(path, O_RDWR | O_CLOEXEC);
	if (descriptor < 0)
		// this process may not write the file, and the later open for writing reports why
		return CAU_OK;
	cau_status status = lock_file(descriptor, error);
	if (status) {
		close(descriptor);
		return status;
	}
	lock->database = descriptor;
	lock->device = file.st_dev;
	lock->inode = file.st_ino;
	lock->next = held;
	held = lock;
	return CAU_OK;
}

cau_status cau_store_lock_database(struct cau_store_lock *lock, const char *path, cau_error *error)
{
	cau_status status = CAU_OK;
	pthread_mutex_lock(&held_mutex);
	if (lock->database < 0)
		status = hold(lock, path, error);
	pthread_mutex_unlock(&held_mutex);
	return status;
}

static void let_go_of_database(struct cau_store_lock *lock)
{
	if (lock->database < 0)
		return;
	pthread_mutex_lock(&held_mutex);
	struct cau_store_lock **place = &held;
	while (*place != lock)
		place = &(*place)->next;
	*place = lock->next;
	pthread_mutex_unlock(&held_mutex);
	close(lock->database);
	lock->database = -1;
}

void cau_store_lock_release(struct cau_store_lock *lock)
{
	let_go_of_database(lock);
	if (lock->descriptor < 0)
		return;
	unlink(lock->path);
	close(lock->descriptor);
	lock->descriptor = -1;
}
