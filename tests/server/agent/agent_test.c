// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the agent with all kinds of peers at its port.
#include "agent/agent.h"

#include <arpa/inet.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include <cmocka.h>

enum { PATIENCE_S = 10 }; // longest wait for an answer, which should come at once

typedef struct world {
	cau_agent *agent;
	atomic_int measured;
	atomic_bool takes;
} world;

static void measure(void *user, cau_load *load)
{
	world *w = user;
	w->measured++;
	*load = (cau_load){.takes = w->takes,
	                   .session_count = 37,
	                   .session_count_most = 100,
	                   .session_bytes_most = 1,
	                   .pace_share_min = 1};
}

static int begin(void **state)
{
	static world made;
	cau_error error = {0};
	made = (world){.takes = true};
	*state = &made;
	cau_agent_def def = {.address = "127.0.0.1", .measure = measure, .user = &made};
	return cau_agent_create(&made.agent, &def, &error) ? 1 : 0;
}

static int end(void **state)
{
	world *w = *state;
	cau_agent_destroy(w->agent);
	return 0;
}

static int connect_peer(const world *w)
{
	int peer = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
	struct sockaddr_in at = {.sin_family = AF_INET,
	                         .sin_port = htons((uint16_t)cau_agent_port(w->agent)),
	                         .sin_addr.s_addr = htonl(INADDR_LOOPBACK)};
	struct timeval patience = {.tv_sec = PATIENCE_S};
	assert_true(peer >= 0);
	assert_int_equal(setsockopt(peer, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience), 0);
	assert_int_equal(connect(peer, (struct sockaddr *)&at, sizeof at), 0);
	return peer;
}

// Reads until the agent closes, and compares the text.
static void expect_line(int peer, const char *wanted)
{
	char text[64] = "";
	size_t bytes = 0;
	ssize_t got;
	while ((got = recv(peer, text + bytes, sizeof text - 1 - bytes, 0)) > 0)
		bytes += (size_t)got;
	assert_int_equal(got, 0);
	assert_string_equal(text, wanted);
	close(peer);
}

static void who_asks_gets_one_line(void **state)
{
	const world *w = *state;
	expect_line(connect_peer(w), "ready 63%\n");
}

static void who_has_no_room_drains(void **state)
{
	world *w = *state;
	w->takes = false;
	expect_line(connect_peer(w), "drain\n");
}

static void silent_and_resetting_peers_disturb_nobody(void **state)
{
	enum { PEERS = 200 };
	const world *w = *state;
	int silent[PEERS];
	for (int i = 0; i < PEERS; i++) {
		silent[i] = connect_peer(w);
		struct linger at_once = {.l_onoff = 1};
		int resetting = connect_peer(w);
		setsockopt(resetting, SOL_SOCKET, SO_LINGER, &at_once, sizeof at_once);
		close(resetting);
	}
	expect_line(connect_peer(w), "ready 63%\n");
	for (int i = 0; i < PEERS; i++)
		expect_line(silent[i], "ready 63%\n"); // each peer had a line of its own
}

static void the_load_is_not_measured_for_each(void **state)
{
	enum { PEERS = 100 };
	world *w = *state;
	for (int i = 0; i < PEERS; i++)
		expect_line(connect_peer(w), "ready 63%\n");
	assert_in_range(w->measured, 1, PEERS / 2);
}

static void a_taken_port_is_said(void **state)
{
	const world *w = *state;
	cau_agent *second;
	cau_error error = {0};
	cau_agent_def def = {
		.address = "127.0.0.1", .port = cau_agent_port(w->agent), .measure = measure};
	assert_int_equal(cau_agent_create(&second, &def, &error), CAU_IO);
	assert_null(second);
	assert_string_equal(error.path, "agent_port");
	assert_non_null(strstr(error.reason, "cannot listen"));
}

int main(void)
{
#define CASE(name) cmocka_unit_test_setup_teardown(name, begin, end)
	const struct CMUnitTest tests[] = {
		CASE(who_asks_gets_one_line),
		CASE(who_has_no_room_drains),
		CASE(silent_and_resetting_peers_disturb_nobody),
		CASE(the_load_is_not_measured_for_each),
		CASE(a_taken_port_is_said),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
