// SPDX-License-Identifier: GPL-3.0-or-later
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
#pragma once

#include "base/simd.h"

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
