// SPDX-License-Identifier: GPL-3.0-or-later
// When a tick begins: by the clock while the session runs, by session.step while it is paused.
#include <math.h>

#include "cautery/assert.h"
#include "session/internal.h"

#define BEHIND_MOST_S 0.25 // more than this behind the wall is given up, not caught up

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

bool cau_time_resume(cau_logic *logic, const cau_waiting *order, cau_action *action)
{
	if (logic->state == CAU_SESSION_FAULTED)
		return refuse(action, CAU_FAULTED, logic->fault);
	if (logic->steps_left)
		return refuse(action, CAU_BAD_STATE, "the session is being stepped");
	if (order->overtaken)
		return refuse(action, CAU_BAD_STATE, "a later pause replaced this");
	action->changed = logic->state == CAU_SESSION_PAUSED;
	if (action->changed) {
		logic->state = CAU_SESSION_RUNNING;
		logic->next_step_s = logic->now_s;
	}
	return true;
}

bool cau_time_step(cau_logic *logic, const cau_asked *asked, cau_action *action)
{
	if (logic->state == CAU_SESSION_FAULTED)
		return refuse(action, CAU_FAULTED, logic->fault);
	if (logic->state != CAU_SESSION_PAUSED || logic->stepping)
		return refuse(
			action, CAU_BAD_STATE,
			"session.step needs a paused session without another step under way: pause it first");
	logic->steps_left = asked->ticks;
	CAU_RULE(logic->steps_left > 0, "%lld steps are asked for", (long long)logic->steps_left);
	logic->stepping = asked->ticket;
	return true;
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
	if (logic->stepping) // being stepped, or to be answered for it
		return 0;
	return logic->state == CAU_SESSION_RUNNING ? logic->next_step_s : INFINITY;
}
