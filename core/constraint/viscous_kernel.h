// SPDX-License-Identifier: GPL-3.0-or-later
// Viscosity of tetrahedra and triangles (Kelvin-Voigt): an element has the stress S_v = t C : dE/dt
// in addition to its law's. E = (F^T F - I)/2 is Green's strain and C the stiffness at rest. t is
// the retardation time, viscosity / stiffness. E does not change as an element turns, so turning is
// not damped.
//
// In a solve dE/dt = (E(x) - R) / h. R is E at the tick's start. In the second of two substeps, R
// is E(x) + q/h (E(x1) - E(x)), from the start x and the result x1 of the first. So the stress is
// the gradient of t / (2 h) (E - R) : C : (E - R), which the objective includes (J).
#pragma once

#include "constraint/plasticity_kernel.h"
#include "constraint/sheet_kernel.h"

INLINE sym3 sym3_between(sym3 from, sym3 to, vreal share)
{
	return (sym3){from.a00 + share * (to.a00 - from.a00), from.a11 + share * (to.a11 - from.a11),
	              from.a22 + share * (to.a22 - from.a22), from.a01 + share * (to.a01 - from.a01),
	              from.a02 + share * (to.a02 - from.a02), from.a12 + share * (to.a12 - from.a12)};
}

INLINE m3 fat_gradient_at(const cau_fat_set *set, int32_t slot, const real *displacement)
{
	fat_face face = fat_face_gather(set, slot, displacement);
	return fat_displacement_gradient(set, slot, &face, displacement);
}

// Handles slots [first, last): R becomes R + share (E - R).
static void fat_strain_kernel(const cau_fat_set *set, int32_t first, int32_t last,
                              const real *displacement, double share)
{
	for (int32_t slot = first; slot < last; slot += LANES) {
		sym3 e = green_strain(fat_gradient_at(set, slot, displacement));
		if (share != 1)
			e = sym3_between(sym3_load(set->strain, slot), e, v_set((real)share));
		sym3_store(set->strain, slot, e);
	}
}

// Adds viscosity's gradients to the records. Returns viscosity's energy, J.
static double fat_viscous_kernel(const cau_fat_set *set, const cau_fat_group *group,
                                 double rate_per_s, int32_t first, int32_t last,
                                 const real *displacement, real *records)
{
	vsum energy = {0};
	real mu = (real)(group->viscous_mu * rate_per_s);
	real lambda = (real)(group->viscous_lambda * rate_per_s);
	for (int32_t slot = first; slot < last; slot += LANES) {
		m3 h = fat_gradient_at(set, slot, displacement);
		sym3 e = green_strain(h), r = sym3_load(set->strain, slot);
		sym3 d = {e.a00 - r.a00, e.a11 - r.a11, e.a22 - r.a22,
		          e.a01 - r.a01, e.a02 - r.a02, e.a12 - r.a12};
		vreal trace = d.a00 + d.a11 + d.a22, volume = v_load(set->volume, slot);
		energy += v_widen(volume * (mu * sym3_dot(d, d) + (real)0.5 * lambda * trace * trace));
		vreal l = lambda * trace, m = v_set(2 * mu);
		sym3 s = {m * d.a00 + l, m * d.a11 + l, m * d.a22 + l, m * d.a01, m * d.a02, m * d.a12};
		m3 stress = m3_scale(volume, m3_times_sym(m3_add(m3_identity(), h), s));
		v3 rest = v3_zero();
		for (int i = 0; i < 3; i++) {
			v3 g = fat_vertex_gradient(set, slot, stress, i);
			v3_add_to(records, set->record_at[i + 1] + slot, g);
			rest = v3_sub(rest, g);
		}
		v3_add_to(records, set->record_at[0] + slot, rest);
	}
	return v_total(energy);
}

// ---- triangles: C is the stiffness of their limit times the identity

typedef struct sheet_strain { // E, and the F at which it is computed
	vreal a00, a11, a01;
	sheet_gradient f;
} sheet_strain;

INLINE sheet_strain sheet_strain_at(const cau_sheet_set *set, int32_t slot,
                                    const real *displacement)
{
	const real half = (real)0.5;
	sheet_edge edge = sheet_edge_gather(set, slot, displacement);
	sheet_gradient h = sheet_displacement_gradient(set, slot, &edge, displacement);
	v3 f0[2];
	for (int a = 0; a < 2; a++)
		f0[a] = (v3){v_load(set->rest[3 * a], slot), v_load(set->rest[3 * a + 1], slot),
		             v_load(set->rest[3 * a + 2], slot)};
	sym2 k = sheet_metric_above_identity(f0, h.c);
	return (sheet_strain){
		half * k.a00, half * k.a11, half * k.a01, {{v3_add(f0[0], h.c[0]), v3_add(f0[1], h.c[1])}}};
}

INLINE vreal between(vreal from, vreal to, vreal share)
{
	return from + share * (to - from);
}

static void sheet_strain_kernel(const cau_sheet_set *set, int32_t first, int32_t last,
                                const real *displacement, double share)
{
	for (int32_t slot = first; slot < last; slot += LANES) {
		sheet_strain e = sheet_strain_at(set, slot, displacement);
		if (share != 1) {
			vreal s = v_set((real)share);
			e.a00 = between(v_load(set->strain[0], slot), e.a00, s);
			e.a11 = between(v_load(set->strain[1], slot), e.a11, s);
			e.a01 = between(v_load(set->strain[2], slot), e.a01, s);
		}
		v_store(set->strain[0], slot, e.a00);
		v_store(set->strain[1], slot, e.a11);
		v_store(set->strain[2], slot, e.a01);
	}
}

static double sheet_viscous_kernel(const cau_sheet_set *set, const cau_sheet_group *group,
                                   double rate_per_s, int32_t first, int32_t last,
                                   const real *displacement, real *records)
{
	vsum energy = {0};
	real scale = (real)(group->viscosity_s * rate_per_s);
	for (int32_t slot = first; slot < last; slot += LANES) {
		sheet_strain e = sheet_strain_at(set, slot, displacement);
		vreal d00 = e.a00 - v_load(set->strain[0], slot),
			  d11 = e.a11 - v_load(set->strain[1], slot),
			  d01 = e.a01 - v_load(set->strain[2], slot), w = scale * v_load(set->weight, slot);
		energy += v_widen(w * (d00 * d00 + d11 * d11 + 2 * d01 * d01));
		sheet_gradient stress = {{v3_add_scaled(v3_scale(w * d00, e.f.c[0]), w * d01, e.f.c[1]),
		                          v3_add_scaled(v3_scale(w * d01, e.f.c[0]), w * d11, e.f.c[1])}};
		v3 second = sheet_vertex_gradient(set, slot, stress, 0);
		v3 apex = sheet_vertex_gradient(set, slot, stress, 1);
		v3_add_to(records, set->record_at[1] + slot, second);
		v3_add_to(records, set->record_at[2] + slot, apex);
		v3_add_to(records, set->record_at[0] + slot, v3_sub(v3_sub(v3_zero(), second), apex));
	}
	return 0.5 * v_total(energy);
}
