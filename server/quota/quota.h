// SPDX-License-Identifier: GPL-3.0-or-later
// Allowances for requests that cost much (sessions made, states sought, files): each connection,
// each address, each role and the whole daemon have one. An allowance holds what a minute may ask
// for, so somebody who was quiet may ask for that much at once, and fills again evenly.
#pragma once

#include "cautery/messages.h"
#include "config/config.h"

enum { CAU_QUOTA_ADDRESS_BYTES = 64 };

typedef struct cau_quota cau_quota;

// Zeroed: nothing taken yet.
typedef struct cau_allowance {
	double taken, seen_s;
} cau_allowance;

// A token whose line has a quota of its own, for all its connections together.
typedef struct cau_quota_token {
	uint64_t grant;
	int64_t most; // a minute; 0: it has none
} cau_quota_token;

cau_quota *cau_quota_create(const cau_config *config); // NULL: no memory
void cau_quota_destroy(cau_quota *quota);              // takes NULL

// Takes one request from every allowance that it falls under, or from none: CAU_LIMIT, with the
// setting that bounds it and when to try again. `address` is text, "" if nobody knows it. From any
// thread; `connection` is the caller's own, `token` may be NULL.
cau_status cau_quota_take(cau_quota *quota, cau_allowance *connection, const cau_quota_token *token,
                          const char *address, cau_role role, double now_s, cau_error *error);
