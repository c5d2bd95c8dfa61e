// SPDX-License-Identifier: GPL-3.0-or-later
// Strain limits of tetrahedra: the limits of strain_limit_sheet.h for the 3x3 metric.
#pragma once

#include "constraint/polar.h"
#include "constraint/strain_range.h"

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
