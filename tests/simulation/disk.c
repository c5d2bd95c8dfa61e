// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulation/disk.h"

#include <assert.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>

#include "simulation/scheduler.h"

enum {
	NAMES_MOST = 256,
	INODES_MOST = 4096,   // a daemon that cannot start creates some inodes at each attempt
	FILE_MOST = 64 << 20, // address space of each file in bytes; only written pages take memory
};

typedef struct name {
	char path[DISK_PATH_BYTES];
	disk_inode *inode, *durable; // NULL if no file has this name
} name;

static struct {
	name names[NAMES_MOST];
	int name_count, inode_count;
	disk_inode *inodes[INODES_MOST];
	disk_manner manners[DISK_MACHINES];
	sim_random random;
} disk;

disk_counts disk_counted;

void disk_begin(uint64_t seed)
{
	memset(&disk, 0, sizeof disk);
	disk.random = sim_random_of(seed, 3);
	disk_counted = (disk_counts){0};
	for (int i = 0; i < DISK_MACHINES; i++)
		disk.manners[i] = (disk_manner){.sync_least_ns = 50000, .sync_most_ns = 2 * SIM_MS};
}

disk_manner *disk_manner_of(int machine)
{
	return &disk.manners[machine];
}

int disk_machine_of(const char *path)
{
	bool here = strncmp(path, "/sim", 4) == 0 && path[4] >= '0' && path[4] < '0' + DISK_MACHINES &&
	            (path[5] == '/' || !path[5]);
	return here ? path[4] - '0' : -1;
}

// ---- names
static name *find_name(const char *path)
{
	for (int i = 0; i < disk.name_count; i++)
		if (strcmp(disk.names[i].path, path) == 0)
			return &disk.names[i];
	return NULL;
}

static name *make_name(const char *path)
{
	name *found = find_name(path);
	if (found)
		return found;
	assert(disk.name_count < NAMES_MOST && strlen(path) < DISK_PATH_BYTES);
	found = &disk.names[disk.name_count++];
	snprintf(found->path, sizeof found->path, "%s", path);
	return found;
}

static unsigned char *reserve(size_t bytes)
{
	void *memory = mmap(NULL, bytes, PROT_READ | PROT_WRITE,
	                    MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
	assert(memory != MAP_FAILED);
	return memory;
}

disk_inode *disk_make_nameless(int machine)
{
	disk_inode *inode = calloc(1, sizeof *inode);
	assert(inode && disk.inode_count < INODES_MOST);
	inode->number = disk.inode_count + 1;
	inode->machine = machine;
	inode->bytes = reserve(FILE_MOST);
	inode->durable = reserve(FILE_MOST);
	inode->dirty = reserve(FILE_MOST / DISK_SECTOR_BYTES);
	disk.inodes[disk.inode_count++] = inode;
	return inode;
}

disk_inode *disk_find(const char *path, bool make)
{
	name *found = make ? make_name(path) : find_name(path);
	if (found && !found->inode && make)
		found->inode = disk_make_nameless(disk_machine_of(path));
	return found ? found->inode : NULL;
}

bool disk_link(const char *from, const char *to)
{
	disk_inode *inode = disk_find(from, false);
	if (!inode || disk_find(to, false))
		return false;
	make_name(to)->inode = inode;
	return true;
}

bool disk_unlink(const char *path)
{
	name *found = find_name(path);
	if (!found || !found->inode)
		return false;
	found->inode = NULL;
	return true;
}

void disk_sync_names(int machine)
{
	for (int i = 0; i < disk.name_count; i++)
		if (disk_machine_of(disk.names[i].path) == machine)
			disk.names[i].durable = disk.names[i].inode;
}

// ---- bytes
static void soil(disk_inode *inode, size_t at, size_t count)
{
	size_t first = at / DISK_SECTOR_BYTES;
	size_t end = (at + count + DISK_SECTOR_BYTES - 1) / DISK_SECTOR_BYTES;
	bool clean = inode->dirty_from == inode->dirty_to;
	if (!count)
		return;
	memset(inode->dirty + first, 1, end - first);
	inode->dirty_from = clean || first < inode->dirty_from ? first : inode->dirty_from;
	inode->dirty_to = clean || end > inode->dirty_to ? end : inode->dirty_to;
}

int disk_write(disk_inode *inode, const void *bytes, size_t count, size_t at)
{
	const disk_manner *manner = &disk.manners[inode->machine];
	disk_counted.writes++;
	if (sim_chance(&disk.random, manner->fail_write_one_in)) {
		disk_counted.failed++;
		return EIO;
	}
	if (manner->full && at + count > inode->size)
		return ENOSPC;
	assert(at + count <= FILE_MOST);
	memcpy(inode->bytes + at, bytes, count);
	if (at + count > inode->size)
		inode->size = at + count;
	soil(inode, at, count);
	return 0;
}

int disk_read(const disk_inode *inode, void *bytes, size_t count, size_t at, size_t *got)
{
	if (sim_chance(&disk.random, disk.manners[inode->machine].fail_read_one_in)) {
		disk_counted.failed++;
		return EIO;
	}
	*got = at >= inode->size ? 0 : inode->size - at < count ? inode->size - at : count;
	if (*got)
		memcpy(bytes, inode->bytes + at, *got);
	return 0;
}

int disk_truncate(disk_inode *inode, size_t size)
{
	assert(size <= FILE_MOST);
	if (size < inode->size) {
		memset(inode->bytes + size, 0, inode->size - size);
		soil(inode, size, inode->size - size);
	}
	inode->size = size;
	return 0;
}

// Makes a file durable. Bytes that are written during the sync become durable only with the next
// sync.
int disk_sync(disk_inode *inode)
{
	const disk_manner *manner = &disk.manners[inode->machine];
	disk_counted.syncs++;
	sim_sleep(sim_between(&disk.random, manner->sync_least_ns, manner->sync_most_ns));
	if (sim_chance(&disk.random, manner->fail_sync_one_in)) {
		disk_counted.failed++;
		return EIO;
	}
	if (manner->lies)
		return 0;
	for (size_t sector = inode->dirty_from; sector < inode->dirty_to; sector++)
		if (inode->dirty[sector]) {
			size_t at = sector * DISK_SECTOR_BYTES;
			memcpy(inode->durable + at, inode->bytes + at, DISK_SECTOR_BYTES);
			inode->dirty[sector] = 0;
		}
	inode->dirty_from = inode->dirty_to = 0;
	inode->durable_size = inode->size;
	return 0;
}

// ---- death of a machine
enum { ALL_LOST, ALL_KEPT, SOME_LOST, LOSSES };

static bool is_kept(int loss)
{
	return loss == ALL_KEPT || (loss == SOME_LOST && sim_chance(&disk.random, 2));
}

static void lose(disk_inode *inode)
{
	int loss = (int)sim_between(&disk.random, 0, LOSSES - 1);
	size_t size = is_kept(loss) ? inode->size : inode->durable_size;
	for (size_t sector = inode->dirty_from; sector < inode->dirty_to; sector++) {
		size_t at = sector * DISK_SECTOR_BYTES;
		if (!inode->dirty[sector])
			continue;
		bool kept = is_kept(loss);
		disk_counted.lost_sectors += !kept;
		disk_counted.torn_writes += loss == SOME_LOST;
		memcpy((kept ? inode->durable : inode->bytes) + at,
		       (kept ? inode->bytes : inode->durable) + at, DISK_SECTOR_BYTES);
		inode->dirty[sector] = 0;
	}
	size_t most = inode->size > inode->durable_size ? inode->size : inode->durable_size;
	memset(inode->bytes + size, 0, most - size);
	memset(inode->durable + size, 0, most - size);
	inode->dirty_from = inode->dirty_to = 0;
	inode->size = inode->durable_size = size;
}

static void lose_names(int machine)
{
	for (int i = 0; i < disk.name_count; i++) {
		name *n = &disk.names[i];
		if (disk_machine_of(n->path) == machine && n->inode != n->durable)
			n->inode = n->durable = sim_chance(&disk.random, 2) ? n->inode : n->durable;
	}
}

void disk_kill(int machine, bool power)
{
	for (int i = 0; i < disk.inode_count; i++) {
		disk_inode *inode = disk.inodes[i];
		if (inode->machine != machine)
			continue;
		inode->file_lock = inode->range_lock = NULL;
		inode->handles = NULL;
		memset(inode->shared, 0, sizeof inode->shared);
		memset(inode->shared_count, 0, sizeof inode->shared_count);
		memset(inode->exclusive, 0, sizeof inode->exclusive);
		if (power)
			lose(inode);
	}
	if (power)
		lose_names(machine);
}

size_t disk_bytes(int machine)
{
	size_t bytes = 0;
	for (int i = 0; i < disk.name_count; i++)
		if (disk.names[i].inode && disk_machine_of(disk.names[i].path) == machine)
			bytes += disk.names[i].inode->size;
	return bytes;
}
