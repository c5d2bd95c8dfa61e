// SPDX-License-Identifier: GPL-3.0-or-later
#include "transport_dds/leave.h"

#include <pthread.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#include "clock/clock.h"
#include "log/log.h"

#define LEAVE_S 2

static void *leave(void *domain)
{
	dds_delete((dds_entity_t)(intptr_t)domain);
	return NULL;
}

// Ends the process before OpenSSL's exit handler, which frees memory that Cyclone's running threads
// use. Exit handlers run in the reverse order of their registration.
static void end_at_once(int status, void *unused)
{
	(void)unused;
	fflush(NULL);
	_exit(status);
}

void cau_dds_leave(dds_entity_t domain)
{
	pthread_t thread;
	struct timespec until = cau_timespec(cau_monotonic_s() + LEAVE_S);
	if (pthread_create(&thread, NULL, leave, (void *)(intptr_t)domain) != 0) {
		dds_delete(domain);
	} else if (pthread_clockjoin_np(thread, NULL, CLOCK_MONOTONIC, &until) != 0) {
		pthread_detach(thread);
		on_exit(end_at_once, NULL);
		cau_log(CAU_LOG_WARNING, NULL, "dds_not_left",
		        "reason=\"the network interface of DDS is gone\"");
	}
}
