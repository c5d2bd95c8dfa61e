// SPDX-License-Identifier: GPL-3.0-or-later
// A client that is connected to a scripted server.
#pragma once

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "cautery/client.h"
#include "clients/library/scripted_server.h"

// Longest wait, s: much longer than a loopback needs, even under sanitizers. Only failing tests
// wait so long.
enum { FIXTURE_PATIENCE_S = 20 };

typedef struct fixture {
	scripted_server *server;
	cau_loop *loop;
	cau_client *client;
	cau_client_def def;
	cau_error error;
} fixture;

static inline void fixture_begin(fixture *f, const scripted_script *script)
{
	*f = (fixture){.server = scripted_start(script), .def = cau_default_client_def()};
	f->def.url = scripted_url(f->server);
	f->def.name = "test";
	f->def.timeout_s = FIXTURE_PATIENCE_S;
	assert_int_equal(cau_loop_create(&f->loop, &f->error), CAU_OK);
}

static inline cau_status fixture_connect(fixture *f)
{
	assert_int_equal(cau_client_create(f->loop, &f->def, &f->client, &f->error), CAU_OK);
	return cau_client_connect(f->client, &f->error);
}

static inline void fixture_end(fixture *f)
{
	if (f->client)
		cau_client_close(f->client);
	cau_client_destroy(f->client);
	cau_loop_destroy(f->loop);
	scripted_stop(f->server);
}

// Waits until `condition` is true.
#define FIXTURE_AWAIT(f, condition)                                                                \
	do {                                                                                           \
		double until_s_ = cau_client_now() + FIXTURE_PATIENCE_S;                                   \
		while (!(condition) && cau_client_now() < until_s_)                                        \
			cau_loop_wait((f)->loop, 0.1);                                                         \
		if (!(condition))                                                                          \
			fail_msg("never came true: %s", #condition);                                           \
	} while (0)
