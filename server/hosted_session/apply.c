// SPDX-License-Identifier: GPL-3.0-or-later
// Commands at a tick border: who may, what the core says, what the log keeps.
#include <stdlib.h>
#include <string.h>

#include "hosted_session/internal.h"

static bool is_about_tool(int kind)
{
	return kind >= CAU_COMMAND_TOOL_REMOVE && kind <= CAU_COMMAND_TOOL_RELEASE;
}

// Only the driver moves a tool, opens and closes it, and turns energy on; anybody who may operate
// turns it off; a tool without driver may be changed or taken away by anybody who may operate.
static cau_status check_driver(cau_hosted *h, const cau_order *order, int32_t *code,
                               cau_error *error)
{
	const cau_command *command = &order->as.command;
	if (!is_about_tool(command->kind))
		return CAU_OK;
	const cau_drive *drive = cau_drive_find(h, command->tool);
	if (!drive)
		return cau_fail(error, CAU_NOT_FOUND, "params.tool", "no tool `%s` in this session",
		                command->tool);
	bool off = command->kind == CAU_COMMAND_TOOL_ENERGIZE && !command->as.energized;
	bool keeping =
		command->kind == CAU_COMMAND_TOOL_REMOVE || command->kind == CAU_COMMAND_TOOL_CONFIGURE;
	if (off || drive->driver.client == order->asker.client)
		return CAU_OK;
	if (keeping && !drive->driver.client)
		return CAU_OK;
	*code = CAU_RPC_NOT_DRIVER;
	if (!drive->driver.client)
		return cau_fail(error, CAU_BAD_STATE, "params.tool",
		                "nobody drives it: tool.take_over comes first");
	return cau_fail(error, CAU_BAD_STATE, "params.tool", "%s drives it", drive->driver.name);
}

static void take_energy(cau_hosted *h, const cau_order *order, cau_drive *drive)
{
	bool on = order->as.command.as.energized;
	pthread_mutex_lock(&h->mutex);
	bool was = drive->energized;
	drive->energized = on;
	drive->cut_wanted = false;
	drive->last_s = cau_monotonic_s();
	if (on)
		drive->frozen = false;
	else if (was)
		drive->energy_off = CAU_ENERGY_OFF_COMMANDED;
	pthread_mutex_unlock(&h->mutex);
	if (was != on) {
		cau_event_add(h, on ? CAU_EVENT_ENERGY_ON : CAU_EVENT_ENERGY_OFF, drive->tool,
		              order->asker.name, 0, NULL);
		cau_drive_tell(h, drive);
	}
	if (on)
		h->around->armed(h->around->user);
}

// What the daemon itself keeps of a command that the core has taken.
static void take_effect(cau_hosted *h, const cau_order *order)
{
	const cau_command *command = &order->as.command;
	cau_drive *drive = is_about_tool(command->kind) ? cau_drive_find(h, command->tool) : NULL;
	switch (command->kind) {
	case CAU_COMMAND_TOOL_ADD:
		cau_drive_add(h, command->as.definition.name, &order->asker);
		cau_event_add(h, CAU_EVENT_TOOL_ADDED, command->as.definition.name, order->asker.name, 0,
		              NULL);
		cau_answer_changed(h, CAU_CHANGE_TOOLS, order->asker.name);
		break;
	case CAU_COMMAND_TOOL_REMOVE:
		cau_event_add(h, CAU_EVENT_TOOL_REMOVED, command->tool, order->asker.name, 0, NULL);
		cau_drive_remove(h, command->tool);
		cau_answer_changed(h, CAU_CHANGE_TOOLS, order->asker.name);
		break;
	case CAU_COMMAND_TOOL_CONFIGURE:
		cau_answer_changed(h, CAU_CHANGE_TOOLS, order->asker.name);
		break;
	case CAU_COMMAND_TOOL_ENERGIZE:
		take_energy(h, order, drive);
		break;
	case CAU_COMMAND_TOOL_MOVE:
		drive->frozen = false;
		break;
	case CAU_COMMAND_SET_GRAVITY:
	case CAU_COMMAND_SET_MATERIAL:
		cau_answer_changed(h, CAU_CHANGE_TISSUE, order->asker.name);
		break;
	default:
		break;
	}
}

void cau_hosted_command(cau_hosted *h, const cau_command *command)
{
	cau_error error = {0};
	cau_command now = *command;
	now.tick = h->tick;
	if (cau_session_submit(h->core, &now, &error))
		cau_log(CAU_LOG_ERROR, h->id, "command_lost", "tool=%s reason=\"%s\"", now.tool,
		        error.reason);
	else
		cau_record_command(h, &now, NULL, NULL, 0);
}

static void refuse(cau_hosted *h, cau_order *order, const cau_error *error, int32_t code)
{
	h->refused_commands++;
	if (order->motion)
		cau_drive_refuse(h, order, error);
	cau_answer_fail(order, error, code);
}

static void apply_command(cau_hosted *h, cau_order *order)
{
	cau_error error = {0};
	int32_t code = 0;
	cau_command *command = &order->as.command;
	cau_status status = check_driver(h, order, &code, &error);
	if (!status && h->state == CAU_SESSION_FAULTED)
		status = cau_fail(&error, CAU_FAULTED, "", "%s", h->fault);
	if (command->tick < h->tick)
		command->tick = h->tick;
	if (!status)
		status = cau_session_submit(h->core, command, &error);
	if (status) {
		refuse(h, order, &error, code);
		return;
	}
	size_t bytes = 0;
	char *text = NULL;
	cau_wire_command_result result = {(int64_t)command->tick, (int64_t)command->sequence, 0};
	if (order->reply.answer)
		text = cau_answer_text(order->reply.method, &result, &bytes, &error);
	cau_record_command(h, command, order, text, bytes);
	if (text)
		cau_record_reply(h, &order->reply, text, bytes);
	pthread_mutex_lock(&h->mutex);
	h->counts.commands++;
	h->counts.motions += command->kind == CAU_COMMAND_TOOL_MOVE;
	pthread_mutex_unlock(&h->mutex);
	take_effect(h, order);
	free(order);
}

// True if this is a request sent again, and answered or set aside.
static bool was_resent(cau_hosted *h, cau_order *order)
{
	cau_error error = {0};
	cau_status status = cau_record_resend(h, order, &error);
	if (status == CAU_OK) {
		free(order);
		return true;
	}
	if (status == CAU_ALREADY_EXISTS) {
		snprintf(error.path, sizeof error.path, "params.client_sequence");
		cau_answer_fail(order, &error, CAU_RPC_SEQUENCE_PAST);
		return true;
	}
	if (status != CAU_BAD_STATE)
		return false;
	order->next = h->postponed;
	h->postponed = order;
	h->commit_awaited = true;
	return true;
}

void cau_hosted_apply(cau_hosted *h, cau_order *order)
{
	static void (*const handlers[])(cau_hosted *, cau_order *) = {
		[CAU_ORDER_COMMAND] = apply_command,
		[CAU_ORDER_PAUSE] = cau_apply_pause,
		[CAU_ORDER_RESUME] = cau_apply_resume,
		[CAU_ORDER_STEP] = cau_apply_step,
		[CAU_ORDER_SPEED] = cau_apply_speed,
		[CAU_ORDER_RESET] = cau_apply_back,
		[CAU_ORDER_REWIND] = cau_apply_back,
		[CAU_ORDER_SNAPSHOT] = cau_apply_snapshot,
		[CAU_ORDER_RESTORE] = cau_apply_back,
		[CAU_ORDER_FORK] = cau_apply_fork,
		[CAU_ORDER_DESTROY] = cau_apply_destroy,
		[CAU_ORDER_TAKE_OVER] = cau_apply_take_over,
		[CAU_ORDER_HAND_OVER] = cau_apply_hand_over,
		[CAU_ORDER_REQUEST_TAKEOVER] = cau_apply_request_takeover,
	};
	if (!was_resent(h, order))
		handlers[order->kind](h, order);
}
