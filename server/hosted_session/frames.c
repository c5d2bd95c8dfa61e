// SPDX-License-Identifier: GPL-3.0-or-later
// Fills frames from the core, and lets clients join streams.
#include <stdlib.h>
#include <string.h>

#include "hosted_session/internal.h"
#include "hosted_session/slice.h"

typedef struct showing {
	cau_hosted *hosted;
	cau_shown shown;
} showing;

static void add_drives(cau_hosted_decisions *decisions, cau_stream_tool *tools, int32_t count)
{
	for (int32_t i = 0; i < count; i++) {
		cau_drive drive = {.energy_off = CAU_ENERGY_OFF_NEVER_ENABLED};
		cau_decisions_find(decisions, tools[i].name, &drive);
		tools[i].driver = drive.driver.client;
		tools[i].frozen = drive.frozen;
		tools[i].energy_off = (uint8_t)drive.energy_off;
	}
}

static const cau_stream_sample *fill_sample(void *user)
{
	showing *p = user;
	cau_hosted *h = p->hosted;
	cau_shown *shown = &p->shown;
	int state = cau_decisions_state(&h->decisions);
	cau_show(h->core.session, shown);
	add_drives(&h->decisions, shown->tools, shown->frame.tool_count);
	shown->statistics.realtime_factor = (float)h->pace.realtime_factor;
	shown->statistics.step_cost_s = (float)h->pace.step_cost_s;
	shown->statistics.refused_commands = h->findings.refused_commands;
	shown->sample.flags = (uint16_t)((state == CAU_SESSION_PAUSED ? CAU_FRAME_PAUSED : 0) |
	                                 (state == CAU_SESSION_FAULTED ? CAU_FRAME_FAULTED : 0));
	return &shown->sample;
}

// Makes the core compute its costly channels only while a subscriber receives them.
static void follow_channels(cau_session *core, cau_streams *streams)
{
	cau_session_watch(core, cau_streams_watched(streams));
}

// False if no frame will show a waiting command, because there are no subscribers or no ticks.
static bool frame_is_near(cau_hosted_frames *frames, cau_hosted_decisions *decisions)
{
	cau_stream_counts streams;
	cau_streams_count(&frames->streams, &streams);
	return streams.subscribers && cau_decisions_state(decisions) == CAU_SESSION_RUNNING;
}

void cau_frames_publish(cau_hosted *h, double now_s)
{
	cau_error error = {0};
	showing p;
	bool made = false;
	p.hosted = h;
	follow_channels(h->core.session, &h->frames.streams);
	cau_decided decided = cau_decisions_now(&h->decisions);
	cau_stream_moment moment = {
		.now_s = now_s,
		.all = atomic_exchange(&h->frames.dirty,
	                           false), // later changes are published next time
		.moving = decided.state == CAU_SESSION_RUNNING || decided.steps_left,
		.sample = fill_sample,
		.user = &p,
	};
	if (cau_streams_publish(&h->frames.streams, &moment, &made, &error) &&
	    cau_decisions_state(&h->decisions) != CAU_SESSION_FAULTED)
		cau_hosted_fault(h, &error);
	if (made) {
		cau_pace_framed(&h->pace, h->identity.around->times);
		h->identity.around->sink.frames(h->identity.around->sink.user);
	} else if (h->pace.waiting_count && !frame_is_near(&h->frames, &h->decisions)) {
		h->pace.waiting_count = 0;
	}
}

void cau_frames_restart(cau_hosted_frames *frames)
{
	frames->epoch = cau_streams_restart(&frames->streams);
	frames->dirty = true;
}

// ---- subscribers
cau_stream_shape cau_frames_shape(const cau_session_info *info)
{
	return (cau_stream_shape){.vertex_count = info->vertex_count,
	                          .face_count = info->face_count,
	                          .face = info->face,
	                          .face_layer = info->face_layer,
	                          .texture = info->texture,
	                          .rest_position = info->rest_position};
}

static cau_status join(cau_hosted_frames *frames, const cau_session_info *info,
                       const cau_order *order, const cau_stream **stream, cau_error *error)
{
	bool woken = false;
	cau_stream_wish wish = {.rate_hz = order->as.join.rate_hz,
	                        .step_m = order->as.join.step_m,
	                        .plain = order->as.join.plain,
	                        .channels = order->as.join.channels};
	cau_stream_shape shape = cau_frames_shape(info);
	cau_status status = cau_streams_join(&frames->streams, &wish, &shape, stream, &woken, error);
	if (woken)
		frames->dirty = true;
	return status;
}

void cau_apply_join(cau_hosted *h, cau_order *order)
{
	cau_error error = {0};
	const cau_stream *stream = NULL;
	if (join(&h->frames, &h->core.info, order, &stream, &error)) {
		cau_answer_fail(order, &error, 0);
		return;
	}
	cau_wire_stream_description result = {.session_number = h->identity.number,
	                                      .profile = stream->def.profile,
	                                      .epoch = h->frames.epoch,
	                                      .rate_hz = stream->rate_hz,
	                                      .channels = stream->def.channels,
	                                      .vertex_count = stream->def.vertex_count,
	                                      .face_count = stream->def.face_count,
	                                      .step_m = stream->def.step_m,
	                                      .stress_step_pa = stream->def.stress_step_pa,
	                                      .has_plain = true,
	                                      .plain = stream->def.plain};
	memcpy(result.session, h->identity.id, sizeof result.session);
	memcpy(result.origin_m, stream->def.origin_m, sizeof result.origin_m);
	cau_outcome outcome = {.joined = h, .stream = stream->def.profile};
	char *text = cau_answer_text(order->reply.method, &result, &outcome.text_bytes, &error);
	outcome.text = text;
	outcome.error = text ? NULL : &error;
	if (!text)
		cau_hosted_leave(h, &(cau_subscriber){.stream = stream->def.profile});
	cau_reply_answer(&order->reply, &outcome);
	free(text);
	free(order);
}

cau_buffer *cau_hosted_next_frame(cau_hosted *h, cau_subscriber *sub, double now_s)
{
	bool wake;
	cau_buffer *buffer = cau_streams_next_frame(&h->frames.streams, sub, now_s, &wake);
	if (wake)
		cau_worker_pool_wake(h->identity.around->pool, &h->task);
	return buffer;
}

bool cau_hosted_has_frame(cau_hosted *h, const cau_subscriber *sub)
{
	return cau_streams_has_frame(&h->frames.streams, sub);
}

void cau_hosted_leave(cau_hosted *h, const cau_subscriber *sub)
{
	cau_streams_leave(&h->frames.streams, sub);
}
