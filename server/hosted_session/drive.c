// SPDX-License-Identifier: GPL-3.0-or-later
// What the core and the log are told of drivers and energy. Who drives and what is lit is
// decided in server/session/drive.c.
#include <string.h>

#include "cautery/defaults.h"
#include "hosted_session/internal.h"

// ---- cuts ---------------------------------------------------------------------------------------

bool cau_drive_does(cau_hosted *h, const cau_command *command)
{
	bool off = command->kind == CAU_COMMAND_TOOL_ENERGIZE && !command->as.energized;
	bool hold = command->kind == CAU_COMMAND_TOOL_HOLD;
	int32_t waited = off || hold ? cau_session_waiting(h->core, command->tool) : 0;
	if (off)
		cau_session_energy_off(h->core, command->tool, command->sequence);
	else if (hold)
		cau_session_hold_still(h->core, command->tool, command->sequence);
	else
		return false;
	int32_t voided = waited - cau_session_waiting(h->core, command->tool);
	if (voided)
		cau_log(CAU_LOG_INFO, h->id, "commands_void", "tick=%llu tool=%s count=%d",
		        (unsigned long long)h->tick, command->tool, voided);
	return true;
}

// A command of the daemon's own: logged for nobody, with no driver's number. It cannot fail.
static void tell_core(cau_hosted *h, int kind, const char *tool)
{
	cau_command command;
	cau_default_command(&command, kind); // of energy: off
	snprintf(command.tool, sizeof command.tool, "%s", tool);
	command.tick = h->tick;
	cau_drive_does(h, &command);
	if (cau_decided_state(h) != CAU_SESSION_FAULTED) // there the log ends
		cau_record_command(h, &command, NULL, NULL, 0);
}

void cau_drive_darken(cau_hosted *h, const char *tool)
{
	tell_core(h, CAU_COMMAND_TOOL_ENERGIZE, tool);
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
	if (action->was_lit)
		cau_drive_darken(h, drive->tool);
	if (drive->freeze)
		tell_core(h, CAU_COMMAND_TOOL_HOLD, drive->tool);
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
