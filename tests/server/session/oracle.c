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

void oracle_switch_off(tool_book *tool, uint64_t came)
{
	if (came > tool->off)
		tool->off = came;
}

void oracle_switch_all_off(world *w, uint64_t came)
{
	for (int i = 0; i < TOOLS; i++)
		oracle_switch_off(&w->tools[i], came);
}

void oracle_end_lockstep(world *w)
{
	w->lockstep = 0;
	w->advance_left = 0;
}

// True if the client is not silent. In lock-step a client is silent when a tick begins that exceeds
// its deadline in ticks.
static bool is_alive(const world *w, const tool_book *tool, int client)
{
	if (w->lockstep && client == w->lockstep)
		return !w->advance_left || w->tick - w->advance_tick < DEADLINE_TICKS;
	return tool->alive_s[client] + tool->deadline_s > w->now_s;
}

// True if no later event makes this client's enable void.
static bool stands(const world *w, const tool_book *tool, int client, uint64_t enable)
{
	return tool->there && tool->driver == client && enable > tool->off &&
	       enable > tool->silent[client] && enable > w->away[client] && enable > w->gone[client] &&
	       enable > w->no_store;
}

// True if the newest event about the tool's energy is an enable of its present driver.
static bool is_enabled(const world *w, const tool_book *tool)
{
	return tool->enable && stands(w, tool, tool->enabler, tool->enable);
}

static bool is_over(const world *w, const tool_book *tool)
{
	return tool->limit && w->tick >= tool->limit;
}

static bool should_be_energized(const world *w, const tool_book *tool)
{
	return is_enabled(w, tool) && !is_over(w, tool) && is_alive(w, tool, tool->enabler);
}

static bool is_silent(const world *w, const tool_book *tool)
{
	return is_enabled(w, tool) && !is_alive(w, tool, tool->enabler);
}

// Counts a tick of a paused session. It must have been requested, in lock-step by the client in
// lock-step.
static void count_steps(world *w)
{
	int64_t *left = w->lockstep ? &w->advance_left : &w->steps_left;
	if (w->state != CAU_SESSION_PAUSED)
		return;
	if (!*left)
		world_wrong(w, "a tick begins in a paused session, and nobody asked for it");
	else
		--*left;
	for (int i = 0; i < TOOLS; i++)
		w->energized_advances += w->tools[i].energized && w->tools[i].driver == w->lockstep;
}

static bool waits_to_leave(const world *w)
{
	for (int i = 0; i < w->ticket_count; i++) {
		cau_ask ask = w->tickets[i].asked.ask;
		bool leaves = ask == CAU_ASK_RESUME || (ask == CAU_ASK_STEP && !w->tickets[i].stepping);
		if (leaves && w->tickets[i].kept && !w->tickets[i].answers)
			return true;
	}
	return false;
}

void oracle_check_stepped(world *w)
{
	if (oracle_ticket(w, w->action.ticket)->asked.ask != CAU_ASK_ADVANCE || !w->advance_left)
		return;
	if (!waits_to_leave(w))
		world_wrong(w, "an advance ends with %d ticks left", (int)w->advance_left);
	oracle_end_lockstep(w);
	w->leaving = true;
}

void oracle_check_tick(world *w)
{
	for (int i = 0; i < TOOLS; i++) {
		const tool_book *tool = &w->tools[i];
		bool should = should_be_energized(w, tool);
		if (tool->energized && !should)
			world_wrong(w,
			            "a tick begins with %s energized; the newest enable came %llu, the "
			            "switching off %llu",
			            world_tool_names[i], (unsigned long long)tool->enable,
			            (unsigned long long)tool->off);
		if (!tool->energized && should)
			world_wrong(w, "a tick begins with %s off, though it was enabled", world_tool_names[i]);
		w->energized_steps += tool->energized;
		if (is_over(w, tool))
			w->tools[i].enable = w->tools[i].limit = 0;
	}
	for (int i = 0; i < w->ticket_count; i++)
		if (w->tickets[i].asked.ask == CAU_ASK_PAUSE && w->tickets[i].kept &&
		    !w->tickets[i].answers)
			world_wrong(w, "a tick begins while a pause waits");
	count_steps(w);
	w->steps++;
}

// ---- void orders --------------------------------------------------------------------------------

static bool is_for_later(const world *w, const ticket_book *ticket)
{
	return ticket->asked.tick > w->tick;
}

// True if the order becomes void once its client no longer drives the order's tool. This holds for
// orders that use the tool, and for orders of later ticks.
static bool is_of_hold(const world *w, const ticket_book *ticket)
{
	cau_ask ask = ticket->asked.ask;
	bool uses = ask == CAU_ASK_TOOL_USE || ask == CAU_ASK_MOTION || ask == CAU_ASK_ENERGY_ON ||
	            ask == CAU_ASK_ADVANCE;
	bool keeps = ask == CAU_ASK_TOOL_KEEP || ask == CAU_ASK_TOOL_REMOVE;
	return uses || (keeps && is_for_later(w, ticket));
}

static bool is_later_off(const world *w, const ticket_book *ticket)
{
	return ticket->asked.ask == CAU_ASK_ENERGY_OFF && is_for_later(w, ticket);
}

static bool is_from(const ticket_book *ticket, int client)
{
	return !ticket->answers && (int)ticket->asked.asker.client == client;
}

// Makes a silent driver's advances void.
static void void_advances(world *w, int driver, uint64_t before, bool doubted)
{
	for (int i = 0; i < w->ticket_count; i++) {
		ticket_book *ticket = &w->tickets[i];
		bool advance = ticket->asked.ask == CAU_ASK_ADVANCE && !ticket->stepping;
		if (!advance || !is_from(ticket, driver) || ticket->came >= before)
			continue;
		ticket->doubted |= doubted;
		ticket->voided |= !doubted;
	}
}

static void void_of_driver(world *w, const char *name, int driver, uint64_t before, bool doubted)
{
	for (int i = 0; i < w->ticket_count; i++) {
		ticket_book *ticket = &w->tickets[i];
		if (!is_from(ticket, driver) || ticket->came >= before ||
		    strcmp(ticket->asked.tool, name) != 0 ||
		    !(is_of_hold(w, ticket) || is_later_off(w, ticket)))
			continue;
		if (doubted)
			ticket->doubted = true;
		else
			ticket->voided = true;
	}
}

void oracle_note_loss(world *w, int client, bool for_good)
{
	for (int i = 0; i < w->ticket_count; i++) {
		ticket_book *ticket = &w->tickets[i];
		const tool_book *tool = oracle_book(w, ticket->asked.tool);
		bool off = tool && tool->there && tool->driver == client && is_later_off(w, ticket);
		if (is_from(ticket, client) &&
		    (is_of_hold(w, ticket) || off || (for_good && is_for_later(w, ticket))))
			ticket->voided = true;
	}
}

void oracle_note_cancel(world *w, int client, uint64_t number)
{
	for (int i = 0; i < w->ticket_count; i++)
		if (is_from(&w->tickets[i], client) && is_for_later(w, &w->tickets[i]) &&
		    (!number || number == (uint64_t)i + 1))
			w->tickets[i].voided = true;
}

static int count_waiting(const world *w, int client, bool later)
{
	int count = 0;
	for (int i = 0; i < w->ticket_count; i++) {
		const ticket_book *ticket = &w->tickets[i];
		bool served =
			w->working && w->action.ticket == (uint64_t)i + 1 && w->action.act != CAU_ACT_LOOK;
		bool waits = ticket->kept && !ticket->answers && !served && !ticket->stepping;
		bool is_later = is_for_later(w, ticket) && !ticket->voided;
		count +=
			waits && is_later == later && (!client || (int)ticket->asked.asker.client == client);
	}
	return count;
}

// Notes an energy-off for a tool that does not exist. Earlier enables have no effect when the tool
// is added.
void oracle_note_off_of_none(world *w, const char *tool, uint64_t before)
{
	for (int i = 0; i < w->ticket_count; i++) {
		ticket_book *ticket = &w->tickets[i];
		bool on = ticket->asked.ask == CAU_ASK_ENERGY_ON && strcmp(ticket->asked.tool, tool) == 0;
		for (int32_t k = 0; k < ticket->asked.part_count; k++)
			on |= ticket->asked.parts[k].on && strcmp(ticket->asked.parts[k].tool, tool) == 0;
		if (!ticket->answers && on && ticket->came < before)
			ticket->voided = true;
	}
}

void oracle_check_room(world *w, const ticket_book *ticket)
{
	bool off = ticket->asked.ask == CAU_ASK_ENERGY_OFF,
		 motion = ticket->asked.ask == CAU_ASK_MOTION;
	int client = (int)ticket->asked.asker.client, bound = cau_logic_later_most(QUEUE);
	if (w->ended || !w->store_takes || off || ticket->asked.ask == CAU_ASK_PAUSE)
		return;
	for (int i = 0; i < w->ticket_count; i++) // an order that may be void can be in either queue
		if (w->tickets[i].doubted && !w->tickets[i].answers && is_for_later(w, &w->tickets[i]))
			return;
	// Orders that the present act makes void are counted only when the act ends.
	if (w->working && w->action.act == CAU_ACT_ORDER)
		return;
	bool later = is_for_later(w, ticket), full;
	if (later) // the counts leave out the order itself
		full = count_waiting(w, client, true) - ticket->kept >= bound ||
		       count_waiting(w, 0, true) - ticket->kept >= QUEUE ||
		       count_waiting(w, 0, true) + count_waiting(w, 0, false) - ticket->kept >= 2 * QUEUE;
	else
		full = count_waiting(w, 0, false) - ticket->kept >= QUEUE;
	if (!ticket->kept && !full)
		world_wrong(w, "%s of c%d finds no room, and there is some",
		            world_ask_names[ticket->asked.ask], client);
	if (later && ticket->kept && full)
		world_wrong(w, "%s of c%d waits for later, beyond the bound",
		            world_ask_names[ticket->asked.ask], client);
	if (!later && ticket->kept && full && !motion)
		world_wrong(w, "%s of c%d waits, beyond the bound", world_ask_names[ticket->asked.ask],
		            client);
}

// ---- decisions ----------------------------------------------------------------------------------

static bool is_stepping(const world *w)
{
	for (int i = 0; i < w->ticket_count; i++)
		if (w->tickets[i].stepping && !w->tickets[i].answers)
			return true;
	return false;
}

// True if everything in the advance is allowed now.
static bool may_advance(const world *w, const ticket_book *ticket)
{
	int client = (int)ticket->asked.asker.client;
	if (w->state != CAU_SESSION_PAUSED || is_stepping(w) || (w->lockstep && w->lockstep != client))
		return false;
	for (int32_t i = 0; i < ticket->asked.part_count; i++) {
		const cau_part *part = &ticket->asked.parts[i];
		const tool_book *tool = oracle_book((world *)w, part->tool);
		bool drives = tool->there && tool->driver == client;
		bool counts = w->store_takes && stands(w, tool, client, ticket->came);
		if (!tool->there || ((part->uses || part->on) && !drives) || (part->on && !counts))
			return false;
	}
	return true;
}

// True if protocol/README.md allows the order.
static bool may(const world *w, const ticket_book *ticket)
{
	const cau_asked *asked = &ticket->asked;
	const tool_book *tool = oracle_book((world *)w, asked->tool);
	int client = (int)asked->asker.client;
	bool drives = tool && tool->there && tool->driver == client;
	switch (asked->ask) {
	case CAU_ASK_TOOL_ADD:
		return !tool->there;
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
	case CAU_ASK_ADVANCE:
		return may_advance(w, ticket);
	default:
		return true;
	}
}

// True if no event has made the enable void, so that it must be accepted.
static bool must_enable(const world *w, const ticket_book *ticket)
{
	const tool_book *tool = oracle_book((world *)w, ticket->asked.tool);
	int client = (int)ticket->asked.asker.client;
	return w->store_takes && stands(w, tool, client, ticket->came) && is_alive(w, tool, client);
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

static void note_silence(world *w, uint64_t came)
{
	for (int i = 0; i < TOOLS; i++) {
		tool_book *tool = &w->tools[i];
		if (!is_silent(w, tool))
			continue;
		tool->silent[tool->enabler] = came;
		void_advances(w, tool->driver, came + 1, false);
		void_of_driver(w, world_tool_names[i], tool->driver, came + 1, false);
	}
}

// A later sign of life does not undo a silence that was found.
void oracle_note_silence(world *w)
{
	note_silence(w, w->came);
}

// A sign of life after the deadline does not undo the silence, even if no check found it. Requests
// that come with the sign of life are valid; earlier requests are not.
void oracle_note_life(world *w, int client, const char *name, double alive_s)
{
	note_silence(w, w->came - 1);
	for (int i = 0; i < TOOLS; i++) {
		double *newest_s = &w->tools[i].alive_s[client];
		bool about = !*name || strcmp(world_tool_names[i], name) == 0;
		if (about && alive_s > *newest_s)
			*newest_s = alive_s;
	}
	if (alive_s > w->life_s[client])
		w->life_s[client] = alive_s;
}

void oracle_note_coming(world *w, const ticket_book *ticket)
{
	const cau_asked *asked = &ticket->asked;
	tool_book *tool = oracle_book(w, asked->tool);
	note_silence(w, w->came - 1);
	if (asked->ask == CAU_ASK_ADVANCE)
		oracle_note_life(w, (int)asked->asker.client, "",
		                 asked->alive_s > 0 ? asked->alive_s : w->now_s);
	for (int32_t i = 0; i < asked->part_count; i++)
		if (asked->parts[i].off)
			oracle_switch_off(oracle_book(w, asked->parts[i].tool), ticket->came);
	if (!tool)
		return;
	oracle_note_life(w, (int)asked->asker.client, asked->tool,
	                 asked->alive_s > 0 ? asked->alive_s : w->now_s);
	if (asked->ask == CAU_ASK_ENERGY_OFF && asked->tick <= w->tick)
		oracle_switch_off(tool, ticket->came);
}

// ---- energy cut-off -----------------------------------------------------------------------------

// Turns the tool's energy off. Enables that came in by `came` do not turn it on again.
static void cut(tool_book *tool, uint64_t came)
{
	oracle_switch_off(tool, came);
	tool->enable = 0;
}

// Returns the arrival of the first waiting order of this kind and tool; 0: there is none.
static uint64_t waits(const world *w, cau_ask ask, const char *tool)
{
	for (int i = 0; i < w->ticket_count; i++) {
		const ticket_book *ticket = &w->tickets[i];
		if (ticket->asked.ask == ask && !ticket->answers && strcmp(ticket->asked.tool, tool) == 0)
			return ticket->came;
	}
	return 0;
}

static uint64_t oldest(uint64_t a, uint64_t b)
{
	return a && b ? (a < b ? a : b) : a + b; // 0 means that there is no order
}

// True for an energy cut-off of a pause. A pause cuts off the tools one after the other, and the
// first cut-off makes earlier enables of all tools void.
static bool is_cut_of_pause(world *w)
{
	uint64_t pause = oldest(w->paused, waits(w, CAU_ASK_PAUSE, ""));
	if (strcmp(w->action.drive.cut_cause, "paused") != 0 || !pause)
		return false;
	for (int i = 0; i < TOOLS && !w->pausing; i++)
		cut(&w->tools[i], pause);
	oracle_end_lockstep(w);
	w->pausing = true;
	return true;
}

// True for an energy cut-off of a session.step or session.resume that ends lock-step. Which of the
// two orders made the cut-off is known only when that order is decided.
static bool is_cut_of_leaving(world *w)
{
	if (strcmp(w->action.drive.cut_cause, "lock-step has ended") != 0)
		return false;
	if (!w->leaving && (!w->lockstep || !waits_to_leave(w)))
		world_wrong(w, "lock-step ends, and nobody ended it");
	for (int i = 0; i < TOOLS && !w->leaving; i++)
		w->tools[i].enable = 0;
	oracle_end_lockstep(w);
	w->leaving = true;
	return true;
}

void oracle_note_cut(world *w)
{
	const cau_drive *drive = &w->action.drive;
	tool_book *tool = oracle_book(w, drive->tool);
	for (int i = 0; i < TOOLS; i++)
		if (is_silent(w, &w->tools[i])) {
			w->tools[i].looked = w->came;
			void_advances(w, w->tools[i].driver, w->came + 1, true);
			void_of_driver(w, world_tool_names[i], w->tools[i].driver, w->came + 1, true);
		}
	if (is_cut_of_pause(w) || is_cut_of_leaving(w) || !w->action.was_energized)
		return;
	uint64_t change =
		oldest(waits(w, CAU_ASK_TAKE_OVER, drive->tool), waits(w, CAU_ASK_HAND_OVER, drive->tool));
	uint64_t removal = waits(w, CAU_ASK_TOOL_REMOVE, drive->tool);
	uint64_t *silent = &tool->silent[tool->enabler];
	if (strcmp(drive->cut_cause, "another driver") == 0 && change)
		cut(tool, change);
	else if (strcmp(drive->cut_cause, "the tool was removed") == 0 && removal)
		cut(tool, removal);
	else if (strcmp(drive->cut_cause, "the driver sent no heartbeat in time") == 0 &&
	         tool->looked > tool->enable)
		*silent = tool->looked > *silent ? tool->looked : *silent;
	else if (strcmp(drive->cut_cause, "the limit of ticks is reached") == 0 && is_over(w, tool))
		tool->enable = tool->limit = 0;
	else if (should_be_energized(w, tool))
		world_wrong(w, "%s is cut for nothing: %s", drive->tool, drive->cut_cause);
}

// ---- orders that are done -----------------------------------------------------------------------

static void change_driver(world *w, const ticket_book *ticket, int to)
{
	tool_book *tool = oracle_book(w, ticket->asked.tool);
	if (tool->driver == to)
		return;
	if (tool->energized)
		world_wrong(w, "%s changes its driver while its energy is on", ticket->asked.tool);
	oracle_switch_off(tool, ticket->came);
	if (tool->driver)
		void_of_driver(w, ticket->asked.tool, tool->driver, ticket->came, false);
	tool->driver = to;
}

static void note_enable(world *w, tool_book *tool, const ticket_book *ticket, uint64_t limit)
{
	int client = (int)ticket->asked.asker.client;
	tool->energized = true;
	if (stands(w, tool, client, ticket->came))
		tool->limit = limit ? w->tick + limit : 0;
	if (ticket->came > tool->enable) {
		tool->enable = ticket->came;
		tool->enabler = client;
	}
}

static void note_advance(world *w, ticket_book *ticket)
{
	for (int32_t i = 0; i < ticket->asked.part_count; i++) {
		const cau_part *part = &ticket->asked.parts[i];
		if (part->on)
			note_enable(w, oracle_book(w, part->tool), ticket, part->limit);
	}
	ticket->stepping = true;
	if (ticket->voided) // the client of the advance was lost while the core took it
		return;
	w->lockstep = (int)ticket->asked.asker.client;
	w->advance_tick = w->tick;
	w->advance_left = ticket->asked.ticks;
}

// Notes the results of an order that was done, as protocol/README.md states them.
void oracle_note_done(world *w, ticket_book *ticket)
{
	const cau_asked *asked = &ticket->asked;
	tool_book *tool = oracle_book(w, asked->tool);
	int client = (int)asked->asker.client;
	switch (asked->ask) {
	case CAU_ASK_ADVANCE:
		note_advance(w, ticket);
		break;
	case CAU_ASK_TOOL_ADD:
		tool->there = true;
		tool->driver = ticket->came > w->gone[client] ? client : 0;
		tool->deadline_s = DEADLINE_S;
		oracle_switch_off(tool, ticket->came); // an added tool is a new tool
		break;
	case CAU_ASK_TOOL_REMOVE:
		if (tool->energized)
			world_wrong(w, "%s is removed, and the core has its energy on", asked->tool);
		tool->there = tool->energized = false;
		cut(tool, ticket->came);
		tool->driver = 0;
		for (int i = 1; i <= CLIENTS; i++)
			void_of_driver(w, asked->tool, i, ticket->came, false);
		break;
	case CAU_ASK_ENERGY_ON:
		note_enable(w, tool, ticket, asked->limit);
		break;
	case CAU_ASK_ENERGY_OFF:
		tool->energized = false;
		break;
	case CAU_ASK_PAUSE:
		w->state = CAU_SESSION_PAUSED;
		oracle_switch_all_off(w, ticket->came);
		break;
	case CAU_ASK_RESUME:
		w->state = CAU_SESSION_RUNNING;
		break;
	case CAU_ASK_STEP:
		ticket->stepping = true;
		w->steps_left = asked->ticks;
		break;
	case CAU_ASK_GO:
		w->going = true;
		oracle_end_lockstep(w);
		for (int i = 0; i < TOOLS; i++)
			cut(&w->tools[i], ticket->came);
		break;
	case CAU_ASK_DESTROY:
		w->ended = true;
		break;
	default:
		break;
	}
}

// The driver changes when the order is decided.
static void note_change(world *w, const ticket_book *ticket)
{
	int client = (int)ticket->asked.asker.client, to = (int)ticket->asked.to.client;
	if (ticket->asked.ask == CAU_ASK_TAKE_OVER)
		change_driver(w, ticket, ticket->came > w->gone[client] ? client : 0);
	else if (ticket->asked.ask == CAU_ASK_HAND_OVER)
		change_driver(w, ticket, to && ticket->came < w->gone[to] ? 0 : to);
}

// Energy is off when the order is decided. An energy-off for this tick, or one that waited for the
// disk, also ends an enable that arrived later but took effect earlier.
static void note_off(world *w, const ticket_book *ticket)
{
	tool_book *tool = oracle_book(w, ticket->asked.tool);
	if (!may(w, ticket))
		world_wrong(w, "off of c%u is done, and there is no tool", ticket->asked.asker.client);
	cut(tool, ticket->came);
}

// A pause, a step or a resume ends lock-step when the order is decided. This also holds if the
// order is refused after its energy cut-offs.
static void note_left(world *w, const ticket_book *ticket, bool orders)
{
	cau_ask ask = ticket->asked.ask;
	bool leaves = ask == CAU_ASK_STEP || ask == CAU_ASK_RESUME;
	if (leaves && (w->leaving || (orders && w->lockstep))) {
		for (int i = 0; i < TOOLS; i++)
			cut(&w->tools[i], ticket->came);
		w->leaving = false;
	}
	if (orders && (leaves || ask == CAU_ASK_PAUSE))
		oracle_end_lockstep(w);
}

// Notes that the worker checks for silence before lock-step begins. Returns true if the advance is
// from a silent client.
static bool note_silence_at_advance(world *w, const ticket_book *ticket)
{
	bool silent = false;
	for (int i = 0; i < TOOLS; i++)
		silent |=
			is_silent(w, &w->tools[i]) && w->tools[i].enabler == (int)ticket->asked.asker.client;
	note_silence(w, w->came);
	return silent;
}

void oracle_check_decision(world *w)
{
	const ticket_book *ticket = oracle_ticket(w, w->action.ticket);
	cau_ask ask = ticket->asked.ask;
	bool orders = w->action.act == CAU_ACT_ORDER;
	if (w->ended)
		return;
	note_left(w, ticket, orders);
	if (ask == CAU_ASK_ADVANCE && !w->lockstep && note_silence_at_advance(w, ticket)) {
		if (orders)
			world_wrong(w, "a silent client begins lock-step");
		return;
	}
	if (orders && is_for_later(w, ticket))
		world_wrong(w, "%s of c%u is done before its tick", world_ask_names[ask],
		            ticket->asked.asker.client);
	if (orders && ticket->voided)
		world_wrong(w, "%s of c%u is done, and it was overtaken", world_ask_names[ask],
		            ticket->asked.asker.client);
	if (!orders && (ticket->voided || ticket->doubted))
		return;
	if (ask == CAU_ASK_ENERGY_ON) {
		const tool_book *tool = oracle_book(w, ticket->asked.tool);
		uint32_t client = ticket->asked.asker.client;
		bool counts_ticks = w->lockstep && w->lockstep == (int)client;
		bool silent = !counts_ticks && tool->alive_s[client] + tool->deadline_s <= w->now_s;
		if (orders && (tool->driver != (int)client || silent))
			world_wrong(w, "an enable of c%u is taken, which %s", client,
			            silent ? "is silent" : "does not drive");
		if (!orders && must_enable(w, ticket))
			world_wrong(w, "a good enable of c%u was refused: %s", ticket->asked.asker.client,
			            w->action.error.reason);
	} else if (orders && ask == CAU_ASK_ENERGY_OFF) {
		note_off(w, ticket);
	} else if (orders && !may(w, ticket)) {
		world_wrong(w, "%s of c%u is done, and it may not", world_ask_names[ask],
		            ticket->asked.asker.client);
	} else if (!orders && may(w, ticket) && ask != CAU_ASK_RESUME && ask != CAU_ASK_STEP &&
	           ask != CAU_ASK_GO) {
		world_wrong(w, "%s of c%u is refused, and it may: %s", world_ask_names[ask],
		            ticket->asked.asker.client, w->action.error.reason);
	}
	if (orders && may(w, ticket))
		note_change(w, ticket);
}
