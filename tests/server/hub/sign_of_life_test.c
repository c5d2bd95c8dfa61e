// SPDX-License-Identifier: GPL-3.0-or-later
// Signs of life by the sender's clock: delays, pile-ups, drift, and clocks that are set.
#include "hub/sign_of_life.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

#define DEADLINE_S 0.25
#define PERIOD_S 0.05
#define AHEAD_S 1e5 // the client's clock minus the server's

// Sends a heartbeat every period from `from_s` to `to_s`, the server's time, each on its way for
// `delay_s`. The client's clock runs `rate` times as fast as the server's. Returns the last answer.
static double send(cau_sign_of_life *sign, double from_s, double to_s, double delay_s, double rate)
{
	double alive_s = 0;
	for (double sent_s = from_s; sent_s < to_s; sent_s += PERIOD_S)
		alive_s =
			cau_sign_of_life_hear(sign, sent_s + delay_s, AHEAD_S + rate * sent_s, DEADLINE_S);
	return alive_s;
}

static void a_late_message_tells_when_it_was_sent(void **state)
{
	(void)state;
	cau_sign_of_life sign = {0};
	assert_true(send(&sign, 10, 11, 0.02, 1) > 10.95);
	double alive_s = cau_sign_of_life_hear(&sign, 11.32, AHEAD_S + 11, DEADLINE_S);
	assert_float_equal(alive_s, 11.02, 1e-6);
	// A steady delay is not seen as one.
	alive_s = cau_sign_of_life_hear(&sign, 11.37, AHEAD_S + 11.35, DEADLINE_S);
	assert_float_equal(alive_s, 11.37, 1e-6);
}

static void what_piled_up_counts_as_of_its_sending(void **state)
{
	(void)state;
	for (double stop_s = 0.7; stop_s < 100; stop_s *= 3) {
		cau_sign_of_life sign = {0};
		send(&sign, 10, 20, 0.001, 1);
		double alive_s = 0, goes_on_s = 20 + stop_s;
		for (double sent_s = 20; sent_s < goes_on_s - 0.6; sent_s += PERIOD_S)
			alive_s = cau_sign_of_life_hear(&sign, goes_on_s, AHEAD_S + sent_s, DEADLINE_S);
		assert_true(alive_s < goes_on_s - 0.59); // silent for longer than the deadline
	}
}

static void an_answer_never_goes_back_nor_ahead(void **state)
{
	(void)state;
	cau_sign_of_life sign = {0};
	double last_s = 0, arrival_s = 5;
	unsigned seed = 7;
	for (int i = 0; i < 100000; i++) {
		seed = seed * 1664525u + 1013904223u;
		arrival_s += (seed >> 20) % 8 * 0.02;
		double client_s = (seed >> 8) % 4096 * 0.1;
		double alive_s = cau_sign_of_life_hear(&sign, arrival_s, client_s, DEADLINE_S);
		assert_true(alive_s >= last_s && alive_s <= arrival_s);
		last_s = alive_s;
	}
}

static void drift_is_followed(void **state)
{
	(void)state;
	const double rates[] = {0.999, 1.001}; // ten times what a bad crystal does
	for (int i = 0; i < 2; i++) {
		cau_sign_of_life sign = {0};
		double alive_s = send(&sign, 10, 3610, 0.001, rates[i]);
		assert_true(alive_s > 3610 - 2 * PERIOD_S);
	}
}

static void a_clock_set_back_is_silent_for_one_window(void **state)
{
	(void)state;
	cau_sign_of_life sign = {0};
	send(&sign, 1000, 1010, 0.001, 1);
	double alive_s = 0;
	for (double sent_s = 1010; sent_s < 1010 + CAU_SIGN_WINDOW_S - PERIOD_S; sent_s += PERIOD_S) {
		alive_s = cau_sign_of_life_hear(&sign, sent_s, AHEAD_S + sent_s - 3600, DEADLINE_S);
		assert_true(alive_s < 1010.01);
	}
	for (double sent_s = 1010 + CAU_SIGN_WINDOW_S; sent_s < 1016; sent_s += PERIOD_S)
		alive_s = cau_sign_of_life_hear(&sign, sent_s, AHEAD_S + sent_s - 3600, DEADLINE_S);
	assert_true(alive_s > 1015.9);
}

// A client's machine that sleeps, with its clock, has been silent; then it is measured again.
static void a_clock_that_stood_still_is_measured_again(void **state)
{
	(void)state;
	cau_sign_of_life sign = {0};
	send(&sign, 10, 20, 0.001, 1);
	double alive_s = 0;
	for (double sent_s = 22; sent_s < 30; sent_s += PERIOD_S)
		alive_s = cau_sign_of_life_hear(&sign, sent_s, AHEAD_S + sent_s - 2, DEADLINE_S);
	assert_true(alive_s > 29.9);
}

static void a_clock_set_forward_is_measured_first(void **state)
{
	(void)state;
	cau_sign_of_life sign = {0};
	send(&sign, 10, 20, 0.001, 1);
	// In a pile of the time from 20 to 20.7 the clock is set an hour forward.
	double alive_s = 0;
	for (double sent_s = 20; sent_s < 20.1; sent_s += PERIOD_S)
		alive_s = cau_sign_of_life_hear(&sign, 20.7, AHEAD_S + sent_s, DEADLINE_S);
	for (double sent_s = 20.1; sent_s < 20.3; sent_s += PERIOD_S)
		alive_s = cau_sign_of_life_hear(&sign, 20.7, AHEAD_S + 3600 + sent_s, DEADLINE_S);
	assert_true(alive_s < 20.1);
	for (double sent_s = 20.75; sent_s < 22; sent_s += PERIOD_S)
		alive_s = cau_sign_of_life_hear(&sign, sent_s, AHEAD_S + 3600 + sent_s, DEADLINE_S);
	assert_true(alive_s > 21.9);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_late_message_tells_when_it_was_sent),
		cmocka_unit_test(what_piled_up_counts_as_of_its_sending),
		cmocka_unit_test(an_answer_never_goes_back_nor_ahead),
		cmocka_unit_test(drift_is_followed),
		cmocka_unit_test(a_clock_set_back_is_silent_for_one_window),
		cmocka_unit_test(a_clock_that_stood_still_is_measured_again),
		cmocka_unit_test(a_clock_set_forward_is_measured_first),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
