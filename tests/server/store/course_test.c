// SPDX-License-Identifier: GPL-3.0-or-later
// Tests which checkpoints thinning keeps over days, and which ticks can be reached if the log has
// holes.
#include "store_fixture.h"

#include <stdlib.h>

#include "store/retention.h"

enum { SPACING = 600 };

static void add(struct cau_store_course *course, int64_t tick)
{
	course->point[course->point_count++] = (struct cau_store_point){.tick = tick, .bytes = 1};
}

static void thin(struct cau_store_course *course)
{
	for (int gone; (gone = cau_store_course_thin(course, SPACING)) >= 0;) {
		course->point_count--;
		for (int i = gone; i < course->point_count; i++)
			course->point[i] = course->point[i + 1];
	}
}

// Checks the replay between any two neighbouring checkpoints. Its length is at most a quarter of
// the later checkpoint's age, or the distance at which checkpoints were made.
static void check_replays(const struct cau_store_course *course, int64_t cadence)
{
	const struct cau_store_point *point = course->point;
	int64_t now = point[course->point_count - 1].tick;
	for (int i = 0; i + 1 < course->point_count; i++) {
		int64_t age = now - point[i + 1].tick, span = point[i + 1].tick - point[i].tick;
		int64_t most = age / 4 > cadence ? age / 4 : cadence;
		assert_true(span <= (most > SPACING ? most : SPACING));
	}
}

// Makes checkpoints at a steady pace for 64 hours of 60 ticks a second, with thinning. Returns the
// largest number that existed.
static int live_through(int64_t cadence)
{
	static struct cau_store_point room[200];
	struct cau_store_course course = {.point = room};
	int most = 0;
	for (int64_t tick = 0; tick <= 64ll * 3600 * 60; tick += cadence) {
		add(&course, tick);
		thin(&course);
		assert_int_equal(room[0].tick, 0);
		if (course.point_count > most)
			most = course.point_count;
		if (tick % (cadence * 64) == 0)
			check_replays(&course, cadence);
	}
	return most;
}

// The bounds are from server/README.md, "Rewinding and history".
static void the_number_of_checkpoints_grows_with_the_logarithm_of_time(void **state)
{
	(void)state;
	int driven = live_through(600), untouched = live_through(153600), stepped = live_through(7);
	print_message("at most %d driven, %d untouched, %d stepped\n", driven, untouched, stepped);
	assert_in_range(driven, 20, 85);
	assert_in_range(untouched, 10, 40);
	assert_in_range(stepped, 20, 85);
}

static void marked_ones_and_ends_of_holes_stay(void **state)
{
	(void)state;
	static struct cau_store_point room[1000];
	struct cau_store_hole hole = {1000, 1010};
	struct cau_store_course course = {room, &hole, 0, 1};
	for (int64_t tick = 0; tick < 10000; tick += 10) {
		add(&course, tick);
		room[course.point_count - 1].marked = tick == 2000;
	}
	thin(&course);
	int kept = 0;
	for (int i = 0; i < course.point_count; i++)
		kept += room[i].tick == 1010 || room[i].tick == 2000;
	assert_int_equal(kept, 2);
	assert_in_range(course.point_count, 8, 40);
	for (int gone; (gone = cau_store_course_coarsen(&course, SPACING)) >= 0;) {
		course.point_count--;
		for (int i = gone; i < course.point_count; i++)
			room[i] = room[i + 1];
	}
	static const int64_t last[] = {0, 1010, 2000, 9980, 9990};
	assert_int_equal(course.point_count, 5);
	for (int i = 0; i < 5; i++)
		assert_int_equal(room[i].tick, last[i]);
}

static void holes_divide_what_can_be_reached(void **state)
{
	(void)state;
	struct cau_store_point point[] = {{.tick = 0},   {.tick = 100}, {.tick = 300},
	                                  {.tick = 400}, {.tick = 500}, {.tick = 600}};
	// The state at 300 can be reached only by its checkpoint: the log is missing before and after.
	struct cau_store_hole hole[] = {{150, 300}, {300, 400}, {450, 600}};
	struct cau_store_course course = {point, hole, 6, 3};
	static const int64_t expected[][2] = {
		{0, 150}, {300, 300}, {400, 450}, {500, 500}, {600, INT64_MAX}};
	struct cau_store_range range;
	int64_t after = -1;
	for (int i = 0; i < 5; i++, after = range.to_tick) {
		assert_true(cau_store_course_range(&course, after, &range));
		assert_int_equal(range.from_tick, expected[i][0]);
		assert_int_equal(range.to_tick, expected[i][1]);
	}
	course.point_count = 0;
	assert_false(cau_store_course_range(&course, -1, &range));
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(the_number_of_checkpoints_grows_with_the_logarithm_of_time),
		cmocka_unit_test(marked_ones_and_ends_of_holes_stay),
		cmocka_unit_test(holes_divide_what_can_be_reached),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
