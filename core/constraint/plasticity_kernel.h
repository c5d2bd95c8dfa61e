// SPDX-License-Identifier: GPL-3.0-or-later
// Counts inverted tetrahedra and applies plastic flow (section 5.2), once a tick after the last
// iteration. Let e' be the deviator of the elastic strain E_e = (F_e^T F_e - I)/2, and d = |e'| -
// gamma_1. If d > 0, e_p grows by (d / |e'|) e'. If e_p is longer than gamma_2, it is scaled back
// to gamma_2.
#pragma once

#include "constraint/fat_kernel.h"

INLINE vreal sym3_norm(sym3 a)
{
	return v_sqrt(v_max(sym3_dot(a, a), v_set(REAL_TINY)));
}

// Returns the deviator e' of the strain at H_e = F_e - I.
INLINE sym3 strain_deviator(m3 he)
{
	sym3 e = green_strain(he);
	vreal mean = (e.a00 + e.a11 + e.a22) * (real)(1.0 / 3.0);
	e.a00 -= mean, e.a11 -= mean, e.a22 -= mean;
	return e;
}

// True if a lane starts to flow. No lane has flowed before, so H_e = H.
INLINE bool plastic_begins(const cau_fat_group *group, m3 h)
{
	return v_any(sym3_norm(strain_deviator(h)) - (real)group->yield_strain > v_set(0));
}

// Returns e_p after flow. `flowed` marks the lanes that changed.
INLINE sym3 plastic_flow(const cau_fat_group *group, m3 h, sym3 z, sym3 plastic, vmask *flowed)
{
	m3 he = m3_add(h, m3_times_sym(h, z));
	he.c[0] = v3_add(he.c[0], (v3){z.a00, z.a01, z.a02});
	he.c[1] = v3_add(he.c[1], (v3){z.a01, z.a11, z.a12});
	he.c[2] = v3_add(he.c[2], (v3){z.a02, z.a12, z.a22});
	sym3 e = strain_deviator(he);
	vreal size = sym3_norm(e), beyond = size - (real)group->yield_strain;
	*flowed = beyond > v_set(0);
	vreal step = v_select(*flowed, beyond / size, v_set(0));
	sym3 p = {plastic.a00 + step * e.a00, plastic.a11 + step * e.a11, plastic.a22 + step * e.a22,
	          plastic.a01 + step * e.a01, plastic.a02 + step * e.a02, plastic.a12 + step * e.a12};
	vreal length = sym3_norm(p), most = v_set((real)group->plastic_strain_max);
	vreal scale = v_select(length > most, most / length, v_set(1));
	return (sym3){scale * p.a00, scale * p.a11, scale * p.a22,
	              scale * p.a01, scale * p.a02, scale * p.a12};
}

// Returns I + 2 e_p. e_p is bounded so that the result stays positive definite.
INLINE sym3 plastic_metric(sym3 p)
{
	vreal size = sym3_norm(p), most = v_set((real)0.45);
	vreal s = 2 * v_select(size > most, most / size, v_set(1));
	return (sym3){1 + s * p.a00, 1 + s * p.a11, 1 + s * p.a22, s * p.a01, s * p.a02, s * p.a12};
}

static void sym3_store(void *const array[6], int32_t slot, sym3 a)
{
	v_store(array[0], slot, a.a00);
	v_store(array[1], slot, a.a11);
	v_store(array[2], slot, a.a22);
	v_store(array[3], slot, a.a01);
	v_store(array[4], slot, a.a02);
	v_store(array[5], slot, a.a12);
}

// Computes C_p^(-1/2) - I of the slots that have flowed, for two vectors of slots. Both may be the
// same vector.
INLINE void plastic_maps(const cau_fat_set *set, const int32_t slot[2])
{
	sym3 z[2];
	for (int k = 0; k < 2; k++)
		z[k] = plastic_metric(sym3_load(set->plastic_strain, slot[k]));
	sym3_inverse_roots(z);
	for (int k = 0; k < 2; k++) {
		z[k].a00 -= 1, z[k].a11 -= 1, z[k].a22 -= 1;
		sym3_store(set->plastic, slot[k], z[k]);
	}
}

// Handles slots [first, last) of one group. Returns the number of live tetrahedra that are
// inverted.
static int32_t settle_kernel(const cau_elements *elements, const cau_fat_group *group,
                             int32_t first, int32_t last, const real *displacement)
{
	const cau_fat_set *set = &elements->fat;
	// `waiting` lists slots for which plastic_maps is still to be called
	int32_t inverted = 0, waiting[2], wait = 0;
	for (int32_t slot = first; slot < last; slot += LANES) {
		fat_face face = fat_face_gather(set, slot, displacement);
		m3 h = fat_displacement_gradient(set, slot, &face, displacement);
		vreal det = m3_determinant(m3_add(m3_identity(), h));
		vmask bad = (det <= v_set(0)) & (v_load(set->volume, slot) > v_set(0));
		for (int l = 0; l < LANES && v_any(bad); l++)
			inverted += bad[l] != 0;
		if (!group->plastic || (!set->flowed[slot / CAU_BATCH] && !plastic_begins(group, h)))
			continue;
		vmask flowed;
		sym3 p = plastic_flow(group, h, sym3_load(set->plastic, slot),
		                      sym3_load(set->plastic_strain, slot), &flowed);
		if (!v_any(flowed))
			continue;
		set->flowed[slot / CAU_BATCH] = 1;
		sym3_store(set->plastic_strain, slot, p);
		waiting[wait++] = slot;
		if (wait == 2)
			plastic_maps(set, waiting);
		wait %= 2;
	}
	if (wait)
		plastic_maps(set, (int32_t[]){waiting[0], waiting[0]});
	return inverted;
}
