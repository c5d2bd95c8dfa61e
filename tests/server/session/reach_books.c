// SPDX-License-Identifier: GPL-3.0-or-later
#include "server/session/reach_books.h"

#include <string.h>

void reach_darken(reach_state *books, int tool, int client)
{
	for (int i = 0; i < books->order_count; i++) {
		reach_order *order = &books->orders[i];
		if (order->ask == CAU_ASK_ENERGY_ON && order->tool == tool &&
		    (!client || order->client == client))
			order->overtaken = 1;
	}
	if (!client || books->tools[tool].driver == client)
		books->tools[tool].wanted = 0;
}

void reach_darken_all(reach_state *books, int client)
{
	for (int i = 0; i < books->tool_count; i++)
		reach_darken(books, i, client);
}

void reach_darken_before(reach_state *books, int tool, int place)
{
	for (int i = 0; i < place - 1; i++)
		if (books->orders[i].ask == CAU_ASK_ENERGY_ON && books->orders[i].tool == tool)
			books->orders[i].overtaken = 1;
	books->tools[tool].wanted = 0;
}

void reach_note_silence(reach_state *books)
{
	for (int i = 0; i < books->tool_count; i++)
		if (books->tools[i].wanted && !books->tools[i].fresh)
			reach_darken(books, i, books->tools[i].driver);
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
