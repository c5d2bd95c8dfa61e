// SPDX-License-Identifier: GPL-3.0-or-later
// Asks a server for the labels behind an address. The server gives one fixed answer.
#include <arpa/inet.h>
#include <pthread.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cmocka.h>

#include "cautery/client.h"

// Longest wait, s: much longer than a loopback needs, even under sanitizers. Only failing tests
// wait so long.
static const double patience_s = 20;

typedef struct speaker {
	const char *answer; // the answer; NULL: the server does not answer until the client hangs up
	int socket;
	char url[64], request[2048];
	pthread_t thread;
} speaker;

static void *speak(void *argument)
{
	speaker *s = argument;
	size_t bytes = 0;
	int peer = accept(s->socket, NULL, NULL);
	while (!strstr(s->request, "\r\n\r\n")) {
		ssize_t got = recv(peer, s->request + bytes, sizeof s->request - 1 - bytes, 0);
		if (got <= 0)
			break;
		bytes += (size_t)got;
	}
	if (s->answer)
		send(peer, s->answer, strlen(s->answer), MSG_NOSIGNAL);
	else
		recv(peer, (char[1]){0}, 1, 0);
	close(peer);
	return NULL;
}

static void begin(speaker *s, const char *answer)
{
	struct sockaddr_in at = {.sin_family = AF_INET, .sin_addr.s_addr = htonl(INADDR_LOOPBACK)};
	socklen_t bytes = sizeof at;
	*s = (speaker){.answer = answer, .socket = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)};
	assert_int_equal(bind(s->socket, (struct sockaddr *)&at, sizeof at), 0);
	assert_int_equal(listen(s->socket, 1), 0);
	assert_int_equal(getsockname(s->socket, (struct sockaddr *)&at, &bytes), 0);
	snprintf(s->url, sizeof s->url, "ws://127.0.0.1:%d", ntohs(at.sin_port));
	assert_int_equal(pthread_create(&s->thread, NULL, speak, s), 0);
}

static cau_status ask(const char *answer, double timeout_s, cau_fleet *fleet, cau_error *error)
{
	speaker s;
	cau_loop *loop = NULL;
	begin(&s, answer);
	assert_int_equal(cau_loop_create(&loop, error), CAU_OK);
	cau_status status = cau_client_find_fleet(loop, s.url, timeout_s, fleet, error);
	cau_loop_destroy(loop);
	pthread_join(s.thread, NULL);
	close(s.socket);
	assert_non_null(strstr(s.request, "GET /api/fleet HTTP/1.1"));
	return status;
}

static cau_fleet fleet;

static void a_proxy_names_its_daemons(void **state)
{
	(void)state;
	cau_error error = {0};
	static const char answer[] = "HTTP/1.1 200 OK\r\ncontent-type: application/json\r\n"
								 "content-length: 24\r\n\r\n{\"labels\": [\"d1\", \"d2\"]}";
	assert_int_equal(ask(answer, patience_s, &fleet, &error), CAU_OK);
	assert_int_equal(fleet.count, 2);
	assert_string_equal(fleet.labels[1], "d2");
}

static void a_daemon_alone_is_no_fleet(void **state)
{
	(void)state;
	cau_error error = {0};
	static const char answer[] = "HTTP/1.1 404 Not Found\r\ncontent-length: 2\r\n\r\n{}";
	assert_int_equal(ask(answer, patience_s, &fleet, &error), CAU_OK);
	assert_int_equal(fleet.count, 0);
}

static void trouble_is_told(void **state)
{
	(void)state;
	cau_error error = {0};
	assert_int_equal(ask("", patience_s, &fleet, &error), CAU_IO); // the server hangs up
	assert_int_equal(ask(NULL, 0.05, &fleet, &error), CAU_IO);     // the server is silent
	assert_non_null(strstr(error.reason, "in time"));
	assert_int_equal(
		ask("HTTP/1.1 200 OK\r\ncontent-length: 2\r\n\r\n{}", patience_s, &fleet, &error),
		CAU_BAD_VALUE);
	assert_int_equal(fleet.count, 0);
}

static void more_than_a_fleet_needs_is_not_taken(void **state)
{
	(void)state;
	cau_error error = {0};
	static char answer[CAU_FLEET_JSON_MAX_BYTES + 200];
	int head = snprintf(answer, sizeof answer, "HTTP/1.1 200 OK\r\ncontent-length: %d\r\n\r\n",
	                    CAU_FLEET_JSON_MAX_BYTES + 1);
	memset(answer + head, ' ', CAU_FLEET_JSON_MAX_BYTES + 1);
	assert_int_equal(ask(answer, patience_s, &fleet, &error), CAU_IO);
	assert_non_null(strstr(error.reason, "longer than 65536 bytes"));
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_proxy_names_its_daemons),
		cmocka_unit_test(a_daemon_alone_is_no_fleet),
		cmocka_unit_test(trouble_is_told),
		cmocka_unit_test(more_than_a_fleet_needs_is_not_taken),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
