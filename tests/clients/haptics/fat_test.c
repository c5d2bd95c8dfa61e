// SPDX-License-Identifier: GPL-3.0-or-later
// A hand presses a ball into fat of 5 and 100 kPa, over links of 0, 20 and 50 ms each way.
#include "clients/haptics/loop.h"

static const double top_m = 0.003; // height at which the ball of 3 mm touches the slab
// Largest trembling of the force of a held contact, N peak to peak, and largest relative error of
// the force of a moved contact below 3 Hz.
static const double most_trembling_n = 0.05, most_error = 0.05;
// Largest energy that the hand may get, J, and largest change of the force in a millisecond, N.
static const double most_given_j = 1e-3, most_jump_n = 0.3;

// Lowers the ball in half a second and holds it there.
static void press(const loop_def *def, double time_s, double wanted_m[3])
{
	double share = fmin(time_s / 0.5, 1);
	wanted_m[0] = wanted_m[1] = 0;
	wanted_m[2] = top_m + 0.001 - share * (def->deep_m + 0.001);
}

// Lowers the ball and then moves it up and down below 3 Hz.
static void swing(const loop_def *def, double time_s, double wanted_m[3])
{
	press(def, time_s, wanted_m);
	double begun = fmin(time_s / 0.5, 1), turn = 6.283185307179586 * time_s;
	wanted_m[2] +=
		begun * def->swing_m * (sin(0.5 * turn) / 2 + sin(1.2 * turn) / 3 + sin(2.7 * turn) / 6);
}

// Applies a low-pass filter with 3 Hz: one pole, forwards and backwards, twice.
static void keep_slow(double (*signal)[3], int count, int axis)
{
	// frequency of each of the four poles; together they attenuate 3 Hz by 3 dB
	const double pole_hz = 3 * 2.3;
	const double turned = 6.283185307179586 * pole_hz * 0.001, share = turned / (1 + turned);
	for (int pass = 0; pass < 2; pass++) {
		for (int i = 1; i < count; i++)
			signal[i][axis] = signal[i - 1][axis] + share * (signal[i][axis] - signal[i - 1][axis]);
		for (int i = count - 2; i >= 0; i--)
			signal[i][axis] = signal[i + 1][axis] + share * (signal[i][axis] - signal[i + 1][axis]);
	}
}

// Returns the root mean square of a - b, relative to that of b.
static double difference(double (*a)[3], double (*b)[3], int from, int to)
{
	double sum = 0, size = 0;
	for (int i = from; i < to; i++)
		for (int c = 0; c < 3; c++) {
			sum += (a[i][c] - b[i][c]) * (a[i][c] - b[i][c]);
			size += b[i][c] * b[i][c];
		}
	return sqrt(sum / size);
}

static void is_safe(const loop_log *log)
{
	assert_true(log->most_given_j <= most_given_j);
	assert_true(log->most_jump_n <= most_jump_n + 1e-9);
}

// Holds the ball 4 mm deep in soft fat. In hard fat the hand wants a depth of 12 mm and presses
// with 0.9 N.
static void hold(double young_modulus_pa, double delay_s)
{
	loop_def def = {.young_modulus_pa = young_modulus_pa,
	                .delay_s = delay_s,
	                .seconds = CAU_TEST_SANITIZED ? 1 : 4,
	                .lead = press,
	                .deep_m = young_modulus_pa > 1e4 ? 0.012 : 0.004};
	loop_log log = loop_run(&def);
	double least = INFINITY, most = -INFINITY;
	for (int i = log.count - 1000; i < log.count; i++) {
		least = fmin(least, log.force_n[i][2]);
		most = fmax(most, log.force_n[i][2]);
	}
	print_message("held in %g kPa over %g ms: %.3f N, %.4f N peak to peak; a tick takes %.1f ms\n",
	              young_modulus_pa / 1e3, 1e3 * delay_s, most, most - least, 1e3 * log.tick_s);
	is_safe(&log);
	if (!CAU_TEST_SANITIZED) {
		assert_true(most - least < most_trembling_n);
		assert_true(most > 0.08); // the hand must press at all
	}
	loop_finish(&log);
}

static void held_contact_comes_to_rest(void **state)
{
	(void)state;
	for (int delay_ms = 0; delay_ms <= 50; delay_ms += delay_ms ? 30 : 20) {
		hold(5e3, 1e-3 * delay_ms);
		hold(1e5, 1e-3 * delay_ms);
	}
}

static void move(double young_modulus_pa, double delay_s)
{
	bool hard = young_modulus_pa > 1e4;
	loop_def def = {.young_modulus_pa = young_modulus_pa,
	                .delay_s = delay_s,
	                .seconds = 4,
	                .lead = swing,
	                .deep_m = hard ? 0.009 : 0.003,
	                .swing_m = hard ? 0.004 : 0.0015};
	loop_log log = loop_run(&def);
	double(*fine)[3] = loop_reference(&def, &log, 0.001);
	for (int axis = 0; axis < 3; axis++) {
		keep_slow(fine, log.count, axis);
		keep_slow(log.force_n, log.count, axis);
	}
	double error = difference(log.force_n, fine, 1000, 3500);
	print_message("moved in %g kPa over %g ms: %.1f %% off\n", young_modulus_pa / 1e3,
	              1e3 * delay_s, 100 * error);
	is_safe(&log);
	assert_true(error < most_error);
	free(fine);
	loop_finish(&log);
}

// Compares the rendered force with the force of the scene in steps of a millisecond. The first
// second is left out, because the ball comes down in it. The end is left out, because the filter
// distorts it.
static void force_is_that_of_the_scene_in_milliseconds(void **state)
{
	(void)state;
	for (int delay_ms = 0; delay_ms <= 50 && !CAU_TEST_SANITIZED; delay_ms += delay_ms ? 30 : 20) {
		move(5e3, 1e-3 * delay_ms);
		move(1e5, 1e-3 * delay_ms);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(held_contact_comes_to_rest),
		cmocka_unit_test(force_is_that_of_the_scene_in_milliseconds),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
