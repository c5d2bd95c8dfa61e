// SPDX-License-Identifier: GPL-3.0-or-later
// Strains kept in an interval: the energy of an element is w/2 times the squared distances of F to
// each of the sets that its strains may lie in, added up. One set is that of the matrices whose
// column f_a has a length in its interval; another is that of those whose columns f_a and f_b have
// no more than a certain cosine between them. The nearest member of either is known in closed form,
// so the residual F - P is the gradient of half the squared distance, and both depend on F^T F
// alone, so there is no torque.
//
// Departs: the sets are taken one by one. The nearest member of their intersection has no closed
// form, and a metric that is clamped as a whole (what is nearest in length, then in shear) is not
// the nearest, so that the force towards it is the gradient of nothing.
#pragma once

#include "base/simd.h"

// How far the shear's formulas are kept from where two columns are parallel and of one length, as
// there is no one nearest pair: a share of their squares, a few roundings in size. Limits are off
// by as much.
#define RANGE_ROUNDING (CAU_SINGLE ? (real)1e-5 : (real)1e-10)

// Column f of length sqrt(k): adds F - P to `residual`, returns the squared distance. Below the
// rounding of k, which may be that of I + ..., its length is not known: it is taken to be no less.
INLINE vreal range_stretch(v3 f, vreal k, double least, double most, v3 *residual)
{
	vreal length = v_sqrt(v_max(k, v_set(64 * REAL_EPSILON)));
	vreal kept = v_clamp(length, (real)least, (real)most);
	*residual = v3_add_scaled(*residual, 1 - kept / length, f);
	return (length - kept) * (length - kept);
}

// Columns f_1, f_2 with products k11, k22, k12, their cosine at most `most` (below 1) in size.
//
// Both turn in their plane, by d together, until the cosine is most, and shrink to where they are
// nearest. With a = k11 + k22 and x = |f_1| |f_2| sin d = sqrt(1 - most^2) |k12| - most J, J their
// area, the squared distance is D = (a - r) / 2, r = sqrt(a^2 - 4 x^2), and
// dD/da = -D / r, dD/dx = 2 x / r.
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
