// SPDX-License-Identifier: GPL-3.0-or-later
// Priorities of the daemon's threads, for times when the processors are fully used: network and
// watchdog first, workers after them, and the builder last.
#pragma once

#include <sys/resource.h>
#include <sys/types.h>
#include <unistd.h>

enum {
	// takes effect if the system permits it: CAP_SYS_NICE, or LimitNICE of the service
	CAU_NICE_FIRST = -5,
	CAU_NICE_LAST = 5,
	// With this value the builder gets the time that workers leave, or a third of a worker's share.
	// At 15, building a session that needs 2.5 s took 79 s while two other programs ran.
	CAU_NICE_BUILDER = 10,
};

// Sets the priority of the calling thread. It stays if the system does not permit the change.
static inline void cau_thread_set_nice(int nice)
{
	setpriority(PRIO_PROCESS, (id_t)gettid(), nice);
}
