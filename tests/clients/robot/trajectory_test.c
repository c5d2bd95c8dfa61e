// SPDX-License-Identifier: GPL-3.0-or-later
#include "robot/robot.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

static const double rounding = 1e-12; // largest error of some operations on numbers near 1

static bool read_text(robot_trajectory *trajectory, const char *text)
{
	char name[] = "/tmp/cautery-trajectory-XXXXXX";
	int file = mkstemp(name);
	assert_true(file >= 0);
	assert_int_equal(write(file, text, strlen(text)), strlen(text));
	close(file);
	FILE *errors = tmpfile();
	bool good = robot_trajectory_read(trajectory, name, errors);
	assert_true(good || ftell(errors) > 0);
	fclose(errors);
	unlink(name);
	return good;
}

static void a_line_dwells_and_goes(void **state)
{
	(void)state;
	robot_trajectory line;
	assert_true(robot_trajectory_line(&line, (double[]){0, 0, 1}, (double[]){0.3, 0.4, 1}, 2, 0.1));
	assert_true(fabs(robot_trajectory_seconds(&line) - 7) < rounding);
	assert_true(robot_trajectory_at(&line, 1.9).position_m[0] == 0);
	assert_true(fabs(robot_trajectory_at(&line, 4.5).position_m[1] - 0.2) < rounding);
	assert_true(robot_trajectory_at(&line, 99).position_m[0] == 0.3);
	robot_trajectory_finish(&line);
}

static void files_are_joined_by_straight_lines(void **state)
{
	(void)state;
	robot_trajectory t;
	assert_true(read_text(&t, "# a comment\n0 1 2 3\n1 2 2 3\n\n3 2 4 3 0 0 0 2\n"));
	assert_int_equal(t.count, 3);
	assert_true(fabs(robot_trajectory_at(&t, 0.5).position_m[0] - 1.5) < rounding);
	assert_true(fabs(robot_trajectory_at(&t, 2).position_m[1] - 3) < rounding);
	robot_pose last = robot_trajectory_at(&t, 3);
	assert_true(last.rotation[3] == 1);
	robot_trajectory_finish(&t);
}

static void rotations_take_the_shorter_way(void **state)
{
	(void)state;
	robot_pose a = {.rotation = {1, 0, 0, 0}}, b = {.rotation = {-cos(0.2), 0, 0, -sin(0.2)}};
	robot_pose half = robot_pose_between(&a, &b, 0.5);
	assert_true(fabs(half.rotation[0] - cos(0.1)) < rounding);
	assert_true(fabs(half.rotation[3] - sin(0.1)) < rounding);
}

static void what_is_no_trajectory_is_refused(void **state)
{
	(void)state;
	robot_trajectory t;
	const char *const bad[] = {
		"",           "# nothing\n",       "0 1 2\n",    "0 1 2 nan\n", "1 0 0 0\n0 0 0 0\n",
		"-1 0 0 0\n", "0 0 0 0 0 0 0 0\n", "0 0 0 0 1\n"};
	for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++)
		assert_false(read_text(&t, bad[i]));
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_line_dwells_and_goes),
		cmocka_unit_test(files_are_joined_by_straight_lines),
		cmocka_unit_test(rotations_take_the_shorter_way),
		cmocka_unit_test(what_is_no_trajectory_is_refused),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
