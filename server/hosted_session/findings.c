// SPDX-License-Identifier: GPL-3.0-or-later
#include "hosted_session/timeline.h"

#include <stdio.h>

#include "hosted_session/internal.h"
#include "hosted_session/slice.h"

#define GAIN_MOST 0.01 // largest energy gain that is not reported, relative to the tick's energy

// Fewest ticks between two reports of an energy gain. One report in ten seconds is enough.
enum { GAIN_QUIET_TICKS = 600 };

void cau_findings_know(cau_hosted_findings *findings, const cau_session *core)
{
	cau_frame frame;
	cau_session_frame(core, &frame);
	findings->elements_removed = frame.statistics.elements_removed;
	findings->elements_torn = frame.statistics.elements_torn;
	for (int32_t i = 0; i < frame.vessel_count; i++)
		findings->vessel_flags[i] = frame.vessels[i]->flags;
}

// Reports a tear. The first tool whose jaws hold tissue is named as its cause.
static void note_tear(cau_hosted_timeline *timeline, const cau_frame *frame, int32_t torn)
{
	const cau_tool_state *puller = NULL;
	for (int32_t i = frame->tool_count - 1; i >= 0; i--)
		if (frame->tools[i].grasped_vertices)
			puller = &frame->tools[i];
	timeline->record->touched = true;
	cau_timeline_add(timeline, CAU_EVENT_TEAR, puller ? puller->name : NULL, NULL, torn, NULL);
}

static void note_cut(cau_hosted_findings *findings, cau_hosted_timeline *timeline,
                     cau_hosted_decisions *decisions, const cau_frame *frame)
{
	const cau_statistics *now = &frame->statistics;
	int32_t torn = now->elements_torn - findings->elements_torn;
	int32_t removed = now->elements_removed - findings->elements_removed - torn;
	findings->elements_removed = now->elements_removed;
	findings->elements_torn = now->elements_torn;
	if (torn > 0)
		note_tear(timeline, frame, torn);
	if (removed <= 0)
		return;
	cau_drive drives[CAU_MAX_TOOLS];
	timeline->record->touched = true;
	const cau_drive *cutter = NULL;
	int32_t count = cau_decisions_drives(decisions, drives);
	for (int32_t i = 0; i < count; i++)
		if (drives[i].energized)
			cutter = &drives[i];
	cau_timeline_add(timeline, CAU_EVENT_CUT, cutter ? cutter->tool : NULL,
	                 cutter ? cutter->driver.name : NULL, removed, NULL);
}

// Reports a layer with inverted tetrahedra once, and again only after all of its tetrahedra were
// upright.
static void note_inverted(cau_hosted_findings *findings, cau_hosted_timeline *timeline,
                          const cau_scene_def *scene, const cau_statistics *now)
{
	for (int32_t i = 0; i < scene->layer_count; i++) {
		uint32_t bit = 1u << i;
		bool reported = findings->inverted_layers & bit;
		findings->inverted_layers &= now->long_inverted[i] ? UINT32_MAX : ~bit;
		if (!now->long_inverted[i] || reported)
			continue;
		findings->inverted_layers |= bit;
		cau_timeline_add(timeline, CAU_EVENT_INVERTED, NULL, NULL, now->long_inverted[i],
		                 scene->layers[i].name);
	}
}

static void note_gain(cau_hosted_findings *findings, cau_hosted_timeline *timeline,
                      const cau_statistics *now)
{
	char detail[64];
	bool again = timeline->core->tick < findings->gain_tick ||
	             timeline->core->tick - findings->gain_tick >= GAIN_QUIET_TICKS;
	if (!(now->energy_gain_j > GAIN_MOST * now->energy_scale_j) || (findings->gain_tick && !again))
		return;
	findings->gain_tick = timeline->core->tick;
	snprintf(detail, sizeof detail, "%.3g J were gained in a tick that began with %.3g J",
	         now->energy_gain_j, now->energy_scale_j);
	cau_timeline_add(timeline, CAU_EVENT_ENERGY_GAIN, NULL, NULL, 0, detail);
}

static void note_vessels(cau_hosted_findings *findings, cau_hosted_timeline *timeline,
                         const cau_frame *frame)
{
	for (int32_t i = 0; i < frame->vessel_count; i++) {
		const cau_vessel_state *vessel = frame->vessels[i];
		uint32_t before = findings->vessel_flags[i], now = vessel->flags;
		findings->vessel_flags[i] = now;
		if (now & ~before & CAU_VESSEL_SEALED)
			cau_timeline_add(timeline, CAU_EVENT_SEALED, NULL, NULL, 0, vessel->name);
		if ((now ^ before) & CAU_VESSEL_BLEEDS)
			cau_timeline_add(
				timeline, now & CAU_VESSEL_BLEEDS ? CAU_EVENT_BLEEDING : CAU_EVENT_BLEEDING_STOPPED,
				NULL, NULL, 0, vessel->name);
	}
}

static void note_refusals(cau_hosted_findings *findings, const char *id, uint64_t tick,
                          const cau_frame *frame)
{
	for (int32_t i = 0; i < frame->refusal_count; i++) {
		findings->refused_commands++;
		cau_log(CAU_LOG_INFO, id, "refused_at_tick", "tick=%llu path=%s reason=\"%s\"",
		        (unsigned long long)tick, frame->refusals[i].path, frame->refusals[i].reason);
	}
}

void cau_findings_note(cau_hosted *h, const cau_frame *frame)
{
	note_cut(&h->findings, &h->timeline, &h->decisions, frame);
	note_inverted(&h->findings, &h->timeline, h->identity.scene, &frame->statistics);
	note_gain(&h->findings, &h->timeline, &frame->statistics);
	note_vessels(&h->findings, &h->timeline, frame);
	cau_timeline_settle(&h->timeline);
	note_refusals(&h->findings, h->identity.id, h->core.tick, frame);
}

// ---- faults -------------------------------------------------------------------------------------

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
	h->pace.realtime_factor = 0; // a faulted session does not advance
	cau_hosted_tell_fault(h, error);
}

// Faults the session because the core would heat a tool whose energy is off in the state machine.
// The cause is unknown, so all energy goes off. Other sessions are not affected.
void cau_fault_stop_unsound(cau_hosted *h)
{
	cau_error error = {0};
	cau_frame frame;
	cau_session_frame(h->core.session, &frame);
	for (int32_t i = 0; i < frame.tool_count; i++)
		cau_energy_turn_off(h, frame.tools[i].name);
	cau_energy_turn_off(h, h->decisions.odd_tool); // `frame` lacks a tool that is not added yet
	cau_fail(&error, CAU_FAULTED, "", "tool %s had energy on without a valid enable",
	         h->decisions.odd_tool);
	cau_log(CAU_LOG_ERROR, h->identity.id, "energy_disagrees", "tick=%llu tool=%s",
	        (unsigned long long)h->core.tick, h->decisions.odd_tool);
	cau_decide_stepped(h, error.reason);
	cau_hosted_tell_fault(h, &error);
}

// Reports a broken safety rule of the decisions. The decisions have already faulted the session,
// and the energy cut-offs follow as ordinary acts.
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
