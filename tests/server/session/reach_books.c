// SPDX-License-Identifier: GPL-3.0-or-later
#include "server/session/reach_books.h"

#include <string.h>

static bool enables(const reach_order *order, int tool)
{
	bool on =
		order->ask == CAU_ASK_ENERGY_ON || (order->ask == CAU_ASK_ADVANCE && order->to == REACH_ON);
	return on && order->tool == tool;
}

void reach_switch_off(reach_state *books, int tool, int client)
{
	for (int i = 0; i < books->order_count; i++) {
		reach_order *order = &books->orders[i];
		if (enables(order, tool) && (!client || order->client == client))
			order->overtaken = 1;
	}
	if (!client || books->tools[tool].driver == client)
		books->tools[tool].wanted = 0;
}

void reach_switch_all_off(reach_state *books, int client)
{
	for (int i = 0; i < books->tool_count; i++)
		reach_switch_off(books, i, client);
}

void reach_switch_off_before(reach_state *books, int tool, int place)
{
	for (int i = 0; i < place - 1; i++)
		if (enables(&books->orders[i], tool))
			books->orders[i].overtaken = 1;
	books->tools[tool].wanted = 0;
}

bool reach_is_silent(const reach_state *books, const reach_tool *tool)
{
	bool by_ticks = books->lockstep && tool->driver == books->lockstep;
	return by_ticks ? books->steps && books->since : !tool->fresh;
}

// Makes the client's advances void, because they depend on all of its tools.
static void overtake_advances(reach_state *books, int client)
{
	for (int i = 0; i < books->order_count; i++)
		if (books->orders[i].ask == CAU_ASK_ADVANCE && books->orders[i].client == client)
			books->orders[i].overtaken = 1;
}

void reach_note_silence(reach_state *books)
{
	for (int i = 0; i < books->tool_count; i++)
		if (books->tools[i].wanted && reach_is_silent(books, &books->tools[i])) {
			reach_switch_off(books, i, books->tools[i].driver);
			overtake_advances(books, books->tools[i].driver);
		}
}

void reach_drop_order(reach_state *books, int place)
{
	size_t after = (size_t)(books->order_count - place);
	memmove(&books->orders[place - 1], &books->orders[place], after * sizeof *books->orders);
	memset(&books->orders[--books->order_count], 0, sizeof *books->orders);
}

int reach_head(const reach_state *books)
{
	for (int i = 0; i < books->order_count; i++)
		if (i + 1 != books->serves && !books->orders[i].later && !books->orders[i].postponed)
			return i + 1;
	return 0;
}

bool reach_waits_postponed(const reach_state *books, cau_ask ask)
{
	for (int i = 0; i < books->order_count; i++)
		if (books->orders[i].ask == ask && books->orders[i].postponed)
			return true;
	return false;
}
