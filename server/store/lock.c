// SPDX-License-Identifier: GPL-3.0-or-later
#include "lock.h"

#include <errno.h>
#include <fcntl.h>
#include <stdbool.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

// The holder removes the file when it lets go, so a lock may have been taken on a file that is
// gone.
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
	return cau_fail(error, CAU_BAD_STATE, NULL, "in use by process %s (lock file %s)",
	                holder[0] ? holder : "unknown", path);
}

static void write_holder(int descriptor)
{
	// Only an explanation for others: that it could not be written is no reason to stop.
	char holder[32];
	int length = snprintf(holder, sizeof holder, "%ld\n", (long)getpid());
	if (ftruncate(descriptor, 0) == 0 && pwrite(descriptor, holder, (size_t)length, 0) < 0)
		return;
}

cau_status cau_store_lock_take(struct cau_store_lock *lock, const char *path, cau_error *error)
{
	lock->descriptor = -1;
	int length = snprintf(lock->path, sizeof lock->path, "%s-lock", path);
	if ((size_t)length >= sizeof lock->path)
		return cau_fail(error, CAU_BAD_VALUE, NULL, "the path is too long");
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

void cau_store_lock_release(struct cau_store_lock *lock)
{
	if (lock->descriptor < 0)
		return;
	unlink(lock->path);
	close(lock->descriptor);
	lock->descriptor = -1;
}
