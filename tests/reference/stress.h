// SPDX-License-Identifier: GPL-3.0-or-later
// First Piola-Kirchhoff stress, written by hand in double. It is an oracle that is independent of
// core and of the finite-element package, whose derivatives are automatic.
#pragma once

// Computes P (Pa) of the deformation gradient F (only read), both row-major. `model` is
// CAU_MODEL_STVK or CAU_MODEL_NEOHOOKEAN (the inversion-safe form of Smith et al. 2018 with its
// Lame reparametrisation).
void cau_reference_stress(int model, double young_modulus_pa, double poisson_ratio, double f[3][3],
                          double stress[3][3]);

double cau_reference_determinant(double f[3][3]);
