// SPDX-License-Identifier: GPL-3.0-or-later
// What the machine and the daemon's process say of themselves.
#pragma once

#include "cautery/status.h"

// Processor time of this machine since boot, in ticks of the kernel; zero where /proc tells none.
typedef struct load_cpu {
	double total, steal;
} load_cpu;
load_cpu load_cpu_read(void);

double load_own_cpu_s(void); // of this process

// Resident memory of the daemon, from /metrics at the URL's host and port; plain HTTP only. `token`
// may be NULL. Errors: CAU_IO, CAU_UNSUPPORTED (TLS), CAU_NOT_FOUND (no such metric).
cau_status load_daemon_memory(const char *url, const char *token, double *bytes, cau_error *error);
