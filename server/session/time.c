// SPDX-License-Identifier: GPL-3.0-or-later
// Decides when a tick begins: by the clock while the session runs, by session.step or
// session.advance while it is paused.
//
// session.advance puts a paused session in lock-step with the client that asks. During lock-step
// only this client's advances make ticks. So its silence is counted in ticks (drive.c), and no
// energy is delivered while the client computes. Lock-step ends when all energy is turned off, or
// when its client is lost. session.step and session.resume also end it, after turning energy off.
// Ticks that were asked for but not computed are then dropped: no tick begins with the energy of a
// client that no longer waits.
#include <math.h>

#include "cautery/assert.h"
#include "session/internal.h"

// Largest delay behind the wall clock that is caught up, s. A larger delay is dropped.
#define BEHIND_MOST_S 0.25

bool cau_time_is_due(const cau_logic *logic, double now_s)
{
	if (logic->state == CAU_SESSION_RUNNING)
		return now_s >= logic->next_step_s;
	return logic->state == CAU_SESSION_PAUSED && logic->steps_left > 0;
}

void cau_time_begin_tick(cau_logic *logic, double now_s)
{
	if (logic->state == CAU_SESSION_PAUSED) {
		logic->steps_left--;
		CAU_RULE(logic->steps_left >= 0, "%lld steps left", (long long)logic->steps_left);
		return;
	}
	double period_s = logic->step_s / logic->speed;
	CAU_RULE(period_s > 0, "a tick of %g s at speed %g", logic->step_s, logic->speed);
	logic->next_step_s += period_s;
	if (now_s - logic->next_step_s > fmax(BEHIND_MOST_S, period_s))
		logic->next_step_s = now_s;
}

void cau_time_end_tick(cau_logic *logic)
{
	CAU_RULE(logic->tick < UINT64_MAX, "tick %llu", (unsigned long long)logic->tick);
	logic->tick++;
}

static bool refuse(cau_action *action, cau_status status, const char *reason)
{
	action->act = CAU_ACT_REFUSE;
	cau_fail(&action->error, status, "", "%s", reason);
	return false;
}

bool cau_time_end_of_steps(cau_logic *logic, cau_action *action)
{
	CAU_RULE(logic->steps_left >= 0, "%lld steps left", (long long)logic->steps_left);
	bool faulted = logic->state == CAU_SESSION_FAULTED || logic->ended;
	if (!logic->stepping || (logic->steps_left && !faulted))
		return false;
	action->act = faulted ? CAU_ACT_STEP_FAILED : CAU_ACT_STEPPED;
	action->ticket = logic->stepping;
	logic->stepping = 0;
	return true;
}

// Ends lock-step before the order is served. Energy is cut off first, by a separate act. Then the
// present advance is answered. The order stays in the queue meanwhile.
static bool leave_lockstep(cau_logic *logic, const cau_waiting *order, cau_action *action,
                           cau_effects *effects)
{
	if (!logic->lockstep)
		return true;
	cau_drive_cut_energized(logic, order->moment, CAU_ENERGY_OFF_COMMANDED, "lock-step has ended",
	                        effects);
	CAU_RULE(!logic->lockstep && !logic->steps_left, "lock-step goes on, with %lld ticks",
	         (long long)logic->steps_left);
	return !cau_drive_next_cut(logic, true, action) && !cau_time_end_of_steps(logic, action);
}

bool cau_time_resume(cau_logic *logic, const cau_waiting *order, cau_action *action,
                     cau_effects *effects)
{
	if (logic->state == CAU_SESSION_FAULTED)
		return refuse(action, CAU_FAULTED, logic->fault);
	if (logic->steps_left && !logic->lockstep)
		return refuse(action, CAU_BAD_STATE, "the session is being stepped");
	if (order->overtaken)
		return refuse(action, CAU_BAD_STATE, "a later pause request replaced this request");
	if (!leave_lockstep(logic, order, action, effects))
		return false;
	action->changed = logic->state == CAU_SESSION_PAUSED;
	if (action->changed) {
		logic->state = CAU_SESSION_RUNNING;
		logic->next_step_s = logic->now_s;
	}
	return true;
}

bool cau_time_step(cau_logic *logic, const cau_waiting *order, cau_action *action,
                   cau_effects *effects)
{
	if (logic->state == CAU_SESSION_FAULTED)
		return refuse(action, CAU_FAULTED, logic->fault);
	if (logic->state != CAU_SESSION_PAUSED || (logic->stepping && !logic->lockstep))
		return refuse(action, CAU_BAD_STATE,
		              "session.step needs a paused session in which no other step runs: pause the "
		              "session first");
	if (!leave_lockstep(logic, order, action, effects))
		return false;
	logic->steps_left = order->asked.ticks;
	CAU_RULE(logic->steps_left > 0, "%lld steps are asked for", (long long)logic->steps_left);
	logic->stepping = order->asked.ticket;
	return true;
}

bool cau_time_advance(cau_logic *logic, const cau_waiting *order, cau_action *action)
{
	uint32_t client = order->asked.asker.client;
	if (logic->state == CAU_SESSION_FAULTED)
		return refuse(action, CAU_FAULTED, logic->fault);
	if (logic->lockstep && logic->lockstep != client)
		return refuse(action, CAU_BAD_STATE,
		              "another client advances this session in lock-step: session.step, "
		              "session.resume or session.pause ends that");
	if (logic->state != CAU_SESSION_PAUSED || logic->stepping)
		return refuse(action, CAU_BAD_STATE,
		              "session.advance needs a paused session without other ticks under way: "
		              "pause it, or wait for their answer");
	return cau_drive_allows_parts(logic, order, action);
}

// Begins the ticks of an advance. If its client was lost while the core took the commands, no tick
// is computed.
void cau_time_advanced(cau_logic *logic, const cau_waiting *order)
{
	CAU_RULE(!logic->stepping && !logic->steps_left && order->asked.ticks >= 0,
	         "an advance of %lld ticks while %lld are left", (long long)order->asked.ticks,
	         (long long)logic->steps_left);
	logic->stepping = order->asked.ticket;
	if (order->cut_moment)
		return;
	logic->steps_left = order->asked.ticks;
	logic->lockstep = order->asked.asker.client;
	logic->advance_tick = logic->tick;
}

bool cau_time_go(const cau_logic *logic, cau_action *action)
{
	return !logic->stepping || refuse(action, CAU_BAD_STATE, "the session is being stepped");
}

void cau_time_speed(cau_logic *logic, double speed, double now_s)
{
	CAU_RULE(speed > 0, "a speed of %g", speed);
	logic->speed = speed;
	logic->next_step_s = now_s;
}

double cau_time_due_s(const cau_logic *logic)
{
	if (logic->stepping) // the order's ticks are being computed, or its answer is due
		return 0;
	return logic->state == CAU_SESSION_RUNNING ? logic->next_step_s : INFINITY;
}
