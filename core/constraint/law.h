// SPDX-License-Identifier: GPL-3.0-or-later
// Properties of a law of fat that the solver needs besides its stress: an entry of CAU_MODEL_TABLE.
#pragma once

#include <stdbool.h>

#include "cautery/scene.h"

typedef struct cau_law {
	const char *word;        // in JSON
	double poisson_most;     // larger ratios are refused
	bool has_energy;         // its stress is the gradient of an energy: the solver may compare that
	bool keeps_rotation;     // from evaluation to evaluation, in the slots' `polar`
	double lambda_mu, mu_mu; // Lame parameters as evaluated: lambda + lambda_mu mu and mu_mu mu
	const char *meaning;
} cau_law;

// `model`: CAU_MODEL_*
const cau_law *cau_law_of(int model);
