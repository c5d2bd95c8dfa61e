// SPDX-License-Identifier: GPL-3.0-or-later
#include "cautery/assert.h"
#include "heat/exposure.h"

// The output function of the generator splitmix64 (Steele, Lea and Flood 2014): a bijection that
// mixes all bits.
static uint64_t mix(uint64_t value)
{
	value += UINT64_C(0x9E3779B97F4A7C15);
	value = (value ^ (value >> 30)) * UINT64_C(0xBF58476D1CE4E5B9);
	value = (value ^ (value >> 27)) * UINT64_C(0x94D049BB133111EB);
	return value ^ (value >> 31);
}

// Returns a uniform number in (0, 1), from the upper 53 bits.
static double unit(uint64_t value)
{
	return ((double)(value >> 11) + 0.5) * 0x1p-53;
}

// Returns a standard normal number by Box-Muller, limited to -3 to 3.
static double normal(uint64_t seed, uint64_t where)
{
	uint64_t first = mix(mix(seed) ^ where);
	uint64_t second = mix(first);
	double g = sqrt(-2 * log(unit(first))) * cos(2 * M_PI * unit(second));
	return fmin(fmax(g, -3), 3);
}

static double ignition(double mean_c, double spread_c, double g)
{
	return fmax(mean_c + spread_c * g, 0.1 * mean_c);
}

double cau_ignition_of(double mean_c, double spread_c, uint64_t seed, int32_t layer, int32_t edge)
{
	CAU_ASSERT(spread_c >= 0, "a spread of %g degC", spread_c);
	CAU_ASSERT(layer >= 0 && edge >= 0, "edge %d of layer %d", edge, layer);
	uint64_t where = (uint64_t)(uint32_t)layer << 32 | (uint32_t)edge;
	return ignition(mean_c, spread_c, normal(seed, where));
}

// ---- bundles
static const double bundle_length = 8; // length of a bundle over its width

static double smooth(double t)
{
	return t * t * (3 - 2 * t);
}

// Returns the draw of one node of the lattice. Each coordinate has 21 bits, so nodes that are far
// apart may have equal draws.
static double node_draw(uint64_t seed, int32_t layer, const int64_t node[3])
{
	uint64_t where = 0;
	for (int c = 0; c < 3; c++)
		where = where << 21 | ((uint64_t)node[c] & 0x1FFFFF);
	return normal(seed ^ mix((uint64_t)(uint32_t)layer + 1), where);
}

double cau_ignition_in_bundles(double mean_c, double spread_c, uint64_t seed, int32_t layer,
                               cau_vec3 place, cau_vec3 fibre, double bundle_m)
{
	CAU_ASSERT(bundle_m > 0, "bundles of %g m", bundle_m);
	CAU_ASSERT(fabs(cau_dot(fibre, fibre) - 1) < 1e-9, "a fibre of length %g", cau_length(fibre));
	// Rest space is compressed along the fibres. Lengths are in cells of the lattice.
	double squeeze = (1 / bundle_length - 1) * cau_dot(place, fibre);
	cau_vec3 squeezed = cau_scale(1 / bundle_m, cau_add(place, cau_scale(squeeze, fibre)));
	double at[3], share[3];
	cau_vec3_to(squeezed, at);
	int64_t low[3];
	for (int c = 0; c < 3; c++) {
		low[c] = (int64_t)floor(at[c]);
		share[c] = smooth(at[c] - (double)low[c]);
	}
	// The weights of the eight corners are scaled so that the sum of draws is standard normal
	// everywhere.
	double sum = 0, squares = 0;
	for (int corner = 0; corner < 8; corner++) {
		int64_t node[3];
		double weight = 1;
		for (int c = 0; c < 3; c++) {
			int high = corner >> c & 1;
			node[c] = low[c] + high;
			weight *= high ? share[c] : 1 - share[c];
		}
		sum += weight * node_draw(seed, layer, node);
		squares += weight * weight;
	}
	return ignition(mean_c, spread_c, fmin(fmax(sum / sqrt(squares), -3), 3));
}
