// SPDX-License-Identifier: GPL-3.0-or-later
// Polar factor with determinant +1 of 3x3 matrices, by lane, kept as unit quaternions between
// calls.
#pragma once

#include "base/simd.h"

typedef struct rotation_lanes { // unit quaternion
	vreal w, x, y, z;
} rotation_lanes;

// The robust case, one matrix (columns) in double: eigenvectors of A^T A by cyclic Jacobi, the
// smallest singular direction turned where det A < 0. `q` is replaced by the rotation nearest to A,
// or kept where two singular values vanish.
void cau_polar_robust(const double a[9], double q[4]);

enum { POLAR_STEPS = 6 };

// Squares of turns: below the first a rounding of the rotation hides it; below the second one step
// leaves less than a rounding, as its error is about 0.4 of the turn's third power.
#define POLAR_SETTLED (REAL_EPSILON * REAL_EPSILON / 4)
#define POLAR_NEAR (CAU_SINGLE ? (real)1e-5 : (real)1e-11)
// Least determinant of tr S - sym S, relative to the cube of its trace.
#define POLAR_LEAST ((real)2.5e-6)

INLINE m3 rotation_matrix(rotation_lanes q)
{
	vreal xx = q.x * q.x, yy = q.y * q.y, zz = q.z * q.z;
	vreal xy = q.x * q.y, xz = q.x * q.z, yz = q.y * q.z;
	vreal wx = q.w * q.x, wy = q.w * q.y, wz = q.w * q.z;
	return (m3){{{1 - 2 * (yy + zz), 2 * (xy + wz), 2 * (xz - wy)},
	             {2 * (xy - wz), 1 - 2 * (xx + zz), 2 * (yz + wx)},
	             {2 * (xz + wy), 2 * (yz - wx), 1 - 2 * (xx + yy)}}};
}

// 1/sqrt(n) of a number near one; two terms serve where they leave less than half a rounding.
INLINE vreal inverse_root_near_one(vreal n)
{
#if CAU_SINGLE
	vreal e = n - 1;
	if (!v_any(v_abs(e) > v_set((real)4e-3)))
		return 1 - e * ((real)0.5 - (real)0.375 * e);
#endif
	return 1 / v_sqrt(n);
}

// q (1, w/2), made unit again.
INLINE rotation_lanes rotation_turn(rotation_lanes q, v3 w)
{
	v3 h = v3_scale(v_set((real)0.5), w);
	rotation_lanes p = {
		q.w - q.x * h.x - q.y * h.y - q.z * h.z, q.x + q.w * h.x + q.y * h.z - q.z * h.y,
		q.y + q.w * h.y + q.z * h.x - q.x * h.z, q.z + q.w * h.z + q.x * h.y - q.y * h.x};
	vreal scale = inverse_root_near_one(p.w * p.w + p.x * p.x + p.y * p.y + p.z * p.z);
	return (rotation_lanes){p.w * scale, p.x * scale, p.y * scale, p.z * scale};
}

// Lanes that Newton's step cannot serve, one by one.
static __attribute__((noinline)) void polar_lanes(m3 a, vmask which, rotation_lanes *q)
{
	for (int l = 0; l < LANES; ++l) {
		if (!which[l])
			continue;
		double in[9], out[4] = {(double)q->w[l], (double)q->x[l], (double)q->y[l], (double)q->z[l]};
		for (int c = 0; c < 3; ++c) {
			in[3 * c] = (double)a.c[c].x[l];
			in[3 * c + 1] = (double)a.c[c].y[l];
			in[3 * c + 2] = (double)a.c[c].z[l];
		}
		cau_polar_robust(in, out);
		q->w[l] = (real)out[0];
		q->x[l] = (real)out[1];
		q->y[l] = (real)out[2];
		q->z[l] = (real)out[3];
	}
}

// The turn w that makes S = Q^T A symmetric to first order, from (tr S - sym S) w = axial S. Lanes
// where that matrix is not well positive definite are added to `robust`; they do not turn.
INLINE v3 polar_turn(m3 q, m3 a, vmask *robust)
{
	vreal s00 = v3_dot(q.c[0], a.c[0]), s11 = v3_dot(q.c[1], a.c[1]), s22 = v3_dot(q.c[2], a.c[2]);
	vreal s01 = v3_dot(q.c[0], a.c[1]), s10 = v3_dot(q.c[1], a.c[0]);
	vreal s02 = v3_dot(q.c[0], a.c[2]), s20 = v3_dot(q.c[2], a.c[0]);
	vreal s12 = v3_dot(q.c[1], a.c[2]), s21 = v3_dot(q.c[2], a.c[1]);
	v3 axial = {s21 - s12, s02 - s20, s10 - s01};
	const real half = (real)-0.5;
	vreal m00 = s11 + s22, m11 = s00 + s22, m22 = s00 + s11;
	vreal m01 = half * (s01 + s10), m02 = half * (s02 + s20), m12 = half * (s12 + s21);
	vreal c00 = m11 * m22 - m12 * m12, c11 = m00 * m22 - m02 * m02, c22 = m00 * m11 - m01 * m01;
	vreal c01 = m02 * m12 - m01 * m22, c02 = m01 * m12 - m02 * m11, c12 = m01 * m02 - m00 * m12;
	vreal det = m00 * c00 + m01 * c01 + m02 * c02, trace = m00 + m22 + s22 + s00;
	vreal floor = v_max(POLAR_LEAST * trace * trace * trace, v_set(REAL_TINY));
	*robust |= ~((det > floor) & (c22 > v_set(0)) & (m00 > v_set(0)));
	vreal inverse = 1 / v_select(*robust, v_set(1), det);
	v3 w = {inverse * (c00 * axial.x + c01 * axial.y + c02 * axial.z),
	        inverse * (c01 * axial.x + c11 * axial.y + c12 * axial.z),
	        inverse * (c02 * axial.x + c12 * axial.y + c22 * axial.z)};
	return v3_select(*robust, v3_zero(), w);
}

// Rotation of A from the last one by Newton's method for the largest tr(Q^T A), which converges
// with the third power of the turn; one step mostly serves. Where it does not, cau_polar_robust
// decides. `q` holds the last rotation on entry and the new one on return. Exactly kept where S is
// symmetric to rounding.
INLINE m3 polar_rotation(m3 a, rotation_lanes *q)
{
	vmask robust = v_set(0) > v_set(1); // none
	for (int step = 0;; ++step) {
		m3 r = rotation_matrix(*q);
		v3 w = polar_turn(r, a, &robust);
		vreal turn2 = v3_dot(w, w);
		if (!v_any((turn2 > v_set(POLAR_SETTLED)) | robust))
			return r;
		*q = rotation_turn(*q, w);
		vmask turning = turn2 > v_set(POLAR_NEAR);
		if (!v_any(turning))
			break;
		if (step == POLAR_STEPS - 1) { // it started too far away
			robust |= turning;
			break;
		}
	}
	if (v_any(robust))
		polar_lanes(a, robust, q);
	return rotation_matrix(*q);
}
