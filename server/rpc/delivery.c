// SPDX-License-Identifier: GPL-3.0-or-later
// Delivers the mailbox's messages to their connections, on the network thread.
#include <stdlib.h>
#include <string.h>

#include "rpc/internal.h"

// Starts to send a file. A slot is free: cau_peer_has_room_for_file checked this when the file was
// requested.
static void send_file(cau_peer *peer, cau_post *post)
{
	int i = 0;
	while (i < FILES_OF_PEER - 1 && peer->files[i].file)
		i++;
	cau_buffer_release(peer->files[i].file);
	peer->files[i] = (cau_outgoing){post->file, post->transfer, 0};
	post->file = NULL;
}

// Refuses a join that the session accepted, because the connection has the largest number of
// streams.
static void refuse_join(cau_peer *peer, cau_post *post)
{
	cau_error error = {0};
	cau_rpc_fault fault;
	cau_fail(&error, CAU_LIMIT, "",
	         "the connection has %d streams: leave one, or open another connection",
	         STREAMS_OF_PEER);
	cau_rpc_fault_of_error(&fault, &error);
	cau_peer_fault(peer, &post->id, &fault);
	cau_hosted_leave(post->joined, &(cau_subscriber){.stream = post->stream});
	cau_hosted_release(post->joined);
}

static void deliver_answer(cau_service *service, cau_post *post)
{
	cau_connection *connection = cau_network_find(service->network, post->connection);
	if (post->joined && connection && !cau_peer_has_room(cau_peer_of(connection), post->joined)) {
		refuse_join(cau_peer_of(connection), post);
		return;
	}
	if (connection && cau_method_describe(post->method)->cost == CAU_COST_FILE)
		cau_peer_of(connection)->files_asked--;
	if (connection && post->text) {
		cau_connection_send(connection, post->text);
		post->text = NULL;
		if (post->file)
			send_file(cau_peer_of(connection), post);
	}
	if (post->joined && connection) {
		cau_peer_join(cau_peer_of(connection), post->joined, post->stream);
	} else if (post->joined) {
		cau_hosted_leave(post->joined, &(cau_subscriber){.stream = post->stream});
		cau_hosted_release(post->joined);
	}
}

static bool listens(const cau_peer *peer, cau_audience audience)
{
	if (!peer->greeted || audience.kind == CAU_AUDIENCE_EVERYBODY)
		return peer->greeted;
	if (audience.kind == CAU_AUDIENCE_CLIENT)
		return peer->client.asker.client == audience.id;
	for (int i = 0; i < STREAMS_OF_PEER; i++)
		if (peer->streams[i].hosted && cau_hosted_number(peer->streams[i].hosted) == audience.id)
			return true;
	return false;
}

// True if the peer may receive the notice. A notice to all is about a created or destroyed session.
// A peer whose token is for some sessions gets only notices about these.
static bool may_know(const cau_peer *peer, const cau_post *post)
{
	static const char member[] = "\"session\":\"";
	char session[CAU_NAME_BYTES];
	if (post->audience.kind != CAU_AUDIENCE_EVERYBODY || !*peer->bounds.sessions)
		return true;
	const char *text = (const char *)cau_buffer_bytes(post->text);
	const char *end = text + post->text->byte_count;
	const char *found = memmem(text, post->text->byte_count, member, sizeof member - 1);
	if (!found)
		return false;
	const char *from = found + sizeof member - 1;
	const char *quote = memchr(from, '"', (size_t)(end - from));
	if (!quote || quote - from >= (ptrdiff_t)sizeof session)
		return false;
	snprintf(session, sizeof session, "%.*s", (int)(quote - from), from);
	return cau_auth_session_allowed(&peer->bounds, session);
}

// Sends a copy of the notice to each listener, because each listener's queue needs a node of its
// own. Notices are small.
static void deliver_notice(cau_service *service, cau_post *post)
{
	for (cau_connection *c = cau_network_first(service->network); c; c = c->next) {
		if (!listens(cau_peer_of(c), post->audience) || !may_know(cau_peer_of(c), post))
			continue;
		cau_buffer *copy = cau_buffer_create(post->text->byte_count, false);
		if (copy)
			memcpy(cau_buffer_bytes(copy), cau_buffer_bytes(post->text), copy->byte_count);
		cau_connection_send(c, copy);
	}
}

void cau_service_read_posts(cau_service *service)
{
	pthread_mutex_lock(&service->mutex);
	cau_post *post = service->first;
	service->first = service->last = NULL;
	pthread_mutex_unlock(&service->mutex);
	for (cau_post *next; post; post = next) {
		next = post->next;
		if (post->kind == POST_ANSWER)
			deliver_answer(service, post);
		else
			deliver_notice(service, post);
		cau_buffer_release(post->text);
		cau_buffer_release(post->file);
		free(post);
	}
}
