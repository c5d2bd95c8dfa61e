// SPDX-License-Identifier: GPL-3.0-or-later
// Faults of one session: numerical trouble, and broken safety rules. Each stops this session alone.
#include <stdio.h>

#include "hosted_session/answer.h"
#include "hosted_session/energy.h"
#include "hosted_session/internal.h"

void cau_hosted_tell_fault(cau_hosted *h, const cau_error *error)
{
	cau_wire_session_faulted params = {.tick = (int64_t)h->core.tick};
	snprintf(params.session, sizeof params.session, "%s", h->identity.id);
	snprintf(params.reason, sizeof params.reason, "%.319s", error->reason);
	cau_timeline_add(&h->timeline, CAU_EVENT_FAULT, NULL, NULL, 0, error->reason);
	cau_answer_notify(&h->identity, (cau_audience){CAU_AUDIENCE_SESSION, h->identity.number},
	                  CAU_METHOD_SESSION_FAULTED, &params);
	h->frames.dirty = true;
}

void cau_hosted_fault(cau_hosted *h, const cau_error *error)
{
	cau_decide(h, &(cau_logic_event){.kind = CAU_LOGIC_FAULT,
	                                 .time_s = cau_monotonic_s(),
	                                 .cause = error->reason});
	h->pace.realtime_factor = 0; // it stands still, as a paused one does
	cau_hosted_tell_fault(h, error);
}

// The core would heat a tool that is not on by the machine's books. Nobody can say how that came
// about, so nothing of it goes on: all tools go dark, and the session is faulted, alone.
void cau_fault_stop_unsound(cau_hosted *h)
{
	cau_error error = {0};
	cau_frame frame;
	cau_session_frame(h->core.session, &frame);
	for (int32_t i = 0; i < frame.tool_count; i++)
		cau_energy_turn_off(h, frame.tools[i].name);
	cau_energy_turn_off(h, h->decisions.odd_tool); // which may be still to be added
	cau_fail(&error, CAU_FAULTED, "", "tool %s had energy on without an enable that counts",
	         h->decisions.odd_tool);
	cau_log(CAU_LOG_ERROR, h->identity.id, "energy_disagrees", "tick=%llu tool=%s",
	        (unsigned long long)h->core.tick, h->decisions.odd_tool);
	cau_decide_stepped(h, error.reason);
	cau_hosted_tell_fault(h, &error);
}

// A safety rule of the decisions was broken. They have faulted the session by themselves, and their
// cuts follow as ordinary acts.
void cau_fault_report_broken_rule(cau_hosted *h)
{
	cau_error error = {0};
	char reason[320];
	if (!cau_decisions_broken(&h->decisions, reason, sizeof reason))
		return;
	cau_fail(&error, CAU_FAULTED, "", "%s", reason);
	cau_log(CAU_LOG_ERROR, h->identity.id, "rule_broken", "tick=%llu rule=\"%s\"",
	        (unsigned long long)h->core.tick, reason);
	cau_hosted_tell_fault(h, &error);
}
