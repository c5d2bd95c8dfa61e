// SPDX-License-Identifier: GPL-3.0-or-later
// Applies accepted orders at a tick border: passes commands to the core, and writes the log.
#include <stdlib.h>

#include "hosted_session/internal.h"
#include "hosted_session/slice.h"

// Most time in a slice for requests that only read, s. The last request may exceed it.
#define READS_SLICE_S 0.002

static void note_energy(cau_hosted_timeline *timeline, const cau_order *order,
                        const cau_action *action)
{
	bool on = order->as.command.as.energized;
	if (action->was_energized != on)
		cau_timeline_add(timeline, on ? CAU_EVENT_ENERGY_ON : CAU_EVENT_ENERGY_OFF,
		                 order->as.command.tool, order->asker.name, 0, NULL);
}

// Reports the effect of an accepted command to the timeline and to clients.
static void note(cau_hosted *h, const cau_order *order, const cau_action *action)
{
	const cau_command *command = &order->as.command;
	switch (command->kind) {
	case CAU_COMMAND_TOOL_ADD:
		cau_timeline_add(&h->timeline, CAU_EVENT_TOOL_ADDED, command->as.definition.name,
		                 order->asker.name, 0, NULL);
		cau_answer_changed(h, CAU_CHANGE_TOOLS, order->asker.name);
		break;
	case CAU_COMMAND_TOOL_REMOVE:
		cau_timeline_add(&h->timeline, CAU_EVENT_TOOL_REMOVED, command->tool, order->asker.name, 0,
		                 NULL);
		cau_answer_changed(h, CAU_CHANGE_TOOLS, order->asker.name);
		break;
	case CAU_COMMAND_TOOL_CONFIGURE:
		cau_answer_changed(h, CAU_CHANGE_TOOLS, order->asker.name);
		break;
	case CAU_COMMAND_TOOL_ENERGIZE:
		note_energy(&h->timeline, order, action);
		break;
	case CAU_COMMAND_SET_GRAVITY:
	case CAU_COMMAND_SET_MATERIAL:
		cau_answer_changed(h, CAU_CHANGE_TISSUE, order->asker.name);
		break;
	default:
		break;
	}
}

// True for an energy-off in a faulted session. The log of a faulted session ends with the fault, so
// such a command is not logged. The core still turns energy off.
static bool is_off_of_faulted(cau_hosted_decisions *decisions, const cau_command *command)
{
	return cau_decisions_state(decisions) == CAU_SESSION_FAULTED &&
	       command->kind == CAU_COMMAND_TOOL_ENERGIZE && !command->as.energized;
}

static void answer_command(cau_hosted_record *record, cau_hosted_decisions *decisions,
                           cau_order *order)
{
	size_t bytes = 0;
	char *text = NULL;
	cau_error error = {0};
	cau_command *command = &order->as.command;
	cau_wire_command_result result = {.tick = (int64_t)command->tick,
	                                  .sequence = (int64_t)command->sequence};
	if (order->reply.answer)
		text = cau_answer_text(order->reply.method, &result, &bytes, &error);
	if (is_off_of_faulted(decisions, command))
		cau_record_answer(record, order, text, bytes);
	else
		cau_record_command(record, command, order, text, bytes);
	if (text)
		cau_record_reply(record, &order->reply, text, bytes);
}

// Applies a command that cannot be logged, if it is an energy-off. Every other command is refused,
// because a restart would not replay it.
static cau_outcome_kind apply_unstored(cau_hosted *h, cau_order *order, const cau_error *error)
{
	cau_command *command = &order->as.command;
	if (command->kind != CAU_COMMAND_TOOL_ENERGIZE || command->as.energized) {
		cau_hosted_refuse_order(h, order, error, CAU_RPC_STORE_FULL);
		return CAU_NOT_DONE;
	}
	cau_energy_off_or_hold(&h->identity, &h->core, command);
	cau_hosted_answer_unstored(h, order);
	return CAU_DONE;
}

// Measures the time until a frame shows the command. Only a command of the tick that begins now has
// such a frame. In a paused session no tick begins by itself.
static void await_frame(cau_hosted *h, const cau_order *order)
{
	bool next = order->as.command.tick <= h->core.tick;
	if (next && cau_decisions_state(&h->decisions) == CAU_SESSION_RUNNING)
		cau_pace_await_frame(&h->pace, order->came_s);
}

cau_outcome_kind cau_apply_command(cau_hosted *h, cau_order *order, const cau_action *action)
{
	cau_error error = {0};
	cau_command *command = &order->as.command;
	if (command->tick < h->core.tick)
		command->tick = h->core.tick;
	if (!is_off_of_faulted(&h->decisions, command) && cau_record_check(&h->record, &error))
		return apply_unstored(h, order, &error);
	if (!cau_energy_off_or_hold(&h->identity, &h->core, command) &&
	    cau_session_submit(h->core.session, command, &error)) {
		cau_hosted_refuse_order(h, order, &error, 0);
		return CAU_NOT_DONE;
	}
	answer_command(&h->record, &h->decisions, order);
	cau_published_count(
		&h->published,
		&(cau_hosted_counts){.commands = 1, .motions = command->kind == CAU_COMMAND_TOOL_MOVE});
	await_frame(h, order);
	note(h, order, action);
	free(order);
	return CAU_DONE;
}

cau_outcome_kind cau_hosted_apply(cau_hosted *h, cau_order *order, const cau_action *action)
{
#define CHANGE(kind, ask, apply) [CAU_ORDER_##kind] = (apply),
#define READ(...)
	static cau_applied *const handlers[CAU_ORDER_COUNT] = {CAU_ORDER_TABLE(CHANGE, READ)};
#undef CHANGE
#undef READ
	return handlers[order->kind](h, order, action);
}

void cau_reads_serve(cau_hosted *h, int32_t noted)
{
#define CHANGE(...)
#define READ(kind, apply) [CAU_ORDER_##kind] = (apply),
	static cau_served *const handlers[CAU_ORDER_COUNT] = {CAU_ORDER_TABLE(CHANGE, READ)};
#undef CHANGE
#undef READ
	double end_s = cau_monotonic_s() + READS_SLICE_S;
	for (cau_order *order; (order = cau_reads_take(&h->reads, &noted));) {
		handlers[order->kind](h, order);
		if (cau_monotonic_s() >= end_s)
			return;
	}
}
