// SPDX-License-Identifier: GPL-3.0-or-later
// Solids of uploads: cautery-mesh in a process of its own, with bounds on memory and time. A file
// that it cannot bear costs that process, and never a session.
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "cautery/status.h"

enum { CAU_FILL_REPORT_BYTES = 16384 };

// What an upload and its filling share, between the network thread and a builder's. Counted.
typedef struct cau_filling cau_filling;

cau_filling *cau_filling_create(void); // NULL: no memory
cau_filling *cau_filling_share(cau_filling *filling);
void cau_filling_release(cau_filling *filling); // takes NULL
// The upload is gone, or something else is wanted of it: the process ends soon.
void cau_filling_cancel(cau_filling *filling);
bool cau_filling_is_cancelled(const cau_filling *filling);
// Nothing is done for it any more, whatever came of it.
void cau_filling_end(cau_filling *filling);
bool cau_filling_has_ended(const cau_filling *filling);
// The solid's bytes, valid as long as the filling is held. False: it is not there (yet).
bool cau_filling_solid(const cau_filling *filling, const void **bytes, size_t *byte_count);

typedef struct cau_fill_wish {
	const void *bytes;
	size_t byte_count;
	const char *file_name; // as the user calls it
	double edge;           // in units of the file; 0: chosen
	const char *labels;    // "": all
	bool strict;
	int64_t memory_mb, time_s, most_bytes; // bounds of the process, and of the solid's file
	bool (*is_over)(void *user);           // asked about ten times a second: the daemon ends
	void *user;
} cau_fill_wish;

// Fills *filling, and waits for it. The report has a fact a line. Errors: what cautery-mesh says,
// at "edge_m", "labels" or "strict"; CAU_LIMIT naming the setting where a bound was reached;
// CAU_IO.
cau_status cau_fill(cau_filling *filling, const cau_fill_wish *wish,
                    char report[static CAU_FILL_REPORT_BYTES], cau_error *error);
