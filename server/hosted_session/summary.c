// SPDX-License-Identifier: GPL-3.0-or-later
// What other threads may know of a session at any time.
#include <string.h>

#include "hosted_session/internal.h"

void cau_hosted_publish_summary(cau_hosted *h)
{
	cau_decided decided = cau_decided_now(h);
	cau_wire_session_summary now = {
		.state = h->starting ? CAU_SESSION_STARTING : decided.state,
		.tick = (int64_t)h->tick,
		.time_s = (double)h->tick * h->scene->step_s,
		.step_s = h->scene->step_s,
		.speed = decided.speed,
		.realtime_factor = h->realtime_factor,
		.vertex_count = h->info.vertex_count,
		.face_count = h->info.face_count,
		.tool_count = decided.drive_count,
		.epoch = h->epoch,
		.has_fault = decided.state == CAU_SESSION_FAULTED && *decided.fault,
	};
	now.has_stored = h->around->ephemeral; // and false
	now.has_stage = *h->stage;
	snprintf(now.stage, sizeof now.stage, "%s", h->stage);
	memcpy(now.session, h->id, sizeof now.session);
	memcpy(now.scene, h->scene->name, sizeof now.scene);
	snprintf(now.fault, sizeof now.fault, "%.319s", decided.fault);
	pthread_mutex_lock(&h->mutex);
	h->summary = now;
	h->counts.realtime_factor = h->realtime_factor;
	pthread_mutex_unlock(&h->mutex);
}

void cau_hosted_summary(cau_hosted *h, cau_wire_session_summary *summary)
{
	cau_stream_counts streams; // subscribers come and go without a slice
	cau_streams_count(&h->streams, &streams);
	pthread_mutex_lock(&h->mutex);
	*summary = h->summary;
	pthread_mutex_unlock(&h->mutex);
	summary->subscriber_count = streams.subscribers;
}

void cau_hosted_count(cau_hosted *h, cau_hosted_counts *counts)
{
	cau_stream_counts streams;
	cau_streams_count(&h->streams, &streams);
	pthread_mutex_lock(&h->mutex);
	*counts = h->counts;
	pthread_mutex_unlock(&h->mutex);
	counts->frames = streams.frames;
	counts->frame_bytes = streams.frame_bytes;
	counts->key_frames = streams.key_frames;
	counts->half_rate = streams.half_rate;
}
