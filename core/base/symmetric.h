// SPDX-License-Identifier: GPL-3.0-or-later
// Functions of symmetric 2x2 and 3x3 matrices in double, for code that is not time-critical.
// Entries of 2x2: 00, 11, 01. Entries of 3x3: 00, 11, 22, 01, 02, 12.
#pragma once

// Computes eigenvalues (in no particular order) and orthonormal eigenvectors (columns of v,
// v[row][column]).
void cau_symmetric_eigen3(const double a[6], double value[3], double v[3][3]);

// Computes A^power by the eigenvalues. Eigenvalues below `floor` are replaced by `floor`.
void cau_symmetric_power3(const double a[6], double power, double floor, double out[6]);
void cau_symmetric_power2(const double a[3], double power, double floor, double out[3]);
