// SPDX-License-Identifier: GPL-3.0-or-later
// Strain limits of triangles (section 5.1, Appendix A). P is the matrix nearest to F that the limit
// allows, and R = F - P is the residual. A triangle's energy is w/2 |R|^2 and its stress w R. f_1
// and f_2 are the columns of F.
#pragma once

#include "constraint/strain_range.h"

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
