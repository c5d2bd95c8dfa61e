// SPDX-License-Identifier: GPL-3.0-or-later
// Publishes cautery/session_status: at once after a change, and the running counts ten times a
// second.
#include <math.h>
#include <string.h>

#include "transport_dds/internal.h"

#define PERIOD_S 0.1
#define UNREAD_PERIOD_S 1.0 // time between writes while there are no readers, s; for late joiners

void cau_dds_fill_status(cautery_SessionStatus *status, const cau_wire_session_summary *summary,
                         uint32_t number, const cau_hosted_counts *counts)
{
	*status = (cautery_SessionStatus){
		.session_number = number,
		.state = (cautery_SessionState)summary->state,
		.tick = (uint64_t)summary->tick,
		.time_s = summary->time_s,
		.step_s = summary->step_s,
		.speed = summary->speed,
		.realtime_factor = summary->realtime_factor,
		.epoch = summary->epoch,
		.vertex_count = (uint32_t)summary->vertex_count,
		.face_count = (uint32_t)summary->face_count,
		.tool_count = (uint32_t)summary->tool_count,
		.subscriber_count = (uint32_t)summary->subscriber_count,
		.commands = counts->commands - counts->motions,
		.motions = counts->motions,
		.refused = counts->refused,
		.watchdog_cuts = counts->watchdog_cuts,
		.steps = counts->steps,
	};
	memcpy(status->session, summary->session, sizeof summary->session);
	memcpy(status->scene, summary->scene, sizeof summary->scene);
	if (summary->has_fault)
		memcpy(status->fault, summary->fault, sizeof summary->fault);
}

// True if readers must get the change at once.
static bool is_news(const cau_wire_session_summary *was, const cau_wire_session_summary *now)
{
	return was->state != now->state || was->epoch != now->epoch || was->speed != now->speed ||
	       was->tool_count != now->tool_count || was->subscriber_count != now->subscriber_count;
}

static bool counts_differ(const cau_hosted_counts *was, const cau_hosted_counts *now)
{
	return was->steps != now->steps || was->commands != now->commands ||
	       was->refused != now->refused || was->watchdog_cuts != now->watchdog_cuts;
}

static double period_of(dds_entity_t writer)
{
	dds_publication_matched_status_t matched = {0};
	dds_get_publication_matched_status(writer, &matched);
	return matched.current_count ? PERIOD_S : UNREAD_PERIOD_S;
}

double cau_dds_publish_status(cau_dds_session *session, double now_s)
{
	cau_dds_status *last = &session->status;
	cau_wire_session_summary summary;
	cau_hosted_counts counts;
	cautery_SessionStatus sample;
	cau_hosted_summary(session->hosted, &summary);
	cau_hosted_count(session->hosted, &counts);
	if (!*summary.session)
		return INFINITY; // the session is not built yet
	bool news = last->written_s == 0 || is_news(&last->summary, &summary);
	bool differs = news || last->summary.tick != summary.tick ||
	               last->summary.realtime_factor != summary.realtime_factor ||
	               counts_differ(&last->counts, &counts);
	if (!differs)
		return INFINITY;
	double due_s = last->written_s + period_of(session->status_writer);
	if (!news && now_s < due_s)
		return due_s;
	cau_dds_fill_status(&sample, &summary, cau_hosted_number(session->hosted), &counts);
	dds_write(session->status_writer, &sample);
	*last = (cau_dds_status){summary, counts, now_s};
	return INFINITY;
}
