// SPDX-License-Identifier: GPL-3.0-or-later
// Vectors of lanes for the element kernels, in GCC and Clang vector extensions. A kernel file is
// compiled once per precision and instruction set: CAU_SINGLE is 1 or 0, the compiler's flags say
// the rest. A batch always has CAU_LANES elements, so data are laid out alike on every tier.
#pragma once

#include <math.h>
#include <stdint.h>
#if defined(__AVX2__) || defined(__AVX512F__)
#include <immintrin.h>
#endif

#if CAU_SINGLE
typedef float real;
typedef int32_t real_bits;
enum { LANES = 16 };
#define REAL_TINY 1e-30f
#define REAL_EPSILON 1.2e-7f
#else
typedef double real;
typedef int64_t real_bits;
enum { LANES = 8 };
#define REAL_TINY 1e-290
#define REAL_EPSILON 2.3e-16
#endif

typedef real vreal __attribute__((vector_size(64), may_alias));
typedef real_bits vmask __attribute__((vector_size(64), may_alias));
typedef real vreal_memory __attribute__((vector_size(64), may_alias, aligned(4)));

#define INLINE static inline __attribute__((always_inline))

INLINE vreal v_set(real a)
{
	return (vreal){0} + a;
}
INLINE vreal v_load(const void *from, int32_t slot)
{
	return *(const vreal_memory *)((const real *)from + slot);
}
INLINE void v_store(void *to, int32_t slot, vreal a)
{
	*(vreal_memory *)((real *)to + slot) = a;
}
INLINE vreal v_select(vmask m, vreal yes, vreal no)
{
	return (vreal)((m & (vmask)yes) | (~m & (vmask)no));
}
INLINE vreal v_max(vreal a, vreal b)
{
	return v_select(a > b, a, b);
}
INLINE vreal v_min(vreal a, vreal b)
{
	return v_select(a < b, a, b);
}
INLINE vreal v_abs(vreal a)
{
	return v_max(a, -a);
}
INLINE vreal v_clamp(vreal a, real least, real most)
{
	return v_min(v_max(a, v_set(least)), v_set(most));
}
INLINE int v_any(vmask m)
{
#if defined(__AVX512F__)
	return _mm512_test_epi32_mask((__m512i)m, (__m512i)m) != 0;
#elif defined(__AVX2__)
	union {
		vmask v;
		__m256i half[2];
	} u = {m};
	__m256i either = _mm256_or_si256(u.half[0], u.half[1]);
	return !_mm256_testz_si256(either, either);
#else
	real_bits any = 0;
	for (int l = 0; l < LANES; ++l)
		any |= m[l];
	return any != 0;
#endif
}
INLINE vreal v_sqrt(vreal a)
{
#if CAU_SINGLE && defined(__AVX512F__)
	return (vreal)_mm512_sqrt_ps((__m512)a);
#elif !CAU_SINGLE && defined(__AVX512F__)
	return (vreal)_mm512_sqrt_pd((__m512d)a);
#elif CAU_SINGLE && defined(__AVX2__)
	union {
		vreal v;
		__m256 half[2];
	} u = {a};
	u.half[0] = _mm256_sqrt_ps(u.half[0]);
	u.half[1] = _mm256_sqrt_ps(u.half[1]);
	return u.v;
#else
	vreal root;
	for (int l = 0; l < LANES; ++l)
#if CAU_SINGLE
		root[l] = sqrtf(a[l]);
#else
		root[l] = sqrt(a[l]);
#endif
	return root;
#endif
}

// Sums in double: lanes are widened and folded to eight partial sums, these are added up at the end
// by halves. The same on every tier.
typedef double vsum __attribute__((vector_size(64)));
INLINE vsum v_widen(vreal a)
{
#if CAU_SINGLE
	typedef float half_lanes __attribute__((vector_size(32)));
	union {
		vreal whole;
		half_lanes half[2];
	} u = {a};
	return __builtin_convertvector(u.half[0], vsum) + __builtin_convertvector(u.half[1], vsum);
#else
	return (vsum)a;
#endif
}
INLINE double v_total(vsum a)
{
	for (int width = 4; width; width /= 2)
		for (int l = 0; l < width; ++l)
			a[l] += a[l + width];
	return a[0];
}
INLINE double v_sum(vreal a)
{
	return v_total(v_widen(a));
}

// ---- three-vectors and small matrices of lanes
typedef struct v3 {
	vreal x, y, z;
} v3;
typedef struct m3 { // columns
	v3 c[3];
} m3;
typedef struct sym2 {
	vreal a00, a11, a01;
} sym2;
typedef struct sym3 {
	vreal a00, a11, a22, a01, a02, a12;
} sym3;

INLINE v3 v3_add(v3 a, v3 b)
{
	return (v3){a.x + b.x, a.y + b.y, a.z + b.z};
}
INLINE v3 v3_sub(v3 a, v3 b)
{
	return (v3){a.x - b.x, a.y - b.y, a.z - b.z};
}
INLINE v3 v3_scale(vreal s, v3 a)
{
	return (v3){s * a.x, s * a.y, s * a.z};
}
// a + s b
INLINE v3 v3_add_scaled(v3 a, vreal s, v3 b)
{
	return (v3){a.x + s * b.x, a.y + s * b.y, a.z + s * b.z};
}
INLINE vreal v3_dot(v3 a, v3 b)
{
	return a.x * b.x + a.y * b.y + a.z * b.z;
}
INLINE v3 v3_cross(v3 a, v3 b)
{
	return (v3){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
INLINE v3 v3_select(vmask m, v3 yes, v3 no)
{
	return (v3){v_select(m, yes.x, no.x), v_select(m, yes.y, no.y), v_select(m, yes.z, no.z)};
}
INLINE v3 v3_zero(void)
{
	return (v3){v_set(0), v_set(0), v_set(0)};
}
INLINE m3 m3_add(m3 a, m3 b)
{
	return (m3){{v3_add(a.c[0], b.c[0]), v3_add(a.c[1], b.c[1]), v3_add(a.c[2], b.c[2])}};
}
INLINE m3 m3_sub(m3 a, m3 b)
{
	return (m3){{v3_sub(a.c[0], b.c[0]), v3_sub(a.c[1], b.c[1]), v3_sub(a.c[2], b.c[2])}};
}
INLINE m3 m3_scale(vreal s, m3 a)
{
	return (m3){{v3_scale(s, a.c[0]), v3_scale(s, a.c[1]), v3_scale(s, a.c[2])}};
}
INLINE m3 m3_add_scaled(m3 a, vreal s, m3 b)
{
	return m3_add(a, m3_scale(s, b));
}
INLINE m3 m3_identity(void)
{
	vreal one = v_set(1), zero = v_set(0);
	return (m3){{{one, zero, zero}, {zero, one, zero}, {zero, zero, one}}};
}
INLINE m3 m3_select(vmask m, m3 yes, m3 no)
{
	return (m3){{v3_select(m, yes.c[0], no.c[0]), v3_select(m, yes.c[1], no.c[1]),
	             v3_select(m, yes.c[2], no.c[2])}};
}
INLINE vreal m3_dot(m3 a, m3 b)
{
	return v3_dot(a.c[0], b.c[0]) + v3_dot(a.c[1], b.c[1]) + v3_dot(a.c[2], b.c[2]);
}
INLINE vreal m3_trace(m3 a)
{
	return a.c[0].x + a.c[1].y + a.c[2].z;
}
// Cofactor matrix: det(A) A^-T.
INLINE m3 m3_cofactor(m3 a)
{
	return (m3){{v3_cross(a.c[1], a.c[2]), v3_cross(a.c[2], a.c[0]), v3_cross(a.c[0], a.c[1])}};
}
INLINE vreal m3_determinant(m3 a)
{
	return v3_dot(a.c[0], v3_cross(a.c[1], a.c[2]));
}
// A v
INLINE v3 m3_apply(m3 a, v3 v)
{
	return v3_add_scaled(v3_add_scaled(v3_scale(v.x, a.c[0]), v.y, a.c[1]), v.z, a.c[2]);
}
// A S, S symmetric
INLINE m3 m3_times_sym(m3 a, sym3 s)
{
	return (m3){{m3_apply(a, (v3){s.a00, s.a01, s.a02}), m3_apply(a, (v3){s.a01, s.a11, s.a12}),
	             m3_apply(a, (v3){s.a02, s.a12, s.a22})}};
}
// A^T B, symmetric by assumption
INLINE sym3 m3_transpose_times(m3 a, m3 b)
{
	return (sym3){v3_dot(a.c[0], b.c[0]), v3_dot(a.c[1], b.c[1]), v3_dot(a.c[2], b.c[2]),
	              v3_dot(a.c[0], b.c[1]), v3_dot(a.c[0], b.c[2]), v3_dot(a.c[1], b.c[2])};
}

// ---- vertices: four reals each (x, y, z, unused)
// v3_gather reads one vertex of every lane; v3_add_to adds to one of every lane, lane by lane, so
// that lanes may name the same one. In float on AVX, four vertices are transposed at a time inside
// each 128-bit part of a vector: part j of row k is vertex 4 j + k.
#if CAU_SINGLE && defined(__AVX2__)
INLINE void vertex_add(real *field, int32_t vertex, __m128 a)
{
	real *at = field + 4 * (int64_t)vertex;
	_mm_store_ps(at, _mm_add_ps(_mm_load_ps(at), a));
}
#endif
#if CAU_SINGLE && defined(__AVX512F__)
typedef __m512 vertex_row;
INLINE vertex_row vertex_row_load(const real *field, const int32_t *vertex, int k)
{
	__m512 row = _mm512_castps128_ps512(_mm_load_ps(field + 4 * (int64_t)vertex[k]));
	row = _mm512_insertf32x4(row, _mm_load_ps(field + 4 * (int64_t)vertex[4 + k]), 1);
	row = _mm512_insertf32x4(row, _mm_load_ps(field + 4 * (int64_t)vertex[8 + k]), 2);
	return _mm512_insertf32x4(row, _mm_load_ps(field + 4 * (int64_t)vertex[12 + k]), 3);
}
INLINE void vertex_row_add(real *field, const int32_t *vertex, int k, vertex_row row)
{
	vertex_add(field, vertex[k], _mm512_castps512_ps128(row));
	vertex_add(field, vertex[4 + k], _mm512_extractf32x4_ps(row, 1));
	vertex_add(field, vertex[8 + k], _mm512_extractf32x4_ps(row, 2));
	vertex_add(field, vertex[12 + k], _mm512_extractf32x4_ps(row, 3));
}
#define ROW_LOW(a, b) _mm512_unpacklo_ps(a, b)
#define ROW_HIGH(a, b) _mm512_unpackhi_ps(a, b)
#define PAIR_LOW(a, b)                                                                             \
	_mm512_castpd_ps(_mm512_unpacklo_pd(_mm512_castps_pd(a), _mm512_castps_pd(b)))
#define PAIR_HIGH(a, b)                                                                            \
	_mm512_castpd_ps(_mm512_unpackhi_pd(_mm512_castps_pd(a), _mm512_castps_pd(b)))

INLINE v3 v3_gather(const real *field, const int32_t *vertex)
{
	vertex_row r0 = vertex_row_load(field, vertex, 0), r1 = vertex_row_load(field, vertex, 1);
	vertex_row r2 = vertex_row_load(field, vertex, 2), r3 = vertex_row_load(field, vertex, 3);
	vertex_row xy01 = ROW_LOW(r0, r1), z01 = ROW_HIGH(r0, r1);
	vertex_row xy23 = ROW_LOW(r2, r3), z23 = ROW_HIGH(r2, r3);
	return (v3){(vreal)PAIR_LOW(xy01, xy23), (vreal)PAIR_HIGH(xy01, xy23),
	            (vreal)PAIR_LOW(z01, z23)};
}
INLINE void v3_add_to(real *field, const int32_t *vertex, v3 a)
{
	vertex_row x = (vertex_row)a.x, y = (vertex_row)a.y, z = (vertex_row)a.z,
			   none = _mm512_setzero_ps();
	vertex_row xy_low = ROW_LOW(x, y), xy_high = ROW_HIGH(x, y);
	vertex_row z_low = ROW_LOW(z, none), z_high = ROW_HIGH(z, none);
	vertex_row_add(field, vertex, 0, PAIR_LOW(xy_low, z_low));
	vertex_row_add(field, vertex, 1, PAIR_HIGH(xy_low, z_low));
	vertex_row_add(field, vertex, 2, PAIR_LOW(xy_high, z_high));
	vertex_row_add(field, vertex, 3, PAIR_HIGH(xy_high, z_high));
}
#elif CAU_SINGLE && defined(__AVX2__)
typedef __m256 vertex_row;
INLINE vertex_row vertex_row_load(const real *field, const int32_t *vertex, int k)
{
	__m256 row = _mm256_castps128_ps256(_mm_load_ps(field + 4 * (int64_t)vertex[k]));
	return _mm256_insertf128_ps(row, _mm_load_ps(field + 4 * (int64_t)vertex[4 + k]), 1);
}
INLINE void vertex_row_add(real *field, const int32_t *vertex, int k, vertex_row row)
{
	vertex_add(field, vertex[k], _mm256_castps256_ps128(row));
	vertex_add(field, vertex[4 + k], _mm256_extractf128_ps(row, 1));
}
#define ROW_LOW(a, b) _mm256_unpacklo_ps(a, b)
#define ROW_HIGH(a, b) _mm256_unpackhi_ps(a, b)
#define PAIR_LOW(a, b)                                                                             \
	_mm256_castpd_ps(_mm256_unpacklo_pd(_mm256_castps_pd(a), _mm256_castps_pd(b)))
#define PAIR_HIGH(a, b)                                                                            \
	_mm256_castpd_ps(_mm256_unpackhi_pd(_mm256_castps_pd(a), _mm256_castps_pd(b)))
typedef union vector_halves {
	vreal whole;
	__m256 half[2];
} vector_halves;

INLINE v3 v3_gather(const real *field, const int32_t *vertex)
{
	vector_halves x, y, z;
	for (int h = 0; h < 2; ++h) {
		const int32_t *v = vertex + 8 * h;
		vertex_row r0 = vertex_row_load(field, v, 0), r1 = vertex_row_load(field, v, 1);
		vertex_row r2 = vertex_row_load(field, v, 2), r3 = vertex_row_load(field, v, 3);
		vertex_row xy01 = ROW_LOW(r0, r1), xy23 = ROW_LOW(r2, r3);
		x.half[h] = PAIR_LOW(xy01, xy23);
		y.half[h] = PAIR_HIGH(xy01, xy23);
		z.half[h] = PAIR_LOW(ROW_HIGH(r0, r1), ROW_HIGH(r2, r3));
	}
	return (v3){x.whole, y.whole, z.whole};
}
INLINE void v3_add_to(real *field, const int32_t *vertex, v3 a)
{
	vector_halves x = {a.x}, y = {a.y}, z = {a.z};
	for (int h = 0; h < 2; ++h) {
		const int32_t *at = vertex + 8 * h;
		vertex_row none = _mm256_setzero_ps();
		vertex_row xy_low = ROW_LOW(x.half[h], y.half[h]), xy_high = ROW_HIGH(x.half[h], y.half[h]);
		vertex_row z_low = ROW_LOW(z.half[h], none), z_high = ROW_HIGH(z.half[h], none);
		vertex_row_add(field, at, 0, PAIR_LOW(xy_low, z_low));
		vertex_row_add(field, at, 1, PAIR_HIGH(xy_low, z_low));
		vertex_row_add(field, at, 2, PAIR_LOW(xy_high, z_high));
		vertex_row_add(field, at, 3, PAIR_HIGH(xy_high, z_high));
	}
}
#else
INLINE v3 v3_gather(const real *field, const int32_t *vertex)
{
	v3 out = v3_zero();
	for (int l = 0; l < LANES; ++l) {
		const real *at = field + 4 * (int64_t)vertex[l];
		out.x[l] = at[0];
		out.y[l] = at[1];
		out.z[l] = at[2];
	}
	return out;
}
INLINE void v3_add_to(real *field, const int32_t *vertex, v3 a)
{
	for (int l = 0; l < LANES; ++l) {
		real *at = field + 4 * (int64_t)vertex[l];
		at[0] += a.x[l];
		at[1] += a.y[l];
		at[2] += a.z[l];
	}
}
#endif
