// SPDX-License-Identifier: GPL-3.0-or-later
// Notes when the network thread did not run, to know when the bytes that it reads were sent.
#include "clock/clock.h"
#include "transport_ws/internal.h"

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
