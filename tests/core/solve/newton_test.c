// SPDX-License-Identifier: GPL-3.0-or-later
// Newton's step for sheets: its H is the derivative of the gradient where nothing is left out of
// it, what is left out makes it positive definite, and it is solved as it stands.
#include <string.h>

#include "core/rig/solve_scenes.h"

// Central differences of gradients over a hundredth of a micrometre: truncation and rounding.
static const double DIFFERENCE_M = 1e-8, DIFFERENCE_TOLERANCE = 1e-5;
static const double SOLVE_TOLERANCE = 1e-9; // rounding times a condition of some 1e5

enum { TAUT, LOOSE, RANGE, LAWS };

static void make(rig *r, int law, double stretch)
{
	uint64_t random = 77;
	double a[3][3] = {{stretch, 0.05, 0}, {0, 1.1 * stretch, 0}, {0.2, -0.1, 1}};
	rig_begin(r);
	r->scene->solver = CAU_SOLVER_NEWTON;
	cau_sheet_material *sheet = &rig_add_sheet(r, 6, 5)->sheet[0];
	sheet->limit = law == RANGE ? CAU_LIMIT_RANGE : CAU_LIMIT_TARGET;
	sheet->target[0] = law == TAUT ? 0.3 : 1;
	sheet->target[1] = law == TAUT ? 0.6 : 1;
	sheet->target[2] = law == TAUT ? 0.1 : 0;
	sheet->strain_max[0] = sheet->strain_max[1] = 0.02;
	sheet->shear_max = 0.9;
	rig_pin_box(r, (double[]){-1, -1, -1}, (double[]){-0.0499, 1, 1});
	rig_build(r, NULL, 1);
	rig_factor(r);
	assert_true(r->solver.newton_chosen);
	rig_deform(r, a, 2e-4, &random, r->solver.position);
	r->solver.drag = cau_arena_array(&r->arena, 1, sizeof *r->solver.drag);
	r->solver.drag_count = 1;
	r->solver.drag[0] = (cau_drag){20, 40.0, {0.01, 0.02, -0.01}};
}

static double *vector(rig *r)
{
	return cau_arena_array(&r->arena, 3 * (size_t)r->tissue.vertex_count, sizeof(double));
}

static void take(const rig *r, const cau_reals *from, double *to)
{
	for (int32_t i = 0; i < 3 * r->tissue.vertex_count; i++)
		to[i] = cau_real_get(from, false, 4 * (int64_t)(i / 3) + i % 3);
}

static void gradient_at(rig *r, const double *way, double scale, double *gradient)
{
	int32_t n = 3 * r->tissue.vertex_count;
	for (int32_t i = 0; i < n; i++)
		r->solver.position[i] += scale * way[i];
	cau_solver_evaluate(&r->solver);
	take(r, r->solver.gradient, gradient);
	for (int32_t i = 0; i < n; i++)
		r->solver.position[i] -= scale * way[i];
}

static void add_product(const double *block, const int32_t vertex[2], bool turned, const double *x,
                        double *y)
{
	for (int row = 0; row < 3; row++)
		for (int column = 0; column < 3; column++) {
			double value = turned ? block[4 * row + column] : block[4 * column + row];
			y[3 * vertex[0] + row] += value * x[3 * vertex[1] + column];
		}
}

// y = H x, of an H that is assembled and not factored
static void multiply(rig *r, const double *x, double *y)
{
	const cau_newton *h = &r->solver.newton;
	int32_t *vertex = cau_arena_array(&r->arena, (size_t)h->n, sizeof *vertex);
	memset(y, 0, 3 * (size_t)r->tissue.vertex_count * sizeof *y);
	for (int32_t v = 0; v < r->tissue.vertex_count; v++)
		if (h->place[v] >= 0)
			vertex[h->place[v]] = v;
	for (int32_t j = 0; j < h->n; j++) {
		add_product(h->pivot + CAU_BLOCK * j, (int32_t[]){vertex[j], vertex[j]}, false, x, y);
		for (int32_t k = h->first[j]; k < h->first[j + 1]; k++) {
			int32_t pair[] = {vertex[h->row[k]], vertex[j]}, back[] = {pair[1], pair[0]};
			add_product(h->block + (int64_t)CAU_BLOCK * k, pair, false, x, y);
			add_product(h->block + (int64_t)CAU_BLOCK * k, back, true, x, y);
		}
	}
}

static void random_way(const rig *r, double *way)
{
	uint64_t random = 5;
	for (int32_t i = 0; i < 3 * r->tissue.vertex_count; i++) {
		double a[3][3];
		rig_random_gradient(&random, 1, a);
		way[i] = r->fixed[i / 3] ? 0 : a[0][1];
	}
}

// Stretched beyond their targets or ranges all over, so that no part of any element is negative.
static void the_hessian_is_the_derivative_of_the_gradient(void **state)
{
	(void)state;
	for (int law = 0; law < LAWS; law++) {
		rig r;
		make(&r, law, 1.2);
		size_t n = 3 * (size_t)r.tissue.vertex_count;
		double *way = vector(&r), *above = vector(&r), *below = vector(&r), *product = vector(&r);
		random_way(&r, way);
		assert_int_equal(cau_newton_create(&r.solver.newton, &r.solver, NULL), CAU_OK);
		cau_newton_assemble(&r.solver.newton, &r.solver);
		multiply(&r, way, product);
		gradient_at(&r, way, DIFFERENCE_M, above);
		gradient_at(&r, way, -DIFFERENCE_M, below);
		for (size_t i = 0; i < n; i++)
			above[i] = (above[i] - below[i]) / (2 * DIFFERENCE_M);
		assert_true(rig_difference(product, above, n) < DIFFERENCE_TOLERANCE);
		rig_finish(&r);
	}
}

// Crumpled as well as stretched: H d = -g, and d leads down.
static void its_increment_solves_it_and_leads_down(void **state)
{
	(void)state;
	for (int law = 0; law < LAWS; law++)
		for (int crumpled = 0; crumpled < 2; crumpled++) {
			rig r;
			make(&r, law, crumpled ? 0.4 : 1.2);
			size_t n = 3 * (size_t)r.tissue.vertex_count;
			double *gradient = vector(&r), *way = vector(&r), *product = vector(&r), slope = 0;
			cau_solver_evaluate(&r.solver);
			take(&r, r.solver.gradient, gradient);
			assert_int_equal(cau_newton_increment(&r.solver, NULL), CAU_OK);
			take(&r, r.solver.increment, way);
			cau_newton_assemble(&r.solver.newton, &r.solver);
			multiply(&r, way, product);
			for (size_t i = 0; i < n; i++) {
				slope += way[i] * gradient[i];
				gradient[i] = -gradient[i];
				assert_true(!r.fixed[i / 3] || way[i] == 0);
			}
			assert_true(slope < 0);
			assert_true(rig_difference(product, gradient, n) < SOLVE_TOLERANCE);
			rig_finish(&r);
		}
}

// An element that is cut out has no part in H: what is left is inertia.
static void what_is_removed_is_not_in_it(void **state)
{
	(void)state;
	rig r;
	make(&r, LOOSE, 1.2);
	for (int32_t t = 0; t < r.tissue.triangle_count; t++)
		rig_remove(&r, CAU_ELEMENT_TRIANGLE, t, 0);
	r.solver.drag_count = 0;
	assert_int_equal(cau_newton_create(&r.solver.newton, &r.solver, NULL), CAU_OK);
	cau_newton_assemble(&r.solver.newton, &r.solver);
	double *way = vector(&r), *product = vector(&r), dt = r.solver.step_s;
	random_way(&r, way);
	multiply(&r, way, product);
	for (int32_t i = 0; i < 3 * r.tissue.vertex_count; i++)
		assert_near(product[i], r.tissue.mass[i / 3] / (dt * dt) * way[i], 1e-12);
	rig_finish(&r);
}

// A scene with fat in it, or with a law that has no energy, goes on by A.
static void other_tissue_is_left_to_a(void **state)
{
	(void)state;
	for (int fat = 0; fat < 2; fat++) {
		rig r;
		rig_begin(&r);
		r.scene->solver = CAU_SOLVER_NEWTON;
		if (fat)
			rig_add_slab(&r, 2, 2, 1);
		else
			rig_add_sheet(&r, 3, 3)->sheet[0].projection = CAU_PROJECTION_LINEARISED;
		rig_build(&r, NULL, 1);
		rig_factor(&r);
		assert_false(r.solver.newton_chosen);
		assert_false(cau_newton_is_called_for(&r.solver));
		r.solver.predicted[5] += 0.01;
		assert_int_equal(cau_solver_run(&r.solver, NULL), CAU_OK);
		assert_int_equal(r.solver.newton.n, 0);
		rig_finish(&r);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(the_hessian_is_the_derivative_of_the_gradient),
		cmocka_unit_test(its_increment_solves_it_and_leads_down),
		cmocka_unit_test(what_is_removed_is_not_in_it),
		cmocka_unit_test(other_tissue_is_left_to_a),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
