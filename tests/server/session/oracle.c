// SPDX-License-Identifier: GPL-3.0-or-later
#include "server/session/oracle.h"

#include <assert.h>
#include <string.h>

tool_book *oracle_book(world *w, const char *tool)
{
	for (int i = 0; i < TOOLS; i++)
		if (strcmp(world_tool_names[i], tool) == 0)
			return &w->tools[i];
	return NULL;
}

void oracle_darken(tool_book *tool, uint64_t came)
{
	if (came > tool->dark)
		tool->dark = came;
}

void oracle_darken_all(world *w, uint64_t came)
{
	for (int i = 0; i < TOOLS; i++)
		oracle_darken(&w->tools[i], came);
}

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

void oracle_check_tick(world *w)
{
	for (int i = 0; i < TOOLS; i++) {
		const tool_book *tool = &w->tools[i];
		bool should = should_be_lit(w, tool);
		if (tool->lit && !should)
			world_wrong(w, "a tick begins with %s lit; the newest enable came %llu, the dark %llu",
			            world_tool_names[i], (unsigned long long)tool->enable,
			            (unsigned long long)tool->dark);
		if (!tool->lit && should)
			world_wrong(w, "a tick begins with %s dark, though it was enabled",
			            world_tool_names[i]);
		w->lit_steps += tool->lit;
	}
	for (int i = 0; i < w->ticket_count; i++)
		if (w->tickets[i].asked.ask == CAU_ASK_PAUSE && w->tickets[i].kept &&
		    !w->tickets[i].answers)
			world_wrong(w, "a tick begins while a pause waits");
	w->steps++;
}

// Whether the order may be done, as the page has it.
static bool may(const world *w, const ticket_book *ticket)
{
	const cau_asked *asked = &ticket->asked;
	const tool_book *tool = oracle_book((world *)w, asked->tool);
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
	const tool_book *tool = oracle_book((world *)w, ticket->asked.tool);
	int client = (int)ticket->asked.asker.client;
	double alive_s = tool->alive_s[client];
	return tool->there && tool->driver == client && w->store_takes && ticket->came > tool->dark &&
	       ticket->came > w->away[client] && ticket->came > w->gone[client] &&
	       ticket->came > w->no_store && alive_s + tool->deadline_s > w->now_s;
}

ticket_book *oracle_ticket(world *w, uint64_t number)
{
	assert(number >= 1 && number <= (uint64_t)w->ticket_count);
	return &w->tickets[number - 1];
}

void oracle_answered(world *w, uint64_t number)
{
	if (oracle_ticket(w, number)->answers++)
		world_wrong(w, "order %llu is answered twice", (unsigned long long)number);
}

void oracle_note_coming(world *w, const ticket_book *ticket)
{
	const cau_asked *asked = &ticket->asked;
	tool_book *tool = oracle_book(w, asked->tool);
	if (!tool)
		return;
	// any message about a tool is a sign of life
	tool->alive_s[asked->asker.client] = w->now_s;
	if (asked->ask == CAU_ASK_ENERGY_OFF && asked->tick <= w->tick)
		oracle_darken(tool, ticket->came);
}

// Once a silence was looked at, a sign of life does not undo it.
void oracle_note_silence(world *w)
{
	for (int i = 0; i < TOOLS; i++) {
		tool_book *tool = &w->tools[i];
		bool lit = tool->enable > tool->dark && tool->there && tool->driver == tool->enabler;
		if (lit && tool->alive_s[tool->enabler] + tool->deadline_s <= w->now_s)
			oracle_darken(tool, w->came);
	}
}

static void change_driver(world *w, const ticket_book *ticket, int to)
{
	tool_book *tool = oracle_book(w, ticket->asked.tool);
	if (tool->driver == to)
		return;
	if (tool->lit)
		world_wrong(w, "%s changes hands while it is lit", ticket->asked.tool);
	oracle_darken(tool, ticket->came);
	tool->driver = to;
}

// What an order that was done leads to, as the page has it.
void oracle_note_done(world *w, ticket_book *ticket)
{
	const cau_asked *asked = &ticket->asked;
	tool_book *tool = oracle_book(w, asked->tool);
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
		oracle_darken(tool, ticket->came);
		if (asked->tick) // it was for this tick: what came in later and was lit before is off too
			tool->enable = 0;
		break;
	case CAU_ASK_PAUSE:
		w->state = CAU_SESSION_PAUSED;
		oracle_darken_all(w, ticket->came);
		break;
	case CAU_ASK_RESUME:
		w->state = CAU_SESSION_RUNNING;
		break;
	case CAU_ASK_GO:
		w->going = true;
		oracle_darken_all(w, ticket->came);
		break;
	case CAU_ASK_DESTROY:
		w->ended = true;
		break;
	default:
		break;
	}
}

void oracle_check_decision(world *w)
{
	const ticket_book *ticket = oracle_ticket(w, w->action.ticket);
	cau_ask ask = ticket->asked.ask;
	bool orders = w->action.act == CAU_ACT_ORDER;
	if (w->ended)
		return;
	if (ask == CAU_ASK_ENERGY_ON) {
		const tool_book *tool = oracle_book(w, ticket->asked.tool);
		uint32_t client = ticket->asked.asker.client;
		bool silent = tool->alive_s[client] + tool->deadline_s <= w->now_s;
		if (orders && (tool->driver != (int)client || silent))
			world_wrong(w, "an enable of c%u is taken, which %s", client,
			            silent ? "is silent" : "does not drive");
		if (!orders && must_enable(w, ticket))
			world_wrong(w, "a good enable of c%u was refused: %s", ticket->asked.asker.client,
			            w->action.error.reason);
	} else if (orders && !may(w, ticket)) {
		world_wrong(w, "%s of c%u is done, and it may not", world_ask_names[ask],
		            ticket->asked.asker.client);
	} else if (!orders && may(w, ticket) && ask != CAU_ASK_RESUME && ask != CAU_ASK_STEP &&
	           ask != CAU_ASK_GO) {
		world_wrong(w, "%s of c%u is refused, and it may: %s", world_ask_names[ask],
		            ticket->asked.asker.client, w->action.error.reason);
	}
}
