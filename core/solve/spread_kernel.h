// SPDX-License-Identifier: GPL-3.0-or-later
// Computes increment += C f: columns of A^-1 times the loads on them. The vertices of a few
// registers are processed at a time, and their sums stay in the registers for all columns.
// Otherwise the sums would be read and written far more often than a column is read. The columns
// are added to each vertex in their order.
#pragma once

#include "base/simd.h"
#include "cautery/assert.h"
#include "solve/kernels.h"

// SPREAD_VERTICES: vertices that fit in a register. In double they are processed one by one,
// because one vertex fills at least half a register of the wider tiers.
enum {
	SPREAD_VERTICES = CAU_SINGLE ? VECTOR_BYTES / sizeof(vertex_reals) : 1,
	SPREAD_REGISTERS = 4,
	SPREAD_STRIP = SPREAD_REGISTERS * SPREAD_VERTICES,
};
typedef real spread_reals
	__attribute__((vector_size(SPREAD_VERTICES * sizeof(vertex_reals)), may_alias));
typedef real spread_memory __attribute__((vector_size(SPREAD_VERTICES * sizeof(vertex_reals)),
                                          may_alias, aligned(4 * sizeof(real))));

// The load on a column, repeated for each vertex of a register.
INLINE spread_reals spread_load(const double load[3])
{
	spread_reals f = {0};
	for (int i = 0; i < SPREAD_VERTICES; i++)
		for (int c = 0; c < 3; c++)
			f[4 * i + c] = (real)load[c];
	return f;
}

// Returns out + weight * load, vertex by vertex.
INLINE spread_reals spread_add(spread_reals out, const real *weight, spread_reals load)
{
#if defined(__AVX512F__) && CAU_SINGLE
	const __m512i each = _mm512_set_epi32(3, 3, 3, 3, 2, 2, 2, 2, 1, 1, 1, 1, 0, 0, 0, 0);
	__m512 of = _mm512_castps128_ps512(_mm_loadu_ps(weight));
	return out + (spread_reals)_mm512_permutexvar_ps(each, of) * load;
#elif defined(__AVX2__) && CAU_SINGLE
	__m256 of = _mm256_castps128_ps256(_mm_set1_ps(weight[0]));
	return out + (spread_reals)_mm256_insertf128_ps(of, _mm_set1_ps(weight[1]), 1) * load;
#else
	return out + weight[0] * load;
#endif
}

enum { SPREAD_COLUMNS = 16 }; // columns whose loads are copied to the layout of registers at once

INLINE void spread_strip(real *increment, const cau_reals *const *column, const spread_reals *load,
                         int32_t count, int32_t first)
{
	spread_memory *at = (spread_memory *)(increment + 4 * (int64_t)first);
	spread_reals out[SPREAD_REGISTERS];
	for (int i = 0; i < SPREAD_REGISTERS; i++)
		out[i] = at[i];
	for (int32_t k = 0; k < count; k++)
		for (int i = 0; i < SPREAD_REGISTERS; i++)
			out[i] =
				spread_add(out[i], (const real *)column[k] + first + i * SPREAD_VERTICES, load[k]);
	for (int i = 0; i < SPREAD_REGISTERS; i++)
		at[i] = out[i];
}

// Adds the columns at one vertex after the last whole strip.
INLINE void spread_vertex(real *increment, const cau_reals *const *column, const spread_reals *load,
                          int32_t count, int32_t vertex)
{
	vertex_reals *at = (vertex_reals *)increment + vertex, out = *at;
	for (int32_t k = 0; k < count; k++)
		out += ((const real *)column[k])[vertex] * *(const vertex_reals *)&load[k];
	*at = out;
}

static void spread(cau_reals *increment, const cau_reals *const *column, const double *load,
                   int32_t count, int32_t first, int32_t last)
{
	CAU_ASSERT(first <= last && count >= 0, "vertices %d to %d by %d columns", first, last, count);
	real *to = (real *)increment;
	for (int32_t k = 0; k < count; k += SPREAD_COLUMNS) {
		int32_t few = count - k < SPREAD_COLUMNS ? count - k : SPREAD_COLUMNS, v = first;
		spread_reals f[SPREAD_COLUMNS];
		for (int32_t i = 0; i < few; i++)
			f[i] = spread_load(load + 3 * (int64_t)(k + i));
		for (; v + SPREAD_STRIP <= last; v += SPREAD_STRIP)
			spread_strip(to, column + k, f, few, v);
		for (; v < last; v++)
			spread_vertex(to, column + k, f, few, v);
	}
}
