// SPDX-License-Identifier: GPL-3.0-or-later
// Tests signs of life by the sender's clock: delays, messages that arrive all at once, drift, and
// clocks that are set.
#include "hub/hub.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

#define DEADLINE_S 0.25
#define PERIOD_S 0.05
#define AHEAD_S 1e5 // client's clock minus the server's clock, s

// Returns the time of heartbeat `k` of a series that begins at `from_s`.
static double beat_s(double from_s, int k)
{
	return from_s + k * PERIOD_S;
}

// Sends `count` heartbeats from `from_s` on, one for each period of the server's clock. Each
// travels for `delay_s`. The client's clock runs `rate` times as fast as the server's. Returns the
// last result.
static double send(cau_sign_of_life *sign, double from_s, int count, double delay_s, double rate)
{
	double alive_s = 0;
	for (int k = 0; k < count; k++) {
		double sent_s = beat_s(from_s, k);
		alive_s =
			cau_sign_of_life_hear(sign, sent_s + delay_s, AHEAD_S + rate * sent_s, DEADLINE_S);
	}
	return alive_s;
}

// Sends heartbeats without delay, after the client's clock was set forward by `leap_s`.
static double send_after_leap(cau_sign_of_life *sign, double from_s, int count, double leap_s)
{
	double alive_s = 0;
	for (int k = 0; k < count; k++) {
		double sent_s = beat_s(from_s, k);
		alive_s = cau_sign_of_life_hear(sign, sent_s, AHEAD_S + leap_s + sent_s, DEADLINE_S);
	}
	return alive_s;
}

// Delivers `count` heartbeats, sent from `from_s` on, all at once at `arrival_s`.
static double pile_up(cau_sign_of_life *sign, double from_s, int count, double arrival_s,
                      double leap_s)
{
	double alive_s = 0;
	for (int k = 0; k < count; k++) {
		double client_s = AHEAD_S + leap_s + beat_s(from_s, k);
		alive_s = cau_sign_of_life_hear(sign, arrival_s, client_s, DEADLINE_S);
	}
	return alive_s;
}

static void a_late_message_tells_when_it_was_sent(void **state)
{
	(void)state;
	cau_sign_of_life sign = {0};
	assert_true(send(&sign, 10, 20, 0.02, 1) > 10.95);
	double alive_s = cau_sign_of_life_hear(&sign, 11.32, AHEAD_S + 11, DEADLINE_S);
	assert_float_equal(alive_s, 11.02, 1e-6);
	// A constant delay cannot be detected.
	alive_s = cau_sign_of_life_hear(&sign, 11.37, AHEAD_S + 11.35, DEADLINE_S);
	assert_float_equal(alive_s, 11.37, 1e-6);
}

static void what_piled_up_counts_as_of_its_sending(void **state)
{
	(void)state;
	const double stops_s[] = {0.7, 2.1, 6.3, 18.9, 56.7};
	for (size_t i = 0; i < sizeof stops_s / sizeof *stops_s; i++) {
		cau_sign_of_life sign = {0};
		send(&sign, 10, 200, 0.001, 1);
		double goes_on_s = 20 + stops_s[i];
		int count = (int)ceil((stops_s[i] - 0.6) / PERIOD_S - 1e-6);
		double alive_s = pile_up(&sign, 20, count, goes_on_s, 0);
		// the client was silent for longer than the deadline
		assert_true(alive_s < goes_on_s - 0.59);
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
	// rates of the client's clock, relative to the server's: ten times the drift of a bad crystal
	const double rates[] = {0.999, 1.001};
	for (int i = 0; i < 2; i++) {
		cau_sign_of_life sign = {0};
		double alive_s = send(&sign, 10, 72000, 0.001, rates[i]);
		assert_true(alive_s > 3610 - 2 * PERIOD_S);
	}
}

static void a_clock_set_back_is_silent_for_one_window(void **state)
{
	(void)state;
	cau_sign_of_life sign = {0};
	send(&sign, 1000, 200, 0.001, 1);
	int window = (int)(CAU_SIGN_WINDOW_S / PERIOD_S);
	double silent_s = send_after_leap(&sign, 1010.01, window - 1, -3600);
	assert_true(silent_s < 1010.01);
	double alive_s = send_after_leap(&sign, beat_s(1010.01, window), 20, -3600);
	assert_true(alive_s > 1015.9);
}

// If the client's machine sleeps together with its clock, the client was silent. Then its clock is
// measured again.
static void a_clock_that_stood_still_is_measured_again(void **state)
{
	(void)state;
	cau_sign_of_life sign = {0};
	send(&sign, 10, 200, 0.001, 1);
	assert_true(send_after_leap(&sign, 22, 160, -2) > 29.9);
}

static void a_clock_set_forward_is_measured_first(void **state)
{
	(void)state;
	cau_sign_of_life sign = {0};
	send(&sign, 10, 200, 0.001, 1);
	// Among messages of the time from 20 to 20.7 that arrive at once, the clock is set an hour
	// forward.
	pile_up(&sign, 20, 2, 20.7, 0);
	assert_true(pile_up(&sign, 20.1, 4, 20.7, 3600) < 20.1);
	assert_true(send_after_leap(&sign, 20.75, 25, 3600) > 21.9);
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
