// SPDX-License-Identifier: GPL-3.0-or-later
// Newton's method in loose tissue: H is the derivative of the gradient if no eigenvalue is
// negative; M is symmetric and positive definite wherever the region ends; settling balances the
// region's forces.
#include <string.h>

#include "core/rig/solve_scenes.h"

// Step, m, of central differences of gradients, and their largest relative error, which is
// truncation and rounding.
static const double DIFFERENCE_M = 1e-8, DIFFERENCE_TOLERANCE = 1e-5;
// largest relative error of a solve: rounding times a condition number of about 1e5
static const double SOLVE_TOLERANCE = 1e-9;

enum { TAUT, LOOSE, RANGE, VISCOUS, LAWS };

static void make(rig *r, int law, double stretch)
{
	uint64_t random = 77;
	double a[3][3] = {{stretch, 0.05, 0}, {0, 1.1 * stretch, 0}, {0.2, -0.1, 1}};
	rig_begin(r);
	r->scene->solver = CAU_SOLVER_NEWTON;
	cau_layer_def *layer = rig_add_sheet(r, 6, 5);
	cau_sheet_material *sheet = &layer->sheet[0];
	layer->viscosity_s = law == VISCOUS ? 0.01 : 0;
	sheet->limit = law == RANGE ? CAU_LIMIT_RANGE : CAU_LIMIT_TARGET;
	sheet->target[0] = law == TAUT ? 0.3 : 1;
	sheet->target[1] = law == TAUT ? 0.6 : 1;
	sheet->target[2] = law == TAUT ? 0.1 : 0;
	sheet->strain_max[0] = sheet->strain_max[1] = 0.02;
	sheet->shear_max = 0.9;
	rig_pin_box(r, (double[]){-1, -1, -1}, (double[]){-0.0499, 1, 1});
	rig_build(r, NULL, 1);
	rig_factor(r);
	assert_true(r->solver.settings.newton_chosen);
	cau_solver_take_strain(&r->solver, 1); // takes the strain at rest as the reference
	rig_deform(r, a, 2e-4, &random, r->solver.position);
	cau_solver_take_strain(&r->solver, 0.8); // a fifth of the strain is new in this step
	r->solver.forces.drag = cau_arena_array(&r->arena, 1, sizeof *r->solver.forces.drag);
	r->solver.forces.drag_count = 1;
	r->solver.forces.drag[0] = (cau_drag){20, 40.0, {0.01, 0.02, -0.01}};
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
	take(r, r->solver.iterate.gradient, gradient);
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

// Computes y = H x, for an H that is assembled and not factored.
static void multiply(rig *r, const double *x, double *y)
{
	const cau_newton *h = &r->solver.loose.region;
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

// The sheet is stretched beyond its targets or ranges everywhere, so that no part of an element's
// Hessian has a negative eigenvalue.
static void the_hessian_is_the_derivative_of_the_gradient(void **state)
{
	(void)state;
	for (int law = 0; law < LAWS; law++) {
		rig r;
		make(&r, law, 1.2);
		size_t n = 3 * (size_t)r.tissue.vertex_count;
		double *way = vector(&r), *above = vector(&r), *below = vector(&r), *product = vector(&r);
		random_way(&r, way);
		assert_int_equal(cau_loose_choose(&r.solver, NULL), CAU_OK);
		assert_true(cau_newton_assemble(&r.solver.loose.region, &r.solver));
		multiply(&r, way, product);
		gradient_at(&r, way, DIFFERENCE_M, above);
		gradient_at(&r, way, -DIFFERENCE_M, below);
		for (size_t i = 0; i < n; i++)
			above[i] = (above[i] - below[i]) / (2 * DIFFERENCE_M);
		assert_true(rig_difference(product, above, n) < DIFFERENCE_TOLERANCE);
		rig_finish(&r);
	}
}

// In crumpled and in stretched sheets, the increment d satisfies H d = -g, and d lowers the
// objective.
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
			take(&r, r.solver.iterate.gradient, gradient);
			assert_int_equal(cau_loose_choose(&r.solver, NULL), CAU_OK);
			cau_loose_increment(&r.solver);
			take(&r, r.solver.iterate.increment, way);
			assert_true(cau_newton_assemble(&r.solver.loose.region, &r.solver));
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

// A removed element has no part in H. If all elements are removed, H has only the masses.
static void what_is_removed_is_not_in_it(void **state)
{
	(void)state;
	rig r;
	make(&r, LOOSE, 1.2);
	assert_int_equal(cau_loose_choose(&r.solver, NULL), CAU_OK);
	for (int32_t t = 0; t < r.tissue.triangle_count; t++)
		rig_remove(&r, CAU_ELEMENT_TRIANGLE, t, 0);
	r.solver.forces.drag_count = 0;
	assert_true(cau_newton_assemble(&r.solver.loose.region, &r.solver));
	double *way = vector(&r), *product = vector(&r), dt = r.solver.step_s;
	random_way(&r, way);
	multiply(&r, way, product);
	for (int32_t i = 0; i < 3 * r.tissue.vertex_count; i++)
		assert_near(product[i], r.tissue.mass[i / 3] / (dt * dt) * way[i], 1e-12);
	rig_finish(&r);
}

// Chooses the vertices in one half of the sheet as the region, so that M has couplings between the
// region and the rest.
static void choose_half(rig *r)
{
	cau_loose *loose = &r->solver.loose;
	assert_int_equal(cau_loose_choose(&r->solver, NULL), CAU_OK);
	for (int32_t v = 0; v < r->tissue.vertex_count; v++)
		loose->region.chosen[v] &= r->tissue.rest[3 * v] > 0;
	assert_true(cau_newton_create(&loose->region, &r->solver, NULL));
	assert_true(loose->region.n > 5 && loose->region.n < r->tissue.vertex_count / 2 + 8);
}

// Computes M^-1 g of a random gradient g.
static void precondition(rig *r, uint64_t seed, double *gradient, double *increment)
{
	cau_newton *region = &r->solver.loose.region;
	uint64_t random = seed;
	for (int32_t i = 0; i < 3 * r->tissue.vertex_count; i++) {
		double a[3][3];
		rig_random_gradient(&random, 1, a);
		gradient[i] = r->fixed[i / 3] ? 0 : a[0][1];
		cau_real_set(r->solver.iterate.gradient, false, 4 * (int64_t)(i / 3) + i % 3, gradient[i]);
	}
	assert_true(cau_newton_assemble(region, &r->solver));
	assert_true(r->solver.kernels->newton_factor(region));
	for (int32_t i = 0; i < region->n; i++)
		memcpy(region->gradient + 4 * (int64_t)i, gradient + 3 * (int64_t)region->vertex[i],
		       3 * sizeof *gradient);
	r->solver.loose.fresh = true;
	cau_loose_increment(&r->solver);
	take(r, r->solver.iterate.increment, increment);
}

static double dot(const double *a, const double *b, size_t n)
{
	double sum = 0;
	for (size_t i = 0; i < n; i++)
		sum += a[i] * b[i];
	return sum;
}

static void it_is_joined_to_the_rest_symmetrically(void **state)
{
	(void)state;
	for (int law = 0; law < LAWS; law++) {
		rig r;
		make(&r, law, 0.6);
		size_t n = 3 * (size_t)r.tissue.vertex_count;
		double *g1 = vector(&r), *g2 = vector(&r), *d1 = vector(&r), *d2 = vector(&r);
		choose_half(&r);
		cau_solver_evaluate(&r.solver);
		precondition(&r, 3, g1, d1);
		precondition(&r, 4, g2, d2);
		assert_near(dot(g1, d2, n) / dot(g2, d1, n), 1, SOLVE_TOLERANCE);
		assert_true(dot(g1, d1, n) < 0 && dot(g2, d2, n) < 0);
		rig_finish(&r);
	}
}

// Settling moves the region until its own forces vanish. All other vertices stay, and eq. 4 falls.
static void settling_leaves_no_force(void **state)
{
	(void)state;
	for (int law = 0; law < LAWS; law++) {
		rig r;
		make(&r, law, 1.1);
		size_t n = 3 * (size_t)r.tissue.vertex_count;
		double *before = vector(&r), *gradient = vector(&r);
		memcpy(before, r.solver.position, n * sizeof *before);
		choose_half(&r);
		double objective = cau_solver_evaluate(&r.solver), first = objective;
		take(&r, r.solver.iterate.gradient, gradient);
		double size = sqrt(dot(gradient, gradient, n)), left = 0;
		int most = law == VISCOUS ? 12 : 4; // the viscous sheet buckles while it settles
		for (int k = 0; k < most && (!k || !r.solver.loose.settled); k++)
			assert_int_equal(cau_loose_settle(&r.solver, &objective, NULL), CAU_OK);
		assert_true(r.solver.loose.settled && !r.solver.loose.given_up && objective < first);
		take(&r, r.solver.iterate.gradient, gradient);
		for (size_t i = 0; i < n; i++) {
			if (r.solver.loose.region.place[i / 3] < 0)
				assert_true(r.solver.position[i] == before[i]);
			else
				left = fmax(left, fabs(gradient[i]));
		}
		// steps shorter than 50 nm are not taken, so a small force remains
		assert_true(left < 1e-3 * size);
		rig_finish(&r);
	}
}

// A taut sheet is left to A. If a corner is crumpled, the slack triangles there are the region. A
// sheet with a range is a region in both cases.
static void what_is_slack_is_loose(void **state)
{
	(void)state;
	for (int law = 0; law < LAWS; law++) {
		rig r;
		make(&r, law, 1.6);
		r.solver.settings.newton_chosen = false;
		cau_solver_evaluate(&r.solver);
		assert_int_equal(cau_loose_choose(&r.solver, NULL), CAU_OK);
		assert_int_equal(r.solver.loose.region.n > 0, law == RANGE);
		// move a corner back to 0.2 of its rest position
		for (int32_t v = 0; v < r.tissue.vertex_count; v++)
			if (r.tissue.rest[3 * v] > 0.02 && r.tissue.rest[3 * v + 1] > 0)
				for (int c = 0; c < 3; c++)
					r.solver.position[3 * v + c] = 0.2 * r.tissue.rest[3 * v + c];
		cau_solver_evaluate(&r.solver);
		assert_int_equal(cau_loose_choose(&r.solver, NULL), CAU_OK);
		assert_true(r.solver.loose.region.n > 0);
		rig_finish(&r);
	}
}

// A sheet with a range and too many vertices for a region is left to A. A crumpled sheet beside it
// is still a region.
static void a_large_sheet_with_a_range_is_left_to_a(void **state)
{
	(void)state;
	rig r;
	rig_begin(&r);
	rig_add_sheet(&r, 40, 30)->sheet[0].limit = CAU_LIMIT_RANGE;
	rig_add_sheet(&r, 6, 5);
	rig_build(&r, NULL, 1);
	rig_factor(&r);
	int32_t first = r.tissue.layer[1].first_vertex, n = r.tissue.vertex_count;
	assert_true(first > CAU_NEWTON_ROWS);
	for (int32_t i = 3 * first; i < 3 * n; i++)
		r.solver.position[i] *= 0.2;
	cau_solver_evaluate(&r.solver);
	assert_int_equal(cau_loose_choose(&r.solver, NULL), CAU_OK);
	assert_int_equal(r.solver.loose.region.n, n - first);
	rig_finish(&r);
}

// Fat is left to A, and so is a law without an energy.
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
		r.solver.predicted[5] += 0.01;
		assert_int_equal(cau_solver_run(&r.solver, NULL), CAU_OK);
		assert_int_equal(r.solver.loose.region.n, 0);
		rig_finish(&r);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(the_hessian_is_the_derivative_of_the_gradient),
		cmocka_unit_test(its_increment_solves_it_and_leads_down),
		cmocka_unit_test(what_is_removed_is_not_in_it),
		cmocka_unit_test(it_is_joined_to_the_rest_symmetrically),
		cmocka_unit_test(settling_leaves_no_force),
		cmocka_unit_test(what_is_slack_is_loose),
		cmocka_unit_test(a_large_sheet_with_a_range_is_left_to_a),
		cmocka_unit_test(other_tissue_is_left_to_a),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
