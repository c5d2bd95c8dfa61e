// SPDX-License-Identifier: GPL-3.0-or-later
#include "cautery/haptics.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include <cmocka.h>

static const double tick_s = 1.0 / 60, period_s = 0.001;

static cau_haptics *make(void)
{
	cau_haptics_def def = cau_default_haptics_def();
	cau_haptics *haptics = NULL;
	cau_error error = {0};
	assert_int_equal(cau_haptics_create(&def, &haptics, &error), CAU_OK);
	return haptics;
}

// Returns the contact record of tissue of 500 N/m below z = 0, with the tool at z.
static cau_tool_contact floor_at(double z)
{
	cau_tool_contact record = {.valid = true,
	                           .asked_pose = {.position_m = {0, 0, z}, .rotation = {1, 0, 0, 0}},
	                           .force_n = {0, 0, fmax(-500 * z, 0)},
	                           .plane_count = 1,
	                           .plane = {{.normal = {0, 0, 1}}},
	                           .compliance_m_n = {0.002, 0.002, 0.002}};
	return record;
}

// Returns the contact record of tissue under a round tip, by Hertz's law: 1.5 N at 3 mm.
static cau_tool_contact hertz_at(double z)
{
	cau_tool_contact record = floor_at(fmin(z, 0));
	double deep = fmax(-z, 0), stiffness = fmax(1.5 * 1.5 * sqrt(deep / 0.003) / 0.003, 10);
	record.asked_pose.position_m[2] = z;
	record.force_n[2] = 1.5 * pow(deep / 0.003, 1.5);
	for (int i = 0; i < 3; i++)
		record.compliance_m_n[i] = 1 / stiffness;
	record.plane[0].offset_m = deep > 0 ? z + record.force_n[2] / stiffness : 0;
	return record;
}

static double render_at(cau_haptics *haptics, double z, double velocity, double now_s)
{
	double force[3];
	cau_haptics_device device = {.pose = {.position_m = {0, 0, z}, .rotation = {1, 0, 0, 0}},
	                             .velocity_m_s = {0, 0, velocity}};
	cau_haptics_render(haptics, &device, now_s, force);
	return force[2];
}

static void without_a_record_there_is_no_force(void **state)
{
	(void)state;
	cau_haptics *haptics = make();
	for (int k = 0; k < 50; k++)
		assert_true(render_at(haptics, -0.01, 0, period_s * k) == 0);
	cau_haptics_report report;
	cau_haptics_describe(haptics, &report);
	assert_true(report.fading && !report.touching && !report.limited);
	cau_haptics_destroy(haptics);
	cau_haptics_destroy(NULL);
}

// Presses and releases tissue slowly. Each record is 0.1 s old when it arrives, but the force must
// be that of the present position.
static void force_follows_the_place_not_the_record(void **state)
{
	(void)state;
	cau_haptics *haptics = make();
	double next = 0, worst = 0;
	for (int k = 0; k < 4000; k++) {
		double now = period_s * k, turn = 6.28318530718 * 0.5;
		double z = -0.0003 - 0.0014 * (1 - cos(turn * now)), v = -0.0014 * turn * sin(turn * now);
		if (now >= next) {
			double then = fmax(now - 0.1, 0);
			cau_tool_contact record = hertz_at(-0.0003 - 0.0014 * (1 - cos(turn * then)));
			cau_haptics_take(haptics, &record);
			next += tick_s;
		}
		double force = render_at(haptics, z, v, now);
		if (k > 100)
			worst = fmax(worst, fabs(force - 1.5 * pow(-z / 0.003, 1.5)));
	}
	print_message("at most %.4f N off at 1.5 N\n", worst);
	assert_true(worst < 0.03); // the motion is slow, below damping_hz, so it is hardly damped
	cau_haptics_destroy(haptics);
}

static void a_new_record_is_blended_in(void **state)
{
	(void)state;
	cau_haptics *haptics = make();
	cau_tool_contact soft = floor_at(-0.001), hard = floor_at(-0.001);
	// The force is larger at the same stiffness, so the surface of the tissue is higher.
	hard.force_n[2] = 0.6;
	hard.plane[0].offset_m = 0.0002;
	double before = 0, force = 0;
	for (int k = 0; k < 40; k++) {
		if (k % 20 == 0) // a record is blended in completely before the next record comes
			cau_haptics_take(haptics, &soft);
		before = render_at(haptics, -0.001, 0, period_s * k);
	}
	assert_true(fabs(before - 0.5) < 1e-9);
	cau_haptics_take(haptics, &hard);
	for (int k = 40; k < 60; k++) {
		force = render_at(haptics, -0.001, 0, period_s * k);
		assert_true(force - before <= 0.1 * period_s / tick_s + 1e-9);
		before = force;
	}
	assert_true(fabs(force - 0.6) < 1e-9);
	cau_haptics_destroy(haptics);
}

static void silence_takes_the_force_away_in_time(void **state)
{
	(void)state;
	cau_haptics *haptics = make();
	cau_tool_contact record = floor_at(-0.002);
	double force = 0, before = 0, silent_s = 0;
	for (int k = 0; k < 300; k++) {
		double now = period_s * k;
		if (k < 100 && k % 20 == 0) {
			cau_haptics_take(haptics, &record);
			silent_s = now;
		}
		force = render_at(haptics, -0.002, 0, now);
		assert_true(fabs(force - before) <= 0.3 + 1e-9);
		if (k == 99)
			assert_true(fabs(force - 1) < 1e-9);
		if (now >= silent_s + CAU_HAPTICS_SILENCE_S)
			assert_true(force == 0);
		before = force;
	}
	cau_haptics_destroy(haptics);
}

static void bad_states_of_the_device_let_it_fade(void **state)
{
	(void)state;
	cau_haptics *haptics = make();
	cau_tool_contact record = floor_at(-0.002);
	double force = 0;
	for (int k = 0; k < 50; k++) {
		if (k % 20 == 0)
			cau_haptics_take(haptics, &record);
		force = render_at(haptics, -0.002, 0, period_s * k);
	}
	assert_true(fabs(force - 1) < 1e-9);
	force = render_at(haptics, NAN, 0, 0.050);
	assert_true(fabs(force - 0.7) < 1e-9);
	force = render_at(haptics, -0.002, INFINITY, 0.051);
	force = render_at(haptics, -0.002, 0, 0.001); // the clock runs backwards
	force = render_at(haptics, -0.002, 0, NAN);
	assert_true(force == 0);
	for (int k = 52; k < 80; k++)
		force = render_at(haptics, -0.002, 0, period_s * k);
	assert_true(fabs(force - 1) < 1e-9);
	cau_haptics_destroy(haptics);
}

static void definitions_are_checked(void **state)
{
	(void)state;
	cau_haptics *haptics = NULL;
	cau_error error = {0};
	cau_haptics_def def = cau_default_haptics_def();
	def.period_s = 0;
	assert_int_equal(cau_haptics_create(&def, &haptics, &error), CAU_BAD_VALUE);
	assert_string_equal(error.path, "period_s");
	def = cau_default_haptics_def();
	def.mass_kg = NAN;
	assert_int_equal(cau_haptics_create(&def, &haptics, &error), CAU_BAD_VALUE);
	def = cau_default_haptics_def();
	// If the fade began so late, a force of `force_max_n` = 5 N could not be 0 in time.
	def.fade_s = 0.09;
	assert_int_equal(cau_haptics_create(&def, &haptics, &error), CAU_BAD_VALUE);
	assert_string_equal(error.path, "fade_s");
	assert_null(haptics);
}

static double now_us(void)
{
	struct timespec t;
	clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
	return 1e6 * (double)t.tv_sec + 1e-3 * (double)t.tv_nsec;
}

static int compare(const void *a, const void *b)
{
	double x = *(const double *)a, y = *(const double *)b;
	return (x > y) - (x < y);
}

enum { CALLS = 20000, RUNS = 7 };

// Times each call of a run. us[] keeps the smallest time of each call over all runs.
static void time_calls(const cau_tool_contact *record, double us[CALLS])
{
	cau_haptics *haptics = make();
	for (int k = 0; k < CALLS; k++) {
		double now = period_s * k;
		if (k % 16 == 0)
			cau_haptics_take(haptics, record);
		double start = now_us();
		render_at(haptics, -0.002 + 0.002 * sin(40 * now), 0.08 * cos(40 * now), now);
		us[k] = fmin(us[k], now_us() - start);
	}
	cau_haptics_destroy(haptics);
}

// The record has all planes, comes every tick, and its force is limited by energy. The same calls
// are made in seven runs, and the smallest time of each call counts, so other programs on the
// machine do not matter.
static void a_render_takes_a_few_microseconds(void **state)
{
	(void)state;
	const double most_us = 20;
	double *us = malloc(CALLS * sizeof *us);
	cau_tool_contact record = floor_at(-0.002);
	record.plane_count = CAU_CONTACT_PLANES;
	record.friction = 0.2;
	for (int i = 0; i < CAU_CONTACT_PLANES; i++) {
		double turn = 6.28318530718 * i / CAU_CONTACT_PLANES;
		record.plane[i] = (cau_contact_plane){.normal = {0.6 * cos(turn), 0.6 * sin(turn), 0.8}};
	}
	assert_non_null(us);
	for (int k = 0; k < CALLS; k++)
		us[k] = INFINITY;
	for (int run = 0; run < RUNS; run++)
		time_calls(&record, us);
	qsort(us, CALLS, sizeof *us, compare);
	print_message("a render takes %.2f us, p99.9 %.2f us, at most %.2f us\n", us[CALLS / 2],
	              us[CALLS / 1000 * 999], us[CALLS - 1]);
	assert_true(us[CALLS / 1000 * 999] < (CAU_TEST_SANITIZED ? 50 * most_us : most_us));
	free(us);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(without_a_record_there_is_no_force),
		cmocka_unit_test(force_follows_the_place_not_the_record),
		cmocka_unit_test(a_new_record_is_blended_in),
		cmocka_unit_test(silence_takes_the_force_away_in_time),
		cmocka_unit_test(bad_states_of_the_device_let_it_fade),
		cmocka_unit_test(definitions_are_checked),
		cmocka_unit_test(a_render_takes_a_few_microseconds),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
