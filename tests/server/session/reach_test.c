// SPDX-License-Identifier: GPL-3.0-or-later
// Breadth-first search through every state that a session's machine can reach. Two clients (one an
// admin) send orders, give signs of life, hide their page and disconnect. The store becomes full,
// has capacity again and commits. Time passes. The session steps, is rewound, stays and ends. The
// worker asks for acts, does them and is refused. All of this happens in every order. In each state
// and after each event, rules are checked that keep their own books (reach_rules.c).
//
// A search that closes is a proof: a state that it does not reach cannot occur with these events.
// With --long, two tools with all events close too, in half an hour of processor time and 1.6 GB.
// For one tool with a queue of two and all events, only the states nearest to the start are
// searched, and the printed line says "not closed".
//
// Why the searches are finite, and why this loses nothing:
//   - Moments, times and ticks matter only in comparison, and a state keeps just that: places among
//     the waiting orders, fresh or silent, how many ticks ahead (one; session.step: two).
//   - Values of the asker that an order does not use are left out (reach_state.c).
//   - The two tools differ by name and by which is cut off first. A state also represents the state
//     with the tools exchanged, and events are tried on both. So everything is found that can be
//     reached in either order.
//   - The queue holds one or two orders beside the order being served, or one order and one for a
//     later tick. Two tools are not searched with two orders. These are bounds, not symmetries. The
//     random sequences have queues of six.
//
// The random sequences (logic_test.c) cover the rest: adding and removing tools, motion, and orders
// that only pass through the queue (tissue, snapshots, questions, speed).
//     test_server_session_reach [--long | STATES_MOST]
#include <assert.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "server/session/reach_rules.h"
#include "server/session/reach_search.h"

enum {
	OFF = 1,           // any client turns energy off
	HAND = 2,          // clients hand tools over
	LOSS = 4,          // clients hide their page and disconnect
	STORE = 8,         // the store becomes full, and has capacity again
	PAUSE = 16,        // pause and resume
	GO = 32,           // rewinds, which succeed or fail
	FAULT = 64,        // steps end in numerical trouble
	LATER = 128,       // enables and offs for the next tick
	RESEND = 256,      // orders that may be resends
	STEP = 512,        // session.step
	END = 1024,        // the session is destroyed or lost, the daemon ends
	ALL = 2 * END - 1, // all events except LOCKSTEP
	LOCKSTEP = 2048,   // session.advance
	EVENTS_MOST = 128,
	STATES_OF_PART = 10000000,
	// most states of a search that should close; a search that reaches the limit fails
	STATES_HELD = 200000000,
};

typedef struct search {
	const char *name;
	int tools, capacity;
	unsigned with;
	// SHORT: always; LONG: with --long; PART: with --long, only the first states
	enum { SHORT, LONG, PART } how;
} search;

// First one tool with almost all events. Then two tools and longer queues, in parts that each leave
// out events which multiply the states of the others. Last the complete searches, which take long
// or cannot close.
static const search searches[] = {
	{"one tool, a queue of one", 1, 1, ALL & ~(unsigned)(RESEND | STEP | LATER | END), SHORT},
	{"one tool, a queue of one, resends", 1, 1,
     ALL & ~(unsigned)(STEP | END | HAND | FAULT | LATER), SHORT},
	{"one tool, a queue of one, later ticks, pause and store", 1, 1, OFF | PAUSE | STORE | LATER,
     SHORT},
	{"two tools, drivers", 2, 1, OFF | HAND, SHORT},
	{"two tools, pause and step", 2, 1, OFF | PAUSE | STEP, SHORT},
	{"two tools, losses", 2, 1, OFF | LOSS, SHORT},
	{"two tools, store and going back", 2, 1, STORE | GO, SHORT},
	{"two tools, later ticks", 2, 1, LATER, SHORT},
	{"one tool, a queue of two, pause and store", 1, 2, OFF | PAUSE | STORE, SHORT},
	{"one tool, a queue of two, resends", 1, 2, OFF | RESEND, SHORT},
	{"one tool, off at later ticks, losses", 1, 1, OFF | LOSS | HAND | LATER, SHORT},
	{"one tool, lock-step, losses, pause and step", 1, 1, OFF | LOSS | PAUSE | STEP | LOCKSTEP,
     SHORT},
	{"one tool, lock-step, drivers, store and going back", 1, 1, HAND | STORE | GO | LOCKSTEP,
     SHORT},
	{"one tool, a queue of two, lock-step and pause", 1, 2, PAUSE | LOCKSTEP, LONG},
	{"two tools, lock-step and pause", 2, 1, PAUSE | LOCKSTEP, LONG},
	{"one tool, lock-step, all but later ticks", 1, 1, (ALL & ~(unsigned)LATER) | LOCKSTEP, PART},
	{"one tool, a queue of one, all but later ticks", 1, 1, ALL & ~(unsigned)LATER, LONG},
	{"one tool, a queue of one, everything", 1, 1, ALL, PART},
	{"one tool, a queue of two, all but later ticks", 1, 2, ALL & ~(unsigned)LATER, PART},
	{"two tools, a queue of one, all but later ticks", 2, 1, ALL & ~(unsigned)LATER, LONG},
};

// ---- the events of a search ---------------------------------------------------------------------

static reach_event events[EVENTS_MOST];
static int event_count;

static void add(reach_event made)
{
	assert(event_count < EVENTS_MOST);
	events[event_count++] = made;
}

// Adds an order, and with RESEND also the same order as a possible resend.
static void add_order(const search *s, reach_event made)
{
	made.what = REACH_ORDER;
	add(made);
	made.numbered = true;
	if (s->with & RESEND)
		add(made);
}

static void add_energy(const search *s, cau_ask ask, int client, int tool)
{
	add_order(s, (reach_event){.ask = ask, .client = client, .tool = tool});
	if (s->with & LATER)
		add((reach_event){.ask = ask, .client = client, .tool = tool, .later = 1});
}

// Adds advances with ticks only, and advances that turn each tool's energy on or off.
static void add_advances(const search *s, int client)
{
	reach_event advances = {.what = REACH_ORDER, .ask = CAU_ASK_ADVANCE, .client = client};
	if (!(s->with & LOCKSTEP))
		return;
	add(advances);
	for (advances.tool = 0; advances.tool < s->tools; advances.tool++) {
		advances.to = REACH_ON;
		add(advances);
		advances.to = REACH_OFF;
		add(advances);
	}
}

static void add_tool(const search *s, int client, int tool)
{
	reach_event takes = {.ask = CAU_ASK_TAKE_OVER, .client = client, .tool = tool};
	reach_event hands = {.ask = CAU_ASK_HAND_OVER, .client = client, .tool = tool};
	add_energy(s, CAU_ASK_ENERGY_ON, client, tool);
	add_order(s, takes);
	if (s->with & OFF)
		add_energy(s, CAU_ASK_ENERGY_OFF, client, tool);
	if (!(s->with & HAND))
		return;
	add(hands);
	hands.to = 1 + client % REACH_CLIENTS;
	add(hands);
}

static void add_client(const search *s, int client)
{
	for (int tool = 0; tool < s->tools; tool++)
		add_tool(s, client, tool);
	add_advances(s, client);
	add((reach_event){.what = REACH_ALIVE, .client = client});
	if (!(s->with & LOSS))
		return;
	add((reach_event){.what = REACH_AWAY, .client = client});
	add((reach_event){.what = REACH_FORGET, .client = client});
}

// Returns the flag of a search that an event needs; 0: every search has the event.
static unsigned needs(reach_what what)
{
	static const unsigned of[REACH_WHAT_COUNT] = {
		[REACH_STORE] = STORE,   [REACH_COMMITTED] = RESEND, [REACH_POSTPONED] = RESEND,
		[REACH_FAULTED] = FAULT, [REACH_ARRIVE_OFF] = GO,    [REACH_ARRIVE_ENERGIZED] = GO,
		[REACH_STAY] = GO,       [REACH_DRAIN] = END,        [REACH_END] = END,
	};
	return of[what];
}

static void make_alphabet(const search *s)
{
	static const struct {
		unsigned with;
		cau_ask ask;
	} asks[] = {{PAUSE, CAU_ASK_PAUSE},
	            {PAUSE, CAU_ASK_RESUME},
	            {GO, CAU_ASK_GO},
	            {STEP, CAU_ASK_STEP},
	            {END, CAU_ASK_DESTROY}};
	event_count = 0;
	for (int client = 1; client <= REACH_CLIENTS; client++)
		add_client(s, client);
	for (size_t i = 0; i < sizeof asks / sizeof *asks; i++)
		if (s->with & asks[i].with)
			add_order(s, (reach_event){.ask = asks[i].ask, .client = 1});
	for (int what = REACH_SILENCE; what < REACH_WHAT_COUNT; what++)
		if (!needs((reach_what)what) || (s->with & needs((reach_what)what)))
			add((reach_event){.what = (reach_what)what});
}

// ---- the search ---------------------------------------------------------------------------------

static void print_event(const reach_event *e)
{
	fprintf(stderr, "  %s", reach_what_names[e->what]);
	if (e->client)
		fprintf(stderr, " (client %d)", e->client);
	if (e->what == REACH_ORDER)
		fprintf(stderr, ": ask %d, tool %d, to %d%s%s", (int)e->ask, e->tool, e->to,
		        e->later ? ", later" : "", e->numbered ? ", numbered" : "");
	fprintf(stderr, "\n");
}

// Prints the path to a state. Between two lines the tools may have been exchanged.
static void print_way(const reach_found *found, uint32_t number)
{
	if (!number)
		return;
	print_way(found, found->parents[number]);
	print_event(&events[found->by[number]]);
}

static void fail(const reach_found *found, uint32_t number, const reach_event *last,
                 const char *wrong)
{
	fprintf(stderr, "%s:\n", wrong);
	print_way(found, number);
	print_event(last);
}

// Chooses between a state and the same state with the tools exchanged. The choice is the same for
// both.
static void choose(const reach_state *state, reach_packed *chosen)
{
	reach_state swapped;
	reach_packed other;
	reach_pack(state, chosen);
	if (state->tool_count < REACH_TOOLS)
		return;
	reach_swap_tools(state, &swapped);
	reach_pack(&swapped, &other);
	if (other.word[1] < chosen->word[1] ||
	    (other.word[1] == chosen->word[1] && other.word[0] < chosen->word[0]))
		*chosen = other;
}

typedef struct searching {
	reach_found found;
	reach_move move;
	cau_logic *before; // machine of the state whose events are being tried
	uint64_t moves;
} searching;

// Applies every event to a state that was found. Returns false after an error, or if the search is
// full.
static bool expand(searching *s, const reach_state *from, uint32_t number)
{
	reach_decode(from, s->before);
	for (int i = 0; i < event_count; i++) {
		reach_state to;
		reach_packed chosen;
		if (!reach_can_be(&events[i], from))
			continue;
		reach_copy_machine(s->before, s->move.logic);
		s->move.books = *from;
		s->move.effects.count = 0;
		reach_do(&s->move, &events[i]);
		s->moves++;
		if (s->move.wrong) {
			fail(&s->found, number, &events[i], s->move.wrong);
			return false;
		}
		reach_encode(s->move.logic, &s->move.books, &to);
		choose(&to, &chosen);
		if (!reach_found_add(&s->found, &chosen, number, i))
			return false;
	}
	return true;
}

static bool expand_both(searching *s, uint32_t number)
{
	reach_state from, swapped;
	reach_unpack(&s->found.states[number], &from);
	reach_swap_tools(&from, &swapped);
	bool two = from.tool_count == REACH_TOOLS && memcmp(&from, &swapped, sizeof swapped) != 0;
	return expand(s, &from, number) && (!two || expand(s, &swapped, number));
}

static cau_logic *make_machine(void)
{
	cau_logic *made = calloc(1, cau_logic_bytes(REACH_QUEUE));
	if (!made)
		abort();
	return made;
}

// Runs one search. `bounded`: the search may end at its limit of states without failing.
static bool run(const search *what, uint32_t most, bool bounded)
{
	cau_logic *before = make_machine();
	searching s = {.before = before,
	               .move = {.logic = make_machine(), .scratch = make_machine(), .before = before}};
	const reach_state first = {.tool_count = (uint8_t)what->tools,
	                           .capacity = (uint8_t)what->capacity,
	                           .store_takes = 1,
	                           .state = CAU_SESSION_RUNNING};
	reach_packed packed;
	uint32_t number = 0;
	make_alphabet(what);
	reach_found_init(&s.found, most);
	choose(&first, &packed);
	reach_found_add(&s.found, &packed, 0, 0);
	while (number < s.found.count && expand_both(&s, number))
		number++;
	bool closed = number == s.found.count;
	printf("%s: %u states, %llu transitions, %s\n", what->name, s.found.count,
	       (unsigned long long)s.moves,
	       s.move.wrong ? s.move.wrong
	       : closed     ? "closed"
	                    : "not closed");
	free(before);
	free(s.move.logic);
	free(s.move.scratch);
	reach_found_finish(&s.found);
	return !s.move.wrong && (closed || bounded);
}

int main(int argc, char **argv)
{
	bool takes_long = argc > 1 && strcmp(argv[1], "--long") == 0, bounded = argc > 1 && !takes_long;
	uint32_t asked = bounded ? (uint32_t)strtoul(argv[1], NULL, 10) : 0;
	bool good = true;
	setvbuf(stdout, NULL, _IOLBF, 0);
	for (size_t i = 0; i < sizeof searches / sizeof *searches; i++) {
		bool part = bounded || searches[i].how == PART;
		uint32_t most = bounded ? asked : part ? STATES_OF_PART : STATES_HELD;
		if (bounded || (searches[i].how != SHORT) == takes_long)
			good = run(&searches[i], most, part) && good;
	}
	return good ? EXIT_SUCCESS : EXIT_FAILURE;
}
