// SPDX-License-Identifier: GPL-3.0-or-later
// Tests properties of every law. The gradient is the derivative of the energy. An element has no
// net force or torque, and no force at rest or once it is removed. Precisions and instruction sets
// agree.
#include <string.h>

#include "core/rig/law_scenes.h"

// Step h, m, of central differences, and their largest relative error. Truncation is h^2 relative,
// and rounding is 1e-16 E / (h |g|). Both are about 1e-9 for these meshes at h = 1e-5 of their
// thickness.
static const double DIFFERENCE_STEP_M = 1e-7;
static const double DIFFERENCE_TOLERANCE = 1e-6;
// Largest sum of an element's forces (BALANCE) and moments (TORQUE), relative to the sums of the
// absolute values. A sum of a few products has about twenty roundings of the largest term, which
// may be ten times the result.
static const double BALANCE_DOUBLE = 1e-13;
static const double TORQUE_DOUBLE = 1e-11;
// Largest relative difference between float and double. D_m^-1, u and the material are each rounded
// once to float, by 6e-8. Strains of about a tenth amplify these errors, because a stress is a
// difference of terms ten times its size.
static const double PRECISION_TOLERANCE = 2e-5;
// Largest relative difference between instruction sets: fused multiply-add changes single
// roundings.
static const double TIER_DOUBLE = 1e-12, TIER_SINGLE = 1e-5;

static const double STRAIN = 0.12, NOISE_M = 5e-4;

typedef struct deformed {
	rig r;
	double *x, *gradient;
	size_t reals;
	double energy;
} deformed;

static void make_deformed(deformed *d, const law_scene *law, int precision, const char *tier)
{
	uint64_t random = 11;
	double a[3][3];
	rig_begin(&d->r);
	d->r.scene->precision = precision;
	law->add(&d->r);
	rig_build(&d->r, tier, 1);
	d->reals = 3 * (size_t)d->r.tissue.vertex_count;
	d->x = cau_arena_array(&d->r.arena, d->reals, sizeof(double));
	d->gradient = cau_arena_array(&d->r.arena, d->reals, sizeof(double));
	rig_random_gradient(&random, STRAIN, a);
	rig_deform(&d->r, a, NOISE_M, &random, d->x);
	d->energy = rig_local(&d->r, d->x, d->gradient);
}

static void test_gradient_is_that_of_the_energy(void **state)
{
	(void)state;
	for (int k = 0; k < LAW_SCENES; k++) {
		if (!law_scenes[k].has_energy)
			continue;
		deformed d;
		make_deformed(&d, &law_scenes[k], CAU_PRECISION_DOUBLE, NULL);
		double *numeric = cau_arena_array(&d.r.arena, d.reals, sizeof(double));
		for (size_t i = 0; i < d.reals; i++) {
			double at = d.x[i];
			d.x[i] = at + DIFFERENCE_STEP_M;
			double above = rig_local(&d.r, d.x, NULL);
			d.x[i] = at - DIFFERENCE_STEP_M;
			numeric[i] = (above - rig_local(&d.r, d.x, NULL)) / (2 * DIFFERENCE_STEP_M);
			d.x[i] = at;
		}
		double off = rig_difference(d.gradient, numeric, d.reals);
		if (!(off < DIFFERENCE_TOLERANCE))
			fail_msg("%s: gradient is off by %g", law_scenes[k].name, off);
		assert_true(k == 0 || d.energy > 0);
		rig_finish(&d.r);
	}
}

// Computes the sum of an element's gradient over its vertices, and the sum of its moments, both
// relative to the sums of the absolute values.
static void element_balance(rig *r, const double *x, int kind, int32_t slot, double *force,
                            double *torque)
{
	int32_t first = rig_vertex(r, kind, slot, 0);
	double sum[3] = {0}, moment[3] = {0}, size = 0, arm_size = 0, gradient[12];
	rig_element_gradient(r, kind, slot, gradient);
	for (int i = 0; i < rig_vertex_count(kind); i++) {
		double g[3], arm[3];
		for (int c = 0; c < 3; c++) {
			g[c] = gradient[3 * i + c];
			arm[c] = x[3 * rig_vertex(r, kind, slot, i) + c] - x[3 * first + c];
			sum[c] += g[c];
		}
		for (int c = 0; c < 3; c++)
			moment[c] += arm[(c + 1) % 3] * g[(c + 2) % 3] - arm[(c + 2) % 3] * g[(c + 1) % 3];
		double length = sqrt(g[0] * g[0] + g[1] * g[1] + g[2] * g[2]);
		size += length;
		arm_size += length * sqrt(arm[0] * arm[0] + arm[1] * arm[1] + arm[2] * arm[2]);
	}
	for (int c = 0; c < 3; c++) {
		*force = fmax(*force, size > 0 ? fabs(sum[c]) / size : 0);
		*torque = fmax(*torque, arm_size > 0 ? fabs(moment[c]) / arm_size : 0);
	}
}

static void test_no_law_pushes_or_turns_an_element(void **state)
{
	(void)state;
	for (int k = 0; k < LAW_SCENES; k++)
		for (int diagonal = 0; diagonal < 2; diagonal++) {
			deformed d;
			make_deformed(&d, &law_scenes[k], CAU_PRECISION_DOUBLE, NULL);
			d.r.solver.settings.diagonal = diagonal;
			rig_local(&d.r, d.x, d.gradient);
			const cau_elements *e = &d.r.solver.elements;
			double force = 0, torque = 0;
			for (int32_t s = 0; s < e->sheet.slot_count; s++)
				element_balance(&d.r, d.x, CAU_ELEMENT_TRIANGLE, s, &force, &torque);
			for (int32_t s = 0; s < e->fat.slot_count; s++)
				element_balance(&d.r, d.x, CAU_ELEMENT_TETRAHEDRON, s, &force, &torque);
			for (int32_t s = 0; s < e->link.slot_count; s++)
				element_balance(&d.r, d.x, CAU_ELEMENT_LINK, s, &force, &torque);
			for (int32_t s = 0; s < e->hinge.slot_count; s++)
				element_balance(&d.r, d.x, CAU_ELEMENT_HINGE, s, &force, &torque);
			if (!(force < BALANCE_DOUBLE) || !(torque < TORQUE_DOUBLE))
				fail_msg("%s: force %g, torque %g", law_scenes[k].name, force, torque);
			rig_finish(&d.r);
		}
}

// If the law's target is the rest shape, forces at rest are exactly 0.
static void test_rest_is_exactly_silent(void **state)
{
	(void)state;
	for (int k = 0; k < LAW_SCENES; k++)
		for (int mode = 0; mode < 4; mode++) {
			rig r;
			rig_begin(&r);
			r.scene->precision = mode & 1 ? CAU_PRECISION_SINGLE : CAU_PRECISION_DOUBLE;
			law_scenes[k].add(&r);
			for (int i = 0; i < 6; i++) {
				if (i < 3)
					r.scene->layers[0].sheet[0].target[i] = i < 2;
				r.scene->layers[0].fat[0].target[i] = i < 3;
			}
			rig_build(&r, NULL, 1);
			r.solver.settings.diagonal = mode >> 1;
			size_t reals = 3 * (size_t)r.tissue.vertex_count;
			double *gradient = cau_arena_array(&r.arena, reals, sizeof(double));
			double energy = rig_local(&r, r.tissue.rest, gradient);
			for (size_t i = 0; i < reals; i++)
				if (gradient[i] != 0)
					fail_msg("%s, mode %d: gradient %g at rest", law_scenes[k].name, mode,
					         gradient[i]);
			assert_true(energy == 0);
			rig_finish(&r);
		}
}

static void test_removed_elements_are_silent(void **state)
{
	(void)state;
	for (int k = 0; k < LAW_SCENES; k++) {
		deformed d;
		make_deformed(&d, &law_scenes[k], CAU_PRECISION_DOUBLE, NULL);
		for (int kind = 0; kind < CAU_ELEMENT_KINDS; kind++)
			for (int32_t e = 0; e < cau_tissue_element_count(&d.r.tissue, kind); e++)
				rig_remove(&d.r, kind, e, 0);
		for (int diagonal = 0; diagonal < 2; diagonal++) {
			d.r.solver.settings.diagonal = diagonal;
			assert_true(rig_local(&d.r, d.x, d.gradient) == 0);
			for (size_t i = 0; i < d.reals; i++)
				assert_true(d.gradient[i] == 0);
		}
		rig_finish(&d.r);
	}
}

// After one element is removed, the gradient is the old gradient less the part of the element.
static void test_one_removed_leaves_the_others(void **state)
{
	(void)state;
	deformed d;
	make_deformed(&d, &law_scenes[4], CAU_PRECISION_DOUBLE, NULL);
	enum { GONE = 5 };
	int32_t slot = d.r.solver.slots.slot_of[CAU_ELEMENT_TETRAHEDRON][GONE];
	double share[12];
	rig_element_gradient(&d.r, CAU_ELEMENT_TETRAHEDRON, slot, share);
	for (int i = 0; i < 12; i++)
		d.gradient[3 * rig_vertex(&d.r, CAU_ELEMENT_TETRAHEDRON, slot, i / 3) + i % 3] -= share[i];
	rig_remove(&d.r, CAU_ELEMENT_TETRAHEDRON, GONE, 0);
	double *after = cau_arena_array(&d.r.arena, d.reals, sizeof(double));
	rig_local(&d.r, d.x, after);
	assert_true(rig_difference(after, d.gradient, d.reals) < BALANCE_DOUBLE);
	rig_finish(&d.r);
}

static void compare(const law_scene *law, deformed *a, deformed *b, double tolerance,
                    const char *what)
{
	for (int diagonal = 0; diagonal < 2; diagonal++) {
		a->r.solver.settings.diagonal = b->r.solver.settings.diagonal = diagonal;
		a->energy = rig_local(&a->r, a->x, a->gradient);
		b->energy = rig_local(&b->r, b->x, b->gradient);
		double off = rig_difference(a->gradient, b->gradient, a->reals);
		if (!(off < tolerance) || !(fabs(a->energy - b->energy) <= tolerance * b->energy))
			fail_msg("%s, %s: gradients differ by %g, energies %g and %g", law->name, what, off,
			         a->energy, b->energy);
	}
}

static void test_single_agrees_with_double(void **state)
{
	(void)state;
	for (int k = 0; k < LAW_SCENES; k++) {
		deformed a, b;
		make_deformed(&a, &law_scenes[k], CAU_PRECISION_SINGLE, NULL);
		make_deformed(&b, &law_scenes[k], CAU_PRECISION_DOUBLE, NULL);
		compare(&law_scenes[k], &a, &b, PRECISION_TOLERANCE, "single");
		rig_finish(&a.r);
		rig_finish(&b.r);
	}
}

static void test_every_instruction_set_agrees(void **state)
{
	(void)state;
	static const char *const tiers[] = {"avx2", "avx512"};
	for (int k = 0; k < LAW_SCENES; k++)
		for (int t = 0; t < 2; t++)
			for (int single = 0; single < 2; single++) {
				if (strcmp(cau_kernels_choose(single, tiers[t])->instruction_set, tiers[t]) != 0)
					continue; // this processor does not have the tier
				int precision = single ? CAU_PRECISION_SINGLE : CAU_PRECISION_DOUBLE;
				deformed a, b;
				make_deformed(&a, &law_scenes[k], precision, tiers[t]);
				make_deformed(&b, &law_scenes[k], precision, "baseline");
				assert_string_equal(b.r.solver.kernels->instruction_set, "baseline");
				compare(&law_scenes[k], &a, &b, single ? TIER_SINGLE : TIER_DOUBLE, tiers[t]);
				rig_finish(&a.r);
				rig_finish(&b.r);
			}
}

static void test_dot_and_add_scaled(void **state)
{
	(void)state;
	enum { MOST = 4099 };
	static double x[MOST], y[MOST];
	static float fx[MOST], fy[MOST];
	uint64_t random = 5;
	for (int i = 0; i < MOST; i++) {
		fx[i] = (float)(x[i] = (float)random_between(&random, -1, 1));
		fy[i] = (float)(y[i] = (float)random_between(&random, -1, 1));
	}
	const cau_kernels *whole = cau_kernels_choose(0, NULL), *half = cau_kernels_choose(1, NULL);
	static const int counts[] = {0, 1, 7, 16, 1023, 1024, 1025, MOST};
	// Largest error of a dot product, relative to the sum of the absolute values. In strips of 64
	// float additions the error is at most 64 x 6e-8.
	static const double DOT_SINGLE = 4e-6, DOT_DOUBLE = 1e-14;
	for (size_t k = 0; k < sizeof counts / sizeof *counts; k++) {
		double exact = 0, size = 0;
		for (int i = 0; i < counts[k]; i++) {
			exact += x[i] * y[i];
			size += fabs(x[i] * y[i]);
		}
		assert_near(whole->dot((cau_reals *)x, (cau_reals *)y, 0, counts[k]), exact,
		            DOT_DOUBLE * size);
		assert_near(half->dot((cau_reals *)fx, (cau_reals *)fy, 0, counts[k]), exact,
		            DOT_SINGLE * size);
	}
	// with a start index: only the last element
	assert_true(whole->dot((cau_reals *)x, (cau_reals *)y, MOST - 1, 1) ==
	            x[MOST - 1] * y[MOST - 1]);
	double expected = y[MOST - 1] + 0.5 * x[MOST - 1];
	whole->add_scaled((cau_reals *)y, 0.5, (cau_reals *)x, MOST);
	half->add_scaled((cau_reals *)fy, 0.5, (cau_reals *)fx, MOST);
	assert_true(y[MOST - 1] == expected && fy[MOST - 1] == (float)expected);
}

// counts that make strips of 4 to 16 vertices, and a remainder
enum { SPREAD_VERTICES = 45, SPREAD_COLUMNS = 37 };

typedef struct spread_case {
	_Alignas(64) unsigned char increment[4 * SPREAD_VERTICES * sizeof(double)];
	unsigned char weight[SPREAD_COLUMNS][SPREAD_VERTICES * sizeof(double)];
	const cau_reals *column[SPREAD_COLUMNS];
	double load[3 * SPREAD_COLUMNS];
} spread_case;

static void make_spread_case(spread_case *of, bool single)
{
	uint64_t random = 3;
	for (int i = 0; i < 4 * SPREAD_VERTICES; i++)
		cau_real_set(of->increment, single, i, i % 4 < 3 ? random_between(&random, -1, 1) : 0);
	for (int k = 0; k < SPREAD_COLUMNS; k++) {
		of->column[k] = (const cau_reals *)of->weight[k];
		for (int v = 0; v < SPREAD_VERTICES; v++)
			cau_real_set(of->weight[k], single, v, random_between(&random, 0, 1));
	}
	for (int i = 0; i < 3 * SPREAD_COLUMNS; i++)
		of->load[i] = random_between(&random, -1, 1);
}

static double spread_expected(const spread_case *of, bool single, int count, int first, int last,
                              int i)
{
	double sum = cau_real_get(of->increment, single, i);
	int v = i / 4, c = i % 4;
	for (int k = 0; k < count && v >= first && v < last && c < 3; k++)
		sum += cau_real_get(of->weight[k], single, v) * of->load[3 * k + c];
	return sum;
}

// Checks that spreading several columns at once gives the expected sums, with the same bits as
// spreading them one after the other.
static void compare_spread(const cau_kernels *kernels, int count, int first, int last)
{
	static spread_case together, apart;
	// the number of additions times the rounding (6e-8 or 1.1e-16) of a sum of at most 40
	double tolerance = kernels->single ? 6e-8 * 40 * 40 : 1.1e-16 * 40 * 40;
	make_spread_case(&together, kernels->single);
	make_spread_case(&apart, kernels->single);
	kernels->spread((cau_reals *)together.increment, together.column, together.load, count, first,
	                last);
	for (int i = 0; i < 4 * SPREAD_VERTICES; i++)
		assert_near(cau_real_get(together.increment, kernels->single, i),
		            spread_expected(&apart, kernels->single, count, first, last, i), tolerance);
	for (int k = 0; k < count; k++)
		for (int v = first; v < last; v++)
			kernels->spread((cau_reals *)apart.increment, apart.column + k, apart.load + 3 * k, 1,
			                v, v + 1);
	assert_memory_equal(together.increment, apart.increment, sizeof apart.increment);
}

static void test_columns_are_spread_in_their_order(void **state)
{
	(void)state;
	static const char *const tiers[] = {"baseline", "avx2", "avx512"};
	static const int counts[] = {0, 1, 15, 16, 17, SPREAD_COLUMNS};
	static const int ranges[][2] = {{0, SPREAD_VERTICES}, {3, 42}, {7, 8}, {5, 5}};
	for (int t = 0; t < 3; t++)
		for (int single = 0; single < 2; single++)
			for (size_t c = 0; c < sizeof counts / sizeof *counts; c++)
				for (size_t k = 0; k < sizeof ranges / sizeof *ranges; k++)
					compare_spread(cau_kernels_choose(single, tiers[t]), counts[c], ranges[k][0],
					               ranges[k][1]);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_gradient_is_that_of_the_energy),
		cmocka_unit_test(test_no_law_pushes_or_turns_an_element),
		cmocka_unit_test(test_rest_is_exactly_silent),
		cmocka_unit_test(test_removed_elements_are_silent),
		cmocka_unit_test(test_one_removed_leaves_the_others),
		cmocka_unit_test(test_single_agrees_with_double),
		cmocka_unit_test(test_every_instruction_set_agrees),
		cmocka_unit_test(test_dot_and_add_scaled),
		cmocka_unit_test(test_columns_are_spread_in_their_order),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
