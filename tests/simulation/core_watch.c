// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulation/core_watch.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "hosted_session/internal.h"
#include "server/double/fake_session.h"
#include "simulation/books.h"
#include "simulation/faults.h"
#include "simulation/promises.h"

#define WRAPPED __attribute__((used))

enum { CORES_MOST = 32, FIBERS_WATCHED = 128 };
// Longest time, in addition to the longest step, that energy may stay on after the driver's
// deadline or a cut. A tick may be under way, and a thread may be stalled.
#define STILL_ON_MOST_NS (40 * SIM_MS)

// Longest time in which a running session must begin its next tick. With three sessions of at most
// 4 ms a step, even a single worker is idle for a quarter of the time, so a longer delay is a
// fault.
#define TICK_LATE_MOST_NS (300 * SIM_MS)

typedef struct core_book {
	const cau_session *core; // NULL if the entry is free
	char id[CAU_NAME_BYTES];
	int place, life, machine; // place: index of the session; -1: no such session
	const cau_logic *logic;   // logic of the session, once it is served
	bool running;             // the session ran by the clock at the worker's last decision
	int64_t began_ns;         // time of the session's newest tick, or when the session began to run
	bool served;              // the worker decides; false while the worker computes the past again
	int64_t wrong_ns[TOOLS];  // time since which energy is on without a reason; 0: no such energy
} core_book;

// The present activity of the running fiber.
typedef struct at_work {
	uint64_t fiber;
	cau_hosted *deciding; // the session for which the fiber is in cau_decide_next, else NULL
	bool applying; // true while the fiber carries out an order or one of the daemon's own commands
	// the core for which a tick was decided and is not computed yet; NULL: no such tick
	const cau_session *begun;
	energy allowed[TOOLS];
	int by_ticks[TOOLS]; // client whose lock-step alone allows energy; -1: no such client
} at_work;

static struct {
	core_book cores[CORES_MOST];
	at_work work[FIBERS_WATCHED];
	sim_random random;
	sim_profile profile;
} watched;

static at_work *work_of(uint64_t fiber)
{
	at_work *free_one = NULL;
	for (int i = 0; i < FIBERS_WATCHED; i++) {
		at_work *w = &watched.work[i];
		if (w->fiber == fiber)
			return w;
		if (!free_one && (!w->fiber || !sim_is_alive(w->fiber)))
			free_one = w;
	}
	assert(free_one);
	*free_one = (at_work){.fiber = fiber};
	return free_one;
}

static core_book *book_of(const cau_session *core)
{
	for (int i = 0; i < CORES_MOST; i++)
		if (watched.cores[i].core == core)
			return &watched.cores[i];
	return NULL;
}

// ---- hooks of the core's double
static void on_made(const cau_session_def *def, const cau_session *core)
{
	core_book *book = book_of(NULL);
	assert(book && def->user);
	*book = (core_book){.core = core, .machine = sim_machine()};
	snprintf(book->id, sizeof book->id, "%s", cau_hosted_id(def->user));
	book->place = sim_session_of(book->id);
	if (book->place < 0)
		return;
	book->life = sim_sessions[book->place].life;
	sim_books[book->place].full = false; // a new session begins with a store that accepts writes
}

// True if the session's name was not given to a newer session.
static bool is_present(const core_book *book)
{
	return book && book->place >= 0 && sim_sessions[book->place].life == book->life;
}

static void on_going(const cau_session *core)
{
	core_book *book = book_of(core);
	if (book)
		book->core = NULL;
}

static void on_taking(const cau_session *core, const cau_command *command)
{
	const core_book *book = book_of(core);
	if (!is_present(book) || command->kind != CAU_COMMAND_SET_GRAVITY)
		return;
	if (!work_of(sim_self())->applying)
		promises_counted.replays++;
	else
		books_apply(&sim_books[book->place], books_number(command->as.gravity_m_s2[2]));
}

static const char *promise_of(int place, energy found)
{
	const session_book *book = &sim_books[place];
	return book->full               ? "energy_full"
	       : book->restarted        ? "energy_restart"
	       : found == ENERGY_SILENT ? "energy_silent"
	                                : "energy_cut";
}

// Counts a tick with energy against the ticks that the client's lock-step requests allow.
static void charge_ticks(const core_book *book, unsigned clients)
{
	for (int c = 0; c < CLIENTS; c++)
		if (clients >> c & 1 && --sim_books[book->place].ticks_left[c] < 0)
			sim_fail("energy_silent",
			         "%s makes more ticks with energy on than client %d may be silent", book->id,
			         c);
}

// Checks a tool at the beginning of a tick. Returns the clients whose lock-step alone allows its
// energy, as bits.
static unsigned check_tool(const core_book *book, const cau_tool_state *tool, const at_work *work)
{
	unsigned by_ticks = 0;
	for (int t = 0; t < TOOLS; t++) {
		if (!tool->energized || strcmp(tool->name, sim_tools[t]) != 0)
			continue;
		promises_counted.energized_ticks++;
		if (work->allowed[t] != ENERGY_ALLOWED)
			sim_fail(promise_of(book->place, work->allowed[t]), "%s begins a tick with %s on; %s",
			         book->id, tool->name,
			         work->allowed[t] == ENERGY_SILENT ? "the driver sent no heartbeat in time"
			                                           : "no enable counts");
		if (work->by_ticks[t] >= 0)
			by_ticks |= 1u << work->by_ticks[t];
	}
	return by_ticks;
}

static void on_step(const cau_session *core)
{
	cau_frame frame;
	core_book *book = book_of(core);
	at_work *work = work_of(sim_self());
	sim_work(
		sim_between(&watched.random, watched.profile.step_least_ns, watched.profile.step_most_ns));
	bool replayed = work->begun != core;
	work->begun = NULL;
	if (book)
		book->served = !replayed;
	if (!is_present(book) || replayed)
		return;
	promises_counted.ticks++;
	sim_note((uint64_t)books_number(cau_fake_gravity(core)[2]));
	cau_session_frame(core, &frame);
	unsigned by_ticks = 0;
	for (int32_t i = 0; i < frame.tool_count; i++)
		by_ticks |= check_tool(book, &frame.tools[i], work);
	charge_ticks(book, by_ticks);
}

void core_watch_begin(uint64_t seed, const sim_profile *profile)
{
	memset(&watched, 0, sizeof watched);
	watched.random = sim_random_of(seed, 6);
	watched.profile = *profile;
	cau_fake_hooks_set =
		(cau_fake_hooks){.made = on_made, .going = on_going, .taking = on_taking, .step = on_step};
}

void core_watch_killed(int machine)
{
	for (int i = 0; i < CORES_MOST; i++)
		if (watched.cores[i].machine == machine)
			watched.cores[i].core = NULL;
}

// ---- activity of a worker
void __real_cau_decide_next(cau_hosted *h, cau_action *action);
void __wrap_cau_decide_next(cau_hosted *h, cau_action *action);
WRAPPED void __wrap_cau_decide_next(cau_hosted *h, cau_action *action)
{
	at_work *work = work_of(sim_self());
	work->deciding = h;
	__real_cau_decide_next(h, action);
	work->deciding = NULL;
}

// Compares the state at the first decision after a restart. A session that the daemon was still
// building when it shut down is not compared, because no client was served by it.
static void compare(const cau_hosted *h, const cau_logic *logic, int place)
{
	session_book *book = &sim_books[place];
	if (!book->restarted || !h->core.session || logic->draining || logic->ended ||
	    logic->state == CAU_SESSION_STARTING)
		return;
	books_compare(book, place, books_number(cau_fake_gravity(h->core.session)[2]));
	book->restarted = false;
}

static void see_server(int place, const char *id)
{
	if (sim_sessions[place].machine != sim_machine())
		sim_fail("one_server", "%s is stepped, and machine %d has it", id,
		         sim_sessions[place].machine);
}

static void note_decision(core_book *core, const cau_logic *logic, const cau_action *action)
{
	bool running = logic->state == CAU_SESSION_RUNNING && !logic->going && !logic->draining;
	if (action->act == CAU_ACT_STEP || !running || !core->running)
		core->began_ns = sim_now();
	core->running = running;
	core->served = true;
	core->logic = logic;
	int32_t waits = cau_logic_waiting(logic), most = 2 * (int32_t)watched.profile.queue_commands;
	if (waits > most)
		sim_fail("budget", "%d orders wait for %s, at most %d may", waits, core->id, most);
}

// Notes which energy is allowed at the moment at which the logic decides to begin a tick.
void __real_cau_logic_next(cau_logic *logic, double now_s, cau_action *action,
                           cau_effects *effects);
void __wrap_cau_logic_next(cau_logic *logic, double now_s, cau_action *action,
                           cau_effects *effects);
WRAPPED void __wrap_cau_logic_next(cau_logic *logic, double now_s, cau_action *action,
                                   cau_effects *effects)
{
	at_work *work = work_of(sim_self());
	__real_cau_logic_next(logic, now_s, action, effects);
	int place = work->deciding ? sim_session_of(cau_hosted_id(work->deciding)) : -1;
	if (place < 0)
		return;
	compare(work->deciding, logic, place);
	core_book *core = work->deciding->core.session ? book_of(work->deciding->core.session) : NULL;
	if (core)
		note_decision(core, logic, action);
	if (action->act != CAU_ACT_STEP)
		return;
	work->begun = work->deciding->core.session;
	see_server(place, cau_hosted_id(work->deciding));
	for (int t = 0; t < TOOLS; t++) {
		work->allowed[t] = promises_energy(place, t, sim_now());
		work->by_ticks[t] = promises_by_ticks(place, t, sim_now());
	}
}

cau_outcome_kind __real_cau_hosted_apply(cau_hosted *h, cau_order *order, const cau_action *action);
cau_outcome_kind __wrap_cau_hosted_apply(cau_hosted *h, cau_order *order, const cau_action *action);
WRAPPED cau_outcome_kind __wrap_cau_hosted_apply(cau_hosted *h, cau_order *order,
                                                 const cau_action *action)
{
	work_of(sim_self())->applying = true;
	cau_outcome_kind outcome = __real_cau_hosted_apply(h, order, action);
	work_of(sim_self())->applying = false;
	return outcome;
}

// ---- checks at any time
static void look_at(core_book *book, int64_t now_ns)
{
	cau_frame frame;
	cau_session_frame(book->core, &frame);
	for (int32_t i = 0; i < frame.tool_count; i++)
		for (int t = 0; t < TOOLS; t++) {
			if (strcmp(frame.tools[i].name, sim_tools[t]) != 0)
				continue;
			energy allowed = promises_energy(book->place, t, now_ns);
			if (!frame.tools[i].energized || allowed == ENERGY_ALLOWED)
				book->wrong_ns[t] = 0;
			else if (!book->wrong_ns[t])
				book->wrong_ns[t] = now_ns;
			else if (now_ns - book->wrong_ns[t] > STILL_ON_MOST_NS + watched.profile.step_most_ns)
				sim_fail(promise_of(book->place, allowed), "%s has %s on for %.3f s after %s",
				         book->id, sim_tools[t], 1e-9 * (double)(now_ns - book->wrong_ns[t]),
				         allowed == ENERGY_SILENT ? "its driver's silence" : "its last cut");
		}
}

// Checks the pace: a session that runs by the clock must begin each tick in time, whatever other
// sessions do.
static void check_pace(const core_book *book, int64_t now_ns)
{
	if (book->running && now_ns - book->began_ns > TICK_LATE_MOST_NS)
		sim_fail("fair", "%s began no tick for %.3f s", book->id,
		         1e-9 * (double)(now_ns - book->began_ns));
}

// True if some daemon computes this core. No daemon computes the core of a session that it releases
// or prepares for a move.
static bool is_served(const core_book *book)
{
	return book->served && book->logic && !book->logic->ended &&
	       sim_sessions[book->place].machine == book->machine;
}

void core_watch_advance(int64_t to_ns)
{
	for (int i = 0; i < CORES_MOST; i++) {
		core_book *book = &watched.cores[i];
		if (!book->core || !is_present(book) || !is_served(book))
			continue;
		bool stopped = to_ns <= sim_stopped_until(book->machine);
		if (stopped)
			memset(book->wrong_ns, 0, sizeof book->wrong_ns);
		// No tick begins in these cases.
		if (stopped || book->logic->going || book->logic->draining) {
			book->began_ns = to_ns;
		} else {
			look_at(book, to_ns);
			check_pace(book, to_ns);
		}
	}
}

bool core_watch_state(int place, int machine, int *gravity, int64_t *tick)
{
	char id[NAME_MOST];
	sim_session_id(place, machine, id);
	for (int i = 0; i < CORES_MOST; i++) {
		const core_book *book = &watched.cores[i];
		cau_frame frame;
		if (!book->core || book->machine != machine || strcmp(book->id, id) != 0)
			continue;
		cau_session_frame(book->core, &frame);
		*gravity = books_number(cau_fake_gravity(book->core)[2]);
		*tick = (int64_t)frame.tick;
		return true;
	}
	return false;
}
