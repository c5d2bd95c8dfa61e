// SPDX-License-Identifier: GPL-3.0-or-later
// Measurements of the machine and of the daemon's process.
#pragma once

#include "cautery/status.h"

// Processor time of this machine since boot, in kernel ticks. It is zero if /proc does not report
// it.
typedef struct load_cpu {
	double total, steal;
} load_cpu;
load_cpu load_cpu_read(void);

double load_own_cpu_s(void); // processor time of this process

// Reads the daemon's resident memory from /metrics at the URL's host and port, by plain HTTP only.
// `token` may be NULL. Errors: CAU_IO, CAU_UNSUPPORTED (TLS), CAU_NOT_FOUND (no such metric).
cau_status load_daemon_memory(const char *url, const char *token, double *bytes, cau_error *error);
