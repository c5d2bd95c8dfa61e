// SPDX-License-Identifier: GPL-3.0-or-later
// Gradient and energy of a range of tetrahedra: the local step (eq. 6) for fat.
#pragma once

#include "constraint/diagonal.h"
#include "constraint/elements.h"
#include "constraint/fat_energy.h"
#include "constraint/strain_limit.h"

INLINE rotation_lanes rotation_load(void *const array[4], int32_t slot)
{
	return (rotation_lanes){v_load(array[0], slot), v_load(array[1], slot), v_load(array[2], slot),
	                        v_load(array[3], slot)};
}
INLINE void rotation_store(void *const array[4], int32_t slot, rotation_lanes q)
{
	v_store(array[0], slot, q.w);
	v_store(array[1], slot, q.x);
	v_store(array[2], slot, q.y);
	v_store(array[3], slot, q.z);
}
INLINE sym3 sym3_load(void *const array[6], int32_t slot)
{
	return (sym3){v_load(array[0], slot), v_load(array[1], slot), v_load(array[2], slot),
	              v_load(array[3], slot), v_load(array[4], slot), v_load(array[5], slot)};
}

// Returns the stress of the energy (Pa) at F = I + H, and its density (Pa).
INLINE m3 fat_energy_stress(const cau_fat_group *group, m3 f, m3 h, rotation_lanes *polar,
                            vreal *density)
{
	law_terms terms = {f, h, (real)group->mu, (real)group->lambda, (real)group->stiffness};
	switch (group->model) {
#define X(code, word, ...)                                                                         \
	case CAU_MODEL_##code:                                                                         \
		return word##_stress(terms, polar, density);
		CAU_MODEL_TABLE(X)
#undef X
	default:
		__builtin_unreachable(); // cau_law_of refuses every other model
	}
}

// Computes the stress of the elastic part F_e = F C_p^(-1/2), with H_e = Z + H + H Z and Z =
// C_p^(-1/2) - I, and maps the stress back to F.
INLINE m3 fat_plastic_energy_stress(const cau_fat_group *group, m3 h, sym3 z, rotation_lanes *polar,
                                    vreal *density)
{
	m3 he = m3_add(h, m3_times_sym(h, z));
	he.c[0] = v3_add(he.c[0], (v3){z.a00, z.a01, z.a02});
	he.c[1] = v3_add(he.c[1], (v3){z.a01, z.a11, z.a12});
	he.c[2] = v3_add(he.c[2], (v3){z.a02, z.a12, z.a22});
	m3 p = fat_energy_stress(group, m3_add(m3_identity(), he), he, polar, density);
	return m3_add(p, m3_times_sym(p, z));
}

// Returns the scale that turns residual R into the printed position projection, for the diagonal
// system.
INLINE vreal fat_position_scale(const cau_fat_set *set, int32_t slot, m3 r)
{
	vreal m[9];
	for (int i = 0; i < 9; i++)
		m[i] = v_load(set->dm_inverse[i], slot);
	return diagonal_scale_fat(r, m, v_load(set->position_scale, slot));
}

// Returns the residual of eq. 13 in F. In the diagonal system each constraint has its own step.
INLINE m3 fat_linearised_residual(const cau_fat_set *set, int32_t slot, sym3 root, m3 f,
                                  bool diagonal)
{
	m3 rows = {{{root.a00, root.a01, root.a02},
	            {root.a01, root.a11, root.a12},
	            {root.a02, root.a12, root.a22}}};
	m3 part[6], r = {{v3_zero(), v3_zero(), v3_zero()}};
	fat_linearised_residuals(f, m3_transpose_times(rows, rows), part);
	for (int i = 0; i < 6; i++) {
		vreal s = diagonal ? fat_position_scale(set, slot, part[i]) : v_set(1);
		r = m3_add_scaled(r, s, part[i]);
	}
	return r;
}

// Returns the residual of slots that have shrunk, in a group whose law has no target. These slots
// have their own target `root`. For other slots (00 = 0), R = 0.
INLINE m3 fat_shrunk_residual(sym3 root, m3 f, rotation_lanes *polar)
{
	vmask targeted = root.a00 > v_set(0);
	vreal one = v_set(1), zero = v_set(0);
	sym3 used = {v_select(targeted, root.a00, one),  v_select(targeted, root.a11, one),
	             v_select(targeted, root.a22, one),  v_select(targeted, root.a01, zero),
	             v_select(targeted, root.a02, zero), v_select(targeted, root.a12, zero)};
	m3 r = fat_target_residual(f, used, polar);
	return m3_select(~targeted, (m3){{v3_zero(), v3_zero(), v3_zero()}}, r);
}

// Returns the residual of RANGE. Sets *extra to the sum of the squared distances less |R|^2.
INLINE m3 fat_ranged_residual(const cau_fat_group *group, sym3 root, m3 f, rotation_lanes *polar,
                              vreal *extra)
{
	vmask targeted = root.a00 > v_set(0);
	vreal squared;
	m3 r =
		fat_range_residual(f, group->stretch_min, group->stretch_max, group->shear_max, &squared);
	*extra = v_select(targeted, v_set(0), squared - m3_dot(r, r));
	return v_any(targeted) ? m3_select(targeted, fat_shrunk_residual(root, f, polar), r) : r;
}

// Returns the residual of the strain limit (dimensionless). The limit's energy is w/2 (|R|^2 +
// *extra).
INLINE m3 fat_limit_residual(const cau_fat_set *set, const cau_fat_group *group, int32_t slot,
                             sym3 common, m3 f, rotation_lanes *polar, bool diagonal, vreal *extra)
{
	sym3 root = set->targeted[slot / CAU_BATCH] ? sym3_load(set->target, slot) : common;
	if (group->limit == CAU_LIMIT_TARGET && group->projection == CAU_PROJECTION_LINEARISED)
		return fat_linearised_residual(set, slot, root, f, diagonal);
	if (group->limit == CAU_LIMIT_TARGET) { // every slot has a target, even padding
		m3 r = fat_target_residual(f, root, polar);
		return diagonal ? m3_scale(fat_position_scale(set, slot, r), r) : r;
	}
	m3 r = group->limit == CAU_LIMIT_RANGE ? fat_ranged_residual(group, root, f, polar, extra)
	                                       : fat_shrunk_residual(root, f, polar);
	return diagonal ? m3_scale(fat_position_scale(set, slot, r), r) : r;
}

// The shared face of a pair of tetrahedra: its first vertex, and the edges from there to the other
// two vertices.
typedef struct fat_face {
	v3 origin, edge[2];
} fat_face;

INLINE fat_face fat_face_gather(const cau_fat_set *set, int32_t slot, const real *displacement)
{
	fat_face face = {.origin = v3_gather(displacement, set->record_at[0] + slot)};
	for (int i = 0; i < 2; i++)
		face.edge[i] = v3_sub(v3_gather(displacement, set->record_at[i + 1] + slot), face.origin);
	return face;
}

// Returns H = F - I of the tetrahedron on `face` with the slot's apex.
INLINE m3 fat_displacement_gradient(const cau_fat_set *set, int32_t slot, const fat_face *face,
                                    const real *displacement)
{
	v3 to_apex = v3_sub(v3_gather(displacement, set->record_at[3] + slot), face->origin);
	m3 h;
	for (int c = 0; c < 3; c++) {
		h.c[c] = v3_scale(v_load(set->dm_inverse[c], slot), face->edge[0]);
		h.c[c] = v3_add_scaled(h.c[c], v_load(set->dm_inverse[3 + c], slot), face->edge[1]);
		h.c[c] = v3_add_scaled(h.c[c], v_load(set->dm_inverse[6 + c], slot), to_apex);
	}
	return h;
}

// Returns the weight of the limit, N m. If the law has a limit, the limit acts on every slot.
// Otherwise it acts only on slots that have shrunk.
INLINE vreal fat_limit_weight(const cau_fat_set *set, const cau_fat_group *group, int32_t slot)
{
	if (group->limit == CAU_LIMIT_NONE)
		return v_load(set->limit_weight, slot);
	return (real)group->limit_stiffness * v_load(set->volume, slot);
}

// Returns the stress (Pa m^3 = N m) at F = I + H, and adds the energies (J). `common` is the
// group's target.
INLINE m3 fat_stress(const cau_fat_set *set, const cau_fat_group *group, int32_t slot, sym3 common,
                     m3 h, bool diagonal, vreal *energy)
{
	int limited = set->limited[slot / CAU_BATCH];
	m3 f = m3_add(m3_identity(), h), r = {{v3_zero(), v3_zero(), v3_zero()}};
	rotation_lanes polar = {v_set(1), v_set(0), v_set(0), v_set(0)};
	if (limited || group->keeps_rotation)
		polar = rotation_load(set->polar, slot);
	vreal density, volume = v_load(set->volume, slot);
	if (limited) { // the limit comes first, because its rotation needs the most registers
		vreal w = fat_limit_weight(set, group, slot);
		vreal extra = v_set(0);
		r = fat_limit_residual(set, group, slot, common, f, &polar, diagonal, &extra);
		rotation_store(set->polar, slot, polar);
		*energy += (real)0.5 * w * m3_dot(r, r);
		if (group->limit == CAU_LIMIT_RANGE)
			*energy += (real)0.5 * w * extra;
	}
	m3 p =
		group->plastic && set->flowed[slot / CAU_BATCH]
			? fat_plastic_energy_stress(group, h, sym3_load(set->plastic, slot), &polar, &density)
			: fat_energy_stress(group, f, h, &polar, &density);
	if (!limited && group->keeps_rotation)
		rotation_store(set->polar, slot, polar);
	*energy += volume * density;
	if (diagonal) {
		m3 e = m3_scale(v_set((real)(1 / group->stiffness)), p);
		p = m3_scale(fat_position_scale(set, slot, e), p);
	}
	m3 stress = m3_scale(volume, p);
	return limited ? m3_add_scaled(stress, fat_limit_weight(set, group, slot), r) : stress;
}

// Returns the gradient at vertex i + 1 of four: stress (N m) times row i of D_m^-1.
INLINE v3 fat_vertex_gradient(const cau_fat_set *set, int32_t slot, m3 stress, int i)
{
	v3 g = v3_scale(v_load(set->dm_inverse[3 * i], slot), stress.c[0]);
	for (int c = 1; c < 3; c++)
		g = v3_add_scaled(g, v_load(set->dm_inverse[3 * i + c], slot), stress.c[c]);
	return g;
}

// Handles one vector of pairs; the second tetrahedra are one batch after the first. Returns the
// energies (J) and adds the gradient at the five vertices of each pair.
INLINE vreal fat_pairs(const cau_fat_set *set, const cau_fat_group *group, int32_t slot,
                       sym3 common, const real *displacement, bool diagonal, real *records)
{
	fat_face face = fat_face_gather(set, slot, displacement);
	v3 on_face[3] = {v3_zero(), v3_zero(), v3_zero()};
	vreal energy = v_set(0);
#pragma GCC unroll 1
	for (int32_t half = slot; half <= slot + CAU_BATCH; half += CAU_BATCH) {
		m3 h = fat_displacement_gradient(set, half, &face, displacement);
		v_forget();
		m3 stress = fat_stress(set, group, half, common, h, diagonal, &energy);
		v_forget();
		v3 apex = fat_vertex_gradient(set, half, stress, 2);
		v3_add_to(records, set->record_at[3] + half, apex);
		on_face[0] = v3_sub(on_face[0], apex);
		for (int i = 0; i < 2; i++) {
			v3 g = fat_vertex_gradient(set, half, stress, i);
			on_face[i + 1] = v3_add(on_face[i + 1], g);
			on_face[0] = v3_sub(on_face[0], g);
		}
	}
	for (int i = 0; i < 3; i++)
		v3_add_to(records, set->record_at[i] + slot, on_face[i]);
	return energy;
}

// Prefetches the data of the next pairs. Processors do not prefetch so many arrays by themselves.
INLINE void fat_prefetch(const cau_fat_set *set, const cau_fat_group *group, int32_t slot)
{
	for (int32_t half = slot; half <= slot + CAU_BATCH; half += CAU_BATCH) {
		for (int i = 0; i < 9; i++)
			v_prefetch(set->dm_inverse[i], half);
		v_prefetch(set->volume, half);
		for (int i = half == slot ? 0 : 3; i < 4; i++) {
			__builtin_prefetch(set->record_at[i] + half);
		}
		if (!set->limited[half / CAU_BATCH])
			continue;
		if (group->limit == CAU_LIMIT_NONE)
			v_prefetch(set->limit_weight, half);
		for (int i = 0; i < 6 && set->targeted[half / CAU_BATCH]; i++)
			v_prefetch(set->target[i], half);
		for (int i = 0; i < 4; i++)
			v_prefetch(set->polar[i], half);
	}
}

// Handles slots [first, last) of one group and returns their energy, J. `displacement` is u = x -
// X, m, by the share's records. The gradients are added to `records`.
static double fat_kernel(const cau_elements *elements, const cau_fat_group *group, int32_t first,
                         int32_t last, const real *displacement, real *records, bool diagonal)
{
	vsum energy = {0};
	sym3 common = {v_set((real)group->target[0]), v_set((real)group->target[1]),
	               v_set((real)group->target[2]), v_set((real)group->target[3]),
	               v_set((real)group->target[4]), v_set((real)group->target[5])};
	for (int32_t batch = first; batch < last; batch += 2 * CAU_BATCH) {
		if (batch + 2 * CAU_BATCH < group->first_slot + group->slot_count)
			fat_prefetch(&elements->fat, group, batch + 2 * CAU_BATCH);
		for (int32_t slot = batch; slot < batch + CAU_BATCH; slot += LANES)
			energy += v_widen(
				fat_pairs(&elements->fat, group, slot, common, displacement, diagonal, records));
	}
	return v_total(energy);
}
