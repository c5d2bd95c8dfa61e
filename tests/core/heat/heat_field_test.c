// SPDX-License-Identifier: GPL-3.0-or-later
// Tests nested fields: values that a field takes from the next wider field, values that it gives
// back, and new values after a move. A field that is linear in space must stay unchanged.
#include "heat/heat_field.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "core/tool/tools.h"

enum { NODES = 12, COUNT = NODES * NODES * NODES };
// largest error, K: rounding of sums of eight floats near 100
static const double ROUNDING_C = 1e-4;

typedef struct pair { // a field, and the next wider field
	cau_heat_field field[2];
	float room[4][COUNT];
} pair;

static double linear(cau_vec3 p)
{
	return 100 + 1e3 * p.x - 2e3 * p.y + 5e2 * p.z;
}

static cau_vec3 place_of(const cau_heat_field *field, int i)
{
	double step = field->step_m;
	return (cau_vec3){(double)(field->origin[0] + i % NODES) * step,
	                  (double)(field->origin[1] + i / NODES % NODES) * step,
	                  (double)(field->origin[2] + i / (NODES * NODES)) * step};
}

static int is_outer(int i)
{
	int x = i % NODES, y = i / NODES % NODES, z = i / (NODES * NODES), last = NODES - 1;
	return x * y * z == 0 || x == last || y == last || z == last;
}

// Makes two linear fields. The outer nodes of the inner field have the value `boundary`.
static void make(pair *p, int64_t x, int64_t y, int64_t z, float boundary)
{
	for (int k = 0; k < 2; k++)
		p->field[k] =
			(cau_heat_field){1e-3 * (1 << k), {x, y, z}, p->room[2 * k], p->room[2 * k + 1]};
	cau_heat_field_origin_around(p->field[0].origin, NODES, p->field[1].origin);
	for (int k = 0; k < 2; k++)
		for (int i = 0; i < COUNT; i++)
			p->field[k].temperature[i] = p->field[k].next[i] =
				!k && is_outer(i) ? boundary : (float)linear(place_of(&p->field[k], i));
}

// Origins of the inner field: odd and even, above and below zero, so that all relative positions of
// the two fields occur.
static const int64_t ORIGIN[][3] = {{0, 0, 0}, {-7, 3, 12}, {5, -4, -9}, {-1000001, 6, -2}};
enum { ORIGINS = sizeof ORIGIN / sizeof *ORIGIN };

static void test_one_lies_in_the_middle_of_the_other(void **state)
{
	(void)state;
	for (int64_t at = -9; at < 9; at++) {
		const int64_t fine[3] = {at, at, at};
		int64_t around[3];
		cau_heat_field_origin_around(fine, NODES, around);
		double middle = (double)at + (NODES - 1) / 2.0;
		double middle_around = 2 * ((double)around[0] + (NODES - 1) / 2.0);
		assert_near(middle, middle_around, 1);
		assert_true(2 * around[0] <= at && at + NODES <= 2 * (around[0] + NODES - 1));
	}
}

static void test_boundary(void **state)
{
	(void)state;
	static pair p;
	for (int k = 0; k < ORIGINS; k++) {
		make(&p, ORIGIN[k][0], ORIGIN[k][1], ORIGIN[k][2], -1);
		cau_heat_field_take_boundary(&p.field[0], NODES, &p.field[1]);
		for (int i = 0; i < COUNT; i++) {
			double expected = linear(place_of(&p.field[0], i));
			double rounding = ROUNDING_C + 1e-7 * fabs(expected);
			assert_near((double)p.field[0].temperature[i], expected, rounding);
			assert_near((double)p.field[0].next[i], expected, rounding);
		}
	}
}

// Only the inner nodes are copied, to the bit.
static void test_inner_nodes_are_given(void **state)
{
	(void)state;
	static pair p;
	for (int k = 0; k < ORIGINS; k++) {
		make(&p, ORIGIN[k][0], ORIGIN[k][1], ORIGIN[k][2], 0);
		for (int i = 0; i < COUNT; i++)
			p.field[0].temperature[i] = is_outer(i) ? -1 : 1000 + (float)i;
		cau_heat_field_take_inner(&p.field[1], NODES, &p.field[0]);
		int taken = 0;
		for (int i = 0; i < COUNT; i++) {
			const int64_t *o = p.field[1].origin, *f = p.field[0].origin;
			int64_t x = 2 * (o[0] + i % NODES) - f[0], y = 2 * (o[1] + i / NODES % NODES) - f[1];
			int64_t z = 2 * (o[2] + i / (NODES * NODES)) - f[2], last = NODES - 2;
			if (x < 1 || y < 1 || z < 1 || x > last || y > last || z > last) {
				assert_true(p.field[1].temperature[i] == (float)linear(place_of(&p.field[1], i)));
				continue;
			}
			int64_t from = (z * NODES + y) * NODES + x;
			assert_true(p.field[1].temperature[i] == 1000 + (float)from);
			taken++;
		}
		// along each axis, every second one of ten inner nodes is taken
		assert_int_equal(taken, 5 * 5 * 5);
	}
}

static void test_what_comes_in(void **state)
{
	(void)state;
	static const int64_t shifts[][3] = {{1, 0, 0}, {-2, 3, 1}, {0, -5, 4}, {20, 0, 0}};
	static pair p;
	for (int k = 0; k < 4; k++) {
		make(&p, -3, 4, 7, 0);
		for (int i = 0; i < COUNT; i++)
			p.field[0].temperature[i] = (float)linear(place_of(&p.field[0], i));
		int64_t to[3], around[3];
		for (int axis = 0; axis < 3; axis++)
			to[axis] = p.field[0].origin[axis] + shifts[k][axis];
		cau_heat_field_origin_around(to, NODES, around);
		memcpy(p.field[1].origin, around, sizeof around);
		for (int i = 0; i < COUNT; i++)
			p.field[1].temperature[i] = (float)linear(place_of(&p.field[1], i));
		cau_heat_field_move(&p.field[0], NODES, to, &p.field[1]);
		assert_memory_equal(p.field[0].origin, to, sizeof to);
		for (int i = 0; i < COUNT; i++)
			assert_near((double)p.field[0].temperature[i], linear(place_of(&p.field[0], i)),
			            ROUNDING_C);
	}
}

// Without a wider field, new nodes have the value of the nearest node.
static void test_the_outermost_goes_on_as_it_ends(void **state)
{
	(void)state;
	static pair p;
	make(&p, 0, 0, 0, 50);
	cau_heat_field_move(&p.field[0], NODES, (const int64_t[3]){0, 0, 2}, NULL);
	for (int i = 0; i < 2 * NODES * NODES; i++)
		assert_true(p.field[0].temperature[COUNT - 1 - i] == 50);
	make(&p, 0, 0, 0, 50);
	cau_heat_field_move(&p.field[0], NODES, (const int64_t[3]){-3, 0, 0}, NULL);
	for (int i = 0; i < COUNT; i += NODES)
		for (int x = 0; x < 4; x++)
			assert_true(p.field[0].temperature[i + x] == 50);
}

// The open boundary is exact for a field that falls with the distance from the middle.
static void test_open_boundary(void **state)
{
	(void)state;
	static pair p;
	static float fall[NODES * NODES];
	make(&p, 0, 0, 0, -1);
	cau_heat_field_fall(NODES, fall);
	const double middle = (NODES - 1) / 2.0 * p.field[0].step_m;
	for (int turn = 0; turn < 2; turn++)
		for (int i = 0; i < COUNT; i++) {
			cau_vec3 at = cau_sub(place_of(&p.field[0], i), (cau_vec3){middle, middle, middle});
			double expected = 37 + 0.5 / cau_length(at);
			if (!turn)
				p.field[0].temperature[i] = is_outer(i) ? -1 : (float)expected;
			else
				assert_near((double)p.field[0].temperature[i], expected, ROUNDING_C);
			if (!turn && i == COUNT - 1)
				cau_heat_field_open_boundary(&p.field[0], NODES, 37, fall);
		}
}

static void test_reading(void **state)
{
	(void)state;
	static pair p;
	make(&p, -6, -5, -4, 0);
	cau_heat_cell cell;
	uint64_t random = 17;
	int found = 0;
	for (int i = 0; i < 1000; i++) {
		cau_vec3 at = random_point(&random, 0.012);
		const double along[3] = {at.x * 1e3 / 2, at.y * 1e3 / 2, at.z * 1e3 / 2};
		int in = 1;
		for (int axis = 0; axis < 3; axis++) {
			double nodes = along[axis] - (double)p.field[1].origin[axis];
			in &= nodes >= 0 && nodes <= NODES - 1;
		}
		assert_int_equal(cau_heat_field_find(&p.field[1], NODES, at, &cell), in);
		if (in)
			assert_near(cau_heat_cell_mean(&cell, &p.field[1], NODES), linear(at), ROUNDING_C);
		found += in;
	}
	assert_true(found > 100 && found < 900);
	assert_false(cau_heat_field_find(&p.field[1], NODES, (cau_vec3){0, NAN, 0}, &cell));
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_one_lies_in_the_middle_of_the_other),
		cmocka_unit_test(test_boundary),
		cmocka_unit_test(test_inner_nodes_are_given),
		cmocka_unit_test(test_what_comes_in),
		cmocka_unit_test(test_the_outermost_goes_on_as_it_ends),
		cmocka_unit_test(test_open_boundary),
		cmocka_unit_test(test_reading),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
