// SPDX-License-Identifier: GPL-3.0-or-later
// Computes a region's share of eq. 4 in double: energy, gradient and Hessian. The parts are
// inertia, drag, and w K of each element in its own F. Negative eigenvalues of K are replaced by
// their absolute value or by 0.
//
// The energy of a triangle with a target is E = w/2 |F - Q T^(1/2)|^2, where Q is the polar factor
// of F T^(1/2) = Q S. When F changes by dF, Q turns in its plane by <C, dF> / tr S. Here C = Q J
// T^(1/2), and J is the quarter turn. Q turns out of its plane by S^-1. So K in the plane is the
// identity less C C^T / tr S, where |C|^2 = tr T. Along the normal K is I - T^(1/2) S^-1 T^(1/2).
// Both are in closed form; the largest eigenvalue problem is 2 x 2.
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/vector.h"
#include "cautery/assert.h"
#include "solve/newton.h"
#include "solve/solver.h"

typedef struct matrix3 {
	double at[3][3];
} matrix3;

// K of a triangle by the columns of F. k[0] is for column 0 with itself, k[1] for column 1 with
// itself. k[2] has the rows of column 0 and the columns of column 1.
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

// Returns the value by which H replaces an eigenvalue: a negative one is multiplied by -`negative`.
static double counted(double value, double negative)
{
	return value < 0 ? -negative * value : value;
}

// Returns a symmetric 2 x 2 matrix with its eigenvalues replaced by `counted`.
static symmetric2 filtered(symmetric2 m, double negative)
{
	double mean = (m.a00 + m.a11) / 2, half = (m.a00 - m.a11) / 2;
	double away = sqrt(half * half + m.a01 * m.a01);
	double low = counted(mean - away, negative), high = counted(mean + away, negative);
	if (!(away > 0))
		return (symmetric2){high, high, 0};
	double sum = (high + low) / 2, along = (high - low) / (2 * away);
	return (symmetric2){sum + along * half, sum - along * half, along * m.a01};
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

// Result of a triangle's law at F: the residual R = F - P by columns, |R|^2, and K if `to` is not
// NULL.
typedef struct sheet_answer {
	cau_vec3 residual[2];
	double squared;
	sheet_hessian *to;
	double negative; // factor for negative eigenvalues, as in cau_newton
	// Viscosity's stress in the plane, over the element's weight. Across the plane this stress adds
	// to the limit's stiffness. If `across` is true, K already contains this addition.
	symmetric2 tension;
	bool across;
} sheet_answer;

// The polar factor of F T^(1/2) = Q S. If `full` is false, F has not its full rank, and Q is the
// factor that the local step kept.
typedef struct sheet_polar {
	bool full;
	double stretches;   // tr S
	symmetric2 inverse; // the inverse S^-1
	cau_vec3 q[2];
} sheet_polar;

static sheet_polar find_polar(const cau_vec3 f[2], symmetric2 root, const cau_vec3 kept[2])
{
	symmetric2 metric = {cau_dot(f[0], f[0]), cau_dot(f[1], f[1]), cau_dot(f[0], f[1])};
	symmetric2 m = sandwich(root, metric);
	double area = sqrt(fmax(m.a00 * m.a11 - m.a01 * m.a01, 0)), trace = m.a00 + m.a11;
	sheet_polar polar = {.q = {kept[0], kept[1]}};
	polar.full = area > 1e-3 * trace; // the same limit as in the local step
	if (!polar.full)
		return polar;
	polar.stretches = sqrt(trace + 2 * area);
	// S^-1, from S = (M + area I) / tr S of determinant `area`
	double s = 1 / (polar.stretches * area);
	polar.inverse = (symmetric2){s * (m.a11 + area), s * (m.a00 + area), -s * m.a01};
	// Q = F T^(1/2) S^-1
	cau_vec3 fr[2] = {combine(root.a00, f[0], root.a01, f[1]),
	                  combine(root.a01, f[0], root.a11, f[1])};
	polar.q[0] = combine(polar.inverse.a00, fr[0], polar.inverse.a01, fr[1]);
	polar.q[1] = combine(polar.inverse.a01, fr[0], polar.inverse.a11, fr[1]);
	return polar;
}

static symmetric2 normal_stiffness(const sheet_polar *polar, symmetric2 root)
{
	symmetric2 b = sandwich(root, polar->inverse);
	return (symmetric2){1 - b.a00, 1 - b.a11, -b.a01};
}

static void add_target_hessian(sheet_answer *answer, const cau_vec3 f[2], symmetric2 root,
                               const sheet_polar *polar)
{
	sheet_hessian *to = answer->to;
	double negative = answer->negative;
	add_identity(&to->k[0], 1);
	add_identity(&to->k[1], 1);
	if (!polar->full) // the kept Q does not turn, so K is the identity
		return;
	symmetric2 normal = normal_stiffness(polar, root), more = answer->tension;
	normal = (symmetric2){normal.a00 + more.a00, normal.a11 + more.a11, normal.a01 + more.a01};
	normal = filtered(normal, negative);
	answer->across = true;
	cau_vec3 n = cau_unit_or(cau_cross(f[0], f[1]), (cau_vec3){0});
	add_outer(&to->k[0], normal.a00 - 1, n, n);
	add_outer(&to->k[1], normal.a11 - 1, n, n);
	add_outer(&to->k[2], normal.a01, n, n);
	// C = Q J T^(1/2) with J (1, 0) = (0, 1), J (0, 1) = (-1, 0)
	cau_vec3 c[2] = {combine(root.a00, polar->q[1], -root.a01, polar->q[0]),
	                 combine(root.a01, polar->q[1], -root.a11, polar->q[0])};
	double target = root.a00 * root.a00 + root.a11 * root.a11 + 2 * root.a01 * root.a01;
	double turn = (counted(1 - target / polar->stretches, negative) - 1) / target;
	add_outer(&to->k[0], turn, c[0], c[0]);
	add_outer(&to->k[1], turn, c[1], c[1]);
	add_outer(&to->k[2], turn, c[0], c[1]);
}

static void add_target(sheet_answer *answer, const cau_vec3 f[2], symmetric2 root,
                       const cau_vec3 kept[2])
{
	sheet_polar polar = find_polar(f, root, kept);
	answer->residual[0] = cau_sub(f[0], combine(root.a00, polar.q[0], root.a01, polar.q[1]));
	answer->residual[1] = cau_sub(f[1], combine(root.a01, polar.q[0], root.a11, polar.q[1]));
	answer->squared = cau_dot(answer->residual[0], answer->residual[0]) +
	                  cau_dot(answer->residual[1], answer->residual[1]);
	if (answer->to)
		add_target_hessian(answer, f, root, &polar);
}

// Adds K for strains that are limited to a range (strain_limit.h). A column of F beyond the range
// adds stiffness along the column. Across the column it adds the stiffness of its tension or
// pressure.
static void add_stretch(sheet_answer *answer, int a, cau_vec3 f, double least, double most)
{
	double length = cau_length(f), kept = fmin(fmax(length, least), most);
	if (kept == length || !(length > 0))
		return;
	answer->squared += (length - kept) * (length - kept);
	answer->residual[a] = cau_add_scaled(answer->residual[a], 1 - kept / length, f);
	if (!answer->to)
		return;
	double across = fmin(counted(1 - kept / length, answer->negative), 1);
	add_identity(&answer->to->k[a], across);
	add_outer(&answer->to->k[a], (1 - across) / (length * length), f, f);
}

// For a shear beyond the range, adds stiffness only along the residual r [Gauss and Newton]. Half a
// squared distance has the gradient r, and r / |r| is the gradient of the distance.
static void add_shear(sheet_answer *answer, const cau_vec3 f[2], double most)
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
	answer->squared += 2 * x * x / (a + r);
	for (int c = 0; c < 2; c++)
		answer->residual[c] = cau_add(answer->residual[c], of[c]);
	double size = cau_dot(of[0], of[0]) + cau_dot(of[1], of[1]);
	if (!(size > 1e-20 * a) || !answer->to)
		return;
	add_outer(&answer->to->k[0], 1 / size, of[0], of[0]);
	add_outer(&answer->to->k[1], 1 / size, of[1], of[1]);
	add_outer(&answer->to->k[2], 1 / size, of[0], of[1]);
}

static void add_range(sheet_answer *answer, const cau_vec3 f[2], const cau_sheet_group *group)
{
	for (int a = 0; a < 2; a++)
		add_stretch(answer, a, f[a], group->stretch_min[a], group->stretch_max[a]);
	add_shear(answer, f, group->shear_max);
}

// Returns viscosity's tension `share` (E - R), where R is `from`. Viscosity (viscous_kernel.h) has
// the energy `share` / 2 |E - R|^2, times the element's weight. Its Hessian has two parts: that of
// dE, and the tension, whose negative eigenvalues are replaced like all others.
static symmetric2 tension_of(const cau_vec3 f[2], symmetric2 from, double share)
{
	return (symmetric2){share * ((cau_dot(f[0], f[0]) - 1) / 2 - from.a00),
	                    share * ((cau_dot(f[1], f[1]) - 1) / 2 - from.a11),
	                    share * (cau_dot(f[0], f[1]) / 2 - from.a01)};
}

static void add_viscosity(sheet_answer *answer, const cau_vec3 f[2], double share)
{
	symmetric2 s = answer->tension;
	answer->squared += (s.a00 * s.a00 + s.a11 * s.a11 + 2 * s.a01 * s.a01) / share;
	answer->residual[0] = cau_add(answer->residual[0], combine(s.a00, f[0], s.a01, f[1]));
	answer->residual[1] = cau_add(answer->residual[1], combine(s.a01, f[0], s.a11, f[1]));
	if (!answer->to)
		return;
	matrix3 *k = answer->to->k;
	symmetric2 beside = filtered(s, answer->negative);
	cau_vec3 n = cau_unit_or(cau_cross(f[0], f[1]), (cau_vec3){0});
	const double part[3] = {beside.a00, beside.a11, beside.a01};
	for (int a = 0; a < 3; a++) {
		add_identity(&k[a], part[a]);
		if (answer->across)
			add_outer(&k[a], -part[a], n, n);
	}
	for (int a = 0; a < 2; a++) {
		add_outer(&k[a], share, f[a], f[a]);
		add_outer(&k[a], share / 2, f[1 - a], f[1 - a]);
	}
	add_outer(&k[2], share / 2, f[1], f[0]);
}

// A triangle's vertices, G by vertex and column of F, and weight.
typedef struct sheet_element {
	int32_t vertex[3];
	double g[3][2]; // G by vertex, 1/m
	double weight;  // weight of the element, N m
	symmetric2 root;
	cau_vec3 rest[2], kept[2]; // columns of F at rest; columns of the Q that the local step kept
} sheet_element;

static double get(const cau_step_solver *solver, const void *array, int32_t slot)
{
	return cau_real_get(array, solver->elements.single, slot);
}

static cau_vec3 get3(const cau_step_solver *solver, void *const arrays[3], int32_t slot)
{
	return (cau_vec3){get(solver, arrays[0], slot), get(solver, arrays[1], slot),
	                  get(solver, arrays[2], slot)};
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
	for (int c = 0; c < 2; c++) {
		element.rest[c] = get3(solver, set->rest + 3 * c, slot);
		element.kept[c] = get3(solver, set->polar + 3 * c, slot);
	}
	return element;
}

// Returns viscosity's reference strain R.
static symmetric2 strain_at(const cau_step_solver *solver, int32_t slot)
{
	void *const *strain = solver->elements.sheet.strain;
	return (symmetric2){get(solver, strain[0], slot), get(solver, strain[1], slot),
	                    get(solver, strain[2], slot)};
}

// Returns u = x - X, m.
static cau_vec3 displacement_of(const cau_step_solver *solver, int32_t vertex)
{
	const double *x = solver->position + 3 * (int64_t)vertex;
	const double *rest = solver->tissue->rest + 3 * (int64_t)vertex;
	return (cau_vec3){x[0] - rest[0], x[1] - rest[1], x[2] - rest[2]};
}

// Computes F = F_0 + [du_1 du_2] D_m'^-1 by columns, as in the local step.
static void find_gradient(const cau_step_solver *solver, const sheet_element *element,
                          cau_vec3 f[2])
{
	cau_vec3 u0 = displacement_of(solver, element->vertex[0]);
	cau_vec3 du1 = cau_sub(displacement_of(solver, element->vertex[1]), u0);
	cau_vec3 du2 = cau_sub(displacement_of(solver, element->vertex[2]), u0);
	for (int c = 0; c < 2; c++)
		f[c] = cau_add(element->rest[c], combine(element->g[1][c], du1, element->g[2][c], du2));
}

double cau_newton_stiffness(const cau_step_solver *solver, const cau_newton_element *triangle)
{
	const cau_local_work *work = &solver->slots.work[triangle->work];
	CAU_ASSERT(work->kind == CAU_ELEMENT_TRIANGLE, "share %d has no triangles", triangle->work);
	sheet_element element = sheet_at(solver, work, triangle->slot);
	cau_vec3 f[2];
	if (!(element.root.a00 > 0))
		return CAU_NEWTON_RANGE;
	find_gradient(solver, &element, f);
	sheet_polar polar = find_polar(f, element.root, element.kept);
	symmetric2 k = normal_stiffness(&polar, element.root);
	double half = (k.a00 - k.a11) / 2;
	return polar.full ? (k.a00 + k.a11) / 2 - sqrt(half * half + k.a01 * k.a01) : 0;
}

// ---- sums of the region

static void add_force(cau_newton *newton, int32_t vertex, double scale, cau_vec3 of)
{
	if (newton->place[vertex] < 0)
		return;
	double *to = newton->gradient + 4 * (int64_t)newton->place[vertex];
	to[0] += scale * of.x;
	to[1] += scale * of.y;
	to[2] += scale * of.z;
}

// Adds the block m, or its transpose, between a row and a free vertex outside the region.
static void couple(cau_newton *newton, int32_t row, int32_t vertex, const matrix3 *m, bool turned)
{
	CAU_ASSERT_INDEX(newton->coupling_count, newton->capacity.couplings);
	cau_newton_coupling *to = &newton->coupling[newton->coupling_count++];
	*to = (cau_newton_coupling){.row = row, .vertex = vertex};
	for (int r = 0; r < 3; r++)
		for (int c = 0; c < 3; c++)
			to->block[3 * r + c] = turned ? m->at[c][r] : m->at[r][c];
}

// Adds m to H in the rows of vertex a and the columns of vertex b, and its transpose if a and b
// differ.
static void add_block(cau_newton *newton, const cau_step_solver *solver, int32_t a, int32_t b,
                      const matrix3 *m)
{
	int32_t row = newton->place[a], column = newton->place[b];
	if ((row < 0 && column < 0) || solver->fixed[a] || solver->fixed[b])
		return;
	if (column < 0 || row < 0) {
		couple(newton, column < 0 ? row : column, column < 0 ? b : a, m, row < 0);
		return;
	}
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

static void add_sheet_hessian(cau_newton *newton, const cau_step_solver *solver,
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

static void add_sheet(cau_newton *newton, const cau_step_solver *solver, const cau_local_work *work,
                      int32_t slot, bool hessian)
{
	const cau_sheet_group *group = &solver->elements.sheet.group[work->group];
	sheet_element element = sheet_at(solver, work, slot);
	sheet_hessian k = {0};
	sheet_answer answer = {.to = hessian ? &k : NULL, .negative = newton->negative};
	cau_vec3 f[2];
	if (!(element.weight > 0))
		return;
	find_gradient(solver, &element, f);
	double share = group->viscosity_s * solver->elements.rate_per_s;
	if (share > 0)
		answer.tension = tension_of(f, strain_at(solver, slot), share);
	if (element.root.a00 > 0)
		add_target(&answer, f, element.root, element.kept);
	else if (group->limit == CAU_LIMIT_RANGE)
		add_range(&answer, f, group);
	if (share > 0)
		add_viscosity(&answer, f, share);
	newton->energy += element.weight / 2 * answer.squared;
	for (int i = 0; i < 3; i++)
		add_force(
			newton, element.vertex[i], element.weight,
			combine(element.g[i][0], answer.residual[0], element.g[i][1], answer.residual[1]));
	if (hessian)
		add_sheet_hessian(newton, solver, &element, &k);
}

// Returns w (e e^T / |e|^2 + |1 - L / |e|| (I - e e^T / |e|^2)): the Hessian of a link, or of a
// hinge, for which e = sum of c_i x_i.
static matrix3 length_hessian(cau_vec3 e, double rest, double weight, double negative)
{
	matrix3 m = {0};
	double length = cau_length(e);
	if (!(rest > 0) || !(length > 0)) {
		add_identity(&m, weight);
		return m;
	}
	double across = fmin(counted(1 - rest / length, negative), 1);
	add_identity(&m, weight * across);
	add_outer(&m, weight * (1 - across) / (length * length), e, e);
	return m;
}

typedef struct length_element {
	int count;
	int32_t vertex[4];
	double c[4], rest_length, weight; // weight: N/m
	cau_vec3 rest, moved;             // e at rest, and its change, m
} length_element;

static length_element length_at(const cau_step_solver *solver, const cau_local_work *work,
                                int32_t slot)
{
	bool link = work->kind == CAU_ELEMENT_LINK;
	const cau_link_set *links = &solver->elements.link;
	const cau_hinge_set *hinges = &solver->elements.hinge;
	length_element of = {.count = link ? 2 : 4, .c = {-1, 1}};
	of.weight = get(solver, link ? links->weight : hinges->weight, slot);
	of.rest_length = get(solver, link ? links->rest_length : hinges->rest_length, slot);
	of.rest = get3(solver, link ? links->rest : hinges->rest, slot);
	for (int i = 0; i < of.count; i++) {
		uint16_t record = (link ? links->record_at[i] : hinges->record_at[i])[slot];
		of.vertex[i] = vertex_of(&solver->elements, work, record);
		if (!link)
			of.c[i] = get(solver, hinges->coefficient[i], slot);
		of.moved = cau_add_scaled(of.moved, of.c[i], displacement_of(solver, of.vertex[i]));
	}
	return of;
}

// Returns the residual R as in link_kernel.h: exactly 0 at rest.
static cau_vec3 length_residual(const length_element *of, cau_vec3 e)
{
	double length = cau_length(e);
	double longer = 2 * cau_dot(of->rest, of->moved) + cau_dot(of->moved, of->moved);
	return of->rest_length > 0 && length > 0
	           ? cau_scale(longer / ((length + of->rest_length) * length), e)
	           : of->moved;
}

static void add_length(cau_newton *newton, const cau_step_solver *solver,
                       const cau_local_work *work, int32_t slot, bool hessian)
{
	length_element of = length_at(solver, work, slot);
	if (!(of.weight > 0))
		return;
	cau_vec3 e = cau_add(of.rest, of.moved), residual = length_residual(&of, e);
	newton->energy += of.weight / 2 * cau_dot(residual, residual);
	for (int i = 0; i < of.count; i++)
		add_force(newton, of.vertex[i], of.weight * of.c[i], residual);
	for (int i = 0; i < of.count && hessian; i++)
		for (int j = i; j < of.count; j++) {
			matrix3 m =
				length_hessian(e, of.rest_length, of.weight * of.c[i] * of.c[j], newton->negative);
			add_block(newton, solver, of.vertex[i], of.vertex[j], &m);
		}
}

// Adds inertia about s of eq. 4, or drag about its target: k/2 |x - centre|^2.
static void add_spring(cau_newton *newton, const cau_step_solver *solver, int32_t vertex, double k,
                       const double *centre)
{
	const double *x = solver->position + 3 * (int64_t)vertex;
	int32_t row = newton->place[vertex];
	for (int c = 0; c < 3 && row >= 0; c++) {
		double away = x[c] - centre[c];
		newton->energy += k / 2 * away * away;
		newton->gradient[4 * row + c] += k * away;
		newton->pivot[(int64_t)CAU_BLOCK * row + 5 * c] += k;
	}
}

static void evaluate(cau_newton *newton, const cau_step_solver *solver, bool hessian)
{
	double scale = 1 / (solver->inertia_s * solver->inertia_s);
	newton->energy = 0;
	newton->coupling_count = 0;
	memset(newton->gradient, 0, 4 * (size_t)newton->n * sizeof(double));
	memset(newton->pivot, 0, (size_t)newton->n * CAU_BLOCK * sizeof(double));
	for (int32_t i = 0; i < newton->n; i++)
		add_spring(newton, solver, newton->vertex[i],
		           scale * solver->tissue->mass[newton->vertex[i]],
		           solver->predicted + 3 * (int64_t)newton->vertex[i]);
	for (int32_t k = 0; k < solver->forces.drag_count; k++)
		add_spring(newton, solver, solver->forces.drag[k].vertex,
		           solver->forces.drag[k].coefficient, solver->forces.drag[k].target);
	for (int32_t k = 0; k < newton->element_count; k++) {
		const cau_newton_element *element = &newton->element[k];
		const cau_local_work *work = &solver->slots.work[element->work];
		CAU_ASSERT(work->kind != CAU_ELEMENT_TETRAHEDRON, "fat in Newton's element %d", k);
		if (work->kind == CAU_ELEMENT_TRIANGLE)
			add_sheet(newton, solver, work, element->slot, hessian);
		else
			add_length(newton, solver, work, element->slot, hessian);
	}
	cau_newton_touch(newton, solver);
}

// Most blocks of an element between the region and the rest: two vertices of a hinge in the region,
// two outside.
enum { MOST_COUPLED = 4 };

bool cau_newton_assemble(cau_newton *newton, const cau_step_solver *solver)
{
	int32_t most = MOST_COUPLED * newton->element_count;
	if (most > newton->capacity.couplings) {
		free(newton->coupling);
		newton->coupling = malloc(2 * (size_t)most * sizeof *newton->coupling);
		newton->capacity.couplings = newton->coupling ? 2 * most : 0;
		if (!newton->coupling)
			return false;
	}
	memset(newton->block, 0, (size_t)newton->first[newton->n] * CAU_BLOCK * sizeof(double));
	evaluate(newton, solver, true);
	return true;
}

void cau_newton_measure(cau_newton *newton, const cau_step_solver *solver)
{
	evaluate(newton, solver, false);
}
