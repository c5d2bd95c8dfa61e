// SPDX-License-Identifier: GPL-3.0-or-later
// The diagonal system of the paper as printed (eq. 5-7). Constraints are projected in positions,
// with unit masses. Constraint m pulls to its projection with the weight omega_m = w |G|^2 /
// (vertices of m).
//
// A residual R in F moves positions along R G^T. The position step that makes C = |R| zero to first
// order is |R|^2 / |R G^T|^2 (R G^T). This step weighted with omega_m is the gradient w R G^T of
// the F-space system, times the scale that diagonal_scale returns. So one kernel serves both
// systems. For a single constraint the step is exactly that of eq. 13 and 17.
#pragma once

#include "base/simd.h"

// Returns |G|^2 / vertices x |R|^2 / |R G^T|^2; 0 where R vanishes.
INLINE vreal diagonal_scale(vreal r2, vreal rg2, vreal g2_per_vertex)
{
	return v_select(rg2 > v_set(REAL_TINY), g2_per_vertex * r2 / v_max(rg2, v_set(REAL_TINY)),
	                v_set(0));
}

INLINE vreal diagonal_scale_sheet(const v3 r[2], const vreal m[4], vreal g2_per_vertex)
{
	v3 a = v3_add_scaled(v3_scale(m[0], r[0]), m[1], r[1]);
	v3 b = v3_add_scaled(v3_scale(m[2], r[0]), m[3], r[1]);
	v3 c = v3_add(a, b);
	return diagonal_scale(v3_dot(r[0], r[0]) + v3_dot(r[1], r[1]),
	                      v3_dot(a, a) + v3_dot(b, b) + v3_dot(c, c), g2_per_vertex);
}

// Returns the scale of a tetrahedron. `m` is D_m^-1, row-major. Vertex i + 1 gets R (row i of
// D_m^-1)^T.
INLINE vreal diagonal_scale_fat(m3 r, const vreal m[9], vreal g2_per_vertex)
{
	v3 sum = v3_zero();
	vreal rg2 = v_set(0);
	for (int i = 0; i < 3; i++) {
		v3 g = m3_apply(r, (v3){m[3 * i], m[3 * i + 1], m[3 * i + 2]});
		rg2 += v3_dot(g, g);
		sum = v3_add(sum, g);
	}
	return diagonal_scale(m3_dot(r, r), rg2 + v3_dot(sum, sum), g2_per_vertex);
}
