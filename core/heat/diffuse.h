// SPDX-License-Identifier: GPL-3.0-or-later
// One explicit step of the heat equation on a cubic grid (eq. 18-19, FTCS). Private to core/heat.
#pragma once

#include <stdint.h>

// Computes next = u + rate (sum of the six neighbours - 6 u) at every inner node of the (nodes x
// nodes x nodes) grid, x fastest. The outer nodes of `next` are not changed. `rate` is alpha dt /
// dl^2, at most 1/6 for stability.
void cau_diffuse(const float *temperature, float rate, float *next, int32_t nodes);

// Computes the step near a surface that is held at held_c: next = u + rate (sum - 6 u + pull
// (held_c - u)). Each node has its own rate and pull (heat_surface.c). A node with rate 0 keeps its
// value exactly.
void cau_diffuse_around(const float *temperature, const float *rate, const float *pull,
                        float held_c, float *next, int32_t nodes);

// Finds the least and the greatest of `count` values. `count` is at least 1.
void cau_extremes(const float *values, int64_t count, float *least, float *greatest);
