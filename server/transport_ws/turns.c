// SPDX-License-Identifier: GPL-3.0-or-later
// Chooses the connection that is read next. Connections with input wait in a list. A turn is about
// a millisecond of processor time, charged to the connection's share (shares.h). Drivers go first,
// so that energy off and heartbeats do not wait behind other requests. Then comes the connection
// that has used the least. A connection whose share is used up waits until some is given back.
// Meanwhile epoll does not report it, and its messages stay in the socket.
#include <math.h>
#include <sys/epoll.h>

#include "clock/clock.h"
#include "transport_ws/internal.h"

// ---- when the thread did not run, to know when the bytes that it reads were sent
// least wait, s, of a message for its turn; a message that waited longer counts as sent before
#define WAITED_S 0.02

void cau_network_comes_round(cau_network *network)
{
	double now_s = cau_monotonic_s(), deadline_s = network->def.config->browser_deadline_s;
	if (network->ran_s > 0 && now_s - network->ran_s > deadline_s) {
		network->stopped_s = network->ran_s;
		network->stopped_until_s = now_s + deadline_s;
	}
	network->ran_s = now_s;
}

double cau_connection_sent_after_s(const cau_connection *c, double now_s)
{
	double after_s = cau_network_sent_after_s(c->network, now_s), sent_s = c->input.sent_after_s;
	return now_s - sent_s > WAITED_S ? fmin(after_s, sent_s) : after_s;
}

double cau_network_sent_after_s(const cau_network *network, double now_s)
{
	return now_s < network->stopped_until_s ? network->stopped_s : now_s;
}

// ---- turns
enum { EVENTS_AT_ONCE = 64 };

#define TURN_S 1e-3
#define ROUND_S 4e-3 // time for turns, s; libwebsockets then writes and checks for new input
// least wait for the next turns, s: libwebsockets does not sleep for less than a millisecond
#define REST_S 5e-3

// Returns how long the connection must wait for its turn. A closing connection does not wait:
// reading it to its end is cheap and short. A connection's first turn does not wait either: it
// costs less than the handshake before it. The first turn brings hello, which must not wait for
// time that other connections of its address have used.
static double wait_s(cau_connection *c, double now_s)
{
	double seconds = cau_share_wait_s(&c->turn.share, now_s);
	if (cau_turns_blocked(c))
		return INFINITY;
	return c->end.code || !cau_connection_has_spoken(c) ? 0 : seconds;
}

static cau_connection *find_next(const cau_network *network, double now_s)
{
	cau_connection *next = NULL;
	for (cau_connection *c = network->waiting; c; c = c->turn.next)
		if (wait_s(c, now_s) <= 0 &&
		    (!next || cau_share_precedes(&c->turn.share, &next->turn.share)))
			next = c;
	return next;
}

static void give_turn(cau_connection *c)
{
	double began_s = cau_thread_cpu_s();
	bool more = cau_connection_read(c, began_s + TURN_S);
	cau_share_charge(&c->turn.share, cau_thread_cpu_s() - began_s, cau_monotonic_s());
	if (!more) {
		cau_input_forget(c);
		cau_input_poll(c, true);
	}
}

static void run_again(lws_sorted_usec_list_t *turns);

// Plans the next turns. Waiting connections are not polled, because they are known to have input.
static void wait_for_turns(cau_network *network, double now_s)
{
	double soonest_s = INFINITY;
	for (cau_connection *c = network->waiting; c; c = c->turn.next) {
		cau_input_poll(c, false);
		soonest_s = fmin(soonest_s, wait_s(c, now_s));
	}
	if (soonest_s > 0)
		soonest_s = fmax(soonest_s, REST_S);
	lws_sul_schedule(network->context, 0, &network->turns, run_again,
	                 isinf(soonest_s) ? LWS_SET_TIMER_USEC_CANCEL
	                                  : 1 + (lws_usec_t)(soonest_s * LWS_US_PER_SEC));
}

static void give_turns(cau_network *network)
{
	double now_s = cau_monotonic_s(), until_s = now_s + ROUND_S;
	cau_connection *next = find_next(network, now_s);
	while (next && now_s < until_s) {
		give_turn(next);
		now_s = cau_monotonic_s();
		next = find_next(network, now_s);
	}
	wait_for_turns(network, now_s);
}

static void run_again(lws_sorted_usec_list_t *turns)
{
	cau_network *network = lws_container_of(turns, cau_network, turns);
	cau_network_comes_round(network);
	give_turns(network);
}

void cau_turns_resume(cau_connection *c)
{
	if (c->turn.waits && !cau_turns_blocked(c))
		lws_sul_schedule(c->network->context, 0, &c->network->turns, run_again, 1);
}

// Reads the connections that epoll reports. No connection is freed here: this function only
// requests that connections close, and libwebsockets' loop frees them.
int cau_input_callback(struct lws *wsi, enum lws_callback_reasons reason, void *user, void *in,
                       size_t bytes)
{
	(void)user, (void)in, (void)bytes;
	if (reason != LWS_CALLBACK_RAW_RX_FILE)
		return 0;
	cau_network_comes_round(cau_network_of(wsi));
	struct epoll_event events[EVENTS_AT_ONCE];
	int count = epoll_wait(cau_network_of(wsi)->input, events, EVENTS_AT_ONCE, 0);
	for (int i = 0; i < count; i++)
		cau_input_wait(events[i].data.ptr);
	give_turns(cau_network_of(wsi));
	return 0;
}
