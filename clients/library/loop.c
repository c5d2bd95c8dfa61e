// SPDX-License-Identifier: Apache-2.0
// The clock, and waiting in the event loop that socket.c creates.
#include <stdlib.h>
#include <time.h>

#include "library/internal.h"

double cau_client_now(void)
{
	struct timespec now;
	clock_gettime(CLOCK_MONOTONIC, &now);
	return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

void cau_loop_destroy(cau_loop *loop)
{
	if (!loop)
		return;
	lws_context_destroy(loop->context);
	free(loop);
}

static void woken(lws_sorted_usec_list_t *wake)
{
	(void)wake; // The timer's only purpose is to end the wait.
}

void cau_loop_wait(cau_loop *loop, double seconds)
{
	if (seconds <= 0) {
		lws_service(loop->context, -1);
		return;
	}
	lws_sul_schedule(loop->context, 0, &loop->wake, woken, (lws_usec_t)(seconds * 1e6) + 1);
	lws_service(loop->context, 0);
	lws_sul_cancel(&loop->wake);
}
