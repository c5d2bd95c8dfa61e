// SPDX-License-Identifier: GPL-3.0-or-later
// The committed cases can be read and are correct: each is an equilibrium of its mesh under a
// separately written stress, with its supports, contacts and sums.
#include "reference/case.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#include "reference/stress.h"

// Largest error of a force, relative to the supports' forces. The files have nine digits, so
// displacements have errors of 5e-10 of their size. Forces have these errors times the elements'
// stiffness.
static const double FORCE_TOLERANCE = 1e-6;
// Largest distance of a touching vertex from the sphere, relative to the sphere's radius. The files
// have nine digits.
static const double GAP_TOLERANCE = 1e-8;

static const char *const NAMES[] = {
	"block_stvk_nu30",
	"block_neohookean_nu30",
	"block_neohookean_nu40",
	"cantilever_stvk_nu30",
	"cantilever_stvk_nu45",
	"cantilever_neohookean_nu30",
	"cantilever_neohookean_nu45",
	"twist_stvk_nu30",
	"twist_neohookean_nu40",
	"indentation_stvk_nu30",
	"indentation_neohookean_nu30",
	"indentation_neohookean_nu40",
};

// ---- forces -----------------------------------------------------------------------------------
static double inverse(double a[3][3], double out[3][3])
{
	double determinant = cau_reference_determinant(a);
	for (int i = 0; i < 3; ++i)
		for (int j = 0; j < 3; ++j) {
			int r = (j + 1) % 3, s = (j + 2) % 3, c = (i + 1) % 3, d = (i + 2) % 3;
			out[i][j] = (a[r][c] * a[s][d] - a[r][d] * a[s][c]) / determinant;
		}
	return determinant;
}

// Adds the forces that hold tetrahedron t to `force`. Returns its volume.
static double add_tetrahedron(const cau_reference_case *c, int32_t t, double *force)
{
	const int32_t *v = c->tetrahedron + 4 * (ptrdiff_t)t;
	double rest[3][3], now[3][3], inverted[3][3], f[3][3], stress[3][3];
	for (int i = 0; i < 3; ++i)
		for (int k = 0; k < 3; ++k) {
			const double *x = c->position, *u = c->displacement;
			rest[i][k] = x[3 * v[k + 1] + i] - x[3 * v[0] + i];
			now[i][k] = rest[i][k] + u[3 * v[k + 1] + i] - u[3 * v[0] + i];
		}
	double volume = inverse(rest, inverted) / 6;
	for (int i = 0; i < 3; ++i)
		for (int j = 0; j < 3; ++j) {
			f[i][j] = 0;
			for (int k = 0; k < 3; ++k)
				f[i][j] += now[i][k] * inverted[k][j];
		}
	cau_reference_stress(c->model, c->young_modulus_pa, c->poisson_ratio, f, stress);
	for (int i = 0; i < 3; ++i) {
		double weight = c->density_kg_m3 * c->gravity_m_s2[i] * volume / 4;
		force[3 * v[0] + i] -= weight;
		for (int k = 0; k < 3; ++k) {
			double pull = 0;
			for (int j = 0; j < 3; ++j)
				pull += volume * stress[i][j] * inverted[k][j];
			force[3 * v[k + 1] + i] += pull - weight;
			force[3 * v[0] + i] -= pull;
		}
	}
	return volume;
}

// Returns the forces (N, (vertex_count x 3)) that hold the body in its present state.
static double *holding_forces(const cau_reference_case *c)
{
	double *force = calloc((size_t)c->vertex_count * 3, sizeof *force);
	assert_non_null(force);
	for (int32_t t = 0; t < c->tetrahedron_count; ++t)
		assert_true(add_tetrahedron(c, t, force) > 0);
	return force;
}

static double norm(const double v[3])
{
	return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

// Sums the forces at `vertices` into `sum` and clears them. Returns the sum of their sizes.
static double take(double *force, const int32_t *vertices, int32_t count, double sum[3])
{
	double size = 0;
	for (int32_t i = 0; i < count; ++i) {
		double *f = force + 3 * (ptrdiff_t)vertices[i];
		size += norm(f);
		for (int a = 0; a < 3; ++a) {
			sum[a] += f[a];
			f[a] = 0;
		}
	}
	return size;
}

static void assert_same_force(const double a[3], const double b[3], double tolerance)
{
	double difference[3] = {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
	assert_true(norm(difference) < tolerance);
}

// Checks that every contact force pushes along the sphere's normal and has the value in the file.
static void check_contacts(const cau_reference_case *c, const double *force, double tolerance)
{
	for (int32_t i = 0; i < c->contact_count; ++i) {
		ptrdiff_t at = 3 * (ptrdiff_t)c->contact[i];
		double expected[3];
		assert_true(c->contact_force_n[i] > 0);
		for (int a = 0; a < 3; ++a) {
			double x = c->position[at + a] + c->displacement[at + a];
			expected[a] = c->contact_force_n[i] * (x - c->sphere_center_m[a]) / c->sphere_radius_m;
		}
		assert_same_force(force + at, expected, tolerance);
	}
}

// Returns the largest force (N) on a vertex without support, after the supports' forces are
// removed.
static double unbalanced(const cau_reference_case *c, double *support_force)
{
	double *force = holding_forces(c), sum[3] = {0}, largest = 0;
	*support_force = take(force, c->fixed, c->fixed_count, sum) +
	                 take(force, c->prescribed, c->prescribed_count, sum) +
	                 take(force, c->contact, c->contact_count, sum);
	for (int32_t v = 0; v < c->vertex_count; ++v)
		largest = fmax(largest, norm(force + 3 * (ptrdiff_t)v));
	free(force);
	return largest;
}

// ---- the committed cases ------------------------------------------------------------------------
static void read_case(const char *name, cau_reference_case *c)
{
	char path[512];
	cau_error error = {0};
	snprintf(path, sizeof path, "%s/%s.case", CAU_TEST_REFERENCE, name);
	cau_status status = cau_reference_case_read(path, c, &error);
	if (status)
		fail_msg("%s: %s: %s", path, error.path, error.reason);
	assert_string_equal(c->name, name);
}

static void check_supports(const cau_reference_case *c)
{
	assert_true(c->fixed_count > 0);
	for (int32_t i = 0; i < c->fixed_count; ++i)
		assert_true(norm(c->displacement + 3 * (ptrdiff_t)c->fixed[i]) <= 0);
	for (int32_t i = 0; i < c->prescribed_count; ++i)
		assert_memory_equal(c->displacement + 3 * (ptrdiff_t)c->prescribed[i],
		                    c->prescribed_move + 3 * (ptrdiff_t)i, 3 * sizeof(double));
}

static void check_forces(const cau_reference_case *c)
{
	double *force = holding_forces(c), support = 0;
	assert_true(unbalanced(c, &support) < FORCE_TOLERANCE * support);
	double tolerance = FORCE_TOLERANCE * support, reaction[3] = {0}, hold[3] = {0},
		   contact[3] = {0};
	check_contacts(c, force, tolerance);
	take(force, c->fixed, c->fixed_count, reaction);
	take(force, c->prescribed, c->prescribed_count, hold);
	take(force, c->contact, c->contact_count, contact);
	assert_same_force(reaction, c->reaction_n, tolerance);
	assert_same_force(hold, c->hold_n, tolerance);
	assert_same_force(contact, c->contact_n, tolerance);
	free(force);
}

static void test_cases_are_equilibria(void **state)
{
	(void)state;
	for (size_t i = 0; i < sizeof NAMES / sizeof *NAMES; ++i) {
		cau_reference_case c;
		read_case(NAMES[i], &c);
		assert_true(c.residual < 1e-10);
		check_supports(&c);
		check_forces(&c);
		cau_reference_case_finish(&c);
	}
}

// Moves the last free vertex by a thousandth of the largest displacement.
static void disturb(cau_reference_case *c)
{
	double *force = calloc((size_t)c->vertex_count * 3, sizeof *force), unused[3] = {0},
		   largest = 0;
	assert_non_null(force);
	for (int32_t v = 0; v < c->vertex_count; ++v) {
		force[3 * (ptrdiff_t)v] = 1; // marks the vertices without support
		largest = fmax(largest, norm(c->displacement + 3 * (ptrdiff_t)v));
	}
	take(force, c->fixed, c->fixed_count, unused);
	take(force, c->prescribed, c->prescribed_count, unused);
	take(force, c->contact, c->contact_count, unused);
	int32_t last = c->vertex_count - 1;
	while (last >= 0 && force[3 * (ptrdiff_t)last] <= 0)
		--last;
	assert_true(last >= 0);
	c->displacement[3 * (ptrdiff_t)last + 2] += 1e-3 * largest;
	free(force);
}

// Moving one vertex by the tolerance of the comparison with the solver already breaks the
// equilibrium.
static void test_a_wrong_answer_is_no_equilibrium(void **state)
{
	(void)state;
	for (size_t i = 0; i < sizeof NAMES / sizeof *NAMES; ++i) {
		cau_reference_case c;
		double support = 0;
		read_case(NAMES[i], &c);
		disturb(&c);
		assert_true(unbalanced(&c, &support) > 10 * FORCE_TOLERANCE * support);
		cau_reference_case_finish(&c);
	}
}

static void test_no_vertex_is_inside_the_sphere(void **state)
{
	(void)state;
	int32_t touching = 0;
	for (size_t i = 0; i < sizeof NAMES / sizeof *NAMES; ++i) {
		cau_reference_case c;
		read_case(NAMES[i], &c);
		for (int32_t v = 0; c.sphere_radius_m > 0 && v < c.vertex_count; ++v) {
			double d[3];
			for (int a = 0; a < 3; ++a)
				d[a] = c.position[3 * v + a] + c.displacement[3 * v + a] - c.sphere_center_m[a];
			assert_true(norm(d) > c.sphere_radius_m * (1 - GAP_TOLERANCE));
			touching += norm(d) < c.sphere_radius_m * (1 + GAP_TOLERANCE);
		}
		touching -= c.contact_count;
		cau_reference_case_finish(&c);
	}
	assert_int_equal(touching, 0); // all touching vertices are in the file's list
}

// ---- refusals -----------------------------------------------------------------------------------
static cau_status read_text(const char *text, cau_error *error)
{
	char path[] = "/tmp/cautery-case-XXXXXX";
	int descriptor = mkstemp(path);
	assert_true(descriptor >= 0);
	assert_int_equal(write(descriptor, text, strlen(text)), (ssize_t)strlen(text));
	close(descriptor);
	cau_reference_case c;
	cau_status status = cau_reference_case_read(path, &c, error);
	cau_reference_case_finish(&c);
	unlink(path);
	return status;
}

#define HEAD                                                                                       \
	"cautery-reference 1\nname small\nmodel stvk\nyoung_modulus_pa 1\npoisson_ratio 0.3\n"         \
	"density_kg_m3 1\ngravity_m_s2 0 0 0\nsphere_m 0 0 0 0\nresidual 0\nmeasure 1\n"               \
	"measure_converged 1\nreaction_n 0 0 0\nhold_n 0 0 0\ncontact_n 0 0 0\n"                       \
	"vertices 4\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n"
#define TAIL "fixed 1\n0\nprescribed 0\ncontacts 0\ndisplacements 4\n0 0 0\n0 0 0\n0 0 0\n0 0 0\n"

static void test_bad_files_are_refused(void **state)
{
	(void)state;
	cau_error error = {0};
	assert_int_equal(read_text(HEAD "tetrahedra 1\n0 1 2 3\n" TAIL "end\n", &error), CAU_OK);
	assert_int_equal(read_text(HEAD "tetrahedra 1\n0 1 2 3\n" TAIL, &error), CAU_BAD_SYNTAX);
	assert_string_equal(error.path, "end");
	assert_int_equal(read_text(HEAD "tetrahedra 1\n0 1 2 4\n" TAIL "end\n", &error), CAU_BAD_VALUE);
	assert_string_equal(error.path, "tetrahedra");
	assert_int_equal(read_text(HEAD "tetrahedra 2\n0 1 2 3\n" TAIL "end\n", &error),
	                 CAU_BAD_SYNTAX);
	assert_int_equal(read_text("cautery-reference 2\n", &error), CAU_UNSUPPORTED);
	cau_reference_case c;
	assert_int_equal(cau_reference_case_read("/nowhere", &c, &error), CAU_IO);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_cases_are_equilibria),
		cmocka_unit_test(test_a_wrong_answer_is_no_equilibrium),
		cmocka_unit_test(test_no_vertex_is_inside_the_sphere),
		cmocka_unit_test(test_bad_files_are_refused),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
