// SPDX-License-Identifier: GPL-3.0-or-later
// Factors H = L D L^T in blocks of 3 x 3, column by column (left-looking), and solves with it.
// Always in double: a sheet is softer across its plane than within it by a factor that single
// precision cannot represent.
#pragma once

#include <string.h>

#include "base/simd.h"
#include "solve/newton.h"

typedef double block_column __attribute__((vector_size(32)));

INLINE block_column *block_at(double *blocks, int32_t index)
{
	return (block_column *)(blocks + (int64_t)CAU_BLOCK * index);
}

// to -= a b, by fused multiply-adds
INLINE void block_subtract(block_column *to, const block_column *a, const block_column *b)
{
	for (int c = 0; c < 3; c++) {
		block_column sum = to[c] - a[0] * b[c][0];
		sum -= a[1] * b[c][1];
		to[c] = sum - a[2] * b[c][2];
	}
}

// to = a b
INLINE void block_multiply(block_column *to, const block_column *a, const block_column *b)
{
	for (int c = 0; c < 3; c++)
		to[c] = a[0] * b[c][0] + a[1] * b[c][1] + a[2] * b[c][2];
}

INLINE void block_transpose(block_column *to, const block_column *a)
{
	for (int c = 0; c < 3; c++)
		to[c] = (block_column){a[0][c], a[1][c], a[2][c], 0};
}

INLINE block_column block_cross(block_column a, block_column b)
{
	return (block_column){a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2],
	                      a[0] * b[1] - a[1] * b[0], 0};
}

// Inverts a symmetric block by its cofactors. Returns false if the block is not positive definite.
INLINE bool block_invert(block_column *to, const block_column *a)
{
	block_column cofactor = block_cross(a[1], a[2]);
	double minor = a[0][0] * a[1][1] - a[1][0] * a[1][0];
	double determinant = a[0][0] * cofactor[0] + a[0][1] * cofactor[1] + a[0][2] * cofactor[2];
	to[0] = cofactor / determinant;
	to[1] = block_cross(a[2], a[0]) / determinant;
	to[2] = block_cross(a[0], a[1]) / determinant;
	return a[0][0] > 0 && minor > 0 && determinant > 0;
}

// Appends column k to the list of columns that are subtracted at row[at]. The blocks of column k
// from `at` on are not yet subtracted.
INLINE void newton_wait(const cau_newton *newton, int32_t k, int32_t at)
{
	newton->at[k] = at;
	if (at == newton->first[k + 1])
		return;
	int32_t row = newton->row[at];
	newton->next[k] = newton->head[row];
	newton->head[row] = k;
}

// Subtracts L_ik D_k L_jk^T from column j. The block of column k at `at` is in row j.
INLINE void newton_subtract(const cau_newton *newton, int32_t k, int32_t at)
{
	block_column turned[3], factor[3];
	block_transpose(turned, block_at(newton->block, at));
	block_multiply(factor, block_at(newton->pivot, k), turned);
	for (int32_t i = at; i < newton->first[k + 1]; i++)
		block_subtract(block_at(newton->column, newton->row[i]), block_at(newton->block, i),
		               factor);
}

static bool newton_factor(const cau_newton *newton)
{
	const int32_t *first = newton->first, *row = newton->row;
	const size_t bytes = CAU_BLOCK * sizeof(double);
	memset(newton->head, -1, (size_t)newton->n * sizeof *newton->head);
	for (int32_t j = 0; j < newton->n; j++) {
		memcpy(block_at(newton->column, j), block_at(newton->pivot, j), bytes);
		for (int32_t i = first[j]; i < first[j + 1]; i++)
			memcpy(block_at(newton->column, row[i]), block_at(newton->block, i), bytes);
		for (int32_t k = newton->head[j], next; k >= 0; k = next) {
			next = newton->next[k];
			newton_subtract(newton, k, newton->at[k]);
			newton_wait(newton, k, newton->at[k] + 1);
		}
		block_column *inverse = block_at(newton->inverse, j);
		memcpy(block_at(newton->pivot, j), block_at(newton->column, j), bytes);
		if (!block_invert(inverse, block_at(newton->pivot, j)))
			return false;
		for (int32_t i = first[j]; i < first[j + 1]; i++)
			block_multiply(block_at(newton->block, i), block_at(newton->column, row[i]), inverse);
		newton_wait(newton, j, first[j]);
	}
	return true;
}

INLINE block_column block_apply(const block_column *a, block_column x)
{
	return a[0] * x[0] + a[1] * x[1] + a[2] * x[2];
}

INLINE double block_dot(block_column a, block_column b)
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

// field = H^-1 field
static void newton_solve(const cau_newton *newton)
{
	const int32_t *first = newton->first, *row = newton->row;
	block_column *field = (block_column *)newton->field;
	for (int32_t j = 0; j < newton->n; j++)
		for (int32_t i = first[j]; i < first[j + 1]; i++)
			field[row[i]] -= block_apply(block_at(newton->block, i), field[j]);
	for (int32_t j = newton->n - 1; j >= 0; j--) {
		block_column x = block_apply(block_at(newton->inverse, j), field[j]);
		for (int32_t i = first[j]; i < first[j + 1]; i++) {
			const block_column *a = block_at(newton->block, i);
			block_column y = field[row[i]];
			x -= (block_column){block_dot(a[0], y), block_dot(a[1], y), block_dot(a[2], y), 0};
		}
		field[j] = x;
	}
}
