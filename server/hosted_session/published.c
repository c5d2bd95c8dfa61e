// SPDX-License-Identifier: GPL-3.0-or-later
#include "hosted_session/published.h"

#include <string.h>

#include "hosted_session/hosted.h"
#include "hosted_session/internal.h"

void cau_hosted_publish_summary(cau_hosted *h)
{
	cau_decided decided = cau_decisions_now(&h->decisions);
	cau_wire_session_summary now = {
		.state = h->creation.starting ? CAU_SESSION_STARTING : decided.state,
		.tick = (int64_t)h->core.tick,
		.time_s = (double)h->core.tick * h->identity.scene->step_s,
		.step_s = h->identity.scene->step_s,
		.speed = decided.speed,
		.realtime_factor = h->pace.realtime_factor,
		.vertex_count = h->core.info.vertex_count,
		.face_count = h->core.info.face_count,
		.tool_count = decided.drive_count,
		.epoch = h->frames.epoch,
		.has_fault = decided.state == CAU_SESSION_FAULTED && *decided.fault,
	};
	now.has_stored = h->identity.around->ephemeral; // `stored` stays false
	now.has_stage = *h->suspension.stage;
	snprintf(now.stage, sizeof now.stage, "%s", h->suspension.stage);
	memcpy(now.session, h->identity.id, sizeof now.session);
	memcpy(now.scene, h->identity.scene->name, sizeof now.scene);
	snprintf(now.fault, sizeof now.fault, "%.319s", decided.fault);
	pthread_mutex_lock(&h->published.lock);
	h->published.summary = now;
	h->published.counts.realtime_factor = h->pace.realtime_factor;
	pthread_mutex_unlock(&h->published.lock);
}

void cau_published_count(cau_hosted_published *published, const cau_hosted_counts *more)
{
	pthread_mutex_lock(&published->lock);
	cau_hosted_counts *counts = &published->counts;
	counts->steps += more->steps;
	counts->step_seconds += more->step_seconds;
	counts->energy_gain_j += more->energy_gain_j;
	counts->commands += more->commands;
	counts->motions += more->motions;
	counts->watchdog_cuts += more->watchdog_cuts;
	if (more->steps) {
		counts->contacts_left_out = more->contacts_left_out;
		counts->touching_cut_short = more->touching_cut_short;
		counts->resting = more->resting;
	}
	pthread_mutex_unlock(&published->lock);
}

void cau_hosted_summary(cau_hosted *h, cau_wire_session_summary *summary)
{
	cau_stream_counts streams; // counted now: subscribers join and leave without a slice
	cau_streams_count(&h->frames.streams, &streams);
	pthread_mutex_lock(&h->published.lock);
	*summary = h->published.summary;
	pthread_mutex_unlock(&h->published.lock);
	summary->subscriber_count = streams.subscribers;
}

void cau_hosted_count(cau_hosted *h, cau_hosted_counts *counts)
{
	cau_stream_counts streams;
	cau_streams_count(&h->frames.streams, &streams);
	pthread_mutex_lock(&h->published.lock);
	*counts = h->published.counts;
	pthread_mutex_unlock(&h->published.lock);
	pthread_mutex_lock(&h->refusals.lock);
	counts->refused = h->refusals.count;
	pthread_mutex_unlock(&h->refusals.lock);
	counts->frames = streams.frames;
	counts->frame_bytes = streams.frame_bytes;
	counts->key_frames = streams.key_frames;
	counts->half_rate = streams.half_rate;
}

// ---- tools --------------------------------------------------------------------------------------

void cau_hosted_publish_tools(cau_hosted *h)
{
	cau_frame frame;
	if (!h->core.session || h->creation.starting || h->life.ended)
		return;
	cau_session_frame(h->core.session, &frame);
	pthread_mutex_lock(&h->published.lock);
	h->published.tool_count = frame.tool_count;
	memcpy(h->published.tools, frame.tools, (size_t)frame.tool_count * sizeof *h->published.tools);
	h->published.tick = frame.tick;
	h->published.time_s = frame.time_s;
	pthread_mutex_unlock(&h->published.lock);
}

static void copy_tool(cau_hosted_decisions *decisions, const cau_tool_state *state,
                      cau_hosted_tool *tool)
{
	*tool = (cau_hosted_tool){
		.state = *state, .energized = state->energized, .energy_off = CAU_ENERGY_OFF_NEVER_ENABLED};
	cau_drive drive;
	if (!cau_decisions_find(decisions, state->name, &drive))
		return;
	tool->driver = drive.driver;
	tool->energy_off = drive.energy_off;
}

int32_t cau_hosted_tools(cau_hosted *h, cau_hosted_tool *tools, uint64_t *tick, double *time_s)
{
	cau_tool_state states[CAU_MAX_TOOLS];
	pthread_mutex_lock(&h->published.lock);
	int32_t count = h->published.tool_count;
	memcpy(states, h->published.tools, (size_t)count * sizeof *states);
	*tick = h->published.tick;
	*time_s = h->published.time_s;
	pthread_mutex_unlock(&h->published.lock);
	for (int32_t i = 0; i < count; i++)
		copy_tool(&h->decisions, &states[i], &tools[i]);
	return count;
}

bool cau_hosted_find_tool(cau_hosted *h, const char *name, cau_hosted_tool *tool)
{
	cau_tool_state state;
	bool found = false;
	pthread_mutex_lock(&h->published.lock);
	for (int32_t i = 0; i < h->published.tool_count && !found; i++)
		if (strcmp(h->published.tools[i].name, name) == 0) {
			state = h->published.tools[i];
			found = true;
		}
	pthread_mutex_unlock(&h->published.lock);
	if (found)
		copy_tool(&h->decisions, &state, tool);
	return found;
}
