// SPDX-License-Identifier: GPL-3.0-or-later
#include "server/session/world.h"

#include <assert.h>
#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#define TICK_S 0.0625 // powers of two: sums are exact
#define DEADLINE_S 0.25

static const char *const tool_names[TOOLS] = {"hook", "jaws"};
static const char *const ask_names[CAU_ASK_COUNT] = {
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
};

__attribute__((format(printf, 2, 3))) static void say(world *w, const char *format, ...)
{
	va_list arguments;
	va_start(arguments, format);
	if (w->script)
		vfprintf(w->script, format, arguments);
	va_end(arguments);
}

__attribute__((format(printf, 2, 3))) static void wrong(world *w, const char *format, ...)
{
	va_list arguments;
	va_start(arguments, format);
	if (!*w->wrong)
		vsnprintf(w->wrong, sizeof w->wrong, format, arguments);
	va_end(arguments);
}

static tool_book *book_of(world *w, const char *tool)
{
	for (int i = 0; i < TOOLS; i++)
		if (strcmp(tool_names[i], tool) == 0)
			return &w->tools[i];
	return NULL;
}

static void darken(tool_book *tool, uint64_t came)
{
	if (came > tool->dark)
		tool->dark = came;
}

static void darken_all(world *w, uint64_t came)
{
	for (int i = 0; i < TOOLS; i++)
		darken(&w->tools[i], came);
}

// ---- the rules ----------------------------------------------------------------------------------

// The newest of all that concerns its energy is an enable of its driver, who is there and not
// silent.
static bool should_be_lit(const world *w, const tool_book *tool)
{
	int client = tool->enabler;
	return tool->there && tool->enable && tool->enable > tool->dark &&
	       tool->enable > w->away[client] && tool->enable > w->gone[client] &&
	       tool->enable > w->no_store && tool->driver == client &&
	       tool->alive_s[client] + tool->deadline_s > w->now_s;
}

static void check_tick(world *w)
{
	for (int i = 0; i < TOOLS; i++) {
		const tool_book *tool = &w->tools[i];
		bool should = should_be_lit(w, tool);
		if (tool->lit && !should)
			wrong(w, "a tick begins with %s lit; the newest enable came %llu, the dark %llu",
			      tool_names[i], (unsigned long long)tool->enable, (unsigned long long)tool->dark);
		if (!tool->lit && should)
			wrong(w, "a tick begins with %s dark, though it was enabled", tool_names[i]);
		w->lit_steps += tool->lit;
	}
	for (int i = 0; i < w->ticket_count; i++)
		if (w->tickets[i].asked.ask == CAU_ASK_PAUSE && w->tickets[i].kept &&
		    !w->tickets[i].answers)
			wrong(w, "a tick begins while a pause waits");
	w->steps++;
}

// Whether the order may be done, as the page has it.
static bool may(const world *w, const ticket_book *ticket)
{
	const cau_asked *asked = &ticket->asked;
	const tool_book *tool = book_of((world *)w, asked->tool);
	int client = (int)asked->asker.client;
	bool drives = tool && tool->there && tool->driver == client;
	switch (asked->ask) {
	case CAU_ASK_TOOL_KEEP:
	case CAU_ASK_TOOL_REMOVE:
		return drives || (tool->there && !tool->driver);
	case CAU_ASK_TOOL_USE:
	case CAU_ASK_MOTION:
	case CAU_ASK_HAND_OVER:
		return drives;
	case CAU_ASK_ENERGY_OFF:
	case CAU_ASK_REQUEST_TAKEOVER:
		return tool->there;
	case CAU_ASK_TAKE_OVER:
		return tool->there && (!tool->driver || drives || asked->asker.role == CAU_ROLE_ADMIN) &&
		       ticket->came > w->gone[client];
	default:
		return true;
	}
}

// An enable that nothing has overtaken must be taken.
static bool must_enable(const world *w, const ticket_book *ticket)
{
	const tool_book *tool = book_of((world *)w, ticket->asked.tool);
	int client = (int)ticket->asked.asker.client;
	double alive_s = tool->alive_s[client];
	return tool->there && tool->driver == client && w->store_takes && ticket->came > tool->dark &&
	       ticket->came > w->away[client] && ticket->came > w->gone[client] &&
	       ticket->came > w->no_store && alive_s + tool->deadline_s > w->now_s;
}

// ---- answers ------------------------------------------------------------------------------------

static ticket_book *ticket_of(world *w, uint64_t number)
{
	assert(number >= 1 && number <= (uint64_t)w->ticket_count);
	return &w->tickets[number - 1];
}

static void answered(world *w, uint64_t number)
{
	if (ticket_of(w, number)->answers++)
		wrong(w, "order %llu is answered twice", (unsigned long long)number);
}

static void take_effects(world *w)
{
	for (int32_t i = 0; i < w->effects.count; i++) {
		const cau_effect *effect = &w->effects.list[i];
		bool ends = effect->kind == CAU_EFFECT_REFUSE || effect->kind == CAU_EFFECT_REPLACED ||
		            effect->kind == CAU_EFFECT_UNSTORED;
		if (!ends)
			continue;
		ticket_book *ticket = ticket_of(w, effect->ticket);
		answered(w, effect->ticket);
		if (effect->kind == CAU_EFFECT_REFUSE)
			ticket->kept = false;
		bool room_matters =
			ticket->asked.ask != CAU_ASK_ENERGY_OFF && ticket->asked.ask != CAU_ASK_PAUSE;
		if (effect->kind == CAU_EFFECT_REFUSE && !room_matters && !w->ended)
			wrong(w, "%s was refused when it came in", ask_names[ticket->asked.ask]);
	}
}

// ---- events -------------------------------------------------------------------------------------

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

static void note_coming(world *w, const ticket_book *ticket)
{
	const cau_asked *asked = &ticket->asked;
	tool_book *tool = book_of(w, asked->tool);
	if (tool) // any message about a tool is a sign of life
		tool->alive_s[asked->asker.client] = w->now_s;
	if (asked->ask == CAU_ASK_ENERGY_OFF && asked->tick <= w->tick)
		darken(tool, ticket->came);
}

static void order(world *w, cau_ask ask, int client, int tool, uint32_t more)
{
	if (w->ticket_count == TICKETS)
		return;
	ticket_book *ticket = &w->tickets[w->ticket_count++];
	bool about_tool = (ask >= CAU_ASK_TOOL_ADD && ask <= CAU_ASK_REQUEST_TAKEOVER);
	*ticket = (ticket_book){.came = w->came, .kept = true};
	ticket->asked = (cau_asked){.ticket = (uint64_t)w->ticket_count,
	                            .ask = ask,
	                            .asker = asker_of(client),
	                            .numbered = ask != CAU_ASK_MOTION && more % 4 == 0,
	                            .ticks = 1 + more % 3,
	                            .speed = 1};
	if (about_tool)
		snprintf(ticket->asked.tool, sizeof ticket->asked.tool, "%s", tool_names[tool]);
	if (ask == CAU_ASK_HAND_OVER)
		ticket->asked.to = asker_of((int)(more % (CLIENTS + 1)));
	if ((ask == CAU_ASK_ENERGY_ON || ask == CAU_ASK_ENERGY_OFF) && more % 5 == 0)
		ticket->asked.tick = w->tick + 1 + more % 2;
	say(w, "c%d: %s %s%s (%d)\n", client, ask_names[ask], about_tool ? tool_names[tool] : "",
	    ticket->asked.tick ? " later" : "", w->ticket_count);
	note_coming(w, ticket);
	take(w, (cau_logic_event){.kind = CAU_LOGIC_ORDER, .asked = &ticket->asked});
	if (ask == CAU_ASK_ENERGY_OFF && ticket->answers) // it found no room, and acts at once
		darken(&w->tools[tool], ticket->came);
	if (ask == CAU_ASK_PAUSE && ticket->answers && !w->ended)
		w->paused = ticket->came;
}

static void alive(world *w, int client, int tool)
{
	for (int i = 0; i < TOOLS; i++)
		if (tool < 0 || tool == i)
			w->tools[i].alive_s[client] = w->now_s;
	say(w, "c%d lives\n", client);
	take(w, (cau_logic_event){.kind = CAU_LOGIC_ALIVE,
	                          .client = (uint32_t)client,
	                          .tool = tool < 0 ? "" : tool_names[tool]});
}

static void lose(world *w, int client, bool for_good)
{
	say(w, "c%d %s\n", client, for_good ? "is gone" : "looks away");
	w->away[client] = w->came;
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

// Once a silence was looked at, a sign of life does not undo it.
static void note_silence(world *w)
{
	for (int i = 0; i < TOOLS; i++) {
		tool_book *tool = &w->tools[i];
		bool lit = tool->enable > tool->dark && tool->there && tool->driver == tool->enabler;
		if (lit && tool->alive_s[tool->enabler] + tool->deadline_s <= w->now_s)
			darken(tool, w->came);
	}
}

static void watch(world *w)
{
	say(w, "the watchdog looks\n");
	note_silence(w);
	take(w, (cau_logic_event){.kind = CAU_LOGIC_TIME});
}

static void store(world *w, bool takes)
{
	say(w, "the store %s\n", takes ? "takes" : "is full");
	w->store_takes = takes;
	if (!takes)
		w->no_store = w->came;
	take(w, (cau_logic_event){.kind = CAU_LOGIC_STORE, .store_takes = takes, .cause = "full"});
}

// ---- the worker ---------------------------------------------------------------------------------

static void arrive(world *w, bool lit)
{
	cau_arrived_tool tools[TOOLS] = {0};
	int32_t count = 0;
	for (int i = 0; i < TOOLS; i++) {
		tool_book *tool = &w->tools[i];
		tool->lit = tool->there && lit;
		if (!tool->there)
			continue;
		snprintf(tools[count].name, sizeof tools[count].name, "%s", tool_names[i]);
		tools[count++].lit = tool->lit;
	}
	say(w, "arrived%s\n", lit ? ", with lit tools" : "");
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

static void change_driver(world *w, const ticket_book *ticket, int to)
{
	tool_book *tool = book_of(w, ticket->asked.tool);
	if (tool->driver == to)
		return;
	if (tool->lit)
		wrong(w, "%s changes hands while it is lit", ticket->asked.tool);
	darken(tool, ticket->came);
	tool->driver = to;
}

// What an order that was done leads to, as the page has it.
static void note_done(world *w, ticket_book *ticket)
{
	const cau_asked *asked = &ticket->asked;
	tool_book *tool = book_of(w, asked->tool);
	int client = (int)asked->asker.client, to = (int)asked->to.client;
	switch (asked->ask) {
	case CAU_ASK_TOOL_ADD:
		tool->there = true;
		tool->driver = ticket->came > w->gone[client] ? client : 0;
		tool->deadline_s = DEADLINE_S;
		break;
	case CAU_ASK_TOOL_REMOVE:
		tool->there = tool->lit = false;
		tool->enable = 0;
		tool->driver = 0;
		break;
	case CAU_ASK_TAKE_OVER:
		change_driver(w, ticket, ticket->came > w->gone[client] ? client : 0);
		break;
	case CAU_ASK_HAND_OVER:
		change_driver(w, ticket, to && ticket->came < w->gone[to] ? 0 : to);
		break;
	case CAU_ASK_ENERGY_ON:
		tool->lit = true;
		if (ticket->came > tool->enable) {
			tool->enable = ticket->came;
			tool->enabler = client;
		}
		break;
	case CAU_ASK_ENERGY_OFF:
		tool->lit = false;
		darken(tool, ticket->came);
		if (asked->tick) // it was for this tick: what came in later and was lit before is off too
			tool->enable = 0;
		break;
	case CAU_ASK_PAUSE:
		w->state = CAU_SESSION_PAUSED;
		darken_all(w, ticket->came);
		break;
	case CAU_ASK_RESUME:
		w->state = CAU_SESSION_RUNNING;
		break;
	case CAU_ASK_GO:
		w->going = true;
		darken_all(w, ticket->came);
		break;
	case CAU_ASK_DESTROY:
		w->ended = true;
		break;
	default:
		break;
	}
}

static void check_decision(world *w)
{
	const ticket_book *ticket = ticket_of(w, w->action.ticket);
	cau_ask ask = ticket->asked.ask;
	bool orders = w->action.act == CAU_ACT_ORDER;
	if (w->ended)
		return;
	if (ask == CAU_ASK_ENERGY_ON) {
		const tool_book *tool = book_of(w, ticket->asked.tool);
		uint32_t client = ticket->asked.asker.client;
		bool silent = tool->alive_s[client] + tool->deadline_s <= w->now_s;
		if (orders && (tool->driver != (int)client || silent))
			wrong(w, "an enable of c%u is taken, which %s", client,
			      silent ? "is silent" : "does not drive");
		if (!orders && must_enable(w, ticket))
			wrong(w, "a good enable of c%u was refused: %s", ticket->asked.asker.client,
			      w->action.error.reason);
	} else if (orders && !may(w, ticket)) {
		wrong(w, "%s of c%u is done, and it may not", ask_names[ask], ticket->asked.asker.client);
	} else if (!orders && may(w, ticket) && ask != CAU_ASK_RESUME && ask != CAU_ASK_STEP &&
	           ask != CAU_ASK_GO) {
		wrong(w, "%s of c%u is refused, and it may: %s", ask_names[ask], ticket->asked.asker.client,
		      w->action.error.reason);
	}
}

static void begin_work(world *w)
{
	cau_logic_next(w->logic, w->now_s, &w->action, &w->effects);
	take_effects(w);
	w->working = w->action.act != CAU_ACT_NOTHING;
	if (w->action.act == CAU_ACT_ORDER || w->action.act == CAU_ACT_REFUSE)
		check_decision(w);
	if (w->action.act == CAU_ACT_STEP)
		check_tick(w);
	if (w->action.act == CAU_ACT_CUT)
		note_silence(w);
	if (w->working)
		say(w, "worker: %s (%llu)\n",
		    (const char *[]){"", "refuse", "look", "do", "cut", "pause", "TICK", "stepped",
		                     "step failed"}[w->action.act],
		    (unsigned long long)w->action.ticket);
}

static cau_outcome_kind finish_order(world *w, uint32_t more)
{
	ticket_book *ticket = ticket_of(w, w->action.ticket);
	bool core_may_refuse = ticket->asked.ask == CAU_ASK_TOOL_ADD ||
	                       ticket->asked.ask == CAU_ASK_TISSUE || ticket->asked.ask == CAU_ASK_GO;
	const tool_book *tool = book_of(w, ticket->asked.tool);
	bool there_already = ticket->asked.ask == CAU_ASK_TOOL_ADD && tool->there;
	bool done = !there_already && !(core_may_refuse && more % 4 == 0);
	if (ticket->asked.ask != CAU_ASK_STEP)
		answered(w, w->action.ticket);
	if (done)
		note_done(w, ticket);
	return done ? CAU_DONE : CAU_NOT_DONE;
}

static cau_outcome_kind finish_look(world *w, uint32_t more)
{
	if (more % 8 == 1)
		return CAU_POSTPONED;
	if (more % 8 != 2)
		return CAU_DONE;
	answered(w, w->action.ticket);
	return CAU_NOT_DONE;
}

static cau_outcome_kind finish_act(world *w, uint32_t more)
{
	switch (w->action.act) {
	case CAU_ACT_REFUSE:
	case CAU_ACT_STEPPED:
	case CAU_ACT_STEP_FAILED:
		answered(w, w->action.ticket);
		return CAU_DONE;
	case CAU_ACT_LOOK:
		return finish_look(w, more);
	case CAU_ACT_ORDER:
		return finish_order(w, more);
	case CAU_ACT_CUT:
		if (w->action.was_lit)
			book_of(w, w->action.drive.tool)->lit = false;
		return CAU_DONE;
	case CAU_ACT_PAUSE:
		w->state = CAU_SESSION_PAUSED;
		darken_all(w, w->paused);
		return CAU_DONE;
	case CAU_ACT_NOTHING:
	case CAU_ACT_STEP:
		break;
	}
	return CAU_DONE;
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
	cau_logic_done(w->logic, w->now_s, outcome, &w->effects);
	take_effects(w);
	if (outcome == CAU_POSTPONED && more % 2)
		take(w, (cau_logic_event){.kind = CAU_LOGIC_COMMITTED});
}

static void work(world *w, uint32_t more)
{
	if (w->working)
		end_work(w, more);
	else if (w->going)
		arrive(w, more % 2);
	else
		begin_work(w);
}

// ---- one code -----------------------------------------------------------------------------------

// Half of all is c1 about the hook, so that tools are lit often enough for something to go wrong.
static void order_of_code(world *w, uint32_t code)
{
	static const cau_ask often[] = {CAU_ASK_ENERGY_ON, CAU_ASK_ENERGY_ON,  CAU_ASK_ENERGY_OFF,
	                                CAU_ASK_TAKE_OVER, CAU_ASK_HAND_OVER,  CAU_ASK_PAUSE,
	                                CAU_ASK_RESUME,    CAU_ASK_MOTION,     CAU_ASK_TAKE_OVER,
	                                CAU_ASK_ENERGY_ON, CAU_ASK_TAKE_OVER,  CAU_ASK_ENERGY_ON,
	                                CAU_ASK_TOOL_ADD,  CAU_ASK_ENERGY_OFF, CAU_ASK_GO};
	uint32_t which = code % 64, more = code >> 18;
	cau_ask ask = which < 56   ? often[which % (sizeof often / sizeof *often)]
	              : which < 63 ? (cau_ask)((code >> 6) % (CAU_ASK_COUNT - 1))
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
		alive(w, client, (int)(more / 8 % (TOOLS + 1)) - 1);
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
	else
		work(w, more);
	return !*w->wrong;
}

// ---- the whole ----------------------------------------------------------------------------------

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
	uint64_t steps = w->steps, lit_steps = w->lit_steps;
	memset(w, 0, offsetof(world, tickets));
	w->logic = logic;
	w->script = script;
	w->steps = steps;
	w->lit_steps = lit_steps;
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
			wrong(w, "order %d (%s) has %d answers", i + 1, ask_names[w->tickets[i].asked.ask],
			      w->tickets[i].answers);
	return !*w->wrong;
}
