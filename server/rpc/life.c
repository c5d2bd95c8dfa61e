// SPDX-License-Identifier: GPL-3.0-or-later
// The time of a peer's newest sign of life.
#include "rpc/internal.h"

double cau_peer_alive_s(const cau_peer *peer)
{
	return peer->sign.clocked ? peer->sign.alive_s
	                          : cau_connection_sent_after_s(peer->connection, cau_monotonic_s());
}

// Notes the peer's clock. A heartbeat that may have waited for a long time is not used as the first
// heartbeat, because nothing shows how long it waited.
void cau_peer_hear_clock(cau_peer *peer, int64_t client_time_us)
{
	double now_s = cau_monotonic_s();
	if (peer->sign.clocked || cau_connection_sent_after_s(peer->connection, now_s) >= now_s)
		cau_sign_of_life_hear(&peer->sign, now_s, 1e-6 * (double)client_time_us,
		                      peer->client.asker.deadline_s);
}
