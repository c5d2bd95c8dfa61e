// SPDX-License-Identifier: GPL-3.0-or-later
#include "heat/exposure.h"

// The output function of splitmix64 (Steele, Lea and Flood 2014): a bijection that mixes all bits.
static uint64_t mix(uint64_t value)
{
	value += UINT64_C(0x9E3779B97F4A7C15);
	value = (value ^ (value >> 30)) * UINT64_C(0xBF58476D1CE4E5B9);
	value = (value ^ (value >> 27)) * UINT64_C(0x94D049BB133111EB);
	return value ^ (value >> 31);
}

// Uniform in (0, 1), from the upper 53 bits.
static double unit(uint64_t value)
{
	return ((double)(value >> 11) + 0.5) * 0x1p-53;
}

double cau_ignition_of(double mean_c, double spread_c, uint64_t seed, int32_t layer, int32_t edge)
{
	uint64_t where = (uint64_t)(uint32_t)layer << 32 | (uint32_t)edge;
	uint64_t first = mix(mix(seed) ^ where);
	uint64_t second = mix(first);
	// Box-Muller
	double g = sqrt(-2 * log(unit(first))) * cos(2 * M_PI * unit(second));
	g = fmin(fmax(g, -3), 3);
	return fmax(mean_c + spread_c * g, 0.1 * mean_c);
}
