// SPDX-License-Identifier: GPL-3.0-or-later
#include "hub/sign_of_life.h"

#include <math.h>

#include "cautery/assert.h"

static void begin_window(cau_sign_of_life *sign, double arrival_s, double least_s)
{
	sign->window_from_s = arrival_s;
	sign->window_least_s = least_s;
}

static void begin(cau_sign_of_life *sign, double arrival_s, double difference_s)
{
	sign->clocked = true;
	sign->least_s = difference_s;
	sign->measured_s = sign->alive_s = arrival_s;
	begin_window(sign, arrival_s, difference_s);
}

// Notes a smaller difference: the clock was set forward, or the first message was delayed for long.
static void note_leap(cau_sign_of_life *sign, double arrival_s, double difference_s,
                      double deadline_s)
{
	if (sign->least_s - difference_s > deadline_s)
		sign->measured_s = arrival_s + deadline_s;
	sign->least_s = fmin(sign->least_s, difference_s);
}

static void let_grow_old(cau_sign_of_life *sign, double arrival_s, double client_s)
{
	double difference_s = arrival_s - client_s;
	bool set_back = client_s < sign->client_s;
	if (set_back || arrival_s - sign->arrival_s > CAU_SIGN_GAP_S)
		begin_window(sign, arrival_s, difference_s);
	sign->window_least_s = fmin(sign->window_least_s, difference_s);
	if (arrival_s - sign->window_from_s < CAU_SIGN_WINDOW_S)
		return;
	sign->least_s = sign->window_least_s;
	begin_window(sign, arrival_s, INFINITY);
}

double cau_sign_of_life_hear(cau_sign_of_life *sign, double arrival_s, double client_s,
                             double deadline_s)
{
	CAU_ASSERT(deadline_s >= 0, "a deadline of %g s", deadline_s);
	CAU_ASSERT(arrival_s >= sign->arrival_s, "arrived at %g s, after %g s", arrival_s,
	           sign->arrival_s);
	double difference_s = arrival_s - client_s;
	if (!sign->clocked)
		begin(sign, arrival_s, difference_s);
	note_leap(sign, arrival_s, difference_s, deadline_s);
	let_grow_old(sign, arrival_s, client_s);
	sign->arrival_s = arrival_s;
	sign->client_s = client_s;
	if (arrival_s >= sign->measured_s)
		sign->alive_s = fmax(sign->alive_s, fmin(arrival_s, client_s + sign->least_s));
	CAU_ASSERT(sign->alive_s <= arrival_s, "alive at %g s, which arrived at %g s", sign->alive_s,
	           arrival_s);
	return sign->alive_s;
}
