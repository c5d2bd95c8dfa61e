// SPDX-License-Identifier: GPL-3.0-or-later
// Tests energy and gradient of touching sheets. The gradient agrees with finite differences. Sheets
// beyond the thickness have no energy. Pairs found in advance change nothing. A slide has friction.
#include "core/collide/sheets.h"

#include <stdlib.h>

static const double STEP_M = 1e-9; // displacement for the finite differences, m
// Largest relative error of the gradient. The gradient has a kink where two nearest points are
// equally near.
static const double DIFFERENCE = 1e-4;
static const double ROUNDING = 1e-12;

static void gradient_is_the_energys(void **state)
{
	(void)state;
	sheets s;
	sheets_begin(&s, 4e-3, 0.3, 2.5e-3);
	cau_collide *collide = &s.collide;
	sheets_shake(&s, 5e-4);
	int32_t n = s.r.tissue.vertex_count;
	cau_collide_begin(collide, s.pool, s.x);
	assert_true(collide->result.touching_count > 100 &&
	            collide->grip_count == collide->result.touching_count);
	double *x = malloc(3 * (size_t)n * sizeof *x), *gradient = malloc(3 * (size_t)n * sizeof *x);
	memcpy(x, s.x, 3 * (size_t)n * sizeof *x);
	for (int32_t i = 0; i < 3 * n; i++) // some pairs slide, some stick, some come nearer
		x[i] += 1e-4 * sheets_draw(&s);
	cau_collide_evaluate(collide, s.pool, x);
	memcpy(gradient, collide->load.gradient, 3 * (size_t)n * sizeof *x);
	double most = 0, total[3] = {0};
	for (int32_t i = 0; i < 3 * n; i++) {
		most = fmax(most, fabs(gradient[i]));
		total[i % 3] += gradient[i];
	}
	int off = 0;
	for (int32_t i = 0; i < 3 * n; i++) {
		double at = x[i];
		x[i] = at + STEP_M;
		double up = cau_collide_evaluate(collide, s.pool, x);
		x[i] = at - STEP_M;
		double down = cau_collide_evaluate(collide, s.pool, x);
		x[i] = at;
		off += fabs((up - down) / (2 * STEP_M) - gradient[i]) > DIFFERENCE * most;
	}
	assert_int_equal(off, 0);
	for (int c = 0; c < 3; c++) // action equals reaction
		assert_true(fabs(total[c]) < 1e-9 * most);
	free(x);
	free(gradient);
	rig_finish(&s.r);
}

static void apart_is_nothing(void **state)
{
	(void)state;
	sheets s;
	sheets_begin(&s, 1e-3, 0.3, 1.01e-3);
	cau_collide_begin(&s.collide, s.pool, s.x);
	assert_true(s.collide.start_energy_j == 0 && s.collide.load.count == 0);
	assert_true(s.collide.pair_count > 0);
	rig_finish(&s.r);
}

// Pairs that are found only for a longer step change no bit of the result.
static void foresight_changes_nothing(void **state)
{
	(void)state;
	sheets s;
	sheets_begin(&s, 3e-3, 0, 2e-3);
	sheets_shake(&s, 5e-4);
	cau_collide_begin(&s.collide, s.pool, s.x);
	double energy = s.collide.start_energy_j;
	int32_t pairs = s.collide.pair_count;
	for (int32_t i = 0; i < 3 * s.r.tissue.vertex_count; i++)
		s.collide.step[i] = 5e-4 * sheets_draw(&s);
	s.collide.range.found = false;
	cau_collide_find(&s.collide, s.pool, s.x, CAU_COLLIDE_STEP);
	assert_true(cau_collide_evaluate(&s.collide, s.pool, s.x) == energy && energy > 0);
	assert_true(pairs > 0);
	rig_finish(&s.r);
}

static void expect_as_found_anew(sheets *s)
{
	int32_t n = s->r.tissue.vertex_count;
	cau_collide *collide = &s->collide;
	double energy = cau_collide_evaluate(collide, s->pool, s->x);
	uint64_t touching = collide->result.touching_hash;
	double *gradient = malloc(3 * (size_t)n * sizeof *gradient);
	memcpy(gradient, collide->load.gradient, 3 * (size_t)n * sizeof *gradient);
	collide->range.found = false;
	assert_true(cau_collide_evaluate(collide, s->pool, s->x) == energy);
	assert_true(collide->result.touching_hash == touching);
	assert_memory_equal(gradient, collide->load.gradient, 3 * (size_t)n * sizeof *gradient);
	free(gradient);
}

// Pairs are kept over many ticks and updated where tissue moved, was cut or died. They give the
// same bits as a new search: the same forces, and the same steps that are held back.
static void what_is_kept_changes_nothing(void **state)
{
	(void)state;
	enum { TICKS = 60, ANEW = 8, MOVING = 12, CUT = 10 };
	sheets s;
	sheets_begin(&s, 1e-3, 0, 0.9e-3);
	int32_t n = s.r.tissue.vertex_count, faces = s.r.tissue.faces.face_count, touched = 0;
	cau_collide *collide = &s.collide;
	double *held = malloc(3 * (size_t)n * sizeof *held), *wanted = malloc(3 * (size_t)n * 8);
	for (int tick = 0; tick < TICKS; tick++) {
		if (tick % CUT == 0) // some faces appear, some disappear
			s.mask[(tick * 7 % faces) >> 5] ^= 1u << (tick * 7 % faces & 31);
		cau_surface_list(&collide->surface, s.mask);
		for (int32_t i = 0; i < 3 * n; i++) // most vertices do not move
			collide->step[i] =
				(i / 3 + tick) % n < MOVING ? (i % 3 ? 5e-4 * sheets_draw(&s) : 8e-4) : 0;
		memcpy(wanted, collide->step, 3 * (size_t)n * sizeof *wanted);
		cau_collide_begin(collide, s.pool, s.x);
		cau_collide_filter(collide, s.pool, s.x, false);
		if (tick % ANEW == 0) {
			memcpy(held, collide->step, 3 * (size_t)n * sizeof *held);
			memcpy(collide->step, wanted, 3 * (size_t)n * sizeof *held);
			collide->range.found = false;
			cau_collide_filter(collide, s.pool, s.x, false);
			assert_memory_equal(held, collide->step, 3 * (size_t)n * sizeof *held);
		}
		for (int32_t i = 0; i < 3 * n; i++)
			s.x[i] += collide->step[i];
		if (tick % ANEW == ANEW / 2)
			expect_as_found_anew(&s);
		touched += collide->result.touching_count;
	}
	assert_true(touched > 100);
	free(held);
	free(wanted);
	rig_finish(&s.r);
}

// The stiffness that cau_collide_apply uses equals the change of the gradient, if no force is
// large.
static void stiffness_is_the_gradients_change(void **state)
{
	(void)state;
	sheets s;
	sheets_begin(&s, 3e-3, 0, 2.9e-3);
	cau_collide *collide = &s.collide;
	int32_t upper = s.r.tissue.layer[1].first_vertex, n = s.r.tissue.vertex_count;
	cau_collide_begin(collide, s.pool, s.x);
	double before = 0, after = 0, told = 0;
	for (int32_t v = upper; v < n; v++) {
		before += collide->load.gradient[3 * (size_t)v + 2];
		collide->load.probe[3 * (size_t)v + 2] = 1e-6;
	}
	cau_collide_apply(collide);
	for (int32_t v = upper; v < n; v++) {
		told += collide->load.answer[3 * (size_t)v + 2];
		s.x[3 * (size_t)v + 2] += 1e-6;
	}
	cau_collide_evaluate(collide, s.pool, s.x);
	for (int32_t v = upper; v < n; v++)
		after += collide->load.gradient[3 * (size_t)v + 2];
	assert_true(told > 0 && fabs(after - before - told) < 1e-3 * told);
	rig_finish(&s.r);
}

// Friction resists a slide by the friction coefficient times the pressing force, and by no more.
static void a_slide_rubs(void **state)
{
	(void)state;
	const double friction = 0.25;
	sheets s;
	sheets_begin(&s, 3e-3, friction, 2e-3);
	cau_collide *collide = &s.collide;
	int32_t upper = s.r.tissue.layer[1].first_vertex, n = s.r.tissue.vertex_count;
	cau_collide_begin(collide, s.pool, s.x);
	double pressed = 0, *x = malloc(3 * (size_t)n * sizeof *x);
	for (int32_t k = 0; k < collide->grip_count; k++)
		pressed += collide->grip[k].most_n;
	memcpy(x, s.x, 3 * (size_t)n * sizeof *x);
	double energy[2];
	// The slide is far beyond sticking; the pairs keep their distances.
	for (int k = 0; k < 2; k++) {
		for (int32_t v = upper; v < n; v++)
			x[3 * (size_t)v] = s.x[3 * (size_t)v] + 2e-3 * (k + 1);
		energy[k] = cau_collide_evaluate(collide, s.pool, x) - collide->result.energy_j;
	}
	double force = (energy[1] - energy[0]) / 2e-3;
	assert_true(pressed > 0 && force > 0 && force <= pressed * (1 + ROUNDING));
	free(x);
	rig_finish(&s.r);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(gradient_is_the_energys),
		cmocka_unit_test(apart_is_nothing),
		cmocka_unit_test(foresight_changes_nothing),
		cmocka_unit_test(a_slide_rubs),
		cmocka_unit_test(what_is_kept_changes_nothing),
		cmocka_unit_test(stiffness_is_the_gradients_change),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
