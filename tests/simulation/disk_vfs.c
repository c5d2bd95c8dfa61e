// SPDX-License-Identifier: GPL-3.0-or-later
// SQLite's VFS on the simulated disk.
#include <assert.h>
#include <errno.h>
#include <sqlite3.h>
#include <stdlib.h>
#include <string.h>

#include "simulation/disk.h"
#include "simulation/scheduler.h"

typedef struct disk_handle {
	sqlite3_file base;
	disk_inode *inode;
	struct disk_handle *next; // next handle of the inode
	int lock;                 // SQLITE_LOCK_*
	unsigned shares, owns;    // shares, owns: bits of the handle's locks on the log's index
	bool delete_on_close;
	// false if the next sync must also sync the folder: the first sync of a file that may be new
	// does so, as in SQLite's own VFS
	bool names_synced;
	char path[DISK_PATH_BYTES];
} disk_handle;

static int last_error;
static sim_random vfs_random;

static disk_handle *of(sqlite3_file *file)
{
	return (disk_handle *)file;
}

static int code_of(int error, int otherwise)
{
	last_error = error;
	return error == ENOSPC ? SQLITE_FULL : error ? otherwise : SQLITE_OK;
}

// ---- bytes
static int file_read(sqlite3_file *file, void *bytes, int count, sqlite3_int64 at)
{
	size_t got = 0;
	sim_point();
	int error = disk_read(of(file)->inode, bytes, (size_t)count, (size_t)at, &got);
	if (error)
		return code_of(error, SQLITE_IOERR_READ);
	if (got == (size_t)count)
		return SQLITE_OK;
	memset((char *)bytes + got, 0, (size_t)count - got);
	return SQLITE_IOERR_SHORT_READ;
}

static int file_write(sqlite3_file *file, const void *bytes, int count, sqlite3_int64 at)
{
	sim_point();
	return code_of(disk_write(of(file)->inode, bytes, (size_t)count, (size_t)at),
	               SQLITE_IOERR_WRITE);
}

static int file_truncate(sqlite3_file *file, sqlite3_int64 size)
{
	return code_of(disk_truncate(of(file)->inode, (size_t)size), SQLITE_IOERR_TRUNCATE);
}

static int file_sync(sqlite3_file *file, int flags)
{
	disk_handle *h = of(file);
	(void)flags;
	int error = disk_sync(h->inode);
	if (!error && !h->names_synced)
		disk_sync_names(h->inode->machine);
	h->names_synced = h->names_synced || !error;
	return code_of(error, SQLITE_IOERR_FSYNC);
}

static int file_size(sqlite3_file *file, sqlite3_int64 *size)
{
	*size = (sqlite3_int64)of(file)->inode->size;
	return SQLITE_OK;
}

// ---- locks on the database
static int most_of_others(const disk_handle *own)
{
	int most = SQLITE_LOCK_NONE;
	for (const disk_handle *h = own->inode->handles; h; h = h->next)
		if (h != own && h->lock > most)
			most = h->lock;
	return most;
}

static int file_lock(sqlite3_file *file, int wanted)
{
	disk_handle *h = of(file);
	sim_point();
	if (h->lock >= wanted)
		return SQLITE_OK;
	int others = most_of_others(h);
	if (wanted == SQLITE_LOCK_SHARED && others >= SQLITE_LOCK_PENDING)
		return SQLITE_BUSY;
	if (wanted == SQLITE_LOCK_RESERVED && others >= SQLITE_LOCK_RESERVED)
		return SQLITE_BUSY;
	if (wanted == SQLITE_LOCK_EXCLUSIVE) {
		if (others >= SQLITE_LOCK_PENDING)
			return SQLITE_BUSY;
		h->lock = SQLITE_LOCK_PENDING;
		if (others >= SQLITE_LOCK_SHARED)
			return SQLITE_BUSY;
	}
	h->lock = wanted;
	return SQLITE_OK;
}

static int file_unlock(sqlite3_file *file, int wanted)
{
	disk_handle *h = of(file);
	if (h->lock > wanted)
		h->lock = wanted;
	return SQLITE_OK;
}

static int file_check_reserved(sqlite3_file *file, int *result)
{
	disk_handle *h = of(file);
	*result = h->lock >= SQLITE_LOCK_RESERVED || most_of_others(h) >= SQLITE_LOCK_RESERVED;
	return SQLITE_OK;
}

// ---- the log's index, shared by all connections
static int shared_map(sqlite3_file *file, int piece, int piece_bytes, int extend,
                      void volatile **mapped)
{
	disk_inode *inode = of(file)->inode;
	assert(piece < (int)(sizeof inode->shared / sizeof *inode->shared));
	if (!inode->shared[piece] && extend)
		inode->shared[piece] = calloc(1, (size_t)piece_bytes);
	*mapped = inode->shared[piece];
	return SQLITE_OK;
}

static bool is_free(const disk_handle *h, int slot, bool exclusive)
{
	const disk_inode *inode = h->inode;
	if (inode->exclusive[slot] && inode->exclusive[slot] != h)
		return false;
	return !exclusive || inode->shared_count[slot] == ((h->shares >> slot) & 1u ? 1 : 0);
}

static void set_lock(disk_handle *h, int slot, int flags)
{
	unsigned bit = 1u << slot;
	disk_inode *inode = h->inode;
	bool on = flags & SQLITE_SHM_LOCK;
	if (flags & SQLITE_SHM_EXCLUSIVE) {
		inode->exclusive[slot] = on ? h : NULL;
		h->owns = on ? h->owns | bit : h->owns & ~bit;
	} else if (on != !!(h->shares & bit)) {
		inode->shared_count[slot] += on ? 1 : -1;
		h->shares ^= bit;
	}
}

static int shared_lock(sqlite3_file *file, int first, int count, int flags)
{
	disk_handle *h = of(file);
	sim_point();
	for (int slot = first; (flags & SQLITE_SHM_LOCK) && slot < first + count; slot++)
		if (!is_free(h, slot, flags & SQLITE_SHM_EXCLUSIVE))
			return SQLITE_BUSY;
	for (int slot = first; slot < first + count; slot++)
		set_lock(h, slot, flags);
	return SQLITE_OK;
}

static void shared_barrier(sqlite3_file *file)
{
	(void)file;
	sim_point();
}

static int shared_unmap(sqlite3_file *file, int delete)
{
	disk_handle *h = of(file);
	for (int slot = 0; slot < 8; slot++) {
		if (h->owns >> slot & 1u)
			set_lock(h, slot, SQLITE_SHM_UNLOCK | SQLITE_SHM_EXCLUSIVE);
		if (h->shares >> slot & 1u)
			set_lock(h, slot, SQLITE_SHM_UNLOCK | SQLITE_SHM_SHARED);
	}
	for (int i = 0; delete &&i < (int)(sizeof h->inode->shared / sizeof(void *)); i++) {
		free(h->inode->shared[i]);
		h->inode->shared[i] = NULL;
	}
	return SQLITE_OK;
}

// ---- opening
static int file_close(sqlite3_file *file)
{
	disk_handle *h = of(file);
	disk_handle **at = &h->inode->handles;
	while (*at && *at != h)
		at = &(*at)->next;
	if (*at)
		*at = h->next;
	// This was the last handle, so the next connection must open the log from the beginning.
	if (!h->inode->handles)
		shared_unmap(file, 1);
	if (h->delete_on_close && h->path[0])
		disk_unlink(h->path);
	return SQLITE_OK;
}

static int file_control(sqlite3_file *file, int what, void *argument)
{
	(void)file, (void)what, (void)argument;
	return SQLITE_NOTFOUND;
}

static int sector_bytes(sqlite3_file *file)
{
	(void)file;
	return DISK_SECTOR_BYTES;
}

static int characteristics(sqlite3_file *file)
{
	(void)file;
	return SQLITE_IOCAP_POWERSAFE_OVERWRITE; // SQLite's own VFS reports this for any disk
}

static const sqlite3_io_methods methods = {
	.iVersion = 2,
	.xClose = file_close,
	.xRead = file_read,
	.xWrite = file_write,
	.xTruncate = file_truncate,
	.xSync = file_sync,
	.xFileSize = file_size,
	.xLock = file_lock,
	.xUnlock = file_unlock,
	.xCheckReservedLock = file_check_reserved,
	.xFileControl = file_control,
	.xSectorSize = sector_bytes,
	.xDeviceCharacteristics = characteristics,
	.xShmMap = shared_map,
	.xShmLock = shared_lock,
	.xShmBarrier = shared_barrier,
	.xShmUnmap = shared_unmap,
};

static int vfs_open(sqlite3_vfs *vfs, const char *path, sqlite3_file *file, int flags, int *given)
{
	disk_handle *h = of(file);
	(void)vfs;
	*h = (disk_handle){.delete_on_close = flags & SQLITE_OPEN_DELETEONCLOSE};
	if (path && disk_machine_of(path) < 0)
		return SQLITE_CANTOPEN;
	h->inode = path ? disk_find(path, flags & SQLITE_OPEN_CREATE) : disk_make_nameless(0);
	if (!h->inode)
		return SQLITE_CANTOPEN;
	h->names_synced = !(flags & SQLITE_OPEN_CREATE);
	strncpy(h->path, path ? path : "", sizeof h->path - 1);
	h->next = h->inode->handles;
	h->inode->handles = h;
	h->base.pMethods = &methods;
	if (given)
		*given = flags;
	return SQLITE_OK;
}

static int vfs_delete(sqlite3_vfs *vfs, const char *path, int sync_folder)
{
	(void)vfs;
	if (!disk_unlink(path))
		return SQLITE_IOERR_DELETE_NOENT;
	if (sync_folder)
		disk_sync_names(disk_machine_of(path));
	return SQLITE_OK;
}

static int vfs_access(sqlite3_vfs *vfs, const char *path, int flags, int *result)
{
	(void)vfs;
	const disk_inode *inode = disk_find(path, false);
	*result = inode && (flags != SQLITE_ACCESS_EXISTS || inode->size > 0);
	return SQLITE_OK;
}

static int vfs_full_path(sqlite3_vfs *vfs, const char *path, int capacity, char *out)
{
	(void)vfs;
	if ((int)strlen(path) >= capacity)
		return SQLITE_CANTOPEN;
	strcpy(out, path);
	return SQLITE_OK;
}

static int vfs_randomness(sqlite3_vfs *vfs, int count, char *bytes)
{
	(void)vfs;
	for (int i = 0; i < count; i++)
		bytes[i] = (char)sim_draw(&vfs_random);
	return count;
}

static int vfs_sleep(sqlite3_vfs *vfs, int us)
{
	(void)vfs;
	sim_sleep(us * INT64_C(1000));
	return us;
}

static int vfs_time(sqlite3_vfs *vfs, sqlite3_int64 *ms)
{
	(void)vfs;
	// Julian day in ms
	*ms = INT64_C(210866760000000) + INT64_C(1700000000000) + sim_now() / SIM_MS;
	return SQLITE_OK;
}

static int vfs_last_error(sqlite3_vfs *vfs, int count, char *text)
{
	(void)vfs, (void)count, (void)text;
	return last_error;
}

static sqlite3_vfs vfs = {
	.iVersion = 2,
	.szOsFile = sizeof(disk_handle),
	.mxPathname = DISK_PATH_BYTES - 1,
	.zName = "simulation",
	.xOpen = vfs_open,
	.xDelete = vfs_delete,
	.xAccess = vfs_access,
	.xFullPathname = vfs_full_path,
	.xRandomness = vfs_randomness,
	.xSleep = vfs_sleep,
	.xGetLastError = vfs_last_error,
	.xCurrentTimeInt64 = vfs_time,
};

// Registers the VFS. SQLite is used without its own mutexes: fibers are switched only within the
// calls above, and SQLite holds no mutex during them.
void disk_vfs_register(void)
{
	sqlite3_config(SQLITE_CONFIG_SINGLETHREAD);
	sqlite3_config(SQLITE_CONFIG_MEMSTATUS, 0);
	vfs_random = sim_random_of(0, 4);
	int code = sqlite3_initialize();
	assert(code == SQLITE_OK);
	code = sqlite3_vfs_register(&vfs, 1);
	assert(code == SQLITE_OK);
	(void)code;
}
