// SPDX-License-Identifier: Apache-2.0
// Follows a session that has moved to another daemon. The client closes its connection and connects
// to the new daemon. There it resumes its tools, joins its streams again, and resends requests that
// were answered with `moved`. From then on the old session id means the new id.
#include <stdlib.h>
#include <string.h>

#include "library/internal.h"

enum { PATTERN_BYTES = 16 + CAU_NAME_BYTES };

// Longest wait until the target daemon serves the session, s. After a longer time the program that
// moves the session has died.
#define ARRIVES_MOST_S 30.

// ---- session ids in message texts ---------------------------------------------------------------

static size_t member(char text[PATTERN_BYTES], const char *session)
{
	return (size_t)snprintf(text, PATTERN_BYTES, "\"session\":\"%s\"", session);
}

// Quotes within a string are written as \", so the pattern matches only the member `session`
// itself.
char *cau_follow_text(const char *from, const char *to, const char *text, size_t *bytes)
{
	char old[PATTERN_BYTES], new[PATTERN_BYTES];
	size_t old_bytes = member(old, from), new_bytes = member(new, to);
	const char *found = *from ? memmem(text, *bytes, old, old_bytes) : NULL;
	if (!found)
		return NULL;
	size_t head = (size_t)(found - text), tail = *bytes - head - old_bytes;
	char *made = malloc(head + new_bytes + tail + 1);
	if (!made)
		return NULL;
	memcpy(made, text, head);
	memcpy(made + head, new, new_bytes);
	memcpy(made + head + new_bytes, found + old_bytes, tail);
	*bytes = head + new_bytes + tail;
	made[*bytes] = 0;
	return made;
}

static void rename_pending(cau_client *client, const char *from, const char *to)
{
	for (cau_client_pending **link = &client->first_pending; *link; link = &(*link)->next) {
		cau_client_pending *pending = *link;
		size_t bytes = pending->byte_count;
		char *text = cau_follow_text(from, to, pending->text, &bytes);
		cau_client_pending *made = text ? malloc(sizeof *made + bytes + 1) : NULL;
		if (made) {
			*made = *pending;
			memcpy(made->text, text, bytes + 1);
			made->byte_count = bytes;
			*link = made;
			if (client->last_pending == pending)
				client->last_pending = made;
			free(pending);
		}
		free(text);
	}
}

// ---- whether to follow --------------------------------------------------------------------------

// True if the client uses no other session. A connection leads to one daemon, so a client with
// streams of other sessions does not follow.
static bool is_about(const cau_client *client, const char *session)
{
	if (*client->session && strcmp(client->session, session) != 0)
		return false;
	for (int i = 0; i < CAU_CLIENT_STREAMS_MAX; i++) {
		const cau_client_slot *slot = client->slots[i];
		if (slot && !slot->stream.ended && slot->wanted.has_session &&
		    strcmp(slot->wanted.session, session) != 0 &&
		    strcmp(slot->stream.description.session, session) != 0)
			return false;
	}
	return true;
}

// Reads the target's URL. Refuses a URL without TLS if the present one has TLS, because the token
// would be sent unencrypted.
static bool read_url(const cau_client *client, const char *text, cau_url *url)
{
	*url = client->url;
	return !*text || (!cau_url_read(text, url, NULL) && (url->tls || !client->url.tls));
}

static void rename_sessions(cau_client *client, const char *from, const char *to)
{
	snprintf(client->follow.from, sizeof client->follow.from, "%s", from);
	snprintf(client->follow.to, sizeof client->follow.to, "%s", to);
	snprintf(client->session, sizeof client->session, "%s", to); // A proxy routes by the session.
	for (int i = 0; i < CAU_CLIENT_STREAMS_MAX; i++) {
		cau_client_slot *slot = client->slots[i];
		if (slot && slot->wanted.has_session && strcmp(slot->wanted.session, from) == 0)
			snprintf(slot->wanted.session, sizeof slot->wanted.session, "%s", to);
	}
}

bool cau_follow(cau_client *client, const char *from, const char *to, const char *url)
{
	cau_url found;
	if (client->follow.now && strcmp(client->follow.to, to) == 0) {
		rename_pending(client, from, to);
		cau_follow_when_answered(client);
		return true;
	}
	if (client->follow.now || !client->def.follow || !*to || strcmp(from, to) == 0 ||
	    !is_about(client, from) || !read_url(client, url, &found))
		return false;
	// The program knows only the first id of a session that moved several times.
	char first[CAU_NAME_BYTES];
	snprintf(first, sizeof first, "%s",
	         strcmp(client->follow.to, from) == 0 ? client->follow.from : from);
	rename_sessions(client, from, to);
	rename_pending(client, from, to);
	snprintf(client->follow.from, sizeof client->follow.from, "%s", first);
	client->url = found;
	client->follow.now = true;
	client->follow.ways = 0;
	client->follow.arrives_until_s = cau_client_now() + ARRIVES_MOST_S;
	if (!*client->follow.kept_resume)
		snprintf(client->follow.kept_resume, sizeof client->follow.kept_resume, "%s",
		         client->server.resume);
	cau_follow_when_answered(client);
	return true;
}

// Closes the connection once every pending request can be sent again to the new daemon. The old
// daemon answers all other requests at once, with `moved`.
void cau_follow_when_answered(cau_client *client)
{
	for (const cau_client_pending *p = client->first_pending; p; p = p->next)
		if (!p->again && !p->resendable)
			return;
	snprintf(client->close_reason, sizeof client->close_reason, "the session has moved");
	cau_socket_cut(client);
}

// True if the new daemon does not serve the session yet, so the client asks again. Until the
// session is found, tools are resumed with the old daemon's resume token.
static bool goes_again(cau_client *client, const char *session, const cau_rpc_fault *fault)
{
	bool arrives = fault->code == CAU_RPC_NOT_HERE && *client->follow.to &&
	               strcmp(session, client->follow.to) == 0 &&
	               cau_client_now() < client->follow.arrives_until_s;
	if (!arrives)
		return false;
	if (!client->follow.now)
		client->follow.ways++;
	client->follow.now = true;
	cau_follow_when_answered(client);
	return true;
}

void cau_follow_found(cau_client *client)
{
	if (!client->follow.now)
		client->follow.kept_resume[0] = 0;
}

// ---- what shows that a session has moved --------------------------------------------------------

static void session_of(const cau_client *client, const cau_client_pending *pending,
                       char session[CAU_NAME_BYTES])
{
	cau_rpc_message message;
	cau_rpc_fault fault;
	cau_rpc_envelope envelope = {0};
	snprintf(session, CAU_NAME_BYTES, "%s", client->session);
	if (cau_rpc_read(pending->text, pending->byte_count, CAU_CLIENT_TEXT_MAX, &message, &fault))
		return;
	if (!cau_rpc_envelope_read(&message, &envelope, NULL) && envelope.has_session)
		snprintf(session, CAU_NAME_BYTES, "%s", envelope.session);
	cau_rpc_finish(&message);
}

bool cau_follow_answer(cau_client *client, cau_client_pending *pending, const cau_rpc_fault *fault)
{
	char session[CAU_NAME_BYTES];
	bool moved = fault->code == CAU_RPC_MOVED && *fault->moved_to;
	if ((!moved && fault->code != CAU_RPC_NOT_HERE) || pending->method == CAU_METHOD_SESSION_JOIN)
		return false;
	session_of(client, pending, session);
	// The daemon refused the request, so it may be sent again.
	pending->again = pending->resendable = true;
	cau_pending_add(client, pending);
	if (moved ? cau_follow(client, session, fault->moved_to, fault->url)
	          : goes_again(client, session, fault))
		return true;
	cau_pending_take(client, pending->id);
	return false;
}

// True if the client follows the session or asks again. All streams are then joined again, so the
// refused join needs no further handling.
bool cau_follow_join(cau_client *client, const char *session, const cau_rpc_fault *fault)
{
	if (fault->code == CAU_RPC_MOVED && *fault->moved_to)
		return cau_follow(client, session, fault->moved_to, fault->url);
	return goes_again(client, session, fault);
}

void cau_follow_change(cau_client *client, const cau_wire_session_changed *changed)
{
	bool mine = *client->session && strcmp(client->session, changed->summary.session) == 0;
	for (int i = 0; i < CAU_CLIENT_STREAMS_MAX && !mine; i++) {
		const cau_client_slot *slot = client->slots[i];
		mine = slot && !slot->stream.ended &&
		       strcmp(slot->stream.description.session, changed->summary.session) == 0;
	}
	if (mine && changed->has_moved_to)
		cau_follow(client, changed->summary.session, changed->moved_to, changed->target);
}

bool cau_client_follows(const cau_client *client)
{
	return client->follow.now;
}

const char *cau_client_called(const cau_client *client, const char *session)
{
	bool moved = *client->follow.from && strcmp(client->follow.from, session) == 0;
	return moved ? client->follow.to : session;
}
