// SPDX-License-Identifier: GPL-3.0-or-later
// Random records with random delays must give the hand no energy and no jolt. The argument is the
// number of steps.
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "cautery/haptics.h"
#include "clients/haptics/hand.h"

static const double most_given_j = 1e-3, most_jump_n = 0.3;
static long step_count = 1000000;

static uint64_t seed = 35;

static double random_between(double least, double most) // SplitMix64
{
	uint64_t z = (seed += 0x9e3779b97f4a7c15u);
	z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
	z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
	return least + (most - least) * (double)((z ^ (z >> 31)) >> 11) / 9007199254740992.0;
}

static bool one_in(double n)
{
	return random_between(0, n) < 1;
}

static void random_unit(double out[3])
{
	double length = 0;
	while (length < 0.1 || length > 1) {
		length = 0;
		for (int i = 0; i < 3; i++) {
			out[i] = random_between(-1, 1);
			length += out[i] * out[i];
		}
		length = sqrt(length);
	}
	for (int i = 0; i < 3; i++)
		out[i] /= length;
}

// Returns a random record near a position: soft or hard, pushing or pulling, moving or wrong.
static cau_tool_contact random_record(const double place_m[3])
{
	cau_tool_contact record = {.valid = !one_in(50)};
	record.plane_count = (int32_t)random_between(0, CAU_CONTACT_PLANES + 0.999);
	double soft = pow(10, random_between(-4, -1)), lie = pow(10, random_between(-1, 1));
	for (int i = 0; i < 3; i++) {
		record.asked_pose.position_m[i] = place_m[i] + random_between(-0.01, 0.01);
		record.compliance_m_n[i] = soft * random_between(0.5, 2);
		record.compliance_m_n[3 + i] = soft * random_between(-0.2, 0.2);
		record.force_n[i] = random_between(-1, 1) * lie;
		record.grasp_anchor_m[i] = place_m[i] + random_between(-0.02, 0.02);
	}
	for (int i = 0; i < record.plane_count; i++) {
		cau_contact_plane *plane = &record.plane[i];
		random_unit(plane->normal);
		plane->velocity_m_s = random_between(-0.2, 0.2);
		for (int c = 0; c < 3; c++)
			plane->offset_m += plane->normal[c] * place_m[c];
		plane->offset_m += random_between(-0.01, 0.01);
	}
	record.friction = random_between(0, 1);
	record.damping_ns_m = one_in(2) ? random_between(0, 2) : 0;
	record.grasp_n_m = one_in(4) ? random_between(0, 1000) : 0;
	if (one_in(40))
		record.compliance_m_n[0] = one_in(2) ? -1 : NAN;
	return record;
}

// Returns the contact of a wall at z = 0 for a position, with the true force and a wrong
// compliance. A delayed loop with such records would be unstable.
static cau_tool_contact wall_record(const double place_m[3], double stiffness_n_m)
{
	double push_n = fmax(-place_m[2] * stiffness_n_m, 0);
	cau_tool_contact record = {.valid = true, .plane_count = 1, .friction = 0.2};
	record.plane[0].normal[2] = 1;
	record.force_n[2] = push_n;
	double wrong = random_between(0.3, 3); // factor on the true compliance
	for (int i = 0; i < 3; i++) {
		record.asked_pose.position_m[i] = place_m[i];
		record.compliance_m_n[i] = wrong / stiffness_n_m;
	}
	record.plane[0].offset_m = place_m[2] + push_n * wrong / stiffness_n_m;
	return record;
}

// Changes the wanted position: it stays, swings, leaps or shakes.
static void lead(simulated_hand *hand, double time_s, int manner)
{
	for (int i = 0; i < 3; i++)
		if (manner == 0 && one_in(700))
			hand->wanted_m[i] = random_between(-0.05, 0.05);
		else if (manner == 1)
			hand->wanted_m[i] = 0.02 * sin((2 + i) * 6.28 * time_s);
		else if (manner == 2)
			hand->wanted_m[i] = one_in(2) ? 0.01 : -0.01;
}

enum { LATE = 256, EPISODE = 5000 };

// Extremes of all runs, and the mean force `pushed_n`.
typedef struct findings {
	double most_j, most_jump_n, least_j, pushed_n;
} findings;

// Runs one renderer for five seconds, over a link with a constant delay.
static void run_episode(findings *found)
{
	cau_haptics_def def = cau_default_haptics_def();
	cau_haptics *haptics = NULL;
	cau_error error = {0};
	assert_int_equal(cau_haptics_create(&def, &haptics, &error), CAU_OK);
	simulated_hand hand = {.most_n = def.hand_n};
	double before[3] = {0}, past[LATE][3] = {{0}};
	int manner = (int)random_between(0, 4), late = (int)random_between(0, LATE), next = 0;
	bool honest = one_in(2);
	double stiffness_n_m = pow(10, random_between(1.5, 3.5));
	for (int step = 0; step < EPISODE; step++) {
		double time_s = 0.001 * step, force[3], jump = 0;
		memcpy(past[step % LATE], hand.place_m, sizeof hand.place_m);
		lead(&hand, time_s, manner);
		if (step >= next) {
			const double *then = past[(step + LATE - (step < late ? 0 : late)) % LATE];
			cau_tool_contact record =
				honest ? wall_record(then, stiffness_n_m) : random_record(then);
			cau_haptics_take(haptics, &record);
			next = step + (int)(one_in(30) ? random_between(20, 300) : random_between(10, 25));
		}
		cau_haptics_device device = {.pose.rotation[0] = 1};
		memcpy(device.pose.position_m, hand.place_m, sizeof hand.place_m);
		memcpy(device.velocity_m_s, hand.velocity_m_s, sizeof hand.velocity_m_s);
		cau_haptics_render(haptics, &device, time_s, force);
		for (int i = 0; i < 3; i++) {
			jump += (force[i] - before[i]) * (force[i] - before[i]);
			found->pushed_n += fabs(force[i]) / (double)step_count;
		}
		found->most_jump_n = fmax(found->most_jump_n, sqrt(jump));
		memcpy(before, force, sizeof before);
		hand_move(&hand, force);
		found->most_j = fmax(found->most_j, hand.given_j);
		found->least_j = fmin(found->least_j, hand.given_j);
	}
	cau_haptics_destroy(haptics);
}

static void hands_get_no_energy(void **state)
{
	(void)state;
	findings found = {0};
	for (long step = 0; step < step_count; step += EPISODE)
		run_episode(&found);
	print_message("%ld steps: at most %.3g mJ given, at most %.3g N in a millisecond, %.2g N on "
	              "average\n",
	              step_count, 1e3 * found.most_j, found.most_jump_n, found.pushed_n);
	assert_true(found.most_j <= most_given_j);
	assert_true(found.most_jump_n <= most_jump_n + 1e-9);
	// The renderer must push at all.
	assert_true(found.most_j > 0 && found.least_j < -0.01 && found.pushed_n > 0.1);
}

int main(int argc, char **argv)
{
	if (argc > 1)
		step_count = strtol(argv[1], NULL, 10);
	const struct CMUnitTest tests[] = {cmocka_unit_test(hands_get_no_energy)};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
