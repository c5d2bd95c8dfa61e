// SPDX-License-Identifier: GPL-3.0-or-later
// The files of the viewer and of the manual. They are read once at the start and held in memory,
// compressed if that is smaller. So the network thread never reads a disk.
#pragma once

#include <stdbool.h>
#include <stddef.h>

#include "cautery/status.h"

typedef struct cau_static_file {
	char path[256]; // path in the URL, "/assets/main.js"
	const char *content_type;
	// the file's name contains a hash of its content, so the file may be cached for ever
	bool hashed;
	void *plain;
	size_t plain_bytes;
	void *gzip; // NULL if the compressed file would not be smaller
	size_t gzip_bytes;
} cau_static_file;

typedef struct cau_static_files cau_static_files;

// Reads a folder and its subfolders: at most 1,024 files and 64 MiB, without hidden files and
// links. If `folder` is "", makes one plain page. `setting` is the path of errors, and must stay
// valid. Errors: CAU_IO, CAU_LIMIT, CAU_NO_MEMORY.
cau_status cau_static_files_load(cau_static_files **files, const char *setting, const char *folder,
                                 cau_error *error);
void cau_static_files_destroy(cau_static_files *files);

// Returns the file at a URL path ("/" means "/index.html"), or NULL.
const cau_static_file *cau_static_files_find(const cau_static_files *files, const char *path);
