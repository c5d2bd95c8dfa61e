// SPDX-License-Identifier: GPL-3.0-or-later
// Allowances for expensive requests (creating sessions, restoring states, files). Each connection,
// each address, each role and the whole daemon has one. An allowance has as many requests as a
// minute allows, so a client that was quiet may use these at once. It refills evenly.
#pragma once

#include "cautery/messages.h"
#include "config/config.h"

enum { CAU_QUOTA_ADDRESS_BYTES = 64 };

typedef struct cau_quota cau_quota;

// An allowance; if zeroed, nothing has been taken yet.
typedef struct cau_allowance {
	double taken, seen_s;
} cau_allowance;

// A token that has a quota of its own, shared by all its connections.
typedef struct cau_quota_token {
	uint64_t grant;
	int64_t most; // requests a minute; 0: no quota of its own
} cau_quota_token;

cau_quota *cau_quota_create(const cau_config *config); // NULL if memory ran out
void cau_quota_destroy(cau_quota *quota);              // `quota` may be NULL

// Takes one request from each allowance that applies. If one of them is used up, takes none and
// returns CAU_LIMIT, with the setting that limits it and when to try again. `address` is text, ""
// if unknown. Any thread may call it; `connection` belongs to the caller, `token` may be NULL.
cau_status cau_quota_take(cau_quota *quota, cau_allowance *connection, const cau_quota_token *token,
                          const char *address, cau_role role, double now_s, cau_error *error);
