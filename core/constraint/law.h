// SPDX-License-Identifier: GPL-3.0-or-later
// Properties of a law of fat that the solver needs in addition to its stress. Each is an entry of
// CAU_MODEL_TABLE.
#pragma once

#include <stdbool.h>

#include "cautery/scene.h"

typedef struct cau_law {
	const char *word;    // name in JSON
	double poisson_most; // largest Poisson's ratio that is accepted
	bool has_energy;     // the stress is the gradient of an energy, which the solver may compare
	bool keeps_rotation; // the law uses a rotation that `polar` of the slot keeps between
	                     // evaluations
	double lambda_mu, mu_mu; // Lame parameters as evaluated: lambda + lambda_mu mu and mu_mu mu
	const char *meaning;
} cau_law;

// Returns the properties of a law; `model` is CAU_MODEL_*.
const cau_law *cau_law_of(int model);
