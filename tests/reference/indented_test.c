// SPDX-License-Identifier: GPL-3.0-or-later
// Compares the solution of an indented body with the finite-element package, and the correction for
// thin layers with the numbers in its paper.
// clang-format off
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
// clang-format on

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "reference/case.h"
#include "reference/indented.h"

// Largest relative error of displacements and forces, from the digits of the files.
static const double same = 1e-5;

// Lowers the ball in stages, because a single stage would invert elements.
static void solve(const cau_reference_case *reference, const cau_indented_body *body,
                  cau_indented *out)
{
	// FEW: largest number of iterations that Newton's method needs with a correct Hessian
	enum { STAGES = 8, FEW = 6 };
	int slow = 0; // stages with more iterations, which find the pushing vertices
	size_t bytes = 3 * (size_t)body->vertex_count * sizeof(double);
	double *position = malloc(bytes);
	assert_non_null(position);
	memcpy(position, body->rest, bytes);
	for (int stage = 1; stage <= STAGES; stage++) {
		cau_indenting_ball ball = {.radius_m = reference->sphere_radius_m};
		memcpy(ball.centre_m, reference->sphere_center_m, sizeof ball.centre_m);
		double above = ball.radius_m - ball.centre_m[2];
		ball.centre_m[2] += above * (STAGES - stage) / STAGES;
		assert_true(cau_indented_solve(body, &ball, position, out));
		slow += out->iterations > FEW;
	}
	assert_true(slow <= 1);
	double most = 0, off = 0;
	for (int32_t i = 0; i < 3 * body->vertex_count; i++) {
		off = fmax(off, fabs(position[i] - body->rest[i] - reference->displacement[i]));
		most = fmax(most, fabs(reference->displacement[i]));
	}
	assert_true(off < same * most);
	free(position);
}

static void compare(const char *name)
{
	char path[1024];
	cau_reference_case reference = {0};
	cau_error error = {0};
	snprintf(path, sizeof path, "%s/%s.case", CAU_TEST_REFERENCE, name);
	if (cau_reference_case_read(path, &reference, &error))
		fail_msg("%s: %s", path, error.reason);
	size_t n = (size_t)reference.vertex_count;
	int32_t *surface = malloc(n * sizeof *surface);
	bool *fixed = calloc(n, sizeof *fixed);
	assert_non_null(surface);
	assert_non_null(fixed);
	for (int32_t k = 0; k < reference.fixed_count; k++)
		fixed[reference.fixed[k]] = true;
	cau_indented_body body = {.vertex_count = reference.vertex_count,
	                          .tetrahedron_count = reference.tetrahedron_count,
	                          .surface_count = cau_reference_case_top(&reference, surface),
	                          .rest = reference.position,
	                          .tetrahedron = reference.tetrahedron,
	                          .surface = surface,
	                          .fixed = fixed,
	                          .model = reference.model,
	                          .young_modulus_pa = reference.young_modulus_pa,
	                          .poisson_ratio = reference.poisson_ratio};
	cau_indented found;
	solve(&reference, &body, &found);
	print_message("%s: %.9g N, %.9g by the package\n", name, found.force_n[2],
	              -reference.contact_n[2]);
	assert_true(fabs(found.force_n[2] / -reference.contact_n[2] - 1) < same);
	free(surface);
	free(fixed);
	cau_reference_case_finish(&reference);
}

static void it_is_the_finite_element_packages(void **state)
{
	(void)state;
	compare("indentation_neohookean_nu30");
	compare("indentation_neohookean_nu40");
	compare("indentation_stvk_nu30");
}

// Checks eq. 12 of the paper: 16/9 E sqrt(R) d^(3/2) (1 + 1.133 x + 1.283 x^2 + 0.769 x^3 +- 0.0975
// x^4).
static void hertz_is_as_printed(void **state)
{
	(void)state;
	const double radius_m = 0.01, depth_m = 1e-3, x = 0.25;
	double thick_m = sqrt(radius_m * depth_m) / x, fourth = 0.0975 * pow(x, 4);
	double factor = 1 + 1.133 * x + 1.283 * x * x + 0.769 * x * x * x;
	double found = cau_indented_by_hertz(5000, 0.5, radius_m, depth_m, thick_m) /
	               (16.0 / 9 * 5000 * sqrt(radius_m) * pow(depth_m, 1.5));
	// The sign of the last term may differ, and the numbers in the paper have three digits.
	assert_true(fabs(found - factor) < fourth + 5e-4);
	double far = cau_indented_by_hertz(5000, 0.3, radius_m, depth_m, 1e3);
	double hertz = 4.0 / 3 * 5000 / (1 - 0.09) * sqrt(radius_m) * pow(depth_m, 1.5);
	assert_true(fabs(far / hertz - 1) < 1e-4);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(it_is_the_finite_element_packages),
		cmocka_unit_test(hertz_is_as_printed),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
