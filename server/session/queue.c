// SPDX-License-Identifier: GPL-3.0-or-later
// Orders that wait for a tick border, in the order in which they came.
//
// An order is refused on arrival only if there is no capacity for it (queue, store, the session's
// end). Energy off and pause are never refused: each tool can note an off, and the session can note
// a pause. Signs of life, a hidden page and departures affect waiting orders as well as the present
// state.
//
// Every command for a later tick waits here, and none in the core: the command must not act if its
// asker or its tool is lost before. These commands have a capacity of their own, and each client a
// share of it. So no client can block orders for now, or another client's commands for later.
#include <math.h>
#include <stdio.h>

#include "cautery/assert.h"
#include "cautery/rpc_errors.h"
#include "session/internal.h"

// ---- the list -----------------------------------------------------------------------------------

static bool is_for_later(const cau_logic *logic, const cau_asked *asked)
{
	CAU_RULE_INDEX(asked->ask, CAU_ASK_COUNT);
	return asked->tick > logic->tick && !logic->ended;
}

// True if the order waits for a later tick. A void order waits only for its refusal.
static bool waits_for_later(const cau_logic *logic, const cau_waiting *order)
{
	return is_for_later(logic, &order->asked) && !order->cut_moment;
}

static bool is_ready(const cau_logic *logic, const cau_waiting *order)
{
	return (!order->postponed || logic->ended) && !waits_for_later(logic, order);
}

int32_t cau_logic_later_most(int32_t capacity)
{
	CAU_ASSERT(capacity > 0, "a queue of %d", capacity);
	int32_t quarter = capacity < 4 ? 1 : capacity / 4;
	return quarter < CAU_LATER_OF_CLIENT ? quarter : CAU_LATER_OF_CLIENT;
}

const cau_waiting *cau_logic_later(const cau_logic *logic, int32_t *i)
{
	CAU_ASSERT(*i >= 0, "place %d", *i);
	while (*i < logic->count) {
		const cau_waiting *order = &logic->waiting[(*i)++];
		if (waits_for_later(logic, order))
			return order;
	}
	return NULL;
}

cau_waiting *cau_queue_head(cau_logic *logic)
{
	for (int32_t i = 0; i < logic->count; i++) {
		cau_waiting *order = &logic->waiting[i];
		if (is_ready(logic, order))
			return order->moment <= logic->border_moment || logic->ended ? order : NULL;
	}
	return NULL;
}

cau_waiting *cau_queue_find(cau_logic *logic, uint64_t ticket)
{
	for (int32_t i = 0; i < logic->count; i++)
		if (logic->waiting[i].asked.ticket == ticket)
			return &logic->waiting[i];
	return NULL;
}

const cau_waiting *cau_queue_find_ask(const cau_logic *logic, cau_ask ask)
{
	for (int32_t i = 0; i < logic->count; i++)
		if (logic->waiting[i].asked.ask == ask && is_ready(logic, &logic->waiting[i]))
			return &logic->waiting[i];
	return NULL;
}

bool cau_queue_off_waits(const cau_logic *logic, const char *tool)
{
	for (int32_t i = 0; i < logic->count; i++) {
		const cau_asked *asked = &logic->waiting[i].asked;
		if (asked->ask == CAU_ASK_ENERGY_OFF && strcmp(asked->tool, tool) == 0 &&
		    !is_for_later(logic, asked) && !logic->waiting[i].cut_moment)
			return true;
	}
	return false;
}

void cau_queue_remove(cau_logic *logic, cau_waiting *order)
{
	CAU_RULE_INDEX(order - logic->waiting, logic->count);
	size_t after = (size_t)(logic->waiting + logic->count - (order + 1));
	memmove(order, order + 1, after * sizeof *order);
	logic->count--;
	CAU_RULE(logic->count >= 0, "%d orders", logic->count);
}

int32_t cau_logic_waiting(const cau_logic *logic)
{
	return logic->count;
}

// True if an order is due now. Motion in a running session waits for the border that comes anyway.
bool cau_queue_is_due(const cau_logic *logic)
{
	bool running = logic->state == CAU_SESSION_RUNNING;
	for (int32_t i = 0; i < logic->count; i++) {
		const cau_waiting *order = &logic->waiting[i];
		if (is_ready(logic, order) && !(running && order->asked.ask == CAU_ASK_MOTION))
			return true;
	}
	return false;
}

// ---- events that affect waiting orders ----------------------------------------------------------

static void bring_to_life(cau_waiting *order, uint32_t client, const char *tool, double time_s)
{
	bool its_own = order->asked.asker.client == client;
	if (its_own && (!*tool || strcmp(order->asked.tool, tool) == 0))
		order->alive_s = fmax(order->alive_s, time_s);
}

double cau_order_alive_s(const cau_asked *asked, double now_s)
{
	return asked->alive_s > 0 ? fmin(asked->alive_s, now_s) : now_s;
}

void cau_queue_alive(cau_logic *logic, uint32_t client, const char *tool, double time_s)
{
	for (int32_t i = 0; i < logic->count; i++)
		bring_to_life(&logic->waiting[i], client, tool, time_s);
	bring_to_life(&logic->serving, client, tool, time_s);
}

// Makes an order void. The first cause is the one that is reported; the moment is the newest.
static void make_void(cau_logic *logic, cau_waiting *order, cau_void_cause cause)
{
	CAU_RULE(cause != CAU_VOIDED_NOT, "order %llu is void for no cause",
	         (unsigned long long)order->asked.ticket);
	order->cut_moment = logic->moment;
	if (order->void_cause == CAU_VOIDED_NOT)
		order->void_cause = cause;
}

// True if the order becomes void when the client that sent it loses the order's tool. This holds
// for orders that use the tool, and for orders for a later tick. An energy-off of any client stays
// valid. The exception is an energy-off that the driver itself sent for a later tick: it was the
// end of the driver's own use.
static bool is_of_hold(cau_logic *logic, const cau_waiting *order)
{
	const cau_asked *asked = &order->asked;
	switch (asked->ask) {
	case CAU_ASK_ENERGY_ON:
	case CAU_ASK_TOOL_USE:
	case CAU_ASK_MOTION:
	case CAU_ASK_ADVANCE:
		return true;
	case CAU_ASK_TOOL_KEEP:
	case CAU_ASK_TOOL_REMOVE:
		return waits_for_later(logic, order);
	case CAU_ASK_ENERGY_OFF: {
		const cau_drive *drive = cau_drive_find(logic, asked->tool);
		bool drives = drive && drive->driver.client == asked->asker.client;
		return drives && waits_for_later(logic, order);
	}
	default:
		return false;
	}
}

static void cut_order(cau_logic *logic, cau_waiting *order, uint32_t client)
{
	if (order->asked.asker.client == client && is_of_hold(logic, order))
		make_void(logic, order, CAU_VOIDED_LOST);
}

void cau_queue_cut(cau_logic *logic, uint32_t client)
{
	for (int32_t i = 0; i < logic->count; i++)
		cut_order(logic, &logic->waiting[i], client);
	cut_order(logic, &logic->serving, client);
}

// Makes the order void if the client that sent it is silent. An advance depends on all tools that
// this client drives, another order only on the order's own tool.
static void cut_silent(cau_logic *logic, cau_waiting *order, double now_s)
{
	for (int32_t i = 0; i < logic->drive_count; i++) {
		const cau_drive *drive = &logic->drives[i];
		bool about =
			order->asked.ask == CAU_ASK_ADVANCE || strcmp(order->asked.tool, drive->tool) == 0;
		if (about && cau_drive_is_silent(logic, drive, now_s) &&
		    order->asked.asker.client == drive->driver.client && is_of_hold(logic, order))
			make_void(logic, order, CAU_VOIDED_LOST);
	}
}

void cau_queue_change_hands(cau_logic *logic, const cau_drive *drive, uint64_t moment)
{
	CAU_RULE(drive->tool[0] != 0, "a tool without a name changes hands at %llu",
	         (unsigned long long)moment);
	for (int32_t i = 0; i < logic->count; i++) {
		cau_waiting *order = &logic->waiting[i];
		bool its_own = drive->driver.client && order->asked.asker.client == drive->driver.client &&
		               strcmp(order->asked.tool, drive->tool) == 0;
		bool off = order->asked.ask == CAU_ASK_ENERGY_OFF && waits_for_later(logic, order);
		if (its_own && order->moment < moment && (off || is_of_hold(logic, order)))
			make_void(logic, order, CAU_VOIDED_CHANGED_HANDS);
	}
}

void cau_queue_remove_tool(cau_logic *logic, const char *tool, uint64_t moment)
{
	CAU_RULE(!cau_drive_find(logic, tool), "tool %s is removed and is there", tool);
	for (int32_t i = 0; i < logic->count; i++) {
		cau_waiting *order = &logic->waiting[i];
		bool about = order->asked.ask >= CAU_ASK_TOOL_KEEP &&
		             order->asked.ask <= CAU_ASK_ENERGY_OFF && strcmp(order->asked.tool, tool) == 0;
		bool off = order->asked.ask == CAU_ASK_ENERGY_OFF && waits_for_later(logic, order);
		if (about && order->moment < moment && (off || is_of_hold(logic, order)))
			make_void(logic, order, CAU_VOIDED_REMOVED);
	}
}

void cau_queue_cancel(cau_logic *logic, uint32_t client, uint64_t number, cau_effects *effects)
{
	for (int32_t i = 0; i < logic->count; i++) {
		cau_waiting *order = &logic->waiting[i];
		bool its_own = !client || order->asked.asker.client == client;
		if (!its_own || (number && order->moment != number) || !waits_for_later(logic, order))
			continue;
		make_void(logic, order, CAU_VOIDED_CANCELLED);
		cau_effect_wake(effects);
	}
}

// Makes orders of silent drivers void. A sign of life after the silence does not restore them.
void cau_queue_cut_silent(cau_logic *logic, double now_s)
{
	for (int32_t i = 0; i < logic->count; i++)
		cut_silent(logic, &logic->waiting[i], now_s);
	cut_silent(logic, &logic->serving, now_s);
}

// Marks older resume orders that were held up, so that they do not undo the pause.
void cau_queue_overtake(cau_logic *logic, uint64_t moment)
{
	for (int32_t i = 0; i < logic->count; i++)
		if (logic->waiting[i].asked.ask == CAU_ASK_RESUME && logic->waiting[i].moment < moment)
			logic->waiting[i].overtaken = true;
}

static void forget_order(cau_logic *logic, cau_waiting *order, uint32_t client)
{
	if (order->asked.asker.client == client && waits_for_later(logic, order))
		make_void(logic, order, CAU_VOIDED_LOST);
	order->gone = order->gone || order->asked.asker.client == client;
	order->to_gone = order->to_gone || order->asked.to.client == client;
}

void cau_queue_forget(cau_logic *logic, uint32_t client)
{
	for (int32_t i = 0; i < logic->count; i++)
		forget_order(logic, &logic->waiting[i], client);
	forget_order(logic, &logic->serving, client);
}

// True if the order is an advance that enables the tool.
static bool turns_on(const cau_asked *asked, const char *tool)
{
	for (int32_t i = 0; i < asked->part_count; i++)
		if (asked->parts[i].on && strcmp(asked->parts[i].tool, tool) == 0)
			return true;
	return false;
}

void cau_queue_switch_off(cau_logic *logic, const char *tool, uint64_t moment)
{
	CAU_RULE(!cau_drive_find(logic, tool), "tool %s is there and keeps its own moments", tool);
	for (int32_t i = 0; i < logic->count; i++) {
		cau_waiting *order = &logic->waiting[i];
		if (order->moment >= moment)
			continue;
		if (order->asked.ask == CAU_ASK_ENERGY_ON && strcmp(order->asked.tool, tool) == 0)
			make_void(logic, order, CAU_VOIDED_LOST);
		else if (turns_on(&order->asked, tool))
			make_void(logic, order, CAU_VOIDED_DARKENED);
	}
}

// Notes an off for a tool that is still to be added. Enables from before this moment then have no
// effect.
static void cut_coming(cau_logic *logic, cau_waiting *order, const char *tool)
{
	if (order->asked.ask == CAU_ASK_TOOL_ADD && strcmp(order->asked.tool, tool) == 0)
		order->off_moment = logic->moment;
}

void cau_queue_committed(cau_logic *logic, cau_effects *effects)
{
	for (int32_t i = 0; i < logic->count; i++)
		if (logic->waiting[i].postponed) {
			logic->waiting[i].postponed = false;
			cau_effect_wake(effects);
		}
}

// ---- arrival ------------------------------------------------------------------------------------

// Counts the orders that wait for a later tick, of one client or (0) of all.
static int32_t count_later(const cau_logic *logic, uint32_t client)
{
	int32_t count = 0;
	for (int32_t i = 0; i < logic->count; i++)
		count += waits_for_later(logic, &logic->waiting[i]) &&
		         (!client || logic->waiting[i].asked.asker.client == client);
	return count;
}

static cau_status no_room_for_later(const cau_logic *logic, uint32_t client, cau_error *error)
{
	int32_t most = cau_logic_later_most(logic->capacity);
	if (count_later(logic, client) >= most)
		return cau_fail(error, CAU_LIMIT, "params.tick",
		                "%d commands of this client wait for later ticks, which is the limit "
		                "(session.waiting lists them, session.cancel cancels them)",
		                most);
	if (count_later(logic, 0) >= logic->capacity || logic->count >= 2 * logic->capacity)
		return cau_fail(
			error, CAU_LIMIT, "params.tick",
			"%d commands of all clients wait for later ticks already (setting queue_commands)",
			logic->capacity);
	return CAU_OK;
}

// Returns why there is no capacity for the order; CAU_OK if there is.
static cau_status no_room(const cau_logic *logic, const cau_asked *asked, int32_t *code,
                          cau_error *error)
{
	*code = 0;
	if (logic->draining)
		return cau_fail(error, CAU_BAD_STATE, "", "the daemon is ending");
	if (!logic->store_takes) {
		*code = CAU_RPC_STORE_FULL;
		return cau_fail(error, CAU_IO, "", "the store is full: %s", logic->store_reason);
	}
	if (is_for_later(logic, asked))
		return no_room_for_later(logic, asked->asker.client, error);
	if (logic->count - count_later(logic, 0) >= logic->capacity)
		return cau_fail(error, CAU_LIMIT, "",
		                "the session's queue is full (setting queue_commands)");
	return CAU_OK;
}

static void refuse(cau_effects *effects, uint64_t ticket, const cau_error *error, int32_t code)
{
	CAU_RULE(error->status != CAU_OK, "order %llu is refused for no reason",
	         (unsigned long long)ticket);
	cau_effect *effect = cau_effect_add(effects, CAU_EFFECT_REFUSE, ticket);
	effect->error = *error;
	effect->code = code;
}

// Turns the energy off from this moment on, whatever happens to the order.
static void turn_off(cau_logic *logic, const cau_asked *asked, const char *tool, bool queued,
                     cau_effects *effects)
{
	CAU_RULE(asked->ask == CAU_ASK_ENERGY_OFF || asked->ask == CAU_ASK_ADVANCE,
	         "order %d turns energy off", (int)asked->ask);
	char cause[CAU_CAUSE_BYTES];
	cau_drive *drive = cau_drive_find(logic, tool);
	snprintf(cause, sizeof cause, "turned off by %.24s", asked->asker.name);
	if (drive) {
		cau_drive_cut(drive, logic->moment, CAU_ENERGY_OFF_COMMANDED, cause, effects);
		drive->by_order = queued;
	} else {
		cau_queue_switch_off(logic, tool, logic->moment);
	}
	for (int32_t i = 0; i < logic->count; i++)
		cut_coming(logic, &logic->waiting[i], tool);
	cut_coming(logic, &logic->serving, tool);
}

// Turns off the energy of the tools that an advance turns off. The worker carries out these
// cut-offs before it serves the advance.
static void turn_parts_off(cau_logic *logic, const cau_asked *asked, cau_effects *effects)
{
	for (int32_t i = 0; i < asked->part_count; i++)
		if (asked->parts[i].off)
			turn_off(logic, asked, asked->parts[i].tool, false, effects);
}

// Takes an order that needs no entry in the queue. Returns false if the order needs one.
static bool take_without_room(cau_logic *logic, const cau_asked *asked, cau_effects *effects)
{
	CAU_RULE(logic->moment > 0, "an order before the first event, of ticket %llu",
	         (unsigned long long)asked->ticket);
	if (asked->ask == CAU_ASK_PAUSE)
		logic->pause_moment = logic->moment;
	else if (asked->ask != CAU_ASK_ENERGY_OFF)
		return false;
	cau_effect_add(effects, CAU_EFFECT_UNSTORED, asked->ticket);
	cau_effect_wake(effects);
	return true;
}

// Returns the order that the new motion replaces, or NULL. It is the newest order that affects the
// tool, if this is a motion of the same driver. Nothing then lies between the two motions, and the
// newer pose counts.
static cau_waiting *superseded(cau_logic *logic, const cau_asked *asked)
{
	CAU_RULE(asked->ask == CAU_ASK_MOTION, "order %d takes the place of motion", (int)asked->ask);
	cau_waiting *found = NULL;
	for (int32_t i = 0; i < logic->count; i++) {
		cau_waiting *order = &logic->waiting[i];
		if (waits_for_later(logic, order))
			continue;
		bool same = strcmp(order->asked.tool, asked->tool) == 0;
		bool apart = order->asked.ask == CAU_ASK_TISSUE || (*order->asked.tool && !same);
		if (!apart)
			found = same && order->asked.ask == CAU_ASK_MOTION && !order->cut_moment &&
			                order->asked.asker.client == asked->asker.client
			            ? order
			            : NULL;
	}
	return found;
}

static void append(cau_logic *logic, const cau_asked *asked)
{
	CAU_RULE_INDEX(logic->count, 2 * logic->capacity);
	logic->waiting[logic->count++] =
		(cau_waiting){.asked = *asked,
	                  .moment = logic->moment,
	                  .alive_s = cau_order_alive_s(asked, logic->now_s)};
}

void cau_queue_take(cau_logic *logic, const cau_asked *asked, cau_effects *effects)
{
	CAU_RULE_INDEX(asked->ask, CAU_ASK_COUNT);
	CAU_RULE(logic->count >= 0 && logic->count <= 2 * logic->capacity, "%d orders in a queue of %d",
	         logic->count, logic->capacity);
	cau_error error = {0};
	int32_t code;
	if (logic->ended) {
		cau_fail(&error, CAU_NOT_FOUND, "params.session", "the session is destroyed");
		refuse(effects, asked->ticket, &error, CAU_RPC_NOT_HERE);
		return;
	}
	bool later = is_for_later(logic, asked);
	cau_waiting *older = asked->ask == CAU_ASK_MOTION && !later ? superseded(logic, asked) : NULL;
	cau_status status = no_room(logic, asked, &code, &error);
	if (asked->ask == CAU_ASK_ENERGY_OFF && (status || !later))
		turn_off(logic, asked, asked->tool, !status, effects);
	if (asked->ask == CAU_ASK_ADVANCE)
		turn_parts_off(logic, asked, effects);
	if (status && take_without_room(logic, asked, effects))
		return;
	if (status == CAU_LIMIT && older)
		status = CAU_OK;
	if (status) {
		refuse(effects, asked->ticket, &error, code);
		return;
	}
	if (older) {
		cau_effect_add(effects, CAU_EFFECT_REPLACED, older->asked.ticket);
		older->asked = *asked;
		older->alive_s = fmax(older->alive_s, cau_order_alive_s(asked, logic->now_s));
		return;
	}
	append(logic, asked);
	if (asked->ask != CAU_ASK_MOTION || logic->state != CAU_SESSION_RUNNING)
		cau_effect_wake(effects);
}
