// SPDX-License-Identifier: GPL-3.0-or-later
// The closed form of one element that is stretched along one axis with free sides: F = diag(s, l,
// l).
#pragma once

#include <stdint.h>

#include "cautery/status.h"

typedef struct cau_reference_uniaxial {
	int model; // CAU_MODEL_STVK or CAU_MODEL_NEOHOOKEAN
	double young_modulus_pa;
	double poisson_ratio;
	double stretch;         // s
	double lateral_stretch; // l
	// first Piola-Kirchhoff stress along the axis; the lateral stress is zero
	double stress_pa;
} cau_reference_uniaxial;

// Reads uniaxial.txt into at most `capacity` entries of `rows`. Errors: CAU_IO, CAU_BAD_SYNTAX
// naming the line, CAU_LIMIT if there are more lines.
cau_status cau_reference_uniaxial_read(const char *path, int32_t capacity,
                                       cau_reference_uniaxial *rows, int32_t *row_count,
                                       cau_error *error);
