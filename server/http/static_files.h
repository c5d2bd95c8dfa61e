// SPDX-License-Identifier: GPL-3.0-or-later
// The files of the viewer and of the manual, read once at start and held in memory, compressed
// where that is smaller: the network thread never touches a disk.
#pragma once

#include <stdbool.h>
#include <stddef.h>

#include "cautery/status.h"

typedef struct cau_static_file {
	char path[256]; // as in the URL, "/assets/main.js"
	const char *content_type;
	bool hashed; // its name changes with its content: may be cached for ever
	void *plain;
	size_t plain_bytes;
	void *gzip; // NULL if not smaller
	size_t gzip_bytes;
} cau_static_file;

typedef struct cau_static_files cau_static_files;

// Reads a folder and its folders: at most 1,024 files and 64 MiB; hidden files and links are left
// out. An empty folder name gives one plain page. `setting` (borrowed for good) is the path of
// errors: CAU_IO, CAU_LIMIT, CAU_NO_MEMORY.
cau_status cau_static_files_load(cau_static_files **files, const char *setting, const char *folder,
                                 cau_error *error);
void cau_static_files_destroy(cau_static_files *files);

// The file at a URL path ("/" is "/index.html"), or NULL.
const cau_static_file *cau_static_files_find(const cau_static_files *files, const char *path);
