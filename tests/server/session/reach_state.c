// SPDX-License-Identifier: GPL-3.0-or-later
#include "server/session/reach_state.h"

#include <assert.h>
#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cautery/status.h"

#define PLUS(name, bits) +(bits)
enum {
	ORDER_BITS = 0 REACH_ORDER_MEMBERS(PLUS),
	TOOL_BITS = 0 REACH_TOOL_MEMBERS(PLUS),
	TIME_BITS = 0 REACH_TIME_MEMBERS(PLUS),
	WORD_BITS = 64,
};
static_assert((REACH_QUEUE + 1) * ORDER_BITS <= WORD_BITS, "the orders are a word");
static_assert(REACH_TOOLS * TOOL_BITS + TIME_BITS <= WORD_BITS, "and all else is another");

const char *const reach_tool_names[REACH_TOOLS] = {"hook", "jaws"};

const cau_asker *reach_asker(int client)
{
	static const cau_asker askers[REACH_CLIENTS + 1] = {
		[1] = {.client = 1, .role = CAU_ROLE_OPERATE, .deadline_s = REACH_DEADLINE_S},
		[2] = {.client = 2, .role = CAU_ROLE_ADMIN, .deadline_s = REACH_DEADLINE_S}};
	static_assert(REACH_CLIENTS == 2, "the last one is an admin");
	return &askers[client];
}

int reach_tool_index(const char *name)
{
	for (int i = 0; i < REACH_TOOLS; i++)
		if (strcmp(name, reach_tool_names[i]) == 0)
			return i;
	return 0;
}

bool reach_is_fresh(double alive_s, double now_s)
{
	return alive_s + REACH_DEADLINE_S > now_s;
}

// ---- decode a state into a machine --------------------------------------------------------------

// Returns the moment of the order at this place. Orders have even moments, so that a pause fits
// between any two.
static uint64_t moment_of_place(int place)
{
	return 2 * (uint64_t)place;
}

static double alive_of(uint8_t fresh)
{
	return fresh ? REACH_NOW_S : 0;
}

static void decode_order(const reach_order *from, int place, cau_waiting *to)
{
	memset(to, 0, sizeof *to);
	to->asked.ticket = (uint64_t)place;
	to->asked.ask = (cau_ask)from->ask;
	to->asked.asker = *reach_asker(from->client);
	bool advances = from->ask == CAU_ASK_ADVANCE;
	to->asked.to = *reach_asker(advances ? 0 : from->to);
	to->asked.part_count = advances && from->to;
	if (to->asked.part_count) {
		to->asked.parts[0].on = from->to == REACH_ON;
		to->asked.parts[0].off = from->to == REACH_OFF;
		strcpy(to->asked.parts[0].tool, reach_tool_names[from->tool]);
	}
	bool about_tool = from->ask >= CAU_ASK_TOOL_ADD && from->ask <= CAU_ASK_REQUEST_TAKEOVER;
	if (about_tool)
		strcpy(to->asked.tool, reach_tool_names[from->tool]);
	to->asked.tick = from->later ? REACH_TICK + from->later : 0;
	to->asked.ticks = from->ticks;
	to->asked.numbered = from->looks || from->postponed;
	to->postponed = from->postponed;
	to->moment = moment_of_place(place);
	to->overtaken = from->ask == CAU_ASK_RESUME && from->cut;
	if (from->cut && from->ask != CAU_ASK_RESUME) {
		to->cut_moment = 2 * (REACH_QUEUE + 2);
		to->void_cause = CAU_VOIDED_LOST;
	}
	to->alive_s = alive_of(from->fresh);
	to->gone = from->gone;
	to->to_gone = from->to_gone;
}

static void decode_tool(const reach_tool *from, int index, cau_drive *to)
{
	memset(to, 0, sizeof *to);
	strcpy(to->tool, reach_tool_names[index]);
	to->driver = *reach_asker(from->driver);
	to->alive_s = alive_of(from->fresh);
	to->enabled = from->enabled;
	to->energized = from->energized;
	to->freeze = from->freeze;
	to->by_order = from->by_order;
	to->cut_moment = moment_of_place(from->cut_place);
}

void reach_decode(const reach_state *state, cau_logic *logic)
{
	cau_logic_init(logic, state->capacity);
	logic->moment = 2 * (REACH_QUEUE + 2);
	logic->now_s = REACH_NOW_S;
	logic->next_step_s = REACH_TICK_S;
	logic->tick = REACH_TICK;
	logic->step_s = REACH_STEP_S;
	logic->lockstep = state->lockstep;
	logic->advance_tick = state->lockstep ? REACH_TICK - state->since : 0;
	logic->state = state->state;
	logic->going = state->going;
	logic->draining = state->draining;
	logic->ended = state->ended;
	logic->store_takes = state->store_takes;
	logic->acting = (cau_act)state->acting;
	logic->steps_left = state->steps_left;
	logic->stepping = state->stepping ? REACH_STEP_TICKET : 0;
	if (state->acting == CAU_ACT_CUT)
		strcpy(logic->cutting, reach_tool_names[state->cutting]);
	if (state->pause_place)
		logic->pause_moment = moment_of_place(state->pause_place - 1) + 1;
	logic->border = state->border_place > 0;
	if (logic->border)
		logic->border_moment = moment_of_place(state->border_place - 1);
	assert(state->tool_count <= REACH_TOOLS);
	for (int i = 0; i < state->tool_count; i++)
		decode_tool(&state->tools[i], i, &logic->drives[i]);
	logic->drive_count = state->tool_count;
	for (int i = 0; i < state->order_count; i++)
		if (i + 1 == state->serves)
			decode_order(&state->orders[i], i + 1, &logic->serving);
		else
			decode_order(&state->orders[i], i + 1, &logic->waiting[logic->count++]);
	if (state->looks)
		decode_order(&state->orders[state->looks - 1], state->looks, &logic->serving);
}

void reach_copy_machine(const cau_logic *from, cau_logic *to)
{
	const size_t drives = offsetof(cau_logic, drives), behind = offsetof(cau_logic, drive_count);
	memcpy(to, from, drives + (size_t)from->drive_count * sizeof *from->drives);
	memcpy((char *)to + behind, (const char *)from + behind,
	       sizeof *from - behind + (size_t)from->count * sizeof *from->waiting);
}

// ---- encode a machine as a state ----------------------------------------------------------------

// The orders of a machine in order of arrival, including the order being served.
typedef struct line {
	const cau_waiting *orders[REACH_QUEUE + 1];
	int count, serves, looks; // places from 1; 0: none
} line;

static line line_of(const cau_logic *logic)
{
	line made = {0};
	bool serves = logic->acting == CAU_ACT_ORDER, passed = false;
	for (int i = 0; i < logic->count; i++) {
		if (serves && !passed && logic->serving.moment < logic->waiting[i].moment) {
			passed = true;
			made.orders[made.count++] = &logic->serving;
			made.serves = made.count;
		}
		made.orders[made.count++] = &logic->waiting[i];
		bool looks = logic->acting == CAU_ACT_LOOK &&
		             logic->waiting[i].asked.ticket == logic->serving.asked.ticket;
		if (looks)
			made.looks = made.count;
	}
	if (serves && !passed) {
		made.orders[made.count++] = &logic->serving;
		made.serves = made.count;
	}
	return made;
}

// Encodes an order. Members that this kind of order does not use stay 0.
static void encode_order(const cau_logic *logic, const cau_waiting *from, reach_order *to)
{
	const cau_asked *asked = &from->asked;
	bool on = asked->ask == CAU_ASK_ENERGY_ON, takes = asked->ask == CAU_ASK_TAKE_OVER;
	bool hands = asked->ask == CAU_ASK_HAND_OVER, off = asked->ask == CAU_ASK_ENERGY_OFF;
	to->ask = (uint8_t)asked->ask;
	bool of_later = off && asked->tick > logic->tick, advances = asked->ask == CAU_ASK_ADVANCE;
	bool part_on = asked->part_count && asked->parts[0].on;
	const char *tool = asked->part_count ? asked->parts[0].tool : asked->tool;
	to->client = on || takes || hands || of_later || advances ? (uint8_t)asked->asker.client : 1;
	to->tool = (uint8_t)reach_tool_index(tool);
	to->to = (uint8_t)asked->to.client;
	if (asked->part_count)
		to->to = part_on ? REACH_ON : REACH_OFF;
	to->fresh = (on || takes || part_on) && reach_is_fresh(from->alive_s, logic->now_s);
	to->cut = ((on || off || advances) && from->cut_moment) || from->overtaken;
	to->gone = takes && from->gone;
	to->to_gone = hands && from->to_gone;
	to->later = asked->tick > logic->tick ? (uint8_t)(asked->tick - logic->tick) : 0;
	to->looks = asked->numbered && !from->looked;
	to->postponed = from->postponed;
	to->ticks = asked->ask == CAU_ASK_STEP || advances ? (uint8_t)asked->ticks : 0;
}

// Returns the place of the newest order about this tool's energy that came in by `moment`, or 0.
static uint8_t place_of(const line *orders, const char *tool, uint64_t moment)
{
	for (int i = orders->count; i-- > 0;) {
		const cau_waiting *order = orders->orders[i];
		cau_ask ask = order->asked.ask;
		bool bears = ask == CAU_ASK_ENERGY_ON || ask == CAU_ASK_ENERGY_OFF;
		const char *about = bears                     ? order->asked.tool
		                    : order->asked.part_count ? order->asked.parts[0].tool
		                                              : "";
		if (order->moment <= moment && strcmp(about, tool) == 0)
			return (uint8_t)(i + 1);
	}
	return 0;
}

static void encode_tool(const cau_logic *logic, const cau_drive *from, const line *orders,
                        reach_tool *to)
{
	to->driver = (uint8_t)from->driver.client;
	to->fresh = to->driver && reach_is_fresh(from->alive_s, logic->now_s);
	to->enabled = from->enabled;
	to->energized = from->energized;
	to->freeze = from->freeze;
	to->by_order = from->by_order;
	to->cut_place = place_of(orders, from->tool, from->cut_moment);
}

static uint8_t orders_until(const line *orders, uint64_t moment)
{
	int count = 0;
	for (int i = 0; i < orders->count; i++)
		count += orders->orders[i]->moment <= moment;
	return (uint8_t)count;
}

static void encode_time(const cau_logic *logic, const line *orders, reach_state *state)
{
	state->state = (uint8_t)logic->state;
	state->going = logic->going;
	state->draining = logic->draining;
	state->ended = logic->ended;
	state->store_takes = logic->store_takes;
	state->acting = (uint8_t)logic->acting;
	if (logic->acting == CAU_ACT_CUT)
		state->cutting = (uint8_t)reach_tool_index(logic->cutting);
	state->steps_left = (uint8_t)logic->steps_left;
	state->stepping = logic->stepping != 0;
	state->lockstep = (uint8_t)logic->lockstep;
	state->since = logic->lockstep && logic->tick > logic->advance_tick;
	if (logic->pause_moment)
		state->pause_place = (uint8_t)(1 + orders_until(orders, logic->pause_moment));
	if (logic->border)
		state->border_place = (uint8_t)(1 + orders_until(orders, logic->border_moment));
}

void reach_encode(const cau_logic *logic, const reach_state *books, reach_state *state)
{
	line orders = line_of(logic);
	memset(state, 0, sizeof *state);
	state->tool_count = (uint8_t)logic->drive_count;
	state->capacity = (uint8_t)logic->capacity;
	state->order_count = (uint8_t)orders.count;
	state->serves = (uint8_t)orders.serves;
	state->looks = (uint8_t)orders.looks;
	encode_time(logic, &orders, state);
	state->held = books->held;
	state->steps = books->steps;
	for (int i = 0; i < orders.count; i++) {
		encode_order(logic, orders.orders[i], &state->orders[i]);
		state->orders[i].overtaken = books->orders[i].overtaken;
	}
	for (int i = 0; i < logic->drive_count; i++) {
		encode_tool(logic, &logic->drives[i], &orders, &state->tools[i]);
		state->tools[i].heated = books->tools[i].heated;
		state->tools[i].wanted = books->tools[i].wanted;
	}
}

// ---- symmetry -----------------------------------------------------------------------------------

void reach_swap_tools(const reach_state *state, reach_state *swapped)
{
	*swapped = *state;
	swapped->tools[0] = state->tools[1];
	swapped->tools[1] = state->tools[0];
	for (int i = 0; i < state->order_count; i++) {
		uint8_t ask = state->orders[i].ask;
		bool about_tool = (ask >= CAU_ASK_TOOL_ADD && ask <= CAU_ASK_REQUEST_TAKEOVER) ||
		                  (ask == CAU_ASK_ADVANCE && state->orders[i].to);
		if (about_tool)
			swapped->orders[i].tool = !state->orders[i].tool;
	}
	if (state->acting == CAU_ACT_CUT)
		swapped->cutting = !state->cutting;
}

// ---- packing ------------------------------------------------------------------------------------

// Puts each member at its own bits. Bits of a value that exceed the member's size are collected in
// `beyond`.
#define JOIN(name, bits)                                                                           \
	at -= (bits);                                                                                  \
	word |= (uint64_t)from->name << at;                                                            \
	beyond |= from->name >> (bits);

static uint64_t word_of(uint64_t word, int beyond)
{
	if (beyond)
		abort();
	return word;
}

static uint64_t pack_order(const reach_order *from)
{
	int at = ORDER_BITS, beyond = 0;
	uint64_t word = 0;
	REACH_ORDER_MEMBERS(JOIN)
	return word_of(word, beyond);
}

static uint64_t pack_tool(const reach_tool *from)
{
	int at = TOOL_BITS, beyond = 0;
	uint64_t word = 0;
	REACH_TOOL_MEMBERS(JOIN)
	return word_of(word, beyond);
}

static uint64_t pack_time(const reach_state *from)
{
	int at = TIME_BITS, beyond = 0;
	uint64_t word = 0;
	REACH_TIME_MEMBERS(JOIN)
	return word_of(word, beyond);
}
#undef JOIN

void reach_pack(const reach_state *state, reach_packed *packed)
{
	*packed = (reach_packed){{0, pack_time(state)}};
	for (int i = 0; i < state->order_count; i++) // there are no orders beyond the count
		packed->word[0] |= pack_order(&state->orders[i]) << i * ORDER_BITS;
	for (int i = 0; i < state->tool_count; i++)
		packed->word[1] |= pack_tool(&state->tools[i]) << (TIME_BITS + i * TOOL_BITS);
}

#define TAKE(name, bits)                                                                           \
	at -= (bits);                                                                                  \
	to->name = (uint8_t)(word >> at & ((1u << (bits)) - 1));

static void unpack_order(uint64_t word, reach_order *to)
{
	int at = ORDER_BITS;
	REACH_ORDER_MEMBERS(TAKE)
}

static void unpack_tool(uint64_t word, reach_tool *to)
{
	int at = TOOL_BITS;
	REACH_TOOL_MEMBERS(TAKE)
}

static void unpack_time(uint64_t word, reach_state *to)
{
	int at = TIME_BITS;
	REACH_TIME_MEMBERS(TAKE)
}
#undef TAKE

void reach_unpack(const reach_packed *packed, reach_state *state)
{
	unpack_time(packed->word[1], state);
	for (int i = 0; i <= REACH_QUEUE; i++)
		unpack_order(packed->word[0] >> i * ORDER_BITS, &state->orders[i]);
	for (int i = 0; i < REACH_TOOLS; i++)
		unpack_tool(packed->word[1] >> (TIME_BITS + i * TOOL_BITS), &state->tools[i]);
}
