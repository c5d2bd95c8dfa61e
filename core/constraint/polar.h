// SPDX-License-Identifier: GPL-3.0-or-later
// The polar factor, with determinant +1, of 3x3 matrices, one in each lane. The factors are kept as
// unit quaternions between calls.
#pragma once

#include "base/simd.h"

typedef struct rotation_lanes { // unit quaternion
	vreal w, x, y, z;
} rotation_lanes;

// Computes the rotation for one matrix (by columns) in double, in all cases: by eigenvectors of A^T
// A from cyclic Jacobi. `q` is replaced by the rotation nearest to A. If det A < 0, the smallest
// singular direction is reversed. If two singular values vanish, `q` is unchanged.
void cau_polar_robust(const double a[9], double q[4]);

enum { POLAR_STEPS = 6 };

// Limits of the square of a half turn. Below POLAR_SETTLED, the turn is smaller than the rounding
// of the rotation. Below POLAR_NEAR, one step is enough: it leaves an error of about 0.4 times the
// third power of the turn, which is less than rounding.
#define POLAR_SETTLED (REAL_EPSILON * REAL_EPSILON / 16)
#define POLAR_NEAR (CAU_SINGLE ? (real)2.5e-6 : (real)2.5e-12)
// Least determinant of tr S - sym S, relative to the third power of its trace.
#define POLAR_LEAST ((real)2.5e-6)

INLINE m3 rotation_matrix(rotation_lanes q)
{
	vreal x = q.x + q.x, y = q.y + q.y, z = q.z + q.z;
	vreal xy = x * q.y, xz = x * q.z, yz = y * q.z;
	vreal not_xx = 1 - x * q.x, not_yy = 1 - y * q.y;
	return (m3){{{not_yy - z * q.z, xy + z * q.w, xz - y * q.w},
	             {xy - z * q.w, not_xx - z * q.z, yz + x * q.w},
	             {xz + y * q.w, yz - x * q.w, not_xx - y * q.y}}};
}

// q (1, h). The length is 1 + |h|^2 / 2 to second order.
INLINE rotation_lanes rotation_turn(rotation_lanes q, v3 h)
{
	return (rotation_lanes){
		q.w - q.x * h.x - q.y * h.y - q.z * h.z, q.x + q.w * h.x + q.y * h.z - q.z * h.y,
		q.y + q.w * h.y + q.z * h.x - q.x * h.z, q.z + q.w * h.z + q.x * h.y - q.y * h.x};
}
INLINE vreal rotation_norm2(rotation_lanes q)
{
	return q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z;
}
INLINE rotation_lanes rotation_scale(rotation_lanes q, vreal scale)
{
	return (rotation_lanes){q.w * scale, q.x * scale, q.y * scale, q.z * scale};
}

// Handles the lanes for which Newton's step is not usable, one by one.
static __attribute__((noinline)) void polar_lanes(const m3 *a, vmask which, rotation_lanes *q)
{
	for (int l = 0; l < LANES; l++) {
		if (!which[l])
			continue;
		double in[9], out[4] = {(double)q->w[l], (double)q->x[l], (double)q->y[l], (double)q->z[l]};
		for (int c = 0; c < 3; c++) {
			in[3 * c] = (double)a->c[c].x[l];
			in[3 * c + 1] = (double)a->c[c].y[l];
			in[3 * c + 2] = (double)a->c[c].z[l];
		}
		cau_polar_robust(in, out);
		q->w[l] = (real)out[0];
		q->x[l] = (real)out[1];
		q->y[l] = (real)out[2];
		q->z[l] = (real)out[3];
	}
}

// Returns half of the turn w that makes S = R^T A symmetric to first order: (tr S - sym S) w =
// axial S. `hard` marks the lanes in which tr S - sym S is not positive definite by a margin. The
// result of these lanes is invalid.
INLINE v3 polar_half_turn(m3 r, m3 a, vmask *hard)
{
	vreal s00 = v3_dot(r.c[0], a.c[0]), s11 = v3_dot(r.c[1], a.c[1]), s22 = v3_dot(r.c[2], a.c[2]);
	vreal s01 = v3_dot(r.c[0], a.c[1]), s10 = v3_dot(r.c[1], a.c[0]);
	vreal s02 = v3_dot(r.c[0], a.c[2]), s20 = v3_dot(r.c[2], a.c[0]);
	vreal s12 = v3_dot(r.c[1], a.c[2]), s21 = v3_dot(r.c[2], a.c[1]);
	v3 axial = {s21 - s12, s02 - s20, s10 - s01};
	// M = 2 (tr S - sym S). Its off-diagonal entries are -t01, -t02 and -t12.
	vreal m00 = s11 + s22, m11 = s00 + s22, m22 = s00 + s11;
	m00 += m00, m11 += m11, m22 += m22;
	vreal t01 = s01 + s10, t02 = s02 + s20, t12 = s12 + s21;
	vreal c00 = m11 * m22 - t12 * t12, c11 = m00 * m22 - t02 * t02, c22 = m00 * m11 - t01 * t01;
	vreal c01 = t02 * t12 + t01 * m22, c02 = t01 * t12 + t02 * m11, c12 = t01 * t02 + t12 * m00;
	vreal det = m00 * c00 - t01 * c01 - t02 * c02, trace = m00 + m11 + m22;
	vreal floor = v_max(POLAR_LEAST * trace * trace * trace, v_set(REAL_TINY));
	*hard = ~((det > floor) & (c22 > v_set(0)) & (m00 > v_set(0)));
	vreal inverse = 1 / det;
	return (v3){inverse * (c00 * axial.x + c01 * axial.y + c02 * axial.z),
	            inverse * (c01 * axial.x + c11 * axial.y + c12 * axial.z),
	            inverse * (c02 * axial.x + c12 * axial.y + c22 * axial.z)};
}

// Applies Newton's method for a far turn, in as many steps as needed. `first` is the half turn of
// the first step, and `is_void` marks the lanes in which that half turn is invalid. Lanes in which
// Newton's method fails use cau_polar_robust.
static __attribute__((noinline)) void polar_far(const m3 *a, const v3 *first, const vmask *is_void,
                                                rotation_lanes *q)
{
	vmask robust = v_set(0) > v_set(1); // no lane is set yet
	for (int step = 0; step < POLAR_STEPS; step++) {
		vmask hard = *is_void;
		v3 h = *first;
		if (step)
			h = polar_half_turn(rotation_matrix(*q), *a, &hard);
		robust |= hard;
		h = v3_select(robust, v3_zero(), h);
		rotation_lanes p = rotation_turn(*q, h);
		*q = rotation_scale(p, 1 / v_sqrt(rotation_norm2(p)));
		vmask turning = v3_dot(h, h) > v_set(POLAR_NEAR);
		if (step == POLAR_STEPS - 1) // the start was too far away to converge
			robust |= turning;
		else if (!v_any(turning))
			break;
	}
	if (v_any(robust))
		polar_lanes(a, robust, q);
}

// Finds the rotation of A by Newton's method for the largest tr(R^T A), from the last rotation. The
// error falls with the third power of the turn, so one step is mostly enough. `q` is the last
// rotation on entry and the new one on return. If S is symmetric to rounding, `q` is unchanged.
INLINE m3 polar_rotation(m3 a, rotation_lanes *q)
{
	vmask hard;
	m3 r = rotation_matrix(*q);
	v3 h = polar_half_turn(r, a, &hard);
	vreal turn2 = v3_dot(h, h);
	if (__builtin_expect(v_any(hard | (turn2 > v_set(POLAR_NEAR))), 0)) {
		polar_far(&a, &h, &hard, q);
		return rotation_matrix(*q);
	}
	if (!v_any(turn2 > v_set(POLAR_SETTLED)))
		return r;
	rotation_lanes p = rotation_turn(*q, h);
	*q = rotation_scale(p, (real)1.5 - (real)0.5 * rotation_norm2(p)); // 1/sqrt, near 1
	return rotation_matrix(*q);
}
