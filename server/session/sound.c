// SPDX-License-Identifier: GPL-3.0-or-later
// Checks the conditions that hold between two calls, and handles a broken condition.
//
// A broken rule is a mistake of this program, and its extent is unknown. So this session alone is
// faulted. The energy of its tools is cut off by ordinary acts, as after numerical trouble. Waiting
// orders are refused one by one. If a rule breaks again while the worker asks for its next act, all
// waiting orders are dropped. Otherwise the worker would ask forever.
#include <stdio.h>

#include "cautery/assert.h"
#include "session/internal.h"

void cau_logic_fault(cau_logic *logic, const char *reason, cau_effects *effects)
{
	logic->state = CAU_SESSION_FAULTED;
	logic->steps_left = 0;
	snprintf(logic->fault, sizeof logic->fault, "%s", reason);
	cau_drive_cut_energized(logic, logic->moment, CAU_ENERGY_OFF_WATCHDOG, "the session is faulted",
	                        effects);
}

// Checks one tool. An enabled tool is also energized, and has a driver.
static void expect_sound_drive(const cau_logic *logic, const cau_drive *drive)
{
	CAU_RULE(drive->tool[0] != 0, "a tool of %d has no name", logic->drive_count);
	CAU_RULE(!drive->enabled || drive->energized, "tool %s is enabled and its energy is off",
	         drive->tool);
	CAU_RULE(!drive->enabled || drive->driver.client, "tool %s is enabled without a driver",
	         drive->tool);
	CAU_RULE(drive->driver.deadline_s >= 0, "tool %s has a deadline of %g s", drive->tool,
	         drive->driver.deadline_s);
	CAU_RULE(drive->cut_moment <= logic->moment, "tool %s is cut at moment %llu of %llu",
	         drive->tool, (unsigned long long)drive->cut_moment, (unsigned long long)logic->moment);
}

void cau_logic_expect_sound(const cau_logic *logic)
{
	CAU_RULE(logic->count >= 0 && logic->count <= 2 * logic->capacity, "%d orders in a queue of %d",
	         logic->count, logic->capacity);
	CAU_RULE(logic->drive_count >= 0 && logic->drive_count <= CAU_MAX_TOOLS, "%d tools",
	         logic->drive_count);
	CAU_RULE(logic->steps_left >= 0, "%lld steps left", (long long)logic->steps_left);
	CAU_RULE(!logic->lockstep || (logic->state == CAU_SESSION_PAUSED && !logic->going),
	         "lock-step of client %u in state %d", logic->lockstep, logic->state);
	CAU_RULE(!logic->lockstep || logic->advance_tick <= logic->tick,
	         "advanced at tick %llu of %llu", (unsigned long long)logic->advance_tick,
	         (unsigned long long)logic->tick);
	CAU_RULE(logic->step_s > 0 && logic->speed > 0, "ticks of %g s at speed %g", logic->step_s,
	         logic->speed);
	CAU_RULE(logic->all_off_moment <= logic->moment, "all energy went off at moment %llu of %llu",
	         (unsigned long long)logic->all_off_moment, (unsigned long long)logic->moment);
	for (int32_t i = 0; i < logic->drive_count; i++)
		expect_sound_drive(logic, &logic->drives[i]);
	for (int32_t i = 1; i < logic->count; i++)
		CAU_RULE(logic->waiting[i - 1].moment <= logic->waiting[i].moment,
		         "order %d came in before the one ahead of it", i);
}

// ---- after a broken rule ------------------------------------------------------------------------

// Turns the tool's energy off and requests a cut-off, even if `energized` says that the core does
// not heat. The state may be wrong, and the core is the part that heats.
static void take_energy_off(cau_logic *logic, cau_drive *drive)
{
	drive->tool[sizeof drive->tool - 1] = 0;
	drive->enabled = drive->by_order = drive->freeze = false;
	drive->energized = true;
	drive->limit_tick = 0;
	drive->driver.deadline_s = drive->driver.deadline_s >= 0 ? drive->driver.deadline_s : 0;
	drive->energy_off = drive->cut_off = CAU_ENERGY_OFF_WATCHDOG;
	drive->cut_moment = logic->moment;
	snprintf(drive->cut_cause, sizeof drive->cut_cause, "a safety rule was broken");
}

static void mend_drives(cau_logic *logic)
{
	int32_t kept = 0;
	if (logic->drive_count < 0 || logic->drive_count > CAU_MAX_TOOLS)
		logic->drive_count = 0;
	for (int32_t i = 0; i < logic->drive_count; i++) {
		cau_drive *drive = &logic->drives[i];
		if (!*drive->tool)
			continue;
		take_energy_off(logic, drive);
		logic->drives[kept++] = *drive;
	}
	logic->drive_count = kept;
	logic->all_off_moment = logic->moment;
}

static void mend_queue(cau_logic *logic, bool give_up)
{
	if (give_up || logic->count < 0 || logic->count > 2 * logic->capacity)
		logic->count = 0;
	for (int32_t i = 0; i < logic->count; i++) {
		cau_waiting *order = &logic->waiting[i];
		if (order->moment > logic->moment)
			order->moment = logic->moment;
		if (i && order->moment < logic->waiting[i - 1].moment)
			order->moment = logic->waiting[i - 1].moment;
	}
	logic->pause_moment = 0;
	logic->border = false;
}

static void mend_time(cau_logic *logic)
{
	logic->steps_left = 0;
	logic->lockstep = 0;
	logic->going = false;
	logic->step_s = logic->step_s > 0 ? logic->step_s : 1.0 / 60;
	logic->speed = logic->speed > 0 ? logic->speed : 1;
}

static bool waits(const cau_logic *logic, uint64_t ticket)
{
	for (int32_t i = 0; i < logic->count; i++)
		if (logic->waiting[i].asked.ticket == ticket)
			return true;
	return false;
}

// Refuses an order that arrived, or was taken out of the queue, when the rule broke. Its client
// waits for an answer.
static void refuse_lost(cau_logic *logic, uint64_t ticket, cau_effects *effects)
{
	if (!ticket || waits(logic, ticket))
		return;
	cau_effect *effect = cau_effect_add(effects, CAU_EFFECT_REFUSE, ticket);
	cau_fail(&effect->error, CAU_FAULTED, "", "%s", logic->fault);
}

void cau_logic_end_act(cau_logic *logic)
{
	memset(&logic->serving, 0, sizeof logic->serving);
	logic->acting = CAU_ACT_NOTHING;
}

void cau_logic_break_off(cau_logic *logic, const char *reason, uint64_t ticket, bool give_up,
                         cau_effects *effects)
{
	effects->count = 0;
	give_up = give_up && *logic->broken;
	if (!*logic->broken)
		snprintf(logic->broken, sizeof logic->broken, "%s", reason);
	snprintf(logic->fault, sizeof logic->fault, "a safety rule of the server was broken: %.250s",
	         logic->broken);
	mend_drives(logic);
	mend_queue(logic, give_up);
	mend_time(logic);
	logic->state = CAU_SESSION_FAULTED;
	for (int32_t i = 0; i < logic->drive_count; i++)
		cau_effect_tell(effects, &logic->drives[i]);
	refuse_lost(logic, ticket, effects);
	cau_effect_wake(effects);
}
