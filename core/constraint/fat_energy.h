// SPDX-License-Identifier: GPL-3.0-or-later
// Energies of fat (section 5.2). Psi is the energy density (Pa), and P = dPsi/dF is the first
// Piola-Kirchhoff stress (Pa) at F = I + H. Psi and P are written in H, so that they are exactly
// zero at rest. Strain in this file is (F^T F - I)/2, with the factor of one half.
//
// Each law is an entry of CAU_MODEL_TABLE and a function of the form below. The function returns P
// and sets *density to Psi. `polar` is the slot's rotation. A law that keeps a rotation reads and
// writes `polar`.
//
//     INLINE m3 word_stress(law_terms t, rotation_lanes *polar, vreal *density)
#pragma once

#include "constraint/polar.h"

// Input of a law: F and H = F - I, the Lame parameters as its entry defines them, and the stiffness
// k with which it counts in A (Pa).
typedef struct law_terms {
	m3 f, h;
	real mu, lambda, stiffness;
} law_terms;

// E = (H + H^T + H^T H) / 2
INLINE sym3 green_strain(m3 h)
{
	sym3 hh = m3_transpose_times(h, h);
	const real half = (real)0.5;
	return (sym3){h.c[0].x + half * hh.a00,
	              h.c[1].y + half * hh.a11,
	              h.c[2].z + half * hh.a22,
	              half * (h.c[1].x + h.c[0].y + hh.a01),
	              half * (h.c[2].x + h.c[0].z + hh.a02),
	              half * (h.c[2].y + h.c[1].z + hh.a12)};
}
INLINE vreal sym3_dot(sym3 a, sym3 b)
{
	return a.a00 * b.a00 + a.a11 * b.a11 + a.a22 * b.a22 +
	       2 * (a.a01 * b.a01 + a.a02 * b.a02 + a.a12 * b.a12);
}

// St. Venant-Kirchhoff: Psi = mu e:e + lambda/2 tr(e)^2, P = F (2 mu e + lambda tr(e) I).
INLINE m3 stvk_stress(law_terms t, rotation_lanes *polar, vreal *density)
{
	(void)polar;
	sym3 e = green_strain(t.h);
	vreal trace = e.a00 + e.a11 + e.a22;
	*density = t.mu * sym3_dot(e, e) + (real)0.5 * t.lambda * trace * trace;
	vreal l = t.lambda * trace, m = v_set(2 * t.mu);
	sym3 s = {m * e.a00 + l, m * e.a11 + l, m * e.a22 + l, m * e.a01, m * e.a02, m * e.a12};
	return m3_times_sym(t.f, s);
}

// q - log(1 + q) for q > -1 without cancellation: with z = q / (2 + q), log(1 + q) = 2 atanh(z).
INLINE vreal log_remainder(vreal q)
{
	vreal z = q / (2 + q), z2 = z * z;
	vreal series = v_set(0);
	for (int odd = CAU_SINGLE ? 19 : 41; odd >= 3; odd -= 2)
		series = series * z2 + (real)(1.0 / odd);
	vreal out = q * z - 2 * z * z2 * series;
	vmask outside = v_abs(z) > (real)0.4;
	if (v_any(outside))
		for (int l = 0; l < LANES; l++)
			if (outside[l])
				out[l] = (real)((double)q[l] - log1p((double)q[l]));
	return out;
}

// Stable neo-Hookean [Smith, De Goes, Kim 2018], without its constant at rest:
// Psi = mu/2 (I_C - 3) + lambda/2 (J - alpha)^2 - mu/2 log(I_C + 1), alpha = 1 + 3 mu / (4 lambda).
// P = mu (1 - 1/(I_C + 1)) F + lambda (J - alpha) cof F
//   = mu [3/4 (F - cof F) + (1/4 - 1/(I_C + 1)) F] + lambda (J - 1) cof F.
INLINE m3 neohookean_stress(law_terms t, rotation_lanes *polar, vreal *density)
{
	(void)polar;
	m3 f = t.f, h = t.h;
	real mu = t.mu, lambda = t.lambda;
	m3 cof_h = m3_cofactor(h);
	vreal trace = m3_trace(h);
	vreal ic3 = 2 * trace + m3_dot(h, h); // I_C - 3
	vreal bulge = m3_trace(cof_h) + m3_determinant(h);
	vreal j1 = trace + bulge; // J - 1
	m3 cof = m3_cofactor(f);
	// cof F - I = tr(H) I - H^T + cof H
	m3 cof1 = cof_h;
	cof1.c[0] = v3_sub(cof1.c[0], (v3){h.c[0].x - trace, h.c[1].x, h.c[2].x});
	cof1.c[1] = v3_sub(cof1.c[1], (v3){h.c[0].y, h.c[1].y - trace, h.c[2].y});
	cof1.c[2] = v3_sub(cof1.c[2], (v3){h.c[0].z, h.c[1].z, h.c[2].z - trace});
	vreal q = (real)0.25 * ic3;              // (I_C + 1)/4 - 1
	vreal growth = (real)0.25 * q / (1 + q); // 1/4 - 1/(I_C + 1)
	// Psi without its constant. The first-order terms cancel and are left out.
	*density =
		mu * ((real)0.375 * m3_dot(h, h) - (real)0.75 * bulge + (real)0.5 * log_remainder(q)) +
		(real)0.5 * lambda * j1 * j1;
	m3 p = m3_scale((real)0.75 * v_set(mu), m3_sub(h, cof1));
	p = m3_add_scaled(p, mu * growth, f);
	return m3_add_scaled(p, lambda * j1, cof);
}

// Corotated linear elasticity with determinant-corrected rotation R:
// Psi = mu |F - R|^2 + lambda/2 tr(R^T F - I)^2, P = 2 mu (F - R) + lambda tr(R^T F - I) R.
INLINE m3 corotated_stress(law_terms t, rotation_lanes *polar, vreal *density)
{
	m3 rotation = polar_rotation(t.f, polar);
	m3 stretch = m3_sub(t.f, rotation);
	vreal trace = m3_dot(rotation, stretch);
	*density = t.mu * m3_dot(stretch, stretch) + (real)0.5 * t.lambda * trace * trace;
	return m3_add_scaled(m3_scale(2 * v_set(t.mu), stretch), t.lambda * trace, rotation);
}

// The printed energy constraint C = Psi (eq. 14-17), projected in F: dF = -Psi P / |P|^2. Its
// stress in the system is `stiffness` (Pa) times Psi P / |P|^2. At rest this is 0/0, so a small
// stress is added to the denominator.
INLINE m3 energy_stress(law_terms t, rotation_lanes *polar, vreal *density)
{
	m3 p = stvk_stress(t, polar, density);
	// the added stress: that at a strain of 1e-10
	real least = (real)1e-10 * (2 * t.mu + 3 * t.lambda);
	vreal step = t.stiffness * *density / (m3_dot(p, p) + least * least);
	return m3_scale(step, p);
}
