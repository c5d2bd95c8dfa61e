// SPDX-License-Identifier: GPL-3.0-or-later
// What the core and the log are told of drivers and energy. Who drives and what is lit is
// decided in server/session/drive.c.
#include <string.h>

#include "cautery/defaults.h"
#include "hosted_session/internal.h"

// ---- cuts ---------------------------------------------------------------------------------------

static const cau_tool_state *tool_state(const cau_frame *frame, const char *name)
{
	for (int32_t i = 0; i < frame->tool_count; i++)
		if (strcmp(frame->tools[i].name, name) == 0)
			return &frame->tools[i];
	return NULL;
}

// A command of the daemon's own: logged for nobody.
static void tell_core(cau_hosted *h, const cau_command *command)
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

static void energy_off_command(cau_hosted *h, const char *tool)
{
	cau_command off;
	cau_default_command(&off, CAU_COMMAND_TOOL_ENERGIZE);
	snprintf(off.tool, sizeof off.tool, "%s", tool);
	off.as.energized = 0;
	tell_core(h, &off);
}

// The tool's aim becomes where it is.
static void freeze_command(cau_hosted *h, const cau_tool_state *state)
{
	cau_command stay;
	cau_default_command(&stay, CAU_COMMAND_TOOL_MOVE);
	memcpy(stay.tool, state->name, sizeof stay.tool);
	stay.sequence = state->sequence;
	stay.as.move.pose = state->pose; // where it is: it is not pulled any farther either
	stay.as.move.jaw = state->jaw;
	tell_core(h, &stay);
}

static void count_cut(cau_hosted *h, const cau_drive *drive)
{
	bool watchdog = drive->cut_off == CAU_ENERGY_OFF_WATCHDOG;
	pthread_mutex_lock(&h->mutex);
	h->counts.watchdog_cuts += watchdog;
	pthread_mutex_unlock(&h->mutex);
	cau_event_add(h, watchdog ? CAU_EVENT_WATCHDOG : CAU_EVENT_ENERGY_OFF, drive->tool,
	              drive->driver.name, 0, drive->cut_cause);
	if (watchdog) // who holds a pedal down must not wonder why nothing burns
		cau_log(CAU_LOG_WARNING, h->id, "energy_cut",
		        "tool=%s client=\"%s\" cause=\"%s\" remedy=\"it stays dark until its driver "
		        "releases and enables it anew\"",
		        drive->tool, drive->driver.name, drive->cut_cause);
}

void cau_drive_do_cut(cau_hosted *h, const cau_action *action)
{
	const cau_drive *drive = &action->drive;
	cau_frame frame;
	cau_session_frame(h->core, &frame);
	const cau_tool_state *state = tool_state(&frame, drive->tool);
	bool sound = cau_decided_state(h) != CAU_SESSION_FAULTED; // a faulted core takes no command
	if (sound && action->was_lit)
		energy_off_command(h, drive->tool);
	if (sound && state && drive->freeze)
		freeze_command(h, state);
	if (action->was_lit)
		count_cut(h, drive);
	h->dirty = true;
}

// ---- orders -------------------------------------------------------------------------------------

cau_outcome_kind cau_apply_drive(cau_hosted *h, cau_order *order, const cau_action *action)
{
	cau_wire_driver result;
	const cau_drive *drive = &action->drive;
	bool driven = drive->driver.client != 0;
	if (action->changed)
		cau_event_add(h, CAU_EVENT_DRIVER, drive->tool, driven ? drive->driver.name : "", 0,
		              driven ? "drives" : "has no driver");
	cau_drive_describe(drive, &result);
	cau_answer_order(h, order, &result);
	return CAU_DONE;
}

cau_outcome_kind cau_apply_request_takeover(cau_hosted *h, cau_order *order,
                                            const cau_action *action)
{
	(void)action;
	cau_drive drive;
	cau_wire_nothing result = {0};
	cau_wire_takeover_requested params = {.client = order->asker.client};
	snprintf(params.session, sizeof params.session, "%s", h->id);
	memcpy(params.tool, order->as.tool.tool, sizeof params.tool);
	memcpy(params.name, order->asker.name, sizeof params.name);
	if (cau_decide_find(h, order->as.tool.tool, &drive) && drive.driver.client)
		cau_answer_notify(h, (cau_audience){CAU_AUDIENCE_CLIENT, drive.driver.client},
		                  CAU_METHOD_TAKEOVER_REQUESTED, &params);
	cau_answer_order(h, order, &result);
	return CAU_DONE;
}
