// SPDX-License-Identifier: GPL-3.0-or-later
#include "mesh/index_sort.h"

#include <string.h>

#include "cautery/assert.h"
#include "mesh/mesh_memory.h"

// Makes one stable pass of a counting sort: `to` is `from` ordered by key[row * stride]. bucket
// (bound + 1) is scratch.
static void counting_pass(const int32_t *key, int stride, const int32_t *from, int32_t count,
                          int32_t *bucket, int32_t bound, int32_t *to)
{
	memset(bucket, 0, ((size_t)bound + 1) * sizeof *bucket);
	for (int32_t i = 0; i < count; i++) {
		CAU_ASSERT_INDEX(key[(size_t)i * (size_t)stride], bound);
		bucket[key[(size_t)i * (size_t)stride] + 1]++;
	}
	for (int32_t k = 0; k < bound; k++)
		bucket[k + 1] += bucket[k];
	for (int32_t i = 0; i < count; i++)
		to[bucket[key[(size_t)from[i] * (size_t)stride]]++] = from[i];
}

bool cau_index_sort(const int32_t *tuple, int width, int32_t count, int32_t bound, int32_t *order)
{
	CAU_ASSERT(width >= 1 && count >= 0 && bound >= 0, "%d rows of %d below %d", count, width,
	           bound);
	int32_t *from = cau_mesh_array((size_t)count, sizeof *from);
	int32_t *bucket = cau_mesh_array((size_t)bound + 1, sizeof *bucket);
	bool done = from && bucket;

	for (int32_t i = 0; done && i < count; i++)
		order[i] = i;
	for (int column = width - 1; done && column >= 0; column--) {
		memcpy(from, order, (size_t)count * sizeof *from);
		counting_pass(tuple + column, width, from, count, bucket, bound, order);
	}
	free(from);
	free(bucket);
	return done;
}
