// SPDX-License-Identifier: GPL-3.0-or-later
// Small vectors, poses, quaternions and symmetric matrices in double, for code that does not run
// for each element; and keys that order points.
#pragma once

#include <math.h>
#include <stdbool.h>
#include <stdint.h>

#include "cautery/assert.h"
#include "cautery/scene.h"

typedef struct cau_vec3 {
	double x, y, z;
} cau_vec3;

static inline cau_vec3 cau_vec3_of(const double v[3])
{
	return (cau_vec3){v[0], v[1], v[2]};
}
static inline void cau_vec3_to(cau_vec3 a, double out[3])
{
	out[0] = a.x;
	out[1] = a.y;
	out[2] = a.z;
}
static inline cau_vec3 cau_add(cau_vec3 a, cau_vec3 b)
{
	return (cau_vec3){a.x + b.x, a.y + b.y, a.z + b.z};
}
static inline cau_vec3 cau_sub(cau_vec3 a, cau_vec3 b)
{
	return (cau_vec3){a.x - b.x, a.y - b.y, a.z - b.z};
}
static inline cau_vec3 cau_scale(double s, cau_vec3 a)
{
	return (cau_vec3){s * a.x, s * a.y, s * a.z};
}
// a + s b
static inline cau_vec3 cau_add_scaled(cau_vec3 a, double s, cau_vec3 b)
{
	return (cau_vec3){a.x + s * b.x, a.y + s * b.y, a.z + s * b.z};
}
static inline double cau_dot(cau_vec3 a, cau_vec3 b)
{
	return a.x * b.x + a.y * b.y + a.z * b.z;
}
static inline cau_vec3 cau_cross(cau_vec3 a, cau_vec3 b)
{
	return (cau_vec3){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
static inline double cau_length(cau_vec3 a)
{
	return sqrt(cau_dot(a, a));
}
// a / |a|, or `fallback` if |a| is zero.
static inline cau_vec3 cau_unit_or(cau_vec3 a, cau_vec3 fallback)
{
	double length = cau_length(a);
	return length > 0 ? cau_scale(1 / length, a) : fallback;
}

// Rotates v by the unit quaternion q = (w, x, y, z).
static inline cau_vec3 cau_rotate(const double q[4], cau_vec3 v)
{
	cau_vec3 u = {q[1], q[2], q[3]};
	cau_vec3 t = cau_scale(2, cau_cross(u, v));
	return cau_add(cau_add_scaled(v, q[0], t), cau_cross(u, t));
}
static inline cau_vec3 cau_rotate_back(const double q[4], cau_vec3 v)
{
	const double conjugate[4] = {q[0], -q[1], -q[2], -q[3]};
	return cau_rotate(conjugate, v);
}
static inline cau_vec3 cau_pose_to_world(const cau_pose *pose, cau_vec3 local)
{
	return cau_add(cau_vec3_of(pose->position_m), cau_rotate(pose->rotation, local));
}
static inline cau_vec3 cau_pose_to_local(const cau_pose *pose, cau_vec3 world)
{
	return cau_rotate_back(pose->rotation, cau_sub(world, cau_vec3_of(pose->position_m)));
}
// True if both poses have the same position.
static inline bool cau_pose_is_same_place(const cau_pose *a, const cau_pose *b)
{
	return a->position_m[0] == b->position_m[0] && a->position_m[1] == b->position_m[1] &&
	       a->position_m[2] == b->position_m[2];
}

// True if both poses have the same rotation.
static inline bool cau_pose_is_same_turn(const cau_pose *a, const cau_pose *b)
{
	return a->rotation[0] == b->rotation[0] && a->rotation[1] == b->rotation[1] &&
	       a->rotation[2] == b->rotation[2] && a->rotation[3] == b->rotation[3];
}

// Returns the pose at a fraction s (0 to 1) of the way from a to b: linear in position, normalised
// linear in rotation.
static inline cau_pose cau_pose_between(const cau_pose *a, const cau_pose *b, double s)
{
	CAU_ASSERT(s >= 0 && s <= 1, "a share of %g of the way", s);
	cau_pose out;
	for (int i = 0; i < 3; i++)
		out.position_m[i] = a->position_m[i] + s * (b->position_m[i] - a->position_m[i]);
	double dot = 0, norm = 0;
	for (int i = 0; i < 4; i++)
		dot += a->rotation[i] * b->rotation[i];
	for (int i = 0; i < 4; i++) {
		out.rotation[i] = (1 - s) * a->rotation[i] + (dot < 0 ? -s : s) * b->rotation[i];
		norm += out.rotation[i] * out.rotation[i];
	}
	norm = sqrt(norm);
	for (int i = 0; i < 4; i++)
		out.rotation[i] = norm > 0 ? out.rotation[i] / norm : a->rotation[i];
	return out;
}

// ---- symmetric matrices (symmetric.c)
// Entries of 2x2: 00, 11, 01. Entries of 3x3: 00, 11, 22, 01, 02, 12.
// Computes eigenvalues (in no particular order) and orthonormal eigenvectors (columns of v,
// v[row][column]).
void cau_symmetric_eigen3(const double a[6], double value[3], double v[3][3]);

// Computes A^power by the eigenvalues. Eigenvalues below `floor` are replaced by `floor`.
void cau_symmetric_power3(const double a[6], double power, double floor, double out[6]);
void cau_symmetric_power2(const double a[3], double power, double floor, double out[3]);

// ---- keys along a Morton curve
// Points that are close together have keys that are close together.
enum { CAU_MORTON_BITS = 10 }; // bits of each coordinate

static inline uint32_t cau_morton_spread(uint32_t x) // moves 10 bits to every third bit
{
	CAU_ASSERT(x < 1u << CAU_MORTON_BITS, "%u has more than 10 bits", x);
	x = (x | x << 16) & 0x030000ffu;
	x = (x | x << 8) & 0x0300f00fu;
	x = (x | x << 4) & 0x030c30c3u;
	return (x | x << 2) & 0x09249249u;
}

// Returns the key of a point in the unit cube.
static inline uint32_t cau_morton(const double place[3])
{
	const double most = (1 << CAU_MORTON_BITS) - 1;
	uint32_t key = 0;
	for (int c = 0; c < 3; c++)
		key |= cau_morton_spread((uint32_t)(place[c] * most)) << c;
	return key;
}
