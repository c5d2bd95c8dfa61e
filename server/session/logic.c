// SPDX-License-Identifier: GPL-3.0-or-later
// Takes the session's events one after the other, and gives the worker one act at a time.
#include "session/logic.h"

#include <math.h>
#include <stdio.h>

#include "cautery/assert.h"
#include "cautery/rpc_errors.h"
#include "session/internal.h"

size_t cau_logic_bytes(int32_t capacity)
{
	CAU_ASSERT(capacity > 0, "a queue of %d", capacity);
	return sizeof(cau_logic) + 2 * (size_t)capacity * sizeof(cau_waiting);
}

void cau_logic_init(cau_logic *logic, int32_t capacity)
{
	CAU_ASSERT(capacity > 0, "a queue of %d", capacity);
	// clears padding too, so that equal machines are equal byte by byte
	memset(logic, 0, sizeof *logic);
	logic->capacity = capacity;
	logic->state = CAU_SESSION_STARTING;
	logic->speed = 1;
	logic->step_s = 1.0 / 60;
	logic->store_takes = true;
}

// ---- events -------------------------------------------------------------------------------------

static void take_life(cau_logic *logic, uint32_t client, const char *tool, double time_s)
{
	cau_drive_alive(logic, client, tool, time_s);
	cau_queue_alive(logic, client, tool, time_s);
}

static void take_store(cau_logic *logic, const cau_logic_event *event, cau_effects *effects)
{
	logic->store_takes = event->store_takes;
	snprintf(logic->store_reason, sizeof logic->store_reason, "%s",
	         event->cause ? event->cause : "");
	if (!event->store_takes) // without the store, no client could control the energy
		cau_drive_cut_energized(logic, logic->moment, CAU_ENERGY_OFF_WATCHDOG, "the store is full",
		                        effects);
}

static void take_arrival(cau_logic *logic, const cau_logic_event *event, cau_effects *effects)
{
	CAU_RULE(event->step_s > 0, "arrived with ticks of %g s", event->step_s);
	cau_drive_match(logic, event);
	logic->state = event->state;
	logic->broken[0] = 0; // the new state is sound again
	logic->tick = event->tick;
	logic->step_s = event->step_s;
	logic->next_step_s = event->time_s;
	logic->going = false;
	cau_drive_end_lockstep(logic);
	for (int32_t i = 0; i < logic->drive_count; i++)
		cau_effect_tell(effects, &logic->drives[i]);
	cau_effect_wake(effects);
}

// Continues the session at its present tick, with energy off. The time of the suspension is not
// caught up.
static void take_stay(cau_logic *logic, double time_s, cau_effects *effects)
{
	logic->going = false;
	logic->next_step_s = fmax(logic->next_step_s, time_s);
	cau_effect_wake(effects);
}

// Cuts off the energy of silent drivers. This also comes before every sign of life: a sign that is
// read after the deadline does not undo the silence, however late the watchdog is. After a stop of
// the whole process, signs that waited in sockets may be read before the watchdog runs.
static void cut_silent(cau_logic *logic, double now_s, cau_effects *effects)
{
	cau_queue_cut_silent(logic, now_s);
	cau_drive_cut_silent(logic, now_s, effects);
}

static void take(cau_logic *logic, const cau_logic_event *event, cau_effects *effects)
{
	cau_logic_expect_sound(logic);
	CAU_RULE(event->kind != CAU_LOGIC_ORDER || event->asked, "event %d without an order",
	         (int)event->kind);
	const char *tool = event->tool ? event->tool : "", *cause = event->cause ? event->cause : "";
	effects->count = 0;
	logic->moment++;
	logic->now_s = fmax(logic->now_s, event->time_s);
	switch (event->kind) {
	case CAU_LOGIC_ORDER:
		cut_silent(logic, event->time_s, effects);
		// Any message about a tool is a sign of life for this tool, and an advance is one for all
		// tools.
		if (*event->asked->tool || event->asked->ask == CAU_ASK_ADVANCE)
			take_life(logic, event->asked->asker.client, event->asked->tool,
			          cau_order_alive_s(event->asked, event->time_s));
		cau_queue_take(logic, event->asked, effects);
		break;
	case CAU_LOGIC_ALIVE:
		cut_silent(logic, event->time_s, effects);
		take_life(logic, event->client, tool, event->alive_s > 0 ? event->alive_s : event->time_s);
		break;
	case CAU_LOGIC_AWAY:
		cau_drive_cut_client(logic, event->client, cause, effects);
		cau_queue_cut(logic, event->client);
		cau_effect_wake(effects); // the worker refuses the orders that are void now
		break;
	case CAU_LOGIC_FORGET:
		cau_drive_forget(logic, event->client, effects);
		cau_queue_cut(logic, event->client);
		cau_queue_forget(logic, event->client);
		cau_effect_wake(effects);
		break;
	case CAU_LOGIC_TIME:
		cut_silent(logic, event->time_s, effects);
		break;
	case CAU_LOGIC_STORE:
		take_store(logic, event, effects);
		break;
	case CAU_LOGIC_CANCEL:
		cau_queue_cancel(logic, event->client, event->number, effects);
		break;
	case CAU_LOGIC_COMMITTED:
		cau_queue_committed(logic, effects);
		break;
	case CAU_LOGIC_ARRIVED:
		take_arrival(logic, event, effects);
		break;
	case CAU_LOGIC_STAYED:
		take_stay(logic, event->time_s, effects);
		break;
	case CAU_LOGIC_FAULT:
		logic->going = false;
		cau_logic_fault(logic, cause, effects);
		break;
	case CAU_LOGIC_DRAIN:
		logic->draining = true;
		cau_drive_cut_energized(logic, logic->moment, CAU_ENERGY_OFF_WATCHDOG,
		                        "the daemon is ending", effects);
		cau_effect_wake(effects);
		break;
	case CAU_LOGIC_END:
		logic->ended = true;
		cau_effect_wake(effects);
		break;
	case CAU_LOGIC_EVENT_COUNT:
		CAU_RULE(false, "event %d is none", (int)event->kind);
	}
	cau_logic_expect_sound(logic);
}

void cau_logic_take(cau_logic *logic, const cau_logic_event *event, cau_effects *effects)
{
	cau_rule_guard guard;
	cau_rule_enter(&guard);
	if (setjmp(guard.place) == 0)
		take(logic, event, effects);
	else
		cau_logic_break_off(logic, guard.reason, event->asked ? event->asked->ticket : 0, false,
		                    effects);
	cau_rule_leave(&guard);
}

// ---- the worker's next act ----------------------------------------------------------------------

static bool refuse(cau_action *action, cau_status status, int32_t code, const char *path,
                   const char *reason)
{
	action->act = CAU_ACT_REFUSE;
	action->code = code;
	cau_fail(&action->error, status, path, "%s", reason);
	return false;
}

static bool needs_sound_core(cau_ask ask)
{
	return ask == CAU_ASK_TISSUE || ask == CAU_ASK_TOOL_ADD || ask == CAU_ASK_TOOL_KEEP ||
	       ask == CAU_ASK_TOOL_REMOVE || ask == CAU_ASK_TOOL_USE || ask == CAU_ASK_MOTION ||
	       ask == CAU_ASK_ENERGY_ON;
}

static bool is_about_tool(cau_ask ask)
{
	return ask >= CAU_ASK_TOOL_KEEP && ask <= CAU_ASK_REQUEST_TAKEOVER;
}

// Pauses the session. Energy is cut off first, by a separate act. The order stays in the queue
// until all energy is off.
static bool pause(cau_logic *logic, const cau_waiting *order, cau_action *action,
                  cau_effects *effects)
{
	cau_drive_cut_energized(logic, order->moment, CAU_ENERGY_OFF_COMMANDED, "paused", effects);
	if (cau_drive_next_cut(logic, true, action))
		return false;
	cau_queue_overtake(logic, order->moment);
	action->changed = logic->state == CAU_SESSION_RUNNING;
	if (action->changed)
		logic->state = CAU_SESSION_PAUSED;
	return true;
}

// Turns the tool's energy off. An energy-off for a given tick turns energy off only here, even if
// the tool was enabled after the order arrived. Any other energy-off has turned energy off on
// arrival.
static void turn_off(cau_logic *logic, const cau_waiting *order, cau_effects *effects)
{
	cau_drive *drive = cau_drive_find(logic, order->asked.tool);
	CAU_RULE(drive != NULL, "the energy of tool %s was to go off, and there is no such tool",
	         order->asked.tool);
	if (drive->enabled || drive->cut_moment < order->moment)
		cau_drive_cut(drive, order->moment, CAU_ENERGY_OFF_COMMANDED, "turned off", effects);
}

static bool change_driver(cau_logic *logic, const cau_waiting *order, cau_action *action,
                          cau_effects *effects)
{
	const cau_asked *asked = &order->asked;
	cau_drive *drive = cau_drive_find(logic, asked->tool);
	CAU_RULE(drive != NULL, "tool %s was to change its driver, and there is no such tool",
	         asked->tool);
	bool takes = asked->ask == CAU_ASK_TAKE_OVER;
	cau_asker to = takes || !order->to_gone ? takes ? asked->asker : asked->to : (cau_asker){0};
	if (takes && order->gone)
		return refuse(action, CAU_BAD_STATE, 0, "", "the client that sent this request is gone");
	action->changed = drive->driver.client != to.client;
	const cau_drive before = *drive;
	// If energy is on, the driver cannot change before a cut-off. The tool's `energized` is then
	// set, so cau_drive_next_cut finds a cut-off.
	if (action->changed && !cau_drive_change(drive, order, &to, effects))
		return !cau_drive_next_cut(logic, true, action);
	if (action->changed)
		cau_queue_change_hands(logic, &before, order->moment);
	action->drive = *drive;
	return true;
}

// Removes a tool. If its energy is on, a cut-off comes first, because the core removes the tool
// only in its next tick.
static bool remove_tool(cau_logic *logic, const cau_waiting *order, cau_action *action,
                        cau_effects *effects)
{
	cau_drive *drive = cau_drive_find(logic, order->asked.tool);
	CAU_RULE(drive != NULL, "tool %s was to be removed, and there is no such tool",
	         order->asked.tool);
	if (!drive->energized)
		return true;
	cau_drive_cut(drive, order->moment, CAU_ENERGY_OFF_COMMANDED, "the tool was removed", effects);
	return !cau_drive_next_cut(logic, true, action);
}

// Refuses an order that has become void. For an enable, drive.c gives the reason.
static bool refuse_void(const cau_waiting *order, cau_action *action)
{
	static const char *const causes[] = {
#define X(code, words) words,
		CAU_VOID_CAUSE_TABLE(X)
#undef X
	};
	CAU_RULE(order->cut_moment != 0, "order %llu is void since no moment",
	         (unsigned long long)order->asked.ticket);
	return refuse(action, CAU_BAD_STATE, 0, "", causes[order->void_cause]);
}

// Fills the action for an order. Returns true if the order itself is served now. Returns false if
// another act comes first, or if the order is refused.
static bool decide(cau_logic *logic, const cau_waiting *order, cau_action *action,
                   cau_effects *effects)
{
	const cau_asked *asked = &order->asked;
	CAU_RULE_INDEX(asked->ask, CAU_ASK_COUNT);
	action->act = CAU_ACT_ORDER;
	if (logic->ended)
		return refuse(action, CAU_NOT_FOUND, CAU_RPC_NOT_HERE, "params.session",
		              "the session is destroyed");
	if (*logic->broken && asked->ask != CAU_ASK_DESTROY && asked->ask != CAU_ASK_GO)
		return refuse(action, CAU_FAULTED, 0, "", logic->fault);
	if (asked->numbered && !order->looked) {
		action->act = CAU_ACT_LOOK;
		return false;
	}
	// Drivers that are silent by now are cut off first. In lock-step, their silence would be
	// counted in ticks instead.
	if (asked->ask == CAU_ASK_ADVANCE && !logic->lockstep)
		cut_silent(logic, logic->now_s, effects);
	if (order->cut_moment &&
	    (asked->ask != CAU_ASK_ENERGY_ON || order->void_cause != CAU_VOIDED_LOST))
		return refuse_void(order, action);
	if (is_about_tool(asked->ask) && !cau_drive_allows(logic, order, action))
		return false;
	if (logic->state == CAU_SESSION_FAULTED && needs_sound_core(asked->ask))
		return refuse(action, CAU_FAULTED, 0, "", logic->fault);
	if (asked->ask == CAU_ASK_TOOL_ADD && !cau_drive_may_be_added(logic, asked->tool, action))
		return false;
	const cau_drive *drive = cau_logic_drive(logic, asked->tool);
	action->was_energized = drive && drive->energized;
	switch (asked->ask) {
	case CAU_ASK_TAKE_OVER:
	case CAU_ASK_HAND_OVER:
		return change_driver(logic, order, action, effects);
	case CAU_ASK_TOOL_REMOVE:
		return remove_tool(logic, order, action, effects);
	case CAU_ASK_ENERGY_OFF:
		turn_off(logic, order, effects);
		return true;
	case CAU_ASK_PAUSE:
		return pause(logic, order, action, effects);
	case CAU_ASK_RESUME:
		return cau_time_resume(logic, order, action, effects);
	case CAU_ASK_STEP:
		return cau_time_step(logic, order, action, effects);
	case CAU_ASK_ADVANCE:
		return cau_time_advance(logic, order, action);
	case CAU_ASK_GO:
		return cau_time_go(logic, action);
	case CAU_ASK_SPEED:
		cau_time_speed(logic, asked->speed, logic->now_s);
		return true;
	default:
		return true;
	}
}

static void serve(cau_logic *logic, cau_waiting *order)
{
	CAU_RULE(logic->serving.moment == 0, "order %llu is being served still",
	         (unsigned long long)logic->serving.asked.ticket);
	logic->serving = *order;
	cau_queue_remove(logic, order);
}

// Fills the action for one order of this border. Returns false if there is none.
static bool next_order(cau_logic *logic, cau_action *action, cau_effects *effects)
{
	cau_waiting *order = cau_queue_head(logic);
	if (!order)
		return false;
	action->ticket = order->asked.ticket;
	action->motion = order->asked.ask == CAU_ASK_MOTION;
	if (decide(logic, order, action, effects) || action->act == CAU_ACT_REFUSE)
		serve(logic, order);
	else if (action->act == CAU_ACT_LOOK)
		logic->serving = *order; // the order stays in the queue meanwhile
	return true;
}

static bool next_tick(cau_logic *logic, double now_s, cau_action *action, cau_effects *effects)
{
	if (!cau_time_is_due(logic, now_s))
		return false;
	cut_silent(logic, now_s, effects);
	cau_drive_cut_limits(logic, effects);
	if (cau_drive_next_cut(logic, true, action))
		return true;
	const cau_waiting *waits = cau_queue_find_ask(logic, CAU_ASK_PAUSE);
	if (waits) { // the pause came during this border: no tick begins after it
		logic->border_moment = waits->moment;
		return next_order(logic, action, effects);
	}
	cau_time_begin_tick(logic, now_s);
	CAU_RULE(!cau_drive_is_to_cut(logic), "tick %llu begins with energy that was cut",
	         (unsigned long long)logic->tick);
	logic->border = false;
	action->act = CAU_ACT_STEP;
	return true;
}

// Fills the action for an order to pause that came while the queue was full and was answered then.
static bool next_wanted_pause(cau_logic *logic, cau_action *action, cau_effects *effects)
{
	const cau_waiting wanted = {.moment = logic->pause_moment};
	if (!logic->pause_moment)
		return false;
	// Earlier orders come first, because an older order to resume must not undo the pause.
	if (logic->border_moment < logic->pause_moment)
		logic->border_moment = logic->pause_moment;
	const cau_waiting *head = cau_queue_head(logic);
	if (head && head->moment < logic->pause_moment)
		return false;
	action->act = CAU_ACT_PAUSE;
	if (pause(logic, &wanted, action, effects))
		logic->pause_moment = 0;
	return true;
}

// The order of these lines is a rule: cut-offs before orders, orders before the tick.
static bool next_act(cau_logic *logic, double now_s, cau_action *action, cau_effects *effects)
{
	if (logic->ended)
		return cau_time_end_of_steps(logic, action) || next_order(logic, action, effects);
	if (logic->state == CAU_SESSION_STARTING || logic->going)
		return false;
	return cau_drive_next_cut(logic, logic->state == CAU_SESSION_FAULTED, action) ||
	       next_wanted_pause(logic, action, effects) || cau_time_end_of_steps(logic, action) ||
	       next_order(logic, action, effects) || next_tick(logic, now_s, action, effects);
}

static void next(cau_logic *logic, double now_s, cau_action *action, cau_effects *effects)
{
	cau_logic_expect_sound(logic);
	CAU_RULE(logic->acting == CAU_ACT_NOTHING, "act %d is not done", (int)logic->acting);
	effects->count = 0;
	*action = (cau_action){.act = CAU_ACT_NOTHING};
	logic->moment++;
	logic->now_s = fmax(logic->now_s, now_s);
	if (!logic->border)
		logic->border_moment = logic->moment;
	logic->border = true;
	if (!next_act(logic, now_s, action, effects))
		logic->border = false;
	logic->acting = action->act;
	cau_logic_expect_sound(logic);
}

void cau_logic_next(cau_logic *logic, double now_s, cau_action *action, cau_effects *effects)
{
	cau_rule_guard guard;
	cau_rule_enter(&guard);
	if (setjmp(guard.place) == 0) {
		next(logic, now_s, action, effects);
	} else {
		*action = (cau_action){.act = CAU_ACT_NOTHING};
		cau_logic_break_off(logic, guard.reason, logic->serving.asked.ticket, true, effects);
		cau_logic_end_act(logic);
	}
	cau_rule_leave(&guard);
}

// ---- the outcome of an act ----------------------------------------------------------------------

static void looked(cau_logic *logic, cau_outcome_kind outcome)
{
	cau_waiting *order = cau_queue_find(logic, logic->serving.asked.ticket);
	CAU_RULE(order != NULL, "order %llu is gone; only the worker takes orders out",
	         (unsigned long long)logic->serving.asked.ticket);
	if (outcome == CAU_DONE)
		order->looked = true;
	else if (outcome == CAU_POSTPONED)
		order->postponed = true;
	else
		cau_queue_remove(logic, order);
}

// Notes an advance that the core has accepted. Energy that the advance turns off was cut off when
// the advance arrived.
static void advance(cau_logic *logic, const cau_waiting *order, cau_effects *effects)
{
	for (int32_t i = 0; i < order->asked.part_count; i++) {
		const cau_part *part = &order->asked.parts[i];
		cau_drive *drive = cau_drive_find(logic, part->tool);
		CAU_RULE(drive != NULL, "tool %s was used and is not there", part->tool);
		if (part->uses)
			drive->frozen = false;
		if (part->on)
			cau_drive_enabled(logic, drive, order, part->limit, effects);
	}
	cau_time_advanced(logic, order);
}

static void take_effect(cau_logic *logic, cau_effects *effects)
{
	const cau_waiting *order = &logic->serving;
	cau_drive *drive = cau_drive_find(logic, order->asked.tool);
	CAU_RULE(order->moment != 0, "order %llu never came in",
	         (unsigned long long)order->asked.ticket);
	switch (order->asked.ask) {
	case CAU_ASK_TOOL_ADD:
		cau_drive_add(logic, order);
		break;
	case CAU_ASK_TOOL_REMOVE:
		cau_drive_remove(logic, order->asked.tool);
		cau_queue_remove_tool(logic, order->asked.tool, order->moment);
		break;
	case CAU_ASK_TOOL_USE:
	case CAU_ASK_MOTION:
		CAU_RULE(drive != NULL, "tool %s was moved and is not there", order->asked.tool);
		drive->frozen = false;
		break;
	case CAU_ASK_ENERGY_ON:
		CAU_RULE(drive != NULL, "tool %s was enabled and is not there", order->asked.tool);
		cau_drive_enabled(logic, drive, order, order->asked.limit, effects);
		break;
	case CAU_ASK_ENERGY_OFF:
		CAU_RULE(drive != NULL, "tool %s was turned off and is not there", order->asked.tool);
		drive->energized = false;
		drive->by_order = drive->by_order && cau_queue_off_waits(logic, order->asked.tool);
		break;
	case CAU_ASK_GO:
		logic->going = true;
		cau_drive_cut_energized(logic, order->moment, CAU_ENERGY_OFF_RESTORED,
		                        "the session was rewound or reset", effects);
		break;
	case CAU_ASK_DESTROY:
		logic->ended = true;
		cau_drive_cut_energized(logic, logic->moment, CAU_ENERGY_OFF_COMMANDED, "destroyed",
		                        effects);
		break;
	case CAU_ASK_ADVANCE:
		advance(logic, order, effects);
		break;
	default:
		break;
	}
}

static void done(cau_logic *logic, double now_s, cau_outcome_kind outcome, cau_effects *effects)
{
	cau_logic_expect_sound(logic);
	cau_act act = logic->acting;
	effects->count = 0;
	logic->moment++;
	logic->now_s = fmax(logic->now_s, now_s);
	CAU_RULE(act != CAU_ACT_NOTHING && act != CAU_ACT_STEP, "act %d is done", (int)act);
	if (act == CAU_ACT_LOOK)
		looked(logic, outcome);
	else if (act == CAU_ACT_CUT)
		cau_drive_cut_done(logic, effects);
	else if (act == CAU_ACT_ORDER && outcome == CAU_DONE)
		take_effect(logic, effects);
	if (outcome != CAU_DONE && logic->serving.asked.ask == CAU_ASK_ENERGY_OFF)
		cau_drive_cut_itself(logic, logic->serving.asked.tool);
	cau_logic_end_act(logic);
	cau_logic_expect_sound(logic);
}

void cau_logic_done(cau_logic *logic, double now_s, cau_outcome_kind outcome, cau_effects *effects)
{
	cau_rule_guard guard;
	cau_rule_enter(&guard);
	if (setjmp(guard.place) == 0) {
		done(logic, now_s, outcome, effects);
	} else {
		cau_logic_break_off(logic, guard.reason, 0, false, effects);
		cau_logic_end_act(logic);
	}
	cau_rule_leave(&guard);
}

static void stepped(cau_logic *logic, double now_s, const char *reason, cau_effects *effects)
{
	cau_logic_expect_sound(logic);
	CAU_RULE(logic->acting == CAU_ACT_STEP, "act %d was no step", (int)logic->acting);
	effects->count = 0;
	logic->moment++;
	logic->now_s = fmax(logic->now_s, now_s);
	if (reason)
		cau_logic_fault(logic, reason, effects);
	else
		cau_time_end_tick(logic);
	cau_logic_end_act(logic);
	cau_logic_expect_sound(logic);
}

void cau_logic_stepped(cau_logic *logic, double now_s, const char *reason, cau_effects *effects)
{
	cau_rule_guard guard;
	cau_rule_enter(&guard);
	if (setjmp(guard.place) == 0) {
		stepped(logic, now_s, reason, effects);
	} else {
		cau_logic_break_off(logic, guard.reason, 0, false, effects);
		cau_logic_end_act(logic);
	}
	cau_rule_leave(&guard);
}

double cau_logic_due_s(const cau_logic *logic)
{
	if (logic->ended)
		return logic->count || logic->stepping ? 0 : INFINITY;
	if (logic->draining)
		return INFINITY;
	if (logic->going || logic->state == CAU_SESSION_STARTING)
		return 0;
	if (logic->pause_moment || cau_drive_is_to_cut(logic) || cau_queue_is_due(logic))
		return 0;
	return cau_time_due_s(logic);
}
