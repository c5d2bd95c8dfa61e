// SPDX-License-Identifier: GPL-3.0-or-later
#include "trace/fields.h"

#include <assert.h>

#define LENGTH(array) ((int32_t)(sizeof(array) / sizeof *(array)))
#define PLACE(type, member) offsetof(type, member), sizeof(((type *)0)->member)
#define UNSIGNED(type, name, member)                                                               \
	{                                                                                              \
		name, FIELD_UNSIGNED, PLACE(type, member), NULL, 0                                         \
	}
#define SIGNED(type, name, member)                                                                 \
	{                                                                                              \
		name, FIELD_SIGNED, PLACE(type, member), NULL, 0                                           \
	}
#define REAL(type, name, member)                                                                   \
	{                                                                                              \
		name, FIELD_REAL, PLACE(type, member), NULL, 0                                             \
	}
#define TRUTH(type, name, member)                                                                  \
	{                                                                                              \
		name, FIELD_TRUTH, PLACE(type, member), NULL, 0                                            \
	}
#define TEXT(type, name, member)                                                                   \
	{                                                                                              \
		name, FIELD_TEXT, PLACE(type, member), NULL, 0                                             \
	}
#define CHOICE(type, name, member, words)                                                          \
	{                                                                                              \
		name, FIELD_CHOICE, PLACE(type, member), words, LENGTH(words)                              \
	}

// ---- words --------------------------------------------------------------------------------------

const char *const cau_trace_what_words[CAU_TRACE_WHAT_COUNT] = {
	[CAU_TRACE_INIT] = "init", [CAU_TRACE_TAKE] = "take",       [CAU_TRACE_NEXT] = "next",
	[CAU_TRACE_DONE] = "done", [CAU_TRACE_STEPPED] = "stepped",
};

static const char *const event_words[CAU_LOGIC_EVENT_COUNT] = {
	[CAU_LOGIC_ORDER] = "order",     [CAU_LOGIC_ALIVE] = "alive",
	[CAU_LOGIC_AWAY] = "away",       [CAU_LOGIC_FORGET] = "forget",
	[CAU_LOGIC_TIME] = "time",       [CAU_LOGIC_STORE] = "store",
	[CAU_LOGIC_CANCEL] = "cancel",   [CAU_LOGIC_COMMITTED] = "committed",
	[CAU_LOGIC_ARRIVED] = "arrived", [CAU_LOGIC_STAYED] = "stayed",
	[CAU_LOGIC_FAULT] = "fault",     [CAU_LOGIC_DRAIN] = "drain",
	[CAU_LOGIC_END] = "end",
};

static const char *const ask_words[CAU_ASK_COUNT] = {
	[CAU_ASK_TISSUE] = "tissue",
	[CAU_ASK_TOOL_ADD] = "tool_add",
	[CAU_ASK_TOOL_KEEP] = "tool_keep",
	[CAU_ASK_TOOL_REMOVE] = "tool_remove",
	[CAU_ASK_TOOL_USE] = "tool_use",
	[CAU_ASK_MOTION] = "motion",
	[CAU_ASK_ENERGY_ON] = "energy_on",
	[CAU_ASK_ENERGY_OFF] = "energy_off",
	[CAU_ASK_TAKE_OVER] = "take_over",
	[CAU_ASK_HAND_OVER] = "hand_over",
	[CAU_ASK_REQUEST_TAKEOVER] = "request_takeover",
	[CAU_ASK_PAUSE] = "pause",
	[CAU_ASK_RESUME] = "resume",
	[CAU_ASK_STEP] = "step",
	[CAU_ASK_SPEED] = "speed",
	[CAU_ASK_GO] = "go",
	[CAU_ASK_HISTORY] = "history",
	[CAU_ASK_DESTROY] = "destroy",
	[CAU_ASK_ADVANCE] = "advance",
};

static const char *const act_words[] = {
	[CAU_ACT_NOTHING] = "nothing",
	[CAU_ACT_REFUSE] = "refuse",
	[CAU_ACT_LOOK] = "look",
	[CAU_ACT_ORDER] = "order",
	[CAU_ACT_CUT] = "cut",
	[CAU_ACT_PAUSE] = "pause",
	[CAU_ACT_STEP] = "step",
	[CAU_ACT_STEPPED] = "stepped",
	[CAU_ACT_STEP_FAILED] = "step_failed",
};

static const char *const outcome_words[] = {
	[CAU_DONE] = "done",
	[CAU_NOT_DONE] = "not_done",
	[CAU_POSTPONED] = "postponed",
};

const char *const cau_trace_effect_words[] = {
	[CAU_EFFECT_REFUSE] = "refuse",     [CAU_EFFECT_REPLACED] = "replaced",
	[CAU_EFFECT_UNSTORED] = "unstored", [CAU_EFFECT_TELL] = "tell",
	[CAU_EFFECT_WAKE] = "wake",         [CAU_EFFECT_ARMED] = "armed",
};

#define X(code, name) name,
static const char *const role_words[] = {CAU_ROLE_TABLE(X)};
static const char *const state_words[] = {CAU_SESSION_STATE_TABLE(X)};
#undef X

#define X(code, name, sentence) name,
static const char *const status_words[] = {CAU_STATUS_TABLE(X)};
#undef X

// ---- members ------------------------------------------------------------------------------------

#define CALL(kind, name, member) kind(cau_trace_call, name, member)
#define ASKER(type, prefix, member)                                                                \
	UNSIGNED(type, prefix ".client", member.client), TEXT(type, prefix ".name", member.name),      \
		TEXT(type, prefix ".client_id", member.client_id),                                         \
		CHOICE(type, prefix ".role", member.role, role_words),                                     \
		REAL(type, prefix ".deadline_s", member.deadline_s)
#define TOOL(i)                                                                                    \
	CALL(TEXT, "tools." #i ".name", tools[i].name),                                                \
		CALL(TRUTH, "tools." #i ".energized", tools[i].energized)
#define PART(i)                                                                                    \
	CALL(TEXT, "parts." #i ".tool", asked.parts[i].tool),                                          \
		CALL(SIGNED, "parts." #i ".command", asked.parts[i].command),                              \
		CALL(TRUTH, "parts." #i ".uses", asked.parts[i].uses),                                     \
		CALL(TRUTH, "parts." #i ".on", asked.parts[i].on),                                         \
		CALL(TRUTH, "parts." #i ".off", asked.parts[i].off),                                       \
		CALL(UNSIGNED, "parts." #i ".limit", asked.parts[i].limit)
static_assert(CAU_MAX_TOOLS == 8, "one entry for each tool below, and for each part");

static const field call_fields[] = {
	CALL(REAL, "time_s", time_s),
	CALL(REAL, "alive_s", alive_s),
	CALL(SIGNED, "capacity", capacity),
	CALL(REAL, "step_s", step_s),
	CHOICE(cau_trace_call, "event", event, event_words),
	CALL(UNSIGNED, "client", client),
	CALL(UNSIGNED, "number", number),
	CALL(TEXT, "subject", subject),
	CALL(TEXT, "cause", cause),
	CALL(TRUTH, "store_takes", store_takes),
	CHOICE(cau_trace_call, "state", state, state_words),
	CALL(UNSIGNED, "tick", tick),
	CALL(UNSIGNED, "ticket", asked.ticket),
	CHOICE(cau_trace_call, "ask", asked.ask, ask_words),
	ASKER(cau_trace_call, "asker", asked.asker),
	ASKER(cau_trace_call, "to", asked.to),
	CALL(TEXT, "tool", asked.tool),
	CALL(UNSIGNED, "at", asked.tick),
	CALL(UNSIGNED, "limit", asked.limit),
	CALL(TRUTH, "numbered", asked.numbered),
	CALL(SIGNED, "ticks", asked.ticks),
	CALL(REAL, "speed", asked.speed),
	CALL(REAL, "asker.alive_s", asked.alive_s),
	CALL(SIGNED, "part_count", asked.part_count),
	PART(0),
	PART(1),
	PART(2),
	PART(3),
	PART(4),
	PART(5),
	PART(6),
	PART(7),
	CALL(SIGNED, "tool_count", tool_count),
	TOOL(0),
	TOOL(1),
	TOOL(2),
	TOOL(3),
	TOOL(4),
	TOOL(5),
	TOOL(6),
	TOOL(7),
	CHOICE(cau_trace_call, "outcome", outcome, outcome_words),
	CALL(TRUTH, "faulted", faulted),
};

#define ERROR(type)                                                                                \
	CHOICE(type, "status", error.status, status_words), TEXT(type, "path", error.path),            \
		TEXT(type, "reason", error.reason)

static const field action_fields[] = {
	CHOICE(cau_action, "act", act, act_words), UNSIGNED(cau_action, "ticket", ticket),
	TRUTH(cau_action, "motion", motion),       TRUTH(cau_action, "was_energized", was_energized),
	TRUTH(cau_action, "changed", changed),     ERROR(cau_action),
	SIGNED(cau_action, "code", code),
};

static const field effect_fields[] = {
	ERROR(cau_effect),
	SIGNED(cau_effect, "code", code),
};

static const field drive_fields[] = {
	TEXT(cau_drive, "drive.tool", tool),
	ASKER(cau_drive, "drive.driver", driver),
	REAL(cau_drive, "drive.alive_s", alive_s),
	TRUTH(cau_drive, "drive.enabled", enabled),
	UNSIGNED(cau_drive, "drive.limit_tick", limit_tick),
	TRUTH(cau_drive, "drive.energized", energized),
	TRUTH(cau_drive, "drive.freeze", freeze),
	TRUTH(cau_drive, "drive.frozen", frozen),
	TRUTH(cau_drive, "drive.by_order", by_order),
	SIGNED(cau_drive, "drive.energy_off", energy_off),
	UNSIGNED(cau_drive, "drive.cut_moment", cut_moment),
	SIGNED(cau_drive, "drive.cut_off", cut_off),
	TEXT(cau_drive, "drive.cut_cause", cut_cause),
};

const field_list cau_trace_call_fields = {call_fields, LENGTH(call_fields)};
const field_list cau_trace_action_fields = {action_fields, LENGTH(action_fields)};
const field_list cau_trace_effect_fields = {effect_fields, LENGTH(effect_fields)};
const field_list cau_trace_drive_fields = {drive_fields, LENGTH(drive_fields)};
