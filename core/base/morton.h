// SPDX-License-Identifier: GPL-3.0-or-later
// Keys along a Morton curve: points that are close together have keys that are close together.
#pragma once

#include <stdint.h>

#include "cautery/assert.h"

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
