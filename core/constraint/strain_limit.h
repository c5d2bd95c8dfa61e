// SPDX-License-Identifier: GPL-3.0-or-later
// Strain limits of triangles and tetrahedra, and strains that are kept in a range.
#pragma once

#include "base/simd.h"
#include "constraint/polar.h"

// ---- a range of strains
// Strains limited to an interval. The limits define several sets of F. One set has the matrices F
// whose column f_a has a length in its interval. Another set has the matrices with at most a
// certain cosine between f_a and f_b. The energy of an element is w/2 times the sum of the squared
// distances of F to these sets. The nearest member P of a set is known in closed form. So the
// residual F - P is the gradient of half the squared distance. The distance depends on F^T F alone,
// so there is no torque.
//
// Departs: the sets are handled one by one. The nearest member of their intersection has no closed
// form. A metric that is clamped as a whole (first to the nearest length, then to the nearest
// shear) is not the nearest member, so the force towards it is the gradient of no energy.

// Margin that keeps the shear's formulas away from two parallel columns of one length, for which
// the nearest pair is not unique. It is a share of the columns' squares, a few times rounding.
// Limits have an error of the same size.
#define RANGE_ROUNDING (CAU_SINGLE ? (real)1e-5 : (real)1e-10)

// Handles a column f of length sqrt(k): adds F - P to `residual` and returns the squared distance.
// If k is less than its own rounding, the length is taken to be that of the rounding.
INLINE vreal range_stretch(v3 f, vreal k, double least, double most, v3 *residual)
{
	vreal length = v_sqrt(v_max(k, v_set(64 * REAL_EPSILON)));
	vreal kept = v_clamp(length, (real)least, (real)most);
	*residual = v3_add_scaled(*residual, 1 - kept / length, f);
	return (length - kept) * (length - kept);
}

// Handles columns f_1, f_2 with the products k11, k22, k12. The size of their cosine is at most
// `most` (below 1).
//
// The nearest pair is turned in the columns' plane, by d together, until the cosine is `most`, and
// scaled. With a = k11 + k22 and x = |f_1| |f_2| sin d = sqrt(1 - most^2) |k12| - most J, where J
// is their area, the squared distance is D = (a - r) / 2, r = sqrt(a^2 - 4 x^2), and dD/da = -D /
// r, dD/dx = 2 x / r.
INLINE vreal range_shear(v3 f1, v3 f2, sym2 k, double most, v3 *residual1, v3 *residual2)
{
	real limit = (real)most, across = (real)sqrt(1 - most * most), tiny = RANGE_ROUNDING;
	vreal a = k.a00 + k.a11;
	vreal area = v_sqrt(v_max(k.a00 * k.a11 - k.a01 * k.a01, v_set(0)) + tiny * a * a);
	vreal x = across * v_abs(k.a01) - limit * area;
	vmask beyond = (x > v_set(0)) & (area > v_set(REAL_TINY));
	if (!v_any(beyond))
		return v_set(0);
	vreal r = v_sqrt(v_max(a * a - (4 - 4 * tiny) * x * x, v_set(REAL_TINY)));
	vreal distance = 2 * x * x / (a + r), slope = x / r, bend = limit / area;
	vreal sign = v_select(k.a01 < v_set(0), v_set(-1), v_set(1));
	// half of dD/df_1 = own_1 f_1 + other f_2; half of dD/df_2 = other f_1 + own_2 f_2
	vreal other = slope * (across * sign + bend * k.a01), less = distance / r, flat = 2 * tiny * a;
	vreal own1 = -less - slope * bend * (k.a11 + flat),
		  own2 = -less - slope * bend * (k.a00 + flat);
	v3 zero = v3_zero();
	*residual1 =
		v3_add(*residual1, v3_select(beyond, v3_add_scaled(v3_scale(own1, f1), other, f2), zero));
	*residual2 =
		v3_add(*residual2, v3_select(beyond, v3_add_scaled(v3_scale(own2, f2), other, f1), zero));
	return v_select(beyond, distance, v_set(0));
}

// ---- limits of triangles
// Strain limits of triangles (section 5.1, Appendix A). P is the matrix nearest to F that the limit
// allows, and R = F - P is the residual. A triangle's energy is w/2 |R|^2 and its stress w R. f_1
// and f_2 are the columns of F.

typedef struct sheet_gradient { // F or R of a triangle, 3 x 2, by columns
	v3 c[2];
} sheet_gradient;

// Returns the square root of a symmetric positive semidefinite 2x2 matrix: (M + sqrt(det) I) /
// sqrt(tr + 2 sqrt(det)).
INLINE sym2 sym2_sqrt(sym2 m, vreal *root_determinant)
{
	vreal det = v_max(m.a00 * m.a11 - m.a01 * m.a01, v_set(0));
	vreal s = v_sqrt(det);
	vreal t = v_sqrt(v_max(m.a00 + m.a11 + 2 * s, v_set(REAL_TINY)));
	*root_determinant = s;
	return (sym2){(m.a00 + s) / t, (m.a11 + s) / t, m.a01 / t};
}

// Returns B A B, for symmetric 2x2 matrices.
INLINE sym2 sym2_sandwich(sym2 b, sym2 a)
{
	vreal p00 = b.a00 * a.a00 + b.a01 * a.a01, p01 = b.a00 * a.a01 + b.a01 * a.a11;
	vreal p10 = b.a01 * a.a00 + b.a11 * a.a01, p11 = b.a01 * a.a01 + b.a11 * a.a11;
	return (sym2){p00 * b.a00 + p01 * b.a01, p10 * b.a01 + p11 * b.a11, p00 * b.a01 + p01 * b.a11};
}

// Returns F B, for a symmetric B.
INLINE sheet_gradient sheet_times(sheet_gradient f, sym2 b)
{
	return (sheet_gradient){{v3_add_scaled(v3_scale(b.a00, f.c[0]), b.a01, f.c[1]),
	                         v3_add_scaled(v3_scale(b.a01, f.c[0]), b.a11, f.c[1])}};
}

// Returns the residual of TARGET in closed form. P = Q T^(1/2), where Q is the orthonormal polar
// factor of F T^(1/2). With K = F^T F and S = (T^(1/2) K T^(1/2))^(1/2), Q = F T^(1/2) S^-1. So R =
// F (I - T^(1/2) S^-1 T^(1/2)). At rest with T = I this is exactly zero. Where F has lost rank, Q
// is not defined, and the Q of the last evaluation (`polar`) is used. `slack` marks the lanes with
// little stiffness along the normal. This stiffness is w (I - T^(1/2) S^-1 T^(1/2)).
INLINE sheet_gradient sheet_target_residual(sheet_gradient f, sym2 k, sym2 target_root,
                                            sheet_gradient *polar, vmask *slack)
{
	vreal s;
	sym2 m = sym2_sandwich(target_root, k);
	sym2 root = sym2_sqrt(m, &s);
	// `full` is true if the ratio of singular values is below about 2000, and K is above its own
	// rounding
	vreal trace = m.a00 + m.a11;
	vmask full = (s > (real)1e-3 * trace) & (trace > v_set(64 * REAL_EPSILON));
	vreal inverse = 1 / v_select(full, s, v_set(1));
	sym2 root_inverse = {root.a11 * inverse, root.a00 * inverse, -root.a01 * inverse};
	sym2 b = sym2_sandwich(target_root, root_inverse);
	*slack = ~full | (v_max(b.a00, b.a11) + v_abs(b.a01) > v_set((real)(1 - CAU_SLACK)));
	sheet_gradient q = sheet_times(sheet_times(f, target_root), root_inverse);
	for (int a = 0; a < 2; a++)
		polar->c[a] = v3_select(full, q.c[a], polar->c[a]);
	sheet_gradient exact = sheet_times(f, (sym2){1 - b.a00, 1 - b.a11, -b.a01});
	sheet_gradient kept = sheet_times(*polar, target_root);
	for (int a = 0; a < 2; a++)
		exact.c[a] = v3_select(full, exact.c[a], v3_sub(f.c[a], kept.c[a]));
	return exact;
}

// Returns the residual of RANGE: the sum over both stretches and the shear. *squared is the sum of
// their squared distances.
INLINE sheet_gradient sheet_range_residual(sheet_gradient f, sym2 k, const double stretch_min[2],
                                           const double stretch_max[2], double shear_max,
                                           vreal *squared)
{
	sheet_gradient r = {{v3_zero(), v3_zero()}};
	*squared = range_stretch(f.c[0], k.a00, stretch_min[0], stretch_max[0], &r.c[0]);
	*squared += range_stretch(f.c[1], k.a11, stretch_min[1], stretch_max[1], &r.c[1]);
	*squared += range_shear(f.c[0], f.c[1], k, shear_max, &r.c[0], &r.c[1]);
	return r;
}

// One linearised constraint C of F (eq. 12): dF = -C (dC/dF) / |dC/dF|^2. The residual is C (dC/dF)
// / |dC/dF|^2. The step is limited for columns shorter than a thousandth of their rest length
// (squared: 1e-6), where the gradient does not indicate the distance.
INLINE vreal linearised_step(vreal c, vreal gradient_squared)
{
	return c / v_max(gradient_squared, v_set((real)1e-6));
}

// TARGET, eq. 13 in F: the unordered pairs (a, b) of eq. 12, each once, as three residuals.
// Departs: eq. 13 sums over ordered pairs, which corrects shear twice.
INLINE void sheet_linearised_residuals(sheet_gradient f, sym2 k, sym2 target,
                                       sheet_gradient part[3])
{
	v3 zero = v3_zero();
	vreal u = 2 * linearised_step(k.a00 - target.a00, 4 * k.a00);
	vreal v = 2 * linearised_step(k.a11 - target.a11, 4 * k.a11);
	vreal w = linearised_step(k.a01 - target.a01, k.a00 + k.a11);
	part[0] = (sheet_gradient){{v3_scale(u, f.c[0]), zero}};
	part[1] = (sheet_gradient){{zero, v3_scale(v, f.c[1])}};
	part[2] = (sheet_gradient){{v3_scale(w, f.c[1]), v3_scale(w, f.c[0])}};
}

// ---- limits of tetrahedra
// Strain limits of tetrahedra: the limits of triangles for the 3x3 metric.

// True if S is diagonal, as most targets are. Then a third of the products is enough.
INLINE int sym3_is_diagonal(sym3 s)
{
	return !v_any((vmask)s.a01 | (vmask)s.a02 | (vmask)s.a12);
}
INLINE m3 m3_times_target(m3 a, sym3 root, int along_axes)
{
	if (!along_axes)
		return m3_times_sym(a, root);
	return (m3){
		{v3_scale(root.a00, a.c[0]), v3_scale(root.a11, a.c[1]), v3_scale(root.a22, a.c[2])}};
}

// Returns the residual of TARGET in closed form: R = F - Q T^(1/2), where Q is the rotation of F
// T^(1/2). `q` keeps Q.
INLINE m3 fat_target_residual(m3 f, sym3 target_root, rotation_lanes *q)
{
	int along_axes = sym3_is_diagonal(target_root);
	m3 rotation = polar_rotation(m3_times_target(f, target_root, along_axes), q);
	return m3_sub(f, m3_times_target(rotation, target_root, along_axes));
}

INLINE sym3 sym3_inverse(sym3 a)
{
	sym3 c = {a.a11 * a.a22 - a.a12 * a.a12, a.a00 * a.a22 - a.a02 * a.a02,
	          a.a00 * a.a11 - a.a01 * a.a01, a.a02 * a.a12 - a.a01 * a.a22,
	          a.a01 * a.a12 - a.a02 * a.a11, a.a01 * a.a02 - a.a00 * a.a12};
	vreal i = 1 / v_max(a.a00 * c.a00 + a.a01 * c.a01 + a.a02 * c.a02, v_set(REAL_TINY));
	return (sym3){c.a00 * i, c.a11 * i, c.a22 * i, c.a01 * i, c.a02 * i, c.a12 * i};
}
INLINE sym3 sym3_mean(sym3 a, sym3 b)
{
	const real h = (real)0.5;
	return (sym3){h * (a.a00 + b.a00), h * (a.a11 + b.a11), h * (a.a22 + b.a22),
	              h * (a.a01 + b.a01), h * (a.a02 + b.a02), h * (a.a12 + b.a12)};
}

// Returns the largest absolute entry of a - b.
INLINE vreal sym3_distance(sym3 a, sym3 b)
{
	vreal most = v_max(v_abs(a.a00 - b.a00), v_max(v_abs(a.a11 - b.a11), v_abs(a.a22 - b.a22)));
	return v_max(most,
	             v_max(v_abs(a.a01 - b.a01), v_max(v_abs(a.a02 - b.a02), v_abs(a.a12 - b.a12))));
}

// Most steps of the Denman-Beavers iteration, which computes square roots of symmetric positive
// definite 3x3 matrices and the inverses of these roots. It converges quadratically. So it ends
// after a step as small as the square root of rounding (1e-4 for 1e-8, 1e-9 for 1e-16). Ten steps
// are enough for stretches from 1/30 to 30.
enum { SQRT_STEPS = 10 };

// One step of the iteration. Returns whether another step is needed.
INLINE int sym3_sqrt_step(sym3 *root, sym3 *inverse)
{
	const real small = CAU_SINGLE ? (real)1e-4 : (real)1e-9;
	sym3 last = *root, y = sym3_mean(last, sym3_inverse(*inverse));
	*inverse = sym3_mean(*inverse, sym3_inverse(last));
	*root = y;
	return v_any(sym3_distance(y, last) > small * (y.a00 + y.a11 + y.a22));
}

// Replaces two matrices by the inverses of their square roots. Both are computed side by side,
// because each step waits for the one before it.
INLINE void sym3_inverse_roots(sym3 a[2])
{
	vreal one = v_set(1), zero = v_set(0);
	const sym3 unit = {one, one, one, zero, zero, zero};
	sym3 inverse[2] = {unit, unit};
	int step = 0, more[2] = {1, 1};
	for (; step < SQRT_STEPS && more[0] && more[1]; step++) {
		more[0] = sym3_sqrt_step(&a[0], &inverse[0]);
		more[1] = sym3_sqrt_step(&a[1], &inverse[1]);
	}
	for (int k = 0; k < 2; k++) {
		for (int alone = step; alone < SQRT_STEPS && more[k]; alone++)
			more[k] = sym3_sqrt_step(&a[k], &inverse[k]);
		a[k] = inverse[k];
	}
}

// Returns the residual of RANGE, as in sheet_range_residual, for three stretches and three shears.
INLINE m3 fat_range_residual(m3 f, const double stretch_min[3], const double stretch_max[3],
                             double shear_max, vreal *squared)
{
	m3 r = {{v3_zero(), v3_zero(), v3_zero()}};
	vreal length2[3];
	*squared = v_set(0);
	for (int a = 0; a < 3; a++) {
		length2[a] = v3_dot(f.c[a], f.c[a]);
		*squared += range_stretch(f.c[a], length2[a], stretch_min[a], stretch_max[a], &r.c[a]);
	}
	for (int a = 0; a < 3; a++) {
		int b = (a + 1) % 3;
		sym2 k = {length2[a], length2[b], v3_dot(f.c[a], f.c[b])};
		*squared += range_shear(f.c[a], f.c[b], k, shear_max, &r.c[a], &r.c[b]);
	}
	return r;
}

// Computes the residuals of TARGET, linearised: the six unordered pairs of eq. 12 for the 3x3
// metric, each projected once in F. part[i] is the residual of pair i. The step is limited for
// columns shorter than a thousandth of their rest length (squared: 1e-6), where the gradient does
// not indicate the distance.
INLINE void fat_linearised_residuals(m3 f, sym3 target, m3 part[6])
{
	static const int first[6] = {0, 1, 2, 0, 0, 1}, second[6] = {0, 1, 2, 1, 2, 2};
	sym3 k = m3_transpose_times(f, f);
	vreal have[6] = {k.a00, k.a11, k.a22, k.a01, k.a02, k.a12};
	vreal want[6] = {target.a00, target.a11, target.a22, target.a01, target.a02, target.a12};
	for (int i = 0; i < 6; i++) {
		int a = first[i], b = second[i];
		vreal scale = a == b ? 4 * have[a] : have[a] + have[b];
		vreal step = (have[i] - want[i]) / v_max(scale, v_set((real)1e-6));
		part[i] = (m3){{v3_zero(), v3_zero(), v3_zero()}};
		part[i].c[a] = v3_scale(step, f.c[b]);
		part[i].c[b] = v3_add_scaled(part[i].c[b], step, f.c[a]);
	}
}
