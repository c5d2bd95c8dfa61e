// SPDX-License-Identifier: GPL-3.0-or-later
// How the daemon's threads stand to each other when processors are short: the network and the
// watchdog before everything, workers last, and the builder behind them.
#pragma once

#include <sys/resource.h>
#include <sys/types.h>
#include <unistd.h>

enum {
	CAU_NICE_FIRST = -5, // where the system lets us: CAP_SYS_NICE, or LimitNICE of the service
	CAU_NICE_LAST = 5,
	CAU_NICE_BUILDER = 10, // what builds and makes files takes what workers leave, and a third of
	                       // what one has. At 15 a session of 2.5 s took 79 s beside two programs
};

// Of the calling thread; stays as it is where the system does not let us.
static inline void cau_thread_set_nice(int nice)
{
	setpriority(PRIO_PROCESS, (id_t)gettid(), nice);
}
