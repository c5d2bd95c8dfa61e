// SPDX-License-Identifier: GPL-3.0-or-later
// Each iteration linearises what the points may not do, n . d >= -gap, and solves for the increment
// d by the Hessian's factor and the points' own dense system: the reactions are those of a linear
// complementarity problem in H^-1, found by an active set of their own. The ball's curvature is
// part of the Hessian (that of the Lagrangian), so it converges quadratically where points are
// vertices.
#include "reference/indented.h"

#include <cholmod.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cautery/scene.h"
#include "reference/stress.h"

enum { MOST_POINTS = 1500, MOST_ITERATIONS = 60, MOST_CHANGES = 100 };
static const double converged = 1e-8; // of the ball's force; a gap, of its radius
static const double near = 0.01;      // of the radius: points that may come to push

typedef struct point { // on a vertex, an edge or a face: those with a weight are its own
	int32_t vertex[3];
	double weight[3];
	double normal[3], gap_m, reaction_n;
} point;

typedef struct solver {
	const cau_indented_body *body;
	const cau_indenting_ball *ball;
	double *position;
	double *gradient; // N, (n x 3)
	int32_t *unknown; // (n): of its x; -1: fixed
	int32_t unknown_count;
	point *point;
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

// Gradients (1/m) of the four corners' shapes; returns the volume (m^3).
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

typedef struct tangent { // what dP is made of (Pa), and F
	double plain, outer, volume, bulge;
	double f[3][3], cofactor[3][3];
} tangent;

// Rows of the cofactor are cross products of F's other two rows.
static void cofactor_of(double f[3][3], double out[3][3])
{
	for (int i = 0; i < 3; i++)
		cross(f[(i + 1) % 3], f[(i + 2) % 3], out[i]);
}

static tangent tangent_of(const cau_indented_body *body, double f[3][3])
{
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

// dP of dF, which has the row `i` alone.
static void change_of_stress(const tangent *t, int i, const double row[3], double out[3][3])
{
	double along = dot(t->f[i], row), grown = dot(t->cofactor[i], row), turned[2][3];
	cross(t->f[(i + 2) % 3], row, turned[0]); // of the cofactor's rows i + 1 and i + 2
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
	if (row < column) // CHOLMOD reads the lower half
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
	cau_reference_stress(CAU_MODEL_NEOHOOKEAN, body->young_modulus_pa, body->poisson_ratio, f,
	                     stress);
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

// Vertices in order, those without a weight last: the same point is the same to the bit.
static void sort_point(point *p)
{
	for (int k = 0; k < 3; k++)
		if (p->weight[k] == 0)
			p->vertex[k] = INT32_MAX;
	for (int a = 0; a < 2; a++)
		for (int b = 0; b < 2 - a; b++)
			if (p->vertex[b] > p->vertex[b + 1]) {
				int32_t v = p->vertex[b];
				double w = p->weight[b];
				p->vertex[b] = p->vertex[b + 1];
				p->weight[b] = p->weight[b + 1];
				p->vertex[b + 1] = v;
				p->weight[b + 1] = w;
			}
}

static bool is_listed(const point *list, int count, const point *p, double *reaction_n)
{
	for (int k = 0; k < count; k++)
		if (!memcmp(list[k].vertex, p->vertex, sizeof p->vertex) &&
		    !memcmp(list[k].weight, p->weight, sizeof p->weight)) {
			*reaction_n = list[k].reaction_n;
			return true;
		}
	return false;
}

static void add_point(solver *s, const point *before, int before_count, point p)
{
	double x[3] = {0, 0, 0}, already;
	sort_point(&p);
	for (int k = 0; k < 3; k++)
		for (int c = 0; c < 3 && p.weight[k] > 0; c++)
			x[c] += p.weight[k] * s->position[3 * (size_t)p.vertex[k] + (size_t)c];
	minus(x, s->ball->centre_m, p.normal);
	double length = sqrt(dot(p.normal, p.normal));
	p.gap_m = length - s->ball->radius_m;
	if (p.gap_m > near * s->ball->radius_m || s->point_count == MOST_POINTS ||
	    is_listed(s->point, s->point_count, &p, &already))
		return;
	for (int c = 0; c < 3; c++)
		p.normal[c] /= length;
	p.reaction_n = 0;
	is_listed(before, before_count, &p, &p.reaction_n);
	s->point[s->point_count++] = p;
}

static void find_points(solver *s)
{
	const cau_indented_body *body = s->body;
	int count = s->point_count;
	point *before = malloc((size_t)count * sizeof *before + 1);
	memcpy(before, s->point, (size_t)count * sizeof *before);
	s->point_count = 0;
	for (int32_t k = 0; k < body->surface_count; k++) {
		int32_t v = body->surface[k];
		if (!body->fixed[v])
			add_point(s, before, count, (point){.vertex = {v, v, v}, .weight = {1, 0, 0}});
	}
	for (int32_t k = 0; k < s->ball->point_count; k++) {
		point p = {.reaction_n = 0};
		memcpy(p.vertex, s->ball->point[k].vertex, sizeof p.vertex);
		memcpy(p.weight, s->ball->point[k].weight, sizeof p.weight);
		add_point(s, before, count, p);
	}
	free(before);
}

// How the normals turn, of the Lagrangian's Hessian: what pushes lets a point slide off the ball.
static void add_curvature(solver *s, const point *p)
{
	double by = -p->reaction_n / (p->gap_m + s->ball->radius_m);
	for (int a = 0; a < 3; a++)
		for (int b = 0; b < 3; b++)
			for (int i = 0; i < 3; i++)
				for (int j = 0; j < 3 && p->weight[a] > 0 && p->weight[b] > 0; j++)
					if (s->unknown[p->vertex[a]] >= 0 && s->unknown[p->vertex[b]] >= 0)
						add_entry(s, s->unknown[p->vertex[b]] + j, s->unknown[p->vertex[a]] + i,
						          by * p->weight[a] * p->weight[b] *
						              ((i == j) - p->normal[i] * p->normal[j]));
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

// What is left on the vertices, and by how much points are inside, or push from outside.
static void measure(const solver *s, cau_indented *out)
{
	size_t n = 3 * (size_t)s->body->vertex_count;
	double *left = malloc(n * sizeof *left);
	memcpy(left, s->gradient, n * sizeof *left);
	*out = (cau_indented){.iterations = out->iterations};
	for (int k = 0; k < s->point_count; k++) {
		const point *p = &s->point[k];
		out->points += p->reaction_n > 0;
		out->deepest_m = fmax(out->deepest_m, p->reaction_n > 0 ? fabs(p->gap_m) : -p->gap_m);
		for (int c = 0; c < 3; c++) {
			out->force_n[c] -= p->reaction_n * p->normal[c];
			for (int a = 0; a < 3 && p->weight[a] > 0; a++)
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

// x of the symmetric positive definite system of those that push; A is destroyed.
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

// Reactions >= 0 and gaps S r + b >= 0, of which one is zero for each point. Who pulls is let go,
// who is inside is taken.
static bool find_reactions(point *list, int n, const double *s, const double *b)
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

// The points' normals as columns, and behind them minus the gradient.
static cholmod_dense *right_sides(solver *s)
{
	size_t rows = (size_t)s->unknown_count;
	cholmod_dense *sides =
		cholmod_zeros(rows, (size_t)s->point_count + 1, CHOLMOD_REAL, &s->common);
	double *x = sides->x, *last = x + rows * (size_t)s->point_count;
	for (int k = 0; k < s->point_count; k++)
		for (int a = 0; a < 3; a++)
			for (int c = 0; c < 3 && s->point[k].weight[a] > 0; c++)
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

// Moves what is free by what the linearised problem says; its reactions are the points'.
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
		find_points(&s);
		assemble(&s, true);
		measure(&s, out);
		done = out->iterations > 0 && out->residual < converged &&
		       out->deepest_m < converged * ball->radius_m;
		if (done || out->iterations == MOST_ITERATIONS)
			break;
		right = factorise(&s);
		if (!right) { // far from the solution what pushes may outweigh the tissue
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
