// SPDX-License-Identifier: GPL-3.0-or-later
#include "transport_dds/checks.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>

#include <cmocka.h>

#define LIMIT_S 0.1
#define NOW_NS 1700000000000000000LL
#define MS 1000000LL
#define HOUR_NS (3600 * 1000 * MS)

static const cau_motion_past past = {.sequence = 7,
                                     .source_time_ns = NOW_NS - 10 * MS,
                                     .has_pose = true,
                                     .pose = {{0.1, 0.2, 0.3}, {1, 0, 0, 0}},
                                     .pose_s = 50};
static const cau_tool_def tool = {.max_speed_m_s = 0.5, .max_turn_rad_s = 12};

static void order(uint64_t sequence, int64_t source_time_ns, const char *path)
{
	cau_error error = {0};
	cau_status status = cau_motion_check_order(&past, sequence, source_time_ns, NOW_NS,
	                                           past.pose_s + 0.01, LIMIT_S, &error);
	assert_int_equal(status, path ? CAU_BAD_VALUE : CAU_OK);
	assert_string_equal(error.path, path ? path : "");
}

static void sequences_go_up(void **state)
{
	(void)state;
	order(8, NOW_NS, NULL);
	order(7, NOW_NS, "sequence_number");
	order(0, NOW_NS, "sequence_number");
	order(CAU_MOTION_SEQUENCE_MOST, NOW_NS, NULL);
	order(CAU_MOTION_SEQUENCE_MOST + 1, NOW_NS, "sequence_number");
	order(UINT64_MAX, NOW_NS, "sequence_number");
}

static void times_are_near_and_go_on(void **state)
{
	(void)state;
	order(8, past.source_time_ns, NULL);
	order(8, past.source_time_ns - 1, "source_time_ns");
	order(8, NOW_NS + 99 * MS, NULL);
	order(8, NOW_NS + 101 * MS, "source_time_ns");
	order(8, 0, "source_time_ns");
	order(8, INT64_MIN, "source_time_ns");
	order(8, INT64_MAX, "source_time_ns");
	cau_motion_past none = {0};
	cau_error error = {0};
	int64_t old = NOW_NS - 101 * MS;
	assert_int_equal(cau_motion_check_order(&none, 1, old, NOW_NS, 50, LIMIT_S, &error),
	                 CAU_BAD_VALUE);
}

// Both clocks and a sequence number that is made from the time are set back an hour. Samples are
// refused until the deadline has passed, not for the whole hour.
static void a_step_back_locks_out_for_a_deadline_only(void **state)
{
	(void)state;
	cau_error error = {0};
	const struct {
		uint64_t sequence;
		int64_t source_time_ns, now_ns;
		double after_s;
		cau_status status;
	} cases[] = {
		{8, NOW_NS - HOUR_NS, NOW_NS - HOUR_NS, 0.9 * LIMIT_S, CAU_BAD_VALUE},
		{8, NOW_NS - HOUR_NS, NOW_NS - HOUR_NS, 1.1 * LIMIT_S, CAU_OK},
		{1, NOW_NS, NOW_NS, 0.9 * LIMIT_S, CAU_BAD_VALUE},
		{1, NOW_NS, NOW_NS, 1.1 * LIMIT_S, CAU_OK},
		{0, NOW_NS, NOW_NS, 1.1 * LIMIT_S, CAU_BAD_VALUE},
		{UINT64_MAX, NOW_NS, NOW_NS, 1.1 * LIMIT_S, CAU_BAD_VALUE},
		// only one clock is set back: the sample is too old
		{8, NOW_NS - HOUR_NS, NOW_NS, 1.1 * LIMIT_S, CAU_BAD_VALUE},
	};
	for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++)
		assert_int_equal(cau_motion_check_order(&past, cases[i].sequence, cases[i].source_time_ns,
		                                        cases[i].now_ns, past.pose_s + cases[i].after_s,
		                                        LIMIT_S, &error),
		                 cases[i].status);
}

static void poses_are_finite_and_rotations_unit(void **state)
{
	(void)state;
	cau_error error = {0};
	const double bad[] = {NAN, INFINITY, -INFINITY};
	for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++)
		for (int part = 0; part < 7; part++) {
			cau_pose pose = {{0, 0, 0}, {1, 0, 0, 0}};
			*(part < 3 ? &pose.position_m[part] : &pose.rotation[part - 3]) = bad[i];
			assert_int_equal(cau_motion_check_pose(&pose, 0.5, &error), CAU_BAD_VALUE);
		}
	cau_pose off = {{0, 0, 0}, {1.002, 0, 0, 0}}, near = {{0, 0, 0}, {0, 1.0005, 0, 0}};
	assert_int_equal(cau_motion_check_pose(&off, 0.5, &error), CAU_BAD_VALUE);
	assert_int_equal(cau_motion_check_pose(&near, 0.5, &error), CAU_OK);
	assert_true(near.rotation[1] == 1);
}

// The range is the same as for tool.move on WebSocket.
static void each_coordinate_is_within_its_range(void **state)
{
	(void)state;
	cau_error error = {0};
	for (int c = 0; c < 3; c++)
		for (int sign = -1; sign <= 1; sign += 2) {
			cau_pose end = {{0, 0, 0}, {1, 0, 0, 0}}, beyond = end;
			end.position_m[c] = sign * CAU_PLACE_MOST_M;
			beyond.position_m[c] = nextafter(end.position_m[c], sign * HUGE_VAL);
			assert_int_equal(cau_motion_check_pose(&end, 0.5, &error), CAU_OK);
			assert_int_equal(cau_motion_check_pose(&beyond, 0.5, &error), CAU_BAD_VALUE);
			assert_string_equal(error.path, "position_m");
		}
}

static void jaws_are_within_their_range(void **state)
{
	(void)state;
	cau_error error = {0};
	cau_pose pose = {{0, 0, 0}, {1, 0, 0, 0}};
	assert_int_equal(cau_motion_check_pose(&pose, 0, &error), CAU_OK);
	assert_int_equal(cau_motion_check_pose(&pose, 1, &error), CAU_OK);
	const double bad[] = {nextafter(0, -1), nextafter(1, 2), NAN};
	for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
		assert_int_equal(cau_motion_check_pose(&pose, bad[i], &error), CAU_BAD_VALUE);
		assert_string_equal(error.path, "jaw");
	}
}

static cau_status leap(double distance_m, double turn_rad, double after_s)
{
	cau_error error = {0};
	cau_pose pose = past.pose;
	pose.position_m[2] += distance_m;
	pose.rotation[0] = cos(turn_rad / 2);
	pose.rotation[3] = sin(turn_rad / 2);
	return cau_motion_check_leap(&past, &pose, past.pose_s + after_s, &tool, &error);
}

static void leaps_are_refused(void **state)
{
	(void)state;
	double reach_m = tool.max_speed_m_s * (0.01 + CAU_MOTION_GRACE_S);
	assert_int_equal(leap(0.99 * reach_m, 0, 0.01), CAU_OK);
	assert_int_equal(leap(1.01 * reach_m, 0, 0.01), CAU_BAD_VALUE);
	assert_int_equal(leap(1.01 * reach_m, 0, 0.02), CAU_OK);
	double turn_rad = tool.max_turn_rad_s * (0.01 + CAU_MOTION_GRACE_S);
	assert_int_equal(leap(0, 0.99 * turn_rad, 0.01), CAU_OK);
	assert_int_equal(leap(0, 1.01 * turn_rad, 0.01), CAU_BAD_VALUE);
}

static void a_first_pose_is_anywhere_and_a_quaternion_has_two_signs(void **state)
{
	(void)state;
	cau_error error = {0};
	cau_motion_past none = {0};
	cau_pose away = {{5, 5, 5}, {0, 1, 0, 0}}, same = past.pose;
	same.rotation[0] = -1;
	assert_int_equal(cau_motion_check_leap(&none, &away, 0, &tool, &error), CAU_OK);
	assert_int_equal(cau_motion_check_leap(&past, &same, past.pose_s, &tool, &error), CAU_OK);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(sequences_go_up),
		cmocka_unit_test(times_are_near_and_go_on),
		cmocka_unit_test(a_step_back_locks_out_for_a_deadline_only),
		cmocka_unit_test(poses_are_finite_and_rotations_unit),
		cmocka_unit_test(each_coordinate_is_within_its_range),
		cmocka_unit_test(jaws_are_within_their_range),
		cmocka_unit_test(leaps_are_refused),
		cmocka_unit_test(a_first_pose_is_anywhere_and_a_quaternion_has_two_signs),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
