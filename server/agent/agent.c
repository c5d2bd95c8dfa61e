// SPDX-License-Identifier: GPL-3.0-or-later
#include "agent/agent.h"

#include <errno.h>
#include <math.h>
#include <netdb.h>
#include <poll.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include "clock/clock.h"
#include "log/log.h"

// ---- load ---------------------------------------------------------------------------------------

static double free_share(double used, double most)
{
	return most > 0 ? 1 - used / most : 0;
}

int cau_load_free_percent(const cau_load *load)
{
	double sessions = free_share(load->session_count, load->session_count_most);
	double memory = free_share((double)load->session_bytes, (double)load->session_bytes_most);
	double least = fmin(fmin(sessions, memory), 1 - load->busy_share);
	double percent = 100 * least * fmin(1, load->pace_share_min);
	return (int)lround(fmin(100, fmax(1, percent)));
}

size_t cau_load_write(const cau_load *load, char line[CAU_LOAD_LINE_BYTES])
{
	int bytes = load->takes ? snprintf(line, CAU_LOAD_LINE_BYTES, "ready %d%%\n",
	                                   cau_load_free_percent(load))
	                        : snprintf(line, CAU_LOAD_LINE_BYTES, "drain\n");
	return (size_t)bytes;
}

// ---- agent --------------------------------------------------------------------------------------

enum {
	WAITING_PEERS = 64,   // connections waiting for accept; the system lets further ones wait
	ACCEPT_PAUSE_MS = 100 // pause after a failed accept, for example without free descriptors
};

struct cau_agent {
	cau_agent_def def;
	pthread_t thread;
	int socket, ending; // socket: listening socket; ending: eventfd that ends the thread
	bool started;
	double measured_s; // time when the line was made
	char line[CAU_LOAD_LINE_BYTES];
	size_t line_bytes;
};

// ---- one peer
static void measure(cau_agent *agent)
{
	cau_load load = {0};
	double now_s = cau_monotonic_s();
	if (now_s - agent->measured_s < CAU_AGENT_MEASURE_S)
		return;
	agent->def.measure(agent->def.user, &load);
	agent->line_bytes = cau_load_write(&load, agent->line);
	agent->measured_s = now_s;
}

// Sends the line to a peer and closes. The line fits into a new socket's buffer, so this never
// waits. The peer's bytes are read first: closing a socket with unread bytes resets it, and
// the line may be lost.
static void answer(cau_agent *agent, int peer)
{
	char ignored[512];
	measure(agent);
	ssize_t sent = send(peer, agent->line, agent->line_bytes, MSG_DONTWAIT | MSG_NOSIGNAL);
	if (sent >= 0 && shutdown(peer, SHUT_WR) == 0)
		recv(peer, ignored, sizeof ignored, MSG_DONTWAIT);
	close(peer);
}

// Returns whether the thread continues.
static bool wait_for_end(const cau_agent *agent, int patience_ms)
{
	struct pollfd ending = {.fd = agent->ending, .events = POLLIN};
	return poll(&ending, 1, patience_ms) <= 0;
}

static void *serve(void *argument)
{
	cau_agent *agent = argument;
	pthread_setname_np(pthread_self(), "cautery-agent");
	for (bool goes_on = true; goes_on;) {
		struct pollfd both[] = {{.fd = agent->socket, .events = POLLIN},
		                        {.fd = agent->ending, .events = POLLIN}};
		if (poll(both, 2, -1) < 0 || both[1].revents) {
			goes_on = errno == EINTR && !both[1].revents;
			continue;
		}
		int peer = accept4(agent->socket, NULL, NULL, SOCK_CLOEXEC | SOCK_NONBLOCK);
		if (peer >= 0)
			answer(agent, peer);
		// accept failed, for example because the peer has already gone: wait before the next accept
		else
			goes_on = wait_for_end(agent, ACCEPT_PAUSE_MS);
	}
	return NULL;
}

// ---- creating and destroying
static int listen_at(const struct addrinfo *at)
{
	int on = 1;
	int made = socket(at->ai_family, at->ai_socktype | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
	if (made < 0)
		return -1;
	setsockopt(made, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
	if (bind(made, at->ai_addr, at->ai_addrlen) == 0 && listen(made, WAITING_PEERS) == 0)
		return made;
	int reason = errno;
	close(made);
	errno = reason;
	return -1;
}

static cau_status open_socket(cau_agent *agent, cau_error *error)
{
	struct addrinfo hints = {.ai_socktype = SOCK_STREAM, .ai_flags = AI_PASSIVE}, *found = NULL;
	char port[8];
	snprintf(port, sizeof port, "%d", agent->def.port);
	int trouble = getaddrinfo(agent->def.address, port, &hints, &found);
	if (trouble)
		return cau_fail(error, CAU_IO, "agent_port", "%.60s: %s", agent->def.address,
		                gai_strerror(trouble));
	agent->socket = listen_at(found);
	int reason = errno;
	freeaddrinfo(found);
	if (agent->socket < 0)
		return cau_fail(error, CAU_IO, "agent_port", "cannot listen on %.60s port %d: %s",
		                agent->def.address, agent->def.port, strerror(reason));
	return CAU_OK;
}

cau_status cau_agent_create(cau_agent **made, const cau_agent_def *def, cau_error *error)
{
	*made = NULL;
	cau_agent *agent = calloc(1, sizeof *agent);
	if (!agent)
		return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for the agent");
	agent->def = *def;
	agent->socket = -1;
	agent->measured_s = -INFINITY;
	agent->ending = eventfd(0, EFD_CLOEXEC);
	cau_status status = agent->ending < 0
	                        ? cau_fail(error, CAU_IO, NULL, "cannot create the agent's eventfd: %s",
	                                   strerrordesc_np(errno))
	                        : open_socket(agent, error);
	if (!status) {
		int code = pthread_create(&agent->thread, NULL, serve, agent);
		agent->started = code == 0;
		if (code)
			status = cau_fail(error, CAU_NO_MEMORY, NULL,
			                  "cannot start the agent's thread: %s (its limit: ulimit -u)",
			                  strerrordesc_np(code));
	}
	if (status) {
		cau_agent_destroy(agent);
		return status;
	}
	cau_log(CAU_LOG_NOTICE, NULL, "agent_listening", "address=%s port=%d", def->address,
	        cau_agent_port(agent));
	*made = agent;
	return CAU_OK;
}

int cau_agent_port(const cau_agent *agent)
{
	char port[8] = "";
	struct sockaddr_storage address;
	socklen_t bytes = sizeof address;
	if (getsockname(agent->socket, (struct sockaddr *)&address, &bytes) == 0)
		getnameinfo((struct sockaddr *)&address, bytes, NULL, 0, port, sizeof port, NI_NUMERICSERV);
	return (int)strtol(port, NULL, 10);
}

void cau_agent_destroy(cau_agent *agent)
{
	if (!agent)
		return;
	if (agent->started) {
		eventfd_write(agent->ending, 1);
		pthread_join(agent->thread, NULL);
	}
	if (agent->socket >= 0)
		close(agent->socket);
	if (agent->ending >= 0)
		close(agent->ending);
	free(agent);
}
