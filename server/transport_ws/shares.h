// SPDX-License-Identifier: GPL-3.0-or-later
// How much processor time of the network thread each client may take. Time is measured while
// messages are handled and replies are written, and counted for the connection, for its address
// and for all clients of its standing. Each of the three has a share of one core. Time that was
// used is given back at that rate. So a client that was quiet may use BURST_S of its share at
// once. On the network thread.
#pragma once

#include <stdbool.h>

#include "config/role.h"

// What a client has proved. Each standing has shares of its own, so that viewers take nothing from
// drivers behind the same address.
typedef enum cau_standing {
	CAU_STANDING_UNKNOWN, // no hello yet
	CAU_STANDING_VIEWER,
	CAU_STANDING_DRIVER, // operate or admin
	CAU_STANDING_COUNT,
} cau_standing;

// Processor time, s; zeroed: none was used.
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
	cau_address_share *addresses; // with connections, or with time that is not given back yet
} cau_shares;

// A connection's.
typedef struct cau_share {
	cau_shares *shares; // NULL: closed
	cau_address_share *address;
	cau_standing standing;
	cau_time_used used;
} cau_share;

cau_standing cau_standing_of_role(cau_role role);
void cau_shares_finish(cau_shares *shares); // every share of it is closed

// False: no memory. The shares are borrowed, the address is copied.
bool cau_share_open(cau_shares *shares, cau_share *share, const char *address,
                    cau_standing standing, double now_s);
void cau_share_close(cau_share *share); // also a zeroed one
// The client has another standing from now on; without memory it keeps the old one.
void cau_share_promote(cau_share *share, cau_standing standing, double now_s);

void cau_share_charge(cau_share *share, double cpu_s, double now_s);
// Seconds until the client may use time again; 0: at once.
double cau_share_wait_s(cau_share *share, double now_s);
// Whether `share` goes before `other`: drivers before others, then whoever has used less. Both are
// up to date: cau_share_wait_s was called for them.
bool cau_share_precedes(const cau_share *share, const cau_share *other);
