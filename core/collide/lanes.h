// SPDX-License-Identifier: GPL-3.0-or-later
// Boxes in groups of eight, so that one box is tested against eight boxes at a time. Boxes are
// stored as floats. Rounding keeps order, so boxes that meet in double precision also meet as
// floats. The caller tests in double precision which of the found boxes really meet.
#pragma once

#include <stdint.h>
#if defined(__SSE2__)
#include <xmmintrin.h>
#endif

enum { CAU_LANES = 8, CAU_LANE_QUAD = 4 };

// A group of eight boxes. `least` is less by the contact thickness, so that boxes also meet that
// only come near.
typedef struct cau_collide_lanes {
	_Alignas(sizeof(float[CAU_LANE_QUAD])) float least[3][CAU_LANES], most[3][CAU_LANES];
} cau_collide_lanes;

// Vectors of four floats and of four masks. cau_collide_asking is one box that is tested against
// groups.
typedef float cau_lane_quad __attribute__((vector_size(CAU_LANE_QUAD * sizeof(float)), may_alias));
typedef int32_t cau_lane_mask
	__attribute__((vector_size(CAU_LANE_QUAD * sizeof(float)), may_alias));
typedef struct cau_collide_asking {
	cau_lane_quad least[3], most[3];
} cau_collide_asking;

// Limits a value to +-1e30, so that it fits into a float.
static inline float cau_lane_float(double value)
{
	const double most = 1e30;
	value = value < most ? value : most;
	return (float)(value > -most ? value : -most);
}

static inline void cau_lanes_put(cau_collide_lanes *to, int lane, const double least[3],
                                 const double most[3], double thickness_m)
{
	for (int c = 0; c < 3; c++) {
		to->least[c][lane] = cau_lane_float(least[c] - thickness_m);
		to->most[c][lane] = cau_lane_float(most[c]);
	}
}

// Sets the lanes from `lane` on to boxes that meet no other box.
static inline void cau_lanes_close(cau_collide_lanes *to, int lane)
{
	const float nowhere = 2e30f;
	for (; lane < CAU_LANES; lane++)
		for (int c = 0; c < 3; c++) {
			to->least[c][lane] = nowhere;
			to->most[c][lane] = -nowhere;
		}
}

static inline void cau_lanes_copy(cau_collide_lanes *to, int lane, const cau_collide_lanes *from,
                                  int of)
{
	for (int c = 0; c < 3; c++) {
		to->least[c][lane] = from->least[c][of];
		to->most[c][lane] = from->most[c][of];
	}
}

static inline cau_collide_asking cau_lanes_ask(const cau_collide_lanes *from, int lane)
{
	cau_collide_asking asking;
	for (int c = 0; c < 3; c++) {
		asking.least[c] = (cau_lane_quad){0} + from->least[c][lane];
		asking.most[c] = (cau_lane_quad){0} + from->most[c][lane];
	}
	return asking;
}

static inline uint32_t cau_lane_bits(cau_lane_mask mask)
{
#if defined(__SSE2__)
	return (uint32_t)_mm_movemask_ps((__m128)mask);
#else
	return ((uint32_t)mask[0] & 1) | ((uint32_t)mask[1] & 2) | ((uint32_t)mask[2] & 4) |
	       ((uint32_t)mask[3] & 8);
#endif
}

static inline uint32_t cau_lanes_meet_quad(const cau_collide_lanes *group, int quad,
                                           const cau_collide_asking *asking)
{
	cau_lane_mask met = {-1, -1, -1, -1};
	for (int c = 0; c < 3; c++) {
		const cau_lane_quad *least = (const cau_lane_quad *)group->least[c],
							*most = (const cau_lane_quad *)group->most[c];
		met &= (asking->least[c] <= most[quad]) & (least[quad] <= asking->most[c]);
	}
	return cau_lane_bits(met);
}

// Returns which boxes of the group meet the box, one bit for each.
static inline uint32_t cau_lanes_meet(const cau_collide_lanes *group,
                                      const cau_collide_asking *asking)
{
	return cau_lanes_meet_quad(group, 0, asking) | cau_lanes_meet_quad(group, 1, asking)
	                                                   << CAU_LANE_QUAD;
}
