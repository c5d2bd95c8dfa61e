// SPDX-License-Identifier: GPL-3.0-or-later
// Decides which client drives which tool, and when a tool's energy is on.
//
// Only an enable of the driver that counts turns a tool's energy on. Every other change turns it
// off. Each energy cut-off notes its moment in the tool, and an enable counts only if it came
// later. So an enable that waited in the queue has no effect if its driver meanwhile fell silent,
// hid the page, or lost the tool. `enabled` is the decision, and `energized` is the state of the
// core. If a tool is energized but not enabled, the worker's next act is the cut-off.
#include <math.h>
#include <stdio.h>

#include "cautery/assert.h"
#include "cautery/rpc_errors.h"
#include "session/internal.h"

cau_drive *cau_drive_find(cau_logic *logic, const char *tool)
{
	CAU_RULE(logic->drive_count >= 0 && logic->drive_count <= CAU_MAX_TOOLS, "%d tools",
	         logic->drive_count);
	for (int32_t i = 0; i < logic->drive_count; i++)
		if (strcmp(logic->drives[i].tool, tool) == 0)
			return &logic->drives[i];
	return NULL;
}

const cau_drive *cau_logic_drive(const cau_logic *logic, const char *tool)
{
	for (int32_t i = 0; i < logic->drive_count; i++)
		if (strcmp(logic->drives[i].tool, tool) == 0)
			return &logic->drives[i];
	return NULL;
}

// ---- energy cut-off -----------------------------------------------------------------------------

static uint64_t newest(uint64_t a, uint64_t b)
{
	return a > b ? a : b;
}

static void switch_off(cau_drive *drive, int energy_off, const char *cause, cau_effects *effects)
{
	CAU_RULE_INDEX(energy_off, CAU_ENERGY_OFF_COUNT);
	drive->cut_off = energy_off;
	drive->by_order = false;
	snprintf(drive->cut_cause, sizeof drive->cut_cause, "%s", cause);
	if (drive->energized)
		cau_effect_wake(effects);
	// A client that turns energy off still drives the tool, so the tool need not stop. In all other
	// cases the tool stops where it is.
	if (drive->energized && energy_off != CAU_ENERGY_OFF_COMMANDED)
		drive->freeze = true;
	if (!drive->enabled)
		return;
	drive->enabled = false;
	drive->limit_tick = 0;
	drive->energy_off = energy_off;
	cau_effect_tell(effects, drive);
	CAU_RULE(!drive->enabled, "tool %s is reported off and is on", drive->tool);
}

void cau_drive_cut(cau_drive *drive, uint64_t moment, int energy_off, const char *cause,
                   cau_effects *effects)
{
	CAU_RULE(cause[0] != 0, "tool %s is cut for no cause", drive->tool);
	drive->cut_moment = newest(drive->cut_moment, moment);
	switch_off(drive, energy_off, cause, effects);
	CAU_RULE(!drive->enabled && drive->cut_moment >= moment,
	         "tool %s is cut at %llu and its energy is on", drive->tool,
	         (unsigned long long)moment);
}

void cau_drive_end_lockstep(cau_logic *logic)
{
	if (logic->lockstep)
		logic->steps_left = 0; // the order that asked for the dropped ticks is answered next
	logic->lockstep = 0;
}

void cau_drive_cut_energized(cau_logic *logic, uint64_t moment, int energy_off, const char *cause,
                             cau_effects *effects)
{
	cau_drive_end_lockstep(logic);
	logic->all_off_moment = newest(logic->all_off_moment, moment);
	for (int32_t i = 0; i < logic->drive_count; i++)
		cau_drive_cut(&logic->drives[i], moment, energy_off, cause, effects);
}

// Turns off the energy of a tool whose driver is lost, and stops the tool where it is. Waiting
// orders of the lost driver are made void in the queue. Orders of other clients stay valid; they
// count once their client drives the tool.
static void cut_lost(cau_drive *drive, const char *cause, cau_effects *effects)
{
	switch_off(drive, CAU_ENERGY_OFF_WATCHDOG, cause, effects);
	// `frozen` is reported at once, as is energy off. The core stops the tool in the worker's next
	// act.
	drive->freeze = drive->frozen = true;
	cau_effect_wake(effects);
}

void cau_drive_cut_client(cau_logic *logic, uint32_t client, const char *cause,
                          cau_effects *effects)
{
	if (client == logic->lockstep)
		cau_drive_end_lockstep(logic);
	for (int32_t i = 0; i < logic->drive_count; i++)
		if (client && logic->drives[i].driver.client == client)
			cut_lost(&logic->drives[i], cause, effects);
}

static double silent_from_s(const cau_drive *drive)
{
	CAU_ASSERT(drive->driver.deadline_s >= 0, "a deadline of %g s", drive->driver.deadline_s);
	return drive->alive_s + drive->driver.deadline_s;
}

static bool is_in_lockstep(const cau_logic *logic, const cau_drive *drive)
{
	return logic->lockstep && drive->driver.client == logic->lockstep;
}

// True if the next tick would exceed the deadline of the client in lock-step, counted in ticks
// since its advance. While the client asks for no tick, none begins, however long it waits.
static bool has_overrun(const cau_logic *logic, const cau_drive *drive)
{
	double most = fmax(floor(drive->driver.deadline_s / logic->step_s * (1 + 1e-9)), 1);
	return logic->steps_left > 0 && (double)(logic->tick - logic->advance_tick) >= most;
}

bool cau_drive_is_silent(const cau_logic *logic, const cau_drive *drive, double now_s)
{
	if (!drive->enabled)
		return false;
	return is_in_lockstep(logic, drive) ? has_overrun(logic, drive) : silent_from_s(drive) <= now_s;
}

void cau_drive_cut_silent(cau_logic *logic, double now_s, cau_effects *effects)
{
	for (int32_t i = 0; i < logic->drive_count; i++) {
		cau_drive *drive = &logic->drives[i];
		if (cau_drive_is_silent(logic, drive, now_s))
			cut_lost(drive, "the driver sent no heartbeat in time",
			         effects); // the watchdog's cut-off for silence
	}
}

// Turns energy off where the limit of an enable is reached. A newer enable that still waits counts,
// because the limit belongs to the earlier enable.
void cau_drive_cut_limits(cau_logic *logic, cau_effects *effects)
{
	for (int32_t i = 0; i < logic->drive_count; i++) {
		cau_drive *drive = &logic->drives[i];
		CAU_RULE(drive->enabled || !drive->limit_tick, "tool %s is off and has a limit",
		         drive->tool);
		if (drive->limit_tick && drive->limit_tick <= logic->tick)
			switch_off(drive, CAU_ENERGY_OFF_COMMANDED, "the limit of ticks is reached", effects);
	}
}

double cau_logic_look_s(const cau_logic *logic)
{
	double look_s = INFINITY;
	for (int32_t i = 0; i < logic->drive_count; i++)
		if (logic->drives[i].enabled && !is_in_lockstep(logic, &logic->drives[i]))
			look_s = fmin(look_s, silent_from_s(&logic->drives[i]));
	return look_s;
}

void cau_drive_forget(cau_logic *logic, uint32_t client, cau_effects *effects)
{
	if (client == logic->lockstep)
		cau_drive_end_lockstep(logic);
	for (int32_t i = 0; i < logic->drive_count; i++) {
		cau_drive *drive = &logic->drives[i];
		if (!client || drive->driver.client != client)
			continue;
		cut_lost(drive, "the driver is gone", effects);
		drive->driver = (cau_asker){0};
		cau_effect_tell(effects, drive);
	}
}

void cau_drive_alive(cau_logic *logic, uint32_t client, const char *tool, double time_s)
{
	for (int32_t i = 0; i < logic->drive_count; i++) {
		cau_drive *drive = &logic->drives[i];
		if (client && drive->driver.client == client && (!*tool || strcmp(drive->tool, tool) == 0))
			drive->alive_s = fmax(drive->alive_s, time_s);
	}
}

// ---- acts for the core --------------------------------------------------------------------------

static bool is_to_cut(const cau_drive *drive, bool forced)
{
	return drive->freeze || (drive->energized && !drive->enabled && (forced || !drive->by_order));
}

bool cau_drive_is_to_cut(const cau_logic *logic)
{
	for (int32_t i = 0; i < logic->drive_count; i++)
		if (is_to_cut(&logic->drives[i], true))
			return true;
	return false;
}

bool cau_drive_next_cut(cau_logic *logic, bool forced, cau_action *action)
{
	for (int32_t i = 0; i < logic->drive_count; i++) {
		cau_drive *drive = &logic->drives[i];
		if (!is_to_cut(drive, forced))
			continue;
		*action = (cau_action){.act = CAU_ACT_CUT,
		                       .was_energized = drive->energized && !drive->enabled,
		                       .drive = *drive};
		memcpy(logic->cutting, drive->tool, sizeof logic->cutting);
		// a request to stop the tool that comes during the act is a new request
		drive->freeze = false;
		CAU_RULE(action->act == CAU_ACT_CUT, "tool %s is cut by act %d", drive->tool,
		         (int)action->act);
		return true;
	}
	return false;
}

void cau_drive_cut_done(cau_logic *logic, cau_effects *effects)
{
	cau_drive *drive = cau_drive_find(logic, logic->cutting);
	CAU_RULE(drive != NULL, "tool %s is gone; tools come and go by the worker's own acts",
	         logic->cutting);
	drive->frozen = drive->cut_off == CAU_ENERGY_OFF_WATCHDOG;
	if (!drive->energized || drive->enabled)
		return;
	drive->energized = false;
	if (drive->energy_off == drive->cut_off)
		return;
	drive->energy_off = drive->cut_off; // energy was cut off before the core had the enable
	cau_effect_tell(effects, drive);
}

// Lets the worker turn the core's energy off, because the order that should turn it off will not be
// done.
void cau_drive_cut_itself(cau_logic *logic, const char *tool)
{
	cau_drive *drive = cau_drive_find(logic, tool);
	if (drive)
		drive->by_order = false;
}

// ---- permissions --------------------------------------------------------------------------------

static bool refuse(cau_action *action, cau_status status, int32_t code, const char *reason)
{
	action->act = CAU_ACT_REFUSE;
	action->code = code;
	cau_fail(&action->error, status, "params.tool", "%s", reason);
	return false;
}

static bool refuse_stranger(const cau_drive *drive, cau_action *action)
{
	char reason[160];
	if (!drive->driver.client)
		return refuse(action, CAU_BAD_STATE, CAU_RPC_NOT_DRIVER,
		              "the tool has no driver: call tool.take_over first");
	snprintf(reason, sizeof reason, "%s drives the tool", drive->driver.name);
	return refuse(action, CAU_BAD_STATE, CAU_RPC_NOT_DRIVER, reason);
}

// True if the order's enable is valid: no cut-off came after the order.
static bool counts(const cau_drive *drive, const cau_waiting *order)
{
	return !order->cut_moment && order->moment > drive->cut_moment;
}

static bool allows_enable(const cau_logic *logic, const cau_drive *drive, const cau_waiting *order,
                          cau_action *action)
{
	char reason[160];
	double alive_s = fmax(drive->alive_s, order->alive_s);
	if (!logic->store_takes) {
		snprintf(reason, sizeof reason, "the store is full: %.120s", logic->store_reason);
		return refuse(action, CAU_IO, CAU_RPC_STORE_FULL, reason);
	}
	// An enable that is followed by the driver's own off is accepted, so that both are answered and
	// logged in order. It enables nothing, and the off reaches the core before a tick begins.
	bool advances = order->asked.ask == CAU_ASK_ADVANCE;
	bool off_follows = drive->by_order && !order->cut_moment && !advances;
	if (!counts(drive, order) && !off_follows) {
		snprintf(reason, sizeof reason, "energy of the tool went off after this request: %s",
		         *drive->cut_cause ? drive->cut_cause : "the driver had left");
		return refuse(action, CAU_BAD_STATE, 0, reason);
	}
	// In lock-step only ticks count as time, and an advance starts their count.
	bool by_ticks = advances || is_in_lockstep(logic, drive);
	if (!by_ticks && alive_s + drive->driver.deadline_s <= logic->now_s)
		return refuse(action, CAU_BAD_STATE, 0,
		              "the driver sent no heartbeat in time after this request");
	return true;
}

static bool allows_take_over(const cau_drive *drive, const cau_asked *asked, cau_action *action)
{
	char reason[160];
	uint32_t driver = drive->driver.client;
	if (!driver || driver == asked->asker.client || asked->asker.role == CAU_ROLE_ADMIN)
		return true;
	snprintf(reason, sizeof reason, "%s drives the tool; only an admin can take it over",
	         drive->driver.name);
	return refuse(action, CAU_BAD_STATE, CAU_RPC_FORBIDDEN, reason);
}

// Refuses a tool if its name exists, or if the session has the most tools already. The core would
// refuse such a tool.
bool cau_drive_may_be_added(cau_logic *logic, const char *tool, cau_action *action)
{
	char reason[160];
	if (cau_drive_find(logic, tool)) {
		snprintf(reason, sizeof reason, "there is a tool \"%s\"", tool);
		refuse(action, CAU_ALREADY_EXISTS, 0, reason);
	} else if (logic->drive_count == CAU_MAX_TOOLS) {
		snprintf(reason, sizeof reason, "a session has at most %d tools", CAU_MAX_TOOLS);
		refuse(action, CAU_LIMIT, 0, reason);
	} else {
		return true;
	}
	snprintf(action->error.path, sizeof action->error.path, "params.name");
	return false;
}

bool cau_drive_allows(cau_logic *logic, const cau_waiting *order, cau_action *action)
{
	const cau_asked *asked = &order->asked;
	const cau_drive *drive = cau_drive_find(logic, asked->tool);
	char reason[160];
	if (!drive) {
		snprintf(reason, sizeof reason, "no tool `%s` in this session", asked->tool);
		return refuse(action, CAU_NOT_FOUND, 0, reason);
	}
	bool drives = drive->driver.client && drive->driver.client == asked->asker.client;
	CAU_RULE_INDEX(asked->ask, CAU_ASK_COUNT);
	switch (asked->ask) {
	case CAU_ASK_TOOL_KEEP:
	case CAU_ASK_TOOL_REMOVE:
		return drives || !drive->driver.client || refuse_stranger(drive, action);
	case CAU_ASK_TOOL_USE:
	case CAU_ASK_MOTION:
		return drives || refuse_stranger(drive, action);
	case CAU_ASK_ENERGY_ON:
		return drives ? allows_enable(logic, drive, order, action) : refuse_stranger(drive, action);
	case CAU_ASK_TAKE_OVER:
		return allows_take_over(drive, asked, action);
	case CAU_ASK_HAND_OVER:
		return drives || refuse(action, CAU_BAD_STATE, CAU_RPC_NOT_DRIVER,
		                        "only the driver of a tool can hand it over");
	default: // energy off and requests to the driver: any client with the role operate
		return true;
	}
}

static bool allows_part(cau_logic *logic, const cau_waiting *order, const cau_part *part,
                        cau_action *action)
{
	const cau_drive *drive = cau_drive_find(logic, part->tool);
	const cau_asker *asker = &order->asked.asker;
	char reason[160];
	if (!drive) {
		snprintf(reason, sizeof reason, "no tool `%s` in this session", part->tool);
		return refuse(action, CAU_NOT_FOUND, 0, reason);
	}
	bool drives = asker->client && drive->driver.client == asker->client;
	if ((part->uses || part->on) && !drives)
		return refuse_stranger(drive, action);
	return !part->on || allows_enable(logic, drive, order, action);
}

bool cau_drive_allows_parts(cau_logic *logic, const cau_waiting *order, cau_action *action)
{
	CAU_RULE(order->asked.part_count >= 0 && order->asked.part_count <= CAU_MAX_TOOLS,
	         "an advance with %d tools", order->asked.part_count);
	for (int32_t i = 0; i < order->asked.part_count; i++) {
		const cau_part *part = &order->asked.parts[i];
		if (allows_part(logic, order, part, action))
			continue;
		snprintf(action->error.path, sizeof action->error.path, "params.commands[%d].tool",
		         part->command);
		return false;
	}
	return true;
}

// ---- changes ------------------------------------------------------------------------------------

bool cau_drive_change(cau_drive *drive, const cau_waiting *order, const cau_asker *to,
                      cau_effects *effects)
{
	cau_drive_cut(drive, order->moment, CAU_ENERGY_OFF_TAKEN_OVER, "another driver", effects);
	if (drive->energized)
		return false;
	CAU_RULE(!drive->energized && !drive->enabled,
	         "tool %s changes its driver while its energy is on", drive->tool);
	drive->driver = *to;
	// A client that is handed a tool has given no sign of life for this tool yet.
	drive->alive_s = to->client == order->asked.asker.client ? order->alive_s : 0;
	cau_effect_tell(effects, drive);
	return true;
}

void cau_drive_enabled(cau_logic *logic, cau_drive *drive, const cau_waiting *order, uint64_t limit,
                       cau_effects *effects)
{
	CAU_RULE(order->asked.ask == CAU_ASK_ENERGY_ON || order->asked.ask == CAU_ASK_ADVANCE,
	         "order %d lights tool %s", (int)order->asked.ask, drive->tool);
	drive->energized = true;
	drive->alive_s = fmax(drive->alive_s, order->alive_s);
	bool drives = drive->driver.client == order->asked.asker.client;
	if (!drives || !counts(drive, order))
		return; // energy was cut off while the core took the enable; the cut-off is the next act
	drive->limit_tick = limit ? logic->tick + limit : 0;
	if (drive->enabled)
		return;
	drive->enabled = true;
	drive->frozen = drive->freeze = false;
	cau_effect_tell(effects, drive);
	cau_effect_armed(effects);
}

// Adds the drive of a new tool, whatever its name. Enables are void if they came before the tool
// was added, before all energy was cut off, or before the tool was turned off.
void cau_drive_add(cau_logic *logic, const cau_waiting *order)
{
	CAU_RULE(order->asked.tool[0] != 0, "a tool without a name, by order %llu",
	         (unsigned long long)order->asked.ticket);
	CAU_RULE_INDEX(logic->drive_count, CAU_MAX_TOOLS); // checked in cau_drive_may_be_added
	cau_drive *made = &logic->drives[logic->drive_count++];
	*made = (cau_drive){
		.alive_s = order->alive_s,
		.energy_off = CAU_ENERGY_OFF_NEVER_ENABLED,
		.cut_off = CAU_ENERGY_OFF_NEVER_ENABLED,
		.cut_moment = newest(newest(order->moment, order->off_moment), logic->all_off_moment)};
	memcpy(made->tool, order->asked.tool, sizeof made->tool);
	if (!order->gone)
		made->driver = order->asked.asker;
}

void cau_drive_remove(cau_logic *logic, const char *tool)
{
	cau_drive *gone = cau_drive_find(logic, tool);
	if (!gone)
		return;
	size_t after = (size_t)(&logic->drives[logic->drive_count] - (gone + 1));
	memmove(gone, gone + 1, after * sizeof *gone);
	logic->drive_count--;
	CAU_RULE(logic->drive_count >= 0, "%d tools", logic->drive_count);
}

// Makes one drive for each tool of the new state. Drivers keep tools of the same name. All energy
// is off. A tool that is energized in the new state is cut off before its first tick.
void cau_drive_match(cau_logic *logic, const cau_logic_event *event)
{
	cau_drive old[CAU_MAX_TOOLS];
	int32_t old_count = logic->drive_count;
	memcpy(old, logic->drives, sizeof old);
	CAU_RULE(event->tool_count >= 0 && event->tool_count <= CAU_MAX_TOOLS, "%d tools arrived",
	         event->tool_count);
	logic->drive_count = event->tool_count;
	for (int32_t i = 0; i < event->tool_count; i++) {
		cau_drive *made = &logic->drives[i];
		*made = (cau_drive){.energy_off = CAU_ENERGY_OFF_NEVER_ENABLED};
		for (int32_t j = 0; j < old_count; j++)
			if (strcmp(old[j].tool, event->tools[i].name) == 0)
				*made = old[j];
		memcpy(made->tool, event->tools[i].name, sizeof made->tool);
		made->cut_moment = newest(made->cut_moment, logic->all_off_moment);
		made->enabled = made->frozen = made->by_order = false;
		made->limit_tick = 0;
		made->energized = made->freeze = event->tools[i].energized;
		made->cut_off = CAU_ENERGY_OFF_RESTORED;
		snprintf(made->cut_cause, sizeof made->cut_cause, "%s", event->cause ? event->cause : "");
	}
}
