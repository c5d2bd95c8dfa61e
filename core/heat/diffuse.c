// SPDX-License-Identifier: GPL-3.0-or-later
#include "heat/diffuse.h"

#include "cautery/assert.h"

// Sum of the six nodes around node i. `row` and `plane` are the distances in memory to the next
// node along y and z.
#define SIX(u, i, row, plane)                                                                      \
	(u[i - 1] + u[i + 1] + u[i - row] + u[i + row] + u[i - plane] + u[i + plane])

// Computes one row of inner nodes along x. `u` and `next` point at the first inner node of the row.
static void diffuse_row(const float *restrict u, float rate, float *restrict next, int64_t count,
                        int64_t row, int64_t plane)
{
	CAU_ASSERT(count >= 1 && row == count + 2, "%lld inner nodes in a row of %lld",
	           (long long)count, (long long)row);
	for (int64_t x = 0; x < count; x++)
		next[x] = u[x] + rate * (SIX(u, x, row, plane) - 6.0F * u[x]);
}

static void diffuse_row_around(const float *restrict u, const float *restrict rate,
                               const float *restrict pull, float held_c, float *restrict next,
                               int64_t count, int64_t row, int64_t plane)
{
	CAU_ASSERT(count >= 1 && row == count + 2, "%lld inner nodes in a row of %lld",
	           (long long)count, (long long)row);
	for (int64_t x = 0; x < count; x++)
		next[x] =
			u[x] + rate[x] * (SIX(u, x, row, plane) - 6.0F * u[x] + pull[x] * (held_c - u[x]));
}

void cau_diffuse(const float *temperature, float rate, float *next, int32_t nodes)
{
	CAU_ASSERT(nodes >= 3 && temperature != next, "a grid of %d nodes, into itself", nodes);
	int64_t row = nodes, plane = row * row;
	for (int64_t z = 1; z < nodes - 1; z++)
		for (int64_t y = 1; y < nodes - 1; y++) {
			int64_t first = 1 + y * row + z * plane;
			diffuse_row(temperature + first, rate, next + first, nodes - 2, row, plane);
		}
}

void cau_diffuse_around(const float *temperature, const float *rate, const float *pull,
                        float held_c, float *next, int32_t nodes)
{
	CAU_ASSERT(nodes >= 3 && temperature != next, "a grid of %d nodes, into itself", nodes);
	int64_t row = nodes, plane = row * row;
	for (int64_t z = 1; z < nodes - 1; z++)
		for (int64_t y = 1; y < nodes - 1; y++) {
			int64_t first = 1 + y * row + z * plane;
			diffuse_row_around(temperature + first, rate + first, pull + first, held_c,
			                   next + first, nodes - 2, row, plane);
		}
}

// Uses 16 lanes instead of one running value, so that the compiler can vectorise the loop without
// reordering operations.
void cau_extremes(const float *values, int64_t count, float *least, float *greatest)
{
	CAU_ASSERT(count >= 1, "the extremes of %lld values", (long long)count);
	enum { LANES = 16 };
	float low[LANES], high[LANES];
	for (int lane = 0; lane < LANES; lane++)
		low[lane] = high[lane] = values[0];
	int64_t whole = count - count % LANES;
	for (int64_t i = 0; i < whole; i += LANES)
		for (int lane = 0; lane < LANES; lane++) {
			float value = values[i + lane];
			low[lane] = value < low[lane] ? value : low[lane];
			high[lane] = value > high[lane] ? value : high[lane];
		}
	for (int64_t i = whole; i < count; i++) {
		low[0] = values[i] < low[0] ? values[i] : low[0];
		high[0] = values[i] > high[0] ? values[i] : high[0];
	}
	*least = low[0];
	*greatest = high[0];
	for (int lane = 1; lane < LANES; lane++) {
		*least = low[lane] < *least ? low[lane] : *least;
		*greatest = high[lane] > *greatest ? high[lane] : *greatest;
	}
}
