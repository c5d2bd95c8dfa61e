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
	CAU_ASSERT(laws[model].poisson_most > 0 && laws[model].poisson_most < 0.5, "model %d up to %g",
	           model, laws[model].poisson_most);
	CAU_ASSERT(laws[model].mu_mu > 0, "model %d with %g mu", model, laws[model].mu_mu);
	return &laws[model];
}
