// SPDX-License-Identifier: GPL-3.0-or-later
#include <stdlib.h>
#include <time.h>

#include "library/internal.h"

enum { RECEIVE_BYTES = 65536 };

double cau_client_now(void)
{
	struct timespec now;
	clock_gettime(CLOCK_MONOTONIC, &now);
	return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

cau_status cau_loop_create(cau_loop **loop, cau_error *error)
{
	struct lws_context_creation_info info = {
		.port = CONTEXT_PORT_NO_LISTEN,
		.protocols = cau_client_protocols,
		.options = LWS_SERVER_OPTION_DO_SSL_GLOBAL_INIT,
		.pt_serv_buf_size = RECEIVE_BYTES,
		.gid = -1,
		.uid = -1,
	};
	lws_set_log_level(0, NULL); // troubles are told by cau_error
	*loop = calloc(1, sizeof **loop);
	if (*loop)
		(*loop)->context = lws_create_context(&info);
	if (*loop && (*loop)->context)
		return CAU_OK;
	free(*loop);
	*loop = NULL;
	return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for an event loop");
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
	(void)wake; // that the wait ended is all there is to it
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
