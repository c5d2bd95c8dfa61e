// SPDX-License-Identifier: GPL-3.0-or-later
// Newton's method for the indented body. Each iteration linearises the constraints of the points, n
// . d >= -gap. It solves for the increment d with the factor of the Hessian and a dense system of
// the points. The reactions are the solution of a linear complementarity problem in H^-1, found by
// an active set. The Hessian is that of the Lagrangian, which includes the ball's curvature, so the
// iteration converges quadratically.
#include "reference/indented.h"

#include <cholmod.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cautery/scene.h"
#include "reference/stress.h"
#include "reference/touching.h"

enum { MOST_POINTS = 1500, MOST_ITERATIONS = 60, MOST_CHANGES = 100 };
// Largest residual of a converged solution, relative to the ball's force, and largest violation of
// a gap, relative to the ball's radius.
static const double converged = 1e-8;

typedef struct solver {
	const cau_indented_body *body;
	const cau_indenting_ball *ball;
	double *position;
	double *gradient; // N, (n x 3)
	int32_t *unknown; // (n): index of the vertex's x coordinate among the unknowns, or -1 if the
	                  // vertex is fixed
	int32_t unknown_count;
	cau_touching_point *point;
	int point_count;
	cholmod_common common;
	cholmod_triplet *entries;
	cholmod_factor *factor;
} solver;

static double dot(const double a[3], const double b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void cross(const double a[3], const double b[3], double out[3])
{
	out[0] = a[1] * b[2] - a[2] * b[1];
	out[1] = a[2] * b[0] - a[0] * b[2];
	out[2] = a[0] * b[1] - a[1] * b[0];
}

static void minus(const double a[3], const double b[3], double out[3])
{
	for (int c = 0; c < 3; c++)
		out[c] = a[c] - b[c];
}

// ---- elements

// Computes the gradients (1/m) of the shape functions of the four corners. Returns the volume
// (m^3).
static double shapes(const cau_indented_body *body, const int32_t v[4], double shape[4][3])
{
	double edge[3][3];
	for (int k = 0; k < 3; k++)
		minus(body->rest + 3 * (size_t)v[k + 1], body->rest + 3 * (size_t)v[0], edge[k]);
	cross(edge[1], edge[2], shape[1]);
	cross(edge[2], edge[0], shape[2]);
	cross(edge[0], edge[1], shape[3]);
	double six = dot(edge[0], shape[1]);
	for (int c = 0; c < 3; c++) {
		for (int k = 1; k < 4; k++)
			shape[k][c] /= six;
		shape[0][c] = -shape[1][c] - shape[2][c] - shape[3][c];
	}
	return six / 6;
}

static void deformation(const double *position, const int32_t v[4], double shape[4][3],
                        double f[3][3])
{
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++) {
			f[i][j] = 0;
			for (int a = 0; a < 4; a++)
				f[i][j] += position[3 * (size_t)v[a] + (size_t)i] * shape[a][j];
		}
}

// The deformation gradient F, and the coefficients (Pa) of dP, the change of stress.
typedef struct tangent {
	bool stvk;
	double plain, outer, volume, bulge; // for stvk, `plain` is mu and `volume` is lambda
	double f[3][3], cofactor[3][3];
	double second[3][3]; // second Piola-Kirchhoff stress, for stvk
} tangent;

// The rows of the cofactor matrix are cross products of the two other rows of F.
static void cofactor_of(double f[3][3], double out[3][3])
{
	for (int i = 0; i < 3; i++)
		cross(f[(i + 1) % 3], f[(i + 2) % 3], out[i]);
}

// The stress is 2 mu E + lambda tr E, with E = (F^T F - I) / 2.
static tangent stvk_tangent_of(const cau_indented_body *body, double f[3][3])
{
	double nu = body->poisson_ratio, mu = body->young_modulus_pa / (2 * (1 + nu));
	tangent t = {.stvk = true, .plain = mu, .volume = 2 * mu * nu / (1 - 2 * nu)};
	memcpy(t.f, f, sizeof t.f);
	double trace = 0.5 * (dot(f[0], f[0]) + dot(f[1], f[1]) + dot(f[2], f[2]) - 3);
	for (int j = 0; j < 3; j++)
		for (int k = 0; k < 3; k++) {
			double square = f[0][j] * f[0][k] + f[1][j] * f[1][k] + f[2][j] * f[2][k];
			t.second[j][k] = mu * (square - (j == k)) + t.volume * trace * (j == k);
		}
	return t;
}

static tangent tangent_of(const cau_indented_body *body, double f[3][3])
{
	if (body->model == CAU_MODEL_STVK)
		return stvk_tangent_of(body, f);
	double nu = body->poisson_ratio, mu = body->young_modulus_pa / (2 * (1 + nu));
	double m = 4.0 / 3 * mu, l = 2 * mu * nu / (1 - 2 * nu) + 5.0 / 6 * mu;
	double alpha = 1 + m / l - m / (4 * l);
	double trace = dot(f[0], f[0]) + dot(f[1], f[1]) + dot(f[2], f[2]);
	tangent t = {.plain = m * (1 - 1 / (trace + 1)),
	             .outer = 2 * m / ((trace + 1) * (trace + 1)),
	             .volume = l,
	             .bulge = l * (cau_reference_determinant(f) - alpha)};
	memcpy(t.f, f, sizeof t.f);
	cofactor_of(f, t.cofactor);
	return t;
}

static void stvk_change_of_stress(const tangent *t, int i, const double row[3], double out[3][3])
{
	double along = dot(row, t->f[i]);
	for (int r = 0; r < 3; r++)
		for (int c = 0; c < 3; c++) {
			out[r][c] =
				t->volume * along * t->f[r][c] +
				t->plain * (dot(t->f[r], row) * t->f[i][c] + dot(t->f[r], t->f[i]) * row[c]);
			out[r][c] += r == i ? dot(row, t->second[c]) : 0;
		}
}

// Computes dP for a dF whose only nonzero row is `i`.
static void change_of_stress(const tangent *t, int i, const double row[3], double out[3][3])
{
	if (t->stvk) {
		stvk_change_of_stress(t, i, row, out);
		return;
	}
	double along = dot(t->f[i], row), grown = dot(t->cofactor[i], row), turned[2][3];
	cross(t->f[(i + 2) % 3], row, turned[0]); // changes of the cofactor's rows i + 1 and i + 2
	cross(row, t->f[(i + 1) % 3], turned[1]);
	for (int r = 0; r < 3; r++)
		for (int c = 0; c < 3; c++)
			out[r][c] = t->outer * along * t->f[r][c] + t->volume * grown * t->cofactor[r][c];
	for (int c = 0; c < 3; c++) {
		out[i][c] += t->plain * row[c];
		out[(i + 1) % 3][c] += t->bulge * turned[0][c];
		out[(i + 2) % 3][c] += t->bulge * turned[1][c];
	}
}

static void add_entry(solver *s, int32_t row, int32_t column, double value)
{
	if (row < column) // CHOLMOD reads only the lower half
		return;
	size_t at = s->entries->nnz++;
	((int *)s->entries->i)[at] = row;
	((int *)s->entries->j)[at] = column;
	((double *)s->entries->x)[at] = value;
}

static void add_element(solver *s, const int32_t v[4])
{
	double shape[4][3], f[3][3], stress[3][3], change[3][3];
	const cau_indented_body *body = s->body;
	double volume = shapes(body, v, shape);
	deformation(s->position, v, shape, f);
	cau_reference_stress(body->model, body->young_modulus_pa, body->poisson_ratio, f, stress);
	tangent t = tangent_of(body, f);
	for (int a = 0; a < 4; a++)
		for (int i = 0; i < 3; i++) {
			s->gradient[3 * (size_t)v[a] + (size_t)i] += volume * dot(stress[i], shape[a]);
			if (s->unknown[v[a]] < 0)
				continue;
			change_of_stress(&t, i, shape[a], change);
			for (int b = 0; b < 4; b++)
				for (int j = 0; j < 3 && s->unknown[v[b]] >= 0; j++)
					add_entry(s, s->unknown[v[b]] + j, s->unknown[v[a]] + i,
					          volume * dot(change[j], shape[b]));
		}
}

// ---- points

// Adds the part of the Lagrangian's Hessian that comes from the turning normals: a pushing point
// can slide off the ball.
static void add_curvature(solver *s, const cau_touching_point *p)
{
	double bend[3][3];
	for (int a = 0; a < p->corners; a++)
		for (int b = 0; b < p->corners; b++) {
			int32_t column = s->unknown[p->vertex[a]], row = s->unknown[p->vertex[b]];
			cau_touching_bend(p, b, a, bend);
			for (int i = 0; i < 3 && row >= 0 && column >= 0; i++)
				for (int j = 0; j < 3; j++)
					add_entry(s, row + i, column + j, -p->reaction_n * bend[i][j]);
		}
}

// ---- an iteration

static void assemble(solver *s, bool curved)
{
	const cau_indented_body *body = s->body;
	memset(s->gradient, 0, 3 * (size_t)body->vertex_count * sizeof(double));
	s->entries->nnz = 0;
	for (int32_t t = 0; t < body->tetrahedron_count; t++)
		add_element(s, body->tetrahedron + 4 * (size_t)t);
	for (int k = 0; k < s->point_count && curved; k++)
		add_curvature(s, &s->point[k]);
}

static bool factorise(solver *s)
{
	cholmod_sparse *matrix = cholmod_triplet_to_sparse(s->entries, 0, &s->common);
	if (!s->factor)
		s->factor = cholmod_analyze(matrix, &s->common);
	cholmod_factorize(matrix, s->factor, &s->common);
	cholmod_free_sparse(&matrix, &s->common);
	return s->common.status == CHOLMOD_OK && s->factor->minor == s->factor->n;
}

// Measures the largest unbalanced force on a vertex and the largest violation of the points'
// constraints.
static void measure(const solver *s, cau_indented *out)
{
	size_t n = 3 * (size_t)s->body->vertex_count;
	double *left = malloc(n * sizeof *left);
	memcpy(left, s->gradient, n * sizeof *left);
	*out = (cau_indented){.iterations = out->iterations};
	for (int k = 0; k < s->point_count; k++) {
		const cau_touching_point *p = &s->point[k];
		out->points += p->reaction_n > 0;
		out->deepest_m = fmax(out->deepest_m, p->reaction_n > 0 ? fabs(p->gap_m) : -p->gap_m);
		for (int c = 0; c < 3; c++) {
			out->force_n[c] -= p->reaction_n * p->normal[c];
			for (int a = 0; a < p->corners; a++)
				left[3 * (size_t)p->vertex[a] + (size_t)c] -=
					p->weight[a] * p->reaction_n * p->normal[c];
		}
	}
	for (size_t v = 0; v < (size_t)s->body->vertex_count; v++)
		if (!s->body->fixed[v])
			out->residual = fmax(out->residual, sqrt(dot(left + 3 * v, left + 3 * v)));
	out->residual /= fmax(sqrt(dot(out->force_n, out->force_n)), 1e-12);
	free(left);
}

// Solves the symmetric positive definite system of the pushing points for x. A is destroyed.
static bool solve_dense(double *a, double *x, int n)
{
	for (int j = 0; j < n; j++) {
		for (int k = 0; k < j; k++)
			a[j * n + j] -= a[j * n + k] * a[j * n + k];
		if (!(a[j * n + j] > 0))
			return false;
		a[j * n + j] = sqrt(a[j * n + j]);
		for (int i = j + 1; i < n; i++) {
			for (int k = 0; k < j; k++)
				a[i * n + j] -= a[i * n + k] * a[j * n + k];
			a[i * n + j] /= a[j * n + j];
		}
	}
	for (int i = 0; i < n; i++) {
		for (int k = 0; k < i; k++)
			x[i] -= a[i * n + k] * x[k];
		x[i] /= a[i * n + i];
	}
	for (int i = n - 1; i >= 0; i--) {
		for (int k = i + 1; k < n; k++)
			x[i] -= a[k * n + i] * x[k];
		x[i] /= a[i * n + i];
	}
	return true;
}

// Finds reactions r >= 0 and gaps S r + b >= 0 of which one is zero at each point. Each round
// releases points that pull and adds points that are inside.
static bool find_reactions(cau_touching_point *list, int n, const double *s, const double *b)
{
	size_t many = (size_t)n;
	double *a = malloc(many * many * sizeof *a + 1), *x = malloc(many * sizeof *x + 1);
	int *at = calloc(many + 1, sizeof *at);
	bool right = false, *pushes = malloc(many + 1);
	for (int k = 0; k < n; k++)
		pushes[k] = list[k].reaction_n > 0 || b[k] < 0;
	for (int change = 0; change < MOST_CHANGES && !right; change++) {
		int m = 0;
		for (int k = 0; k < n; k++)
			if (pushes[k])
				at[m++] = k;
		for (int i = 0; i < m; i++) {
			x[i] = -b[at[i]];
			for (int j = 0; j < m; j++)
				a[i * m + j] = s[at[i] * n + at[j]] * (i == j ? 1 + 1e-12 : 1);
		}
		if (!solve_dense(a, x, m))
			break;
		for (int k = 0; k < n; k++)
			list[k].reaction_n = 0;
		for (int i = 0; i < m; i++)
			list[at[i]].reaction_n = x[i];
		right = true;
		for (int k = 0; k < n; k++) {
			double gap = b[k];
			for (int i = 0; i < m; i++)
				gap += s[k * n + at[i]] * x[i];
			bool wanted = pushes[k] ? list[k].reaction_n > 0 : gap < 0;
			right = right && wanted == pushes[k];
			pushes[k] = wanted;
		}
	}
	free(a);
	free(x);
	free(at);
	free(pushes);
	return right;
}

// Returns the points' normals as columns, followed by minus the gradient.
static cholmod_dense *right_sides(solver *s)
{
	size_t rows = (size_t)s->unknown_count;
	cholmod_dense *sides =
		cholmod_zeros(rows, (size_t)s->point_count + 1, CHOLMOD_REAL, &s->common);
	double *x = sides->x, *last = x + rows * (size_t)s->point_count;
	for (int k = 0; k < s->point_count; k++)
		for (int a = 0; a < s->point[k].corners; a++)
			for (int c = 0; c < 3; c++)
				if (s->unknown[s->point[k].vertex[a]] >= 0)
					x[(size_t)k * rows + (size_t)(s->unknown[s->point[k].vertex[a]] + c)] +=
						s->point[k].weight[a] * s->point[k].normal[c];
	for (size_t v = 0; v < (size_t)s->body->vertex_count; v++)
		for (int c = 0; c < 3 && s->unknown[v] >= 0; c++)
			last[s->unknown[v] + c] = -s->gradient[3 * v + (size_t)c];
	return sides;
}

static double dot_of(const double *a, const double *b, size_t n)
{
	double sum = 0;
	for (size_t i = 0; i < n; i++)
		sum += a[i] * b[i];
	return sum;
}

// Moves the free vertices by the solution of the linearised problem, and stores its reactions in
// the points.
static bool move(solver *s)
{
	size_t rows = (size_t)s->unknown_count, n = (size_t)s->point_count;
	cholmod_dense *sides = right_sides(s);
	cholmod_dense *answers = cholmod_solve(CHOLMOD_A, s->factor, sides, &s->common);
	double *y = answers->x, *columns = sides->x, *free_way = y + rows * n;
	double *system = calloc(n * n + n + 1, sizeof *system), *gap = system + n * n;
	for (size_t k = 0; k < n; k++) {
		gap[k] = s->point[k].gap_m + dot_of(columns + k * rows, free_way, rows);
		for (size_t j = 0; j < n; j++)
			system[k * n + j] = dot_of(columns + k * rows, y + j * rows, rows);
	}
	bool found = find_reactions(s->point, s->point_count, system, gap);
	for (size_t k = 0; k < n; k++)
		for (size_t i = 0; i < rows; i++)
			free_way[i] += s->point[k].reaction_n * y[k * rows + i];
	for (size_t v = 0; v < (size_t)s->body->vertex_count; v++)
		for (int c = 0; c < 3 && s->unknown[v] >= 0; c++)
			s->position[3 * v + (size_t)c] += free_way[s->unknown[v] + c];
	free(system);
	cholmod_free_dense(&sides, &s->common);
	cholmod_free_dense(&answers, &s->common);
	return found;
}

static void begin(solver *s)
{
	const cau_indented_body *body = s->body;
	size_t n = (size_t)body->vertex_count;
	s->gradient = malloc(3 * n * sizeof *s->gradient);
	s->unknown = malloc(n * sizeof *s->unknown);
	s->point = malloc(MOST_POINTS * sizeof *s->point);
	for (size_t v = 0; v < n; v++) {
		s->unknown[v] = body->fixed[v] ? -1 : s->unknown_count;
		s->unknown_count += body->fixed[v] ? 0 : 3;
	}
	size_t most = 144 * (size_t)body->tetrahedron_count + 81 * (size_t)MOST_POINTS;
	cholmod_start(&s->common);
	s->common.print = 0;
	s->entries = cholmod_allocate_triplet((size_t)s->unknown_count, (size_t)s->unknown_count, most,
	                                      -1, CHOLMOD_REAL, &s->common);
}

static void end(solver *s)
{
	cholmod_free_triplet(&s->entries, &s->common);
	cholmod_free_factor(&s->factor, &s->common);
	cholmod_finish(&s->common);
	free(s->gradient);
	free(s->unknown);
	free(s->point);
}

bool cau_indented_solve(const cau_indented_body *body, const cau_indenting_ball *ball,
                        double *position, cau_indented *out)
{
	solver s = {.body = body, .ball = ball, .position = position};
	bool done = false, right = true;
	*out = (cau_indented){0};
	begin(&s);
	for (; right; out->iterations++) {
		s.point_count =
			cau_touching_find(body, ball, position, s.point, s.point_count, MOST_POINTS);
		assemble(&s, true);
		measure(&s, out);
		done = out->iterations > 0 && out->residual < converged &&
		       out->deepest_m < converged * ball->radius_m;
		if (done || out->iterations == MOST_ITERATIONS)
			break;
		right = factorise(&s);
		// Far from the solution the curvature of pushing points may make the Hessian indefinite.
		// Then the curvature is left out.
		if (!right) {
			assemble(&s, false);
			right = factorise(&s);
		}
		right = right && move(&s);
	}
	end(&s);
	return done;
}

double cau_indented_by_hertz(double young_modulus_pa, double poisson_ratio, double radius_m,
                             double depth_m, double thickness_m)
{
	const double pi = 3.14159265358979323846;
	double nu = poisson_ratio, x = sqrt(radius_m * depth_m) / thickness_m;
	double a = -(1.2876 - 1.4678 * nu + 1.3442 * nu * nu) / (1 - nu);
	double b = (0.6387 - 1.0277 * nu + 1.5164 * nu * nu) / (1 - nu);
	double cube = a * a * a + 4 * pi * pi / 15 * b, last = a * a * a + 3 * pi * pi / 5 * b;
	double correction = 1 - 2 * a / pi * x + 4 * a * a / (pi * pi) * x * x -
	                    8 / (pi * pi * pi) * cube * x * x * x +
	                    16 * a / (pi * pi * pi * pi) * last * x * x * x * x;
	double hertz = 4 * young_modulus_pa / (3 * (1 - nu * nu)) * sqrt(radius_m) * pow(depth_m, 1.5);
	return hertz * correction;
}
