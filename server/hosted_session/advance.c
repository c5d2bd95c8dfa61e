// SPDX-License-Identifier: GPL-3.0-or-later
// session.advance: applies all commands or none, then the ticks one by one (run.c), then answers.
#include <stdlib.h>
#include <string.h>

#include "hosted_session/internal.h"
#include "hosted_session/slice.h"

// ---- commands -----------------------------------------------------------------------------------

// Checks that the core accepts all commands. The error's path names the command.
static cau_status check(cau_session *core, const cau_advance *advance, cau_error *error)
{
	int32_t index;
	char path[sizeof error->path];
	cau_status status =
		cau_session_may_submit(core, advance->commands, advance->command_count, &index, error);
	if (status) {
		snprintf(path, sizeof path, "params.commands[%d].%.100s", index, error->path);
		memcpy(error->path, path, sizeof error->path);
	}
	return status;
}

// True if the command repeats an enable that is already in effect. Such a command goes neither to
// the core nor to the log. Lock-step repeats the enable with every request, and each log entry
// costs a stored session some KiB.
static bool holds_already(cau_session *core, const cau_command *command, const cau_drive *drive)
{
	cau_frame frame;
	bool plain = command->kind == CAU_COMMAND_TOOL_ENERGIZE && command->as.energized &&
	             !command->as.ticks && !command->sequence;
	if (!plain || !drive->enabled || drive->limit_tick)
		return false;
	cau_session_frame(core, &frame);
	for (int32_t i = 0; i < frame.tool_count; i++)
		if (strcmp(frame.tools[i].name, command->tool) == 0)
			return frame.tools[i].energized;
	return false;
}

static void apply(cau_hosted *h, const cau_order *order, cau_command *command)
{
	cau_error error = {0};
	cau_drive drive = {0};
	cau_decisions_find(&h->decisions, command->tool, &drive);
	if (holds_already(h->core.session, command, &drive))
		return;
	command->tick = h->core.tick;
	if (!cau_energy_off_or_hold(&h->identity, &h->core, command) &&
	    cau_session_submit(h->core.session, command, &error))
		cau_log(CAU_LOG_ERROR, h->identity.id, "advance_lost", "tool=%s reason=\"%s\"",
		        command->tool,
		        error.reason); // cannot fail: the commands were checked just before
	cau_record_command(&h->record, command, NULL, NULL, 0);
	if (command->kind == CAU_COMMAND_TOOL_ENERGIZE && command->as.energized && !drive.energized)
		cau_timeline_add(&h->timeline, CAU_EVENT_ENERGY_ON, command->tool, order->asker.name, 0,
		                 NULL);
}

cau_outcome_kind cau_apply_advance(cau_hosted *h, cau_order *order, const cau_action *action)
{
	(void)action;
	cau_error error = {0};
	cau_advance *advance = order->as.advance;
	if (cau_advance_check(&h->core.info, advance, &error) ||
	    check(h->core.session, advance, &error)) {
		cau_answer_fail(order, &error, 0);
		return CAU_NOT_DONE;
	}
	if (advance->command_count && cau_record_check(&h->record, &error)) {
		cau_answer_fail(order, &error, CAU_RPC_STORE_FULL);
		return CAU_NOT_DONE;
	}
	advance->began_tick = h->core.tick;
	for (int32_t i = 0; i < advance->command_count; i++)
		apply(h, order, &advance->commands[i]);
	cau_published_count(&h->published,
	                    &(cau_hosted_counts){.commands = (uint64_t)advance->command_count});
	return CAU_DONE;
}

// ---- the answer ---------------------------------------------------------------------------------

// Makes the new tick reachable after a restart, if the store is on a disk. An ephemeral session
// needs no log entry, because it is never restarted.
static void record(cau_hosted_record *record, const cau_advance *advance)
{
	if (record->core->tick != advance->began_tick && !record->identity->around->ephemeral)
		cau_record_reached(record);
	else if (record->core->tick != advance->began_tick)
		cau_record_far(record);
}

void cau_advance_answer(cau_hosted *h, cau_order *order)
{
	cau_error error = {0};
	size_t bytes = 0;
	const cau_advance *advance = order->as.advance;
	record(&h->record, advance);
	h->frames.dirty = true; // publish the last state, whatever the rates of the streams
	char *text = cau_advance_text(h, order, &bytes, &error);
	cau_outcome outcome = {.text = text, .text_bytes = bytes, .error = text ? NULL : &error};
	if (!text || h->identity.around->ephemeral) {
		cau_reply_answer(&order->reply, &outcome);
		free(text);
	} else {
		cau_record_batch(&h->record); // creates a batch, whose commit sends the answer
		cau_record_reply(&h->record, &order->reply, text, bytes);
	}
	free(order);
}
