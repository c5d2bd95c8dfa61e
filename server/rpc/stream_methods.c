// SPDX-License-Identifier: GPL-3.0-or-later
// Streams of a connection: joining, choosing the next frame, and handling a slow reader.
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "rpc/internal.h"

static cau_subscription *find(cau_peer *peer, const cau_hosted *hosted)
{
	for (int i = 0; i < STREAMS_OF_PEER; i++)
		if (peer->streams[i].hosted == hosted)
			return &peer->streams[i];
	return NULL;
}

static void close_subscription(cau_subscription *stream)
{
	if (!stream->hosted)
		return;
	cau_hosted_leave(stream->hosted, &stream->subscriber);
	cau_hosted_release(stream->hosted);
	*stream = (cau_subscription){0};
}

void cau_call_session_join(cau_call *call)
{
	cau_wire_session_join params = {0};
	cau_stream_def defaults = cau_default_stream_def();
	cau_order *order = cau_call_order_with(call, CAU_ORDER_JOIN, &params);
	if (!order)
		return;
	order->as.join.rate_hz = params.has_rate_hz ? params.rate_hz : 60;
	order->as.join.step_m = params.has_step_m ? params.step_m : defaults.step_m;
	order->as.join.plain = params.has_plain && params.plain;
	order->as.join.channels = params.has_channels ? params.channels : defaults.channels;
	cau_call_submit(call, order);
}

bool cau_peer_has_room(cau_peer *peer, const cau_hosted *hosted)
{
	return find(peer, hosted) || find(peer, NULL);
}

void cau_peer_join(cau_peer *peer, cau_hosted *hosted, int32_t stream)
{
	cau_subscription *slot = find(peer, hosted);
	if (slot)
		close_subscription(slot);
	else
		slot = find(peer, NULL); // the caller has checked that a slot is free
	*slot = (cau_subscription){hosted, {.stream = stream, .key_asked_s = -INFINITY}};
	cau_connection_want_frame(peer->connection);
}

// Returns the subscription to the call's session. On failure answers the call and returns NULL.
static cau_subscription *subscription_of(cau_call *call)
{
	cau_error error = {0};
	cau_hosted *hosted = cau_call_session(call);
	if (!hosted)
		return NULL;
	cau_subscription *stream = find(call->peer, hosted);
	cau_hosted_release(hosted);
	if (!stream) {
		cau_fail(&error, CAU_BAD_STATE, "", "this connection has not joined the session");
		cau_call_fail(call, &error, 0);
	}
	return stream;
}

void cau_call_session_leave(cau_call *call)
{
	cau_wire_nothing result = {0};
	cau_subscription *stream = subscription_of(call);
	if (!stream)
		return;
	close_subscription(stream);
	cau_call_result(call, &result);
}

void cau_call_stream_key_frame(cau_call *call)
{
	cau_wire_nothing result = {0};
	cau_subscription *stream = subscription_of(call);
	if (!stream)
		return;
	stream->subscriber.wants_key = true;
	stream->subscriber.has_key = false;
	cau_connection_want_frame(call->peer->connection);
	cau_call_result(call, &result);
}

void cau_call_stream_ack(cau_call *call)
{
	cau_error error = {0};
	cau_wire_stream_ack params = {0};
	cau_subscription *stream = subscription_of(call);
	if (!stream || cau_rpc_params(call->message, &params, &error))
		return;
	cau_streams_acknowledge(&stream->subscriber, params.epoch, (uint64_t)params.sequence);
	cau_connection_want_frame(call->peer->connection);
}

cau_buffer *cau_peer_next_frame(cau_peer *peer)
{
	double now_s = cau_monotonic_s();
	for (int i = 0; i < STREAMS_OF_PEER; i++) {
		cau_subscription *stream = &peer->streams[(peer->next_stream + i) % STREAMS_OF_PEER];
		if (!stream->hosted)
			continue;
		if (cau_hosted_ended(stream->hosted)) {
			close_subscription(stream);
			continue;
		}
		cau_buffer *frame = cau_hosted_next_frame(stream->hosted, &stream->subscriber, now_s);
		if (!frame)
			continue;
		stream->subscriber.waiting_since_s = 0;
		peer->next_stream = (peer->next_stream + i + 1) % STREAMS_OF_PEER;
		return frame;
	}
	return cau_peer_next_chunk(peer);
}

bool cau_peer_has_frames(const cau_peer *peer)
{
	for (int i = 0; i < STREAMS_OF_PEER; i++)
		if (peer->streams[i].hosted &&
		    cau_hosted_has_frame(peer->streams[i].hosted, &peer->streams[i].subscriber))
			return true;
	return false;
}

void cau_peer_watch_slowness(cau_peer *peer, double now_s)
{
	for (int i = 0; i < STREAMS_OF_PEER; i++) {
		cau_subscription *stream = &peer->streams[i];
		if (!stream->hosted || !cau_hosted_has_frame(stream->hosted, &stream->subscriber)) {
			stream->subscriber.waiting_since_s = 0;
			continue;
		}
		if (stream->subscriber.waiting_since_s == 0)
			stream->subscriber.waiting_since_s = now_s;
		if (now_s - stream->subscriber.waiting_since_s > peer->service->config->slow_close_s)
			cau_connection_close(peer->connection, CAU_CLOSE_TOO_SLOW, NULL);
	}
}
