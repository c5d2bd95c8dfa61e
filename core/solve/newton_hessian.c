// SPDX-License-Identifier: GPL-3.0-or-later
// The Hessian of eq. 4 in blocks: inertia, drag, and of each element w K in its own F, positive
// semidefinite as what is negative is left out.
//
// Of a triangle's target, E = w/2 |F - Q T^(1/2)|^2, Q the polar factor of F T^(1/2) = Q S. When F
// changes by dF, Q turns in its plane by <C, dF> / tr S, C = Q J T^(1/2), J the quarter turn, and
// out of it by S^-1. So K is the identity less C C^T / tr S in the plane, where |C|^2 = tr T, and
// I - T^(1/2) S^-1 T^(1/2) along the normal: in closed form, without eigenvalues of more than
// 2 x 2.
#include <math.h>
#include <string.h>

#include "base/vector.h"
#include "cautery/assert.h"
#include "solve/newton.h"
#include "solve/solver.h"

typedef struct matrix3 {
	double at[3][3];
} matrix3;

// K of a triangle by the columns of F: 00, 11, and 01 (rows of column 0, columns of column 1).
typedef struct sheet_hessian {
	matrix3 k[3];
} sheet_hessian;

typedef struct symmetric2 {
	double a00, a11, a01;
} symmetric2;

static void add_outer(matrix3 *to, double s, cau_vec3 a, cau_vec3 b)
{
	const double x[3] = {a.x, a.y, a.z}, y[3] = {b.x, b.y, b.z};
	for (int r = 0; r < 3; r++)
		for (int c = 0; c < 3; c++)
			to->at[r][c] += s * x[r] * y[c];
}

static void add_identity(matrix3 *to, double s)
{
	for (int c = 0; c < 3; c++)
		to->at[c][c] += s;
}

// What is not negative of a symmetric 2 x 2.
static symmetric2 positive_part(symmetric2 m)
{
	double mean = (m.a00 + m.a11) / 2, half = (m.a00 - m.a11) / 2;
	double away = sqrt(half * half + m.a01 * m.a01), low = mean - away, high = mean + away;
	if (low >= 0)
		return m;
	if (high <= 0)
		return (symmetric2){0};
	double s = high / (2 * away); // high times the projector on its own direction
	return (symmetric2){s * (away + half), s * (away - half), s * m.a01};
}

static symmetric2 sandwich(symmetric2 b, symmetric2 a)
{
	double p00 = b.a00 * a.a00 + b.a01 * a.a01, p01 = b.a00 * a.a01 + b.a01 * a.a11;
	double p10 = b.a01 * a.a00 + b.a11 * a.a01, p11 = b.a01 * a.a01 + b.a11 * a.a11;
	return (symmetric2){p00 * b.a00 + p01 * b.a01, p10 * b.a01 + p11 * b.a11,
	                    p00 * b.a01 + p01 * b.a11};
}

// a x + b y
static cau_vec3 combine(double a, cau_vec3 x, double b, cau_vec3 y)
{
	return (cau_vec3){a * x.x + b * y.x, a * x.y + b * y.y, a * x.z + b * y.z};
}

// Where F has lost rank Q is kept, and K is the identity.
static void add_target(sheet_hessian *to, const cau_vec3 f[2], symmetric2 root)
{
	symmetric2 metric = {cau_dot(f[0], f[0]), cau_dot(f[1], f[1]), cau_dot(f[0], f[1])};
	symmetric2 m = sandwich(root, metric);
	double area = sqrt(fmax(m.a00 * m.a11 - m.a01 * m.a01, 0)), trace = m.a00 + m.a11;
	add_identity(&to->k[0], 1);
	add_identity(&to->k[1], 1);
	if (!(area > 1e-3 * trace)) // as the local step has it
		return;
	double stretches = sqrt(trace + 2 * area); // tr S
	// S^-1, from S = (M + area I) / tr S of determinant `area`
	double s = 1 / (stretches * area);
	symmetric2 inverse = {s * (m.a11 + area), s * (m.a00 + area), -s * m.a01};
	symmetric2 b = sandwich(root, inverse);
	symmetric2 normal = positive_part((symmetric2){1 - b.a00, 1 - b.a11, -b.a01});
	cau_vec3 n = cau_unit_or(cau_cross(f[0], f[1]), (cau_vec3){0});
	add_outer(&to->k[0], normal.a00 - 1, n, n);
	add_outer(&to->k[1], normal.a11 - 1, n, n);
	add_outer(&to->k[2], normal.a01, n, n);
	// Q = F T^(1/2) S^-1, and C = Q J T^(1/2) with J (1, 0) = (0, 1), J (0, 1) = (-1, 0)
	cau_vec3 fr[2] = {combine(root.a00, f[0], root.a01, f[1]),
	                  combine(root.a01, f[0], root.a11, f[1])};
	cau_vec3 q[2] = {combine(inverse.a00, fr[0], inverse.a01, fr[1]),
	                 combine(inverse.a01, fr[0], inverse.a11, fr[1])};
	cau_vec3 c[2] = {combine(root.a00, q[1], -root.a01, q[0]),
	                 combine(root.a01, q[1], -root.a11, q[0])};
	double target = root.a00 * root.a00 + root.a11 * root.a11 + 2 * root.a01 * root.a01;
	double turn = -fmin(1 / stretches, 1 / target);
	add_outer(&to->k[0], turn, c[0], c[0]);
	add_outer(&to->k[1], turn, c[1], c[1]);
	add_outer(&to->k[2], turn, c[0], c[1]);
}

// Strains kept in a range (strain_range.h): of a column beyond it, its direction in full, and
// across it what tension there is.
static void add_stretch(matrix3 *to, cau_vec3 f, double least, double most)
{
	double length = cau_length(f), kept = fmin(fmax(length, least), most);
	if (kept == length || !(length > 0))
		return;
	double across = fmax(1 - kept / length, 0);
	add_identity(to, across);
	add_outer(to, (1 - across) / (length * length), f, f);
}

// Of a shear beyond it, the direction of its residual r alone [Gauss and Newton]: half a squared
// distance has the gradient r, and r / |r| is the gradient of the distance.
static void add_shear(sheet_hessian *to, const cau_vec3 f[2], double most)
{
	double k00 = cau_dot(f[0], f[0]), k11 = cau_dot(f[1], f[1]), k01 = cau_dot(f[0], f[1]);
	double across = sqrt(1 - most * most), a = k00 + k11;
	double area = sqrt(fmax(k00 * k11 - k01 * k01, 0)), x = across * fabs(k01) - most * area;
	double inner = a * a - 4 * x * x;
	if (!(x > 0) || !(area > 1e-5 * a) || !(inner > 1e-10 * a * a))
		return;
	double r = sqrt(inner), slope = x / r, less = 2 * x * x / (a + r) / r;
	double other = slope * (copysign(across, k01) + most * k01 / area);
	cau_vec3 of[2] = {combine(-less - slope * most * k11 / area, f[0], other, f[1]),
	                  combine(-less - slope * most * k00 / area, f[1], other, f[0])};
	double size = cau_dot(of[0], of[0]) + cau_dot(of[1], of[1]);
	if (!(size > 1e-20 * a))
		return;
	add_outer(&to->k[0], 1 / size, of[0], of[0]);
	add_outer(&to->k[1], 1 / size, of[1], of[1]);
	add_outer(&to->k[2], 1 / size, of[0], of[1]);
}

static void add_range(sheet_hessian *to, const cau_vec3 f[2], const cau_sheet_group *group)
{
	for (int a = 0; a < 2; a++)
		add_stretch(&to->k[a], f[a], group->stretch_min[a], group->stretch_max[a]);
	add_shear(to, f, group->shear_max);
}

// Element vertices, G by vertex and column of F, and weight.
typedef struct sheet_element {
	int32_t vertex[3];
	double g[3][2]; // 1/m
	double weight;  // N m
	symmetric2 root;
} sheet_element;

static double get(const cau_step_solver *solver, const void *array, int32_t slot)
{
	return cau_real_get(array, solver->elements.single, slot);
}

static int32_t vertex_of(const cau_elements *elements, const cau_local_work *work, uint16_t record)
{
	return elements->record_vertex[work->first_record + record / 4] / 4;
}

static sheet_element sheet_at(const cau_step_solver *solver, const cau_local_work *work,
                              int32_t slot)
{
	const cau_sheet_set *set = &solver->elements.sheet;
	sheet_element element = {.weight = get(solver, set->weight, slot)};
	for (int i = 0; i < 3; i++)
		element.vertex[i] = vertex_of(&solver->elements, work, set->record_at[i][slot]);
	for (int c = 0; c < 2; c++) {
		element.g[1][c] = get(solver, set->dm_inverse[c], slot);
		element.g[2][c] = get(solver, set->dm_inverse[2 + c], slot);
		element.g[0][c] = -element.g[1][c] - element.g[2][c];
	}
	element.root =
		(symmetric2){get(solver, set->target[0], slot), get(solver, set->target[1], slot),
	                 get(solver, set->target[2], slot)};
	return element;
}

static cau_vec3 place_of(const cau_step_solver *solver, int32_t vertex)
{
	const double *x = solver->position + 3 * (int64_t)vertex;
	return (cau_vec3){x[0], x[1], x[2]};
}

// ---- into H

// H += m in the rows of vertex a and the columns of b, and its transpose where those are not one.
static void add_block(cau_newton *newton, const cau_step_solver *solver, int32_t a, int32_t b,
                      const matrix3 *m)
{
	int32_t row = newton->place[a], column = newton->place[b];
	if (row < 0 || column < 0 || solver->fixed[a] || solver->fixed[b])
		return;
	bool turned = row < column;
	double *to = newton->pivot + (int64_t)CAU_BLOCK * row;
	if (row != column)
		to = newton->block + (int64_t)CAU_BLOCK * cau_pattern_place(newton->first, newton->row,
		                                                            turned ? row : column,
		                                                            turned ? column : row);
	for (int r = 0; r < 3; r++)
		for (int c = 0; c < 3; c++)
			to[4 * c + r] += turned ? m->at[c][r] : m->at[r][c];
}

static void add_sheet(cau_newton *newton, const cau_step_solver *solver,
                      const sheet_element *element, const sheet_hessian *hessian)
{
	for (int i = 0; i < 3; i++)
		for (int j = i; j < 3; j++) {
			const double *a = element->g[i], *b = element->g[j];
			matrix3 m;
			for (int r = 0; r < 3; r++)
				for (int c = 0; c < 3; c++)
					m.at[r][c] = element->weight * (a[0] * b[0] * hessian->k[0].at[r][c] +
					                                a[1] * b[1] * hessian->k[1].at[r][c] +
					                                a[0] * b[1] * hessian->k[2].at[r][c] +
					                                a[1] * b[0] * hessian->k[2].at[c][r]);
			add_block(newton, solver, element->vertex[i], element->vertex[j], &m);
		}
}

static void add_sheets(cau_newton *newton, const cau_step_solver *solver,
                       const cau_local_work *work)
{
	const cau_sheet_group *group = &solver->elements.sheet.group[work->group];
	for (int32_t slot = work->first; slot < work->last; slot++) {
		sheet_element element = sheet_at(solver, work, slot);
		if (!(element.weight > 0))
			continue;
		cau_vec3 x0 = place_of(solver, element.vertex[0]);
		cau_vec3 along[2] = {cau_sub(place_of(solver, element.vertex[1]), x0),
		                     cau_sub(place_of(solver, element.vertex[2]), x0)};
		cau_vec3 f[2];
		for (int c = 0; c < 2; c++)
			f[c] = combine(element.g[1][c], along[0], element.g[2][c], along[1]);
		sheet_hessian hessian = {0};
		if (element.root.a00 > 0)
			add_target(&hessian, f, element.root);
		else if (group->limit == CAU_LIMIT_RANGE)
			add_range(&hessian, f, group);
		add_sheet(newton, solver, &element, &hessian);
	}
}

// w (e e^T / |e|^2 + (1 - L / |e|) (I - e e^T / |e|^2)), the second only where it is stretched: of
// a link, or of the e = sum of c_i x_i that a hinge has.
static matrix3 length_hessian(cau_vec3 e, double rest, double weight)
{
	matrix3 m = {0};
	double length = cau_length(e);
	if (!(rest > 0) || !(length > 0)) {
		add_identity(&m, weight);
		return m;
	}
	double across = fmax(1 - rest / length, 0);
	add_identity(&m, weight * across);
	add_outer(&m, weight * (1 - across) / (length * length), e, e);
	return m;
}

static void add_lengths(cau_newton *newton, const cau_step_solver *solver,
                        const cau_local_work *work)
{
	bool link = work->kind == CAU_ELEMENT_LINK;
	const cau_link_set *links = &solver->elements.link;
	const cau_hinge_set *hinges = &solver->elements.hinge;
	int count = link ? 2 : 4;
	for (int32_t slot = work->first; slot < work->last; slot++) {
		double weight = get(solver, link ? links->weight : hinges->weight, slot), c[4] = {-1, 1};
		int32_t vertex[4];
		cau_vec3 e = {0};
		if (!(weight > 0))
			continue;
		for (int i = 0; i < count; i++) {
			uint16_t record = (link ? links->record_at[i] : hinges->record_at[i])[slot];
			vertex[i] = vertex_of(&solver->elements, work, record);
			if (!link)
				c[i] = get(solver, hinges->coefficient[i], slot);
			e = combine(1, e, c[i], place_of(solver, vertex[i]));
		}
		double rest = get(solver, link ? links->rest_length : hinges->rest_length, slot);
		for (int i = 0; i < count; i++)
			for (int j = i; j < count; j++) {
				matrix3 m = length_hessian(e, rest, weight * c[i] * c[j]);
				add_block(newton, solver, vertex[i], vertex[j], &m);
			}
	}
}

static void add_inertia(cau_newton *newton, const cau_step_solver *solver)
{
	double scale = 1 / (solver->step_s * solver->step_s);
	for (int32_t v = 0; v < solver->tissue->vertex_count; v++) {
		if (newton->place[v] < 0)
			continue;
		double *to = newton->pivot + (int64_t)CAU_BLOCK * newton->place[v];
		for (int c = 0; c < 3; c++)
			to[5 * c] += scale * solver->tissue->mass[v];
	}
	for (int32_t k = 0; k < solver->drag_count; k++) {
		matrix3 m = {0};
		add_identity(&m, solver->drag[k].coefficient);
		add_block(newton, solver, solver->drag[k].vertex, solver->drag[k].vertex, &m);
	}
}

void cau_newton_assemble(cau_newton *newton, const cau_step_solver *solver)
{
	size_t bytes = CAU_BLOCK * sizeof(double);
	memset(newton->block, 0, (size_t)newton->first[newton->n] * bytes);
	memset(newton->pivot, 0, (size_t)newton->n * bytes);
	add_inertia(newton, solver);
	for (int32_t w = 0; w < solver->slots.work_count; w++) {
		const cau_local_work *work = &solver->slots.work[w];
		CAU_ASSERT(work->kind != CAU_ELEMENT_TETRAHEDRON, "fat in Newton's share %d", w);
		if (work->kind == CAU_ELEMENT_TRIANGLE)
			add_sheets(newton, solver, work);
		else
			add_lengths(newton, solver, work);
	}
}
