// SPDX-License-Identifier: GPL-3.0-or-later
// Trusses and bending hinges. For both, G x is a single vector e (rank 1), and the energy drives
// the length of e to a rest length.
#pragma once

#include "base/simd.h"
#include "constraint/elements.h"

// Returns R = e - |rest| e/|e| with e = rest + d. R is computed so that it is exactly zero at d =
// 0: |e| - L = (2 rest.d + d.d) / (|e| + L). A flat hinge has L = 0 and R = e.
INLINE v3 length_residual(v3 rest, v3 d, vreal rest_length)
{
	v3 e = v3_add(rest, d);
	vreal longer = 2 * v3_dot(rest, d) + v3_dot(d, d);
	vreal length = v_sqrt(v_max(v3_dot(e, e), v_set(REAL_TINY)));
	vreal step = longer / ((length + rest_length) * length);
	return v3_select(rest_length > v_set(0), v3_scale(step, e), d);
}

// Handles slots [first, last) and returns their energy, J. The diagonal system scales R by |G|^2 /
// vertices x |R|^2 / |R G^T|^2. For these elements of rank 1, this scale is 1 / vertices for every
// G.
static double link_kernel(const cau_elements *elements, int32_t first, int32_t last,
                          const real *displacement, real *records, bool diagonal)
{
	const cau_link_set *set = &elements->link;
	real scale = diagonal ? (real)0.5 : 1;
	vsum energy = {0};
	for (int32_t slot = first; slot < last; slot += LANES) {
		v3 d = v3_sub(v3_gather(displacement, set->record_at[1] + slot),
		              v3_gather(displacement, set->record_at[0] + slot));
		v3 rest = {v_load(set->rest[0], slot), v_load(set->rest[1], slot),
		           v_load(set->rest[2], slot)};
		v3 r = length_residual(rest, d, v_load(set->rest_length, slot));
		vreal w = v_load(set->weight, slot);
		energy += v_widen(w * v3_dot(r, r));
		v3 g = v3_scale(scale * w, r);
		v3_add_to(records, set->record_at[0] + slot, v3_sub(v3_zero(), g));
		v3_add_to(records, set->record_at[1] + slot, g);
	}
	return 0.5 * v_total(energy);
}

static double hinge_kernel(const cau_elements *elements, int32_t first, int32_t last,
                           const real *displacement, real *records, bool diagonal)
{
	const cau_hinge_set *set = &elements->hinge;
	real scale = diagonal ? (real)0.25 : 1;
	vsum energy = {0};
	for (int32_t slot = first; slot < last; slot += LANES) {
		vreal c[4];
		v3 d = v3_zero();
		for (int i = 0; i < 4; i++) {
			c[i] = v_load(set->coefficient[i], slot);
			d = v3_add_scaled(d, c[i], v3_gather(displacement, set->record_at[i] + slot));
		}
		v3 rest = {v_load(set->rest[0], slot), v_load(set->rest[1], slot),
		           v_load(set->rest[2], slot)};
		v3 r = length_residual(rest, d, v_load(set->rest_length, slot));
		vreal w = v_load(set->weight, slot);
		energy += v_widen(w * v3_dot(r, r));
		for (int i = 0; i < 4; i++)
			v3_add_to(records, set->record_at[i] + slot, v3_scale(scale * w * c[i], r));
	}
	return 0.5 * v_total(energy);
}
