// SPDX-License-Identifier: GPL-3.0-or-later
#include "haptics/internal.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

static const energy_guard_def def = {.period_s = 0.001,
                                     .slew_n = 0.3,
                                     .mass_kg = 0.05,
                                     .hand_n = 5,
                                     .reserve_j = 5e-4,
                                     .tank_j = 0.05};

// The expected work is calculated by hand. The force of 1 N and the hand's 5 N accelerate 50 g with
// 120 m/s^2. The forces in four milliseconds are 1, 0.7, 0.4 and 0.1 N.
static void the_need_is_the_work_until_the_force_is_gone(void **state)
{
	(void)state;
	double by_hand = 1e-6 * 120 * (1 * 0.5 + 0.7 * 1.5 + 0.4 * 2.5 + 0.1 * 3.5);
	assert_true(fabs(energy_guard_need(&def, 1, 0) - by_hand) < 1e-12);
	by_hand += 1e-3 * 0.2 * (1 + 0.7 + 0.4 + 0.1);
	assert_true(fabs(energy_guard_need(&def, 1, 0.2) - by_hand) < 1e-12);
	assert_true(energy_guard_need(&def, 0, 1) == 0);
}

// The hand holds the device and then pushes it away with the hand's largest force. The test tries
// many durations of the hold and many wanted forces.
static void the_worst_push_gets_the_reserve_at_most(void **state)
{
	(void)state;
	for (int wait = 0; wait < 60; wait++)
		for (int doublings = 0; doublings < 6; doublings++) {
			double wanted = ldexp(0.1, doublings);
			energy_guard guard = {.def = def};
			double place[3] = {0}, velocity[3] = {0}, most = 0;
			for (int step = 0; step < 200; step++) {
				double force[3] = {wanted, 0, 0};
				energy_guard_account(&guard, place);
				most = fmax(most, guard.given_j);
				energy_guard_bound(&guard, velocity, force);
				// The hand first holds the device against the force, and then pushes it.
				double push = step < wait ? -force[0] : def.hand_n;
				double a = (force[0] + push) / def.mass_kg;
				place[0] += velocity[0] * def.period_s + a * def.period_s * def.period_s / 2;
				velocity[0] += a * def.period_s;
			}
			assert_true(most <= def.reserve_j * (1 + 1e-9));
			assert_true(most > 0);
		}
}

static void a_spring_that_is_pressed_pays_for_itself(void **state)
{
	(void)state;
	energy_guard guard = {.def = def};
	double place[3] = {0}, velocity[3] = {0}, least = 1;
	// a spring's force of up to 2 N while the device swings by 4 mm once a second
	for (int step = 0; step < 4000; step++) {
		double time_s = 0.001 * step;
		place[2] = -0.002 * (1 - cos(6.28318530718 * time_s));
		velocity[2] = -0.002 * 6.28318530718 * sin(6.28318530718 * time_s);
		double force[3] = {0, 0, -500 * place[2]};
		energy_guard_account(&guard, place);
		assert_false(energy_guard_bound(&guard, velocity, force));
		assert_true(fabs(force[2] + 500 * place[2]) < 1e-12);
		least = fmin(least, guard.tank_j);
	}
	assert_true(least > 0);
}

static void a_force_changes_by_its_bound_at_most(void **state)
{
	(void)state;
	energy_guard guard = {.def = def};
	double place[3] = {0}, velocity[3] = {0, 0, -0.1}, before = 0;
	for (int step = 0; step < 100; step++) {
		double force[3] = {0, 0, step % 20 < 10 ? 3 : -3};
		energy_guard_account(&guard, place);
		energy_guard_bound(&guard, velocity, force);
		assert_true(fabs(force[2] - before) <= def.slew_n + 1e-12);
		before = force[2];
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(the_need_is_the_work_until_the_force_is_gone),
		cmocka_unit_test(the_worst_push_gets_the_reserve_at_most),
		cmocka_unit_test(a_spring_that_is_pressed_pays_for_itself),
		cmocka_unit_test(a_force_changes_by_its_bound_at_most),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
