// SPDX-License-Identifier: GPL-3.0-or-later
#include "constraint/law.h"

#include "cautery/assert.h"

const cau_law *cau_law_of(int model)
{
#define X(code, word, poisson_most, has_energy, keeps_rotation, lambda_mu, mu_mu, meaning)         \
	{#word, poisson_most, has_energy, keeps_rotation, lambda_mu, mu_mu, meaning},
	static const cau_law laws[] = {CAU_MODEL_TABLE(X)};
#undef X
	CAU_ASSERT_INDEX(model, CAU_MODEL_COUNT);
	return &laws[model];
}
