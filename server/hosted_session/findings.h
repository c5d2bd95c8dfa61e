// SPDX-License-Identifier: GPL-3.0-or-later
// What steps did to the tissue, as far as it was reported, and faults: numerical trouble and broken
// safety rules, each of which stops this session alone. All by the thread that has the session.
#pragma once

#include "cautery/session.h"
#include "hosted_session/sink.h"

typedef struct cau_hosted_findings {
	int32_t elements_removed, elements_torn;
	uint32_t vessel_flags[CAU_MAX_VESSELS];
	uint32_t inverted_layers;  // whose tetrahedra were reported, a bit each
	uint64_t gain_tick;        // of the last report that steps gained energy; 0: none
	uint32_t refused_commands; // also those refused when they came
} cau_hosted_findings;

// Takes what the core has cut, and its vessels, as reported: after a replay or a rewind.
void cau_findings_know(cau_hosted_findings *findings, const cau_session *core);
// Reports the findings of a step: cuts, tears, vessels, layers, refused commands.
void cau_findings_note(cau_hosted *h, const cau_frame *frame);

// Numerical trouble outside a step. The session is faulted; all clients are notified.
void cau_hosted_fault(cau_hosted *h, const cau_error *error);
void cau_hosted_tell_fault(cau_hosted *h, const cau_error *error);
// The core would heat decisions.odd_tool, whose energy the state machine has off.
void cau_fault_stop_unsound(cau_hosted *h);
// Reports a safety rule of the decisions that was broken, once.
void cau_fault_report_broken_rule(cau_hosted *h);
