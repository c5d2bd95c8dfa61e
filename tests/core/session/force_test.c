// SPDX-License-Identifier: GPL-3.0-or-later
// Forces of resting tissue on a tool, in numbers. They are compared with the solution of the same
// mesh by Newton's method, with other meshes, with Hertz's law corrected for thin layers, and along
// a motion over the cells. The cells of a patch are counted along the diameter of the contact by
// Hertz.
#include <stdio.h>

#include "core/session/indent.h"

static const double asked_of_solution = 0.01, asked_over_meshes = 0.1, asked_of_hertz = 0.1;
static const double asked_at_four_cells = 0.03,
					asked_at_two = 0.1; // largest force less least force, over the mean

// Presses a ball in beside the lines of the mesh, so that no vertex is below the ball.
static double press(indent_stand *stand)
{
	const indent *of = &stand->of;
	return indent_press(stand, 0.27 * of->cell_m, 0.31 * of->cell_m, of->depth_m);
}

static void it_is_the_solution_of_the_same_mesh(void **state)
{
	(void)state;
	static const indent presses[] = {
		{1.5e-3, 2e-3, 2e-3, 6e-3, 16e-3, 20e-3, 0.4}, // contact with points of faces
		{3e-3, 1.5e-3, 2e-3, 6e-3, 16e-3, 20e-3, 0.4},
		{6.5e-3, 1e-3, 2e-3, 6e-3, 16e-3, 20e-3, 0.4},
		{6.5e-3, 4e-3, 2e-3, 6e-3, 16e-3, 20e-3, 0.4}, // as deep as a quarter of the slab
		{13e-3, 2e-3, 2e-3, 8e-3, 16e-3, 30e-3, 0.3},
		{40e-3, 1e-3, 3.2e-3, 10e-3, 16e-3, 40e-3, 0.4},
	};
	for (size_t k = 0; k < sizeof presses / sizeof *presses; k++) {
		indent_stand *stand = indent_open(&presses[k]);
		double force_n = press(stand), solved_n = indent_solve(stand, false).force_n[2];
		print_message("ball of %g mm, %g mm deep, %.1f cells: %.6g N, off by %+.1e\n",
		              1e3 * presses[k].radius_m, 1e3 * presses[k].depth_m,
		              indent_cells(&presses[k]), force_n, force_n / solved_n - 1);
		assert_true(fabs(force_n / solved_n - 1) < asked_of_solution);
		indent_close(stand);
	}
}

// The solution does not depend on where the solver starts.
static void the_solution_is_found_from_rest_too(void **state)
{
	(void)state;
	static const indent p = {6.5e-3, 1e-3, 2e-3, 4e-3, 16e-3, 20e-3, 0.4};
	indent_stand *stand = indent_open(&p);
	press(stand);
	double here_n = indent_solve(stand, false).force_n[2];
	double from_rest_n = indent_solve(stand, true).force_n[2];
	assert_true(fabs(from_rest_n / here_n - 1) < 1e-6);
	indent_close(stand);
}

// Presses a ball to a sixteenth of the slab's depth, in meshes of four and more cells in a patch.
static void over_meshes(const indent *coarse, const double *cell_m, int count)
{
	double least = INFINITY, most = 0, hertz_n = 0, finest_n = 0;
	for (int k = 0; k < count; k++) {
		indent p = *coarse;
		p.cell_m = cell_m[k];
		indent_stand *stand = indent_open(&p);
		finest_n = press(stand);
		least = fmin(least, finest_n);
		most = fmax(most, finest_n);
		hertz_n = cau_indented_by_hertz(indent_young_modulus_pa, p.poisson_ratio, p.radius_m,
		                                p.depth_m, p.thick_m);
		print_message("ball of %g mm, %.1f cells: %.5g N, Hertz %+.1f %%\n", 1e3 * p.radius_m,
		              indent_cells(&p), finest_n, 100 * (finest_n / hertz_n - 1));
		assert_true(indent_cells(&p) > 3.9);
		indent_close(stand);
	}
	assert_true(most / least - 1 < asked_over_meshes);
	assert_true(fabs(finest_n / hertz_n - 1) < asked_of_hertz);
}

static const indent small = {6.5e-3, 1e-3, 0, 4.5e-3, 16e-3, 24e-3, 0.3};
static const indent middle = {13e-3, 1e-3, 0, 6e-3, 16e-3, 30e-3, 0.3};
static const indent wide = {40e-3, 1e-3, 0, 9e-3, 16e-3, 40e-3, 0.3};

static void it_hardly_depends_on_the_mesh_and_is_hertzs(void **state)
{
	(void)state;
	over_meshes(&small, (double[]){1.275e-3, 0.85e-3}, 2);
	over_meshes(&middle, (double[]){1.8e-3, 1.2e-3}, 2);
	over_meshes(&wide, (double[]){3.2e-3, 2.1e-3}, 2);
}

static void nor_on_finer_meshes(void **state)
{
	(void)state;
	over_meshes(&small, (double[]){1.275e-3, 0.6375e-3, 0.5e-3}, 3);
	over_meshes(&middle, (double[]){1.8e-3, 0.9e-3, 0.7e-3}, 3);
	over_meshes(&wide, (double[]){3.2e-3, 1.6e-3, 1.3e-3}, 3);
}

// Returns the largest force less the least force, over the mean force, at eight positions along a
// cell.
static double change(double cell_m)
{
	enum { PLACES = 8 };
	indent p = {6.5e-3, 1e-3, cell_m, 5e-3, 16e-3, 24e-3, 0.4};
	indent_stand *stand = indent_open(&p);
	double least = INFINITY, most = 0, sum = 0;
	for (int place = 0; place < PLACES; place++) {
		double share = (double)place / PLACES;
		double force_n =
			indent_press(stand, (0.27 + share) * cell_m, (0.31 + 0.6 * share) * cell_m, p.depth_m);
		least = fmin(least, force_n);
		most = fmax(most, force_n);
		sum += force_n;
	}
	print_message("%.1f cells: %.1f %% from least to most\n", indent_cells(&p),
	              100 * (most - least) / (sum / PLACES));
	indent_close(stand);
	return (most - least) / (sum / PLACES);
}

static void sliding_over_four_cells_it_hardly_changes(void **state)
{
	(void)state;
	assert_true(change(1.27e-3) < asked_at_four_cells);
}

static void over_two_cells_it_changes_little(void **state)
{
	(void)state;
	assert_true(change(2.54e-3) < asked_at_two);
}

int main(int argc, char **argv)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(it_is_the_solution_of_the_same_mesh),
		cmocka_unit_test(the_solution_is_found_from_rest_too),
		cmocka_unit_test(it_hardly_depends_on_the_mesh_and_is_hertzs),
		cmocka_unit_test(sliding_over_four_cells_it_hardly_changes),
		cmocka_unit_test(over_two_cells_it_changes_little),
	};
	const struct CMUnitTest finer[] = {cmocka_unit_test(nor_on_finer_meshes)};
	if (argc > 1 && !strcmp(argv[1], "--long"))
		return cmocka_run_group_tests(finer, NULL, NULL);
	return cmocka_run_group_tests(tests, NULL, NULL);
}
