// SPDX-License-Identifier: GPL-3.0-or-later
// The simulation's disk: files in memory, with the part of them that would survive a loss of power.
// The store reaches it through SQLite's VFS (disk_vfs.c) and the C library's calls (disk_calls.c).
// Both use the simulated disk for paths below /sim0 and /sim1, one folder for each daemon's
// machine.
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum {
	DISK_MACHINES = 2,
	DISK_SECTOR_BYTES = 512, // a sector is written whole or not at all when power is lost
	DISK_PATH_BYTES = 512,
};

typedef struct disk_inode {
	int number, machine;
	// bytes: present content; durable: content after a loss of power
	unsigned char *bytes, *durable;
	size_t size, durable_size;
	// one byte for each sector that differs from the durable content
	unsigned char *dirty;
	size_t dirty_from, dirty_to;        // range of sectors that may differ
	const void *file_lock, *range_lock; // holders of the locks, or NULL
	struct disk_handle *handles;        // SQLite's handles
	void *shared[64];                   // SQLite's index of its log, in pieces
	int shared_count[8]; // locks of the shared index: number of handles that share each lock
	struct disk_handle *exclusive[8];
} disk_inode;

// The behaviour of a machine's disk.
typedef struct disk_manner {
	bool full;                           // no file can grow
	int64_t sync_least_ns, sync_most_ns; // duration of a sync
	// errors happen with a probability of one in this number; 0: never
	int64_t fail_write_one_in, fail_sync_one_in, fail_read_one_in;
	bool lies; // a sync makes nothing durable
} disk_manner;

void disk_begin(uint64_t seed);
disk_manner *disk_manner_of(int machine);
int disk_machine_of(const char *path); // -1 for a path of the real machine

// Finds a file. If there is no such file, returns NULL or, with `make`, creates an empty file.
disk_inode *disk_find(const char *path, bool make);
bool disk_link(const char *from, const char *to); // returns false if `to` exists or `from` does not
bool disk_unlink(const char *path);
void disk_sync_names(int machine); // makes created and removed names durable
disk_inode *disk_make_nameless(int machine);

// Each of these functions returns 0 or an errno.
int disk_write(disk_inode *inode, const void *bytes, size_t count, size_t at);
int disk_read(const disk_inode *inode, void *bytes, size_t count, size_t at, size_t *got);
int disk_truncate(disk_inode *inode, size_t size);
int disk_sync(disk_inode *inode);

// Kills the machine and closes its open files. With `power`, some of the data that was not synced
// is lost too.
void disk_kill(int machine, bool power);
size_t disk_bytes(int machine); // size of all files of the machine

void sim_calls_kill(int machine); // closes the machine's descriptors
void disk_vfs_register(void);     // registers SQLite's default VFS; call it before SQLite is used

typedef struct disk_counts {
	uint64_t writes, syncs, lost_sectors, torn_writes, failed;
} disk_counts;
extern disk_counts disk_counted;
