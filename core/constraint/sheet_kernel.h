// SPDX-License-Identifier: GPL-3.0-or-later
// Gradient and energy of a range of triangles: the local step (eq. 6) for fascia and membrane.
#pragma once

#include "constraint/diagonal.h"
#include "constraint/elements.h"
#include "constraint/strain_limit.h"

INLINE sym2 sheet_metric_above_identity(const v3 f0[2], const v3 h[2])
{
	// F^T F - I, computed from H so that it is exact at rest
	return (sym2){2 * v3_dot(f0[0], h[0]) + v3_dot(h[0], h[0]),
	              2 * v3_dot(f0[1], h[1]) + v3_dot(h[1], h[1]),
	              v3_dot(f0[0], h[1]) + v3_dot(f0[1], h[0]) + v3_dot(h[0], h[1])};
}

// Returns the residual of eq. 13 in F. In the diagonal system each constraint has its own step.
INLINE sheet_gradient sheet_linearised_residual(sheet_gradient f, sym2 k, sym2 target_root,
                                                const vreal dm_inverse[4], vreal g2, bool diagonal)
{
	vreal one = v_set(1);
	sym2 target = sym2_sandwich(target_root, (sym2){one, one, v_set(0)});
	sheet_gradient part[3], r = {{v3_zero(), v3_zero()}};
	sheet_linearised_residuals(f, k, target, part);
	for (int i = 0; i < 3; i++) {
		vreal s = diagonal ? diagonal_scale_sheet(part[i].c, dm_inverse, g2) : one;
		r.c[0] = v3_add_scaled(r.c[0], s, part[i].c[0]);
		r.c[1] = v3_add_scaled(r.c[1], s, part[i].c[1]);
	}
	return r;
}

// Returns the residual R of the triangle's law. Sets *squared to twice the energy over w. Updates
// `polar`. Slots without a target (00 = 0) have the range's residual, if there is a range. For the
// diagonal system R is also scaled.
INLINE sheet_gradient sheet_residual(const cau_sheet_group *group, sheet_gradient f, sym2 k,
                                     sym2 target_root, sheet_gradient *polar,
                                     const vreal dm_inverse[4], vreal g2, bool diagonal,
                                     vreal *squared, vmask *slack)
{
	vmask targeted = target_root.a00 > v_set(0);
	sheet_gradient r, range = {{v3_zero(), v3_zero()}};
	vreal range_squared = v_set(0);
	if (group->limit == CAU_LIMIT_TARGET && group->projection == CAU_PROJECTION_LINEARISED) {
		r = sheet_linearised_residual(f, k, target_root, dm_inverse, g2, diagonal);
		*slack = (vmask){0};
		*squared = v3_dot(r.c[0], r.c[0]) + v3_dot(r.c[1], r.c[1]);
		return r;
	}
	if (group->limit == CAU_LIMIT_RANGE)
		range = sheet_range_residual(f, k, group->stretch_min, group->stretch_max, group->shear_max,
		                             &range_squared);
	r = sheet_target_residual(f, k, target_root, polar, slack);
	*slack &= targeted;
	for (int a = 0; a < 2; a++)
		r.c[a] = v3_select(targeted, r.c[a], range.c[a]);
	if (diagonal) {
		vreal s = diagonal_scale_sheet(r.c, dm_inverse, g2);
		r.c[0] = v3_scale(s, r.c[0]);
		r.c[1] = v3_scale(s, r.c[1]);
	}
	*squared = v3_dot(r.c[0], r.c[0]) + v3_dot(r.c[1], r.c[1]);
	if (group->limit == CAU_LIMIT_RANGE)
		*squared = v_select(targeted, *squared, range_squared);
	return r;
}

// The shared edge of a pair of triangles: its first vertex, and the vector to the second.
typedef struct sheet_edge {
	v3 origin, along;
} sheet_edge;

INLINE sheet_edge sheet_edge_gather(const cau_sheet_set *set, int32_t slot,
                                    const real *displacement)
{
	v3 origin = v3_gather(displacement, set->record_at[0] + slot);
	return (sheet_edge){origin, v3_sub(v3_gather(displacement, set->record_at[1] + slot), origin)};
}

// Returns H = F - F_0 of the triangle on `edge` with the slot's apex.
INLINE sheet_gradient sheet_displacement_gradient(const cau_sheet_set *set, int32_t slot,
                                                  const sheet_edge *edge, const real *displacement)
{
	v3 to_apex = v3_sub(v3_gather(displacement, set->record_at[2] + slot), edge->origin);
	sheet_gradient h;
	for (int c = 0; c < 2; c++)
		h.c[c] = v3_add_scaled(v3_scale(v_load(set->dm_inverse[c], slot), edge->along),
		                       v_load(set->dm_inverse[2 + c], slot), to_apex);
	return h;
}

// Returns w R at F = F_0 + H (N m). Adds twice the energy (J).
INLINE sheet_gradient sheet_stress(const cau_sheet_set *set, const cau_sheet_group *group,
                                   int32_t slot, sheet_gradient h, bool diagonal, vreal *energy,
                                   vmask *slack)
{
	v3 f0[2];
	vreal m[4];
	sheet_gradient polar;
	for (int i = 0; i < 4; i++)
		m[i] = v_load(set->dm_inverse[i], slot);
	for (int a = 0; a < 2; a++) {
		f0[a] = (v3){v_load(set->rest[3 * a], slot), v_load(set->rest[3 * a + 1], slot),
		             v_load(set->rest[3 * a + 2], slot)};
		polar.c[a] = (v3){v_load(set->polar[3 * a], slot), v_load(set->polar[3 * a + 1], slot),
		                  v_load(set->polar[3 * a + 2], slot)};
	}
	sym2 k = sheet_metric_above_identity(f0, h.c);
	k.a00 += 1;
	k.a11 += 1;
	sheet_gradient f = {{v3_add(f0[0], h.c[0]), v3_add(f0[1], h.c[1])}};
	sym2 root = {v_load(set->target[0], slot), v_load(set->target[1], slot),
	             v_load(set->target[2], slot)};
	vreal g2 = diagonal ? v_load(set->position_scale, slot) : v_set(0);
	vreal squared;
	vmask loose;
	sheet_gradient r = sheet_residual(group, f, k, root, &polar, m, g2, diagonal, &squared, &loose);
	for (int a = 0; a < 2; a++) {
		v_store(set->polar[3 * a], slot, polar.c[a].x);
		v_store(set->polar[3 * a + 1], slot, polar.c[a].y);
		v_store(set->polar[3 * a + 2], slot, polar.c[a].z);
	}
	vreal w = v_load(set->weight, slot);
	*energy += w * squared;
	*slack |= loose & (w > v_set(0));
	return (sheet_gradient){{v3_scale(w, r.c[0]), v3_scale(w, r.c[1])}};
}

// Returns the gradient at vertex i + 1 of three: stress (N m) times row i of D_m'^-1.
INLINE v3 sheet_vertex_gradient(const cau_sheet_set *set, int32_t slot, sheet_gradient stress,
                                int i)
{
	return v3_add_scaled(v3_scale(v_load(set->dm_inverse[2 * i], slot), stress.c[0]),
	                     v_load(set->dm_inverse[2 * i + 1], slot), stress.c[1]);
}

// Handles one vector of pairs; the second triangles are one batch after the first. Returns twice
// the energies (J) and adds the gradient at the four vertices of each pair.
INLINE vreal sheet_pairs(const cau_sheet_set *set, const cau_sheet_group *group, int32_t slot,
                         const real *displacement, bool diagonal, real *records, vmask *slack)
{
	sheet_edge edge = sheet_edge_gather(set, slot, displacement);
	v3 on_edge[2] = {v3_zero(), v3_zero()};
	vreal energy = v_set(0);
#pragma GCC unroll 1
	for (int32_t half = slot; half <= slot + CAU_BATCH; half += CAU_BATCH) {
		sheet_gradient h = sheet_displacement_gradient(set, half, &edge, displacement);
		sheet_gradient stress = sheet_stress(set, group, half, h, diagonal, &energy, slack);
		v3 apex = sheet_vertex_gradient(set, half, stress, 1);
		v3 second = sheet_vertex_gradient(set, half, stress, 0);
		v3_add_to(records, set->record_at[2] + half, apex);
		on_edge[1] = v3_add(on_edge[1], second);
		on_edge[0] = v3_sub(v3_sub(on_edge[0], apex), second);
	}
	for (int i = 0; i < 2; i++)
		v3_add_to(records, set->record_at[i] + slot, on_edge[i]);
	return energy;
}

// Prefetches the data of the next pairs, as fat_prefetch does.
INLINE void sheet_prefetch(const cau_sheet_set *set, int32_t slot)
{
	for (int32_t half = slot; half <= slot + CAU_BATCH; half += CAU_BATCH) {
		for (int i = 0; i < 4; i++)
			v_prefetch(set->dm_inverse[i], half);
		for (int i = 0; i < 6; i++) {
			v_prefetch(set->rest[i], half);
			v_prefetch(set->polar[i], half);
		}
		for (int i = 0; i < 3; i++)
			v_prefetch(set->target[i], half);
		v_prefetch(set->weight, half);
		for (int i = half == slot ? 0 : 2; i < 3; i++) {
			__builtin_prefetch(set->record_at[i] + half);
		}
	}
}

// Handles slots [first, last) of one group and returns their energy, J. `displacement` is u = x -
// X, m, by the share's records. The gradients are added to `records`. Sets *slack to whether a
// triangle is slack (CAU_SLACK).
static double sheet_kernel(const cau_elements *elements, const cau_sheet_group *group,
                           int32_t first, int32_t last, const real *displacement, real *records,
                           bool diagonal, bool *slack)
{
	vsum energy = {0};
	vmask loose = {0};
	for (int32_t batch = first; batch < last; batch += 2 * CAU_BATCH) {
		if (batch + 2 * CAU_BATCH < group->first_slot + group->slot_count)
			sheet_prefetch(&elements->sheet, batch + 2 * CAU_BATCH);
		for (int32_t slot = batch; slot < batch + CAU_BATCH; slot += LANES)
			energy += v_widen(sheet_pairs(&elements->sheet, group, slot, displacement, diagonal,
			                              records, &loose));
	}
	*slack = v_any(loose);
	return 0.5 * v_total(energy);
}
