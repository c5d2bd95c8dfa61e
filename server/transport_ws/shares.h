// SPDX-License-Identifier: GPL-3.0-or-later
// Limits the processor time of the network thread that each client may take. Time is measured while
// messages are handled and replies are written. The time is charged three times: to the connection,
// to its address, and to all clients of its standing. Each of the three has a share of one core.
// Used time is given back at the rate of that share. So a client that was quiet may at once use the
// time of BURST_S of its share. Network thread only.
#pragma once

#include <stdbool.h>

#include "config/config.h"

// The proof of identity that a client has given. Each standing has shares of its own, so that
// viewers take no time from drivers behind the same address.
typedef enum cau_standing {
	CAU_STANDING_UNKNOWN, // no hello yet
	CAU_STANDING_VIEWER,
	CAU_STANDING_DRIVER, // operate or admin
	CAU_STANDING_COUNT,
} cau_standing;

// Processor time that was used and not given back yet, s. Zeroed: no time was used.
typedef struct cau_time_used {
	double used_s, seen_s;
} cau_time_used;

typedef struct cau_address_share {
	struct cau_address_share *next;
	char *address;
	cau_standing standing;
	int connections;
	cau_time_used used;
} cau_address_share;

typedef struct cau_shares {
	cau_time_used standings[CAU_STANDING_COUNT];
	// addresses that have connections, or time that is not given back yet
	cau_address_share *addresses;
} cau_shares;

// The share of a connection.
typedef struct cau_share {
	cau_shares *shares; // NULL if closed
	cau_address_share *address;
	cau_standing standing;
	cau_time_used used;
} cau_share;

cau_standing cau_standing_of_role(cau_role role);
void cau_shares_finish(cau_shares *shares); // every share must be closed before

// Opens a connection's share. Returns false if memory ran out. `shares` is borrowed, the address is
// copied.
bool cau_share_open(cau_shares *shares, cau_share *share, const char *address,
                    cau_standing standing, double now_s);
void cau_share_close(cau_share *share); // the share may be zeroed
// Gives the client another standing. If memory runs out, the client keeps its old standing.
void cau_share_promote(cau_share *share, cau_standing standing, double now_s);

void cau_share_charge(cau_share *share, double cpu_s, double now_s);
// Returns the seconds until the client may use time again; 0 if the client may do so at once.
double cau_share_wait_s(cau_share *share, double now_s);
// True if `share` goes before `other`. Drivers go before other clients; among equals, the client
// that has used less time goes first. Call cau_share_wait_s for both before, to bring them up to
// date.
bool cau_share_precedes(const cau_share *share, const cau_share *other);
