// SPDX-License-Identifier: GPL-3.0-or-later
// Gradient and energy of a range of triangles: the local step (eq. 6) for fascia and membrane.
#pragma once

#include "constraint/diagonal.h"
#include "constraint/elements.h"
#include "constraint/strain_limit_sheet.h"

INLINE sym2 sheet_metric_above_identity(const v3 f0[2], const v3 h[2])
{
	// F^T F - I, from H: exact at rest
	return (sym2){2 * v3_dot(f0[0], h[0]) + v3_dot(h[0], h[0]),
	              2 * v3_dot(f0[1], h[1]) + v3_dot(h[1], h[1]),
	              v3_dot(f0[0], h[1]) + v3_dot(f0[1], h[0]) + v3_dot(h[0], h[1])};
}

// Residual R of the triangle's law; `polar` is updated. For a linearised law in the diagonal system
// each constraint has its own step, so `scale` (set to 1 otherwise) is applied here.
INLINE sheet_gradient sheet_residual(const cau_sheet_group *group, sheet_gradient f, sym2 k,
                                     sym2 target_root, sheet_gradient *polar,
                                     const vreal dm_inverse[4], vreal g2, int diagonal)
{
	sheet_gradient r;
	vmask targeted = target_root.a00 > v_set(0);
	if (group->limit == CAU_LIMIT_TARGET && group->projection == CAU_PROJECTION_LINEARISED) {
		vreal one = v_set(1);
		sym2 target = sym2_sandwich(target_root, (sym2){one, one, v_set(0)});
		sheet_gradient part[3];
		sheet_linearised_residuals(f, k, target, part);
		r = (sheet_gradient){{v3_zero(), v3_zero()}};
		for (int i = 0; i < 3; ++i) {
			vreal s = diagonal ? diagonal_scale_sheet(part[i].c, dm_inverse, g2) : one;
			r.c[0] = v3_add_scaled(r.c[0], s, part[i].c[0]);
			r.c[1] = v3_add_scaled(r.c[1], s, part[i].c[1]);
		}
		return r;
	}
	sym2 root = target_root;
	vmask idle = ~targeted;
	if (group->limit == CAU_LIMIT_RANGE) {
		vreal unused;
		vmask inside;
		sym2 range = sym2_sqrt(sheet_range_metric(k, group->stretch_min, group->stretch_max,
		                                          group->shear_max, &inside),
		                       &unused);
		root =
			(sym2){v_select(targeted, root.a00, range.a00), v_select(targeted, root.a11, range.a11),
		           v_select(targeted, root.a01, range.a01)};
		idle = ~targeted & inside;
	}
	r = sheet_target_residual(f, k, root, polar);
	for (int a = 0; a < 2; ++a)
		r.c[a] = v3_select(idle, v3_zero(), r.c[a]);
	if (diagonal) {
		vreal s = diagonal_scale_sheet(r.c, dm_inverse, g2);
		r.c[0] = v3_scale(s, r.c[0]);
		r.c[1] = v3_scale(s, r.c[1]);
	}
	return r;
}

// Slots [first, last) of one group: returns their energy, J. `displacement` is u = x - X, m,
// (vertex_count x 4).
static double sheet_kernel(const cau_elements *elements, const cau_sheet_group *group,
                           int32_t first, int32_t last, const real *displacement, int diagonal)
{
	const cau_sheet_set *set = &elements->sheet;
	vsum energy = {0};
	for (int32_t slot = first; slot < last; slot += LANES) {
		v3 u0 = v3_gather(displacement, set->vertex_at[0] + slot);
		v3 d1 = v3_sub(v3_gather(displacement, set->vertex_at[1] + slot), u0);
		v3 d2 = v3_sub(v3_gather(displacement, set->vertex_at[2] + slot), u0);
		vreal m[4];
		for (int i = 0; i < 4; ++i)
			m[i] = v_load(set->dm_inverse[i], slot);
		v3 h[2] = {v3_add_scaled(v3_scale(m[0], d1), m[2], d2),
		           v3_add_scaled(v3_scale(m[1], d1), m[3], d2)};
		v3 f0[2];
		sheet_gradient polar;
		for (int a = 0; a < 2; ++a) {
			f0[a] = (v3){v_load(set->rest[3 * a], slot), v_load(set->rest[3 * a + 1], slot),
			             v_load(set->rest[3 * a + 2], slot)};
			polar.c[a] = (v3){v_load(set->polar[3 * a], slot), v_load(set->polar[3 * a + 1], slot),
			                  v_load(set->polar[3 * a + 2], slot)};
		}
		sym2 k = sheet_metric_above_identity(f0, h);
		k.a00 += 1;
		k.a11 += 1;
		sheet_gradient f = {{v3_add(f0[0], h[0]), v3_add(f0[1], h[1])}};
		sym2 root = {v_load(set->target[0], slot), v_load(set->target[1], slot),
		             v_load(set->target[2], slot)};
		vreal g2 = diagonal ? v_load(set->position_scale, slot) : v_set(0);
		sheet_gradient r = sheet_residual(group, f, k, root, &polar, m, g2, diagonal);
		vreal w = v_load(set->weight, slot);
		energy += v_widen(w * (v3_dot(r.c[0], r.c[0]) + v3_dot(r.c[1], r.c[1])));
		// gradient on the vertices: w R D_m'^-T
		v3 s0 = v3_scale(w, r.c[0]), s1 = v3_scale(w, r.c[1]);
		v3 g1 = v3_add_scaled(v3_scale(m[0], s0), m[1], s1);
		v3 g2v = v3_add_scaled(v3_scale(m[2], s0), m[3], s1);
		v3 g0 = v3_sub(v3_sub(v3_zero(), g1), g2v);
		v3_add_to(elements->gradient, set->record_at[0] + slot, g0);
		v3_add_to(elements->gradient, set->record_at[1] + slot, g1);
		v3_add_to(elements->gradient, set->record_at[2] + slot, g2v);
		for (int a = 0; a < 2; ++a) {
			v_store(set->polar[3 * a], slot, polar.c[a].x);
			v_store(set->polar[3 * a + 1], slot, polar.c[a].y);
			v_store(set->polar[3 * a + 2], slot, polar.c[a].z);
		}
	}
	return 0.5 * v_total(energy);
}
