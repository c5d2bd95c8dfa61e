// SPDX-License-Identifier: GPL-3.0-or-later
#include "hosted_session/slice.h"

#include <string.h>

#include "cautery/defaults.h"
#include "hosted_session/internal.h"

// ---- energy cut-off -----------------------------------------------------------------------------

bool cau_energy_off_or_hold(const cau_hosted_identity *identity, cau_present_core *core,
                            const cau_command *command)
{
	bool off = command->kind == CAU_COMMAND_TOOL_ENERGIZE && !command->as.energized;
	bool hold = command->kind == CAU_COMMAND_TOOL_HOLD;
	int32_t waited = off || hold ? cau_session_waiting(core->session, command->tool) : 0;
	if (off)
		cau_session_energy_off(core->session, command->tool, command->sequence);
	else if (hold)
		cau_session_hold_still(core->session, command->tool, command->sequence);
	else
		return false;
	int32_t voided = waited - cau_session_waiting(core->session, command->tool);
	if (voided)
		cau_log(CAU_LOG_INFO, identity->id, "commands_void", "tick=%llu tool=%s count=%d",
		        (unsigned long long)core->tick, command->tool, voided);
	return true;
}

// Applies a command of the daemon itself. The log entry has no client and no sequence number. The
// command cannot fail.
static void tell_core(cau_hosted *h, int kind, const char *tool)
{
	cau_command command;
	cau_default_command(&command, kind); // an energize command is an off by default
	snprintf(command.tool, sizeof command.tool, "%s", tool);
	command.tick = h->core.tick;
	cau_energy_off_or_hold(&h->identity, &h->core, &command);
	// the log of a faulted session has ended
	if (cau_decisions_state(&h->decisions) != CAU_SESSION_FAULTED)
		cau_record_command(&h->record, &command, NULL, NULL, 0);
}

void cau_energy_turn_off(cau_hosted *h, const char *tool)
{
	tell_core(h, CAU_COMMAND_TOOL_ENERGIZE, tool);
}

static void count_cut(cau_hosted *h, const cau_drive *drive)
{
	bool watchdog = drive->cut_off == CAU_ENERGY_OFF_WATCHDOG;
	cau_published_count(&h->published, &(cau_hosted_counts){.watchdog_cuts = watchdog});
	cau_timeline_add(&h->timeline, watchdog ? CAU_EVENT_WATCHDOG : CAU_EVENT_ENERGY_OFF,
	                 drive->tool, drive->driver.name, 0, drive->cut_cause);
	if (watchdog) // the log shows why the tool stays cold although the pedal is pressed
		cau_log(CAU_LOG_WARNING, h->identity.id, "energy_cut",
		        "tool=%s client=\"%s\" cause=\"%s\" remedy=\"energy stays off until the driver "
		        "releases and enables it anew\"",
		        drive->tool, drive->driver.name, drive->cut_cause);
}

void cau_energy_cut(cau_hosted *h, const cau_action *action)
{
	const cau_drive *drive = &action->drive;
	if (action->was_energized)
		cau_energy_turn_off(h, drive->tool);
	if (drive->freeze)
		tell_core(h, CAU_COMMAND_TOOL_HOLD, drive->tool);
	if (action->was_energized)
		count_cut(h, drive);
	h->frames.dirty = true;
}

// ---- orders -------------------------------------------------------------------------------------

cau_outcome_kind cau_apply_drive(cau_hosted *h, cau_order *order, const cau_action *action)
{
	cau_wire_driver result;
	const cau_drive *drive = &action->drive;
	bool driven = drive->driver.client != 0;
	if (action->changed)
		cau_timeline_add(&h->timeline, CAU_EVENT_DRIVER, drive->tool,
		                 driven ? drive->driver.name : "", 0, driven ? "drives" : "has no driver");
	cau_answer_driver(drive, &result);
	cau_answer_order(&h->record, order, &result);
	return CAU_DONE;
}

cau_outcome_kind cau_apply_request_takeover(cau_hosted *h, cau_order *order,
                                            const cau_action *action)
{
	(void)action;
	cau_drive drive;
	cau_wire_nothing result = {0};
	cau_wire_takeover_requested params = {.client = order->asker.client};
	snprintf(params.session, sizeof params.session, "%s", h->identity.id);
	memcpy(params.tool, order->as.tool.tool, sizeof params.tool);
	memcpy(params.name, order->asker.name, sizeof params.name);
	if (cau_decisions_find(&h->decisions, order->as.tool.tool, &drive) && drive.driver.client)
		cau_answer_notify(&h->identity, (cau_audience){CAU_AUDIENCE_CLIENT, drive.driver.client},
		                  CAU_METHOD_TAKEOVER_REQUESTED, &params);
	cau_answer_order(&h->record, order, &result);
	return CAU_DONE;
}
