// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulation/books.h"

#include <math.h>

// FIRST_M_S2: gravity of number 0. STEP_M_S2: difference of the gravities of two successive
// numbers. Steps of 0.001 m/s^2 are far above rounding, and 4096 of them are within the range of a
// scene.
#define FIRST_M_S2 10.
#define STEP_M_S2 1e-3

double books_gravity(int number)
{
	return -FIRST_M_S2 - STEP_M_S2 * number;
}

int books_number(double gravity)
{
	double number = (-gravity - FIRST_M_S2) / STEP_M_S2;
	return number > 0.5 && number < GRAVITIES_MOST ? (int)lround(number) : 0;
}

void books_line_leaves(session_book *book)
{
	book->leaving = true;
	book->floor = 0;
}

void books_line_arrives(session_book *book)
{
	if (!book->leaving)
		return;
	book->leaving = false;
	book->floor = 0;
	book->line_from = book->last_applied;
}

void books_acknowledge(session_book *book, int number)
{
	int place = book->applied[number];
	book->acknowledged[number] = true;
	if (!place)
		sim_fail("once", "gravity %d is acknowledged, and the core never got it", number);
	if (!book->leaving && place > book->line_from && place > book->floor)
		book->floor = place;
}

static const sim_request *request_of(int number)
{
	for (int i = 0; i < sim_request_count; i++)
		if (sim_requests[i].what == ASK_GRAVITY && sim_requests[i].gravity == number)
			return &sim_requests[i];
	return NULL;
}

static bool was_sent_again(int number)
{
	for (int i = 0; i < sim_request_count; i++)
		if (sim_requests[i].gravity == number && sim_requests[i].first)
			return true;
	return false;
}

void books_apply(session_book *book, int number)
{
	const sim_request *r = request_of(number);
	if (!r)
		return;
	if (book->acknowledged[number])
		sim_fail("once", "gravity %d acts again after it was acknowledged", number);
	if (book->applied[number] && !was_sent_again(number))
		sim_fail("once", "gravity %d acts again though it was sent once", number);
	bool ordered = !r->later && !was_sent_again(number);
	if (ordered && number < book->last_of_client[r->client])
		sim_fail("order", "client %d sent gravity %d before %d, and it acts behind it", r->client,
		         number, book->last_of_client[r->client]);
	book->applied[number] = ++book->last_applied;
	if (!r->later)
		book->last_of_client[r->client] = number;
}

void books_compare(session_book *book, int place, int number)
{
	if (!book->floor || book->leaving)
		return;
	int newest = number ? book->applied[number] : 0;
	if (newest < book->floor) {
		int lost = 0;
		while (lost < GRAVITIES_MOST && book->applied[lost] != book->floor)
			lost++;
		sim_fail("acknowledged",
		         "session %d has gravity %d after a restart; %d was acknowledged and is newer",
		         place, number, lost);
	}
}
