// SPDX-License-Identifier: GPL-3.0-or-later
// Fills uploaded surfaces with tetrahedra. This runs cautery-mesh in a process of its own, with
// limits on memory and time. A file that exceeds the limits ends only that process, never a
// session.
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "cautery/status.h"

enum { CAU_FILL_REPORT_BYTES = 16384 };

// The shared state of an upload and its filling, used by the network thread and a builder's thread.
// Reference-counted.
typedef struct cau_filling cau_filling;

cau_filling *cau_filling_create(void); // NULL if memory ran out
cau_filling *cau_filling_share(cau_filling *filling);
void cau_filling_release(cau_filling *filling); // `filling` may be NULL
// Cancels the filling, because the upload is gone or is filled with other parameters. The process
// ends soon.
void cau_filling_cancel(cau_filling *filling);
bool cau_filling_is_cancelled(const cau_filling *filling);
// Notes that the filling has ended, with or without a solid.
void cau_filling_end(cau_filling *filling);
bool cau_filling_has_ended(const cau_filling *filling);
// Returns the solid's bytes, valid as long as the caller holds the filling. Returns false if there
// is not a solid, or not yet.
bool cau_filling_solid(const cau_filling *filling, const void **bytes, size_t *byte_count);

typedef struct cau_fill_wish {
	const void *bytes;
	size_t byte_count;
	const char *file_name; // the user's name of the file
	double edge;           // edge length in units of the file; 0: chosen automatically
	const char *labels;    // labels to fill; "": all
	bool strict;
	// limits of the process, and of the size of the solid's file
	int64_t memory_mb, time_s, most_bytes;
	// called about ten times a second; true: the daemon is ending
	bool (*is_over)(void *user);
	void *user;
} cau_fill_wish;

// Makes the solid, puts it into *filling, and waits until it is done. The report has one fact on
// each line. Errors: those of cautery-mesh, at "edge_m", "labels" or "strict"; CAU_LIMIT with the
// name of the setting whose limit was reached; CAU_IO.
cau_status cau_fill(cau_filling *filling, const cau_fill_wish *wish,
                    char report[static CAU_FILL_REPORT_BYTES], cau_error *error);
