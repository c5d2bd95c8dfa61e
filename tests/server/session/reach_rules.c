// SPDX-License-Identifier: GPL-3.0-or-later
#include "server/session/reach_rules.h"

#include <assert.h>
#include <math.h>
#include <string.h>

#include "server/session/reach_books.h"

const char *const reach_what_names[REACH_WHAT_COUNT] = {
	"orders",         "lives",          "looks away",  "is gone",
	"all are silent", "watchdog looks", "store",       "committed",
	"work early",     "work",           "done",        "refused",
	"postponed",      "faulted",        "arrived off", "arrived energized",
	"stays",          "drains",         "ends"};

static void must(reach_move *m, bool holds, const char *otherwise)
{
	if (!holds && !m->wrong)
		m->wrong = otherwise;
}

static bool drives_are_as_before(const reach_move *m, bool but_for_life)
{
	const cau_logic *before = m->silence_is_cut ? m->scratch : m->before;
	for (int32_t i = 0; i < m->logic->drive_count; i++) {
		cau_drive now = m->logic->drives[i];
		if (but_for_life)
			now.alive_s = before->drives[i].alive_s;
		if (memcmp(&now, &before->drives[i], sizeof now) != 0)
			return false;
	}
	return m->logic->drive_count == before->drive_count && m->logic->state == before->state &&
	       m->logic->lockstep == before->lockstep && m->logic->going == before->going &&
	       m->logic->stepping == before->stepping;
}

// ---- events that come in ------------------------------------------------------------------------

static bool has_effect(const reach_move *m, cau_effect_kind kind)
{
	for (int32_t i = 0; i < m->effects.count; i++)
		if (m->effects.list[i].kind == kind)
			return true;
	return false;
}

static bool has_left(const reach_move *m)
{
	return m->before->lockstep && !m->logic->lockstep;
}

// The end of lock-step drops its remaining ticks.
static void note_lockstep(reach_move *m)
{
	if (has_left(m))
		m->books.steps = 0;
}

static void take(reach_move *m, cau_logic_event taken)
{
	taken.time_s = REACH_NOW_S;
	cau_logic_take(m->logic, &taken, &m->effects);
	note_lockstep(m);
	must(m, !*m->logic->broken, "a safety rule is broken");
	bool idle = m->before->acting == CAU_ACT_NOTHING;
	bool newly_due = cau_logic_due_s(m->before) > 0 && cau_logic_due_s(m->logic) == 0;
	must(m, !idle || !newly_due || has_effect(m, CAU_EFFECT_WAKE), "the worker is not woken");
}

// Notes the immediate results of an order that came in.
static void note_coming(reach_move *m, const reach_event *e, bool queued)
{
	bool off = e->ask == CAU_ASK_ENERGY_OFF, pause = e->ask == CAU_ASK_PAUSE;
	if (m->before->ended)
		return;
	// if the queue is full, an off for a later tick takes effect now
	if (off && (!e->later || !queued))
		reach_switch_off(&m->books, e->tool, 0);
	if (e->ask == CAU_ASK_ADVANCE && e->to == REACH_OFF)
		reach_switch_off(&m->books, e->tool, 0);
	if (pause && !queued)
		reach_switch_all_off(&m->books, 0);
	if (pause || (e->ask == CAU_ASK_RESUME && queued))
		m->books.held = pause;
	if (queued)
		m->books.orders[m->books.order_count++] = (reach_order){.ask = (uint8_t)e->ask,
		                                                        .client = (uint8_t)e->client,
		                                                        .tool = (uint8_t)e->tool,
		                                                        .to = (uint8_t)e->to,
		                                                        .later = (uint8_t)e->later};
}

// Prepares the state for comparison: `scratch` becomes `before` with the energy off of drivers that
// were silent by now.
static void expect_silence_cut(reach_move *m)
{
	cau_effects ignored;
	reach_copy_machine(m->before, m->scratch);
	cau_logic_take(m->scratch, &(cau_logic_event){.kind = CAU_LOGIC_TIME, .time_s = REACH_NOW_S},
	               &ignored);
	m->silence_is_cut = true;
}

static void do_order(reach_move *m, const reach_event *e)
{
	bool about_tool = e->ask >= CAU_ASK_TOOL_ADD && e->ask <= CAU_ASK_REQUEST_TAKEOVER;
	bool advances = e->ask == CAU_ASK_ADVANCE, turns_off = advances && e->to == REACH_OFF;
	cau_asked asked = {.ticket = 50,
	                   .ask = e->ask,
	                   .asker = *reach_asker(e->client),
	                   .to = *reach_asker(advances ? 0 : e->to),
	                   .part_count = advances && e->to,
	                   .tick = e->later ? REACH_TICK + (uint64_t)e->later : 0,
	                   .ticks = e->ask == CAU_ASK_STEP || advances ? 2 : 0,
	                   .numbered = e->numbered};
	if (about_tool)
		strcpy(asked.tool, reach_tool_names[e->tool]);
	if (asked.part_count) {
		asked.parts[0].on = e->to == REACH_ON;
		asked.parts[0].off = turns_off;
		strcpy(asked.parts[0].tool, reach_tool_names[e->tool]);
	}
	reach_note_silence(&m->books); // a sign of life after the deadline does not undo the silence
	take(m, (cau_logic_event){.kind = CAU_LOGIC_ORDER, .asked = &asked});
	bool off = e->ask == CAU_ASK_ENERGY_OFF, pause = e->ask == CAU_ASK_PAUSE;
	bool refused = has_effect(m, CAU_EFFECT_REFUSE);
	bool queued = m->logic->count > m->before->count;
	must(m, !refused || !(off || pause) || m->before->ended, "energy off or pause is refused");
	must(m, refused || !m->before->ended, "what has ended takes an order");
	if (refused)
		expect_silence_cut(m);
	must(m, !refused || (!queued && (turns_off || drives_are_as_before(m, true))),
	     "refused, and yet it changed");
	must(m, refused + queued + has_effect(m, CAU_EFFECT_UNSTORED) == 1, "not one answer");
	note_coming(m, e, queued);
}

static void lose(reach_move *m, int client, bool for_good)
{
	reach_switch_all_off(&m->books, client);
	take(m, (cau_logic_event){.kind = for_good ? CAU_LOGIC_FORGET : CAU_LOGIC_AWAY,
	                          .client = (uint32_t)client});
	must(m, m->logic->lockstep != (uint32_t)client, "a lost client is in lock-step");
}

static void do_store(reach_move *m)
{
	bool takes = !m->before->store_takes;
	if (!takes)
		reach_switch_all_off(&m->books, 0);
	take(m, (cau_logic_event){.kind = CAU_LOGIC_STORE, .store_takes = takes});
	must(m, takes || !m->logic->lockstep, "a full store leaves lock-step");
}

static void arrive(reach_move *m, bool energized)
{
	cau_arrived_tool tools[REACH_TOOLS] = {0};
	for (int i = 0; i < m->books.tool_count; i++) {
		strcpy(tools[i].name, reach_tool_names[i]);
		tools[i].energized = energized;
		m->books.tools[i].heated = energized;
		m->books.tools[i].wanted = 0;
	}
	take(m, (cau_logic_event){.kind = CAU_LOGIC_ARRIVED,
	                          .state = m->before->state,
	                          .tick = REACH_TICK,
	                          .step_s = REACH_STEP_S,
	                          .tools = tools,
	                          .tool_count = m->books.tool_count});
}

static void end(reach_move *m, bool drain)
{
	if (drain)
		reach_switch_all_off(&m->books, 0);
	take(m, (cau_logic_event){.kind = drain ? CAU_LOGIC_DRAIN : CAU_LOGIC_END});
}

// ---- the worker begins an act -------------------------------------------------------------------

static bool off_waits(const reach_move *m, int tool)
{
	for (int i = 0; i < m->books.order_count; i++)
		if (m->books.orders[i].ask == CAU_ASK_ENERGY_OFF && m->books.orders[i].tool == tool &&
		    !m->books.orders[i].later)
			return true;
	return false;
}

// Checks the start of a tick. Exactly the wanted tools have energy. After a pause only ticks of
// session.step begin.
static void check_step(reach_move *m)
{
	bool stepped = m->before->state == CAU_SESSION_PAUSED;
	bool held = m->books.held && !reach_waits_postponed(&m->books, CAU_ASK_PAUSE);
	must(m, !held || stepped, "a tick begins after a pause");
	must(m, !stepped || m->books.steps, "a tick that nobody asked for");
	must(m, !m->before->ended, "a tick begins after the end");
	for (int i = 0; i < m->books.tool_count; i++) {
		const reach_tool *tool = &m->books.tools[i];
		const cau_drive *drive = &m->logic->drives[i];
		bool should = tool->wanted && tool->driver && !reach_is_silent(&m->books, tool);
		must(m, !tool->heated || should, "a tick begins with a tool energized that is not to be");
		must(m, tool->heated || !should, "a tick begins with a tool off that is to be energized");
		must(m, !drive->freeze && drive->energized == drive->enabled,
		     "a tick begins with a cut owed");
	}
	if (stepped && m->books.steps)
		m->books.steps--;
}

// Checks that the worker rests only if there is nothing to do. After the session's end, the worker
// only gives answers.
static void check_rest(reach_move *m)
{
	for (int i = 0; i < m->books.tool_count && !m->logic->ended; i++) {
		const cau_drive *drive = &m->logic->drives[i];
		bool owed = drive->freeze || (m->books.tools[i].heated && !drive->enabled);
		must(m, !owed || (!drive->freeze && off_waits(m, i)),
		     "the worker rests, and a cut is owed");
	}
	if (cau_logic_due_s(m->logic) > 0)
		return;
	reach_copy_machine(m->logic, m->scratch);
	cau_logic_next(m->scratch, REACH_NOW_S, &m->action, &m->effects);
	must(m, m->action.act != CAU_ACT_NOTHING, "the worker spins");
	m->action.act = CAU_ACT_NOTHING;
}

static void check_order(reach_move *m)
{
	const reach_order *order = &m->books.orders[m->action.ticket - 1];
	bool changes = order->ask == CAU_ASK_TAKE_OVER || order->ask == CAU_ASK_HAND_OVER;
	must(m, !order->later || m->before->ended, "an order is done before its tick");
	must(m, !order->looks, "it may be a resend, and is done");
	if (order->ask == CAU_ASK_ENERGY_OFF)
		reach_switch_off_before(&m->books, order->tool, (int)m->action.ticket);
	if (m->action.changed && changes) {
		must(m, !m->books.tools[order->tool].heated,
		     "a tool changes its driver while it is energized");
		reach_switch_off_before(&m->books, order->tool, (int)m->action.ticket);
	}
}

static void check_decision(reach_move *m)
{
	switch (m->action.act) {
	case CAU_ACT_REFUSE:
		if (m->books.orders[m->action.ticket - 1].ask == CAU_ASK_ADVANCE && !m->before->lockstep &&
		    !m->before->ended)
			expect_silence_cut(m);
		must(m, drives_are_as_before(m, false), "refused, and yet it changed");
		reach_drop_order(&m->books, (int)m->action.ticket);
		break;
	case CAU_ACT_ORDER:
		check_order(m);
		m->books.serves = (uint8_t)m->action.ticket;
		break;
	case CAU_ACT_STEPPED:
		must(m, !m->books.steps && m->before->stepping, "stepped too little");
		break;
	case CAU_ACT_STEP_FAILED:
		must(m, m->before->stepping, "nobody steps");
		m->books.steps = 0;
		break;
	default:
		break;
	}
}

// Notes energy that goes off when the worker begins a change of driver or a pause, even if the
// client that asked is gone before the order ends. Energy also goes off if the worker finds a
// silence before the watchdog does.
static void note_cut_begun(reach_move *m)
{
	int place = reach_head(&m->books);
	const reach_order none = {0}, *order = place ? &m->books.orders[place - 1] : &none;
	bool changes = order->ask == CAU_ASK_TAKE_OVER || order->ask == CAU_ASK_HAND_OVER;
	for (int i = 0; i < m->books.tool_count; i++) {
		bool pauses = m->before->pause_moment || order->ask == CAU_ASK_PAUSE;
		bool by_order = pauses || (changes && order->tool == i);
		if (!m->before->drives[i].enabled || m->logic->drives[i].enabled || has_left(m))
			continue;
		if (m->books.pause_place) // this pause has no entry among the orders
			reach_switch_off_before(&m->books, i, m->books.pause_place);
		else if (by_order)
			reach_switch_off_before(&m->books, i, place);
		else
			reach_switch_off(&m->books, i, m->books.tools[i].driver);
	}
}

// Notes the end of lock-step by a pause, a step or a resume, which make earlier enables void.
static void note_left(reach_move *m)
{
	int place = reach_head(&m->books), pause = m->books.pause_place;
	if (!has_left(m))
		return;
	cau_ask ask = place ? (cau_ask)m->books.orders[place - 1].ask : CAU_ASK_COUNT;
	bool leaves = ask == CAU_ASK_PAUSE || ask == CAU_ASK_STEP || ask == CAU_ASK_RESUME;
	bool by_order = leaves && (!pause || place < pause);
	must(m, by_order || pause, "lock-step ends, and nobody ended it");
	for (int i = 0; i < m->books.tool_count; i++)
		reach_switch_off_before(&m->books, i, by_order ? place : pause);
}

// Notes that the worker checks for silence before lock-step begins.
static void note_look(reach_move *m)
{
	int place = reach_head(&m->books);
	bool decided = m->action.ticket == (uint64_t)place &&
	               (m->action.act == CAU_ACT_ORDER || m->action.act == CAU_ACT_REFUSE);
	if (place && decided && m->books.orders[place - 1].ask == CAU_ASK_ADVANCE &&
	    !m->before->lockstep && !m->before->ended && !*m->before->broken)
		reach_note_silence(&m->books);
}

static void work(reach_move *m, double now_s)
{
	cau_logic_next(m->logic, now_s, &m->action, &m->effects);
	note_lockstep(m);
	note_left(m);
	note_look(m);
	cau_act act = m->action.act;
	bool early = now_s < REACH_TICK_S;
	bool rested = act == CAU_ACT_NOTHING, pending = cau_logic_due_s(m->before) == 0;
	must(m, !early || rested || pending || m->before->draining, "there is work, and it is not due");
	must(m, act != CAU_ACT_STEP || !early || m->before->stepping, "a tick begins too early");
	if (act == CAU_ACT_CUT)
		note_cut_begun(m);
	check_decision(m);
	if (act == CAU_ACT_STEP)
		check_step(m);
	if (rested)
		check_rest(m);
}

// ---- the worker ends an act ---------------------------------------------------------------------

static void note_order_done(reach_move *m, bool done)
{
	int place = m->books.serves;
	const reach_order order = m->books.orders[place - 1];
	reach_tool *tool = &m->books.tools[order.tool];
	reach_drop_order(&m->books, place);
	m->books.serves = 0;
	if (!done)
		return;
	if (order.ask == CAU_ASK_ENERGY_ON || (order.ask == CAU_ASK_ADVANCE && order.to == REACH_ON)) {
		tool->heated = 1;
		tool->wanted = tool->wanted || (!order.overtaken && tool->driver == order.client);
	} else if (order.ask == CAU_ASK_ENERGY_OFF) {
		tool->heated = 0;
		reach_switch_off_before(&m->books, order.tool, place);
	} else if (order.ask == CAU_ASK_GO || order.ask == CAU_ASK_PAUSE) {
		for (int i = 0; i < m->books.tool_count; i++)
			// enables that came after the order stay valid
			reach_switch_off_before(&m->books, i, place);
	} else if (order.ask == CAU_ASK_STEP) {
		m->books.steps = order.ticks;
	} else if (order.ask == CAU_ASK_DESTROY) {
		reach_switch_all_off(&m->books, 0);
	}
}

// Notes the result of the search for an earlier answer. A pause that was answered before does not
// pause again.
static void note_looked(reach_move *m, reach_what what)
{
	reach_order *order = &m->books.orders[m->books.looks - 1];
	if (what == REACH_POSTPONED)
		order->postponed = 1;
	if (what != REACH_NOT_DONE)
		return;
	if (order->ask == CAU_ASK_PAUSE)
		m->books.held = 0;
	reach_drop_order(&m->books, m->books.looks);
}

static cau_outcome_kind outcome_of(reach_what what)
{
	return what == REACH_DONE ? CAU_DONE : what == REACH_NOT_DONE ? CAU_NOT_DONE : CAU_POSTPONED;
}

// Checks lock-step after an order. If the client of an advance was lost meanwhile, no ticks are
// computed for the advance.
static void note_lockstep_done(reach_move *m, const reach_order *order)
{
	bool ends = order->ask == CAU_ASK_PAUSE || order->ask == CAU_ASK_RESUME ||
	            order->ask == CAU_ASK_STEP || order->ask == CAU_ASK_GO;
	bool lost = order->overtaken || order->cut;
	must(m, !ends || !m->logic->lockstep, "lock-step outlives what ends it");
	if (order->ask != CAU_ASK_ADVANCE)
		return;
	must(m, lost || m->logic->lockstep == order->client, "an advance begins no lock-step");
	must(m, !order->cut || !m->logic->lockstep, "an advance of a lost client begins lock-step");
	m->books.steps = lost ? (uint8_t)m->logic->steps_left : order->ticks;
}

static void finish(reach_move *m, reach_what what)
{
	int acting = m->books.acting;
	const reach_order none = {0},
					  order = m->books.serves ? m->books.orders[m->books.serves - 1] : none;
	if (acting == CAU_ACT_CUT) {
		const cau_drive *drive = &m->before->drives[m->books.cutting];
		if (!drive->enabled)
			m->books.tools[m->books.cutting].heated = 0;
	} else if (acting == CAU_ACT_ORDER) {
		note_order_done(m, what == REACH_DONE);
	} else if (acting == CAU_ACT_LOOK) {
		note_looked(m, what);
	}
	cau_logic_done(m->logic, REACH_NOW_S, outcome_of(what), &m->effects);
	if (acting == CAU_ACT_ORDER && what == REACH_DONE)
		note_lockstep_done(m, &order);
}

static void step(reach_move *m, bool faulted)
{
	if (faulted)
		reach_switch_all_off(&m->books, 0);
	cau_logic_stepped(m->logic, REACH_NOW_S, faulted ? "it melts" : NULL, &m->effects);
	for (int i = 0; i < m->books.order_count && !faulted; i++)
		if (m->books.orders[i].later)
			m->books.orders[i].later--;
}

static void do_worker(reach_move *m, const reach_event *e)
{
	if (e->what == REACH_WORK_EARLY || e->what == REACH_WORK)
		work(m, e->what == REACH_WORK ? REACH_TICK_S : REACH_NOW_S);
	else if (m->books.acting == CAU_ACT_STEP)
		step(m, e->what == REACH_FAULTED);
	else
		finish(m, e->what);
}

// ---- all events ---------------------------------------------------------------------------------

static bool core_may_refuse(const reach_state *state)
{
	uint8_t ask = state->serves ? state->orders[state->serves - 1].ask : 0;
	return state->serves && (ask == CAU_ASK_ENERGY_ON || ask == CAU_ASK_ENERGY_OFF ||
	                         ask == CAU_ASK_GO || ask == CAU_ASK_DESTROY || ask == CAU_ASK_ADVANCE);
}

static bool is_postponed(const reach_state *state)
{
	for (int i = 0; i < state->order_count; i++)
		if (state->orders[i].postponed)
			return true;
	return false;
}

bool reach_can_be(const reach_event *e, const reach_state *state)
{
	bool acts = state->acting != CAU_ACT_NOTHING, steps = state->acting == CAU_ACT_STEP;
	switch (e->what) {
	case REACH_WORK_EARLY:
	case REACH_WORK:
		return !acts && !state->going;
	case REACH_DONE:
		return acts;
	case REACH_NOT_DONE:
		return core_may_refuse(state) || state->looks;
	case REACH_POSTPONED:
		return state->looks;
	case REACH_COMMITTED:
		return is_postponed(state);
	case REACH_FAULTED:
		return steps;
	case REACH_ARRIVE_OFF:
	case REACH_ARRIVE_ENERGIZED:
	case REACH_STAY:
		return state->going && !acts;
	case REACH_DRAIN:
		return !state->draining;
	case REACH_END:
		return !state->ended;
	default:
		return true;
	}
}

// Checks the rules that hold in every state.
static void check_state(reach_move *m)
{
	const cau_logic *logic = m->logic;
	bool answers_owed = logic->count > 0 || logic->stepping;
	bool work_waits = reach_head(&m->books) || logic->stepping || logic->pause_moment;
	must(m, logic->count >= 0 && logic->count <= 2 * logic->capacity, "the queue is overfull");
	must(m, m->effects.count <= CAU_EFFECTS_MOST, "too many effects");
	for (int i = 0; i < logic->drive_count; i++) {
		const cau_drive *drive = &logic->drives[i];
		must(m, !drive->enabled || drive->driver.client, "enabled, and nobody drives it");
		must(m, !drive->enabled || drive->energized, "enabled, and the core was not told");
		must(m, drive->energized == m->books.tools[i].heated,
		     "what the core was told is not known");
		bool by_ticks = logic->lockstep && drive->driver.client == logic->lockstep;
		must(m, !drive->enabled || by_ticks || cau_logic_look_s(logic) < INFINITY,
		     "nobody looks for silence");
		work_waits |= drive->freeze || (drive->energized && !drive->enabled);
	}
	work_waits = logic->ended ? answers_owed : work_waits && !logic->draining;
	must(m, !work_waits || cau_logic_due_s(logic) == 0, "there is work, and it is not due");
}

void reach_do(reach_move *m, const reach_event *e)
{
	m->silence_is_cut = false;
	switch (e->what) {
	case REACH_ORDER:
		do_order(m, e);
		break;
	case REACH_ALIVE:
		reach_note_silence(&m->books);
		take(m, (cau_logic_event){.kind = CAU_LOGIC_ALIVE, .client = (uint32_t)e->client});
		break;
	case REACH_AWAY:
	case REACH_FORGET:
		lose(m, e->client, e->what == REACH_FORGET);
		break;
	case REACH_SILENCE:
		m->logic->now_s += REACH_DEADLINE_S;
		break;
	case REACH_LOOK:
		reach_note_silence(&m->books);
		take(m, (cau_logic_event){.kind = CAU_LOGIC_TIME});
		break;
	case REACH_STORE:
		do_store(m);
		break;
	case REACH_COMMITTED:
		for (int i = 0; i < m->books.order_count; i++)
			m->books.orders[i].postponed = 0;
		take(m, (cau_logic_event){.kind = CAU_LOGIC_COMMITTED});
		break;
	case REACH_ARRIVE_OFF:
	case REACH_ARRIVE_ENERGIZED:
		arrive(m, e->what == REACH_ARRIVE_ENERGIZED);
		break;
	case REACH_STAY:
		take(m, (cau_logic_event){.kind = CAU_LOGIC_STAYED});
		break;
	case REACH_DRAIN:
	case REACH_END:
		end(m, e->what == REACH_DRAIN);
		break;
	default:
		do_worker(m, e);
		break;
	}
	check_state(m);
}
