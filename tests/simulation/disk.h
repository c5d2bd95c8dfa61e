// SPDX-License-Identifier: GPL-3.0-or-later
// The simulation's disk: files in memory, with what of them would outlive a loss of power. The
// store reaches it by SQLite's VFS (disk_vfs.c) and by the C library's calls (disk_calls.c), both
// for paths below /sim0 and /sim1: one folder for each daemon's machine.
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum {
	DISK_MACHINES = 2,
	DISK_SECTOR_BYTES = 512, // written whole or not at all when power goes
	DISK_PATH_BYTES = 512,
};

typedef struct disk_inode {
	int number, machine;
	unsigned char *bytes, *durable; // what is read; what a loss of power leaves
	size_t size, durable_size;
	unsigned char *dirty;               // a byte a sector: it differs from what is durable
	size_t dirty_from, dirty_to;        // the sectors that may be
	const void *file_lock, *range_lock; // who holds them; NULL: nobody
	struct disk_handle *handles;        // SQLite's
	void *shared[64];                   // SQLite's index of its log, in pieces
	int shared_count[8];                // and its locks: handles that share one
	struct disk_handle *exclusive[8];
} disk_inode;

// How a machine's disk behaves.
typedef struct disk_manner {
	bool full;                                                     // no file grows
	int64_t sync_least_ns, sync_most_ns;                           // how long a sync takes
	int64_t fail_write_one_in, fail_sync_one_in, fail_read_one_in; // 0: never
	bool lies;                                                     // a sync makes nothing durable
} disk_manner;

void disk_begin(uint64_t seed);
disk_manner *disk_manner_of(int machine);
int disk_machine_of(const char *path); // -1: a path of the real machine

// NULL: there is none. `make`: a new empty one then.
disk_inode *disk_find(const char *path, bool make);
bool disk_link(const char *from, const char *to); // false: `to` is taken, or no `from`
bool disk_unlink(const char *path);
void disk_sync_names(int machine); // makes and removals of files outlive a loss of power
disk_inode *disk_make_nameless(int machine);

// 0 or an errno.
int disk_write(disk_inode *inode, const void *bytes, size_t count, size_t at);
int disk_read(const disk_inode *inode, void *bytes, size_t count, size_t at, size_t *got);
int disk_truncate(disk_inode *inode, size_t size);
int disk_sync(disk_inode *inode);

// All that runs on the machine is gone. `power`: and so is, in part, what was not synced.
void disk_kill(int machine, bool power);
size_t disk_bytes(int machine); // of all its files

void sim_calls_kill(int machine); // its descriptors are gone
void disk_vfs_register(void);     // as SQLite's default, before SQLite does anything else

typedef struct disk_counts {
	uint64_t writes, syncs, lost_sectors, torn_writes, failed;
} disk_counts;
extern disk_counts disk_counted;
