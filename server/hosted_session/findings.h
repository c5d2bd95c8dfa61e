// SPDX-License-Identifier: GPL-3.0-or-later
// Reports what steps did to the tissue, and faults. A fault is numerical trouble or a broken safety
// rule, and stops this session alone. Only the session's owning thread (internal.h) calls these
// functions.
#pragma once

#include "cautery/session.h"
#include "hosted_session/sink.h"

typedef struct cau_hosted_findings {
	int32_t elements_removed, elements_torn;
	uint32_t vessel_flags[CAU_MAX_VESSELS];
	uint32_t inverted_layers;  // one bit for each layer whose inverted tetrahedra were reported
	uint64_t gain_tick;        // tick of the last report that steps gained energy; 0: none
	uint32_t refused_commands; // commands that were refused on arrival or at a tick
} cau_hosted_findings;

// Takes the core's present cuts and vessels as already reported. Call this after a replay or a
// rewind.
void cau_findings_know(cau_hosted_findings *findings, const cau_session *core);
// Reports the findings of a step: cuts, tears, vessels, layers, refused commands.
void cau_findings_note(cau_hosted *h, const cau_frame *frame);

// Faults the session because of numerical trouble outside a step, and notifies all clients.
void cau_hosted_fault(cau_hosted *h, const cau_error *error);
void cau_hosted_tell_fault(cau_hosted *h, const cau_error *error);
// Faults the session because the core would heat decisions.odd_tool, whose energy is off in the
// state machine.
void cau_fault_stop_unsound(cau_hosted *h);
// Reports a broken safety rule of the decisions, once.
void cau_fault_report_broken_rule(cau_hosted *h);
