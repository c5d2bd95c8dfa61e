// SPDX-License-Identifier: GPL-3.0-or-later
// Vectors of lanes for the element kernels, in GCC and Clang vector extensions. A kernel file is
// compiled once per precision and instruction set. CAU_SINGLE is 1 or 0; the compiler's flags
// define the instruction set. A vector is as wide as the tier's registers. A batch (CAU_BATCH
// slots) is a whole number of vectors on every tier, so the layout of data is the same on all
// tiers.
#pragma once

#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#if defined(__SSE2__)
#include <immintrin.h>
#endif

#if defined(__AVX512F__)
enum { VECTOR_BYTES = 64 };
#elif defined(__AVX2__)
enum { VECTOR_BYTES = 32 };
#else
enum { VECTOR_BYTES = 16 };
#endif

#if CAU_SINGLE
typedef float real;
typedef int32_t real_bits;
#define REAL_TINY 1e-30f
#define REAL_EPSILON 1.2e-7f
#else
typedef double real;
typedef int64_t real_bits;
#define REAL_TINY 1e-290
#define REAL_EPSILON 2.3e-16
#endif
enum { LANES = VECTOR_BYTES / sizeof(real) };

typedef real vreal __attribute__((vector_size(VECTOR_BYTES), may_alias));
typedef real_bits vmask __attribute__((vector_size(VECTOR_BYTES), may_alias));
typedef real vreal_memory __attribute__((vector_size(VECTOR_BYTES), may_alias, aligned(4)));

typedef real vertex_reals __attribute__((vector_size(4 * sizeof(real)), may_alias)); // x, y, z, 0

#define INLINE static inline __attribute__((always_inline))

// V_PREFIX(name) is this tier's intrinsic, if the tier has intrinsics.
#if defined(__AVX512F__)
#define V_PREFIX(name) _mm512_##name
#define V_INTEGER(a) ((__m512i)(a))
#elif defined(__AVX2__)
#define V_PREFIX(name) _mm256_##name
#define V_INTEGER(a) ((__m256i)(a))
#elif defined(__SSE2__)
#define V_PREFIX(name) _mm_##name
#define V_INTEGER(a) ((__m128i)(a))
#endif
#if defined(__SSE2__) && CAU_SINGLE
#define V_CALL(name, ...) ((vreal)V_PREFIX(name##_ps)(__VA_ARGS__))
#elif defined(__SSE2__)
#define V_CALL(name, ...) ((vreal)V_PREFIX(name##_pd)(__VA_ARGS__))
#endif

INLINE vreal v_set(real a)
{
#if defined(__SSE2__)
	return V_CALL(set1, a);
#else
	return (vreal){0} + a;
#endif
}
INLINE vreal v_load(const void *from, int32_t slot)
{
	return *(const vreal_memory *)((const real *)from + slot);
}
INLINE void v_store(void *to, int32_t slot, vreal a)
{
	*(vreal_memory *)((real *)to + slot) = a;
}
// Prefetches a batch's part of an array.
INLINE void v_prefetch(const void *array, int32_t slot)
{
	__builtin_prefetch((const real *)array + slot);
}
// Narrow numbers are 16-bit multiples of a scale that is stored separately. They are for data that
// are read far more often than written, and need not be exact.
enum { NARROW_MOST = INT16_MAX };
typedef int16_t narrow_lanes
	__attribute__((vector_size(LANES * sizeof(int16_t)), may_alias, aligned(2)));
INLINE vreal v_load_narrow(const int16_t *from)
{
#if defined(__AVX512F__) && CAU_SINGLE
	return (vreal)_mm512_cvtepi32_ps(_mm512_cvtepi16_epi32(_mm256_loadu_si256((const void *)from)));
#elif defined(__AVX2__) && CAU_SINGLE
	return (vreal)_mm256_cvtepi32_ps(_mm256_cvtepi16_epi32(_mm_loadu_si128((const void *)from)));
#else
	return __builtin_convertvector(__builtin_convertvector(*(const narrow_lanes *)from, vmask),
	                               vreal);
#endif
}
// Makes the compiler read values again that were loaded before. Otherwise it would keep every value
// of an element's twenty arrays on the stack. A second read costs less than a write to the stack.
INLINE void v_forget(void)
{
	__asm__ volatile("" ::: "memory");
}
INLINE vreal v_select(vmask m, vreal yes, vreal no)
{
	return (vreal)((m & (vmask)yes) | (~m & (vmask)no));
}
INLINE vreal v_max(vreal a, vreal b)
{
#if defined(__SSE2__)
	return V_CALL(max, a, b);
#else
	return v_select(a > b, a, b);
#endif
}
INLINE vreal v_min(vreal a, vreal b)
{
#if defined(__SSE2__)
	return V_CALL(min, a, b);
#else
	return v_select(a < b, a, b);
#endif
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
	return _mm512_test_epi32_mask(V_INTEGER(m), V_INTEGER(m)) != 0;
#elif defined(__AVX2__)
	return !_mm256_testz_si256(V_INTEGER(m), V_INTEGER(m));
#elif defined(__SSE2__)
	return _mm_movemask_epi8(V_INTEGER(m)) != 0;
#else
	real_bits any = 0;
	for (int l = 0; l < LANES; l++)
		any |= m[l];
	return any != 0;
#endif
}
INLINE vreal v_sqrt(vreal a)
{
#if defined(__SSE2__)
	return V_CALL(sqrt, a);
#else
	vreal root;
	for (int l = 0; l < LANES; l++)
#if CAU_SINGLE
		root[l] = sqrtf(a[l]);
#else
		root[l] = sqrt(a[l]);
#endif
	return root;
#endif
}

// A vector of sums in double. Lanes are widened (two halves of floats are added), and finally
// summed by halves.
enum { SUM_LANES = VECTOR_BYTES / sizeof(double) };
typedef double vsum __attribute__((vector_size(VECTOR_BYTES)));
INLINE vsum v_widen(vreal a)
{
#if CAU_SINGLE
	typedef float half_lanes __attribute__((vector_size(VECTOR_BYTES / 2)));
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
	for (int width = SUM_LANES / 2; width; width /= 2)
		for (int l = 0; l < width; l++)
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
typedef struct m3 { // a 3 x 3 matrix by columns
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
// A S, for a symmetric S
INLINE m3 m3_times_sym(m3 a, sym3 s)
{
	return (m3){{m3_apply(a, (v3){s.a00, s.a01, s.a02}), m3_apply(a, (v3){s.a01, s.a11, s.a12}),
	             m3_apply(a, (v3){s.a02, s.a12, s.a22})}};
}
// A^T B, assumed to be symmetric
INLINE sym3 m3_transpose_times(m3 a, m3 b)
{
	return (sym3){v3_dot(a.c[0], b.c[0]), v3_dot(a.c[1], b.c[1]), v3_dot(a.c[2], b.c[2]),
	              v3_dot(a.c[0], b.c[1]), v3_dot(a.c[0], b.c[2]), v3_dot(a.c[1], b.c[2])};
}

// ---- vertices: four reals each (x, y, z, unused)
// v3_gather reads one vertex for each lane. v3_add_to adds to one vertex for each lane, lane by
// lane, because several lanes may have the same vertex. `at` (LANES) has the index in `field` of
// each lane's vertex, in reals. The indices have sixteen bits, or 32 if `wide`. In float, four
// vertices are transposed at a time inside each 128-bit part of a vector. Part j of row k is vertex
// 4 j + k.
INLINE int32_t place_of(const void *at, int wide, int lane)
{
	return wide ? ((const int32_t *)at)[lane] : ((const uint16_t *)at)[lane];
}
#if CAU_SINGLE && defined(__SSE2__)
enum { PARTS = LANES / 4 };
INLINE vreal vertex_row_load(const real *field, const void *at, int wide, int k)
{
#define PART(j) _mm_load_ps(field + place_of(at, wide, 4 * (j) + k))
#if defined(__AVX512F__)
	__m512 row = _mm512_castps128_ps512(PART(0));
	row = _mm512_insertf32x4(row, PART(1), 1);
	row = _mm512_insertf32x4(row, PART(2), 2);
	return (vreal)_mm512_insertf32x4(row, PART(3), 3);
#elif defined(__AVX2__)
	return (vreal)_mm256_insertf128_ps(_mm256_castps128_ps256(PART(0)), PART(1), 1);
#else
	return (vreal)PART(0);
#endif
#undef PART
}
INLINE void vertex_row_add(real *field, const void *at, int wide, int k, vreal row)
{
	union {
		vreal whole;
		__m128 part[PARTS];
	} u = {row};
	for (int j = 0; j < PARTS; j++) {
		real *vertex = field + place_of(at, wide, 4 * j + k);
		_mm_store_ps(vertex, _mm_add_ps(_mm_load_ps(vertex), u.part[j]));
	}
}
// Interleave the low or high halves of each part of a and b: by single reals (row_) or by pairs of
// reals (pair_).
INLINE vreal row_low(vreal a, vreal b)
{
	return V_CALL(unpacklo, a, b);
}
INLINE vreal row_high(vreal a, vreal b)
{
	return V_CALL(unpackhi, a, b);
}
INLINE vreal pair_low(vreal a, vreal b)
{
	return (vreal)V_PREFIX(castpd_ps)(
		V_PREFIX(unpacklo_pd)(V_PREFIX(castps_pd)(a), V_PREFIX(castps_pd)(b)));
}
INLINE vreal pair_high(vreal a, vreal b)
{
	return (vreal)V_PREFIX(castpd_ps)(
		V_PREFIX(unpackhi_pd)(V_PREFIX(castps_pd)(a), V_PREFIX(castps_pd)(b)));
}
INLINE v3 v3_gather_at(const real *field, const void *at, int wide)
{
	vreal r0 = vertex_row_load(field, at, wide, 0), r1 = vertex_row_load(field, at, wide, 1);
	vreal r2 = vertex_row_load(field, at, wide, 2), r3 = vertex_row_load(field, at, wide, 3);
	vreal xy01 = row_low(r0, r1), xy23 = row_low(r2, r3);
	return (v3){pair_low(xy01, xy23), pair_high(xy01, xy23),
	            pair_low(row_high(r0, r1), row_high(r2, r3))};
}
INLINE void v3_add_at(real *field, const void *at, int wide, v3 a)
{
	vreal none = v_set(0);
	vreal xy_low = row_low(a.x, a.y), xy_high = row_high(a.x, a.y);
	vreal z_low = row_low(a.z, none), z_high = row_high(a.z, none);
	vertex_row_add(field, at, wide, 0, pair_low(xy_low, z_low));
	vertex_row_add(field, at, wide, 1, pair_high(xy_low, z_low));
	vertex_row_add(field, at, wide, 2, pair_low(xy_high, z_high));
	vertex_row_add(field, at, wide, 3, pair_high(xy_high, z_high));
}
// vertex -= s times the sum over all lanes
INLINE void v3_subtract_total(real *vertex, real s, v3 a)
{
	vreal none = v_set(0);
	vreal xy = row_low(a.x, a.y) + row_high(a.x, a.y);
	vreal z = row_low(a.z, none) + row_high(a.z, none);
	union {
		vreal whole;
		__m128 part[PARTS];
	} u = {pair_low(xy, z) + pair_high(xy, z)};
	__m128 total = u.part[0];
	for (int j = 1; j < PARTS; j++)
		total = _mm_add_ps(total, u.part[j]);
	_mm_store_ps(vertex, _mm_sub_ps(_mm_load_ps(vertex), _mm_mul_ps(_mm_set1_ps(s), total)));
}
#else
INLINE v3 v3_gather_at(const real *field, const void *at, int wide)
{
	v3 out = v3_zero();
	for (int l = 0; l < LANES; l++) {
		const real *vertex = field + place_of(at, wide, l);
		out.x[l] = vertex[0];
		out.y[l] = vertex[1];
		out.z[l] = vertex[2];
	}
	return out;
}
INLINE void v3_add_at(real *field, const void *at, int wide, v3 a)
{
	for (int l = 0; l < LANES; l++) {
		real *vertex = field + place_of(at, wide, l);
		vertex[0] += a.x[l];
		vertex[1] += a.y[l];
		vertex[2] += a.z[l];
	}
}
INLINE void v3_subtract_total(real *vertex, real s, v3 a)
{
	for (int width = LANES / 2; width; width /= 2)
		for (int l = 0; l < width; l++) {
			a.x[l] += a.x[l + width];
			a.y[l] += a.y[l + width];
			a.z[l] += a.z[l + width];
		}
	vertex[0] -= s * a.x[0];
	vertex[1] -= s * a.y[0];
	vertex[2] -= s * a.z[0];
}
#endif
INLINE v3 v3_gather(const real *field, const uint16_t *at)
{
	return v3_gather_at(field, at, 0);
}
INLINE v3 v3_gather_wide(const real *field, const int32_t *at)
{
	return v3_gather_at(field, at, 1);
}
INLINE void v3_add_to(real *field, const uint16_t *at, v3 a)
{
	v3_add_at(field, at, 0, a);
}
INLINE void v3_add_to_wide(real *field, const int32_t *at, v3 a)
{
	v3_add_at(field, at, 1, a);
}
