// SPDX-License-Identifier: GPL-3.0-or-later
#include "server/session/world.h"

#include <assert.h>
#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include "server/session/oracle.h"

#define TICK_S 0.0625 // length of a tick, simulated s; a power of two, so that sums are exact

const char *const world_tool_names[TOOLS] = {"hook", "jaws"};
const char *const world_ask_names[CAU_ASK_COUNT] = {
	[CAU_ASK_TISSUE] = "tissue",
	[CAU_ASK_TOOL_ADD] = "add",
	[CAU_ASK_TOOL_KEEP] = "configure",
	[CAU_ASK_TOOL_REMOVE] = "remove",
	[CAU_ASK_TOOL_USE] = "use",
	[CAU_ASK_MOTION] = "motion",
	[CAU_ASK_ENERGY_ON] = "on",
	[CAU_ASK_ENERGY_OFF] = "off",
	[CAU_ASK_TAKE_OVER] = "take over",
	[CAU_ASK_HAND_OVER] = "hand over",
	[CAU_ASK_REQUEST_TAKEOVER] = "request",
	[CAU_ASK_PAUSE] = "pause",
	[CAU_ASK_RESUME] = "resume",
	[CAU_ASK_STEP] = "step",
	[CAU_ASK_SPEED] = "speed",
	[CAU_ASK_GO] = "go",
	[CAU_ASK_HISTORY] = "snapshot",
	[CAU_ASK_DESTROY] = "destroy",
	[CAU_ASK_ADVANCE] = "advance",
};

__attribute__((format(printf, 2, 3))) static void say(world *w, const char *format, ...)
{
	va_list arguments;
	va_start(arguments, format);
	if (w->script)
		vfprintf(w->script, format, arguments);
	va_end(arguments);
}

void world_wrong(world *w, const char *format, ...)
{
	va_list arguments;
	va_start(arguments, format);
	if (!*w->wrong)
		vsnprintf(w->wrong, sizeof w->wrong, format, arguments);
	va_end(arguments);
}

// ---- events -------------------------------------------------------------------------------------

static void take_effects(world *w)
{
	for (int32_t i = 0; i < w->effects.count; i++) {
		const cau_effect *effect = &w->effects.list[i];
		bool ends = effect->kind == CAU_EFFECT_REFUSE || effect->kind == CAU_EFFECT_REPLACED ||
		            effect->kind == CAU_EFFECT_UNSTORED;
		if (!ends)
			continue;
		ticket_book *ticket = oracle_ticket(w, effect->ticket);
		oracle_answered(w, effect->ticket);
		if (effect->kind == CAU_EFFECT_REFUSE)
			ticket->kept = false;
		bool room_matters =
			ticket->asked.ask != CAU_ASK_ENERGY_OFF && ticket->asked.ask != CAU_ASK_PAUSE;
		if (effect->kind == CAU_EFFECT_REFUSE && !room_matters && !w->ended)
			world_wrong(w, "%s was refused when it came in", world_ask_names[ticket->asked.ask]);
	}
}

static void take(world *w, cau_logic_event event)
{
	event.time_s = w->now_s;
	cau_logic_take(w->logic, &event, &w->effects);
	take_effects(w);
}

static cau_asker asker_of(int client)
{
	cau_asker asker = {.client = (uint32_t)client,
	                   .role = client == CLIENTS ? CAU_ROLE_ADMIN : CAU_ROLE_OPERATE,
	                   .deadline_s = DEADLINE_S};
	if (client)
		snprintf(asker.name, sizeof asker.name, "c%d", client);
	return asker;
}

// Chooses what an advance does: with one tool or both; energy on, on for some ticks, off, or
// unchanged.
static void choose_parts(cau_asked *asked, uint32_t more)
{
	enum { ON = 1, LIMITED, OFF };
	asked->ticks = more / 256 % 8;
	for (int tool = 0; tool < TOOLS; tool++) {
		uint32_t energy = more / 4 % 4;
		bool about = more % 4 == 3 || more % 4 == (uint32_t)tool + 1;
		cau_part *part = &asked->parts[asked->part_count];
		more /= 4;
		if (!about)
			continue;
		asked->part_count++;
		*part = (cau_part){.uses = energy == 0 || more % 3 == 0,
		                   .on = energy == ON || energy == LIMITED,
		                   .off = energy == OFF,
		                   .limit = energy == LIMITED ? 2 : 0};
		snprintf(part->tool, sizeof part->tool, "%s", world_tool_names[tool]);
	}
}

static void note_off_parts(world *w, const ticket_book *ticket)
{
	for (int32_t i = 0; i < ticket->asked.part_count; i++) {
		const cau_part *part = &ticket->asked.parts[i];
		if (part->off && !oracle_book(w, part->tool)->there && !w->ended)
			oracle_note_off_of_none(w, part->tool, ticket->came);
	}
}

static void order(world *w, cau_ask ask, int client, int tool, uint32_t more)
{
	if (w->ticket_count == TICKETS)
		return;
	ticket_book *ticket = &w->tickets[w->ticket_count++];
	bool about_tool = (ask >= CAU_ASK_TOOL_ADD && ask <= CAU_ASK_REQUEST_TAKEOVER);
	*ticket = (ticket_book){.came = w->came, .kept = true};
	ticket->asked =
		(cau_asked){.ticket = (uint64_t)w->ticket_count,
	                .ask = ask,
	                .asker = asker_of(client),
	                .numbered = ask != CAU_ASK_MOTION && ask != CAU_ASK_ADVANCE && more % 4 == 0,
	                .ticks = 1 + more % 3,
	                .speed = 1};
	if (about_tool)
		snprintf(ticket->asked.tool, sizeof ticket->asked.tool, "%s", world_tool_names[tool]);
	if (ask == CAU_ASK_ADVANCE)
		choose_parts(&ticket->asked, more);
	if (more / 16 % 4 == 0) // the client sends its clock, so its orders are no signs of life
		ticket->asked.alive_s = w->life_s[client];
	if (ask == CAU_ASK_HAND_OVER)
		ticket->asked.to = asker_of((int)(more % (CLIENTS + 1)));
	if (ask <= CAU_ASK_ENERGY_OFF && more % 5 == 0)
		ticket->asked.tick = w->tick + 1 + more % 2;
	if (ask == CAU_ASK_ENERGY_ON && more % 7 == 0)
		ticket->asked.limit = 1 + more % 3;
	say(w, "c%d: %s %s%s%s (%d)\n", client, world_ask_names[ask],
	    about_tool ? world_tool_names[tool] : "", ticket->asked.tick ? " later" : "",
	    ticket->asked.limit ? " for some ticks" : "", w->ticket_count);
	oracle_note_coming(w, ticket);
	take(w, (cau_logic_event){.kind = CAU_LOGIC_ORDER, .asked = &ticket->asked});
	oracle_check_room(w, ticket);
	bool now = ticket->answers || ticket->asked.tick <= w->tick;
	if (ask == CAU_ASK_ENERGY_OFF && now && !w->tools[tool].there && !w->ended)
		oracle_note_off_of_none(w, world_tool_names[tool], ticket->came);
	note_off_parts(w, ticket);
	// The order was answered at once because the queue is full, so the energy-off takes effect at
	// once.
	if (ask == CAU_ASK_ENERGY_OFF && ticket->answers)
		oracle_switch_off(&w->tools[tool], ticket->came);
	if (ask == CAU_ASK_PAUSE && ticket->answers && !w->ended)
		w->paused = ticket->came;
}

// Gives a sign of life that was sent `lag` thirds of the deadline ago.
static void alive(world *w, int client, int tool, int lag)
{
	const char *name = tool < 0 ? "" : world_tool_names[tool];
	double alive_s = fmax(w->life_s[client], w->now_s - lag * DEADLINE_S / 3);
	oracle_note_life(w, client, name, alive_s);
	say(w, "c%d lives%s\n", client, alive_s < w->now_s ? ", as it did before" : "");
	take(w, (cau_logic_event){.kind = CAU_LOGIC_ALIVE,
	                          .client = (uint32_t)client,
	                          .tool = name,
	                          .alive_s = alive_s});
}

static void lose(world *w, int client, bool for_good)
{
	say(w, "c%d %s\n", client, for_good ? "is gone" : "looks away");
	w->away[client] = w->came;
	if (client == w->lockstep)
		oracle_end_lockstep(w);
	oracle_note_loss(w, client, for_good);
	for (int i = 0; i < TOOLS && for_good; i++)
		if (w->tools[i].driver == client)
			w->tools[i].driver = 0;
	if (for_good)
		w->gone[client] = w->came;
	take(w, (cau_logic_event){.kind = for_good ? CAU_LOGIC_FORGET : CAU_LOGIC_AWAY,
	                          .client = (uint32_t)client,
	                          .cause = "lost"});
}

static void pass_time(world *w, uint32_t quarters)
{
	w->now_s += 0.25 * TICK_S * quarters;
	say(w, "it is %.4f s\n", w->now_s);
}

static void watch(world *w)
{
	say(w, "the watchdog looks\n");
	oracle_note_silence(w);
	take(w, (cau_logic_event){.kind = CAU_LOGIC_TIME});
}

static void store(world *w, bool takes)
{
	say(w, "the store %s\n", takes ? "takes" : "is full");
	w->store_takes = takes;
	if (!takes) {
		w->no_store = w->came;
		oracle_end_lockstep(w);
	}
	take(w, (cau_logic_event){.kind = CAU_LOGIC_STORE, .store_takes = takes, .cause = "full"});
}

// ---- the worker ---------------------------------------------------------------------------------

// Exchanges the presence of the jaws. If the present state has the jaws, the state after a rewind
// has none, and the reverse.
static void exchange_jaws(world *w)
{
	tool_book *jaws = &w->tools[1];
	say(w, "jaws %s\n", jaws->there ? "are not there any more" : "are there again");
	jaws->there = !jaws->there;
	jaws->driver = 0;
	jaws->enable = 0;
	jaws->deadline_s = DEADLINE_S;
}

static void arrive(world *w, bool energized)
{
	cau_arrived_tool tools[TOOLS] = {0};
	int32_t count = 0;
	for (int i = 0; i < TOOLS; i++) {
		tool_book *tool = &w->tools[i];
		tool->energized = tool->there && energized;
		if (!tool->there)
			continue;
		snprintf(tools[count].name, sizeof tools[count].name, "%s", world_tool_names[i]);
		tools[count++].energized = tool->energized;
	}
	say(w, "arrived%s\n", energized ? ", with energized tools" : "");
	w->going = false;
	w->state = w->state == CAU_SESSION_STARTING || w->state == CAU_SESSION_RUNNING
	               ? CAU_SESSION_RUNNING
	               : CAU_SESSION_PAUSED;
	take(w, (cau_logic_event){.kind = CAU_LOGIC_ARRIVED,
	                          .state = w->state,
	                          .tick = w->tick,
	                          .step_s = TICK_S,
	                          .tools = tools,
	                          .tool_count = count});
}

// Kills and restarts the program. Waiting orders are lost, no tool has a driver, and the core
// starts with all tools energized.
static void restart(world *w)
{
	if (w->ended)
		return;
	say(w, "killed, and restarted\n");
	for (int i = 0; i < w->ticket_count; i++)
		if (!w->tickets[i].answers)
			w->tickets[i].answers = 1; // the answer reaches no client
	for (int i = 0; i < TOOLS; i++) {
		w->tools[i].driver = 0;
		w->tools[i].enable = 0;
	}
	oracle_switch_all_off(w, w->came);
	oracle_end_lockstep(w);
	w->steps_left = 0;
	w->working = w->pausing = w->leaving = false;
	w->store_takes = true;
	w->paused = 0;
	w->state = CAU_SESSION_STARTING;
	cau_logic_init(w->logic, QUEUE);
	w->logic->step_s = TICK_S;
	arrive(w, true);
}

static void cancel(world *w, int client, uint32_t more)
{
	int32_t place = 0;
	const cau_waiting *first = cau_logic_later(w->logic, &place);
	uint64_t ticket = more % 2 && first ? first->asked.ticket : 0;
	say(w, "c%d cancels %s\n", client, ticket ? "one" : "all");
	oracle_note_cancel(w, client, ticket);
	take(w, (cau_logic_event){.kind = CAU_LOGIC_CANCEL,
	                          .client = (uint32_t)client,
	                          .number = ticket ? first->moment : 0});
}

static void begin_work(world *w)
{
	cau_logic_next(w->logic, w->now_s, &w->action, &w->effects);
	take_effects(w);
	w->working = w->action.act != CAU_ACT_NOTHING;
	if (w->action.act == CAU_ACT_ORDER || w->action.act == CAU_ACT_REFUSE)
		oracle_check_decision(w);
	if (w->action.act == CAU_ACT_STEP)
		oracle_check_tick(w);
	if (w->action.act == CAU_ACT_CUT)
		oracle_note_cut(w);
	else
		w->pausing = false;
	if (w->action.act == CAU_ACT_STEPPED)
		oracle_check_stepped(w);
	if (w->action.act == CAU_ACT_PAUSE) {
		oracle_end_lockstep(w);
		w->served = w->paused;
		w->paused = 0;
	}
	if (w->working)
		say(w, "worker: %s (%llu)\n",
		    (const char *[]){"", "refuse", "look", "do", "cut", "pause", "TICK", "stepped",
		                     "step failed"}[w->action.act],
		    (unsigned long long)w->action.ticket);
}

static cau_outcome_kind finish_order(world *w, uint32_t more)
{
	ticket_book *ticket = oracle_ticket(w, w->action.ticket);
	// Every call of the core that returns a status may refuse. Turning energy off returns none.
	bool core_may_refuse = ticket->asked.ask < CAU_ASK_ENERGY_OFF ||
	                       ticket->asked.ask == CAU_ASK_GO || ticket->asked.ask == CAU_ASK_ADVANCE;
	bool done = !(core_may_refuse && more % 4 == 0);
	if (ticket->asked.ask != CAU_ASK_STEP && !(ticket->asked.ask == CAU_ASK_ADVANCE && done))
		oracle_answered(w, w->action.ticket);
	if (done)
		oracle_note_done(w, ticket);
	return done ? CAU_DONE : CAU_NOT_DONE;
}

static cau_outcome_kind finish_look(world *w, uint32_t more)
{
	if (more % 8 == 1)
		return CAU_POSTPONED;
	if (more % 8 != 2)
		return CAU_DONE;
	oracle_answered(w, w->action.ticket);
	return CAU_NOT_DONE;
}

static cau_outcome_kind finish_act(world *w, uint32_t more)
{
	switch (w->action.act) {
	case CAU_ACT_REFUSE:
	case CAU_ACT_STEPPED:
	case CAU_ACT_STEP_FAILED:
		oracle_answered(w, w->action.ticket);
		return CAU_DONE;
	case CAU_ACT_LOOK:
		return finish_look(w, more);
	case CAU_ACT_ORDER:
		return finish_order(w, more);
	case CAU_ACT_CUT:
		if (w->action.was_energized)
			oracle_book(w, w->action.drive.tool)->energized = false;
		return CAU_DONE;
	case CAU_ACT_PAUSE:
		w->state = CAU_SESSION_PAUSED;
		oracle_switch_all_off(w, w->served);
		return CAU_DONE;
	case CAU_ACT_NOTHING:
	case CAU_ACT_STEP:
		break;
	}
	return CAU_DONE;
}

static bool is_pause(world *w)
{
	return oracle_ticket(w, w->action.ticket)->asked.ask == CAU_ASK_PAUSE;
}

static void end_work(world *w, uint32_t more)
{
	w->working = false;
	if (w->action.act == CAU_ACT_STEP) {
		w->tick++;
		cau_logic_stepped(w->logic, w->now_s, NULL, &w->effects);
		take_effects(w);
		return;
	}
	cau_outcome_kind outcome = finish_act(w, more);
	bool pauses = w->action.act == CAU_ACT_LOOK && is_pause(w);
	cau_logic_done(w->logic, w->now_s, outcome, &w->effects);
	take_effects(w);
	// A tick may begin while a pause waits for the disk. The oracle does not model this, so the
	// test commits the pause here.
	if (outcome == CAU_POSTPONED && (pauses || more % 16 == 1))
		take(w, (cau_logic_event){.kind = CAU_LOGIC_COMMITTED});
}

static void stay(world *w)
{
	say(w, "stays where it is\n");
	w->going = false;
	take(w, (cau_logic_event){.kind = CAU_LOGIC_STAYED});
}

static void work(world *w, uint32_t more)
{
	if (w->working) {
		end_work(w, more);
	} else if (w->going && more % 3 == 0) {
		stay(w);
	} else if (w->going) {
		if (more / 2 % 4 == 0)
			exchange_jaws(w);
		arrive(w, more % 2);
	} else {
		begin_work(w);
	}
}

// ---- one code -----------------------------------------------------------------------------------

// Half of the orders are from client 1 about the hook. So energy is on often enough to reveal
// errors.
static void order_of_code(world *w, uint32_t code)
{
	static const cau_ask often[] = {CAU_ASK_ENERGY_ON, CAU_ASK_ENERGY_ON,  CAU_ASK_ENERGY_OFF,
	                                CAU_ASK_TAKE_OVER, CAU_ASK_HAND_OVER,  CAU_ASK_PAUSE,
	                                CAU_ASK_RESUME,    CAU_ASK_MOTION,     CAU_ASK_TAKE_OVER,
	                                CAU_ASK_ENERGY_ON, CAU_ASK_TAKE_OVER,  CAU_ASK_ENERGY_ON,
	                                CAU_ASK_TOOL_ADD,  CAU_ASK_ENERGY_OFF, CAU_ASK_GO};
	uint32_t which = code % 64, more = code >> 18;
	cau_ask ask = which < 56   ? often[which % (sizeof often / sizeof *often)]
	              : which < 63 ? (cau_ask)((code >> 6) % CAU_ASK_DESTROY)
	                           : CAU_ASK_DESTROY;
	bool usual = (code >> 11) % 2;
	order(w, ask, usual ? 1 : 1 + (int)((code >> 12) % CLIENTS),
	      usual ? 0 : (int)((code >> 16) % TOOLS), more);
}

bool world_do(world *w, uint32_t code)
{
	uint32_t more = code >> 5, what = code % 32;
	int client = more % 2 ? 1 : 1 + (int)(more / 2 % CLIENTS);
	w->came++;
	if (what < 10)
		order_of_code(w, more);
	else if (what < 12)
		alive(w, client, (int)(more / 8 % (TOOLS + 1)) - 1, (int)(more / 64 % 8));
	else if (what == 12)
		lose(w, client, more / 8 % 4 == 0);
	else if (what < 17)
		pass_time(w, more % 8);
	else if (what == 17)
		watch(w);
	else if (what == 18 && more % 4 == 0)
		store(w, !w->store_takes);
	else if (what == 18)
		take(w, (cau_logic_event){.kind = CAU_LOGIC_COMMITTED});
	else if (what == 19 && more % 8 == 0)
		restart(w);
	else if (what == 19 && more % 8 == 1)
		cancel(w, client, more / 8);
	else if (what == WORLD_ADVANCES)
		order(w, CAU_ASK_ADVANCE, client, 0, more / 8);
	else
		work(w, more);
	if (*w->logic->broken)
		world_wrong(w, "a rule was broken: %s", w->logic->broken);
	return !*w->wrong;
}

// ---- the world ----------------------------------------------------------------------------------

world *world_create(void)
{
	world *w = calloc(1, sizeof *w);
	if (w)
		w->logic = malloc(cau_logic_bytes(QUEUE));
	assert(w && w->logic);
	return w;
}

void world_destroy(world *w)
{
	free(w->logic);
	free(w);
}

void world_begin(world *w)
{
	cau_logic *logic = w->logic;
	FILE *script = w->script;
	uint64_t steps = w->steps, energized_steps = w->energized_steps,
			 energized_advances = w->energized_advances;
	memset(w, 0, offsetof(world, tickets));
	w->logic = logic;
	w->script = script;
	w->steps = steps;
	w->energized_steps = energized_steps;
	w->energized_advances = energized_advances;
	w->ticket_count = 0;
	*w->wrong = 0;
	w->store_takes = true;
	w->state = CAU_SESSION_STARTING;
	w->now_s = 1;
	w->came = 1;
	cau_logic_init(logic, QUEUE);
	logic->step_s = TICK_S;
	w->tools[0] = (tool_book){.there = true, .deadline_s = DEADLINE_S};
	arrive(w, false);
	order(w, CAU_ASK_TAKE_OVER, 1, 0, 1);
	work(w, 0);
	work(w, 0);
}

bool world_end(world *w)
{
	if (w->working)
		end_work(w, 3);
	if (w->going)
		arrive(w, false);
	take(w, (cau_logic_event){.kind = CAU_LOGIC_COMMITTED});
	w->ended = true;
	take(w, (cau_logic_event){.kind = CAU_LOGIC_END});
	for (int i = 0; i < 4 * TICKETS && cau_logic_due_s(w->logic) == 0; i++) {
		begin_work(w);
		if (w->working)
			end_work(w, 3);
	}
	for (int i = 0; i < w->ticket_count; i++)
		if (w->tickets[i].answers != 1)
			world_wrong(w, "order %d (%s) has %d answers", i + 1,
			            world_ask_names[w->tickets[i].asked.ask], w->tickets[i].answers);
	return !*w->wrong;
}
