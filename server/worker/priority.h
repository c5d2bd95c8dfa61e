// SPDX-License-Identifier: GPL-3.0-or-later
// Priorities of the daemon's threads when processors are short: network and watchdog first, workers
// after them, and the builder last.
#pragma once

#include <sys/resource.h>
#include <sys/types.h>
#include <unistd.h>

enum {
	CAU_NICE_FIRST = -5, // if the system permits: CAP_SYS_NICE, or LimitNICE of the service
	CAU_NICE_LAST = 5,
	// the builder gets what workers leave, or a third of a worker's share. At 15, a session of 2.5
	// s took 79 s beside two programs.
	CAU_NICE_BUILDER = 10,
};

// Sets the priority of the calling thread. It stays if the system does not permit the change.
static inline void cau_thread_set_nice(int nice)
{
	setpriority(PRIO_PROCESS, (id_t)gettid(), nice);
}
