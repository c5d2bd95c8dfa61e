// SPDX-License-Identifier: GPL-3.0-or-later
// Access: tokens with roles, and the checks of Host and Origin that keep foreign web pages from
// driving the daemon.
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "cautery/message_choices.h"
#include "cautery/status.h"
#include "config/config.h"

typedef struct cau_auth cau_auth;

enum { CAU_AUTH_NAME_BYTES = 48, CAU_AUTH_OWNER_BYTES = 80, CAU_AUTH_SESSIONS_BYTES = 152 };

// The limits in a token's line, besides its role.
typedef struct cau_auth_bounds {
	// Ids of sessions, separated by commas. A `*` at the end of an entry stands for all ids with
	// that beginning. "": every session.
	char sessions[CAU_AUTH_SESSIONS_BYTES];
	// largest number of expensive requests a minute, of all the token's connections together; 0:
	// the token has no quota of its own
	int64_t quota;
} cau_auth_bounds;

// Reads the file of tokens if the settings name one. Each line is one token; `#` starts a comment:
//
//     ROLE sha256:HASH [name=N] [expires=2027-01-31T12:00:00Z] [sessions=d1-anna-*,d1-demo]
//                      [quota=60]
//
// A token of 16 to 128 printable characters may replace its hash. Only hashes are kept. A file that
// users other than its owner can read is refused.
cau_status cau_auth_create(cau_auth **auth, const cau_config *config, cau_error *error);
void cau_auth_destroy(cau_auth *auth); // `auth` may be NULL
// Reads the file of tokens again. On failure the tokens stay as they were, and the error names the
// file and line. Any thread may call this and all functions below.
cau_status cau_auth_reload(cau_auth *auth, const cau_config *config, cau_error *error);

// Finds the role of a token (without a zero at its end). Returns false if the token has none.
// Without a file of tokens everyone is admin, with or without a token. Takes the same time for
// every wrong token of the same length.
bool cau_auth_role(const cau_auth *auth, const char *token, size_t bytes, cau_role *role);

// Returns the token's grant, a number that no other token gets; a connection keeps it. 0: the token
// has no role.
uint64_t cau_auth_grant(const cau_auth *auth, const char *token, size_t bytes);
// Finds the present role of the token behind a grant. Returns false if the token was revoked or has
// expired.
bool cau_auth_grant_role(const cau_auth *auth, uint64_t grant, cau_role *role);
// Finds the token's owner, in a form for programs: the name in its line, else its hash. Tokens with
// the same name have the same owner. "": no token is required, or it was revoked.
void cau_auth_grant_owner(const cau_auth *auth, uint64_t grant, char owner[CAU_AUTH_OWNER_BYTES]);
// Finds the name in the token's line; "" if the line has none.
void cau_auth_grant_name(const cau_auth *auth, uint64_t grant, char name[CAU_AUTH_NAME_BYTES]);

// Finds the limits of the token. Returns false if it was revoked or has expired. Without a file of
// tokens there are no limits.
bool cau_auth_grant_bounds(const cau_auth *auth, uint64_t grant, cau_auth_bounds *bounds);
// True if the limits allow the session. The empty id is in no list.
bool cau_auth_session_allowed(const cau_auth_bounds *bounds, const char *session);
// True if a token may read what concerns all sessions.
bool cau_auth_sees_all(const cau_auth *auth, const char *token, size_t bytes);

// True if requests must have a token.
bool cau_auth_required(const cau_auth *auth);

// True if a Host header names this daemon. Allowed are the loopback names and the listening
// address, each with the listening port or no port, and the names in the settings.
bool cau_auth_host_allowed(const cau_config *config, const char *host);
// True if an Origin header names this daemon's own page (same host and port as `host`) or an origin
// in the settings. A missing header (NULL or "") is accepted, because the client is not a browser.
bool cau_auth_origin_allowed(const cau_config *config, const char *origin, const char *host);

// Finds the client's address. `address` has the peer's address. If the peer is one of the
// trusted_proxies in the settings, it is replaced by the address in the X-Forwarded-For header
// (NULL: no header). An IPv4 address mapped into IPv6 becomes an IPv4 address.
void cau_auth_find_address(const cau_config *config, const char *forwarded, char *address,
                           size_t capacity);

// True if `text` is one of the comma-separated names in `list`, ignoring case.
bool cau_list_has(const char *list, const char *text);
