// SPDX-License-Identifier: GPL-3.0-or-later
// Replaces the C library's file calls for paths of the simulated disk. Other paths use the real
// calls: scenes are read from the real disk. threads.c explains how the replacement works.
#include <errno.h>
#include <fcntl.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include "simulation/disk.h"
#include "simulation/scheduler.h"

#define WRAPPED __attribute__((used))

enum { DESCRIPTORS_MOST = 256, FIRST_DESCRIPTOR = 1 << 20 };

typedef struct descriptor {
	disk_inode *inode; // NULL for a folder
	int machine;
	bool used;
} descriptor;

static descriptor descriptors[DESCRIPTORS_MOST];
// number of starts of each machine; the files get another device number with each start
static int boots[DISK_MACHINES];

void sim_calls_kill(int machine)
{
	for (int i = 0; i < DESCRIPTORS_MOST; i++)
		if (descriptors[i].machine == machine)
			descriptors[i] = (descriptor){0};
	boots[machine]++;
}

static descriptor *find(int number)
{
	int i = number - FIRST_DESCRIPTOR;
	return i >= 0 && i < DESCRIPTORS_MOST && descriptors[i].used ? &descriptors[i] : NULL;
}

static int fail(int reason)
{
	errno = reason;
	return -1;
}

int __real_open(const char *path, int flags, ...);
int __wrap_open(const char *path, int flags, ...);
WRAPPED int __wrap_open(const char *path, int flags, ...)
{
	va_list arguments;
	va_start(arguments, flags);
	unsigned mode = flags & O_CREAT ? va_arg(arguments, unsigned) : 0;
	va_end(arguments);
	int machine = disk_machine_of(path);
	if (machine < 0)
		return __real_open(path, flags, mode);
	disk_inode *inode = flags & O_DIRECTORY ? NULL : disk_find(path, flags & O_CREAT);
	if (!inode && !(flags & O_DIRECTORY))
		return fail(ENOENT);
	if (inode && flags & O_TRUNC)
		disk_truncate(inode, 0);
	for (int i = 0; i < DESCRIPTORS_MOST; i++)
		if (!descriptors[i].used) {
			descriptors[i] = (descriptor){inode, machine, true};
			return FIRST_DESCRIPTOR + i;
		}
	return fail(EMFILE);
}

int __real_close(int number);
int __wrap_close(int number);
WRAPPED int __wrap_close(int number)
{
	descriptor *d = find(number);
	if (!d)
		return __real_close(number);
	if (d->inode && d->inode->file_lock == d)
		d->inode->file_lock = NULL;
	if (d->inode && d->inode->range_lock == d)
		d->inode->range_lock = NULL;
	*d = (descriptor){0};
	return 0;
}

static void describe(const disk_inode *inode, struct stat *out)
{
	*out = (struct stat){.st_dev = (dev_t)(1000 + 2 * boots[inode->machine] + inode->machine),
	                     .st_ino = (ino_t)inode->number,
	                     .st_mode = S_IFREG | 0600,
	                     .st_size = (off_t)inode->size};
}

int __real_stat(const char *path, struct stat *out);
int __wrap_stat(const char *path, struct stat *out);
WRAPPED int __wrap_stat(const char *path, struct stat *out)
{
	if (disk_machine_of(path) < 0)
		return __real_stat(path, out);
	const disk_inode *inode = disk_find(path, false);
	if (!inode)
		return fail(ENOENT);
	describe(inode, out);
	return 0;
}

int __real_fstat(int number, struct stat *out);
int __wrap_fstat(int number, struct stat *out);
WRAPPED int __wrap_fstat(int number, struct stat *out)
{
	const descriptor *d = find(number);
	if (!d)
		return __real_fstat(number, out);
	describe(d->inode, out);
	return 0;
}

ssize_t __real_pread(int number, void *bytes, size_t count, off_t at);
ssize_t __wrap_pread(int number, void *bytes, size_t count, off_t at);
WRAPPED ssize_t __wrap_pread(int number, void *bytes, size_t count, off_t at)
{
	size_t got = 0;
	const descriptor *d = find(number);
	if (!d)
		return __real_pread(number, bytes, count, at);
	int error = disk_read(d->inode, bytes, count, (size_t)at, &got);
	return error ? fail(error) : (ssize_t)got;
}

ssize_t __real_pwrite(int number, const void *bytes, size_t count, off_t at);
ssize_t __wrap_pwrite(int number, const void *bytes, size_t count, off_t at);
WRAPPED ssize_t __wrap_pwrite(int number, const void *bytes, size_t count, off_t at)
{
	const descriptor *d = find(number);
	if (!d)
		return __real_pwrite(number, bytes, count, at);
	int error = disk_write(d->inode, bytes, count, (size_t)at);
	return error ? fail(error) : (ssize_t)count;
}

int __real_ftruncate(int number, off_t size);
int __wrap_ftruncate(int number, off_t size);
WRAPPED int __wrap_ftruncate(int number, off_t size)
{
	const descriptor *d = find(number);
	return d ? disk_truncate(d->inode, (size_t)size) : __real_ftruncate(number, size);
}

int __real_fsync(int number);
int __wrap_fsync(int number);
WRAPPED int __wrap_fsync(int number)
{
	const descriptor *d = find(number);
	if (!d)
		return __real_fsync(number);
	if (d->inode) {
		int error = disk_sync(d->inode);
		return error ? fail(error) : 0;
	}
	disk_sync_names(d->machine);
	return 0;
}

static int lock(const void **held, const void *by)
{
	if (*held && *held != by)
		return fail(EWOULDBLOCK);
	*held = by;
	return 0;
}

int __real_flock(int number, int what);
int __wrap_flock(int number, int what);
WRAPPED int __wrap_flock(int number, int what)
{
	const descriptor *d = find(number);
	return d ? lock(&d->inode->file_lock, d) : __real_flock(number, what);
}

int __real_fcntl(int number, int what, ...);
int __wrap_fcntl(int number, int what, ...);
WRAPPED int __wrap_fcntl(int number, int what, ...)
{
	va_list arguments;
	va_start(arguments, what);
	void *argument = va_arg(arguments, void *);
	va_end(arguments);
	const descriptor *d = find(number);
	return d ? lock(&d->inode->range_lock, d) : __real_fcntl(number, what, argument);
}

int __real_link(const char *from, const char *to);
int __wrap_link(const char *from, const char *to);
WRAPPED int __wrap_link(const char *from, const char *to)
{
	if (disk_machine_of(from) < 0)
		return __real_link(from, to);
	return disk_link(from, to) ? 0 : fail(EEXIST);
}

int __real_unlink(const char *path);
int __wrap_unlink(const char *path);
WRAPPED int __wrap_unlink(const char *path)
{
	if (disk_machine_of(path) < 0)
		return __real_unlink(path);
	return disk_unlink(path) ? 0 : fail(ENOENT);
}

char *__real_realpath(const char *path, char *out);
char *__wrap_realpath(const char *path, char *out);
WRAPPED char *__wrap_realpath(const char *path, char *out)
{
	if (disk_machine_of(path) < 0)
		return __real_realpath(path, out);
	if (strchr(path + 1, '/') && !disk_find(path, false)) {
		errno = ENOENT;
		return NULL;
	}
	return strcpy(out, path);
}

int __real_statvfs(const char *path, struct statvfs *out);
int __wrap_statvfs(const char *path, struct statvfs *out);
WRAPPED int __wrap_statvfs(const char *path, struct statvfs *out)
{
	enum { FREE_BYTES = 1 << 30 };
	int machine = disk_machine_of(path);
	if (machine < 0)
		return __real_statvfs(path, out);
	*out = (struct statvfs){.f_frsize = 1, .f_bavail = FREE_BYTES};
	if (disk_manner_of(machine)->full)
		out->f_bavail = 0;
	return 0;
}
