// SPDX-License-Identifier: GPL-3.0-or-later
// Who may do what: tokens with roles, and the checks of Host and Origin that keep web pages of
// others from driving the daemon.
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "cautery/message_choices.h"
#include "cautery/status.h"
#include "config/config.h"

typedef struct cau_auth cau_auth;

enum { CAU_AUTH_NAME_BYTES = 48, CAU_AUTH_OWNER_BYTES = 80, CAU_AUTH_SESSIONS_BYTES = 152 };

// What a token's line bounds besides its role.
typedef struct cau_auth_bounds {
	// Ids of sessions, separated by commas, each perhaps with a `*` at its end for all that begin
	// so; "": every session.
	char sessions[CAU_AUTH_SESSIONS_BYTES];
	int64_t quota; // expensive requests a minute of all its connections; 0: it has none of its own
} cau_auth_bounds;

// Reads the file of tokens if the settings name one: a line each, `#` starts a comment,
//
//     ROLE sha256:HASH [name=N] [expires=2027-01-31T12:00:00Z] [sessions=d1-anna-*,d1-demo]
//                      [quota=60]
//
// or a token of 16 to 128 printable characters in the place of its hash. Only hashes are kept. A
// file that others than its owner can read is refused.
cau_status cau_auth_create(cau_auth **auth, const cau_config *config, cau_error *error);
void cau_auth_destroy(cau_auth *auth); // takes NULL
// Reads the file of tokens anew. On failure the tokens stay as they were; the error says which line
// of which file is wrong. Any thread, like all functions below.
cau_status cau_auth_reload(cau_auth *auth, const cau_config *config, cau_error *error);

// The role of a token (not zero-ended); false if it has none. Without a file of tokens everyone is
// admin, with or without a token. Takes the same time for every wrong token of a length.
bool cau_auth_role(const cau_auth *auth, const char *token, size_t bytes, cau_role *role);

// What a connection remembers of the token that it came with: a number that no other token gets.
// 0: the token has no role.
uint64_t cau_auth_grant(const cau_auth *auth, const char *token, size_t bytes);
// The role that the token behind a grant has now; false if it was taken back or has expired.
bool cau_auth_grant_role(const cau_auth *auth, uint64_t grant, cau_role *role);
// Who owns the token, in a word for machines: the name of its line, else its hash. Tokens of one
// name have one owner. "": no token is asked for, or it was taken back.
void cau_auth_grant_owner(const cau_auth *auth, uint64_t grant, char owner[CAU_AUTH_OWNER_BYTES]);
// Whose token it is, by its line; "": not said.
void cau_auth_grant_name(const cau_auth *auth, uint64_t grant, char name[CAU_AUTH_NAME_BYTES]);

// False if it was taken back or has expired; without a file of tokens nothing is bounded.
bool cau_auth_grant_bounds(const cau_auth *auth, uint64_t grant, cau_auth_bounds *bounds);
// Whether the session is one of those; "" is none of a list's.
bool cau_auth_session_allowed(const cau_auth_bounds *bounds, const char *session);
// Whether a token may read what tells of all sessions.
bool cau_auth_sees_all(const cau_auth *auth, const char *token, size_t bytes);

// Whether requests must carry a token.
bool cau_auth_required(const cau_auth *auth);

// Whether a Host header names this daemon: loopback names and the listening address, each with the
// listening port or none, and what the settings add.
bool cau_auth_host_allowed(const cau_config *config, const char *host);
// Whether an Origin header is this daemon's own page (same host and port as `host`) or one that the
// settings add. An absent one (NULL or "") is no browser and passes.
bool cau_auth_origin_allowed(const cau_config *config, const char *origin, const char *host);

// Who a connection is from: `address` holds its peer's, and is replaced by what the X-Forwarded-For
// header says (NULL: there is none) where the peer is one of the settings' trusted_proxies. An IPv4
// address that is mapped into IPv6 becomes one of IPv4.
void cau_auth_find_address(const cau_config *config, const char *forwarded, char *address,
                           size_t capacity);
