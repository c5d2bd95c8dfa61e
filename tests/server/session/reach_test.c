// SPDX-License-Identifier: GPL-3.0-or-later
// Every state that a session's machine can come to, by breadth first: two clients (one an admin)
// order, live, look away and go, the store fills and empties, time passes, and the worker asks,
// does and is refused, in every order. In each state and after each event rules are checked that
// keep their own books. All searches close: what they do not reach cannot happen with these events.
//     test_server_session_reach [STATES_MOST]
#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "server/session/reach_state.h"

typedef enum what {
	ORDER,
	ALIVE,
	AWAY,
	FORGET,
	SILENCE,    // time passes until all are silent
	LOOK,       // the watchdog looks
	STORE,      // it fills, or has room again
	WORK_EARLY, // the worker asks before the next tick is due
	WORK,       // or when it is
	DONE,
	NOT_DONE, // by the core
	FAULTED,  // a step ends in numerical trouble
	ARRIVE_DARK,
	ARRIVE_LIT,
} what;

static const char *const what_names[] = {
	"orders",       "lives",      "looks away", "is gone", "all are silent", "the watchdog looks",
	"store",        "work early", "work",       "done",    "refused",        "faulted",
	"arrived dark", "arrived lit"};

typedef struct event {
	what what;
	cau_ask ask;
	int client, tool, to;
} event;

enum { EVENTS_MOST = 64 };

typedef struct search {
	const char *name;
	int tools, capacity;
	bool energy_off, hand_over, losses, store, pause, go, fault; // what there is beside the rest
} search;

// Everything with one tool; two tools and longer queues in parts, each without what multiplies the
// states of the others.
static const search searches[] = {
	{"one tool, a queue of one, everything", 1, 1, true, true, true, true, true, true, true},
	{"two tools, drivers", 2, 1, true, true, false, false, false, false, false},
	{"two tools, pause", 2, 1, true, false, false, false, true, false, false},
	{"two tools, losses", 2, 1, true, false, true, false, false, false, false},
	{"one tool, a queue of two, pause and store", 1, 2, true, false, false, true, true, false,
     false},
};

// ---- the alphabet -------------------------------------------------------------------------------

static event events[EVENTS_MOST];
static int event_count;

static void add(event made)
{
	assert(event_count < EVENTS_MOST);
	events[event_count++] = made;
}

static void add_orders(const search *s, int client, int tool)
{
	add((event){ORDER, CAU_ASK_ENERGY_ON, client, tool, 0});
	add((event){ORDER, CAU_ASK_TAKE_OVER, client, tool, 0});
	if (s->energy_off)
		add((event){ORDER, CAU_ASK_ENERGY_OFF, client, tool, 0});
	if (!s->hand_over)
		return;
	add((event){ORDER, CAU_ASK_HAND_OVER, client, tool, 0});
	add((event){ORDER, CAU_ASK_HAND_OVER, client, tool, 1 + client % REACH_CLIENTS});
}

static void make_alphabet(const search *s)
{
	event_count = 0;
	for (int client = 1; client <= REACH_CLIENTS; client++) {
		for (int tool = 0; tool < s->tools; tool++)
			add_orders(s, client, tool);
		add((event){ALIVE, 0, client, 0, 0});
		if (s->losses) {
			add((event){AWAY, 0, client, 0, 0});
			add((event){FORGET, 0, client, 0, 0});
		}
	}
	if (s->pause) {
		add((event){ORDER, CAU_ASK_PAUSE, 1, 0, 0});
		add((event){ORDER, CAU_ASK_RESUME, 1, 0, 0});
	}
	if (s->go)
		add((event){ORDER, CAU_ASK_GO, 1, 0, 0});
	for (what w = SILENCE; w <= ARRIVE_LIT; w++)
		if ((w != STORE || s->store) && (w != FAULTED || s->fault) && (w < ARRIVE_DARK || s->go))
			add((event){.what = w});
}

// ---- one event, and what must be true of it -----------------------------------------------------

typedef struct moving {
	cau_logic *logic, *before; // before: the event
	cau_action action;
	cau_effects effects;
	reach_state books;
	const char *wrong; // NULL: nothing
} moving;

static void must(moving *m, bool holds, const char *otherwise)
{
	if (!holds && !m->wrong)
		m->wrong = otherwise;
}

static int order_count(const reach_state *state)
{
	return state->serves + state->count;
}

// What came in before does not light the tool any more; `client`: what this one asked for.
static void darken(reach_state *books, int tool, int client)
{
	for (int i = 0; i < order_count(books); i++) {
		reach_order *order = &books->orders[i];
		if (order->ask == CAU_ASK_ENERGY_ON && order->tool == tool &&
		    (!client || order->client == client))
			order->overtaken = 1;
	}
	if (!client || books->tools[tool].driver == client)
		books->tools[tool].wanted = 0;
}

static void darken_all(reach_state *books, int client)
{
	for (int i = 0; i < books->tool_count; i++)
		darken(books, i, client);
}

static void note_silence(reach_state *books)
{
	for (int i = 0; i < books->tool_count; i++)
		if (books->tools[i].wanted && !books->tools[i].fresh)
			darken(books, i, books->tools[i].driver);
}

static void drop_first_order(reach_state *books)
{
	memmove(&books->orders[0], &books->orders[1], REACH_QUEUE * sizeof *books->orders);
	memset(&books->orders[REACH_QUEUE], 0, sizeof *books->orders);
}

static bool has_effect(const moving *m, cau_effect_kind kind)
{
	for (int32_t i = 0; i < m->effects.count; i++)
		if (m->effects.list[i].kind == kind)
			return true;
	return false;
}

static bool drives_are_as_before(const moving *m, bool but_for_life)
{
	for (int32_t i = 0; i < m->logic->drive_count; i++) {
		cau_drive now = m->logic->drives[i];
		if (but_for_life)
			now.alive_s = m->before->drives[i].alive_s;
		if (memcmp(&now, &m->before->drives[i], sizeof now) != 0)
			return false;
	}
	return m->logic->drive_count == m->before->drive_count && m->logic->state == m->before->state &&
	       m->logic->going == m->before->going;
}

static void take(moving *m, cau_logic_event taken)
{
	taken.time_s = REACH_NOW_S;
	cau_logic_take(m->logic, &taken, &m->effects);
	bool idle = m->before->acting == CAU_ACT_NOTHING;
	bool newly_due = cau_logic_due_s(m->before) > 0 && cau_logic_due_s(m->logic) == 0;
	must(m, !idle || !newly_due || has_effect(m, CAU_EFFECT_WAKE), "the worker is not woken");
}

static void do_order(moving *m, const event *e)
{
	bool about_tool = e->ask >= CAU_ASK_TOOL_ADD && e->ask <= CAU_ASK_REQUEST_TAKEOVER;
	cau_asked asked = {.ticket = 50, .ask = e->ask, .asker = reach_asker(e->client)};
	asked.to = reach_asker(e->to);
	if (about_tool)
		strcpy(asked.tool, reach_tool_names[e->tool]);
	take(m, (cau_logic_event){.kind = CAU_LOGIC_ORDER, .asked = &asked});
	bool off = e->ask == CAU_ASK_ENERGY_OFF, pause = e->ask == CAU_ASK_PAUSE;
	bool refused = has_effect(m, CAU_EFFECT_REFUSE);
	bool queued = m->logic->count > m->before->count;
	must(m, !refused || !(off || pause), "energy off or pause is refused");
	must(m, !refused || (!queued && drives_are_as_before(m, true)), "refused, and yet it changed");
	must(m, refused + queued + has_effect(m, CAU_EFFECT_UNSTORED) == 1, "not one answer");
	if (off)
		darken(&m->books, e->tool, 0);
	if (pause && !queued)
		darken_all(&m->books, 0);
	if (pause || (e->ask == CAU_ASK_RESUME && queued))
		m->books.held = pause;
}

static void lose(moving *m, int client, bool for_good)
{
	darken_all(&m->books, client);
	take(m, (cau_logic_event){.kind = for_good ? CAU_LOGIC_FORGET : CAU_LOGIC_AWAY,
	                          .client = (uint32_t)client});
}

static void do_store(moving *m)
{
	bool takes = !m->before->store_takes;
	if (!takes)
		darken_all(&m->books, 0);
	take(m, (cau_logic_event){.kind = CAU_LOGIC_STORE, .store_takes = takes});
}

static void arrive(moving *m, bool lit)
{
	cau_arrived_tool tools[REACH_TOOLS] = {0};
	for (int i = 0; i < m->books.tool_count; i++) {
		strcpy(tools[i].name, reach_tool_names[i]);
		tools[i].lit = lit;
		m->books.tools[i].heated = lit;
		m->books.tools[i].wanted = 0;
	}
	take(m, (cau_logic_event){.kind = CAU_LOGIC_ARRIVED,
	                          .state = m->before->state,
	                          .step_s = 0.0625,
	                          .tools = tools,
	                          .tool_count = m->books.tool_count});
}

// ---- the worker ---------------------------------------------------------------------------------

static bool off_waits(const moving *m, int tool)
{
	for (int i = 0; i < m->books.count; i++)
		if (m->books.orders[i].ask == CAU_ASK_ENERGY_OFF && m->books.orders[i].tool == tool)
			return true;
	return false;
}

// No tick begins with energy that nobody wants, nor without energy that somebody does.
static void check_step(moving *m)
{
	must(m, !m->books.held, "a tick begins after a pause");
	for (int i = 0; i < m->books.tool_count; i++) {
		const reach_tool *tool = &m->books.tools[i];
		const cau_drive *drive = &m->logic->drives[i];
		bool should = tool->wanted && tool->driver && tool->fresh;
		must(m, !tool->heated || should, "a tick begins with a tool lit that is not to be");
		must(m, tool->heated || !should, "a tick begins with a tool dark that is to be lit");
		must(m, !drive->freeze && drive->lit == drive->enabled, "a tick begins with a cut owed");
	}
}

// Whoever has work is told to do it: at once, or as soon as a border begins.
static void check_rest(moving *m)
{
	for (int i = 0; i < m->books.tool_count; i++) {
		const cau_drive *drive = &m->logic->drives[i];
		bool owed = drive->freeze || (m->books.tools[i].heated && !drive->enabled);
		must(m, !owed || (!drive->freeze && off_waits(m, i)),
		     "the worker rests, and a cut is owed");
	}
	if (cau_logic_due_s(m->logic) > 0)
		return;
	memcpy(m->before, m->logic, cau_logic_bytes(REACH_QUEUE));
	cau_logic_next(m->before, REACH_NOW_S, &m->action, &m->effects);
	must(m, m->action.act != CAU_ACT_NOTHING, "the worker spins");
	m->action.act = CAU_ACT_NOTHING;
}

static void check_decision(moving *m)
{
	const reach_order *order = &m->books.orders[0];
	if (m->action.act == CAU_ACT_REFUSE) {
		must(m, drives_are_as_before(m, false), "refused, and yet it changed");
		drop_first_order(&m->books);
	} else if (m->action.act == CAU_ACT_ORDER && m->action.changed &&
	           (order->ask == CAU_ASK_TAKE_OVER || order->ask == CAU_ASK_HAND_OVER)) {
		must(m, !m->books.tools[order->tool].heated, "a tool changes hands lit");
		m->books.tools[order->tool].wanted = 0;
	}
}

// A tool goes dark when its change of hands or a pause begins, even if who asked for that is gone
// before it ends; or since the worker sees a silence before the watchdog does.
static void note_cut_begun(moving *m)
{
	const reach_order *order = &m->books.orders[0];
	bool changes = order->ask == CAU_ASK_TAKE_OVER || order->ask == CAU_ASK_HAND_OVER;
	for (int i = 0; i < m->books.tool_count; i++) {
		bool pauses = m->books.pause_place || (m->books.count && order->ask == CAU_ASK_PAUSE);
		bool by_order = pauses || (m->books.count && changes && order->tool == i);
		if (!m->before->drives[i].enabled || m->logic->drives[i].enabled)
			continue;
		if (by_order)
			m->books.tools[i].wanted = 0;
		else
			darken(&m->books, i, m->books.tools[i].driver);
	}
}

static void work(moving *m, double now_s)
{
	cau_logic_next(m->logic, now_s, &m->action, &m->effects);
	cau_act act = m->action.act;
	bool early = now_s < REACH_TICK_S;
	bool rested = act == CAU_ACT_NOTHING;
	must(m, !early || rested || cau_logic_due_s(m->before) == 0,
	     "there is work, and it is not due");
	must(m, m->action.act != CAU_ACT_STEP || !early, "a tick begins too early");
	if (act == CAU_ACT_CUT)
		note_cut_begun(m);
	check_decision(m);
	if (act == CAU_ACT_STEP)
		check_step(m);
	if (rested)
		check_rest(m);
}

static void note_order_done(moving *m, bool done)
{
	const reach_order order = m->books.orders[0];
	reach_tool *tool = &m->books.tools[order.tool];
	drop_first_order(&m->books);
	m->books.serves = 0;
	if (!done)
		return;
	if (order.ask == CAU_ASK_ENERGY_ON) {
		tool->heated = 1;
		tool->wanted = tool->wanted || (!order.overtaken && tool->driver == order.client);
	} else if (order.ask == CAU_ASK_ENERGY_OFF) {
		tool->heated = 0;
	} else if (order.ask == CAU_ASK_GO || order.ask == CAU_ASK_PAUSE) {
		for (int i = 0; i < m->books.tool_count; i++)
			m->books.tools[i].wanted = 0; // what waits came in later, and counts
	}
}

static void finish(moving *m, bool done)
{
	int acting = m->books.acting;
	if (acting == CAU_ACT_CUT) {
		const cau_drive *drive = &m->before->drives[m->books.cutting];
		if (!drive->enabled)
			m->books.tools[m->books.cutting].heated = 0;
	} else if (acting == CAU_ACT_ORDER) {
		note_order_done(m, done);
	}
	cau_logic_done(m->logic, REACH_NOW_S, done ? CAU_DONE : CAU_NOT_DONE, &m->effects);
}

// ---- all of it ----------------------------------------------------------------------------------

static bool core_may_refuse(const reach_state *state)
{
	uint8_t ask = state->orders[0].ask;
	return state->serves &&
	       (ask == CAU_ASK_ENERGY_ON || ask == CAU_ASK_ENERGY_OFF || ask == CAU_ASK_GO);
}

static bool can_be(const event *e, const reach_state *state)
{
	bool acts = state->acting != CAU_ACT_NOTHING, steps = state->acting == CAU_ACT_STEP;
	switch (e->what) {
	case WORK_EARLY:
	case WORK:
		return !acts && !state->going;
	case DONE:
		return acts;
	case NOT_DONE:
		return core_may_refuse(state);
	case FAULTED:
		return steps;
	case ARRIVE_DARK:
	case ARRIVE_LIT:
		return state->going;
	default:
		return true;
	}
}

static void do_worker(moving *m, const event *e)
{
	bool steps = m->books.acting == CAU_ACT_STEP;
	if (e->what == WORK_EARLY || e->what == WORK) {
		work(m, e->what == WORK ? REACH_TICK_S : REACH_NOW_S);
	} else if (steps) {
		if (e->what == FAULTED)
			darken_all(&m->books, 0);
		cau_logic_stepped(m->logic, REACH_NOW_S, e->what == FAULTED ? "it melts" : NULL,
		                  &m->effects);
	} else if (e->what == DONE || e->what == NOT_DONE) {
		finish(m, e->what == DONE);
	} else {
		arrive(m, e->what == ARRIVE_LIT);
	}
}

static void do_event(moving *m, const event *e)
{
	switch (e->what) {
	case ORDER:
		do_order(m, e);
		break;
	case ALIVE:
		take(m, (cau_logic_event){.kind = CAU_LOGIC_ALIVE, .client = (uint32_t)e->client});
		break;
	case AWAY:
	case FORGET:
		lose(m, e->client, e->what == FORGET);
		break;
	case SILENCE:
		m->logic->now_s += REACH_DEADLINE_S;
		break;
	case LOOK:
		note_silence(&m->books);
		take(m, (cau_logic_event){.kind = CAU_LOGIC_TIME});
		break;
	case STORE:
		do_store(m);
		break;
	default:
		do_worker(m, e);
		break;
	}
}

// What is true of every state.
static void check_state(moving *m)
{
	const cau_logic *logic = m->logic;
	bool work_waits = logic->count > 0 || logic->pause_moment;
	must(m, logic->count >= 0 && logic->count <= logic->capacity, "the queue is overfull");
	must(m, m->effects.count <= CAU_EFFECTS_MOST, "too many effects");
	for (int i = 0; i < logic->drive_count; i++) {
		const cau_drive *drive = &logic->drives[i];
		must(m, !drive->enabled || drive->driver.client, "enabled, and nobody drives it");
		must(m, !drive->enabled || drive->lit, "enabled, and the core was not told");
		must(m, drive->lit == m->books.tools[i].heated, "what the core was told is not known");
		must(m, !drive->enabled || cau_logic_look_s(logic) < INFINITY, "nobody looks for silence");
		work_waits |= drive->freeze || (drive->lit && !drive->enabled);
	}
	must(m, !work_waits || cau_logic_due_s(logic) == 0, "there is work, and it is not due");
}

// ---- the search ---------------------------------------------------------------------------------

typedef struct found {
	reach_state *states;
	uint32_t *parents;
	uint8_t *by;     // the event that led from the parent
	uint32_t *slots; // open addressing; 0: free, else the state's number and 1
	uint32_t count, most, slot_count;
} found;

static void *make(size_t count, size_t bytes)
{
	void *made = calloc(count, bytes);
	if (!made)
		abort();
	return made;
}

static void find_begin(found *f, uint32_t most)
{
	f->most = most;
	f->count = 0;
	for (f->slot_count = 2; f->slot_count < 2 * most; f->slot_count *= 2)
		;
	f->states = make(most, sizeof *f->states);
	f->parents = make(most, sizeof *f->parents);
	f->by = make(most, 1);
	f->slots = make(f->slot_count, sizeof *f->slots);
}

static void find_end(found *f)
{
	free(f->states);
	free(f->parents);
	free(f->by);
	free(f->slots);
}

// FNV-1a, stirred so that the low bits are as good as the others.
static uint32_t hash_of(const reach_state *state)
{
	const unsigned char *bytes = (const unsigned char *)state;
	uint64_t hash = 0xcbf29ce484222325u;
	for (size_t i = 0; i < sizeof *state; i++)
		hash = (hash ^ bytes[i]) * 0x100000001b3u;
	return (uint32_t)(hash ^ (hash >> 32));
}

// False: there is no room for it.
static bool find_add(found *f, const reach_state *state, uint32_t parent, int by)
{
	uint32_t slot = hash_of(state) & (f->slot_count - 1);
	for (; f->slots[slot]; slot = (slot + 1) & (f->slot_count - 1))
		if (memcmp(&f->states[f->slots[slot] - 1], state, sizeof *state) == 0)
			return true;
	if (f->count == f->most)
		return false;
	f->states[f->count] = *state;
	f->parents[f->count] = parent;
	f->by[f->count] = (uint8_t)by;
	f->slots[slot] = ++f->count;
	return true;
}

static void print_event(const event *e)
{
	fprintf(stderr, "  %s", what_names[e->what]);
	if (e->client)
		fprintf(stderr, " (client %d)", e->client);
	if (e->what == ORDER)
		fprintf(stderr, ": ask %d, tool %d, to %d", (int)e->ask, e->tool, e->to);
	fprintf(stderr, "\n");
}

static void print_way(const found *f, uint32_t state)
{
	if (!state)
		return;
	print_way(f, f->parents[state]);
	print_event(&events[f->by[state]]);
}

static bool expand(found *f, uint32_t number, moving *m, uint64_t *moves)
{
	for (int i = 0; i < event_count; i++) {
		const reach_state from = f->states[number];
		reach_state to;
		if (!can_be(&events[i], &from))
			continue;
		reach_decode(&from, m->logic);
		memcpy(m->before, m->logic, cau_logic_bytes(REACH_QUEUE));
		m->books = from;
		m->effects.count = 0;
		do_event(m, &events[i]);
		check_state(m);
		++*moves;
		if (m->wrong) {
			fprintf(stderr, "%s:\n", m->wrong);
			print_way(f, number);
			print_event(&events[i]);
			return false;
		}
		reach_encode(m->logic, &m->books, &to);
		if (!find_add(f, &to, number, i))
			return true; // the search is full, and says so
	}
	return true;
}

static void begin(const search *s, found *f, moving *m)
{
	reach_state first = {.tool_count = (uint8_t)s->tools,
	                     .capacity = (uint8_t)s->capacity,
	                     .store_takes = 1,
	                     .state = CAU_SESSION_RUNNING};
	make_alphabet(s);
	*m = (moving){.logic = make(1, cau_logic_bytes(REACH_QUEUE)),
	              .before = make(1, cau_logic_bytes(REACH_QUEUE))};
	find_add(f, &first, 0, 0);
}

// `bounded`: that it is not over when there is no more room is no failure.
static bool run(const search *s, uint32_t most, bool bounded)
{
	found f;
	moving m;
	uint64_t moves = 0;
	uint32_t number = 0;
	find_begin(&f, most);
	begin(s, &f, &m);
	while (number < f.count && f.count < f.most && expand(&f, number, &m, &moves))
		number++;
	bool closed = number == f.count;
	printf("%s: %u states, %llu transitions, %s\n", s->name, f.count, (unsigned long long)moves,
	       m.wrong  ? m.wrong
	       : closed ? "closed"
	                : "not closed");
	free(m.logic);
	free(m.before);
	find_end(&f);
	return !m.wrong && (closed || bounded);
}

int main(int argc, char **argv)
{
	bool bounded = argc > 1;
	uint32_t most = bounded ? (uint32_t)strtoul(argv[1], NULL, 10) : 6000000;
	setvbuf(stdout, NULL, _IOLBF, 0);
	bool good = true;
	for (size_t i = 0; i < sizeof searches / sizeof *searches; i++)
		good = run(&searches[i], most, bounded) && good;
	return good ? EXIT_SUCCESS : EXIT_FAILURE;
}
